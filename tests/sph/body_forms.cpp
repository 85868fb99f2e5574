// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <silt/shape/mix.hpp>
#include <silt/sph/body_form.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace sph_body_forms_test {

using namespace silt;
using detail::BodySites;
using detail::LiquidForm;
using silt_test::has;
using silt_test::refusal;

namespace {

Polyhedron brick(double a, double b, double c) {  // half lengths
  std::vector<Vec3d> corners;
  for (const double x : {-a, a})
    for (const double y : {-b, b})
      for (const double z : {-c, c}) corners.push_back({x, y, z});
  return Polyhedron::from_points(corners);
}
SphSetup lattice(double spacing, int dimensions = 3) {
  return {.spacing = spacing,
          .region = {{0, 0, 0}, {1, 1, 1}},
          .smoothing = 1,
          .dimensions = dimensions};
}

}  // namespace

TEST_CASE("SPH bodies: a brick of whole spacings is a lattice, mirrored at its faces") {
  const LiquidForm form(brick(0.5, 0.4, 0.3));
  const BodySites of = form.lay(lattice(0.1), 1);
  CHECK(of.sites.size() == 10 * 8 * 6);  // the kernel reaches 3.5 spacings: to the middle
  CHECK(of.share == near(1).epsilon(1e-9));
  int faces = 0;  // particles that are far from edges
  for (const auto& site : of.sites) {
    const Vec3d in{std::abs(site.at.x), std::abs(site.at.y), std::abs(site.at.z)};
    std::array<double, 3> depths{0.5 - in.x, 0.4 - in.y, 0.3 - in.z};
    std::sort(depths.begin(), depths.end());
    const double way = norm(site.ghost - site.at), reach = 1.3 * lattice(0.1).h();
    if (depths[1] > depths[0] + reach && in.z > reach) {
      ++faces;
      CHECK(near_relative(way, 2 * depths[0], 1e-9));
    }
    CHECK(way >= 2 * depths[0] * (1 - 1e-9));
    CHECK(way <= 3.6 * depths[0]);
    CHECK_FALSE(form.contains(site.ghost));
  }
  CHECK(faces == 16);
  // Twice as large: the same as with half the spacing.
  const BodySites twice = form.lay(lattice(0.2), 2);
  CHECK(twice.sites.size() == of.sites.size());
  CHECK(norm(twice.sites[7].at - 2 * of.sites[7].at) < 1e-12);
}

// Points on the diagonals of a square are as near to one face as to another. Catches images behind
// the face that rounding chooses: in still water such a block turned by 15 degrees in 0.8 s.
TEST_CASE("SPH bodies: points of a square block and their images are symmetric") {
  const BodySites of = LiquidForm(brick(0.4, 0.4, 0.24)).lay(lattice(0.1), 1);
  CHECK(of.sites.size() == 8 * 8 * 5);
  const auto mirrored = [](Vec3d v, bool across) {
    (across ? v.y : v.x) *= -1;
    return v;
  };
  for (const auto& one : of.sites)
    for (const bool across : {false, true}) {
      const Vec3d at = mirrored(one.at, across), ghost = mirrored(one.ghost, across);
      CHECK(std::count_if(of.sites.begin(), of.sites.end(), [&](const auto& other) {
              return norm(other.at - at) < 1e-12 && norm(other.ghost - ghost) < 1e-12;
            }) == 1);
    }
}

TEST_CASE("SPH bodies: of any shape the particles have the body's volume, and lie in it") {
  const auto check = [](const auto& shape, double outermost) {
    const LiquidForm form(shape);
    const BodySites of = form.lay(lattice(0.1), 1);
    // All of the lattice has the volume; all lie within the kernel's reach here.
    CHECK(of.share * static_cast<double>(of.sites.size()) * 1e-3 ==
          near(shape.mass_properties().volume).epsilon(1e-9));
    CHECK(of.share > 0.8);  // 6 particles across, of which whole ones count at rounded corners
    CHECK(of.share < 1.1);
    double farthest = 0;
    for (const auto& site : of.sites) {
      CHECK(form.contains(site.at));
      CHECK_FALSE(form.contains(site.ghost + 1e-3 * (site.ghost - site.at)));
      farthest = std::max(farthest, norm(site.at));
    }
    CHECK(farthest < outermost);
    CHECK(farthest > outermost - 0.1);
  };
  check(SuperEllipsoid{0.5, 0.35, 0.3}, 0.5);
  check(SuperEllipsoid{0.3, 0.3, 0.3, 8, 8}, 0.45);
  check(MultiSphere{{{{-0.2, 0, 0}, 0.3}, {{0.2, 0, 0}, 0.3}}}, 0.5);
  check(PolySuperEllipsoid{.plus = {0.5, 0.3, 0.3}, .minus = {0.3, 0.3, 0.3}}, 0.45);
  check(brick(0.3, 0.3, 0.3), 0.52);
  check(Mix<Sphere, SuperEllipsoid>(SuperEllipsoid{0.5, 0.35, 0.3}), 0.5);
}

TEST_CASE("SPH bodies: mirror images in the notch of a dumb-bell lie outside of both balls") {
  // Over the surface of the nearer ball alone some would lie in the other.
  const LiquidForm form(MultiSphere{{{{-0.35, 0, 0}, 0.4}, {{0.35, 0, 0}, 0.4}}});
  for (const auto& site : form.lay(lattice(0.1), 1).sites)
    for (const double x : {-0.35, 0.35}) CHECK(norm(site.ghost - Vec3d{x, 0, 0}) > 0.4 - 1e-3);
}

TEST_CASE("SPH bodies: what a lattice cannot show is refused") {
  CHECK(has(refusal([] { LiquidForm(brick(0.5, 0.4, 0.05)).lay(lattice(0.1), 1); }),
            "is too thin for a spacing of 0.1 m"));
  CHECK(has(refusal([] { LiquidForm(brick(0.5, 0.2, 0.5)).lay(lattice(0.1, 2), 1); }),
            "a body must be a prism along y and 1 m long; one is 0.4 m long"));
  CHECK(LiquidForm(brick(0.3, 0.5, 0.2)).lay(lattice(0.1, 2), 1).sites.size() == 24);
}

}  // namespace sph_body_forms_test
