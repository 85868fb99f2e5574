// silt - BSD-3-Clause, see LICENSE
#include <silt/shape/polyhedron.hpp>

#include "body_scenes.hpp"

namespace parallel_polyhedra_test {

namespace {

using Shape = silt::Polyhedron;
const auto forms = [](auto& all) {
  std::vector<silt::Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? 1e-3 : -1e-3, k & 2 ? 0.8e-3 : -0.8e-3, k & 4 ? 0.7e-3 : -0.7e-3});
  all.add_form(silt::Polyhedron::from_points(corners));
  all.add_form(silt::Polyhedron::from_points(
      {{1e-3, 1e-3, 1e-3}, {1e-3, -1e-3, -1e-3}, {-1e-3, 1e-3, -1e-3}, {-1e-3, -1e-3, 1e-3}},
      0.2e-3));
  return std::size_t{2};
};

// As tests/parallel/spheres.cpp: sums in another order differ by 1e-16 of the forces, and grow by
// some ten contacts of each body; a contact that is missing or has forgotten is 1e-3.
TEST_CASE(
    "ranks: polyhedra that slide and rub are those of one process, while cuts move through them") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10);
}

TEST_CASE("ranks: likewise polyhedra in a ring, whose first and last rank are neighbours") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10, silt_test::slide_ring);
}

TEST_CASE("ranks: a dense cloud of polyhedra loses nobody and keeps its momentum") {
  silt_test::check_cloud<Shape>(forms, 0.01);
}

}  // namespace

}  // namespace parallel_polyhedra_test
