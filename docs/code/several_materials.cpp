// silt - BSD-3-Clause, see LICENSE
//
// A steel ball falls onto hollow and solid glass grains: several materials in one scene, a sphere
// that is not solid, and a run continued from a checkpoint (docs/tutorial.md, docs/shapes.md).

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

// A sphere with its mass in a thin shell: I = 2/3 m r^2.
struct HollowSphere : silt::Sphere {
  static constexpr double inertia_factor() { return 2.0 / 3.0; }
};

const silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};
const silt::HertzMindlin::Material steel{
    .youngs_modulus = 5e7, .poisson_ratio = 0.29, .restitution = 0.6, .friction = 0.3};

auto make() {
  silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts{{glass, steel}};
  contacts.add(glass, "glass"), contacts.add(steel, "steel");  // names, for messages
  contacts.set_pair(glass, steel, {.restitution = 0.7, .friction = 0.35});

  silt::Particles<silt::Sphere> grains;
  grains.fill({.min = {0, 0, 0}, .max = {0.02, 0.02, 0.02}},
              {.radius = 0.75e-3, .density = 2500, .count = 500, .material = contacts.add(glass)});
  grains.add({.position = {0.01, 0.01, 0.03},
              .radius = 4e-3,
              .density = 7800,
              .material = contacts.add(steel)});

  silt::Simulation sim{std::move(grains), contacts};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 2;  // results do not depend on it; left out: all processors
  sim.add_wall(silt::box({0, 0, 0}, {0.02, 0.02, 0.05}), steel);
  return sim;
}

/// The acceleration of a ball that rolls down a slope of 20 degrees, relative to one that slides
/// without friction.
template <class Ball>
double rolled() {
  silt::Particles<Ball> one;
  one.add({.position = {0, 0, 1e-3}, .radius = 1e-3, .density = 2500});
  silt::Simulation sim{std::move(one), silt::Contacts<silt::HertzMindlin>{glass}};
  const double slope = 20 * M_PI / 180, g = 9.81;
  sim.gravity = {g * std::sin(slope), 0, -g * std::cos(slope)};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.run(0.1);
  return sim.velocity(0).x / (sim.time() * g * std::sin(slope));
}

int main() {
  auto sim = make();
  sim.run(0.05);
  silt::save_checkpoint(sim, "half.silt");
  sim.run(0.05);

  auto again = make();  // its particles are replaced by those of the file
  silt::load_checkpoint(again, "half.silt");
  again.run(0.05);

  const auto ball = sim.find(500);
  std::printf("time step %.3g s; after %.4f s and %lld steps the ball is at z = %.2f mm\n",
              sim.step_length(), sim.time(), static_cast<long long>(sim.step()),
              1e3 * sim.position(ball).z);
  const bool same = again.position(again.find(500)).z == sim.position(ball).z;
  std::printf("from the checkpoint: %s\n", same ? "the same bits" : "other bits");

  const double solid = rolled<silt::Sphere>(), hollow = rolled<HollowSphere>();
  std::printf("rolling: solid %.4f (1/1.4 = 0.7143), hollow %.4f (0.6)\n", solid, hollow);
  // The lever arm of friction is shorter by the overlap, 1e-3 of the radius here.
  const bool rolls = std::abs(solid * 1.4 - 1) < 1e-3 && std::abs(hollow / 0.6 - 1) < 1e-3;
  return same && rolls && sim.size() == 501 ? 0 : 1;
}
