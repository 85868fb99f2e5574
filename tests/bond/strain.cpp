// silt - BSD-3-Clause, see LICENSE
// The strain of a bond and the loads that go with it.
//   work of the loads is the energy's loss   couples that miss how the frame turns, or take a turn
//                                            by 0.5 rad for a small one
//   nothing but strain enters                terms that see ends which turn together
//   closed forms                             signs, halves of angles, arms
#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include <silt/bond/strain.hpp>
#include <silt/core/random.hpp>

#include "near.hpp"

namespace bond_strain_test {

using silt::BondedEnds;
using silt::BondRest;
using silt::BondStrain;
using silt::Quaternion;
using silt::Vec3d;

Vec3d any_vector(silt::Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}
Quaternion turned(const Vec3d& by) {
  const double angle = silt::norm(by);
  return angle == 0 ? Quaternion{} : silt::rotation_about((1 / angle) * by, angle);
}

struct End {
  Vec3d centre{0, 0, 0};
  Quaternion orientation;
  Vec3d velocity{0, 0, 0}, angular_velocity{0, 0, 0};
};
BondedEnds<double> ends(const End& i, const End& j) {
  return {i.centre - j.centre, i.velocity - j.velocity, i.orientation,
          j.orientation,       i.angular_velocity,      j.angular_velocity};
}

/// Two ends somewhere, bonded, then strained: turned against each other by up to `turn` [rad].
struct Scene {
  End i, j;
  BondRest<double> rest;

