// silt - BSD-3-Clause, see LICENSE
#include "near.hpp"
#include "solid_bodies.hpp"

namespace solid_rims_test {

using namespace solid_test;

namespace {

Touches at(const Cylinder& wall, const auto& body) {
  return all([&](SolidContact* out, int n) { return cylinder_contacts(body, wall, out, n); });
}
Touches at(const Cone& wall, const auto& body) {
  return all([&](SolidContact* out, int n) { return cone_contacts(body, wall, out, n); });
}

const Cylinder tube{{0, 0, 0}, {0, 0, 3}, 1, Side::Inside};
const Cylinder shaft{{0, 0, -3}, {0, 0, 0}, 1, Side::Outside};  // its upper rim
const Cone funnel{{0, 0, 0}, {0, 0, 3}, 0.7, 2, Side::Inside};
const Cone spike{{0, 0, 0}, {0, 0, 3}, 1.5, 0.7, Side::Outside};
const Cone tip{{0, 0, 0}, {0, 0, 3}, 0, 2, Side::Outside};

template <class Action>
void for_walls(Action&& action) {
  action(tube), action(shaft), action(funnel), action(spike), action(tip);
}

/// How deep p is in a body: the least over directions of h(m) - m . p, by smaller and smaller
/// steps.
double depth_of(const auto& body, const Vec3d& p, Vec3d m) {
  const auto over = [&](const Vec3d& n) { return dot(n, body.support(n) - p); };
  double best = over(m);
  for (double step = 0.2; step > 1e-8;) {
    Vec3d s, t;
    const Vec3d from = m;
    tangents(from, s, t);
    bool better = false;
    for (int k = 0; k < 8; ++k) {
      const Vec3d n =
          normalised(from + (step * std::cos(k * pi / 4)) * s + (step * std::sin(k * pi / 4)) * t);
      if (const double d = over(n); d < best) best = d, m = n, better = true;
    }
    if (!better) step *= 0.5;
  }
  return best;
}

/// The largest jump of the deepest overlap on a path, over `depth`: where it changes most, halved
/// until the motion is 1e-9 long.
template <class Wall, class Body>
double largest_jump(const Wall& wall, const Body& body, const Vec3d& way, double depth) {
  constexpr int parts = 1000;
  const auto overlap = [&](double part) {
    const auto found = at(wall, moved(body, part * way, {}));
    return found.empty() ? 0 : found[0].overlap;
  };
  double worst = 0, before = overlap(0);
  for (int k = 1; k <= parts; ++k) {
    double low = (k - 1.0) / parts, high = 1.0 * k / parts, at_low = before,
           at_high = overlap(high);
    before = at_high;
    while ((high - low) * norm(way) > 1e-9 && std::abs(at_high - at_low) > 0.01 * depth) {
      const double middle = 0.5 * (low + high), there = overlap(middle);
      if (std::abs(there - at_low) > std::abs(at_high - there))
        high = middle, at_high = there;
      else
        low = middle, at_low = there;
    }
    if ((high - low) * norm(way) <= 1e-9) worst = std::max(worst, std::abs(at_high - at_low));
  }
  return worst / depth;
}

/// Lays a body on the wall at z = 1 or -1, `depth` deep.
template <class Wall, class Body>
Body laid(const Wall& wall, const Body& body, double z, double depth) {
  const bool inside = wall.side == Side::Inside;
  double low = 0, high = 1.5;
  const auto there = [&](double x) {
    return moved(body, Vec3d{inside ? x : 3 - x, 0, z}, Quaternion{});
  };
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    const auto found = at(wall, there(middle));
    (found.empty() || found[0].overlap < depth ? low : high) = middle;
  }
  return there(low);
}

}  // namespace

