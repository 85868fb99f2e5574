// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/shape/narrow/super_ellipsoid_plane.hpp>

#include "near.hpp"
#include "oracle.hpp"
#include "pair_count.hpp"
#include "two_bodies.hpp"

namespace super_ellipsoid_contact_test {

namespace {

using silt::SuperEllipsoid;
using silt::Vec3d;
using Real = silt::Lanes<silt::DefaultArch>::Real;
constexpr std::size_t W = silt::Lanes<silt::DefaultArch>::width;
using LanePair = silt::PosedPair<silt::SuperForm<Real>, silt::SuperForm<Real>>;

double size_of(const pairs::Pair& p) { return std::min(p.i.size, p.j.size); }

silt::BodyContact<double> cold(const pairs::Pair& pair) {
  silt::NormalMemory<double> memory;
  return touch(pair, memory);
}

/// A contact's lane k as doubles: overlap, normal, point, R_eff.
std::array<double, 8> values(const silt::BodyContact<Real>& c, std::size_t k) {
  const auto of = [&](const Real& x) { return silt::one_lane<double>(x, k); };
  return {of(c.overlap), of(c.normal.x), of(c.normal.y), of(c.normal.z),
          of(c.point.x), of(c.point.y),  of(c.point.z),  of(c.R_eff)};
}
bool lane_of(const silt::Mask<Real>& mask, std::size_t k) { return silt::lane_bits(mask) >> k & 1; }

}  // namespace

TEST_CASE("super_ellipsoids: spheres as s = 2 agree with spheres to 1e-12") {
  pairs::Source from(1);
  for (int k = 0; k < 2000; ++k) {
    const double ri = from.uniform(0.5, 2), rj = from.uniform(0.5, 2);
    const Vec3d ray = from.direction();
    const double distance = (ri + rj) * from.uniform(0.7, 1.05);
    pairs::Pair p{form_of(SuperEllipsoid{ri, ri, ri}), form_of(SuperEllipsoid{rj, rj, rj}),
                  silt::body_axes(from.turn()), silt::body_axes(from.turn()), ray * distance};
    const auto c = cold(p);
    CHECK(c.touches == (distance < ri + rj));
    CHECK(c.solved);
    if (!c.touches) continue;
    CHECK(std::abs(c.overlap - (ri + rj - distance)) < 1e-12);
    CHECK(norm(c.normal + ray) < 1e-12);
    CHECK(norm(c.point - ray * (0.5 * (ri + distance - rj))) < 1e-12);
    CHECK(std::abs(c.R_eff - ri * rj / (ri + rj)) < 1e-12);
    // A sphere as the partner of one of s = 2, either way round.
    silt::PosedPair<pairs::Form, silt::SphereForm<double>> mixed{p.i, silt::sphere_form(rj),
                                                                 p.turn_i, p.turn_j, p.between};
    silt::NormalMemory<double> memory;
    const auto d = touch(mixed, memory);
    CHECK(std::abs(d.overlap - c.overlap) < 1e-12);
    CHECK(norm(d.normal - c.normal) < 1e-12);
    CHECK(norm(d.point - c.point) < 1e-12);
  }
}

TEST_CASE("super_ellipsoids: a sphere touches where its centre is nearest") {
  pairs::Source from(2);
  for (int k = 0; k < 500; ++k) {
    const auto shape = from.shape(12, 4);
    silt::PosedPair<pairs::Form, silt::SphereForm<double>> p{form_of(shape),
                                                             silt::sphere_form(0.5),
                                                             silt::body_axes(from.turn()),
                                                             silt::body_axes(silt::Quaternion{}),
                                                             {}};
    const Vec3d n = from.direction(), foot = support_of(p.i, n);
    p.between = p.turn_i.to_space(foot + n * 0.49);  // n is the normal at the foot
    silt::NormalMemory<double> memory;
    const auto c = touch(p, memory);
    CHECK(c.touches);
    CHECK(std::abs(c.overlap - 0.01) < 1e-10);
    CHECK(norm(c.normal + p.turn_i.to_space(n)) < 1e-7);
    CHECK(norm(c.point - p.turn_i.to_space(foot - n * 0.005)) < 1e-7 * shape.bounding_radius());
  }
}

TEST_CASE("super_ellipsoids: normals along axes and in planes of the body make finite caps") {
  for (const double s1 : {2.0, 2.5, 8.0, 40.0})
    for (const double s2 : {2.0, 3.0, 40.0}) {
      const auto form = form_of(SuperEllipsoid{1, 30, 2, s1, s2});
      for (const Vec3d& n : {Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}, Vec3d{0.6, 0.8, 0},
                             Vec3d{0, 0.6, -0.8}, Vec3d{1e-17, 0, -1}}) {
        Vec3d s, t;
        silt::tangents(n, s, t);
        const auto cap = cap_at(form, n, s, t);
        for (const double x : {cap.height, cap.along_s, cap.along_t, cap.radii.xx, cap.radii.xy,
                               cap.radii.yy, cap.pace.xx})
          CHECK(std::isfinite(x));
        CHECK(cap.radii.xx > 0);
        CHECK(cap.height > 0);
      }
    }
}

