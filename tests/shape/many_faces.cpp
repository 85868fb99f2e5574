// silt - BSD-3-Clause, see LICENSE
//
// Polyhedra of up to 4000 faces: closed forms, spheres of facets between their inner and outer
// sphere, libccd, energy of collisions.

#include "two_polyhedra.hpp"

#include <silt/shape/narrow/solid_pairs.hpp>

#if defined(SILT_TEST_CCD)
#include <ccd/ccd.h>
#endif

namespace many_faces_test {

using namespace shape_test;
using silt::OverlapMemory;
using silt::thickness_contact;
using silt::volume_overlap;

namespace {

/// So many triangles, their corners spread evenly on an ellipsoid whose mean semi-axis is 1/2.
std::vector<Vec3d> faceted(int faces, const Vec3d& axes = {1, 1, 1}) {
  std::vector<Vec3d> out;
  for (int k = 0, n = faces / 2 + 2; k < n; ++k) {
    const double z = 1 - (2 * k + 1.0) / n, r = std::sqrt(1 - z * z);
    const double phi = pi * (3 - std::sqrt(5.0)) * k;
    out.push_back(
        {0.5 * axes.x * r * std::cos(phi), 0.5 * axes.y * r * std::sin(phi), 0.5 * axes.z * z});
  }
  return out;
}
const Polyhedron& ball_of_2000() {
  static const Polyhedron ball = Polyhedron::from_points(faceted(2000));
  return ball;
}

/// The radius of the largest sphere about the origin inside.
double inner_radius(const Polyhedron& body) {
  double least = 9;
  for (const auto& f : body.faces()) least = std::min(least, f.offset);
  return least;
}
/// Volume of the intersection of two spheres of radius r, d apart.
double lens(double r, double d) {
  return d >= 2 * r ? 0 : pi / 12 * (4 * r + d) * (2 * r - d) * (2 * r - d);
}
double cap(double r, double height) {
  return height <= 0 ? 0 : pi / 3 * height * height * (3 * r - height);
}

}  // namespace

TEST_CASE("polyhedra of many faces: a prism of 1998 sides has the prism's volume and inertia") {
  constexpr int n = 1998;
  const double r = 0.7, h = 0.4;
  std::vector<Vec3d> corners;
  for (int k = 0; k < n; ++k)
    for (const double z : {-0.5 * h, 0.5 * h})
      corners.push_back({r * std::cos(2 * pi * k / n), r * std::sin(2 * pi * k / n), z});
  const auto body = Polyhedron::from_points(corners);
  CHECK(body.faces().size() == n + 2);
  CHECK(body.vertices().size() == 2 * n);
  CHECK(body.edges().size() == 3 * n);
  CHECK(body.graph().size() == 2 * n);
  const double volume = 0.5 * n * r * r * std::sin(2 * pi / n) * h;
  const double about_axis = volume * r * r / 6 * (2 + std::cos(2 * pi / n));
  const double across = 0.5 * about_axis + volume * h * h / 12;
  // Some 4000 roundings of 1e-16, of terms no larger than the sum.
  CHECK(agree(body.core_volume(), volume, 1e-12));
  const auto inertia = inertia_of(mass_properties(body));
  CHECK(agree(inertia.zz, about_axis, 1e-12));
  CHECK(agree(inertia.xx, across, 1e-12));
  CHECK(agree(inertia.yy, across, 1e-12));
}

TEST_CASE("polyhedra of many faces: 4000 are possible, 4002 are refused") {
  CHECK(Polyhedron::from_points(faceted(4000)).faces().size() == 4000);
  refuses([] { Polyhedron::from_points(faceted(4002)); },
          "4002 faces and 2003 corners; at most 4000");
}

TEST_CASE(
    "polyhedra of many faces: overlaps of balls of 2000 facets lie between those of spheres") {
  Random random(1);
  const auto& ball = ball_of_2000();
  REQUIRE(ball.faces().size() == 2000);
  const double outer = 0.5, inner = inner_radius(ball);
  CHECK(inner > 0.498);  // triangles of area 4 pi R^2/2000 lie some 2e-3 R inside
  double unequal = 0;
  for (int k = 0; k < 200; ++k) {
    const double depth = 0.4 * std::pow(10, -2 * random.uniform());
    const Vec3d towards = random.direction();
    const PlacedPolyhedron i{&ball, {{0, 0, 0}, random.turn()}};
    const PlacedPolyhedron j{&ball, {(1 - depth) * towards, random.turn()}};
    const auto found = volume_overlap(i, j, -towards);
    CHECK(found.volume <= lens(outer, 1 - depth));
    CHECK(found.volume >= lens(inner, 1 - depth));
    // Seen from the other side, and from a direction that lets another face cut first.
    const auto other = volume_overlap(j, i, towards);
    const auto askew = volume_overlap(i, j, normalised(random.direction() - towards));
    unequal = std::max({unequal, std::abs(found.volume - other.volume),
                        std::abs(found.volume - askew.volume), norm(found.area + other.area)});
    const auto floor = volume_overlap(i, (0.5 - depth) * towards, -towards);
    CHECK(floor.volume <= cap(outer, depth));
    CHECK(floor.volume >= cap(inner, depth - outer + inner));
  }
  CHECK(unequal <= 1e-14);  // a hundred roundings of 1e-16
}

TEST_CASE("polyhedra of many faces: S and the couple are the derivatives of the volume") {
  Random random(2);
  const auto egg = principal_shape(Polyhedron::from_points(faceted(2000, {1, 1.3, 0.8}))).parts[0];
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    const Vec3d towards = random.direction();
    const PlacedPolyhedron i{&egg, {{0, 0, 0}, random.turn()}};
    PlacedPolyhedron j{&egg, {{0, 0, 0}, random.turn()}};
    j.pose.position = i.support(towards) - j.support(-towards) - 0.02 * towards;
    const auto found = volume_overlap(i, j, -towards);
    const double h = 1e-6;
    for (const Vec3d& e : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
      const auto moved = [&](double by) {
        auto p = i;
        p.pose.position += by * e;
        return volume_overlap(p, j, -towards).volume;
      };
      const auto turned = [&](double by) {
        auto p = i;
        const auto r = rotation_matrix(rotation_about(e, by));
        p.pose.position = found.point + r * (p.pose.position - found.point);
        p.pose.turn = {r * p.pose.turn.x, r * p.pose.turn.y, r * p.pose.turn.z};
        return volume_overlap(p, j, -towards).volume;
      };
      worst = std::max(
          {worst, std::abs((moved(h) - moved(-h)) / (2 * h) - dot(found.area, e)),
           std::abs((turned(h) - turned(-h)) / (2 * h) - found.couple * dot(found.area, e))});
    }
  }
  // Rounding 1e-17/h, and the change of S within h where features of the size of h appear: 10 h.
  CHECK(worst <= 1e-5);
}

