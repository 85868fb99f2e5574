// silt - BSD-3-Clause, see LICENSE
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>
#include <silt/shape/polyhedron.hpp>
#include <silt/shape/super_ellipsoid.hpp>

#include "body_scenes.hpp"

namespace parallel_mixes_test {

namespace {

using Shape = silt::Mix<silt::Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron,
                        silt::Compound<silt::Polyhedron>>;
const auto forms = [](auto& all) {
  const auto block = [](double a, double b, double c) {
    std::vector<silt::Vec3d> corners;
    for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
    return silt::Polyhedron::from_points(corners);
  };
  all.add_form(silt::Sphere{});
  all.add_form(silt::MultiSphere{{{{-0.6e-3, 0, 0}, 0.7e-3}, {{0.5e-3, 0, 0}, 0.8e-3}}});
  all.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 1e-3, .c = 0.6e-3, .s1 = 6, .s2 = 2});
  all.add_form(block(1e-3, 0.8e-3, 0.7e-3));
  all.add_form(silt::Compound<silt::Polyhedron>{
      .parts = {{block(1e-3, 0.3e-3, 0.8e-3), {0, -0.7e-3, 0}},
                {block(0.3e-3, 0.7e-3, 0.8e-3), {-0.7e-3, 0.3e-3, 0}}}});
  return std::size_t{5};
};

// As tests/parallel/spheres.cpp: sums in another order differ by 1e-16 of the forces, and grow by
// some ten contacts of each body; a contact that is missing or has forgotten is 1e-3.
TEST_CASE(
    "ranks: all shapes together that slide and rub are those of one process, while cuts move "
    "through them") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10);
}

TEST_CASE(
    "ranks: likewise all shapes together in a ring, whose first and last rank are neighbours") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10, silt_test::slide_ring);
}

TEST_CASE("ranks: a dense cloud of all shapes together loses nobody and keeps its momentum") {
  silt_test::check_cloud<Shape>(forms, 0.01);
}

}  // namespace

}  // namespace parallel_mixes_test
