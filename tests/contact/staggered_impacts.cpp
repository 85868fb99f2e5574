// silt - BSD-3-Clause, see LICENSE
#include <cmath>
#include <numbers>
#include <vector>

#include <silt/contact/contacts.hpp>
#include <silt/simulation.hpp>

#include <doctest/doctest.h>

namespace staggered_impacts_test {

namespace {

using namespace silt;

/// A spring and a dashpot that never pull. With a branch it is right for one double alone, and
/// refused elsewhere (tests/compile/refused/law_with_if.cpp).
template <bool Branches>
struct NoPull {
  struct Material {
    double stiffness, damping;  // [N/m], [N s/m]
    bool operator==(const Material&) const = default;
  };
  template <class Real>
  struct Coefficients {
    Real k, c;
  };
  static Coefficients<double> mix(const Material& a, const Material&) {
    return {a.stiffness, a.damping};
  }
  template <class Real>
  static Real force(const Contact<Real>& c, const Coefficients<Real>& p) {
    Real f = p.k * c.overlap - p.c * c.normal_velocity;
    if constexpr (Branches) {
      if (f < 0) f = 0;
    } else {
      f = select(f < 0, Real(0), f);
    }
    return f;
  }
};

constexpr double speed = 0.5, R = 1e-3, rho = 2500, k = 1000, share = 0.3, dt = 2e-7;
const double m = rho * 4 / 3 * std::numbers::pi * R * R * R;

/// Rebound speeds [m/s] of sixteen spheres on a plane, each some tenths of a contact after the one
/// before it: lanes of a pack are at all stages of the impact at once.
template <class Law, class Kernels>
std::vector<double> rebounds(Kernels kernels) {
  // share of the critical damping on a wall, where m* = m
  const typename Law::Material material{k, 2 * share * std::sqrt(k * m)};
  const double contact = std::numbers::pi * std::sqrt(m / k);  // [s]
  Particles<Sphere> spheres;
  for (int n = 0; n < 16; ++n) {
    // All touch in the middle of a step.
    const double gap = speed * dt * (3.5 + std::floor(0.31 * n * contact / dt));
    spheres.add({.position = {3 * R * n, 0, R + gap},
                 .radius = R,
                 .density = rho,
                 .velocity = {0, 0, -speed}});
  }
  Simulation sim{std::move(spheres), Contacts<Law>{material}, kernels};
  sim.add_wall(Plane{{0, 0, 0}, {0, 0, 1}}, material);
  sim.time_step = dt, sim.threads = 1;
  sim.guard.max_overlap = 0.5;
  sim.run(7 * contact);
  std::vector<double> out;
  for (std::uint32_t id = 0; id < 16; ++id) out.push_back(sim.velocity(sim.find(id)).z);
  return out;
}

}  // namespace

TEST_CASE("staggered impacts: a law that selects rebounds alike in all lanes, as its closed form") {
  const auto lanes = rebounds<NoPull<false>>(KernelsFor<DefaultArch>{});
  const auto branched = rebounds<NoPull<true>>(KernelsFor<OneLane>{});
  // T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465: the contact ends as its force does.
  const double root = std::sqrt(1 - share * share);
  const double e = std::exp(
      -share / root * (std::numbers::pi - std::atan2(2 * share * root, 1 - 2 * share * share)));
  for (std::size_t n = 0; n < 16; ++n) {
    CAPTURE(n);
    // First order in the step: the dashpot at first touch, and the end of the contact.
    CHECK(lanes[n] == doctest::Approx(e * speed).epsilon(2e-3));
    // What stays is the rounding of positions, 1e-16 of 0.1 m over overlaps of 1e-5 m.
    CHECK(lanes[n] == doctest::Approx(lanes[0]).epsilon(1e-8));
    CHECK(branched[n] == doctest::Approx(lanes[n]).epsilon(1e-12));
  }
}

}  // namespace staggered_impacts_test