TEST_CASE("super_ellipsoids: rounded faces change the height by less than 3 face_rounding") {
  pairs::Source from(3);
  double most = 0;
  for (int k = 0; k < 20000; ++k) {
    const auto shape = from.shape(40, 30);
    const Vec3d n = from.direction();
    Vec3d s, t;
    silt::tangents(n, s, t);
    const double error = silt::cap_at(form_of(shape), n, s, t).height - shape.height(n);
    const double allowed = 3 * shape.face_rounding * shape.smallest_axis();
    CHECK(error < 1e-13 * shape.bounding_radius());
    CHECK(error > -allowed);
    most = std::max(most, -error / allowed);
    if (shape.s1 == 2 && shape.s2 == 2) CHECK(std::abs(error) < 1e-13 * shape.bounding_radius());
  }
  CHECK(most > 0.5);
}

TEST_CASE("super_ellipsoids: height, point and radii of a cap are those of one convex body") {
  pairs::Source from(4);
  for (int k = 0; k < 2000; ++k) {
    const auto shape = from.shape(40, 10);
    const auto form = form_of(shape);
    const Vec3d n = from.direction();
    Vec3d s, t;
    silt::tangents(n, s, t);
    const auto cap = silt::cap_at(form, n, s, t);
    const Vec3d p = support_of(form, n);
    CHECK(std::abs(dot(n, p) - cap.height) < 1e-13 * shape.bounding_radius());
    // Turning the normal by h moves the point by the radii: central differences err by h^2.
    const double h = 1e-6 * std::min({1.0, std::abs(n.x), std::abs(n.y), std::abs(n.z)});
    const Vec3d dp = (support_of(form, silt::normalised(n + s * h)) -
                      support_of(form, silt::normalised(n - s * h))) *
                     (0.5 / h);
    const double large = cap.radii.xx + cap.radii.yy, noise = 1e-15 * shape.bounding_radius() / h;
    CHECK(std::abs(dot(dp, s) - cap.radii.xx) < 1e-4 * large + noise);
    CHECK(std::abs(dot(dp, t) - cap.radii.xy) < 1e-4 * large + noise);
    CHECK(std::abs(dot(dp, n)) < 1e-4 * large + noise);
    CHECK(cap.radii.xx > 0);
    CHECK(cap.radii.xx * cap.radii.yy > cap.radii.xy * cap.radii.xy);
    // Away from faces the radii are those of the surface itself.
    const double R = contact_radius(form, cap), exact = shape.contact_radius(shape.support(n));
    if (shape.s1 <= 4 && shape.s2 <= 4) CHECK(std::abs(R / exact - 1) < 0.03);
  }
}

