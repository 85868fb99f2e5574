// silt - BSD-3-Clause, see LICENSE
#include <silt/shape/multi_sphere.hpp>

#include "body_scenes.hpp"

namespace parallel_multi_spheres_test {

namespace {

using Shape = silt::MultiSphere;
const auto forms = [](auto& all) {
  all.add_form(silt::MultiSphere{{{{-0.6e-3, 0, 0}, 1e-3}, {{0.5e-3, 0.1e-3, 0}, 0.8e-3}}});
  all.add_form(silt::MultiSphere{{{{0, 0, 0}, 1e-3},
                                  {{0.9e-3, 0, 0}, 0.8e-3},
                                  {{0, 0.9e-3, 0}, 0.8e-3},
                                  {{0, 0, 0.9e-3}, 0.8e-3}}});
  return std::size_t{2};
};

// As tests/parallel/spheres.cpp: sums in another order differ by 1e-16 of the forces, and grow by
// some ten contacts of each body; a contact that is missing or has forgotten is 1e-3.
TEST_CASE(
    "ranks: multi-spheres that slide and rub are those of one process, while cuts move through "
    "them") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10);
}

TEST_CASE("ranks: likewise multi-spheres in a ring, whose first and last rank are neighbours") {
  silt_test::check_slide<Shape>(forms, 0.03, 1e-12, 1e-10, silt_test::slide_ring);
}

TEST_CASE("ranks: a dense cloud of multi-spheres loses nobody and keeps its momentum") {
  silt_test::check_cloud<Shape>(forms, 0.01);
}

}  // namespace

}  // namespace parallel_multi_spheres_test
