// silt - BSD-3-Clause, see LICENSE
// A user-defined bond model, of docs/bonds.md: glue with the same stiffness in all directions,
// which breaks when its springs store more than a given energy.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

struct Glue {
  double stiffness;  // [N/m]
  double turning;    // [N m]
  double toughness;  // [J]

  template <class Real>
  struct Numbers {
    Real is_there;  // [-] 1; 0 in lanes without a bond
  };
  Numbers<double> numbers(const silt::BondedPair&) const { return {1}; }
  template <class Real>
  silt::BondAnswer<Real> answer(const silt::BondStrain<Real>& s, const Numbers<Real>& p) const {
    const silt::Vec3<Real> none{Real(0), Real(0), Real(0)};
    return {s.shift * (p.is_there * Real(-stiffness)), s.turn * (p.is_there * Real(-turning)), none,
            none};
  }
  template <class Real>
  Real load(const silt::BondAnswer<Real>& a, const silt::Vec3<Real>&, const Numbers<Real>&) const {
    return dot(a.force, a.force) * Real(0.5 / stiffness / toughness) +
           dot(a.couple, a.couple) * Real(0.5 / turning / toughness);
  }
  double energy(const silt::BondStrain<double>& s, const Numbers<double>&) const {
    return 0.5 * stiffness * dot(s.shift, s.shift) + 0.5 * turning * dot(s.turn, s.turn);
  }
  silt::BondStiffness stiffest(const Numbers<double>&) const { return {stiffness, turning}; }
};

int main() {
  const double R = 1e-3;
  const silt::HertzMindlin::Material resin{
      .youngs_modulus = 1e8, .poisson_ratio = 0.3, .restitution = 0.7, .friction = 0.3};
  const auto breaks = [&](double energy, const silt::Vec3d& way) {
    silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{resin},
                         silt::Bonds{Glue{.stiffness = 1e4, .turning = 1e-2, .toughness = 1e-6}}};
    silt::add_bonded(sim, silt::fibre({0, 0, 0}, {2 * R, 0, 0}, 2, {.radius = R, .density = 1200}));
    // Two spheres that fly apart with m*/2 v^2 = energy.
    sim.set_velocity(1, std::sqrt(2 * energy / (sim.mass(0) / 2)) * way);
    sim.run(1e-3);
    return sim.broken_bonds() == 1;
  };
  const bool below = breaks(0.97e-6, {1, 0, 0}), above = breaks(1.03e-6, {1, 0, 0});
  std::printf("0.97 uJ: %s, 1.03 uJ: %s\n", below ? "broken" : "holds", above ? "broken" : "holds");
  return !below && above ? 0 : 1;
}
