// silt - BSD-3-Clause, see LICENSE
#pragma once

// The shear box: two halves, a pressing lid, and a sample of spheres. A test is
//
//   shear_box::Scene s;
//   shear_box::prepare(s, true, threads, "dense.silt");
//   auto sim = shear_box::make_box(s, true, threads);
//   silt::load_checkpoint(sim, "dense.silt");
//   shear_box::load_lid(sim, s, 50e3);  // [Pa]
//   for (const char* wall : {"lower half", "floor"})
//     sim.set_motion(wall, shear_box::shear_from(sim.time(), s.speed(), 0.01));

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <silt/silt.hpp>

namespace shear_box {

using silt::Vec3d;
using Law = silt::HertzMindlin;

struct Scene {
  double diameter = 2.5e-3;        // [m] the mean; sizes from 0.8 to 1.2 of it
  double length = 24, width = 10;  // [diameters] inside; along the motion, across
  double height = 12;              // [diameters] of the sample, about
  double travel = 4;               // [diameters] of the lower half
  double inertial = 8e-3;          // [-] at the lowest stress, of a band of 5 diameters
  double stiffness = 7e4;          // [-] Young's modulus over the highest stress
  double friction = 0.5;           // [-] between particles, and on floor and lid
  double wall_friction = 0.1;      // [-] on the walls of both halves
  std::vector<double> stress{25e3, 50e3, 100e3};     // [Pa] on the lid, from the lowest on
  static constexpr double density = 2600, g = 9.81;  // [kg/m3], [m/s2]
  static constexpr double band = 5;                  // [diameters] of which `inertial` is reckoned
  // [-] Solid fractions at which this number of grains fills about `height`.
  static constexpr double dense = 0.61, loose = 0.55;
  static constexpr double smooth = 0.02, rough = 2;  // [-] friction while samples are made

