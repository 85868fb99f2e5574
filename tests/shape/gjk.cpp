// silt - BSD-3-Clause, see LICENSE

#include "bodies.hpp"
#include "pair_count.hpp"

#include <silt/shape/narrow/margin_contact.hpp>
#include <silt/shape/narrow/sphere_polyhedron.hpp>

#if defined(SILT_TEST_CCD)
#include <ccd/ccd.h>
#endif

namespace gjk_test {

using namespace shape_test;
using silt::AxisMemory;
using silt::gjk_distance;
using silt::PlacedPolyhedron;
using silt::PointSet;
using silt::SegmentSet;

namespace {

/// An ellipsoid by its support function, as a super-ellipsoid would be.
struct Ellipsoid {
  Vec3d axes;
  RigidPose pose;
  Vec3d support(const Vec3d& n) const {
    const Vec3d m = pose.turn.back(n);
    const Vec3d scaled{axes.x * m.x, axes.y * m.y, axes.z * m.z};
    const double length = norm(scaled);
    return pose.to_space(
        {axes.x * scaled.x / length, axes.y * scaled.y / length, axes.z * scaled.z / length});
  }
};

/// < 0: how deep; > 0: a distance along an axis that parts them (a lower bound of the distance).
double exact_gap(const PlacedPolyhedron& a, const PlacedPolyhedron& b) {
  return -silt::detail::SeparatingAxes(a, b).result().depth;
}

PlacedPolyhedron place(const Polyhedron& body, const Vec3d& at, const Quaternion& turn) {
  return {&body, {at, turn}};
}

/// Random, shallow, aligned faces, edge on edge, corner to corner, deep: by number.
std::pair<PlacedPolyhedron, PlacedPolyhedron> arrange(int kind, const Polyhedron& a,
                                                      const Polyhedron& b, Random& random) {
  auto i = place(a, {0, 0, 0}, kind == 2 ? Quaternion{} : random.turn());
  auto j = place(b, random.in_cube(0.9), kind == 2 ? Quaternion{} : random.turn());
  const auto towards = kind == 2 ? Vec3d{0, 0, 1} : random.direction();
  if (kind == 1 || kind == 2)  // nearly touching along a direction
    j.pose.position = i.support(towards) - (j.support(-towards) - j.pose.position) +
                      random.uniform(-0.02, 0.02) * towards;
  if (kind == 3) j.pose.position = 0.05 * random.direction();  // deep
  if (kind == 4) j.pose.turn = i.pose.turn;                    // all faces and edges parallel
  return {i, j};
}

/// The optimality of a distance: no point of b is nearer along the normal than on_a, on_b say.
void check_distance(const PlacedPolyhedron& a, const PlacedPolyhedron& b, double& worst) {
  const auto found = gjk_distance(a, b, Vec3d{0, 0, 0});
  const double gap = exact_gap(a, b);
  if (std::abs(gap) < 1e-9) return;  // touching: either answer
  REQUIRE(found.overlapping == (gap < 0));
  if (found.overlapping) {
    const auto deep = penetration(a, b, found);
    worst = std::max(worst, std::abs(deep.depth + gap));
    worst = std::max(worst, norm(deep.on_b - deep.on_a - deep.depth * deep.normal));
    const double parted = silt::gap_along(
        {a.shape, {a.pose.position + deep.depth * deep.normal, a.pose.turn}}, b, deep.normal);
    worst = std::max(worst, std::abs(parted));
  } else {
    worst = std::max(worst, std::abs(silt::gap_along(a, b, found.normal) - found.distance));
    worst = std::max(worst, norm(found.on_a - found.on_b - found.distance * found.normal));
  }
}

}  // namespace

TEST_CASE("gjk: 1e5 pairs of polyhedra; distance is proved by its own axis, depth by all axes") {
  Random random(1);
  std::vector<Polyhedron> bodies;
  for (int k = 0; k < 24; ++k) bodies.push_back(random.hull(4 + k));
  for (int k = 0; k < 8; ++k)
    bodies.push_back(box({random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)}));
  double worst = 0;
  for (int k = 0, count = pairs::count(100000); k < count; ++k) {
    const auto& a = bodies[static_cast<std::size_t>(random.uniform(0, 32))];
    const auto& b = bodies[static_cast<std::size_t>(random.uniform(0, 32))];
    const auto [i, j] = arrange(k % 5, a, b, random);
    check_distance(i, j, worst);
  }
  // Bodies have size 1; the relative gap is 1e-10, that of points its root where faces are parallel
  // to within it: on_a - on_b are combinations with weights of up to 1/angle.
  CHECK(worst <= 1e-9);
}