TEST_CASE("solid rims: a super-ellipsoid that is a sphere touches rims and surfaces as a sphere") {
  Draws r(1);
  int touching = 0, on_rim = 0;
  for (int k = 0; k < 5000; ++k) {
    const double R = r.uniform(0.05, 0.4);
    const Vec3d centre{r.uniform(-1.5, 1.5), r.uniform(-1.5, 1.5), r.uniform(-0.4, 0.4)};
    const auto ball = place(SuperEllipsoid{R, R, R}, centre, r.turn());
    for_walls([&](const auto& wall) {
      SurfacePoint s{};
      const int n = wall.contacts(centre, R, &s);
      if (n == 1 && s.distance < 0.3 * R) return;  // deep
      const auto found = at(wall, ball);
      REQUIRE(static_cast<int>(found.size()) == n);
      if (n == 0) return;
      ++touching, on_rim += detail::is_rim(found[0]);
      CHECK(std::abs(found[0].overlap - (R - s.distance)) < 1e-13);
      CHECK(norm(found[0].normal - s.normal) < 1e-9);
      CHECK(found[0].R_eff == near(R));
    });
  }
  CHECK(touching > 2000);
  CHECK(on_rim > 700);
}

TEST_CASE("solid rims: dilated points and polyhedra of 120 corners touch rims as spheres do") {
  Draws r(2);
  std::vector<Vec3d> fine, small;
  for (int k = 0; k < 120; ++k) {
    const double z = 1 - (2 * k + 1.0) / 120, s = std::sqrt(1 - z * z), phi = 2.399963229728653 * k;
    fine.push_back(0.3 * Vec3d{s * std::cos(phi), s * std::sin(phi), z});
    if (k % 10 == 0) small.push_back(1e-7 * fine.back());
  }
  const auto facets = Polyhedron::from_points(fine), point = Polyhedron::from_points(small, 0.3);
  // The surface of the fine one is up to 0.009 below that of the sphere, its faces turned by 0.25.
  const double within = 0.009, turned = 0.25;
  int touching = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3d centre{r.uniform(-1.5, 1.5), r.uniform(-1.5, 1.5), r.uniform(-0.4, 0)};
    const Quaternion turn = r.turn();
    const auto check = [&](const auto& wall) {
      SurfacePoint s{};
      const int n = wall.contacts(centre, 0.3, &s);
      if (n == 1 && (s.distance < 0.27 || s.normal.z > -0.2)) return;  // deep, or on the surface
      const auto dilated = at(wall, place(point, centre, turn));
      const auto sharp = at(wall, place(facets, centre, turn));
      REQUIRE(static_cast<int>(dilated.size()) == n);
      if (n == 0) {
        CHECK(sharp.empty());
        return;
      }
      ++touching;
      CHECK(std::abs(dilated[0].overlap - (0.3 - s.distance)) < 3e-8);  // the size of its core
      CHECK(norm(dilated[0].normal - s.normal) < 2e-7);
      if (s.distance > 0.3 - within) return;
      REQUIRE(sharp.size() > 0);
      CHECK(std::abs(sharp[0].overlap - (0.3 - s.distance)) < within);
      CHECK(norm(sharp[0].normal - s.normal) < turned);
    };
    check(tube), check(funnel), check(spike);
  }
  CHECK(touching > 300);
}

TEST_CASE(
    "solid rims: the deepest place of the rim, by steps; a potential; gone behind its depth") {
  Draws r(3);
  int found_on_rim = 0;
  for (const double s : {2., 3., 8., 20., 1.})  // 1: dilated polyhedra
    for (int k = 0; k < 25; ++k) {
      const double phi = r.uniform(0, 2 * pi), lean = r.uniform(0.3, 2.8);
      const double depth = std::pow(10, r.uniform(-5, -2.5));
      const Vec3d e{std::cos(phi), std::sin(phi), 0},
          n = std::cos(lean) * e - Vec3d{0, 0, std::sin(lean)};
      const auto check = [&](auto body, double grown) {
        body = moved(body, e - (depth - grown) * n - body.support(-n), {});
        const auto find = [&](const auto& b) { return at(tube, b); };
        const auto touches = find(body);
        INFO("s ", s, " k ", k);
        // The deepest on this side by halving steps of the angle.
        double best = -1, best_phi = phi;
        const auto look = [&](double x) {
          const double d = depth_of(body, Vec3d{std::cos(x), std::sin(x), 0}, -n) + grown;
          if (d > best) best = d, best_phi = x;
          return best_phi == x;
        };
        look(phi);
        for (double step = 0.02; step > 1e-7;)
          if (!look(best_phi + step) && !look(best_phi - step)) step *= 0.5;
        double error = 1;
        for (const auto& c : touches)
          if (detail::is_rim(c)) error = std::min(error, std::abs(c.overlap - best));
        // Steps of 1e-8 rad and 1e-7 m are far below; the second order of the angle's is 1e-14.
        CHECK(error < 1e-9 + 1e-6 * best);
        // Differences over 1e-7: rounding 1e-9, second derivatives up to some 100/size.
        CHECK(potential_error(body, find, 1e-7) < 1e-5);
        ++found_on_rim;
      };
      if (s >= 2) {
        const SuperEllipsoid shape{r.uniform(.2, .5), r.uniform(.2, .5), r.uniform(.2, .5), s, s};
        check(place(shape, {0, 0, 0}, r.turn()), 0);
      } else if (s == 1) {
        const auto round = Polyhedron::from_points(
            shape_test::box_corners({-.15, -.15, -.15}, {.15, .15, .15}), 0.05);
        check(place(round, {0, 0, 0}, r.turn()), 0.05);
      }
    }
  CHECK(found_on_rim == 125);
}

