// silt - BSD-3-Clause, see LICENSE
//
// A module of your own. Sand and iron fall past a drum with a magnet inside: a short struct adds
// the magnetic force on iron, which lands on the other side of a splitter. The program prints the
// share of the iron that does.
//
// picture: draw own_module/particles.pvd --colour material --names sand,iron --time 0.2 0.6 -o own_module.png

#include <array>
#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

// Magnet along the axis y of a drum. Its field decreases with the square of the distance r. The
// force on a grain of volume V and susceptibility chi is V chi/(2 mu0) times the gradient of B^2.
struct Magnet {
  double field;      // [T] at the surface of the drum
  double radius;     // [m] of the drum
  std::size_t iron;  // number of that material

  // Data of each grain; files and checkpoints contain them under these names.
  struct Fields {
    double susceptibility = 0, impulse = 0;  // [-], [N s]
  };
  static constexpr std::array names{"susceptibility", "impulse [N s]"};

  // Called for each new grain.
  Fields start(const silt::Seen& grain) const {
    return {.susceptibility = grain.material == iron ? 3.0 : 0.0};
  }
  silt::Vec3d force(const silt::Seen& grain, const Fields& f) const {
    const silt::Vec3d from_axis{grain.position.x, 0, grain.position.z};
    const double r = norm(from_axis), mu0 = 1.2566e-6;                         // [m], [N/A2]
    const double gradient = -4 * field * field * std::pow(radius / r, 4) / r;  // [T2/m]
    const double volume = silt::Sphere::volume(grain.radius);
    return volume * f.susceptibility / (2 * mu0) * gradient / r * from_axis;
  }
  // Called after each step.
  void update(const silt::Seen& grain, Fields& f, double dt) const {
    f.impulse += norm(force(grain, f)) * dt;
  }
};

int main() {
  const silt::HertzMindlin::Material sand{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.4, .friction = 0.5};
  const silt::HertzMindlin::Material iron{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.4};
  silt::Contacts<silt::HertzMindlin, silt::SeveralMaterials> contacts{{sand, iron}};
  contacts.set_pair(sand, iron, {.restitution = 0.45, .friction = 0.45});

  const double radius = 0.03, width = 0.02, split = 0.03;  // [m]
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, contacts,
                       Magnet{.field = 0.068, .radius = radius, .iron = contacts.add(iron)}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Cylinder{{0, 0, 0}, {0, width, 0}, radius, silt::Side::Outside}, iron,
               {.name = "drum"});
  sim.add_wall(silt::open_box({-0.04, 0, -0.13}, {0.1, width, 0.11}), sand, {.name = "bins"});
  sim.add_wall(silt::rectangle({split, 0, -0.13}, {0, width, 0}, {0, 0, 0.07}), iron,
               {.name = "splitter"});
  const silt::Box feed{{0.036, 0, 0.08}, {0.05, width, 0.1}};
  sim.add_inlet(feed, {.radius = silt::uniform(0.9e-3, 1.1e-3),
                       .density = 2600,
                       .rate = 3000,
                       .velocity = {0, 0, -0.5},
                       .total = 1000,
                       .recipe = {{.share = 0.3,
                                   .radius = silt::uniform(0.9e-3, 1.1e-3),
                                   .density = 7800,
                                   .material = contacts.add(iron)}}});
  sim.run(0.6, silt::vtk_series("own_module", silt::every(0.01)));

  // Grains of each material on the left of the splitter, and in total.
  std::array<double, 2> left{}, all{};
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    all[sim.material(k)] += 1;
    if (sim.position(k).x < split) left[sim.material(k)] += 1;
  }
  const double recovered = left[1] / all[1], purity = left[1] / (left[0] + left[1]);
  std::printf("%.1f %% of the iron is recovered, with a purity of %.1f %%\n", 100 * recovered,
              100 * purity);
  // Fails for a force on the wrong grains, or on none: without it all fall to the right.
  return recovered > 0.8 && purity > 0.8 ? 0 : 1;
}
