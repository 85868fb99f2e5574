// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/fill/bodies.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>

#include "near.hpp"

namespace compound_test {

namespace {

using silt::Compound;
using silt::Polyhedron;
using silt::SuperEllipsoid;
using silt::Vec3d;

Polyhedron block(double a, double b, double c) {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return Polyhedron::from_points(corners);
}

template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const silt::InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace

TEST_CASE("compound: an angle of two blocks that overlap has the mass of their union") {
  // Legs of 4 x 1 and 1 x 4, both with the 1 x 1 corner; 2 deep.
  const Compound<Polyhedron> angle{
      .parts = {{block(2, 0.5, 1), {2, 0.5, 0}}, {block(0.5, 2, 1), {0.5, 2, 0}}}};
  const auto mass = angle.mass_properties();
  // As the 4 x 1 leg and a 1 x 3 one above the corner.
  const double volume = 2 * (4 + 3), x = 2 * (4 * 2 + 3 * 0.5) / volume;
  // As compound.hpp says; 2.5e-4 seen.
  CHECK(near_relative(mass.volume, volume, 1e-3));
  CHECK(norm(mass.centroid - Vec3d{x, x, 0}) < 2e-3);
}

TEST_CASE("compound: the dilation of a part counts") {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 0.5 : -0.5, k & 4 ? 0.7 : -0.7});
  const auto round = Polyhedron::from_points(corners, 0.4);
  const Compound<Polyhedron> one{.parts = {{round}, {block(0.3, 0.3, 0.3)}}};  // the second inside
  const auto mass = one.mass_properties(), alone = round.mass_properties();
  CHECK(near_relative(mass.volume, alone.volume, 1e-3));
  const auto sum = [](const Vec3d& v) { return v.x + v.y + v.z; };
  CHECK(near_relative(sum(mass.inertia), sum(alone.inertia), 1e-3));
}

TEST_CASE("compound: two ellipsoids with equal axes are two spheres") {
  const SuperEllipsoid ball{1, 1, 1};
  const Compound<SuperEllipsoid> two{.parts = {{ball, {-0.5, 0, 0}}, {ball, {0.5, 0, 0}}}};
  const silt::MultiSphere spheres{{{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}}};
  const auto a = two.mass_properties(), b = spheres.mass_properties();
  CHECK(near_relative(a.volume, b.volume, 1e-3));  // as compound.hpp says
  const auto sum = [](const Vec3d& v) { return v.x + v.y + v.z; };
  CHECK(near_relative(sum(a.inertia), sum(b.inertia), 1e-3));
}

TEST_CASE("compound: parts stand where they were put, in the principal frame") {
  const silt::Quaternion turn = silt::rotation_about({0, 0, 1}, 0.7);
  const silt::PolySuperEllipsoid egg{{1, 1.2, 2}, {0.8, 1, 0.6}};
  const Compound<silt::PolySuperEllipsoid> one{.parts = {{egg, {3, -1, 0.5}, turn}}};
  const auto mass = one.mass_properties();
  CHECK(near_relative(mass.volume, egg.volume(), 1e-14));
  // A point of the egg, by the engine's way and by hand.
  const auto part = one.solids(mass).front();
  const Vec3d x{0.3, 0.2, -0.4};
  const Vec3d by_engine = mass.centroid + rotate(mass.axes, part.centre + rotate(part.axes, x));
  CHECK(norm(by_engine - (Vec3d{3, -1, 0.5} + rotate(turn, x))) < 1e-12);
}

TEST_CASE("compound: what is refused") {
  const auto says = [](const Compound<SuperEllipsoid>& c, const char* word) {
    return refusal([&] { c.check(); }).find(word) != std::string::npos;
  };
  CHECK(says({.parts = {}}, "no parts"));
  CHECK(says({.parts = {{SuperEllipsoid{-1, 1, 1}}}}, "SuperEllipsoid.a"));
  CHECK(says({.parts = {{SuperEllipsoid{1, 1, 1}}}, .grid = 2}, "grid"));
  CHECK(says({.parts = {{SuperEllipsoid{1, 1, 1}, {NAN, 0, 0}}}}, "centre"));
  CHECK(says({.parts = {{SuperEllipsoid{1, 1, 1}}}, .mass = silt::MassProperties{}}, "volume"));
  const SuperEllipsoid ball{1, 1, 1};
  CHECK(says({.parts = {{ball}, {ball, {1, 0, 0}, {2, 0, 0, 0}}}}, "axes of part 1 have length 2"));
  silt::MassProperties mass = ball.mass_properties();
  mass.axes = {0, 0, 0, 0};
  CHECK(says({.parts = {{ball}}, .mass = mass}, "the axes of its mass are a quaternion of length 0"));
  silt::Particles<silt::Mix<silt::Sphere, SuperEllipsoid>> mix;
  mix.add_form(silt::Sphere{});
  CHECK(refusal([&] {
          mix.add({.form = 0, .position = {0, 0, 0}, .density = 1000});
        }).find("no size of its own") != std::string::npos);
}

}  // namespace compound_test
