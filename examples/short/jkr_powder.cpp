// silt - BSD-3-Clause, see LICENSE
//
// Cohesive powder packs loosely. Grains of 0.1 mm fall into a box, once without and once with JKR
// adhesion: then they stick at first contact, and large pores remain. The program prints the solid
// fraction of both beds.
//
// picture: draw jkr_powder/dry.vtp jkr_powder/sticky.vtp --colour contacts --title dry sticky -o jkr_powder.png

#include <cstdio>
#include <string>

#include <silt/silt.hpp>

// Solid fraction [-] of a bed of grains with this work of adhesion [J/m2].
double solid_fraction(const std::string& name, double work_of_adhesion) {
  // Softer than real powder, for a larger time step: with a modulus of 1e6 Pa instead of 1e9 Pa, a
  // work of 0.01 J/m2 corresponds to 0.16 J/m2 (docs/contact_laws.md).
  const silt::Jkr::Material powder{.youngs_modulus = 1e6,  // [Pa]
                                   .poisson_ratio = 0.25,
                                   .work_of_adhesion = work_of_adhesion,
                                   .restitution = 0.5,
                                   .friction = 0.5};
  const double length = 1.5e-3, width = 0.5e-3;  // [m]; the box repeats across
  silt::Particles<silt::Sphere> grains;
  grains.fill({{0, 0, 0}, {length, width, 6e-3}}, {.radius = silt::uniform(45e-6, 55e-6),
                                                   .density = 2500,
                                                   .count = 1500,
                                                   .arrangement = silt::Arrangement::Random});
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::Jkr>{powder}, silt::Field<"contacts">{},
      silt::PeriodicBox{{{0, 0, -1e-3}, {length, width, 8e-3}}, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, -1, 0}, {length, 1, 8e-3}), powder);
  sim.run(0.05);

  const auto partners = silt::coordination(sim);
  double volume = 0;  // [m3]
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    sim.field<"contacts">(k) = static_cast<double>(partners.of[k]);
    volume += silt::Sphere::volume(sim.radius(k));
  }
  silt::write_particles("jkr_powder/" + name + ".vtp", sim);
  // The bed is twice as high as its centre of mass.
  const double fraction = volume / (length * width * 2 * sim.centre_of_mass().z);
  std::printf("%s: solid fraction %.3f, %.1f contacts a grain\n", name.c_str(), fraction,
              partners.mean);
  return fraction;
}

int main() {
  silt::make_folder("jkr_powder");
  const double dry = solid_fraction("dry", 0), sticky = solid_fraction("sticky", 0.01);
  // Fails for adhesion without effect, and for grains that do not settle.
  return dry > 0.5 && sticky < dry - 0.1 ? 0 : 1;
}