  double L() const { return length * diameter; }            // [m]
  double W() const { return width * diameter; }             // [m]
  double split() const { return 0.5 * height * diameter; }  // [m] from the floor, where z = 0
  double area() const { return L() * W(); }                 // [m2]
  /// [s] in which this stress accelerates a grain over its diameter.
  double inertial_time(double pressure) const { return diameter * std::sqrt(density / pressure); }
  double speed() const {  // [m/s] of the lower half
    return inertial * band * diameter / inertial_time(stress.front());
  }
  double mean_volume() const {  // [m3] of a grain; radii are uniform
    return M_PI / 6 * std::pow(diameter, 3) * (std::pow(1.2, 4) - std::pow(0.8, 4)) / 1.6;
  }
  double lid_mass() const { return 7800 * area() * 4 * diameter; }  // [kg] steel, 4 diameters thick
  std::size_t grains(bool is_dense) const {
    const double solid = (is_dense ? dense : loose) * area() * height * diameter;
    return static_cast<std::size_t>(solid / mean_volume());
  }
  // Overlaps of about (stress/modulus)^(2/3) of the diameter.
  Law::Material solid(double mu) const {
    return {.youngs_modulus = stiffness * stress.back(),
            .poisson_ratio = 0.2,
            .restitution = 0.3,
            .friction = mu};
  }
};

/// Rectangles that are joined to one mesh.
struct Panels {
  std::vector<std::array<Vec3d, 3>> triangles;
  Panels& add(const Vec3d& corner, const Vec3d& a, const Vec3d& b) {
    triangles.push_back({corner, corner + a, corner + a + b});
    triangles.push_back({corner, corner + a + b, corner + b});
    return *this;
  }
  /// Four walls around [0, L] x [0, W], from z = low upwards.
  Panels& walls(double L, double W, double low, double height) {
    const Vec3d x{L, 0, 0}, y{0, W, 0}, z{0, 0, height}, o{0, 0, low};
    return add(o, x, z).add(o + y, x, z).add(o, y, z).add(o + x, y, z);
  }
};

/// The lid during preparation: a servo that approaches the sample gently.
inline silt::ServoForce press(const Scene& s, double stress) {
  return {.direction = {0, 0, -1},
          .force = stress * s.area(),
          .max_speed = 0.5 * s.diameter / s.inertial_time(s.stress.front())};
}

/// Grains on a grid above the floor, which fall and are compressed by the lid; material 0 during
/// preparation, 1 afterwards. The split of the box is at z = 0, and its lower half moves to +x.
inline auto make_box(const Scene& s, bool is_dense, int threads) {
  const double made_with = is_dense ? Scene::smooth : Scene::rough;
  const double L = s.L(), W = s.W(), D = s.split(), d = s.diameter;
  silt::Particles<silt::Sphere> grains;
  silt::Random random(7);
  const double pitch = 1.21 * d;
  const int nx = static_cast<int>(L / pitch), ny = static_cast<int>(W / pitch);
  const auto count = static_cast<int>(s.grains(is_dense));
  for (int k = 0; k < count; ++k) {
    const auto any = [&] { return 2 * random.uniform() - 1; };
    const double r = 0.5 * d * (1 + 0.2 * any());
    const double x = any(), y = any(), z = any();
    grains.add({.position = {L / nx * (k % nx + 0.5), W / ny * (k / nx % ny + 0.5),
                             pitch * (k / (nx * ny) + 0.5) - D},
                .radius = r,
                .density = Scene::density,
                .velocity = 0.3 * Vec3d{x, y, z}});
  }
  const double top = pitch * (count / (nx * ny) + 2) - D;
  const auto fresh = s.solid(made_with), grain = s.solid(s.friction);
  silt::Contacts<Law, silt::SeveralMaterials> contacts{fresh};
  contacts.add(fresh, "fresh"), contacts.add(grain, "grain");
  contacts.add(s.solid(s.wall_friction), "steel"), contacts.add(grain, "plate");
  silt::Simulation sim{std::move(grains), contacts, silt::EnergyLedger{}};
  sim.threads = threads;
  sim.gravity = {0, 0, -Scene::g};
  const auto pair = [&](const char* a, const char* b, double mu) {
    sim.set_pair(a, b, {.restitution = 0.3, .friction = mu});
  };
  pair("fresh", "grain", made_with), pair("fresh", "steel", std::min(made_with, s.wall_friction));
  pair("fresh", "plate", std::min(made_with, s.friction));
  pair("grain", "steel", s.wall_friction), pair("grain", "plate", s.friction);
  pair("steel", "plate", s.wall_friction);

  const auto steel = s.solid(s.wall_friction);
  const double flange = (s.travel + 2) * d;  // [m] what the halves lay open as they are offset
  const Vec3d across{0, W, 0}, out{flange, 0, 0};
  sim.add_wall(silt::TriangleMesh(Panels{}.walls(L, W, -D, D).add(-out, out, across).triangles),
               steel, {.name = "lower half"});
  sim.add_wall(silt::Plane{{0, 0, -D}, {0, 0, 1}}, grain, {.name = "floor", .material = "plate"});
  sim.add_wall(
      silt::TriangleMesh(Panels{}.walls(L, W, 0, top + d).add({L, 0, 0}, out, across).triangles),
      steel, {.name = "upper half"});
  sim.add_wall(silt::Plane{{0, 0, top}, {0, 0, -1}}, grain,
               {.name = "lid", .drive = press(s, s.stress.front()), .material = "plate"});
  return sim;
}

/// Kinetic energy [J] over stress times volume [-].
template <class Sim>
double unrest(const Sim& sim, const Scene& s, double stress) {
  return sim.kinetic_energy() / (stress * s.area() * s.height * s.diameter);
}

/// Runs until the lid has reached its force and the grains are at rest; false if they do not.
template <class Sim>
bool come_to_rest(Sim& sim, const Scene& s, double stress) {
  for (int k = 0; k < 120; ++k) {
    sim.run(5 * s.inertial_time(stress));
    if (std::abs(sim.wall("lid").force.z / (stress * s.area()) - 1) < 5e-3 &&
        unrest(sim, s, stress) < 5e-6)
      return true;
  }
  return false;
}

/// From now on the lid is a steel plate under a dead weight, free to move vertically, as in the
/// apparatus.
template <class Sim>
void load_lid(Sim& sim, const Scene& s, double stress) {
  const double mass = s.lid_mass();
  sim.set_drive("lid", silt::Slide{.direction = {0, 0, -1},
                                   .mass = mass,
                                   .force = stress * s.area() - mass * Scene::g});
}

/// Prepares the sample at the lowest stress and gives its grains their friction; all its tests
/// start from the file.
inline void prepare(const Scene& s, bool is_dense, int threads, const std::string& file) {
  auto sim = make_box(s, is_dense, threads);
  come_to_rest(sim, s, s.stress.front());
  for (std::size_t k = 0; k < sim.rows(); ++k) sim.set_material(sim.id(k), "grain");
  come_to_rest(sim, s, s.stress.front());
  silt::save_checkpoint(sim, file);
}

/// Displacement [m] of the lower half at a time t after its start: it accelerates to its speed
/// within `ramp` [s].
inline silt::Motion shear_from(double now, double speed, double ramp) {
  return [=](double time) {
    const double t = std::max(time - now, 0.0);
    const double way = t < ramp ? 0.5 * speed * t * t / ramp : speed * (t - 0.5 * ramp);
    return silt::Pose{{}, {way, 0, 0}};
  };
}

}  // namespace shear_box
