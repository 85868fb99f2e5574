// silt - BSD-3-Clause, see LICENSE
//
// Particles are removed, added and changed during a run (docs/edits.md): a sieve as a floor.

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.6, .friction = 0.4};
  silt::Particles<silt::Sphere> grains;
  grains.fill({.min = {0, 0, 0}, .max = {0.02, 0.02, 0.04}},  // [m]
              {.radius = silt::uniform(0.6e-3, 1.2e-3), .density = 2500, .count = 800});
  const std::size_t all = grains.size();

  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::EnergyLedger{}};
  sim.gravity = {0, 0, -9.81};  // [m/s2]
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.08}), glass);

  // Every millisecond: fine grains near the floor fall through; as many come back at the top.
  std::size_t sieved = 0;
  const auto sieve = [&](auto& s) {
    silt::Particles<silt::Sphere> back;
    for (std::size_t k = 0; k < s.rows() && back.size() < 9; ++k)
      if (s.is_present(k) && s.radius(k) < 0.75e-3 && s.position(k).z < 2e-3) {
        const double site = static_cast<double>(back.size());
        back.add({.position = {4e-3 + 6e-3 * std::fmod(site, 3), 4e-3 + 6e-3 * std::floor(site / 3),
                               0.075},
                  .radius = s.radius(k),
                  .density = 2500,
                  .velocity = {0, 0, -1.8}});  // [m/s] on, before the next ones come
        s.remove(s.id(k));
      }
    s.add(back);
    sieved += back.size();
  };
  sim.run(0.1, silt::at(silt::every(1e-3), sieve));

  // One grain is shot upwards.
  sim.set_velocity(7, {0, 0, 1});            // [m/s]
  sim.set_angular_velocity(7, {100, 0, 0});  // [rad/s]
  sim.run(0.02, silt::at(silt::every(1e-3), sieve));

  const auto e = sim.energy();

  const auto volume = [&] {  // [m3] of those that wear
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k) && sim.id(k) % 2 == 0) sum += silt::Sphere::volume(sim.radius(k));
    return sum;
  };
  const double before = volume();
  // Half of all grains wear: each of them loses 1 % of its radius in every millisecond.
  const auto wear = [](auto& s) {
    for (std::size_t k = 0; k < s.rows(); ++k)
      if (s.is_present(k) && s.id(k) % 2 == 0) s.set_radius(s.id(k), 0.99 * s.radius(k));
  };
  sim.run(0.01, silt::at(silt::every(1e-3), wear));
  const double left = volume() / before;

  std::printf(
      "%zu grains went through the sieve and came back; books close to %.1e of %.3g J\n"
      "worn grains have %.3f of their volume\n",
      sieved, std::abs(e.residual()) / e.initial, e.initial, left);
  return sim.size() == all && sieved > 20 && std::abs(e.residual()) < 2e-3 * e.initial &&
                 std::abs(left - std::pow(0.99, 30)) < 1e-9
             ? 0
             : 1;
}
