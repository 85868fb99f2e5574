// silt - BSD-3-Clause, see LICENSE
#include "coupling/averaging_support.hpp"

namespace averaging_bodies_test {

using namespace averaging_test;
using silt::averaged_form;
using silt::AveragedForm;
using silt::MultiSphere;
using silt::Polyhedron;
using silt::SuperEllipsoid;

namespace {

Polyhedron brick(double a, double b, double c, double radius = 0) {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return Polyhedron::from_points(corners, radius);
}

std::vector<AveragedForm> forms() {
  return {averaged_form(SuperEllipsoid{2, 1, 0.7}, 50),
          averaged_form(SuperEllipsoid{1, 1, 3, 8, 2}, 50), averaged_form(brick(1, 2, 0.5), 50),
          averaged_form(MultiSphere{{{{-1, 0, 0}, 1}, {{1, 0, 0}, 1}}}, 50),
          averaged_form(silt::Sphere{}, 50)};
}

Cloud bodies_in(const Box& box, std::size_t n, double d, std::uint64_t seed) {
  Cloud cloud = random_cloud(box, n, d, seed);
  silt::Random random(seed + 1);
  cloud.forms = forms();
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3d axis =
        silt::normalised({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)});
    cloud.orientation.push_back(silt::rotation_about(axis, random.uniform(0, 3)));
    cloud.form.push_back(static_cast<std::uint32_t>(random.index(cloud.forms.size())));
  }
  return cloud;
}

}  // namespace

TEST_CASE("body forms: points fill the body, their second moments are its own") {
  // Mean of x^2 of an ellipsoid a^2/5, of a brick a^2/3; points err by what counting them does,
  // some N^(-2/3) (0.004) of each term at the surface.
  const auto moments = [](const AveragedForm& form) {
    Vec3d sum{0, 0, 0}, mean{0, 0, 0};
    for (const Vec3d& x : form.points) sum += Vec3d{x.x * x.x, x.y * x.y, x.z * x.z}, mean += x;
    CHECK(silt::norm(mean) <= 1e-12 * static_cast<double>(form.points.size()));
    return sum * (1.0 / static_cast<double>(form.points.size()));
  };
  const double r = std::cbrt(2.0 * 1 * 0.7);
  const Vec3d e = moments(averaged_form(SuperEllipsoid{2, 1, 0.7}, 4000));
  CHECK(near_relative(e.x, 4 / (5 * r * r), 0.01));
  CHECK(near_relative(e.y, 1 / (5 * r * r), 0.01));
  CHECK(near_relative(e.z, 0.49 / (5 * r * r), 0.01));
  // Principal axes of the brick are those of its points, in some order.
  const AveragedForm of = averaged_form(brick(1, 2, 0.5), 4000);
  const double R = std::cbrt(0.75 * 8 / std::numbers::pi);
  const Vec3d b = moments(of);
  double found[3] = {b.x, b.y, b.z};
  std::sort(found, found + 3);
  CHECK(near_relative(found[0], 0.25 / (3 * R * R), 0.015));
  CHECK(near_relative(found[1], 1 / (3 * R * R), 0.015));
  CHECK(near_relative(found[2], 4 / (3 * R * R), 0.015));
  // The ellipsoid of equal moments has a brick's proportions, and the body's volume.
  const Vec3d& a = of.axes;
  CHECK(near_relative(a.x * a.y * a.z, 1, 1e-12));
  CHECK(near_relative(std::max({a.x, a.y, a.z}) / std::min({a.x, a.y, a.z}), 4, 1e-9));
  // Two balls that touch, centres at -1 and 1: (1 + 1/5, 1/5, 1/5). Balls moved twice had 4.2.
  const Vec3d two = moments(averaged_form(MultiSphere{{{{-1, 0, 0}, 1}, {{1, 0, 0}, 1}}}, 4000));
  CHECK(near_relative(std::max({two.x, two.y, two.z}), 1.2 / std::cbrt(4.0), 0.01));
  CHECK(near_relative(two.x + two.y + two.z, 1.6 / std::cbrt(4.0), 0.01));
  // A rounded brick reaches out by its radius.
  const AveragedForm round = averaged_form(brick(1, 1, 1, 0.5), 2000);
  double farthest = 0;
  for (const Vec3d& x : round.points) farthest = std::max({farthest, x.x, x.y, x.z});
  const double rr = brick(1, 1, 1, 0.5).equal_volume_radius();
  CHECK(farthest > 1.4 / rr);
  CHECK(farthest < 1.52 / rr);
  CHECK(averaged_form(silt::Sphere{}).sphere);
  CHECK(averaged_form(brick(1, 1, 1)).sphere);  // a cube's moments are a sphere's
  CHECK_FALSE(averaged_form(SuperEllipsoid{1, 1, 1, 8, 8}).sphere);
  // Every kind of shape has a form: a compound, octants, one of a mix.
  const SuperEllipsoid rod{3, 1, 1};
  const silt::Compound<SuperEllipsoid> one{.parts = {{rod, {}, {}}}};
  const silt::PolySuperEllipsoid egg{.plus = {2, 1, 1}, .minus = {1, 1, 1}};
  const auto elongation = [](const AveragedForm& form) {
    const Vec3d& x = form.axes;
    return std::max({x.x, x.y, x.z}) / std::min({x.x, x.y, x.z});
  };
  CHECK(near_relative(elongation(averaged_form(rod)), 3, 1e-12));
  CHECK(near_relative(elongation(averaged_form(one)), 3, 1e-9));
  // Of the egg: <x^2> - <x>^2 = 3/5 - (3/8)^2 along, 1/5 across.
  CHECK(near_relative(elongation(averaged_form(egg)), std::sqrt((0.6 - 0.140625) / 0.2), 1e-6));
  CHECK(averaged_form(silt::Mix<silt::Sphere, SuperEllipsoid>(silt::Sphere{})).sphere);
  CHECK(says(refusal([] { averaged_form(silt::Sphere{}, 0); }), "0 interior points"));
}

