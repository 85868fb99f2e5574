// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <silt/boundary/triangle_mesh.hpp>
#include <silt/fill/packing.hpp>

#include "near.hpp"

namespace packing_test {

using silt::Arrangement;
using silt::Box;
using silt::CylinderRegion;
using silt::FillRequest;
using silt::FillResult;
using silt::PlacedSphere;
using silt::SizeDistribution;

namespace {

/// A user's own region: a ball.
struct BallRegion {
  silt::Vec3d centre;
  double radius;
  Box bounds() const { return Box{centre, centre}.grown(radius); }
  double volume() const { return silt::sphere_volume(radius); }
  bool fits(const silt::Vec3d& p, double r) const { return norm(p - centre) <= radius - r; }
  std::string describe() const { return silt::text("the ball at ", centre, " m"); }
};
static_assert(silt::Region<BallRegion>);

double solid_volume(const std::vector<PlacedSphere>& spheres) {
  double sum = 0;
  for (const auto& s : spheres) sum += silt::sphere_volume(s.radius);
  return sum;
}

/// Smallest distance between two surfaces, among `spheres` and between them and `already`.
double least_gap(const std::vector<PlacedSphere>& spheres,
                 const std::vector<PlacedSphere>& already = {}) {
  double least = std::numeric_limits<double>::infinity();
  const auto gap = [](const PlacedSphere& a, const PlacedSphere& b) {
    return norm(a.position - b.position) - a.radius - b.radius;
  };
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, gap(spheres[i], spheres[j]));
    for (const auto& other : already) least = std::min(least, gap(spheres[i], other));
  }
  return least;
}

bool same(const std::vector<PlacedSphere>& a, const std::vector<PlacedSphere>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.position == q.position && p.radius == q.radius;
  });
}

const std::vector<std::pair<const char*, SizeDistribution>>& distributions() {
  static const std::vector<std::pair<const char*, SizeDistribution>> all{
      {"one size", 1e-3},
      {"uniform", silt::uniform(0.8e-3, 1.2e-3)},
      {"normal", silt::normal(1e-3, 0.2e-3, 0.5e-3, 1.5e-3)},
      {"log_normal 1:20", silt::log_normal(0.4e-3, 1.8, 0.1e-3, 2e-3)},
      {"table", silt::table({{0.5e-3, 0.5}, {1.5e-3, 0.5}}, silt::By::Mass)}};
  return all;
}

template <class R>
void check_placement(const R& region, std::size_t count, const std::vector<PlacedSphere>& already) {
  const auto& place = silt::region_of(region);
  for (const auto& distribution : distributions())
    for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random}) {
      const auto& sizes = distribution.second;
      CAPTURE(distribution.first);
      CAPTURE(place.describe());
      CAPTURE(static_cast<int>(arrangement));
      const double gap = 0.05e-3;
      const FillRequest request{
          .radius = sizes, .count = count, .arrangement = arrangement, .gap = gap, .seed = 3};
      const auto result = silt::pack(region, request, already);
      CAPTURE(result.why_not_more);
      CHECK(result.spheres.size() == count);
      CHECK(result.requested == count);
      CHECK(result.why_not_more.empty());
      // positions of order 0.1 m: rounding of 1e-16 m, far below the gap
      CHECK(least_gap(result.spheres, already) >= gap - 1e-15);
      CHECK(std::all_of(result.spheres.begin(), result.spheres.end(), [&](const auto& s) {
        return place.fits(s.position, s.radius) && s.radius >= sizes.min() &&
               s.radius <= sizes.max();
      }));
    }
}