TEST_CASE("super_ellipsoids: overlap has the normal and the lever arm as its derivatives") {
  pairs::Source from(5);
  for (int k = 0; k < 500; ++k) {
    const auto p = pairs::general(from, 12, 3, from.log_uniform(1e-4, 0.02));
    const auto c = cold(p.pair);
    REQUIRE(c.touches);
    const double h = 1e-6,
                 curve = 1e-6 * size_of(p.pair);  // central differences: h^2, rounding / h
    const auto after = [&](const Vec3d& shift, const Vec3d& axis, double angle) {
      auto q = p.pair;
      q.between = q.between - shift;  // i moves by shift
      const auto turn = silt::rotation_about(axis, angle);
      q.turn_i = silt::body_axes(turn * p.turn_i);
      return cold(q).overlap;
    };
    const Vec3d u = from.direction();
    const double slope = (after(u * h, u, 0) - after(-u * h, u, 0)) / (2 * h);
    CHECK(std::abs(slope - dot(c.normal, u) * -1) < 1e-6);
    const double couple = (after({}, u, h) - after({}, u, -h)) / (2 * h);
    CHECK(std::abs(couple - dot(cross(c.point, c.normal), u) * -1) < curve);
  }
}

TEST_CASE("super_ellipsoids: swapped bodies give the same contact seen from the other side") {
  pairs::Source from(6);
  for (int k = 0; k < 500; ++k) {
    const auto p = pairs::general(from, 20, 5, from.log_uniform(1e-4, 0.02));
    const pairs::Pair back{p.pair.j, p.pair.i, p.pair.turn_j, p.pair.turn_i, -p.pair.between};
    const auto a = cold(p.pair), b = cold(back);
    REQUIRE(a.touches);
    CHECK(std::abs(a.overlap - b.overlap) < 1e-12 * size_of(p.pair));
    CHECK(norm(a.normal + b.normal) < 1e-6);
    CHECK(norm(a.point - p.pair.between - b.point) < 2e-7 * size_of(p.pair));
  }
}

TEST_CASE("super_ellipsoids: 100 % solved, in general position and with aligned faces") {
  pairs::Source from(7);
  int touching = 0, steps = 0;
  for (int k = 0; k < 20000; ++k) {
    const double sign = k % 4 == 0 ? -1 : 1, depth = sign * from.log_uniform(1e-6, 0.1);
    auto p = k % 2 == 0 ? pairs::general(from, 40, 30, depth)
                        : pairs::aligned(from, 40, 30, from.log_uniform(1e-6, 1e-2), depth);
    const auto found = silt::find_common_normal(p.pair, {0, 0, 0});
    CHECK(found.solved);
    CHECK((found.depth > 0) == (depth > 0));
    CHECK((found.depth < 0 || found.residual <= silt::normal_tolerance * size_of(p.pair)));
    touching += found.depth > 0, steps = std::max(steps, found.evaluations);
  }
  CHECK(touching == 15000);
  CHECK(steps < 800);
}

TEST_CASE("super_ellipsoids: a pack of moving pairs gives what each pair alone gives anew") {
  pairs::Source from(8);
  for (int block = 0; block < 300; ++block) {
    std::array<pairs::Posed, W> posed;
    LanePair lanes;
    silt::NormalMemory<Real> memory;
    const double s = block % 3 == 0 ? 2 : 40;
    for (std::size_t l = 0; l < W; ++l)
      posed[l] = l % 2 == 0 ? pairs::general(from, s, 5, from.uniform(-0.002, 0.01))
                            : pairs::aligned(from, s, 5, 1e-3, from.uniform(-0.002, 0.01));
    for (int step = 0; step < 5; ++step) {
      for (std::size_t l = 0; l < W; ++l) {
        pairs::move(from, posed[l], from.log_uniform(1e-7, 1e-4));
        silt::set_lane(lanes, posed[l].pair, l);
      }
      const auto found = touch<silt::ContactRadius::Local>(lanes, memory);
      const auto apart = silt::apart(lanes, memory);
      for (std::size_t l = 0; l < W; ++l) {
        const auto& pair = posed[l].pair;
        silt::NormalMemory<double> none;
        const auto one = touch<silt::ContactRadius::Local>(pair, none);
        const auto v = values(found, l);
        CHECK(lane_of(found.touches, l) == one.touches);
        CHECK(lane_of(found.solved, l));
        CHECK(!(lane_of(apart, l) && one.touches));
        if (!one.touches) continue;
        // The overlap misses slope times turn_tolerance, with slopes of up to 1e-4 sizes here.
        CHECK(std::abs(v[0] - one.overlap) < 1e-11 * pair.i.bound);
        CHECK(norm(Vec3d{v[1], v[2], v[3]} - one.normal) < 1e-6);
        CHECK(norm(Vec3d{v[4], v[5], v[6]} - one.point) < 1e-7 * size_of(pair));
        CHECK(std::abs(v[7] / one.R_eff - 1) < 0.05);
      }
    }
  }
}

