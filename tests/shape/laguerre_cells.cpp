// silt - BSD-3-Clause, see LICENSE

#include "bodies.hpp"

#include <silt/fill/bodies.hpp>
#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/narrow/solid_pairs.hpp>

namespace laguerre_cells_test {

using namespace shape_test;
using silt::laguerre_cells;

namespace {

struct Named {
  std::string name;
  Polyhedron body;
};

/// Bodies of about size 1; those with corners of four edges and with many faces among them.
std::vector<Named> bodies() {
  Random random(3);
  const std::vector<Vec3d> octahedron{{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                      {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  std::vector<Vec3d> ball;
  for (int k = 0; k < 100; ++k) ball.push_back(0.5 * random.direction());
  return {{"cube", box({1, 1, 1})},
          {"plate", box({1, 1, 0.05})},
          {"needle", box({1, 0.03, 0.04})},
          {"tetrahedron", Polyhedron::from_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})},
          {"octahedron", Polyhedron::from_points(octahedron)},
          {"hull", random.hull(15)},
          {"ball", Polyhedron::from_points(ball)}};
}

/// Sizes between 1 and `ratio`, evenly in their logarithm, both ends among them.
std::vector<double> some_shares(std::size_t count, double ratio, silt::Random& random) {
  std::vector<double> out{1, ratio};
  while (out.size() < count) out.push_back(std::pow(ratio, random.uniform()));
  double sum = 0;
  for (const double s : out) sum += s;
  for (double& s : out) s /= sum;
  return out;
}

double diameter(const Polyhedron& body) { return 2 * body.bounding_radius(); }

/// Moments of all cells about `origin`.
silt::Moments moments_about(const std::vector<Polyhedron>& cells, const Vec3d& origin) {
  silt::Moments sum;
  for (const auto& cell : cells) {
    const auto m = silt::moments_of(cell.triangles(), origin);
    sum.volume += m.volume, sum.first += m.first, sum.second += m.second;
  }
  return sum;
}

/// [m] the body's depth of a point under its faces; < 0 outside.
double depth_in(const Polyhedron& body, const Vec3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : body.faces()) least = std::min(least, face.offset - dot(face.normal, p));
  return least;
}

double sphericity(const Polyhedron& body) {
  return std::cbrt(pi * 36 * body.core_volume() * body.core_volume()) / body.core_area();
}

std::vector<double> equal(std::size_t count) {
  return std::vector<double>(count, 1.0 / static_cast<double>(count));
}

/// As the engine finds contacts: each in its principal frame, put back where it was; all of them
/// turned by `q` and moved by `way` [m].
double deepest_contact(const std::vector<Polyhedron>& cells, const silt::Quaternion& q = {},
                       const Vec3d& way = {0, 0, 0}) {
  std::vector<silt::PrincipalShape> shapes;
  for (const auto& cell : cells) {
    shapes.push_back(principal_shape(cell));
    const auto mass = cell.mass_properties();
    const auto axes = silt::body_axes(q * mass.axes);
    shapes.back().frame = {way + rotate(q, mass.centroid),
                           silt::RotationMatrix{axes.x, axes.y, axes.z}};
  }
  double most = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const silt::PlacedPolyhedron a{&shapes[i].parts[0], shapes[i].frame};
      const silt::PlacedPolyhedron b{&shapes[j].parts[0], shapes[j].frame};
      silt::NormalMemory<double> memory{{0, 0, 0}, 0, 0};
      most = std::max(most, touch_solids(a, b, memory).overlap);
    }
  return most;
}

}  // namespace

TEST_CASE("laguerre_cells: volumes to 1e-12 of the body's, moments of all together to 1e-12") {
  for (const auto& named : bodies()) {
    const auto& body = named.body;
    CAPTURE(named.name);
    const auto mass = mass_properties(body);
    const auto whole = silt::moments_of(body.triangles(), mass.centroid);
    for (const std::size_t count : {2, 3, 8, 12, 50})
      for (const double ratio : {1.0, 1e-2, 1e-4}) {
        CAPTURE(count);
        CAPTURE(ratio);
        silt::Random random(7 + count);
        const auto shares = some_shares(count, ratio, random);
        const auto cells = laguerre_cells(body, shares, random);
        REQUIRE(cells.size() == count);
        double worst = 0;
        for (std::size_t k = 0; k < count; ++k)
          worst =
              std::max(worst, std::abs(cells[k].core_volume() / body.core_volume() - shares[k]));
        CHECK(worst <= 1e-12);
        const auto sum = moments_about(cells, mass.centroid);
        const double trace = whole.second.trace();
        CHECK(agree(sum.volume, whole.volume, 1e-13));
        CHECK(norm(sum.first) <= 1e-12 * whole.volume * diameter(body));
        auto rest = sum.second;
        rest += -1.0 * whole.second;
        for (const double part : {rest.xx, rest.yy, rest.zz, rest.xy, rest.yz, rest.zx})
          CHECK(std::abs(part) <= 1e-12 * trace);
      }
  }
}

