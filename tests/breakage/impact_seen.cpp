// silt - BSD-3-Clause, see LICENSE
// What an equivalence function is told of an impact in a simulation.
#include <cmath>
#include <utility>

#include <doctest/doctest.h>

#include <silt/breakage/breakage.hpp>
#include <silt/breakage/sizes.hpp>
#include <silt/breakage/strength.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/impact.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/softened.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace breakage_impact_seen_test {

struct Probe {
  static constexpr silt::LoadUnit unit = silt::LoadUnit::Force;
  static inline silt::Impact last{};
  double load(const silt::Impact& impact) const { return last = impact, 0.0; }
  void check() const {}
};

constexpr double radius = 1e-3, density = 2165, speed = 3;

/// A sphere flies at a plane of its material.
template <class Law>
silt::Impact seen(const typename Law::Material& material) {
  silt::Particles<silt::Sphere> grain;
  grain.add({.position = {0, 0, 1.02 * radius},
             .radius = radius,
             .density = density,
             .velocity = {0.5, 0, -speed}});
  silt::Simulation sim{std::move(grain), silt::Contacts<Law>{material},
                       silt::Breakage{silt::LogLogisticStrength{31, 2e-3, 1.6, 3},
                                      Probe{},
                                      silt::GaudinSchuhmann{1, 0.8},
                                      {.dust_below = 0.5e-3}}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, material);
  Probe::last = {};
  sim.run(0.03 * radius / speed);
  return Probe::last;
}

TEST_CASE(
    "breakage: an impact at touch tells the spring's largest force, with the solid's modulus") {
  using Soft = silt::Softened<silt::HertzMindlin>;
  const double mass = density * silt::Sphere::volume(radius);
  for (const double e : {1.0, 0.8, 0.4}) {
    const double hertz =
        silt::hertz_max_elastic_force({silt::effective_modulus(2e9, 0.25, 2e9, 0.25), radius, mass,
                                       speed, silt::damping_ratio(e, silt::DampingEnd::ZeroForce)});
    const silt::HertzMindlin::Material solid{
        .youngs_modulus = 2e9, .poisson_ratio = 0.25, .restitution = e, .friction = 0.3};
    const silt::Impact plain = seen<silt::HertzMindlin>(solid);
    CHECK(plain.elastic_force == near(hertz).epsilon(1e-12));
    CHECK(plain.speed == near(speed).epsilon(1e-12));
    CHECK(plain.m_eff == near(mass).epsilon(1e-12));
    CHECK(plain.at_wall);
    // The softened modulus would give a force lower by 5^-1.
    CHECK(seen<Soft>({.solid = solid, .full_radius = 5 * radius}).elastic_force ==
          near(hertz).epsilon(1e-12));
  }
  // k x, m v^2 = k x^2
  const double k = 1e5;
  CHECK(seen<silt::LinearSpringFriction>({.stiffness = k, .restitution = 1}).elastic_force ==
        near(speed * std::sqrt(k * mass)).epsilon(1e-12));
}

}  // namespace breakage_impact_seen_test