TEST_CASE("super_ellipsoids: kernels for s = 2 and for s1 = s2 agree with that for any exponents") {
  pairs::Source from(9);
  for (const double s : {2.0, 5.0})
    for (int k = 0; k < 200; ++k) {
      auto p = pairs::general(from, 2, 3, 0.01);
      p.i.s1 = p.i.s2 = s;
      const auto any = form_of(p.i);
      const Vec3d n = from.direction();
      Vec3d u, v;
      silt::tangents(n, u, v);
      const auto a = cap_at(any, n, u, v);
      const auto b =
          s == 2
              ? cap_at(std::bit_cast<silt::SuperForm<double, silt::Exponents::Two>>(any), n, u, v)
              : cap_at(std::bit_cast<silt::SuperForm<double, silt::Exponents::Equal>>(any), n, u,
                       v);
      CHECK(std::abs(a.height - b.height) < 1e-13 * any.bound);
      CHECK(std::abs(a.along_s - b.along_s) < 1e-13 * any.bound);
      CHECK(std::abs(a.radii.xx - b.radii.xx) < 1e-10 * any.bound);
      CHECK(std::abs(a.radii.xy - b.radii.xy) < 1e-10 * any.bound);
    }
}

TEST_CASE("super_ellipsoids: the least depth is that of a search over all directions") {
  pairs::Source from(10);
  for (int k = 0; k < 60; ++k) {
    const auto p = k % 2 == 0 ? pairs::general(from, 12, 3, from.log_uniform(1e-3, 0.03))
                              : pairs::aligned(from, 12, 3, 1e-2, from.log_uniform(1e-3, 0.03));
    const double least = oracle::least_depth(p.pair), found = cold(p.pair).overlap;
    CAPTURE(k);
    // A pattern search stops some 1e-9 rad from a minimum whose curvature is 1e3 sizes at most.
    CHECK(std::abs(found - least) < 1e-6 * size_of(p.pair));
  }
}

#if defined(SILT_TEST_CCD)
TEST_CASE("super_ellipsoids: 100 000 pairs touch where libccd's GJK says so") {
  pairs::Source from(11);
  const int count = pairs::count(100000);
  int compared = 0;
  for (int k = 0; k < count; ++k) {
    const double depth = (k % 3 == 0 ? -1 : 1) * from.log_uniform(1e-4, 0.1);
    const double s = k % 5 == 0 ? 2 : k % 5 == 1 ? 40 : 8, aspect = k % 7 == 0 ? 30 : 3;
    const auto p = k % 2 == 0
                       ? pairs::general(from, s, aspect, depth)
                       : pairs::aligned(from, s, aspect, from.log_uniform(1e-6, 1e-2), depth);
    const auto c = cold(p.pair);
    // GJK stops on an absolute tolerance of some 1e-5.
    if (std::abs(c.overlap) < 1e-4) continue;
    ++compared;
    CHECK(c.touches == oracle::Ccd(p.pair).touch());
  }
  CHECK(compared > 0.8 * count);
}