TEST_CASE("laguerre_cells: 200 cells of volumes from 1 to 1e-4 in a cube") {
  silt::Random random(5);
  const auto shares = some_shares(200, 1e-4, random);
  const auto cells = laguerre_cells(box({1, 1, 1}), shares, random);
  double worst = 0, sum = 0;
  for (std::size_t k = 0; k < cells.size(); ++k)
    worst = std::max(worst, std::abs(cells[k].core_volume() - shares[k])),
    sum += cells[k].core_volume();
  CHECK(worst <= 1e-12);
  CHECK(agree(sum, 1, 1e-13));
}

TEST_CASE("laguerre_cells: each random point is in one cell, but within 1e-12 of a face") {
  for (const auto& named : bodies()) {
    const auto& body = named.body;
    CAPTURE(named.name);
    silt::Random random(11);
    const auto cells = laguerre_cells(body, some_shares(20, 1e-3, random), random);
    const silt::detail::PointsInside inside(body);
    const double band = 1e-12 * diameter(body);
    int nowhere = 0, twice = 0;
    for (int k = 0; k < 5000; ++k) {
      const Vec3d p = inside.draw(random);
      int wide = 0, deep = 0;
      for (const auto& cell : cells)
        wide += depth_in(cell, p) > -band, deep += depth_in(cell, p) > band;
      nowhere += wide == 0, twice += deep > 1;
    }
    CHECK(nowhere == 0);
    CHECK(twice == 0);
  }
}

TEST_CASE("laguerre_cells: no two cells press on each other by more than 1e-12 of the body") {
  for (const auto& named : bodies())
    for (const std::size_t count : {2, 12, 40}) {
      const auto& body = named.body;
      CAPTURE(named.name);
      CAPTURE(count);
      silt::Random random(23 + count);
      const auto cells = laguerre_cells(body, some_shares(count, 1e-3, random), random);
      CHECK(deepest_contact(cells) <= 1e-12 * diameter(body));
    }
}

TEST_CASE("laguerre_cells: nor do cells of cells, turned and far away, along edges and corners") {
  // Of cells that share an edge alone, area and volume are rounding: their quotient was taken for a
  // thickness, and overlaps came up to the size of the cells.
  silt::Random random(1);
  Random turns(1);
  for (int k = 0; k < 150; ++k) {
    const auto body = turns.hull(14);
    std::vector<Polyhedron> cells;
    for (const auto& cell : laguerre_cells(body, some_shares(6, 0.1, random), random))
      for (auto& part : laguerre_cells(cell, some_shares(4, 0.1, random), random))
        cells.push_back(std::move(part));
    const auto q = silt::random_orientation(random);
    CAPTURE(k);
    CHECK(deepest_contact(cells, q, {10, -3, 7}) <= 1e-11 * diameter(body));
  }
}

TEST_CASE("thickness_overlap: pieces pushed into each other by 1e-11 to 1e-6 of their size") {
  // Their sides are slanted: an overlap of 1e-8 of their width came of rounding, and a gradient of
  // up to 1e9. The overlap of a slab is at most the push along its normal.
  silt::Random random(1);
  const auto cells = laguerre_cells(box({1, 1, 1}), some_shares(12, 0.1, random), random);
  std::vector<silt::PrincipalShape> shapes;
  for (const auto& cell : cells) shapes.push_back(principal_shape(cell));
  for (double push = 1e-11; push < 1e-5; push *= 10) {
    CAPTURE(push);
    int touching = 0;
    double most = 0, steepest = 0;
    for (std::size_t i = 0; i < 12; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        silt::PlacedPolyhedron a{&shapes[i].parts[0], shapes[i].frame};
        const silt::PlacedPolyhedron b{&shapes[j].parts[0], shapes[j].frame};
        const double x = random.normal(), y = random.normal(), z = random.normal();
        a.pose.position += push * normalised(Vec3d{x, y, z});
        silt::NormalMemory<double> memory{{0, 0, 0}, 0, 0};
        const auto contact = touch_solids(a, b, memory);
        if (!(contact.overlap > 0)) continue;
        ++touching;
        most = std::max(most, contact.overlap), steepest = std::max(steepest, contact.gradient);
      }
    CHECK(touching > 10);
    CHECK(most <= push * (1 + 1e-3));
    CHECK(steepest <= 1.1);
  }
}