TEST_CASE("gjk: 2e4 boxes in multiples of 1/8: parallel faces, edges, corners, exact distances") {
  Random random(2);
  const auto eighths = [&](int low, int high) {
    return std::floor(random.uniform(low, high + 1)) / 8;
  };
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3d ea{eighths(1, 8), eighths(1, 8), eighths(1, 8)};
    const Vec3d eb{eighths(1, 8), eighths(1, 8), eighths(1, 8)};
    const Vec3d at{eighths(-12, 12), eighths(-12, 12), eighths(-12, 12)};
    const auto a = box(ea), b = box(eb);
    const Vec3d gap{std::abs(at.x) - 0.5 * (ea.x + eb.x), std::abs(at.y) - 0.5 * (ea.y + eb.y),
                    std::abs(at.z) - 0.5 * (ea.z + eb.z)};
    const double inner = std::max({gap.x, gap.y, gap.z});
    const double distance =
        norm(Vec3d{std::max(gap.x, 0.0), std::max(gap.y, 0.0), std::max(gap.z, 0.0)});
    const auto i = place(a, at, {}), j = place(b, {0, 0, 0}, {});
    const auto found = gjk_distance(i, j, Vec3d{0, 0, 0});
    if (inner > 0) {
      worst = std::max(worst, std::abs(found.distance - distance));
    } else if (inner < 0) {
      REQUIRE(found.overlapping);
      worst = std::max(worst, std::abs(penetration(i, j, found).depth + inner));
    }
  }
  CHECK(worst <= 1e-14);
}

TEST_CASE("gjk: ellipsoid and sphere, capsules, triangle: closed forms and optimality") {
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const Ellipsoid e{{random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)},
                      {random.in_cube(1), random.turn()}};
    const Vec3d p = 3.0 * random.direction();
    const auto found = gjk_distance(e, PointSet{p}, Vec3d{0, 0, 0});
    REQUIRE(!found.overlapping);
    CHECK(norm(found.on_b - p) <= 1e-15);
    CHECK(found.distance - found.lower_bound <= 1e-9 * found.distance);
    // The gap p - on_a is normal to the surface: grad f = 2 x/a^2.
    const Vec3d x = e.pose.to_body(found.on_a);
    const Vec3d n =
        e.pose.turn * normalised(Vec3d{x.x / (e.axes.x * e.axes.x), x.y / (e.axes.y * e.axes.y),
                                       x.z / (e.axes.z * e.axes.z)});
    CHECK(norm(n + found.normal) <= 2e-3);  // root of the gap, times curvature to 25
    AxisMemory memory;
    const double radius = 3;
    const auto contact = margin_contact(e, 0, PointSet{p}, radius, memory);
    CHECK(agree(contact.overlap, std::max(radius - found.distance, 0.0), 1e-9));
  }
  for (int k = 0; k < 2000; ++k) {
    const SegmentSet s{random.in_cube(1), random.in_cube(1)},
        t{random.in_cube(1), random.in_cube(1)};
    const auto found = gjk_distance(s, t, Vec3d{0, 0, 0});
    double best = 9;  // of two segments: coarse grid, then finer around the best
    double u0 = 0.5, v0 = 0.5, span = 0.5;
    for (int level = 0; level < 30; ++level, span *= 0.6) {
      double u1 = u0, v1 = v0;
      for (int i = -4; i <= 4; ++i)
        for (int j = -4; j <= 4; ++j) {
          const double u = std::clamp(u0 + span * i / 4, 0.0, 1.0);
          const double v = std::clamp(v0 + span * j / 4, 0.0, 1.0);
          const double d = norm(s.a + u * (s.b - s.a) - t.a - v * (t.b - t.a));
          if (d < best) best = d, u1 = u, v1 = v;
        }
      u0 = u1, v0 = v1;
    }
    CHECK(agree(found.distance, best, 1e-6));
    CHECK(found.distance <= best + 1e-12);
  }
  const silt::TriangleSet floor{{Vec3d{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}}};
  const auto cube = box({1, 1, 1});
  for (int k = 0; k < 200; ++k) {  // a mesh wall: the lowest corner
    auto body = place(cube, {0, 0, 2}, random.turn());
    const auto found = gjk_distance(body, floor, Vec3d{0, 0, 0});
    CHECK(agree(found.distance, body.support({0, 0, -1}).z, 1e-12));
    CHECK(norm(found.normal - Vec3d{0, 0, 1}) <= 1e-9);
  }
}