TEST_CASE("super_ellipsoids: libccd's EPA finds the same depth in 2 000 touching pairs") {
  pairs::Source from(12);
  const int count = pairs::count(2000);
  int compared = 0, missed = 0;
  double least = 1, most = 0;
  for (int k = 0; k < count; ++k) {
    const auto p = pairs::general(from, k % 2 == 0 ? 4 : 12, 3, from.log_uniform(1e-3, 0.05));
    const double depth = oracle::Ccd(p.pair).depth(), found = cold(p.pair).overlap;
    if (depth <= 0) continue;  // it gives up on some
    ++compared;
    const double more = (found - depth) / size_of(p.pair);
    least = std::min(least, more);
    // One in thousands ends early: then a search over all directions tells who is right.
    if (more > 1e-3 && ++missed)
      CHECK(std::abs(found - oracle::least_depth(p.pair)) < 1e-6 * size_of(p.pair));
    else
      most = std::max(most, more);
  }
  CHECK(compared > 0.95 * count);
  // EPA measures a polytope inside the sum of the bodies: never more, and less by the height of a
  // cap over its facets, at which it stops.
  MESSAGE("libccd: of ", compared, " depths ", missed, " missed; the others at most ", most,
          " sizes less");
  CHECK(least > -1e-9);
  CHECK(most < 1e-3);
  CHECK(missed <= 2 + compared / 1000);
}
#endif

TEST_CASE(
    "super_ellipsoids: the point of two faces moves without jumps as they tilt through zero") {
  const SuperEllipsoid block{1, 1, 1, 8, 8};
  const auto form = form_of(block);
  pairs::Pair p{form, form, silt::body_axes(silt::Quaternion{}), {}, {}};
  silt::NormalMemory<double> memory;
  Vec3d last{}, first{};
  double jump = 0, last_overlap = 0;
  const double step = 1e-6;
  for (int k = -2000; k <= 2000; ++k) {
    const double tilt = k * step;
    p.turn_j = silt::body_axes(silt::rotation_about({1, 0, 0}, tilt));
    p.between = {0.3 + 1e-4 * k / 2000, 0.2, 1.995};
    const auto c = touch(p, memory);
    REQUIRE(c.touches);
    CHECK(c.solved);
    if (k > -2000) {
      jump = std::max(jump, norm(c.point - last));
      CHECK(std::abs(c.overlap - last_overlap) < 2 * step);  // the overlap's slope is a lever arm
    } else {
      first = c.point;
    }
    last = c.point, last_overlap = c.overlap;
  }
  CHECK(norm(last - first) > 0.5);  // from one side of the face towards the other
  // Both faces have the same radius of curvature in the middle, some 1000 a: the point moves by at
  // most half of that times the step, and a little for the shift.
  const auto cap = cap_at(form, Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0});
  CHECK(jump < 0.5 * cap.radii.xx * step + 1e-6);
  CHECK(jump > 0.1 * cap.radii.xx * step);
}

TEST_CASE("super_ellipsoids: elastic collisions keep energy to the integrator's order") {
  for (const double s : {2.0, 4.0, 8.0, 20.0}) {
    double coarse = 0, fine = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
      const auto a = two_bodies::collide(s, two_bodies::Overlap::Common, 50, seed);
      const auto b = two_bodies::collide(s, two_bodies::Overlap::Common, 200, seed);
      CHECK(a.touched);
      CHECK(b.parted);
      coarse += std::abs(a.energy) / 20, fine += std::abs(b.energy) / 20;
      CHECK(b.momentum < 1e-12);
      CHECK(b.angular_momentum < 1e-12);
    }
    CAPTURE(s);
    // Second order, and 5/2 as the force starts like overlap^(3/2): a quarter of the step leaves
    // 1/16 to 1/32; measured 1/45 to 1/26.
    CHECK(coarse < 1e-4);
    CHECK(fine < coarse / 12);
  }
}