namespace {
struct Swing {
  double energy = 0, momentum = 0;  // largest relative error during the collision; change
  bool touched = false;
};
/// Two bodies of 2000 faces, off centre and spinning; linear, by the thickness.
Swing collide(double h) {
  Random random(3);
  const Polyhedron egg = Polyhedron::from_points(faceted(2000, {1, 1.2, 0.8}));
  Body a(egg), b(egg);
  a.position = {0.62, 0.1, -0.05}, a.velocity = {-1, 0, 0};
  b.position = {-0.62, 0, 0}, b.velocity = {1, 0, 0};
  a.turn = random.turn(), b.turn = random.turn();
  a.spin = 0.01 * random.direction(), b.spin = 0.01 * random.direction();
  const TestLaw law{4000, 1};
  OverlapMemory memory;
  Swing out;
  const double energy = a.kinetic_energy() + b.kinetic_energy();
  const Vec3d before = a.mass * a.velocity + b.mass * b.velocity;
  for (double t = 0; t < 0.3; t += h) {
    a.kick(h / 2), b.kick(h / 2), a.drift(h), b.drift(h);
    const auto c = thickness_contact(a.placed(), b.placed(), memory);
    const Vec3d f = act(c, law, a.velocity - b.velocity, {0, 0, 0});
    a.force = f, b.force = -f;
    a.torque = cross(c.point - a.position, f) + c.couple * f;
    b.torque = -(cross(c.point - b.position, f) + c.couple * f);
    a.kick(h / 2), b.kick(h / 2);
    const double now = a.kinetic_energy() + b.kinetic_energy() + law.energy(c.overlap);
    out.energy = std::max(out.energy, std::abs(now / energy - 1));
    out.touched |= c.overlap > 0;
  }
  CHECK(norm(a.velocity + Vec3d{1, 0, 0}) > 0.5);  // they did not pass by
  out.momentum = norm(a.mass * a.velocity + b.mass * b.velocity - before);
  return out;
}
}  // namespace

