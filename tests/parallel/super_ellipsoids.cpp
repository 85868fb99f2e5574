// silt - BSD-3-Clause, see LICENSE
#include <silt/shape/super_ellipsoid.hpp>

#include "body_scenes.hpp"

namespace parallel_super_ellipsoids_test {

namespace {

using Shape = silt::SuperEllipsoid;
const auto forms = [](auto& all) {
  all.add_form(silt::SuperEllipsoid{.a = 1e-3, .b = 0.9e-3, .c = 0.6e-3, .s1 = 4, .s2 = 4});
  all.add_form(silt::SuperEllipsoid{.a = 0.6e-3, .b = 0.6e-3, .c = 1e-3, .s1 = 6, .s2 = 2});
  return std::size_t{2};
};

// As tests/parallel/spheres.cpp: sums in another order differ by 1e-16 of the forces, and grow by
// some ten contacts of each body; a contact that is missing or has forgotten is 1e-3.
TEST_CASE(
    "ranks: super-ellipsoids that slide and rub are those of one process, while cuts move through "
    "them") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10);
}

TEST_CASE("ranks: likewise super-ellipsoids in a ring, whose first and last rank are neighbours") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10, silt_test::slide_ring);
}

TEST_CASE("ranks: a dense cloud of super-ellipsoids loses nobody and keeps its momentum") {
  silt_test::check_cloud<Shape>(forms, 0.01);
}

}  // namespace

}  // namespace parallel_super_ellipsoids_test