TEST_CASE("super_ellipsoid_plane: rests on its lowest point, and agrees with a huge sphere") {
  pairs::Source from(13);
  for (int k = 0; k < 300; ++k) {
    const auto shape = from.shape(20, 5);
    const auto form = form_of(shape);
    const auto turn = silt::body_axes(from.turn());
    const Vec3d n = from.direction();
    const double low = dot(n, turn.to_space(support_of(form, -turn.to_body(n))));
    double R = 0;
    const auto c = touch_plane(form, turn, n, -low - 0.01, R);
    CHECK(c.touches);
    CHECK(std::abs(c.overlap - 0.01) < 1e-13 * form.bound);
    CHECK(std::abs(dot(c.point, n) - low - 0.005) < 1e-13 * form.bound);
    CHECK(c.normal == n);
    CHECK(R == c.R_eff);
    const auto gone = touch_plane(form, turn, n, -low + 0.01, R);
    CHECK(!gone.touches);
    CHECK(R == 0);
    const double huge = 1e6;  // overlaps agree to overlap size / huge, points to radius / huge
    silt::PosedPair<pairs::Form, silt::SphereForm<double>> pair{form, silt::sphere_form(huge), turn,
                                                                turn, n * (low + 0.01 - huge)};
    silt::NormalMemory<double> memory;
    const auto d = touch(pair, memory);
    CHECK(std::abs(d.overlap - c.overlap) < 1e-3 * form.bound);
  }
}

TEST_CASE(
    "poly_super_ellipsoid: equal halves touch as the super-ellipsoid, others as their octant") {
  pairs::Source from(14);
  using Poly = silt::PolyForm<double>;
  for (int k = 0; k < 500; ++k) {
    const auto p = pairs::general(from, 12, 3, from.uniform(-0.01, 0.02));
    const auto poly = [](const SuperEllipsoid& s) {
      return form_of(silt::PolySuperEllipsoid{{s.a, s.b, s.c}, {s.a, s.b, s.c}, s.s1, s.s2});
    };
    silt::PosedPair<Poly, Poly> q{poly(p.i), poly(p.j), p.pair.turn_i, p.pair.turn_j,
                                  p.pair.between};
    silt::NormalMemory<double> memory;
    const auto a = cold(p.pair), b = touch(q, memory);
    CHECK(a.touches == b.touches);
    if (a.touches) CHECK(std::abs(a.overlap - b.overlap) < 1e-12 * p.pair.i.bound);
    // Lopsided bodies: solved, and points of the true octants.
    q.i.minus2 = q.i.minus2 * 0.5, q.j.minus2 = q.j.minus2 * 0.7;
    silt::NormalMemory<double> none;
    const auto c = touch(q, none);
    CHECK(c.solved);
    if (!c.touches) continue;
    const Vec3d n = q.turn_i.to_body(-c.normal), x = support_of(q.i, n);
    CHECK((n.x < 0) == (x.x < 0));
    CHECK(norm(q.turn_i.to_space(x) + c.normal * (0.5 * c.overlap) - c.point) < 1e-6 * q.i.bound);
  }
}

TEST_CASE("super_ellipsoids: bodies about one centre, far ones and memory of pairs that part") {
  const auto form = form_of(SuperEllipsoid{1, 2, 3, 8, 4});
  const auto straight = silt::body_axes(silt::Quaternion{});
  pairs::Pair p{form, form, straight, straight, {0, 0, 0}};
  const auto c = cold(p);
  CHECK(c.touches);
  CHECK(c.solved);
  CHECK(std::isfinite(c.overlap));

  silt::NormalMemory<double> memory;
  p.between = {0, 0, 5.9};
  CHECK(touch(p, memory).touches);
  CHECK(memory.R_eff > 0);
  p.between = {0, 0, 6.1};
  const auto close = touch(p, memory);
  CHECK(!close.touches);
  CHECK(memory.R_eff == 0);
  CHECK(memory.follows != 0);
  CHECK(close.overlap == near(-0.1).epsilon(0.02));
  CHECK(silt::apart(p, memory));
  p.between = {0, 0, 60};
  const auto far = touch(p, memory);
  CHECK(!far.touches);
  CHECK(far.solved);
  CHECK(memory.follows == 0);
}

}  // namespace super_ellipsoid_contact_test
