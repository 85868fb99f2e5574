// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/plane.hpp>

#include "support.hpp"

namespace plane_test {

using namespace boundary_test;
using silt::Plane;

TEST_CASE("plane: distance and normal in front, on and behind, for a normal of any length") {
  const Plane plane{.point = {1, 2, 3}, .normal = {0, 0, 5}};
  for (const double height : {0.25, 0.0, -0.25}) {  // exact in binary
    const auto found = contacts(plane, {-7, 4, 3 + height}, 0.5);
    REQUIRE(found.size() == 1);
    CHECK(found[0].distance == height);
    CHECK(found[0].normal == Vec3d{0, 0, 1});
    CHECK(found[0].feature == 0);
  }
}

TEST_CASE("plane: a contact needs distance < reach") {
  const Plane plane{.point = {0, 0, 0}, .normal = {1, 0, 0}};
  CHECK(contacts(plane, {0.5, 0, 0}, 0.5).empty());
  CHECK(contacts(plane, {0.499, 0, 0}, 0.5).size() == 1);
}

TEST_CASE("plane: oblique distance equals the projection within round-off") {
  const Plane plane{.point = {0.1, -0.2, 0.3}, .normal = {1, 2, 2}};
  const auto found = contacts(plane, Vec3d{0.1, -0.2, 0.3} + Vec3d{2, -1, 0} + Vec3d{1, 2, 2}, 4);
  REQUIRE(found.size() == 1);
  CHECK(found[0].distance == doctest::Approx(3).epsilon(1e-15));
  CHECK(gap(found[0].normal, {1 / 3., 2 / 3., 2 / 3.}) < 1e-15);
}

TEST_CASE("plane: bounds are flat along an axis and infinite otherwise") {
  const auto flat = Plane{{1, 2, 3}, {0, -2, 0}}.bounds();
  CHECK(flat.min == Vec3d{-infinity, 2, -infinity});
  CHECK(flat.max == Vec3d{infinity, 2, infinity});
  const auto oblique = Plane{{1, 2, 3}, {0, 1, 1}}.bounds();
  CHECK(oblique.min == Vec3d{-infinity, -infinity, -infinity});
  CHECK(oblique.max == Vec3d{infinity, infinity, infinity});
}

TEST_CASE("plane: refuses a normal without direction and a point that is not finite") {
  refuses<silt::InputError>(
      [] {
        Plane{{0, 0, 0}, {0, 0, 0}}.check();
      },
      "Plane.normal = (0, 0, 0)");
  refuses<silt::InputError>([] { Plane{{0, 0, 0}, {0, infinity, 0}}.check(); }, "Plane.normal");
  refuses<silt::InputError>(
      [] {
        Plane{{0, not_a_number, 0}, {0, 0, 1}}.check();
      },
      "Plane.point = (0, nan, 0) [m]");
  CHECK_NOTHROW(Plane{{0, 0, 0}, {0, 0, 1e-3}}.check());
}

TEST_CASE("box_planes: the distances to the six walls of a box") {
  const auto planes = silt::box_planes({0, 0, 0}, {1, 2, 4});
  const std::array<double, 6> expected{0.25, 0.75, 0.5, 1.5, 1, 3};
  REQUIRE(planes.size() == 6);
  for (std::size_t k = 0; k < 6; ++k) {
    const auto found = contacts(planes[k], {0.25, 0.5, 1}, 10);
    REQUIRE(found.size() == 1);
    CHECK(found[0].distance == expected[k]);
  }
}

TEST_CASE("box_planes: refuses min >= max in any direction and limits that are not finite") {
  refuses<silt::InputError>(
      [] {
        silt::box_planes({0, 0, 0}, {1, 0, 1});
      },
      "box: min = (0, 0, 0) [m] must be less than max = (1, 0, 1)");
  refuses<silt::InputError>([] { silt::box_planes({2, 0, 0}, {1, 1, 1}); }, "must be less than");
  refuses<silt::InputError>(
      [] {
        silt::box_planes({0, 0, 0}, {1, 1, infinity});
      },
      "must be finite");
}

}  // namespace plane_test
