// silt - BSD-3-Clause, see LICENSE
// Strength of a parallel bond: tension, shear, twist and bending each break it at its stress,
// exactly.
//   wrong lever arms (R/I, R/J), a shared area, tension that helps shear
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include <silt/bond/parallel_bond.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace bond_strength_test {

using silt::Vec3d;
constexpr double R = 2e-3, pi = std::numbers::pi;
const silt::BondedPair pair{.radius_i = R,
                            .radius_j = 3e-3,
                            .length = 5e-3,
                            .m_eff = 1e-5,
                            .inertia_eff = 1e-11,
                            .share = 0.5};
constexpr double A = pi * R * R, I = pi * R * R * R * R / 4;
const Vec3d n{0.6, 0, 0.8}, across{0.8, 0, -0.6}, y{0, 1, 0};

/// [-] of a bond that bears this force and couple.
double load(const silt::ParallelBond& bond, const Vec3d& force, const Vec3d& couple) {
  return bond.load<double>({force, couple, {0, 0, 0}, {0, 0, 0}}, n, bond.numbers(pair));
}

TEST_CASE("parallel bond: tension, bending, shear and twist break it at their stresses") {
  silt::ParallelBond bond{.youngs_modulus = 1e9, .tensile_strength = 2e6, .shear_strength = 3e6};
  CHECK(load(bond, -2e6 * A * n, {0, 0, 0}) == near(1).epsilon(1e-14));  // i is pulled back
  CHECK(load(bond, 2e9 * A * n, {0, 0, 0}) < 1e-12);                     // pressed
  CHECK(load(bond, {0, 0, 0}, 2e6 * I / R * y) == near(1).epsilon(1e-14));
  CHECK(load(bond, {0, 0, 0}, 2e6 * I / R * across) == near(1).epsilon(1e-14));
  CHECK(load(bond, 3e6 * A * y, {0, 0, 0}) == near(1).epsilon(1e-14));
  CHECK(load(bond, {0, 0, 0}, -3e6 * 2 * I / R * n) == near(1).epsilon(1e-14));
  // Half of each: sums of stresses at the rim.
  CHECK(load(bond, -1e6 * A * n, 1e6 * I / R * y) == near(1).epsilon(1e-14));
  CHECK(load(bond, 1.5e6 * A * y, 1.5e6 * 2 * I / R * n) == near(1).epsilon(1e-14));
  // Friction: pressed, it bears more shear; pulled, less.
  bond.friction_angle = std::atan(0.5), bond.tensile_strength = INFINITY;
  CHECK(load(bond, (3e6 + 1e6) * A * y + 2e6 * A * n, {0, 0, 0}) == near(1).epsilon(1e-14));
  CHECK(load(bond, (3e6 - 1e6) * A * y - 2e6 * A * n, {0, 0, 0}) == near(1).epsilon(1e-14));
}

TEST_CASE("parallel bond: its stiffnesses, dashpots, and scatter of mean 1") {
  const silt::ParallelBond bond{.youngs_modulus = 1e9, .stiffness_ratio = 2, .damping = 0.2};
  const double kn = 1e9 * A / 5e-3;
  const auto answer = [&](const Vec3d& shift, const Vec3d& turn, const Vec3d& shift_rate,
                          const Vec3d& turn_rate) {
    return bond.answer<double>({shift, turn, shift_rate, turn_rate, n, {}, {}, 1, {}},
                               bond.numbers(pair));
  };
  const Vec3d none{0, 0, 0};
  const auto is = [](const Vec3d& a, const Vec3d& b) { return norm(a - b) <= 1e-13 * norm(b); };
  CHECK(is(answer(1e-6 * n, none, none, none).force, -1e-6 * kn * n));
  CHECK(is(answer(1e-6 * y, none, none, none).force, -1e-6 * kn / 2 * y));
  CHECK(is(answer(none, 1e-3 * y, none, none).couple, -1e-3 * 1e9 * I / 5e-3 * y));
  CHECK(is(answer(none, 1e-3 * n, none, none).couple, -1e-3 * 1e9 * 2 * I / 2 / 5e-3 * n));
  const auto dashpot = [](double k, double m) { return 2 * 0.2 * std::sqrt(k * m); };
  CHECK(is(answer(none, none, n, none).rate_force, -dashpot(kn, 1e-5) * n));
  CHECK(is(answer(none, none, y, none).rate_force, -dashpot(kn / 2, 1e-5) * y));
  CHECK(is(answer(none, none, none, y).rate_couple, -dashpot(1e9 * I / 5e-3, 1e-11) * y));
  CHECK(is(answer(none, none, none, n).rate_couple, -dashpot(1e9 * I / 5e-3, 1e-11) * n));
  // The mean of the Weibull factor, by the midpoint rule in its share.
  silt::ParallelBond weak = bond;
  weak.weibull_modulus = 3;
  double mean = 0;
  const int parts = 20000;
  for (int k = 0; k < parts; ++k) {
    auto one = pair;
    one.share = (k + 0.5) / parts;
    mean += 1 / weak.numbers(one).per_strength / parts;
  }
  CHECK(mean == near(1).epsilon(1e-4));
}

TEST_CASE("parallel bond: what cannot be is refused") {
  const auto refused = [](const silt::ParallelBond& bond, const char* words) {
    CHECK(silt_test::has(silt_test::refusal([&] { bond.check(); }), words));
  };
  refused({.youngs_modulus = 0}, "ParallelBond.youngs_modulus = 0 [Pa]");
  refused({.youngs_modulus = 1, .stiffness_ratio = -1}, "ParallelBond.stiffness_ratio = -1 [-]");
  refused({.youngs_modulus = 1, .radius_ratio = 0}, "ParallelBond.radius_ratio = 0 [-]");
  refused({.youngs_modulus = 1, .tensile_strength = 0}, "ParallelBond.tensile_strength = 0 [Pa]");
  refused({.youngs_modulus = 1, .friction_angle = 2}, "must be in [0, pi/2)");
  refused({.youngs_modulus = 1, .damping = -1}, "ParallelBond.damping = -1 [-]");
  refused({.youngs_modulus = 1, .shear_strength = -1}, "ParallelBond.shear_strength = -1 [Pa]");
  refused({.youngs_modulus = 1, .weibull_modulus = -1}, "ParallelBond.weibull_modulus = -1 [-]");
  refused({.youngs_modulus = 1, .weibull_modulus = 0.01},
          "weibull_modulus = 0.01 [-] must be 0, for no scatter, or at least 0.5");
}

}  // namespace bond_strength_test