TEST_CASE("laguerre_cells: cells of cells of a cell fill it as well") {
  Polyhedron body = box({1, 1, 1});
  silt::Random random(2);
  for (int generation = 0; generation < 6; ++generation) {
    CAPTURE(generation);
    const auto cells = laguerre_cells(body, some_shares(10, 1e-2, random), random);
    double sum = 0;
    for (const auto& cell : cells) sum += cell.core_volume();
    CHECK(agree(sum, body.core_volume(), 1e-13));
    CHECK(deepest_contact(cells) <= 1e-12 * diameter(body));
    body = principal_shape(cells[static_cast<std::size_t>(generation)]).parts[0];
  }
}

TEST_CASE("laguerre_cells: one seed gives the same cells, two seeds do not") {
  const auto body = box({1, 2, 1});
  const auto shares = std::vector<double>{0.5, 0.2, 0.2, 0.1};
  silt::Random one(1), again(1), other(2);
  const auto a = laguerre_cells(body, shares, one), b = laguerre_cells(body, shares, again),
             c = laguerre_cells(body, shares, other);
  CHECK(std::equal(a.begin(), a.end(), b.begin()));
  CHECK(!(a[0] == c[0]));
  CHECK(one.state() == again.state());
}

TEST_CASE("laguerre_cells: any unit of length, away from the origin") {
  for (const double size : {1e-6, 1.0, 1e3})
    for (const Vec3d& place : {Vec3d{0, 0, 0}, Vec3d{3, -2, 5}}) {
      CAPTURE(size);
      auto corners = box_corners(size * place, size * (place + Vec3d{1, 2, 1}));
      const auto body = Polyhedron::from_points(corners);
      silt::Random random(4);
      const auto shares = some_shares(12, 1e-2, random);
      const auto cells = laguerre_cells(body, shares, random);
      double worst = 0;
      for (std::size_t k = 0; k < cells.size(); ++k)
        worst = std::max(worst, std::abs(cells[k].core_volume() / body.core_volume() - shares[k]));
      CHECK(worst <= 1e-12);
    }
}

TEST_CASE("laguerre_cells: sites moved to centroids make rounder cells") {
  // A cube has 0.806. Without a move the mean is about 0.77; no weight at all would leave it there.
  double mean[3] = {0, 0, 0}, least = 1;
  for (int moves = 0; moves < 3; ++moves)
    for (int k = 0; k < 4; ++k) {
      silt::Random random(static_cast<std::uint64_t>(31 + k));
      for (const auto& cell :
           laguerre_cells(box({1, 1, 1}), equal(50), random, {.rounding = moves})) {
        mean[moves] += sphericity(cell) / 200;
        if (moves == 2) least = std::min(least, sphericity(cell));
      }
    }
  CAPTURE(mean[0]);
  CAPTURE(mean[1]);
  CAPTURE(mean[2]);
  CAPTURE(least);
  CHECK(mean[0] < mean[1]);
  CHECK(mean[1] < mean[2]);
  CHECK(mean[2] > 0.81);
  CHECK(least > 0.65);
}

TEST_CASE("power_cells: two and three cells of a bar end where their volumes say") {
  const auto body = Polyhedron::from_points(box_corners({0, 0, 0}, {1, 0.5, 0.5}));
  silt::detail::PowerSites sites{{{0.2, 0.25, 0.25}, {0.6, 0.25, 0.25}, {0.9, 0.25, 0.25}},
                                 {0, 0, 0}};
  silt::detail::VolumeWeights fit(body, {0.25 * 0.3, 0.25 * 0.05, 0.25 * 0.65});
  REQUIRE(fit.fit(sites));
  const auto& cells = fit.cells().cells();
  CHECK(norm(cells[0].centroid - Vec3d{0.15, 0.25, 0.25}) <= 1e-13);
  CHECK(norm(cells[1].centroid - Vec3d{0.325, 0.25, 0.25}) <= 1e-13);
  CHECK(norm(cells[2].centroid - Vec3d{0.675, 0.25, 0.25}) <= 1e-13);
  // Planes at 0.3 and 0.35, by (1): |x - s_i|^2 - w_i equal on both sides.
  CHECK(agree(sites.weight[0] - sites.weight[1], 0.01 - 0.09, 1e-11));
  CHECK(agree(sites.weight[1] - sites.weight[2], 0.0625 - 0.3025, 1e-11));
}