TEST_CASE("averaging of bodies: volume, adjointness and constants to rounding in every mode") {
  for (const Room& room : rooms())
    for_modes(true, [&](const char* name, const auto& mode) {
      CAPTURE(room.name);
      CAPTURE(name);
      typename std::decay_t<decltype(mode)>::Averaging op(mode, room.grid, 1);
      furnish(op, room);
      const Cloud cloud = bodies_in(room.grid.box(), 40, 1, 4);
      op.place(cloud.seen());
      CHECK(op.report().outside == 0);
      const Columns q{cloud.volumes()};
      const std::vector<CellField> f{random_field(room.grid, 10), CellField(room.grid, 3.25)};
      const CellField solids = spread(op, q)[0];
      CHECK(near_relative(silt::total(solids), sum_of(q[0]), 1e-13));
      const Columns seen = gather(op, f, 40);
      double on_particles = 0;
      for (std::size_t p = 0; p < 40; ++p) on_particles += q[0][p] * seen[0][p];
      CHECK(std::abs(dot(solids, f[0]) - on_particles) <= 1e-13 * sum_of(q[0]));
      for (const double v : seen[1]) CHECK(near_relative(v, 3.25, 1e-13));
    });
}

TEST_CASE(
    "averaging of bodies: the enlarged kernel is as elongated as the body, and turns with it") {
  const Grid grid({{0, 0, 0}, {20, 20, 20}}, {40, 40, 40});
  Cloud one;
  one.position = {{10.15, 10, 9.8}};
  one.radius = {0.5};
  one.forms = {averaged_form(SuperEllipsoid{2, 1, 1})};
  const double tilt = 0.6;
  one.orientation = {silt::rotation_about({0, 0, 1}, tilt)};
  for (const Kernel::Form form : {Kernel::Form::Compact, Kernel::Form::Gaussian}) {
    Kernel::Averaging op({form}, grid, 1);
    op.place(one.seen());
    const CellField w = spread(op, {{1}})[0];
    double xx = 0, yy = 0, zz = 0, xy = 0;
    Vec3d mean{0, 0, 0};
    for (int k = 0; k < 40; ++k)
      for (int j = 0; j < 40; ++j)
        for (int i = 0; i < 40; ++i) {
          const Vec3d x = grid.centre(i, j, k) - one.position[0];
          xx += w(i, j, k) * x.x * x.x, yy += w(i, j, k) * x.y * x.y;
          zz += w(i, j, k) * x.z * x.z, xy += w(i, j, k) * x.x * x.y;
          mean += x * w(i, j, k);
        }
    // In the body's axes: variances 4 : 1 : 1, no mixed one; sampled every 0.5, at least 9 across.
    const double c = std::cos(tilt), s = std::sin(tilt);
    const double along = c * c * xx + 2 * c * s * xy + s * s * yy;
    const double across = s * s * xx - 2 * c * s * xy + c * c * yy;
    const double mixed = c * s * (yy - xx) + (c * c - s * s) * xy;
    CHECK(silt::norm(mean) <= 1e-3);
    CHECK(near_relative(along / across, 4, 0.003));
    CHECK(near_relative(zz / across, 1, 0.003));
    CHECK(std::abs(mixed) <= 0.003 * across);
  }
}

