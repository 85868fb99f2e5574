// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <silt/coupling/momentum_exchange.hpp>

#include "near.hpp"

namespace momentum_exchange_test {

using silt::momentum_exchange;
using silt::Vec3d;

namespace {

/// n equal particles in a box with a fluid whose velocity is implicit, along x.
struct Suspension {
  double m, K, n, fluid;  // [kg] of one, [kg/s], [-], [kg] of the fluid
  double u = 0, v = 1;    // [m/s]

  double loading() const { return n * m / fluid; }
  double momentum() const { return fluid * u + n * m * v; }
  /// `a` acts on the particles; what it weighs is held by a force on the fluid.
  void step(double dt, double l, double a = 0) {
    const auto e = momentum_exchange(m, K, dt, Vec3d{a, 0, 0}, l);
    // fluid (u' - u)/dt = -n F(u') - n m a
    const double b = e.coefficient, c = e.offset.x;
    u = (fluid / dt * u + n * (b * v + c - m * a)) / (fluid / dt + n * b);
    v += dt / m * (e.force({u, 0, 0}, {v, 0, 0}).x + m * a);
  }
  /// Exact slip v - u of relaxation from the present one.
  double exact_slip(double t) const { return (v - u) * std::exp(-(1 + loading()) * t * K / m); }
};

}  // namespace

TEST_CASE("momentum exchange: velocity is exact at any X = dt K/m from 1e-8 to 1e6, in lanes") {
  using Pack = typename silt::Lanes<silt::DefaultArch>::Real;
  const double m = 2e-6, a = -9.81, u = 0.7;
  for (double digits = -8; digits <= 6; digits += 0.13) {
    const double X = std::pow(10.0, digits), dt = 1e-4, K = X * m / dt;
    CAPTURE(X);
    const auto e = momentum_exchange(m, K, dt, Vec3d{0, 0, a});
    const auto after = [&](double v) {
      return v + dt / m * (e.force({0, 0, u}, {0, 0, v}).z + m * a);
    };
    // Terminal velocity stays, to the rounding of a dt and of u - v.
    const double terminal = u + m * a / K;
    CHECK(std::abs(after(terminal) - terminal) <=
          4e-16 * (std::abs(a) * dt + std::abs(terminal) + u));
    // And any other follows the exponential. 1 - e^-X has a few ulp, the velocities theirs.
    const double v = terminal - 3;
    CHECK(std::abs(after(v) - (terminal - 3 * std::exp(-X))) <= 2e-15 * (3 + std::abs(terminal)));
    const auto lanes = momentum_exchange(Pack(m), Pack(K), Pack(dt),
                                         silt::Vec3<Pack>{Pack(0.0), Pack(0.0), Pack(a)});
    alignas(64) double b[silt::Lanes<silt::DefaultArch>::width], c[std::size(b)];
    silt::store(b, lanes.coefficient), silt::store(c, lanes.offset.z);
    for (const double lane : b) CHECK(near_relative(lane, e.coefficient, 1e-14));
    for (const double lane : c) CHECK(std::abs(lane - e.offset.z) <= 1e-15 * m * std::abs(a));
  }
  const auto none = momentum_exchange(m, 0.0, 1e-4, Vec3d{1, 2, 3});
  CHECK(none.coefficient == 0);
  CHECK(none.offset == Vec3d{0, 0, 0});
}

TEST_CASE("momentum exchange: relaxation, dt/tau 0.01 to 10: exact if the loading is given") {
  const double m = 1e-6, tau = 0.02, K = m / tau;
  for (const double load : {0.01, 0.3, 3.0, 40.0})
    for (const double X : {0.01, 0.1, 0.5, 1.0, 2.0, 10.0}) {
      CAPTURE(load);
      CAPTURE(X);
      Suspension held{m, K, 50, 50 * m / load}, given = held;
      const Suspension start = held;
      const double dt = X * tau, total = held.momentum();
      double error = 0;
      for (int step = 1; step <= 20; ++step) {
        held.step(dt, 0);
        given.step(dt, load);
        const double exact = start.exact_slip(step * dt);
        error = std::max(error, std::abs(held.v - held.u - exact));
        // 1e-15 a step of the velocities, which are 1 m/s at most.
        CHECK(std::abs(given.v - given.u - exact) <= 3e-14);
        CHECK(near_relative(held.momentum(), total, 1e-14));
        CHECK(near_relative(given.momentum(), total, 1e-14));
      }
      CHECK(error <= 0.17 * load);  // as the header says, to first order in the load
      if (load == 0.01 && X == 1) CHECK(error > 1e-3);  // so the loading matters even here
    }
}

TEST_CASE("momentum exchange: a suspension whose weight the fluid carries settles at its slip") {
  const double m = 1e-6, tau = 0.02, a = -9.81;
  for (const double load : {0.0, 3.0})
    for (const double X : {0.01, 1.0, 10.0, 1e4}) {
      Suspension s{m, m / tau, 50, 50 * m / 3};
      s.v = 0;
      for (int step = 1; step <= 3000; ++step) s.step(X * tau, load, a);
      CAPTURE(load);
      CAPTURE(X);
      // Slip a tau, beside which a dt was rounded.
      CHECK(std::abs(s.v - s.u - a * tau) <= 1e-14 * std::abs(a) * tau * (1 + X));
      CHECK(std::abs(s.momentum()) <= 3000 * 1e-16 * 50 * m * std::abs(a) * tau * (1 + X));
    }
}

TEST_CASE("momentum exchange: unlike particles give and take nothing but momentum") {
  // 1000 particles with X from 1e-6 to 1e5, one fluid velocity: the sum stays to round-off.
  struct One {
    double m, K;
    Vec3d v;
  };
  std::vector<One> all;
  std::uint32_t state = 1;
  const auto uniform = [&] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
  const double dt = 1e-4, fluid = 3e-3;
  for (int i = 0; i < 1000; ++i) {
    const double m = 1e-6 * std::pow(10.0, 3 * uniform() - 2);
    all.push_back({m,
                   m / dt * std::pow(10.0, 11 * uniform() - 6),
                   {2 * uniform() - 1, uniform(), uniform()}});
  }
  Vec3d u{3, 0, -1};
  const auto momentum = [&] {
    Vec3d sum = fluid * u;
    for (const auto& p : all) sum += p.m * p.v;
    return sum;
  };
  const Vec3d before = momentum();
  for (int step = 0; step < 200; ++step) {
    double b = fluid / dt;
    Vec3d right = u * b;
    for (const auto& p : all) {
      const auto e = momentum_exchange(p.m, p.K, dt, Vec3d{0, 0, 0});
      b += e.coefficient, right += e.coefficient * p.v + e.offset;
    }
    u = right * (1 / b);
    for (auto& p : all)
      p.v += momentum_exchange(p.m, p.K, dt, Vec3d{0, 0, 0}).force(u, p.v) * (dt / p.m);
  }
  // 4e5 roundings of 1e-16, mostly cancelling.
  CHECK(norm(momentum() - before) <= 1e-12 * norm(before));
}

}  // namespace momentum_exchange_test
