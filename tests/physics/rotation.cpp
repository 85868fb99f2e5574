// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <silt/motion/rotation.hpp>

#include "near.hpp"

namespace rotation_test {

// V7 of the verification list: torque-free and heavy tops.

namespace {

using silt::Quaternion;
using silt::Vec3d;

struct Top {
  Quaternion q;
  Vec3d momentum, inertia;

  Vec3d momentum_in_space() const { return rotate(q, momentum); }
  double energy() const {
    return 0.5 * (momentum.x * momentum.x / inertia.x + momentum.y * momentum.y / inertia.y +
                  momentum.z * momentum.z / inertia.z);
  }
};

/// I = (1, 2, 3), spinning near its unstable axis.
Top asymmetric() { return {{}, {0.02, 2.0, 0.03}, {1, 2, 3}}; }

template <class Rotation>
Top freely(double duration, int steps) {
  Top top = asymmetric();
  for (int k = 0; k < steps; ++k) {
    // The first kick is half a step long, as in a simulation.
    Rotation::kick(top.momentum, {0, 0, 0}, top.inertia, (k > 0 ? 1 : 0.5) * duration / steps);
    Rotation::drift(top.q, top.momentum, top.inertia, duration / steps);
  }
  return top;
}

/// The same by classical Runge-Kutta of I w' + w x I w = 0 and q' = q (0, w)/2: neither splitting
/// nor exponentials, so that an error that Rotation's two have in common shows. Its error at 20000
/// steps of 1e-3 is some 1e-13.
Quaternion by_runge_kutta(double duration, int steps) {
  struct State {
    Quaternion q;
    Vec3d L;
  };
  const Top top = asymmetric();
  const auto slope = [&](const State& s) {
    const Vec3d w{s.L.x / top.inertia.x, s.L.y / top.inertia.y, s.L.z / top.inertia.z};
    const Quaternion r = s.q * Quaternion{0, w.x, w.y, w.z};
    return State{{r.w / 2, r.x / 2, r.y / 2, r.z / 2}, cross(s.L, w)};
  };
  const auto moved = [](const State& s, const State& k, double h) {
    return State{{s.q.w + h * k.q.w, s.q.x + h * k.q.x, s.q.y + h * k.q.y, s.q.z + h * k.q.z},
                 s.L + h * k.L};
  };
  State s{top.q, top.momentum};
  const double h = duration / steps;
  for (int n = 0; n < steps; ++n) {
    const State a = slope(s), b = slope(moved(s, a, h / 2)), c = slope(moved(s, b, h / 2)),
                d = slope(moved(s, c, h));
    s = moved(moved(moved(moved(s, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  return s.q;
}

/// Angle [rad] between two orientations.
double angle(const Quaternion& a, const Quaternion& b) {
  const Quaternion d = conjugate(a) * b;
  return 2 * std::asin(std::min(1.0, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)));
}

}  // namespace

TEST_CASE_TEMPLATE("A free asymmetric top turns with an error of second order", R, silt::NoSquish,
                   silt::Spiral) {
  const double duration = 20;
  const auto reference = by_runge_kutta(duration, 20000);
  CHECK(angle(by_runge_kutta(duration, 40000), reference) < 1e-11);
  const double coarse = angle(freely<R>(duration, 200).q, reference),
               fine = angle(freely<R>(duration, 400).q, reference),
               finest = angle(freely<R>(duration, 800).q, reference);
  // Both as computed apart by a program in Python, of the sources' formulas.
  CHECK(near_relative(coarse, std::is_same_v<R, silt::NoSquish> ? 8.684e-4 : 5.990e-4, 1e-3));
  CHECK(std::log2(coarse / fine) > 1.7);
  CHECK(std::log2(fine / finest) == near(2).epsilon(0.12));
}

TEST_CASE(
    "NoSquish keeps angular momentum and quaternion, and energy within a bound, for 1e6 steps") {
  Top top = asymmetric();
  const Vec3d start = top.momentum_in_space();
  const double energy = top.energy();
  double worst_early = 0, worst_late = 0;
  for (int k = 0; k < 1000000; ++k) {
    silt::NoSquish::drift(top.q, top.momentum, top.inertia, 0.05);
    const double error = std::abs(top.energy() / energy - 1);
    (k < 10000 ? worst_early : worst_late) = std::max(k < 10000 ? worst_early : worst_late, error);
  }
  CHECK(worst_early < 3e-4);
  CHECK(worst_late < 1.01 * worst_early);  // bounded: nothing is added in 99 times as long
  CHECK(norm(top.momentum_in_space() - start) / norm(start) < 1e-9);  // rounding of 1e6 steps
  const Quaternion& q = top.q;
  CHECK(std::abs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-9);
}

TEST_CASE("Spiral loses energy slowly, by a rate of its step") {
  const auto drift_of = [](double h) {
    Top top = asymmetric();
    const double energy = top.energy();
    for (int k = 0; k < static_cast<int>(2000 / h); ++k) {
      silt::Spiral::kick(top.momentum, {0, 0, 0}, top.inertia, h);
      silt::Spiral::drift(top.q, top.momentum, top.inertia, h);
    }
    return std::abs(top.energy() / energy - 1);
  };
  const double coarse = drift_of(0.1), fine = drift_of(0.05);
  CHECK(coarse < 1e-2);
  CHECK(coarse / fine > 6);  // third order in the step
}

TEST_CASE_TEMPLATE("A heavy top keeps its energy and its momentum about the vertical", R,
                   silt::NoSquish, silt::Spiral) {
  // A symmetric top on its tip: torque m g l e x z of gravity about the tip.
  const double weight = 1.5;  // [N m] m g l
  const auto run = [&](int steps) {
    Top top{silt::rotation_about({1, 0, 0}, 0.5), {0, 0.3, 8.0}, {1.2, 1.2, 0.8}};
    const auto torque = [&] {
      const Vec3d axis = rotate(top.q, {0, 0, 1});
      return rotate(conjugate(top.q), weight * cross(axis, Vec3d{0, 0, -1}));
    };
    const auto energy = [&] { return top.energy() + weight * rotate(top.q, {0, 0, 1}).z; };
    const double e = energy(), vertical = top.momentum_in_space().z, h = 100.0 / steps;
    double worst = 0;
    for (int k = 0; k < steps; ++k) {  // velocity Verlet
      R::kick(top.momentum, torque(), top.inertia, h / 2);
      R::drift(top.q, top.momentum, top.inertia, h);
      R::kick(top.momentum, torque(), top.inertia, h / 2);
      worst = std::max(
          {worst, std::abs(energy() / e - 1), std::abs(top.momentum_in_space().z / vertical - 1)});
    }
    return worst;
  };
  const double coarse = run(10000), fine = run(20000);
  CHECK(coarse < 1e-3);
  CHECK(coarse / fine == near(4).epsilon(0.2));  // second order
}

TEST_CASE_TEMPLATE("A fast-spinning body turns right even where a step turns it far", R,
                   silt::NoSquish, silt::Spiral) {
  // About a principal axis any step is exact.
  Top top{{}, {0, 0, 6.0}, {1, 2, 3}};
  R::drift(top.q, top.momentum, top.inertia, 0.7);
  CHECK(angle(top.q, silt::rotation_about({0, 0, 1}, 1.4)) < 1e-14);
}

}  // namespace rotation_test