TEST_CASE("penetration: an ellipsoid in a sphere's way, within the bounds it gives") {
  Random random(4);
  for (int k = 0; k < 300; ++k) {
    const Ellipsoid e{{0.9, 0.6, 0.4}, {{0, 0, 0}, random.turn()}};
    const PointSet p{e.pose.to_space(0.1 * random.direction())};
    const auto found = gjk_distance(e, p, Vec3d{0, 0, 0});
    REQUIRE(found.overlapping);
    const auto deep = penetration(e, p, found);
    double best = 9;  // min over directions of the support function
    for (int i = 0; i < 4000; ++i) {
      const Vec3d n = random.direction();
      best = std::min(best, dot(n, e.support(n) - p.at));
    }
    CHECK(deep.lower_bound <= best + 1e-12);
    CHECK(deep.lower_bound <= deep.depth);
    CHECK(deep.depth <= best * 1.03);  // 64 planes around a smooth body
  }
}

TEST_CASE("gjk: a warm start and a reach that is passed take one support each") {
  const auto cube = box({1, 1, 1});
  const auto i = place(cube, {0, 0, 1.5}, {}), j = place(cube, {0, 0, 0}, {});
  const auto cold = gjk_distance(i, j, Vec3d{1, 0.2, 0.1});
  CHECK(agree(cold.distance, 0.5, 1e-14));
  CHECK(gjk_distance(i, j, cold.normal).iterations <= cold.iterations);
  const auto passed = gjk_distance(i, j, cold.normal, 0.4);
  CHECK(passed.beyond_reach);
  CHECK(passed.iterations == 0);
  AxisMemory memory;
  CHECK(margin_contact(i, 0.2, j, 0.2, memory).overlap == 0);
  const auto touch = margin_contact(i, 0.3, j, 0.25, memory);
  CHECK(agree(touch.overlap, 0.05, 1e-12));
  CHECK(agree(touch.normal.z, 1, 1e-12));
  CHECK(agree(touch.point.z, 0.5 + 0.5 * (0.5 + 0.25 - 0.3), 1e-12));
}

TEST_CASE("margin_contact: overlap passes the margin into the core without a jump") {
  Random random(5);
  for (int k = 0; k < 500; ++k) {
    const auto a = random.hull(12), b = random.hull(14);
    auto i = place(a, {0, 0, 0}, random.turn());
    const auto j = place(b, {0, 0, 0}, random.turn());
    const auto towards = random.direction();
    i.pose.position = 2.0 * towards;  // along the direction until the cores touch
    for (int step = 0; step < 100; ++step) {
      const auto apart = gjk_distance(i, j, Vec3d{0, 0, 0});
      if (apart.distance < 1e-7) break;
      i.pose.position -= 0.999 * apart.distance * towards;
    }
    AxisMemory memory;
    double before = margin_contact(i, 0.01, j, 0.01, memory).overlap;
    for (int step = 0; step < 20; ++step) {
      i.pose.position -= 1e-7 * towards;
      const double now = margin_contact(i, 0.01, j, 0.01, memory).overlap;
      CHECK(std::abs(now - before) <= 1.01e-7);  // |grad overlap| = 1
      before = now;
    }
  }
}