/// Some spheres of mixed sizes in the way, in a row through `from` and `to`.
std::vector<PlacedSphere> row_of_spheres(const silt::Vec3d& from, const silt::Vec3d& to) {
  std::vector<PlacedSphere> row;
  for (int i = 0; i <= 10; ++i)
    row.push_back({from + (to - from) * (i / 10.0), i % 2 ? 5e-3 : 0.3e-3});
  return row;
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const silt::InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

bool has(const std::string& sentence, const std::string& words) {
  return sentence.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE(
    "packing: 2000 spheres neither overlap, nor leave the box, nor meet those already there") {
  const Box box{{0.01, -0.02, 0.1}, {0.06, 0.03, 0.2}};
  check_placement(box, 2000, row_of_spheres({0.02, 0, 0.11}, {0.05, 0.01, 0.19}));
}

TEST_CASE("packing: 2000 spheres fit into an oblique cylinder around spheres already there") {
  const CylinderRegion cylinder{.from = {0, 0, 0}, .to = {0.06, 0.03, 0.1}, .radius = 0.03};
  check_placement(cylinder, 2000, row_of_spheres({0, 0, 0}, {0.06, 0.03, 0.1}));
}

TEST_CASE("packing: 2000 spheres fit into a region of the user's own") {
  check_placement(BallRegion{{0, 0.1, 0}, 0.05}, 2000,
                  row_of_spheres({-0.05, 0.1, 0}, {0.05, 0.1, 0}));
}

TEST_CASE(
    "packing: 2000 spheres fit into a tetrahedron of triangles around spheres already there") {
  const silt::Vec3d a{0, 0, 0}, b{0.15, 0, 0}, c{0, 0.15, 0}, d{0, 0, 0.15};
  const silt::TriangleMesh mesh({{a, c, b}, {a, b, d}, {a, d, c}, {b, c, d}});
  check_placement(silt::MeshRegion(mesh), 2000, row_of_spheres(a, {0.05, 0.05, 0.05}));
}

TEST_CASE("packing: a slender oblique cylinder is filled although it fills 1 % of its bounds") {
  const CylinderRegion pipe{.from = {0, 0, 0}, .to = {0.3, 0.3, 0.3}, .radius = 0.01};
  for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random}) {
    const auto result = silt::pack(
        pipe, {.radius = silt::uniform(0.9e-3, 1.1e-3), .count = 3000, .arrangement = arrangement});
    CHECK(result.spheres.size() == 3000);
    CHECK(least_gap(result.spheres) >= -1e-15);
  }
}

TEST_CASE("packing: the same seed places the same spheres, another seed others") {
  const Box box{{0, 0, 0}, {0.03, 0.03, 0.03}};
  for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random}) {
    FillRequest request{
        .radius = silt::uniform(0.9e-3, 1.1e-3), .count = 500, .arrangement = arrangement};
    const auto first = silt::pack(box, request), second = silt::pack(box, request);
    CHECK(same(first.spheres, second.spheres));
    request.seed = 2;
    CHECK_FALSE(same(first.spheres, silt::pack(box, request).spheres));
  }
}

TEST_CASE("packing: as many as fit reach the solid fractions that the documentation states") {
  const Box box{{0, 0, 0}, {30, 30, 30}};  // one diameter is 1
  const auto fraction = [&](Arrangement arrangement) {
    const auto result = silt::pack(box, {.radius = 0.5, .arrangement = arrangement});
    CHECK(result.why_not_more.empty());
    CHECK(result.requested == result.spheres.size());
    return solid_volume(result.spheres) / box.volume();
  };
  CHECK(fraction(Arrangement::Lattice) == near(0.591).epsilon(0.005));  // fixed by geometry
  CHECK(fraction(Arrangement::Random) == near(0.31).epsilon(0.03));     // by chance: +-3 %
}

TEST_CASE("packing: a wide distribution is placed at a solid fraction of 0.45 by Random") {
  const Box box{{0, 0, 0}, {10, 10, 10}};
  const auto result = silt::pack(box, {.radius = silt::log_normal(0.2, 1.8, 0.05, 1.0),
                                       .solid_volume = 450,
                                       .arrangement = Arrangement::Random});
  CHECK(result.why_not_more.empty());
  CHECK(least_gap(result.spheres) >= -1e-14);
  CHECK(solid_volume(result.spheres) == near(450).epsilon(0.01));
}

TEST_CASE("packing: a solid volume is met to half of the largest sphere") {
  const Box box{{0, 0, 0}, {0.1, 0.1, 0.1}};
  const auto sizes = silt::uniform(1e-3, 2e-3);
  for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random})
    for (const double wanted : {1e-7, 1.234e-5, 1e-4}) {
      const auto result =
          silt::pack(box, {.radius = sizes, .solid_volume = wanted, .arrangement = arrangement});
      CHECK(result.why_not_more.empty());
      CHECK(std::abs(solid_volume(result.spheres) - wanted) <= silt::sphere_volume(2e-3) / 2);
    }
}

