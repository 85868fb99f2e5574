// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/passages.hpp>

#include <limits>

#include <silt/boundary/finite_walls.hpp>

#include "support.hpp"

namespace passages_test {

using namespace boundary_test;
using silt::OpenDomain;
using silt::PeriodicBox;
using silt::detail::Passages;
using silt::detail::PassedSurface;

namespace {

int net(const Passages& p) { return p.forwards - p.backwards; }
bool is_once(const Passages& p) { return p.forwards + p.backwards == 1; }

// Catches: a path through an edge or a corner that two triangles count, or none of them; the centre
// of a disc is a corner of all of its triangles.
TEST_CASE("passages: a path through centre, edges and corners of a disc passes once") {
  std::mt19937_64 random(1);
  for (const Vec3d& axis : {Vec3d{0, 0, -1}, Vec3d{1, 2, -0.5}}) {
    const auto mesh = silt::disc({0.1, -0.2, 0.3}, axis, 0.05, 64);
    PassedSurface disc("test", mesh);
    const auto& at = mesh.vertices();
    for (std::size_t v = 1; v < at.size(); ++v)
      for (const double share : {0.0, 0.25, 0.5, 0.999}) {  // along the spokes
        const Vec3d through = at[0] + share * (at[v] - at[0]);
        for (const Vec3d& slant : {Vec3d{0, 0, 0}, random_point(random, -1e-3, 1e-3)}) {
          const Vec3d way = 1e-3 * normalised(axis) + 0.3 * slant;
          const auto there = disc.between(through - way, through + way, OpenDomain{}),
                     back = disc.between(through + way, through - way, OpenDomain{});
          CHECK(is_once(there));
          CHECK(is_once(back));
          CHECK(there.forwards == 1);
          CHECK(back.backwards == 1);
          CHECK(there.first == doctest::Approx(0.5));
        }
      }
    // Beyond the rim.
    for (std::size_t v = 1; v < at.size(); ++v) {
      const Vec3d beside = at[0] + 1.001 * (at[v] - at[0]), way = 1e-3 * normalised(axis);
      CHECK_FALSE(disc.between(beside - way, beside + way, OpenDomain{}).any());
    }
  }
}

// Catches: crossings of a closed mesh that are missed, doubled or have the wrong sign.
TEST_CASE(
    "passages: of a closed mesh, those that leave less those that enter are the change of inside") {
  std::mt19937_64 random(2);
  const silt::TriangleMesh meshes[] = {silt::sphere_mesh({0, 0, 0}, 0.5, 3),
                                       silt::box_mesh({-0.3, -0.4, -0.5}, {0.5, 0.4, 0.3})};
  for (const auto& mesh : meshes) {
    PassedSurface surface("test", mesh);
    int through = 0;
    for (int n = 0; n < 20000; ++n) {
      const Vec3d a = random_point(random, -0.7, 0.7), b = random_point(random, -0.7, 0.7);
      const auto p = surface.between(a, b, OpenDomain{});
      CHECK(net(p) == int{mesh.contains(a)} - int{mesh.contains(b)});
      through += p.forwards > 0 && p.backwards > 0;
      if (p.forwards > 0 && p.backwards > 0) CHECK_FALSE(p.first_forwards);  // convex: in first
    }
    CHECK(through > 100);
    // From the middle through corners, and through the middles of edges.
    for (const auto& t : mesh.triangles())
      for (int k = 0; k < 3; ++k) {
        const Vec3d &a = mesh.vertices()[t[k]], &b = mesh.vertices()[t[(k + 1) % 3]];
        for (const Vec3d& to : {1.3 * a, 0.65 * (a + b)}) {
          CHECK(surface.between({0, 0, 0}, to, OpenDomain{}).forwards == 1);
          CHECK(net(surface.between(to, {0, 0, 0}, OpenDomain{})) == -1);
        }
      }
  }
}

// Catches: a particle that is seen exactly on the surface and counts twice or never.
TEST_CASE("passages: paths that meet on the surface pass once together") {
  PassedSurface plane("test", silt::Plane{{0, 0, 0.5}, {0, 0, 3}}),
      patch("test", silt::rectangle({-1, -1, 0.5}, {2, 0, 0}, {0, 2, 0}));
  for (auto* surface : {&plane, &patch}) {
    const Vec3d low{0.1, 0.2, 0.25}, on{0.1, 0.2, 0.5}, high{0.1, 0.2, 0.75};
    const auto count = [&](std::initializer_list<Vec3d> places) {
      std::array<int, 2> sum{0, 0};
      for (auto at = places.begin(); at + 1 != places.end(); ++at) {
        const auto p = surface->between(*at, *(at + 1), OpenDomain{});
        sum[0] += p.forwards, sum[1] += p.backwards;
      }
      return sum;
    };
    CHECK(count({low, on, high}) == std::array{1, 0});
    CHECK(count({high, on, low}) == std::array{0, 1});
    CHECK(count({low, on, on, low}) == std::array{1, 1});
    CHECK(count({high, on, high}) == std::array{0, 0});
    CHECK(count({low, high, low, high}) == std::array{2, 1});
  }
}

// Catches: a wrap that counts as a passage; a plane on a face of the box that is passed at one face
// and not at the other; the images of a mesh left out; a passage on the seam of two images counted
// twice or never.
TEST_CASE("passages: in a periodic box, at surfaces anywhere, on the faces and across them") {
  const PeriodicBox box({{0, 0, 0}, {1, 0.5, 2}}, {true, true, false});
  const auto goes = [&](const silt::Surfaces& at, const Vec3d& from, const Vec3d& to) {
    PassedSurface surface("test", at);
    surface.check(box);
    const auto there = surface.between(from, to, box), back = surface.between(to, from, box);
    CHECK(net(there) == -net(back));
    return net(there);
  };
  const Vec3d last{0.98, 0.2, 1}, first{0.02, 0.2, 1}, beyond{1.02, 0.2, 1};
  for (const double x : {0.0, 1.0, -3.0, 0.99, 0.01}) {
    CAPTURE(x);
    const silt::Plane plane{{x, 0, 0}, {2, 0, 0}};
    CHECK(goes(plane, last, first) == 1);   // wrapped
    CHECK(goes(plane, last, beyond) == 1);  // not yet
    const auto patch = silt::rectangle({x, 0, 0.5}, {0, 0.5, 0}, {0, 0, 1});
    CHECK(goes(patch, last, first) == 1);
    CHECK(goes(patch, last, beyond) == 1);
    CHECK(goes(patch, {0.98, 0.2, 1.6}, {0.02, 0.2, 1.6}) == 0);  // above it
  }
  CHECK(goes(silt::Plane{{0.5, 0, 0}, {1, 0, 0}}, last, first) == 0);
  CHECK(goes(silt::Plane{{0, 0, 1}, {0, 0, 1}}, last, {0.02, 0.2, 0.99}) == -1);
  // A floor that ends at the faces, passed on them and on the corner where four images meet.
  const auto floor = silt::rectangle({0, 0, 1}, {1, 0, 0}, {0, 0.5, 0});
  for (const double x : {0.0, 1.0, 0.3, -1.0})
    for (const double y : {0.0, 0.5, 0.2, 1.5}) CHECK(goes(floor, {x, y, 0.99}, {x, y, 1.01}) == 1);
  // A disc across a face.
  const auto hole = silt::disc({0, 0.25, 1}, {0, 0, 1}, 0.1);
  CHECK(goes(hole, {0.95, 0.25, 0.99}, {0.95, 0.25, 1.01}) == 1);
  CHECK(goes(hole, {0.05, 0.25, 0.99}, {0.05, 0.25, 1.01}) == 1);
  CHECK(goes(hole, {0.5, 0.25, 0.99}, {0.5, 0.25, 1.01}) == 0);
}

// Catches: a random walk whose passages do not add up to the change of its place.
TEST_CASE("passages: many small ways through a periodic box add up to whole lengths") {
  const PeriodicBox box({{0, 0, 0}, {1, 1, 1}}, {true, true, true});
  std::mt19937_64 random(3);
  PassedSurface across("test", silt::Plane{{0.7, 0, 0}, {1, 0, 0}}),
      patch("test", silt::rectangle({0.7, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  Vec3d x{0.1, 0.2, 0.3}, straight = x;
  int by_plane = 0, by_patch = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3d way = random_point(random, -0.1, 0.13);
    straight += way;
    Vec3d to = x + way;
    if (n % 7 == 0) to = box.wrapped(to);
    by_plane += net(across.between(x, to, box)), by_patch += net(patch.between(x, to, box));
    x = to;
  }
  const int whole = static_cast<int>(std::floor(straight.x - 0.7)) + 1;
  CHECK(whole > 200);
  CHECK(by_plane == whole);
  CHECK(by_patch == whole);
}

TEST_CASE("passages: unfit surfaces are refused") {
  const auto make = [](const silt::Surfaces& surface) { PassedSurface("counter", surface); };
  refuses<silt::InputError>(
      [&] {
        make(silt::Plane{{0, 0, 0}, {0, 0, 0}});
      },
      "Plane.normal = (0, 0, 0) [-] must be finite and not zero");
  refuses<silt::InputError>(
      [&] {
        make(silt::Plane{{0, not_a_number, 0}, {0, 0, 1}});
      },
      "Plane.point");
  refuses<silt::InputError>(
      [&] {
        make(silt::box({0, 0, 0}, {1, 1, 1}));
      },
      "counter: 6 surfaces given, but it takes one");
  refuses<silt::InputError>(
      [&] {
        make(silt::Cylinder{{0, 0, 0}, {0, 0, 1}, 1, silt::Side::Inside});
      },
      "counter: a Cylinder or Cone is not counted at; give a plane, or a mesh");
  for (const double radius : {-0.1, 0.0, not_a_number, infinity})
    refuses<silt::InputError>(
        [&] {
          make(silt::disc({0, 0, 0}, {0, 0, 1}, radius));
        },
        "[m] must be finite and greater than 0");
  refuses<silt::InputError>(
      [&] {
        make(silt::disc({0, 0, 0}, {0, 0, 0}, 1));
      },
      "must be finite and not zero");
  refuses<silt::InputError>([&] { make(silt::TriangleMesh({})); }, "0 triangles given");
  const PeriodicBox box({{0, 0, 0}, {1, 1, 1}}, {true, false, false});
  refuses<silt::InputError>(
      [&] {
        PassedSurface("counter", silt::Plane{{0, 0, 0}, {1, 0, 1}}).check(box);
      },
      "is oblique to x, which repeats");
  refuses<silt::InputError>(
      [&] {
        PassedSurface("counter", silt::disc({0, 0, 0}, {0, 0, 1}, 0.6)).check(box);
      },
      "counter: the mesh is 1.2 m long in x, more than the PeriodicBox, 1 m");
  CHECK_NOTHROW(PassedSurface("counter", silt::disc({0, 0, 0}, {1, 0, 0}, 9)).check(box));
}

}  // namespace

}  // namespace passages_test
