// silt - BSD-3-Clause, see LICENSE
#include <silt/contact/linear_spring.hpp>

#include "contact/support.hpp"

namespace linear_spring_test {

namespace {

using namespace contact_test;
using enum DampingEnd;
using Law = LinearSpringFriction;
using Attractive = BasicLinearSpringFriction<ZeroOverlap>;

Law::Material spring(double restitution = 0.6, double friction = 0.4) {
  return {.stiffness = 1e4, .restitution = restitution, .friction = friction, .shear_ratio = 0.5};
}
auto coefficients(const Law::Material& m) { return Law::mix(m, m, Law::like(m)); }
Attractive::Coefficients<double> attractive() {
  const Attractive::Material m{1e4, 0.6, 0.4, 0.5};
  return Attractive::mix(m, m, Attractive::like(m));
}
const Contact<double> at_rest = contact_at_rest();

}  // namespace

TEST_CASE("linear_spring: force k_n d at rest, resistance k_t s to a small slip") {
  auto c = at_rest;
  c.tangential_velocity = {1e-3, 0, 0};  // a slip of 1 nm in the step
  Law::History<double> h{};
  const auto f = Law::force(c, coefficients(spring(1)), h);
  CHECK(near_relative(f.normal, 1e4 * c.overlap, 1e-15));
  CHECK(near_relative(-f.tangential.x, 0.5 * 1e4 * 1e-9, 1e-15));
  CHECK(near_relative(h.slip.x, 1e-9, 1e-15));
  const LinearSpring::Material m{1e4, 1};
  CHECK(near_relative(LinearSpring::force(c, LinearSpring::mix(m, m, LinearSpring::like(m))),
                      f.normal, 1e-15));
  CHECK(Law::stiffness(c, coefficients(spring())) == 1e4);
}

TEST_CASE("linear_spring: two materials act as springs in series") {
  const auto p = Law::mix({.stiffness = 1e4, .shear_ratio = 0.5},
                          {.stiffness = 3e4, .shear_ratio = 0.25}, {1, 0});
  CHECK(near_relative(p.stiffness, 1.5e4, 1e-15));
  CHECK(near_relative(p.shear_ratio * p.stiffness, 2 / (1 / 5e3 + 1 / 7.5e3), 1e-15));
}

TEST_CASE("linear_spring: a batch equals doubles to a few ulp") {
  // Sums of three products in another order or fused: 1e-15 each, some tens of operations.
  CHECK(largest_lane_difference<Law>(coefficients(spring()), 1e-5) < 1e-13);
  CHECK(largest_lane_difference<Attractive>(attractive(), 1e-5) < 1e-13);
  const LinearSpring::Material m{1e4, 0.5};
  CHECK(largest_lane_difference<LinearSpring>(LinearSpring::mix(m, m, LinearSpring::like(m)), 0) <
        1e-13);
}

TEST_CASE("linear_spring: friction stays within mu F_n at every normal velocity") {
  check_coulomb_limit<Law>(coefficients(spring()), 0.4, 1e-4);
  check_coulomb_limit<Attractive>(attractive(), 0.4, 1e-4);
}

TEST_CASE("linear_spring: each parameter of the material changes the force") {
  auto c = at_rest;
  c.normal_velocity = -0.1, c.tangential_velocity = {0.01, 0, 0};
  const auto force = [&](const Law::Material& m, double slip) {
    Law::History<double> h{{slip, 0, 0}};
    return Law::force(c, coefficients(m), h);
  };
  const auto changed = [](double Law::Material::*field) {
    auto m = spring();
    m.*field *= 0.9;
    return m;
  };
  const double normal = force(spring(), 0).normal, across = force(spring(), 0).tangential.x;
  const double sliding = force(spring(), 1).tangential.x;
  for (const auto field : {&Law::Material::stiffness, &Law::Material::restitution}) {
    CHECK(std::abs(force(changed(field), 0).normal / normal - 1) > 1e-3);
    CHECK(std::abs(force(changed(field), 0).tangential.x / across - 1) > 1e-3);
  }
  CHECK(std::abs(force(changed(&Law::Material::shear_ratio), 0).tangential.x / across - 1) > 1e-3);
  CHECK(near_relative(force(changed(&Law::Material::friction), 1).tangential.x, 0.9 * sliding,
                      1e-14));
}

TEST_CASE("linear_spring: no closed cycle of displacements gives energy") {
  Random random(3);
  for (const double friction : {0.3, 1e6})
    for (int k = 0; k < 200; ++k) {
      const RandomCycle path(random);
      const auto work = cycle<Law>(coefficients(spring(1, friction)), path, 4000);
      CAPTURE(k);
      // The force of a step sees its end, not its middle: 1/4000 of what is turned over.
      CHECK(work.gained < 2.5e-4 * work.turned_over);
    }
}

TEST_CASE("linear_spring: refuses values out of range and names them") {
  using M = Law::Material;
  const auto with = [](double M::*field, double value) {
    return [=] {
      auto m = spring();
      m.*field = value;
      Law::check(m);
    };
  };
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL})
    refuses(with(&M::stiffness, bad), {"LinearSpringFriction::Material.stiffness", "[N/m]"});
  for (const double bad : {0.0, -0.5, 1.3, std::nan("")}) {
    refuses(with(&M::restitution, bad), {"restitution", "(0, 1]"});
    refuses(with(&M::shear_ratio, bad), {"shear_ratio", "(0, 1]"});
  }
  for (const double bad : {-0.1, std::nan(""), HUGE_VAL})
    refuses(with(&M::friction, bad), {"friction", "[-]"});
  refuses([] { LinearSpring::check(LinearSpring::Material{-1}); },
          {"LinearSpring::Material.stiffness = -1"});
  refuses([] { LinearSpring::check(LinearSpring::Material{1, 2}); }, {"restitution = 2"});
}

}  // namespace linear_spring_test
