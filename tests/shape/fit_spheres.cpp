// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <silt/shape/fit_spheres.hpp>

namespace fit_spheres_test {

namespace {

using silt::Vec3d;
using Soup = std::vector<std::array<Vec3d, 3>>;

/// A cuboid with its middle at the origin; `flip`: faces inwards.
Soup cuboid(const Vec3d& half, bool flip = false) {
  Soup soup;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](double u, double v) {
        double c[3];
        c[axis] = side, c[(axis + 1) % 3] = side * u, c[(axis + 2) % 3] = v;
        return Vec3d{c[0] * half.x, c[1] * half.y, c[2] * half.z};
      };
      const Vec3d a = corner(-1, -1), b = corner(1, -1), c = corner(1, 1), d = corner(-1, 1);
      soup.push_back(flip ? std::array{a, c, b} : std::array{a, b, c});
      soup.push_back(flip ? std::array{a, d, c} : std::array{a, c, d});
    }
  return soup;
}

/// A ball of radius 1 as triangles, by longitude and latitude.
Soup ball(int n) {
  const auto at = [n](int i, int j) {
    const double a = std::numbers::pi * i / n, b = std::numbers::pi * (j % (2 * n)) / n;
    return Vec3d{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)};
  };
  Soup soup;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      if (i > 0) soup.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < n) soup.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return soup;
}

}  // namespace

TEST_CASE("Mass properties of a mesh are exact") {
  auto soup = cuboid({1, 2, 3});
  for (auto& t : soup)
    for (auto& p : t) p += Vec3d{10, -5, 2};
  const auto m = silt::mass_properties(silt::TriangleMesh(soup));
  CHECK(std::abs(m.volume / 48 - 1) < 1e-13);
  CHECK(norm(m.centroid - Vec3d{10, -5, 2}) < 1e-12);
  CHECK(std::abs(m.inertia.x / (48.0 * (16 + 36) / 12) - 1) < 1e-12);
  CHECK(std::abs(m.inertia.y / (48.0 * (4 + 36) / 12) - 1) < 1e-12);
  CHECK(std::abs(m.inertia.z / (48.0 * (4 + 16) / 12) - 1) < 1e-12);
}

TEST_CASE("One sphere fits a ball") {
  const silt::TriangleMesh mesh(ball(24));
  const auto fit = silt::fit_spheres(mesh, {.spheres = 1});
  REQUIRE(fit.form.balls.size() == 1);
  CHECK(std::abs(fit.volume_error) < 1e-3);
  CHECK(fit.largest_error < 0.046);  // half the diagonal of a cell 0.05 wide, and the facets
  CHECK(std::abs(fit.form.balls[0].radius - 1) < 0.02);
}

TEST_CASE("More spheres fit a cuboid better, at its volume, and say how well") {
  const silt::TriangleMesh mesh(cuboid({2, 1, 1}));
  double last = 1e300;
  for (const std::size_t count : {2u, 10u, 60u}) {
    const auto fit = silt::fit_spheres(mesh, {.spheres = count, .resolution = 30});
    CHECK(fit.form.balls.size() == count);
    CHECK(std::abs(fit.volume_error) < 2e-3);  // of the bisection's 120 lines
    CHECK(fit.surface_error < last);
    CHECK(fit.largest_error >= fit.surface_error);
    last = fit.surface_error;
    // Mass and inertia are those of the mesh, however few the spheres.
    CHECK(std::abs(fit.form.mass_properties().volume - 16) < 1e-12);
  }
  CHECK(last < 0.12);  // of a half side 1; corners stay round
}

TEST_CASE("What cannot be fitted is said") {
  const auto sentence = [](const Soup& soup, silt::SphereFitOptions options) -> std::string {
    try {
      (void)silt::fit_spheres(silt::TriangleMesh(soup), options);
    } catch (const silt::InputError& e) {
      return e.what();
    }
    return "";
  };
  auto open = cuboid({1, 1, 1});
  open.pop_back();
  CHECK(sentence(open, {}).find("not closed") != std::string::npos);
  auto doubled = cuboid({1, 1, 1});
  const auto once = doubled;
  doubled.insert(doubled.end(), once.begin(), once.end());
  CHECK(sentence(doubled, {}).find("fit_spheres: the mesh holds 12 triangles twice") == 0);
  CHECK(sentence(cuboid({1, 1, 1}, true), {}).find("face inwards") != std::string::npos);
  CHECK(sentence(cuboid({1, 1, 1}), {.spheres = 0}).find("spheres = 0") != std::string::npos);
  CHECK(sentence(cuboid({1, 1, 1}), {.resolution = 2}).find("resolution = 2") != std::string::npos);
}

}  // namespace fit_spheres_test