TEST_CASE("packing: the lattice fills from below, with sizes in random order") {
  const Box box{{0, 0, 0}, {0.04, 0.04, 1}};
  const auto result = silt::pack(box, {.radius = silt::uniform(0.5e-3, 1e-3), .count = 2000});
  double top = 0, mean_first = 0, mean_last = 0;
  for (std::size_t i = 0; i < 2000; ++i) {
    top = std::max(top, result.spheres[i].position.z);
    (i < 1000 ? mean_first : mean_last) += result.spheres[i].radius / 1000;
  }
  // spacing 2.1 mm: at least 18 x 20 spheres a layer, so 6 layers 1.71 mm apart
  CHECK(top < 0.012);
  // standard error of the difference of two means of 1000: 0.144e-3 sqrt(2 / 1000)
  CHECK(std::abs(mean_first - mean_last) < 4 * 0.144e-3 * std::sqrt(2.0 / 1000));
}

TEST_CASE("packing: the lattice turns so that a layer of one diameter is a full triangular layer") {
  const double d = 1;
  for (const auto& extent : {silt::Vec3d{d, 30, 30}, {30, d, 30}, {30, 30, d}}) {
    const auto result = silt::pack(Box{{0, 0, 0}, extent}, {.radius = d / 2});
    CAPTURE(extent.x);
    CAPTURE(extent.y);
    // 28 to a row, 32 rows 0.909 apart, every other row one less
    CHECK(result.spheres.size() >= 32 * 27);
    CHECK(least_gap(result.spheres) >= -1e-14);
  }
  const auto column = silt::pack(Box{{0, 0, 0}, {d, d, 30}}, {.radius = d / 2});
  CHECK(column.spheres.size() == 28);
}

TEST_CASE("packing: what does not fit is reported with how many, where and why") {
  const Box box{{0, 0, 0}, {0.02, 0.02, 0.02}};
  for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random}) {
    const auto result =
        silt::pack(box, {.radius = 1e-3, .count = 5000, .arrangement = arrangement, .trials = 500});
    CAPTURE(result.why_not_more);
    CHECK(result.spheres.size() > 400);
    CHECK(result.spheres.size() < 5000);
    CHECK(result.requested == 5000);
    CHECK(least_gap(result.spheres) >= -1e-16);
    CHECK(has(result.why_not_more, silt::text(result.spheres.size(),
                                              " of 5000 spheres fitted into the box from (0, 0, 0) "
                                              "to (0.02, 0.02, 0.02) m (solid fraction 0.")));
    CHECK(has(result.why_not_more,
              arrangement == Arrangement::Random
                  ? "500 trials in a row found no free place for the radius 0.001"
                  : "no more free sites, which are 0.0021 [m] apart"));
    CHECK(has(result.why_not_more, "ask for fewer, use a larger region"));
  }
}

TEST_CASE("packing: more solid volume than the region has is reported, not tried") {
  const Box box{{0, 0, 0}, {0.02, 0.02, 0.02}};
  const double one = silt::sphere_volume(1e-3);
  for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random}) {
    const auto result =
        silt::pack(box, {.radius = 1e-3, .solid_volume = 1e12 * one, .arrangement = arrangement});
    CHECK(result.requested == 1000000000000);
    CHECK(has(result.why_not_more, "of 1000000000000 spheres fitted"));
  }
}

TEST_CASE("packing: a sphere wider than the region is reported as such") {
  const Box slit{{0, 0, 0}, {1, 1, 0.01}};
  for (const auto arrangement : {Arrangement::Lattice, Arrangement::Random}) {
    const auto result =
        silt::pack(slit, {.radius = 0.006, .count = 3, .arrangement = arrangement, .trials = 10});
    const auto as_many_as_fit =
        silt::pack(slit, {.radius = 0.006, .arrangement = arrangement, .trials = 10});
    CHECK(has(as_many_as_fit.why_not_more, "0 of 1 spheres fitted"));
    CHECK(result.spheres.empty());
    CHECK(has(result.why_not_more, "0 of 3 spheres fitted"));
    CHECK(has(result.why_not_more,
              "of diameter 0.012 [m], is wider than its bounds of (1, 1, 0.01)"));
  }
}

