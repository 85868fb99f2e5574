// silt - BSD-3-Clause, see LICENSE
// The program of docs/modules.md: charged grains fall through an electric field and past a lamp
// that heats them.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

struct Lamp {
  silt::Box beam;
  double power;          // [W] on each grain in the beam
  double heat_capacity;  // [J/(kg K)]
  struct Fields {
    double temperature = 293, seconds_in_beam = 0;  // [K], [s]
  };
  static constexpr std::array names{"temperature [K]", "seconds in beam"};
  void update(const silt::Seen& p, Fields& f, double dt) const {
    if (!beam.contains(p.position)) return;
    f.temperature += power / (p.mass * heat_capacity) * dt;
    f.seconds_in_beam += dt;
  }
};

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
  silt::Particles<silt::Sphere> grains;
  for (int k = 0; k < 3; ++k)
    grains.add({.position = {0, 0.005 * k, 0.1}, .radius = 0.25e-3, .density = 2500});

  const silt::Vec3d E{2e5, 0, 0};  // [V/m]
  silt::Simulation sim{
      std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
      silt::BodyForce{silt::Field<"charge [C]">{},
                      [E](const silt::Seen&, double charge) { return charge * E; }},
      Lamp{.beam = {{-1, -1, 0.05}, {1, 1, 0.06}}, .power = 1e-3, .heat_capacity = 840}};
  sim.gravity = {0, 0, -9.81};
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.field<"charge [C]">(k) = 5e-13 * (static_cast<double>(k) - 1);  // -, none, +

  sim.run(0.12, silt::vtk_series("charged", silt::every(0.02)),
          silt::csv_series("charged", silt::every(0.06)));
  double hottest = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const auto& lamp = sim.field<Lamp>(k);
    hottest = std::max(hottest, lamp.temperature);
    std::printf("charge %5.1f pC: at x = %6.2f mm, %.1f K after %.2f ms in the beam\n",
                1e12 * sim.field<"charge [C]">(k), 1e3 * sim.position(k).x, lamp.temperature,
                1e3 * lamp.seconds_in_beam);
  }

  // Fails if a force acts on the wrong grain, twice or not at all (x = q E t2/(2 m)), or if a field
  // counts steps twice (from 0.04 to 0.05 m below the start, v2 = 2 g h).
  const double t = sim.time(), m = sim.mass(0);
  const double deflection = 0.5 * 5e-13 * 2e5 / m * t * t;
  const double in_beam = (std::sqrt(2 * 9.81 * 0.05) - std::sqrt(2 * 9.81 * 0.04)) / 9.81;
  bool right = true;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const double wanted = deflection * (static_cast<double>(sim.id(k)) - 1);
    right &= std::abs(sim.position(k).x - wanted) < 1e-6 * deflection;
    // The ends of the beam are resolved to one step.
    right &= std::abs(sim.field<Lamp>(k).seconds_in_beam - in_beam) < 1.5 * sim.step_length();
  }
  right &= std::abs((hottest - 293) / (1e-3 / (m * 840) * in_beam) - 1) < 0.02;
  if (!right)
    std::printf("wrong: x = %.4f mm and %.3f ms in the beam were expected\n", 1e3 * deflection,
                1e3 * in_beam);
  return right ? 0 : 1;
}