  Scene(silt::Random& random, double turn) {
    const Quaternion q_i = turned(any_vector(random, 2)), q_j = turned(any_vector(random, 2));
    const Vec3d x_i = any_vector(random, 2), x_j = any_vector(random, 2);
    rest = BondRest<double>::of(rotate(conjugate(q_j), x_i - x_j), random.uniform(0.2, 0.8),
                                conjugate(q_j) * q_i);
    i = {x_i + any_vector(random, 0.3), turned(any_vector(random, turn)) * q_i,
         any_vector(random, 1), any_vector(random, 1)};
    j = {x_j, q_j, any_vector(random, 1), any_vector(random, 1)};
  }
  BondStrain<double> strain() const { return strain_of(rest, ends(i, j)); }
  /// The same after a time t [s].
  Scene later(double t) const {
    Scene s = *this;
    for (auto* end : {&s.i, &s.j}) {
      end->centre += t * end->velocity;
      end->orientation = turned(t * end->angular_velocity) * end->orientation;
    }
    return s;
  }
};

/// Along the bond, and across [N/m, N m].
struct Stiff {
  double along, across;
  Vec3d operator()(const Vec3d& n, const Vec3d& v) const {
    return across * v + ((along - across) * dot(v, n)) * n;
  }
};
constexpr Stiff of_shift{3, 11}, of_turn{2, 13};
double energy(const BondStrain<double>& s) {
  return 0.5 * dot(s.shift, of_shift(s.normal, s.shift)) +
         0.5 * dot(s.turn, of_turn(s.normal, s.turn));
}
silt::BondLoads<double> loads(const BondStrain<double>& s) {
  return loads_of(s, -of_shift(s.normal, s.shift), -of_turn(s.normal, s.turn), {0, 0, 0},
                  {0, 0, 0});
}
double power(const silt::BondLoads<double>& l, const Scene& s) {
  return dot(l.force, s.i.velocity - s.j.velocity) + dot(l.torque_i, s.i.angular_velocity) +
         dot(l.torque_j, s.j.angular_velocity);
}

TEST_CASE("bond: the loads do the work that the energy loses, at any strain and turn") {
  silt::Random random(1);
  for (int n = 0; n < 200; ++n) {
    const Scene s(random, n % 2 == 0 ? 0.1 : 1);
    const double h = 1e-4;  // [s] central differences: h^2 times third derivatives of some tens
    const double lost = (energy(s.later(-h).strain()) - energy(s.later(h).strain())) / (2 * h);
    CHECK(std::abs(power(loads(s.strain()), s) - lost) < 3e-5);
  }
}

TEST_CASE("bond: momentum and angular momentum, and dashpots that take energy alone") {
  silt::Random random(2);
  for (int n = 0; n < 200; ++n) {
    const Scene s(random, 1);
    const auto strain = s.strain();
    const auto l = loads(strain);
    const Vec3d twist = cross(s.i.centre - s.j.centre, l.force) + l.torque_i + l.torque_j;
    CHECK(silt::norm(twist) < 1e-12);
    const auto damped =
        loads_of(strain, {0, 0, 0}, {0, 0, 0}, -of_shift(strain.normal, strain.shift_rate),
                 -of_turn(strain.normal, strain.turn_rate));
    const double taken = dot(strain.shift_rate, of_shift(strain.normal, strain.shift_rate)) +
                         dot(strain.turn_rate, of_turn(strain.normal, strain.turn_rate));
    CHECK(power(damped, s) == near(-taken).epsilon(1e-12));
  }
}

TEST_CASE("bond: motion of both ends as one rigid body strains nothing, and turns the loads") {
  silt::Random random(3);
  for (int n = 0; n < 100; ++n) {
    const Scene s(random, 0.7);
    const Quaternion q = turned(any_vector(random, 2));
    Scene moved = s;
    const Vec3d w = any_vector(random, 1);
    for (auto* end : {&moved.i, &moved.j}) {
      end->centre = rotate(q, end->centre) + Vec3d{1, 2, 3};
      end->orientation = q * end->orientation;
      end->velocity = cross(w, end->centre), end->angular_velocity = w;
    }
    const auto a = s.strain(), b = moved.strain();
    for (const auto part :
         {&BondStrain<double>::shift, &BondStrain<double>::turn, &BondStrain<double>::normal})
      CHECK(silt::norm(rotate(q, a.*part) - b.*part) < 1e-12);
    CHECK(silt::norm(a.normal) == near(1).epsilon(1e-13));
    CHECK(silt::norm(rotate(q, loads(a).force) - loads(b).force) < 1e-11);
    // The middle of a strained bond is carried along; its ends do not part.
    CHECK(silt::norm(b.turn_rate) < 1e-12);
    CHECK(silt::norm(b.shift_rate) < 1e-12);
  }
}

TEST_CASE("bond: closed forms of a stretch, a shear, a twist and a bend") {
  const auto rest = BondRest<double>::of({0, 0, 2}, 0.5, {});
  End i, j;
  i.centre = {0, 0, 2};
  const auto strain = [&] { return strain_of(rest, ends(i, j)); };
  CHECK(silt::norm(strain().shift) + silt::norm(strain().turn) == 0);

  i.centre = {0.01, 0, 2.02};
  CHECK(silt::norm(strain().shift - Vec3d{0.01, 0, 0.02}) < 1e-15);
  // A turn by an angle about one axis, which (2) takes for a (1 - a^4/480).
  for (const double angle : {0.01, 0.1, 0.5, 1.0})
    for (const Vec3d& axis : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{0.6, 0, 0.8}}) {
      i.orientation = silt::rotation_about(axis, angle);
      const double is = dot(strain().turn, axis), off = std::pow(angle, 5) / 480;
      CHECK(std::abs(is - angle) <= 1.001 * off + 1e-15);
      CHECK(std::abs(is - angle) >= 0.9 * off - 1e-15);
      // Its other quaternion is the same turn.
      const auto& q = i.orientation;
      i.orientation = {-q.w, -q.x, -q.y, -q.z};
      CHECK(dot(strain().turn, axis) == near(is).epsilon(1e-14));
    }
  // Bent as a circle: both ends turn by half an angle, and their copies of the middle move apart.
  const double half = 0.1;
  i.orientation = silt::rotation_about({0, 1, 0}, half);
  j.orientation = silt::rotation_about({0, 1, 0}, -half);
  i.centre = rotate(i.orientation, {0, 0, 1}) + rotate(j.orientation, {0, 0, 1});
  CHECK(silt::norm(strain().shift) < 1e-15);
  CHECK(std::abs(strain().turn.y - 2 * half) < std::pow(2 * half, 5) / 400);
  CHECK(silt::norm(strain().normal - Vec3d{0, 0, 1}) < 1e-15);
}

}  // namespace bond_strain_test