TEST_CASE("sphere_contact: what GJK finds from outside, the nearest face from inside") {
  Random random(6);
  for (int k = 0; k < 20000; ++k) {
    const auto body = box({1, 0.7, 0.4});
    const auto placed = place(body, random.in_cube(0.1), random.turn());
    const Vec3d centre = random.in_cube(1);
    const double radius = random.uniform(0.05, 0.5);
    const auto found = sphere_contact(centre, radius, placed);
    const auto gjk = gjk_distance(PointSet{centre}, placed, Vec3d{0, 0, 0});
    if (gjk.overlapping) {
      CHECK(found.buried);
      CHECK(agree(found.overlap - radius, penetration(PointSet{centre}, placed, gjk).depth, 1e-9));
    } else {
      CHECK(agree(found.overlap, std::max(radius - gjk.distance, 0.0), 1e-9));
      if (found.overlap > 0) CHECK(norm(found.normal - gjk.normal) <= 1e-4);
    }
    if (found.overlap > 0) {  // the point lies midway
      const double to_centre = dot(centre - found.point, found.normal);
      CHECK(agree(to_centre, radius - 0.5 * found.overlap, 1e-12));
    }
  }
}

#if defined(SILT_TEST_CCD)
namespace {
void ccd_support(const void* object, const ccd_vec3_t* dir, ccd_vec3_t* out) {
  const auto& body = *static_cast<const PlacedPolyhedron*>(object);
  const auto p = body.support({dir->v[0], dir->v[1], dir->v[2]});
  ccdVec3Set(out, p.x, p.y, p.z);
}
void ccd_centre(const void* object, ccd_vec3_t* out) {
  const auto& p = static_cast<const PlacedPolyhedron*>(object)->pose.position;
  ccdVec3Set(out, p.x, p.y, p.z);
}
}  // namespace

TEST_CASE("gjk: libccd says the same of 1e5 pairs") {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = ccd_support;
  ccd.center1 = ccd.center2 = ccd_centre;
  ccd.max_iterations = 500;
  ccd.epa_tolerance = 1e-9;
  Random random(7);
  std::vector<Polyhedron> bodies;
  for (int k = 0; k < 20; ++k) bodies.push_back(random.hull(4 + k));
  bodies.push_back(box({1, 0.5, 0.8}));
  bodies.push_back(box({0.4, 0.4, 0.4}));
  int disagree = 0, deep_pairs = 0, shorter = 0, too_short = 0, deeper = 0, failed = 0;
  for (int k = 0, count = pairs::count(100000); k < count; ++k) {
    const auto& a = bodies[static_cast<std::size_t>(random.uniform(0, 22))];
    const auto& b = bodies[static_cast<std::size_t>(random.uniform(0, 22))];
    const auto [i, j] = arrange(k % 5, a, b, random);
    const double gap = exact_gap(i, j);
    if (std::abs(gap) < 1e-5) continue;  // libccd's own tolerance on touching
    const auto mine = gjk_distance(i, j, Vec3d{0, 0, 0});
    disagree += mine.overlapping != (ccdGJKIntersect(&i, &j, &ccd) != 0);
    if (!mine.overlapping || k % 4 != 0) continue;
    ccd_real_t depth = 0;
    ccd_vec3_t direction, position;
    ++deep_pairs;
    if (ccdGJKPenetration(&i, &j, &ccd, &depth, &direction, &position) != 0) {
      ++failed;
      continue;
    }
    const double depth_here = penetration(i, j, mine).depth;
    deeper += depth > depth_here + 1e-6;
    if (!(depth < depth_here - 1e-6)) continue;
    double parted = -9;  // does its way part them?
    for (const double way : {depth, -depth}) {
      auto moved = i;
      const Vec3d n{direction.v[0], direction.v[1], direction.v[2]};
      moved.pose.position += way * n;
      parted = std::max({parted, silt::gap_along(moved, j, n), silt::gap_along(moved, j, -n)});
    }
    (parted > -1e-6 ? shorter : too_short) += 1;
  }
  MESSAGE("libccd: ", disagree, " differ on touching; of ", deep_pairs, " that overlap ", shorter,
          " have a shorter way out there, ", too_short, " one that does not part them, ", deeper,
          " a longer one; it gave up ", failed, " times");
  CHECK(disagree == 0);
  CHECK(shorter == 0);
  CHECK(too_short + deeper + failed < deep_pairs / 500);  // its misses; all axes agree with silt
}
#endif

}  // namespace gjk_test