TEST_CASE(
    "averaging of bodies: satellites see the orientation, spheres among bodies their kernel") {
  // A rod along x is in three cells of a row, along z in three of a column.
  const Grid grid({{0, 0, 0}, {5, 5, 5}}, {5, 5, 5});
  Cloud one;
  one.position = {grid.centre(2, 2, 2)};
  one.forms = {averaged_form(SuperEllipsoid{1.4, 0.2, 0.2}, 200)};
  one.radius = {SuperEllipsoid{1.4, 0.2, 0.2}.equal_volume_radius()};
  Unresolved::Averaging op({Unresolved::Share::Satellites}, grid, 1);
  for (const double angle : {0.0, 0.5 * std::numbers::pi}) {
    one.orientation = {silt::rotation_about({0, 1, 0}, angle)};
    op.place(one.seen());
    const CellField w = spread(op, {{1}})[0];
    const double row = w(1, 2, 2) + w(3, 2, 2), column = w(2, 2, 1) + w(2, 2, 3);
    // Of an ellipsoid of semi-axis 1.4 beyond 0.5: 1 - (3 t - t^3)/2 of t = 0.5/1.4 in both.
    const double t = 0.5 / 1.4, beyond = 1 - 0.5 * t * (3 - t * t);
    CHECK(std::abs((angle > 0 ? column : row) - beyond) <= 0.02);
    CHECK((angle > 0 ? row : column) == 0);
  }
  Cloud balls = random_cloud(grid.box(), 20, 1, 3), same = balls;
  same.forms = forms();
  same.form.assign(20, 4);
  same.orientation.assign(20, {});
  Kernel::Averaging a({}, grid, 1), b({}, grid, 1);
  a.place(balls.seen()), b.place(same.seen());
  const CellField fa = spread(a, {balls.radius})[0], fb = spread(b, {balls.radius})[0];
  for (int i = 0; i < 5; ++i) CHECK(fa(i, 2, 3) == fb(i, 2, 3));

  Unresolved::Averaging exact({}, grid, 1);
  CHECK(says(refusal([&] { exact.place(same.seen()); }), "Share::Exact is for spheres only"));
  same.form[3] = 7;
  CHECK(says(refusal([&] { a.place(same.seen()); }), "form 7 of particle 3"));
  same.form.clear(), same.orientation.clear();
  CHECK(says(refusal([&] { a.place(same.seen()); }), "0 orientations for 20 bodies"));
}

}  // namespace averaging_bodies_test
