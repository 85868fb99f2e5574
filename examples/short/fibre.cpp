// silt - BSD-3-Clause, see LICENSE
//
// Fibres bend under their own weight. Five fibres of bonded spheres, clamped at one end, sag; the
// program prints the tip deflections beside those of an elastic beam by linear theory.
//
// picture: draw fibre/particles.pvd --bonds fibre/bonds.pvd --bond-colour bending --bond-radius 4e-4 --view -15,25 --width 1200 -o fibre.png

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

int main() {
  const double radius = 0.5e-3, density = 1200;          // [m], [kg/m3]
  const silt::ParallelBond glue{.youngs_modulus = 2e6};  // [Pa]
  const silt::HertzMindlin::Material surface{
      .youngs_modulus = 2e7, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.5};

  // A drag brings the fibres to rest; without it they would oscillate for long.
  const double decay = 30;  // [1/s]
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{surface},
                       silt::Bonds{glue}, silt::BodyForce{[decay](const silt::Seen& p) {
                         return -decay * p.mass * p.velocity;
                       }}};
  sim.gravity = {0, 0, -9.81};

  struct Fibre {
    std::size_t bonds;
    silt::ParticleId tip;
  };
  std::vector<Fibre> fibres;
  for (std::size_t k = 0; k < 5; ++k) {
    const std::size_t bonds = 10 + 5 * k;
    const double y = -8 * radius * static_cast<double>(k);
    auto chain = silt::fibre({0, y, 0}, {2 * radius * static_cast<double>(bonds), y, 0}, bonds + 1,
                             {.radius = radius, .density = density});
    chain.spheres[0].fixed = true;  // a clamp
    const auto first = silt::add_bonded(sim, chain);
    fibres.push_back({bonds, first + static_cast<silt::ParticleId>(bonds)});
  }
  sim.run(0.8, silt::vtk_series("fibre", silt::every(0.02)),
          silt::bond_series("fibre", silt::every(0.02)), silt::progress());

  // Beam with the bonds' cross-section, loaded by the weight of each sphere.
  const double I = std::numbers::pi * std::pow(radius, 4) / 4;          // [m4]
  const double weight = density * silt::Sphere::volume(radius) * 9.81;  // [N]
  bool right = true;
  for (const auto& fibre : fibres) {
    const double length = 2 * radius * static_cast<double>(fibre.bonds);
    double beam = 0;  // [m]
    for (std::size_t k = 1; k <= fibre.bonds; ++k) {
      const double x = 2 * radius * static_cast<double>(k);
      beam += weight * x * x * (3 * length - x) / (6 * glue.youngs_modulus * I);
    }
    const double sag = -sim.position(sim.find(fibre.tip)).z;
    std::printf("fibre of %.0f mm: tip %.3f mm lower, beam %.3f mm\n", 1e3 * length, 1e3 * sag,
                1e3 * beam);
    // Fails for a wrong bending stiffness. Fibres that sag by more than a tenth of their length
    // deflect less than linear theory predicts.
    if (beam < 0.1 * length) right = right && std::abs(sag / beam - 1) < 0.02;
  }
  return right ? 0 : 1;
}