TEST_CASE("power_cells: slopes of volumes by weights are areas over distances") {
  silt::Random random(8);
  const auto body = box({1, 1, 1});
  const silt::detail::PointsInside inside(body);
  const std::vector<double> volume(12, 1.0 / 12);
  const auto sites = silt::detail::draw_sites(body, inside, volume, random);
  silt::detail::PowerCells at(body, 12), up(body, 12), down(body, 12);
  REQUIRE(at.measure(sites, 0));
  constexpr double h = 1e-5;  // central differences: h^2 = 1e-10, rounding 1e-16/h
  for (std::size_t j = 0; j < 12; ++j) {
    auto higher = sites, lower = sites;
    higher.weight[j] += h, lower.weight[j] -= h;
    REQUIRE(up.measure(higher, 0));
    REQUIRE(down.measure(lower, 0));
    for (std::size_t i = 0; i < 12; ++i) {
      double slope = 0;
      for (const auto& [k, area] : at.cells()[i].neighbours) {
        const double part = area / (2 * norm(sites.at[k] - sites.at[i]));
        if (i == j) slope += part;
        if (k == j) slope -= part;
      }
      CHECK(std::abs((up.cells()[i].volume - down.cells()[i].volume) / (2 * h) - slope) <= 1e-7);
    }
  }
}

TEST_CASE("power_cells: volumes and areas of voro++ in a box, with weights and without") {
  // Computed with voro++ 0.4.6 (container_poly). Sites and radii: silt::Random(42), in turn.
  struct Known {
    double volume, area;
  };
  const Known voronoi[10] = {
      {0.4964365971108694, 3.8771730282339028},  {0.13479289080922016, 1.7787310268650358},
      {0.45431244961908734, 3.5554603677752374}, {0.54415675290483756, 3.960715634860728},
      {0.19107085020813586, 2.0790102708843312}, {0.17117451354102564, 2.1269406146426828},
      {0.33682591678925294, 3.1241337827595586}, {0.25271456926010777, 2.6903774323719265},
      {0.31272479239859663, 3.2268813206414104}, {0.10579066735886651, 1.799841531880584},
  };
  const Known radical[10] = {
      {0.49239795591178709, 3.8566031556614933}, {0.13842795899718011, 1.8072499556500614},
      {0.45236058829009546, 3.5428665968268382}, {0.52771849614931265, 3.8875576618119503},
      {0.19242067368066695, 2.0861439685335785}, {0.17235488720382253, 2.1446212809380976},
      {0.44295581741523637, 3.551402331828454},  {0.26372066957402851, 2.7589012823110526},
      {0.31006884610170365, 3.2075721083076352}, {0.0075741066761660369, 0.32955406008240895},
  };
  const auto body = Polyhedron::from_points(box_corners({0, 0, 0}, {2, 1, 1.5}));
  silt::Random random(42);
  silt::detail::PowerSites sites;
  for (int k = 0; k < 10; ++k) {
    const double x = 2 * random.uniform(), y = random.uniform(), z = 1.5 * random.uniform(),
                 r = 0.1 + 0.1 * random.uniform();
    sites.at.push_back({x, y, z}), sites.weight.push_back(r * r);
  }
  silt::detail::PowerCells power(body, 10);
  const auto compare = [&](const Known(&known)[10]) {
    REQUIRE(power.measure(sites, 0));
    silt::detail::CellForms forms(10);
    for (std::size_t i = 0; i < 10; ++i) {
      CAPTURE(i);
      CHECK(agree(power.cells()[i].volume, known[i].volume, 1e-11));
      const auto form = forms.form(*power.cut(sites, i), i, true);
      REQUIRE(form.has_value());
      CHECK(agree(form->core_volume(), known[i].volume, 1e-11));
      CHECK(agree(form->core_area(), known[i].area, 1e-11));
      CHECK(norm(mass_properties(*form).centroid - power.cells()[i].centroid) <= 1e-13);
    }
  };
  compare(radical);
  std::fill(sites.weight.begin(), sites.weight.end(), 0.01);
  compare(voronoi);
}

TEST_CASE("power_cells: an empty cell ends the measurement") {
  const auto body = box({1, 1, 1});
  silt::detail::PowerCells power(body, 2);
  const std::vector<Vec3d> at{{-0.1, 0, 0}, {0.1, 0, 0}};
  CHECK(power.measure({at, {0, 0}}, 1e-3));
  CHECK(!power.measure({at, {0.5, 0}}, 0));      // the plane is at x = 1.25
  CHECK(!power.measure({at, {0.19, 0}}, 0.03));  // at 0.475: 0.025 is left
  CHECK(power.measure({at, {0.19, 0}}, 0.02));
}

