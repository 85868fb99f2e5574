// silt - BSD-3-Clause, see LICENSE

#include "solids.hpp"

#include "near.hpp"
#include "pair_count.hpp"

namespace solid_pairs_test {

using namespace solids;
using silt::least_gap_of;
using silt::touch_solids;

namespace {

/// j so that it overlaps i by `depth` [m] where the direction `towards` looks (upper bound of it).
template <class A, class KindJ>
auto placed_at(const A& i, const KindJ& kind, const Quaternion& turn, const Vec3d& towards,
               double depth) {
  const auto j = kind.at({0, 0, 0}, turn);
  return kind.at(farthest(i, towards) - farthest(j, -towards) - depth * towards, turn);
}

/// The boxes and hulls of the tests with super-ellipsoids.
std::vector<Polyhedron> many_shapes(Random& random) {
  std::vector<Polyhedron> out;
  for (int k = 0; k < 12; ++k) out.push_back(random.hull(4 + 2 * k));
  for (int k = 0; k < 4; ++k) {
    const Vec3d e{random.uniform(0.3, 0.9), random.uniform(0.3, 0.9), random.uniform(0.3, 0.9)};
    out.push_back(shape_test::box(e));
  }
  out.push_back(random.hull(150));  // climbs to its supports
  for (int k = 0; k < 4; ++k)
    out.push_back(Polyhedron::from_points(random.hull(8 + k).vertices(), 0.03 * (k + 1)));
  return out;
}

/// Distance of the bodies [m], 0 if they touch.
template <class A, class B>
double gap_between(const A& i, const B& j) {
  const auto core = [](const auto& body) {
    if constexpr (std::is_same_v<std::decay_t<decltype(body)>, PlacedBall>)
      return std::pair{silt::PointSet{body.position}, body.radius};
    else if constexpr (std::is_same_v<std::decay_t<decltype(body)>, PlacedPolyhedron>)
      return std::pair{body, body.shape->radius()};
    else
      return std::pair{body, 0.0};
  };
  const auto [a, r_a] = core(i);
  const auto [b, r_b] = core(j);
  return std::max(silt::gjk_distance(a, b, Vec3d{0, 0, 0}).distance - r_a - r_b, 0.0);
}

struct Arranged {
  Super i;
  PlacedPolyhedron j;
};

/// Anywhere, shallow, near miss, deep, and aligned: faces, edges and corners of both along the same
/// axes.
Arranged arrange(int kind, const Polyhedron& shape, Random& random) {
  const SuperKind body(random, kind % 2 == 0 ? 4 : 20);
  const auto turn = random.turn();
  const Super i = body.at({0, 0, 0}, turn);
  const SharpKind partner(shape);
  if (kind == 0) return {i, {&shape, {random.in_cube(0.9), random.turn()}}};
  if (kind == 3) return {i, {&shape, {0.1 * random.direction(), random.turn()}}};
  const bool aligned = kind == 4;
  const double depth = kind == 2 ? random.uniform(-1e-4, 1e-4) : random.uniform(0, 0.02);
  const Vec3d sides[] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  const Vec3d towards =
      aligned ? normalised(rotate(turn, sides[static_cast<int>(random.uniform(0, 3))]))
              : random.direction();
  auto placed = placed_at(i, partner, aligned ? turn : random.turn(), towards, depth).pose;
  return {i, {&shape, placed}};
}

}  // namespace

TEST_CASE("solid_pairs: super-ellipsoid and polyhedron, 3e4 pairs: a minimum, or proved apart") {
  Random random(1);
  const auto shapes = many_shapes(random);
  int touching = 0, unproved = 0, gjk_wrong = 0, unsettled = 0, evaluations = 0;
  double of_depth = 0, of_point = 0, outside = 0;
  for (int k = 0, count = pairs::count(30000); k < count; ++k) {
    const auto& shape = shapes[static_cast<std::size_t>(k / 5) % shapes.size()];
    const auto [i, j] = arrange(k % 5, shape, random);
    const auto found = find_corner_normal(i, j, {0, 0, 0});
    NormalMemory<double> memory;
    const auto c = touch_solids(i, j, memory);
    unsettled += !found.settled;
    if (!(c.overlap > 0)) {
      if (memory.follows == 0) continue;  // by the bounding spheres
      const Vec3d m = silt::detail::last_direction_of(i, j, memory);
      unproved += !(-depth_along(i, j, m) >= -c.overlap - 1e-12);
      // Slender simplices once made GJK say that these overlap: two of these pairs.
      const double gap = gap_between(i, j);
      gjk_wrong += gap < -c.overlap - 1e-9 * (gap + shape.radius());
      continue;
    }
    unproved += gap_between(i, j) > 1e-9;
    ++touching, evaluations += found.evaluations;
    const Vec3d m = -c.normal;
    of_depth = std::max(of_depth, std::abs(depth_along(i, j, m) - c.overlap));
    // The point lies half the overlap deep in both bodies; a corner's place is exact, and that of i
    // there as uncertain as the normal times i's radius, up to 1000 m.
    const Vec3d on_i = c.point + (0.5 * c.overlap) * m;
    const Vec3d on_j = c.point - (0.5 * c.overlap - shape.radius()) * m;
    if (found.held != 1) of_point = std::max(of_point, norm(i.support(m) - on_i));
    for (const auto& face : shape.faces())
      outside = std::max(outside, dot(face.normal, j.pose.to_body(on_j)) - face.offset);
  }
  MESSAGE(touching, " touch, by ", static_cast<double>(evaluations) / touching,
          " evaluations from nothing; overlap off by ", of_depth, ", point of i by ", of_point);
  CHECK(touching > 15000);
  CHECK(unproved == 0);
  CHECK(gjk_wrong == 0);
  CHECK(unsettled == 0);
  CHECK(of_depth <= 1e-9);  // turn_tolerance^2 times radii of up to 1000 m
  CHECK(outside <= 1e-12);
  CHECK(of_point <= 1e-6);
}

TEST_CASE("solid_pairs: super-ellipsoid and polyhedron from nothing: the least of all minima") {
  Random random(2);
  const auto shapes = many_shapes(random);
  double above = 0;
  int pairs = 0, lower = 0, deep_above = 0, deep_pairs = 0;
  for (int k = 0; k < 250; ++k) {
    const auto& shape = shapes[static_cast<std::size_t>(random.uniform(0, 21))];
    const auto [i, j] = arrange(k % 5, shape, random);
    NormalMemory<double> memory;
    const auto c = touch_solids(i, j, memory);
    if (!(c.overlap > 0)) continue;
    const double least = least_depth(i, j);  // itself a little above the minimum, or in another
    if (c.overlap < 0.03)
      above = std::max(above, c.overlap - least), ++pairs;
    else
      deep_above += c.overlap > least + 1e-6, ++deep_pairs;
    lower += c.overlap < least - 1e-6;
  }
  MESSAGE("of ", pairs, " shallow pairs at most ", above, " above the least; of ", deep_pairs,
          " deep ones ", deep_above, " are; lower than the brute force: ", lower);
  CHECK(pairs > 100);
  CHECK(above <= 1e-9);
  CHECK(deep_above <= deep_pairs / 100);
}

TEST_CASE("solid_pairs: an ellipsoid with equal axes touches a polyhedron as the ball does") {
  Random random(3);
  const auto shapes = many_shapes(random);
  double of_overlap = 0, of_normal = 0, of_point = 0;
  int touching = 0;
  for (int k = 0; k < 20000; ++k) {
    const auto& shape = shapes[static_cast<std::size_t>(k) % shapes.size()];
    const double radius = random.uniform(0.1, 0.5);
    const Super i{form_of(silt::SuperEllipsoid{radius, radius, radius}), body_axes(random.turn()),
                  random.in_cube(0.7)};
    const PlacedPolyhedron j{&shape, {random.in_cube(0.1), random.turn()}};
    const auto exact = sphere_contact(i.position, radius, j);
    NormalMemory<double> memory;
    const auto c = touch_solids(i, j, memory);
    CHECK((c.overlap > 0) == (exact.overlap > 0));
    if (!(c.overlap > 0)) continue;
    ++touching;
    of_overlap = std::max(of_overlap, std::abs(c.overlap - exact.overlap));
    if (exact.buried && norm(c.normal - exact.normal) > 0.01) continue;  // two faces, equally near
    of_normal = std::max(of_normal, norm(c.normal - exact.normal));
    of_point = std::max(of_point, norm(c.point - exact.point));
  }
  MESSAGE(touching, " touch; overlap off by ", of_overlap, ", normal ", of_normal, ", point ",
          of_point);
  CHECK(touching > 5000);
  CHECK(of_overlap <= 1e-12);
  CHECK(of_normal <= 3e-7);  // turn_tolerance
  CHECK(of_point <= 3e-7);
}

namespace {

/// Largest difference of the overlap's change by place and turn of i from (1) of placed.hpp, over
/// the change; by differences of 2 h.
template <class KindI, class KindJ>
double gradient_error(const KindI& kind_i, const KindJ& kind_j, Random& random) {
  const double h = 1e-5;
  const auto qi = random.turn(), qj = random.turn();
  const auto i = kind_i.at({0, 0, 0}, qi);
  const Vec3d at = silt::detail::place_of(placed_at(i, kind_j, qj, random.direction(), 0.02));
  const auto j = kind_j.at(at, qj);
  NormalMemory<double> memory;
  const auto c = touch_solids(i, j, memory);
  if (!(c.overlap > 1e-3)) return 0;
  double worst = 0;
  const auto overlap_at = [&](const Vec3d& x, const Quaternion& q) {
    auto same = memory;
    return touch_solids(kind_i.at(x, q), j, same).overlap;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3d e{axis == 0 ? 1. : 0., axis == 1 ? 1. : 0., axis == 2 ? 1. : 0.};
    const double by_place = (overlap_at(h * e, qi) - overlap_at(-h * e, qi)) / (2 * h);
    const double by_turn = (overlap_at({0, 0, 0}, silt::rotation_about(e, h) * qi) -
                            overlap_at({0, 0, 0}, silt::rotation_about(e, -h) * qi)) /
                           (2 * h);
    worst = std::max(worst, std::abs(by_place + c.gradient * dot(c.normal, e)));
    const Vec3d torque = cross(c.point, c.normal) + c.couple * c.normal;
    worst = std::max(worst, std::abs(by_turn + c.gradient * dot(torque, e)));
  }
  return worst;
}

}  // namespace

TEST_CASE("solid_pairs: the overlap changes by place and turn as force and couple say, all kinds") {
  Random random(4);
  for_each_pair(
      [&](const auto& i, const auto& j) {
        std::vector<double> errors;
        for (int k = 0; k < 40; ++k) errors.push_back(gradient_error(i, j, random));
        std::sort(errors.begin(), errors.end());
        INFO(i.name, " on ", j.name, ": ", errors[37], ", largest ", errors[39]);
        // Differences of 1e-5 m on radii of some 0.01 m and more, GJK's normals to 1.4e-5. Two in
        // forty may stand across a change of features.
        CHECK(errors[37] <= 1e-4);
        CHECK(errors[20] <= 1e-5);
      },
      random);
}

TEST_CASE("solid_pairs: exchanged bodies have the mirrored contact, all kinds") {
  Random random(5);
  for_each_pair(
      [&](const auto& kind_i, const auto& kind_j) {
        INFO(kind_i.name, " on ", kind_j.name);
        for (int k = 0; k < 40; ++k) {
          const auto i = kind_i.at({0, 0, 0}, random.turn());
          const auto j =
              placed_at(i, kind_j, random.turn(), random.direction(), random.uniform(-0.01, 0.03));
          NormalMemory<double> one, other;
          for (int again = 0; again < 2; ++again) {
            const auto c = touch_solids(i, j, one), d = touch_solids(j, i, other);
            CHECK(std::abs(c.overlap - d.overlap) <= 1e-9);
            CHECK(std::abs(one.R_eff - other.R_eff) <= 1e-6);
            if (!(c.overlap > 0)) continue;
            CHECK(norm(c.normal + d.normal) <= 1e-6);
            CHECK(std::abs(c.couple - d.couple) <= 1e-9);
            CHECK(std::abs(c.gradient - d.gradient) <= 1e-9);
            CHECK(c.R_eff == one.R_eff);
          }
        }
      },
      random);
}

TEST_CASE(
    "solid_pairs: moving pairs, warm: as from nothing, apart where apart, R_eff of the first "
    "touch") {
  Random random(6);
  for_each_pair(
      [&](const auto& kind_i, const auto& kind_j) {
        INFO(kind_i.name, " on ", kind_j.name);
        int differ = 0, touching = 0, wrong = 0, bounds = 0, radii = 0;
        for (int run = 0; run < 8; ++run) {
          const auto turn_i = random.turn();
          Quaternion turn_j = random.turn();
          const auto i = kind_i.at({0, 0, 0}, turn_i);
          const Vec3d towards = random.direction(), axis = random.direction();
          const Vec3d side = normalised(cross(towards, random.direction()));
          const Vec3d first = silt::detail::place_of(placed_at(i, kind_j, turn_j, towards, 0.005));
          NormalMemory<double> memory;
          double R_eff = 0;
          for (int step = -40; step < 40; ++step) {
            const double x = step / 40.0;
            turn_j = silt::rotation_about(axis, 2e-3) * turn_j;
            const auto j = kind_j.at(first + 0.02 * x * x * towards + 0.02 * x * side, turn_j);
            const double least = least_gap_of(i, j, memory);
            const auto warm = touch_solids(i, j, memory);
            NormalMemory<double> fresh;
            const auto cold = touch_solids(i, j, fresh);
            wrong += (warm.overlap > 0) != (cold.overlap > 0);
            bounds += warm.overlap > 0 && least > 0;
            bounds += !(warm.overlap > 0) && memory.R_eff != 0;
            if (!(warm.overlap > 0)) R_eff = 0;
            if (!(warm.overlap > 0) || !(cold.overlap > 0)) continue;
            if (R_eff == 0) R_eff = warm.R_eff;
            radii += warm.R_eff != R_eff;
            ++touching;
            differ += std::abs(warm.overlap - cold.overlap) > 1e-9;
          }
        }
        MESSAGE(kind_i.name, " on ", kind_j.name, ": ", differ, " of ", touching, " differ");
        CHECK(touching > 50);
        CHECK(wrong == 0);
        CHECK(bounds == 0);
        CHECK(radii == 0);
        CHECK(differ <= touching / 50);  // the minimum it came in by is no longer the least
      },
      random);
}

namespace {
template <class Body>
double margin_of(const Body&) {
  return 0;
}
double margin_of(const PlacedPolyhedron& body) { return body.shape->radius(); }
}  // namespace

TEST_CASE(
    "solid_pairs: a pair that was apart touches as a new one does, however old its direction") {
  // Bodies may have turned by any angle since the last look. Overlaps up to 0.3 % of their size, on
  // both sides of what a first touch may be (deepest_first_touch), and gaps.
  Random random(77);
  std::size_t touching = 0;
  for (int round = 0; round < 12; ++round)
    for_each_pair(
        [&](const auto& kind_i, const auto& kind_j) {
          for (int k = 0; k < 12; ++k) {
            const auto i = kind_i.at({0, 0, 0}, random.turn());
            const Vec3d way = random.direction();
            const Quaternion q = random.turn();
            const double gap = random.uniform(-1.2e-3, 2e-3);
            // Where they touch, along a line of centres.
            double near = 0, far = 3;
            for (int half = 0; half < 40; ++half) {
              const double x = 0.5 * (near + far);
              const auto j = kind_j.at(x * way, q);
              (gjk_distance(i, j, -way).distance > margin_of(i) + margin_of(j) ? far : near) = x;
            }
            const auto j = kind_j.at((far + gap) * way, q);
            NormalMemory<double> fresh, old{random.direction(), k % 2 == 0 ? 1.0 : -1.0, 0};
            const auto a = touch_solids(i, j, fresh), b = touch_solids(i, j, old);
            INFO(kind_i.name, " and ", kind_j.name, ", gap ", gap, ", overlaps ", a.overlap,
                 " and ", b.overlap);
            CHECK((a.overlap > 0) == (b.overlap > 0));
            if (!(a.overlap > 0)) continue;
            ++touching;
            // Both are minima to point_tolerance of the size; depths agree to its square.
            CHECK(std::abs(a.overlap - b.overlap) < 1e-9);
          }
        },
        random);
  CHECK(touching > 1000);
}

TEST_CASE("solid_pairs: gaps are lower bounds of the distance, all kinds") {
  Random random(7);
  for_each_pair(
      [&](const auto& kind_i, const auto& kind_j) {
        INFO(kind_i.name, " on ", kind_j.name);
        double above = 0, below = 0;
        for (int k = 0; k < 60; ++k) {
          const auto i = kind_i.at({0, 0, 0}, random.turn());
          const double away = std::pow(10, random.uniform(-4, -0.5));
          const auto j = placed_at(i, kind_j, random.turn(), random.direction(), -away);
          NormalMemory<double> memory;
          for (int again = 0; again < 2; ++again) {
            const auto c = touch_solids(i, j, memory);
            CHECK(c.overlap <= 0);
            const double gap = gap_between(i, j);
            above = std::max({above, -c.overlap - gap, least_gap_of(i, j, memory) - gap});
            below += least_gap_of(i, j, memory) <= 0;
          }
        }
        CHECK(above <= 1e-9);
        CHECK(below <= 12);  // of 120: within 1e-5 of the size
      },
      random);
}

TEST_CASE(
    "solid_pairs: elastic collisions conserve energy with the square of the step, all kinds") {
  Random random(8);
  for_each_pair(
      [&](const auto& i, const auto& j) {
        // Dilated polyhedra: the point jumps where an edge or face comes to lie parallel to one of
        // the partner. There the potential has a kink, and such collisions are left out.
        const bool may_jump = (i.name == "dilated" || i.name == "polyhedron") &&
                              (j.name == "dilated" || j.name == "polyhedron") &&
                              i.name + j.name != "polyhedronpolyhedron";
        double coarse = 0, fine = 0, end = 0, momentum = 0;
        int parted = 0, used = 0;
        for (unsigned seed = 1; seed <= 8; ++seed) {
          const auto one = collide(i, j, seed, 1e-3), other = collide(i, j, seed, 2.5e-4);
          parted += one.parted && other.parted;
          momentum = std::max({momentum, one.momentum, other.momentum});
          if (may_jump && other.jump > 2e-3) continue;  // the bodies move by 2.5e-4 in a step
          coarse += one.swing, fine += other.swing, ++used;
          if (other.parted) end = std::max(end, other.end);
        }
        const double order = std::log(coarse / fine) / std::log(4.0);
        MESSAGE(i.name, " on ", j.name, ", ", used, " collisions: mean largest energy error ",
                coarse / used, " at step 1e-3, ", fine / used, " at 2.5e-4: order ", order,
                ", after it at most ", end);
        CHECK(parted >= 7);
        CHECK(used >= 4);
        CHECK(momentum <= 1e-12);
        CHECK(fine / used <= 1e-4);
        CHECK(end <= 1e-4);
        CHECK(order >= 1.6);  // second order, less what the first touch has of its singular force
      },
      random);
}

TEST_CASE(
    "solid_pairs: bodies in one place and one inside of the other have finite contacts, all "
    "kinds") {
  Random random(10);
  const auto is_finite_contact = [](const SolidContact& c) {
    return silt::is_finite(c.normal) && silt::is_finite(c.point) &&
           std::abs(norm(c.normal) - 1) <= 1e-12 &&
           silt::is_finite({c.overlap, c.gradient, c.couple}) && std::isfinite(c.R_eff);
  };
  for_each_pair(
      [&](const auto& kind_i, const auto& kind_j) {
        INFO(kind_i.name, " on ", kind_j.name);
        for (int k = 0; k < 20; ++k) {
          const auto turn = random.turn();
          const auto i = kind_i.at({0, 0, 0}, turn);
          // The same place, turn and all; then from there out by one direction.
          NormalMemory<double> memory;
          const Vec3d out = random.direction();
          for (const double away : {0.0, 1e-12, 0.05, 0.3, 3.0, 0.0}) {
            const auto j = kind_j.at(away * out, k % 2 == 0 ? turn : random.turn());
            const auto c = touch_solids(i, j, memory);
            CHECK(is_finite_contact(c));
            CHECK((c.overlap > 0) == (away < 1));
            CHECK((c.R_eff > 0) == (away < 1));
            CHECK(memory.R_eff == c.R_eff);
          }
        }
      },
      random);
}

TEST_CASE("solid_pairs: a polyhedron inside of another is buried: an overlap without a force") {
  const auto small = shape_test::box({0.1, 0.1, 0.1}), large = shape_test::box({1, 1, 1});
  NormalMemory<double> memory;
  const auto c = touch_solids(PlacedPolyhedron{&small, {{0.1, 0, 0}, Quaternion{}}},
                              PlacedPolyhedron{&large, {}}, memory);
  CHECK(c.overlap > 0.05);
  CHECK(c.gradient == 0);
}

TEST_CASE("solid_pairs: an ellipsoid on a box's face, edge and corner: closed forms") {
  const auto cube = shape_test::box({1, 1, 1});
  const PlacedPolyhedron j{&cube, {}};
  const double a = 0.3, b = 0.2, c = 0.1, depth = 1e-3;
  const auto form = form_of(silt::SuperEllipsoid{a, b, c});
  const silt::BodyAxes<double> axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3d n : {Vec3d{0, 0, 1}, normalised(Vec3d{1, 0, 1}), normalised(Vec3d{1, 1, 1})}) {
    // The ellipsoid's point with outward normal -n at the middle of the feature, and then deeper.
    const double h = std::sqrt(a * a * n.x * n.x + b * b * n.y * n.y + c * c * n.z * n.z);
    const Vec3d feature{n.x > 0 ? 0.5 : 0, n.y > 0 ? 0.5 : 0, n.z > 0 ? 0.5 : 0};
    const Vec3d from_centre{-a * a * n.x / h, -b * b * n.y / h, -c * c * n.z / h};
    const Super i{form, axes, feature - from_centre - depth * n};
    NormalMemory<double> memory;
    const auto contact = touch_solids(i, j, memory);
    CHECK(contact.overlap == near(depth).epsilon(1e-12));
    CHECK(norm(contact.normal - n) <= 1e-7);
    CHECK(norm(contact.point - (feature - 0.5 * depth * n)) <= 1e-7);
    // R = 1/mean curvature, h = height of the tangent plane: kappa_m of an ellipsoid at normal n is
    // (T1 + T2)/(2 T1 T2), T1 T2 = (a b c/h^2)^2, T1 + T2 from the trace of its matrix of radii.
    const double product = std::pow(a * b * c / (h * h), 2);
    const Vec3d g{a * a * n.x / h, b * b * n.y / h, c * c * n.z / h};
    const double sum = (a * a + b * b + c * c - dot(g, g)) / h;
    const double R = std::min(2 * product / sum, a), Rj = cube.equal_volume_radius();
    CHECK(contact.R_eff == near(R * Rj / (R + Rj)).epsilon(1e-3));
  }
}

}  // namespace solid_pairs_test