TEST_CASE("polyhedra of many faces: an elastic collision keeps its energy, to second order") {
  const Swing coarse = collide(1e-3), fine = collide(2.5e-4);
  MESSAGE("largest energy error ", coarse.energy, " at step 1e-3, ", fine.energy, " at 2.5e-4");
  CHECK(coarse.touched);
  CHECK(fine.momentum <= 1e-13);
  CHECK(fine.energy <= 1e-3);
  CHECK(coarse.energy / fine.energy >= 9);  // 16, less what the first touch has of its kink
}

#if defined(SILT_TEST_CCD)
namespace {
void ccd_point(const void* object, const ccd_vec3_t* dir, ccd_vec3_t* out) {
  const auto& body = *static_cast<const PlacedPolyhedron*>(object);
  const Vec3d n = body.pose.turn.back({dir->v[0], dir->v[1], dir->v[2]});
  Vec3d best = body.shape->vertices()[0];  // all corners: independent of climbing
  for (const auto& v : body.shape->vertices())
    if (dot(n, v) > dot(n, best)) best = v;
  best = body.pose.to_space(best);
  ccdVec3Set(out, best.x, best.y, best.z);
}
}  // namespace

TEST_CASE("polyhedra of many faces: libccd says the same on touching and on depth") {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_point;
  ccd.max_iterations = 500, ccd.epa_tolerance = 1e-9;
  Random random(4);
  const Polyhedron bodies[] = {
      ball_of_2000(), Polyhedron::from_points(faceted(2000, {0.6, 1.4, 1})),
      Polyhedron::from_points(faceted(1280, {1.3, 0.5, 1.2})), random.hull(20)};
  int touching = 0, differ = 0, depths = 0, off = 0;
  for (std::size_t k = 0; k < 300; ++k) {
    const Vec3d towards = random.direction();
    const PlacedPolyhedron i{&bodies[k % 4], {{0, 0, 0}, random.turn()}};
    PlacedPolyhedron j{&bodies[k / 4 % 3], {{0, 0, 0}, random.turn()}};
    j.pose.position =
        i.support(towards) - j.support(-towards) + random.uniform(-0.05, 0.005) * towards;
    const auto gjk = gjk_distance(i, j, Vec3d{0, 0, 0});
    const bool said = ccdGJKIntersect(&i, &j, &ccd) != 0;
    silt::NormalMemory<double> memory;
    const bool touch = touch_solids(i, j, memory).overlap > 0;
    const double depth = gjk.overlapping ? penetration(i, j, gjk).depth : -gjk.distance;
    if (std::abs(depth) < 1e-6) continue;  // libccd's own tolerance on touching
    touching += touch;
    differ += touch != said || touch != (depth > 0);
    ccd_real_t way;
    ccd_vec3_t direction, position;
    if (!touch || ccdGJKPenetration(&i, &j, &ccd, &way, &direction, &position) != 0) continue;
    ++depths;
    off += std::abs(way - depth) > 1e-4;  // its polytope is good to the root of the tolerance
  }
  CHECK(touching > 100);
  CHECK(differ == 0);
  CHECK(depths > 90);
  CHECK(off <= depths / 50);  // it misses the least way now and then, as in libccd.cpp
}
#endif

}  // namespace many_faces_test