TEST_CASE("packing: requests that make no sense are refused by name") {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  const auto says = [&](const auto& region, const FillRequest& request, const std::string& words,
                        const std::vector<PlacedSphere>& already = {}) {
    const auto sentence = refusal([&] { silt::pack(region, request, already); });
    CAPTURE(sentence);
    CAPTURE(words);
    CHECK(has(sentence, words));
  };
  says(box, {.radius = 0.1, .count = 5, .solid_volume = 0.1},
       "FillRequest.count = 5 and FillRequest.solid_volume = 0.1 [m3] are both given");
  // In mm: before it had drawn them all, memory ran out after minutes.
  says(silt::Box{{0, 0, 0}, {100, 100, 200}}, {.radius = 1e-3},
       "FillRequest: its region of 2e+06 m3 has the volume of 4.77465e+14 spheres");
  says(box, {.radius = 0.1, .gap = -1}, "FillRequest.gap = -1 [m]");
  says(box, {.radius = 0.1, .count = static_cast<std::size_t>(-5)},
       "is a negative number that was converted");
  says(box, {.radius = 0.1, .count = 0},
       "FillRequest.count = 0 [-] must be at least 1; leave it out for as many as fit");
  says(box, {.radius = 0.1, .solid_volume = not_a_number}, "FillRequest.solid_volume = nan [m3]");
  says(box, {.radius = 0.1, .solid_volume = 1e-9}, "is less than the smallest sphere");
  says(box, {.radius = 0.1, .trials = 0}, "FillRequest.trials = 0 [-]");
  says(Box{{0, 0, 0}, {1, 0, 1}}, {.radius = 0.1},
       "cannot fill the box from (0, 0, 0) to (1, 0, 1) m");
  says(Box{{0, 0, 0}, {1, 1, not_a_number}}, {.radius = 0.1}, "cannot fill the box");
  says(CylinderRegion{{0, 0, 0}, {0, 0, 1}, -1}, {.radius = 0.1}, "of radius -1 m");
  says(CylinderRegion{{0, 0, 1}, {0, 0, 1}, 1}, {.radius = 0.1},
       "cannot fill the cylinder from (0, 0, 1) to (0, 0, 1) m");
  says(box, {.radius = 0.1}, "a sphere of radius -1 [m] at (0, 0, 0) [m]", {{{0, 0, 0}, -1}});
  says(box, {.radius = 0.1}, "a sphere of radius 1 [m] at (nan, 0, 0) [m]",
       {{{not_a_number, 0, 0}, 1}});
}

TEST_CASE("packing: a request without a radius is refused") {
  CHECK(refusal([] {
          silt::pack(Box{{0, 0, 0}, {1, 1, 1}}, FillRequest{.count = 3});
        }).find("FillRequest.radius is not given: spheres have no size of their own") == 0);
}

TEST_CASE("packing: try_place fills an inlet until no place is left, around what is there") {
  const CylinderRegion inlet{.from = {0, 0, 0.1}, .to = {0, 0, 0.12}, .radius = 0.02};
  silt::SphereGrid grid;
  std::vector<PlacedSphere> there{{{0, 0, 0.11}, 5e-3}}, placed;
  for (const auto& s : there) grid.insert(s);
  silt::Random random(4);
  for (;;) {
    const double radius = random.uniform(1e-3, 2e-3);
    const auto centre =
        silt::try_place(inlet, grid, {.radius = radius, .gap = 1e-4, .trials = 200}, random);
    if (!centre) break;
    placed.push_back({*centre, radius});
    grid.insert(placed.back());
  }
  CHECK(placed.size() > 100);
  CHECK(least_gap(placed, there) >= 1e-4 - 1e-16);
  for (const auto& s : placed) CHECK(inlet.fits(s.position, s.radius));
  CHECK(has(refusal([&] { silt::try_place(inlet, grid, {.radius = 0}, random); }),
            "Placement.radius = 0 [m]"));
}

TEST_CASE("packing: a sphere grid finds the same free places as brute force at sizes 1:1000") {
  silt::Random random(6);
  const auto point = [&] {
    silt::Vec3d p;
    p.x = random.uniform(-1, 1), p.y = random.uniform(-1, 1), p.z = random.uniform(-1, 1);
    return p;
  };
  silt::SphereGrid grid;
  std::vector<PlacedSphere> spheres;
  for (int i = 0; i < 2000; ++i) {
    spheres.push_back({point(), std::pow(10.0, random.uniform(-4, -1))});
    grid.insert(spheres.back());
  }
  int free_places = 0, different = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto p = point();
    const double radius = std::pow(10.0, random.uniform(-4, -1)), gap = random.uniform(0, 0.02);
    const bool is_free = std::all_of(spheres.begin(), spheres.end(), [&](const auto& s) {
      return norm(s.position - p) >= s.radius + radius + gap;
    });
    free_places += is_free;
    different += is_free != grid.is_free(p, radius, gap);
  }
  CHECK(free_places > 500);
  CHECK(free_places < 4500);
  CHECK(different == 0);
}

}  // namespace packing_test
