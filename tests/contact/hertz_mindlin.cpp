// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/hertz_mindlin.hpp>

#include "contact/support.hpp"

namespace hertz_mindlin_test {

namespace {

using namespace contact_test;
using enum DampingEnd;
using ByDisplacement = BasicHertzMindlin<ZeroForce, TangentialMemory::Displacement>;
using Attractive = BasicHertzMindlin<ZeroOverlap>;

template <class Law = HertzMindlin>
typename Law::Material glass(double restitution = 0.6, double friction = 0.4) {
  return {.youngs_modulus = 1e8,
          .poisson_ratio = 0.25,
          .restitution = restitution,
          .friction = friction};
}
template <class Law = HertzMindlin>
auto coefficients(const typename Law::Material& m) {
  return Law::mix(m, m, Law::like(m));
}
const Contact<double> at_rest = contact_at_rest();

}  // namespace

TEST_CASE("hertz_mindlin: at rest the normal force is 4/3 E* sqrt(R*) d^(3/2)") {
  const auto p = coefficients(glass());
  const double E = 1e8 / (2 * (1 - 0.25 * 0.25));
  for (const double overlap : {1e-9, 1e-6, 1e-4}) {
    auto c = at_rest;
    c.overlap = overlap;
    HertzMindlin::History<double> h{};
    const double expected = 4.0 / 3.0 * E * std::sqrt(1e-3) * std::pow(overlap, 1.5);
    CHECK(near_relative(HertzMindlin::force(c, p, h).normal, expected, 1e-14));
    CHECK(near_relative(HertzMindlin::stiffness(c, p), 1.5 * expected / overlap, 1e-14));
  }
}

TEST_CASE("hertz_mindlin: a small slip s is resisted by 8 G* sqrt(R* d) s, with either memory") {
  const double G = 1e8 / (2 * 1.25) / (2 * (2 - 0.25)), slip = 1e-9;
  auto c = at_rest;
  c.tangential_velocity = {slip / c.time_step, 0, 0};
  const double expected = 8 * G * std::sqrt(c.R_eff * c.overlap) * slip;
  HertzMindlin::History<double> force{};
  ByDisplacement::History<double> displacement{};
  const auto f = HertzMindlin::force(c, coefficients(glass(1)), force);
  const auto d = ByDisplacement::force(c, coefficients<ByDisplacement>(glass<ByDisplacement>(1)),
                                       displacement);
  CHECK(near_relative(-f.tangential.x, expected, 1e-14));
  CHECK(near_relative(-d.tangential.x, expected, 1e-14));
  CHECK(near_relative(-force.tangential.x, expected, 1e-14));
  CHECK(near_relative(displacement.tangential.x, slip, 1e-14));
}

TEST_CASE("hertz_mindlin: materials mix as springs in series, in either order") {
  const auto a = glass(), b = HertzMindlin::Material{2e11, 0.3, 0.6, 0.4};
  const HertzMindlin::Pair pair{0.5, 0.3};
  const auto ab = reals<double>(HertzMindlin::mix(a, b, pair));
  const auto ba = reals<double>(HertzMindlin::mix(b, a, pair));
  for (std::size_t k = 0; k < ab.size(); ++k) CHECK(near_relative(ab[k], ba[k], 1e-15));
  CHECK(near_relative(HertzMindlin::mix(a, b, pair).twice_modulus,
                      2 / ((1 - 0.0625) / 1e8 + (1 - 0.09) / 2e11), 1e-15));
}

TEST_CASE("hertz_mindlin: a batch equals doubles to a few ulp") {
  // Sums of three products in another order or fused: 1e-15 each, some tens of operations.
  CHECK(largest_lane_difference<HertzMindlin>(coefficients(glass()), 0.1) < 1e-13);
  CHECK(largest_lane_difference<Attractive>(coefficients<Attractive>(glass<Attractive>()), 0.1) <
        1e-13);
  CHECK(largest_lane_difference<ByDisplacement>(
            coefficients<ByDisplacement>(glass<ByDisplacement>()), 1e-6) < 1e-13);
}

TEST_CASE("hertz_mindlin: friction stays within mu F_n at every normal velocity") {
  check_coulomb_limit<HertzMindlin>(coefficients(glass()), 0.4, 1);
  check_coulomb_limit<Attractive>(coefficients<Attractive>(glass<Attractive>()), 0.4, 1);
  check_coulomb_limit<ByDisplacement>(coefficients<ByDisplacement>(glass<ByDisplacement>()), 0.4,
                                      1e-5);
}

TEST_CASE("hertz_mindlin: the force never pulls with ZeroForce, and does with ZeroOverlap") {
  auto c = at_rest;
  c.normal_velocity = 5;
  HertzMindlin::History<double> h{};
  Attractive::History<double> k{};
  CHECK(HertzMindlin::force(c, coefficients(glass()), h).normal == 0);
  CHECK(Attractive::force(c, coefficients<Attractive>(glass<Attractive>()), k).normal < 0);
}

TEST_CASE("hertz_mindlin: each parameter of the material changes the force") {
  auto c = at_rest;
  c.normal_velocity = -0.1, c.tangential_velocity = {0.1, 0, 0};
  const auto force = [&](const HertzMindlin::Material& m, double slip) {
    HertzMindlin::History<double> h{{slip, 0, 0}};
    return HertzMindlin::force(c, coefficients(m), h);
  };
  const auto base = glass();
  const auto changed = [&](double HertzMindlin::Material::*field) {
    auto m = base;
    m.*field *= 0.9;
    return m;
  };
  const auto reference = force(base, 0);
  for (const auto field :
       {&HertzMindlin::Material::youngs_modulus, &HertzMindlin::Material::poisson_ratio,
        &HertzMindlin::Material::restitution}) {
    const auto f = force(changed(field), 0);
    CHECK(std::abs(f.normal / reference.normal - 1) > 1e-3);
    CHECK(std::abs(f.tangential.x / reference.tangential.x - 1) > 1e-3);
  }
  const double sliding = -100;  // [N] beyond the limit
  CHECK(near_relative(force(changed(&HertzMindlin::Material::friction), sliding).tangential.x,
                      0.9 * force(base, sliding).tangential.x, 1e-14));
}

TEST_CASE("hertz_mindlin: no closed cycle of displacements gives energy with the force as memory") {
  Random random(3);
  for (const double friction : {0.3, 1e6})
    for (int k = 0; k < 200; ++k) {
      const RandomCycle path(random);
      const auto work = cycle<HertzMindlin>(coefficients(glass(1, friction)), path, 4000);
      CAPTURE(k);
      // The force of a step sees its end, not its middle: 1/4000 of what is turned over.
      CHECK(work.gained < 2.5e-4 * work.turned_over);
    }
}

TEST_CASE(
    "hertz_mindlin: pressing a sheared contact in gives energy with the displacement as memory") {
  // Sheared by s at overlap d, pressed to 4 d, where the spring is twice as stiff, and let go
  // there: S_t s^2/2 more than it took. The same cycle with the force as memory loses as much.
  const double s = 1e-6, d = 1e-5;
  const auto path = [&](double t) {
    const double q = 5 * t;
    if (q < 1) return Vec3d{0, 0, d * q};
    if (q < 2) return Vec3d{s * (q - 1), 0, d};
    if (q < 3) return Vec3d{s, 0, d * (1 + 3 * (q - 2))};
    if (q < 4) return Vec3d{s * (4 - q), 0, 4 * d};
    return Vec3d{0, 0, 4 * d * (5 - q)};
  };
  const double G = 1e8 / (2 * 1.25) / (2 * (2 - 0.25));
  const double energy = 0.5 * 8 * G * std::sqrt(1e-3 * d) * s * s;
  const auto m = glass<ByDisplacement>(1, 1e6);
  const auto displacement = cycle<ByDisplacement>(coefficients<ByDisplacement>(m), path, 20000);
  const auto force = cycle<HertzMindlin>(coefficients(glass(1, 1e6)), path, 20000);
  // Steps of 1/4000 of each leg, and a normal work 100 times as large.
  CHECK(near_relative(displacement.gained, energy, 0.01));
  CHECK(near_relative(force.gained, -energy, 0.01));
}

TEST_CASE("hertz_mindlin: refuses values out of range and names them") {
  const auto with = [](double HertzMindlin::Material::*field, double value) {
    return [=] {
      auto m = glass();
      m.*field = value;
      HertzMindlin::check(m);
    };
  };
  using M = HertzMindlin::Material;
  for (const double bad : {0.0, -1e7, std::nan(""), HUGE_VAL})
    refuses(with(&M::youngs_modulus, bad), {"HertzMindlin::Material.youngs_modulus", "[Pa]"});
  for (const double bad : {-0.1, 0.51, std::nan("")})
    refuses(with(&M::poisson_ratio, bad), {"HertzMindlin::Material.poisson_ratio", "[0, 0.5]"});
  for (const double bad : {0.0, -0.5, 1.3, std::nan("")})
    refuses(with(&M::restitution, bad), {"restitution", "(0, 1]"});
  for (const double bad : {-0.1, std::nan(""), HUGE_VAL})
    refuses(with(&M::friction, bad), {"friction", "[-]"});
  refuses(with(&M::restitution, 1.3), {"1.3"});
  CHECK_NOTHROW(HertzMindlin::check(glass()));
}

}  // namespace hertz_mindlin_test