TEST_CASE("laguerre_cells: short edges are seen, and cost 1e-8 of the volume at most") {
  // Four sites on a square, nearly: between the two across, a face of a width of about `off`.
  const auto body = box({1, 1, 1});
  for (const double off : {0.0, 1e-14, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-3}) {
    CAPTURE(off);
    silt::detail::PowerSites sites{
        {{0.2 + off, 0.2, 0}, {-0.2, 0.2, 0}, {-0.2, -0.2, 0}, {0.2, -0.2, 0}}, {0, 0, 0, 0}};
    silt::detail::PowerCells power(body, 4);
    REQUIRE(power.measure(sites, 0));
    silt::detail::CellForms strict(4), any(4);
    double sum = 0;
    int clean = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      clean += strict.form(*power.cut(sites, i), i, true).has_value();
      sum += any.form(*power.cut(sites, i), i, false)->core_volume();
    }
    CHECK((clean == 4) == (off == 1e-3));
    CHECK(agree(sum, 1, 1e-8));
  }
}

TEST_CASE("laguerre_cells: a body with short edges of its own is cut nevertheless") {
  for (const double cut : {1e-7, 1e-5}) {
    CAPTURE(cut);
    std::vector<Vec3d> corners = box_corners({0, 0, 0}, {1, 1, 1});
    corners[7] = {1, 1, 1 - cut};
    corners.push_back({1, 1 - cut, 1}), corners.push_back({1 - cut, 1, 1});
    const auto body = Polyhedron::from_points(corners);
    REQUIRE(body.vertices().size() == 10);
    silt::Random random(6);
    const auto shares = some_shares(12, 1e-2, random);
    const auto cells = laguerre_cells(body, shares, random);
    double worst = 0, sum = 0;
    for (std::size_t k = 0; k < cells.size(); ++k)
      worst = std::max(worst, std::abs(cells[k].core_volume() / body.core_volume() - shares[k])),
      sum += cells[k].core_volume();
    CHECK(worst <= 1e-8);
    CHECK(agree(sum, body.core_volume(), 1e-8));
  }
}

TEST_CASE("laguerre_cells: one share is the body itself") {
  silt::Random random(1);
  const auto body = box({1, 2, 3});
  const auto cells = laguerre_cells(body, std::vector<double>{1}, random);
  REQUIRE(cells.size() == 1);
  CHECK(cells[0] == body);
}

TEST_CASE("laguerre_cells: what cannot be cut is refused") {
  silt::Random random(1);
  const auto body = box({1, 1, 1});
  const auto cut = [&](const std::vector<double>& shares) { laguerre_cells(body, shares, random); };
  refuses([&] { cut({}); }, "0 shares given; from 1 to 4000");
  refuses([&] { cut(equal(4001)); }, "4001 shares given");
  refuses([&] { cut({0.5, 0, 0.5}); }, "share 1 (counted from 0) is 0 [-]");
  refuses([&] { cut({1.5, -0.5}); }, "share 0 (counted from 0) is 1.5 [-]");
  refuses([&] { cut({0.5, std::numeric_limits<double>::quiet_NaN()}); }, "share 1");
  refuses([&] { cut({0.5, 0.4}); }, "the 2 shares are 0.9 [-] in sum; they must be 1");
  refuses([&] { laguerre_cells(Polyhedron::from_points(body.vertices(), 0.1), equal(2), random); },
          "the body is dilated by 0.1 [m]; only sharp polyhedra");
}

TEST_CASE("solve_definite: a Laplacian and a pivot lost") {
  // 3 unknowns; rows of the lower half alone are given.
  silt::DynArray<double> a{4, 99, 99, -1, 3, 99, -2, -1, 5}, b{1, 2, 3};
  const silt::DynArray<double> full{4, -1, -2, -1, 3, -1, -2, -1, 5}, right = b;
  silt::detail::solve_definite(a, b);
  for (std::size_t i = 0; i < 3; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < 3; ++j) sum += full[3 * i + j] * b[j];
    CHECK(agree(sum, right[i], 1e-15));
  }
  silt::DynArray<double> none{0}, held{3};
  silt::detail::solve_definite(none, held);
  CHECK(held[0] == 0);
}

}  // namespace laguerre_cells_test