TEST_CASE("solid rims: a body that slides over a rim meets no step: its overlap is continuous") {
  Draws r(4);
  const double depth = 1e-3;
  const auto die = shape_test::box({0.4, 0.4, 0.4});
  const auto round =
      Polyhedron::from_points(shape_test::box_corners({-.15, -.15, -.15}, {.15, .15, .15}), 0.05);
  double smooth = 0, dilated = 0;
  std::vector<double> sharp;
  for (int k = 0; k < 8; ++k) {
    const auto turn = k == 0   ? Quaternion{}
                      : k == 1 ? rotation_about({0.3, 1, 0.1}, 1e-3)
                      : k == 2 ? rotation_about({0.3, 1, 0.1}, -1e-3)
                               : r.turn();
    const auto slide = [&](const auto& wall, const auto& body, double out) {
      return largest_jump(wall, laid(wall, body, -out, depth), {0, 0, out * 1.6}, depth);
    };
    for (const double s : {2., 8., 20.}) {
      const auto body = place(SuperEllipsoid{0.2, 0.3, 0.25, s, s}, {0, 0, 0}, turn);
      smooth = std::max({smooth, slide(tube, body, -1), slide(shaft, body, 1)});
    }
    dilated = std::max({dilated, slide(tube, place(round, {0, 0, 0}, turn), -1),
                        slide(shaft, place(round, {0, 0, 0}, turn), 1)});
    sharp.push_back(std::max(slide(tube, place(die, {0, 0, 0}, turn), -1),
                             slide(shaft, place(die, {0, 0, 0}, turn), 1)));
  }
  INFO("jumps over the depth: super-ellipsoids ", smooth, ", dilated cube ", dilated);
  CHECK(smooth < 0.01);
  CHECK(dilated < 0.01);
  // Corners of a sharp one hand over to its edges by jumps, of less than what they touch with.
  CHECK(*std::max_element(sharp.begin(), sharp.end()) < 0.8);
}

TEST_CASE("solid rims: what lies flat on a wall and a body next to a rim have one contact each") {
  // A sharp cube in the tube, flush with its end and a little beyond: four corners, then two and
  // the rim.
  const auto die = shape_test::box({0.4, 0.4, 0.4});
  const auto in = laid(tube, place(die, {0, 0, 0}, {}), 1, 1e-3);
  REQUIRE(at(tube, in).size() == 4);
  for (const double z : {0.3, 0.2001, 0.1999, 0.1, 0.01, -0.1, -0.19}) {
    const auto touches = at(tube, moved(in, {0, 0, z - 1}, {}));
    REQUIRE(touches.size() == 4);
    for (const auto& c : touches) {
      CHECK(c.overlap == near(1e-3).epsilon(1e-6));
      CHECK(std::abs(c.normal.z) < 1e-6);
    }
  }
  CHECK(at(tube, moved(in, {0, 0, -1.201}, {})).empty());
  // Past the end on the other side of the surface a body is not behind it.
  CHECK(at(tube, place(die, {1.1, 0, -0.21}, {})).empty());
  const auto on = at(tube, place(die, {1.1, 0, -0.199}, {}));
  REQUIRE(on.size() >= 1);
  for (const auto& c : on) {
    CHECK(c.overlap == near(1e-3));
    CHECK(norm(c.normal - Vec3d{0, 0, -1}) < 1e-12);
  }
}

}  // namespace solid_rims_test
