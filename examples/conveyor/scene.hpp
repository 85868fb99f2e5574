// silt - BSD-3-Clause, see LICENSE
#pragma once

// The transfer's scene: two belts with their skirts, a hinged plate between them, an inlet of ore
// and fines.
//
//   conveyor::Scene s;
//   auto sim = conveyor::make_simulation(s);
//   sim.run(s.steady(), silt::vtk_series("out", silt::every(0.05)));

#include <array>
#include <cmath>

#include <silt/silt.hpp>

namespace conveyor {

using silt::Vec3d;
using Law = silt::HertzMindlin;

constexpr double g = 9.81;  // [m/s2]

/// Residence time of each grain.
struct Age {
  struct Fields {
    double age = 0;  // [s]
  };
  static constexpr std::array names{"age [s]"};
  void update(const silt::Seen&, Fields& f, double dt) const { f.age += dt; }
};

struct Scene {
  double rate = 2;                         // [kg/s] of the feed
  double measured = 2.5;                   // [s] of steady flow
  double upper = 1, lower = 1.2;           // [m/s] of the belts
  double plate_mass = 1.5;                 // [kg]
  static constexpr double density = 2700;  // [kg/m3]

  // Belts: the upper one along x, its end at x = 0; the lower one along y.
  static constexpr double length = 0.5, half_width = 0.08, top = 0.3;   // [m]
  static constexpr double across = 0.15, behind = -0.15, end = 0.5;     // [m] of the lower one
  static constexpr double skirt = 0.08;                                 // [m] height
  static constexpr double at_plate = 0.11, hinge = 0.43, plate = 0.29;  // [m]

  // The feed: a quarter of the grains by number are lumps, the rest fines.
  static constexpr double lumps = 0.25, small[2] = {3e-3, 5e-3}, large[2] = {6e-3, 8e-3};  // [m]

  double steady() const {  // [s] from when the flow is: half as long again as both belts take
    return 0.5 + 1.5 * (length / upper + (end - behind) / lower);
  }
  /// Mean of r^n of the feed [m^n].
  static double moment(int n) {
    const auto of = [n](const double(&r)[2]) {
      return (std::pow(r[1], n + 1) - std::pow(r[0], n + 1)) / ((n + 1) * (r[1] - r[0]));
    };
    return (1 - lumps) * of(small) + lumps * of(large);
  }
  /// Standard deviation of the mass fed within a time [s], over its mean [-]: the number of grains
  /// is exact, their masses are random.
  double scatter(double time) const {
    const double mass = density * silt::Sphere::volume(1) * moment(3);
    return std::sqrt((moment(6) / (moment(3) * moment(3)) - 1) * mass / (rate * time));
  }

  Law::Material ore() const { return solid(0.5); }
  Law::Material fines() const { return solid(0.6); }
  Law::Material rubber() const {
    return {.youngs_modulus = 4e7, .poisson_ratio = 0.45, .restitution = 0.3, .friction = 0.8};
  }
  Law::Material steel() const {
    return {.youngs_modulus = 1e8, .poisson_ratio = 0.3, .restitution = 0.4, .friction = 0.35};
  }

 private:
  static Law::Material solid(double friction) {
    return {.youngs_modulus = 5e7, .poisson_ratio = 0.25, .restitution = 0.3, .friction = friction};
  }
};

inline auto contacts_of(const Scene& s) {
  silt::Contacts<Law, silt::SeveralMaterials, silt::RollingEpsd> contacts{
      s.ore(), {.rolling_friction = 0.15}};
  contacts.add(s.ore(), "ore"), contacts.add(s.fines(), "fines");
  contacts.add(s.rubber(), "rubber"), contacts.add(s.steel(), "steel");
  contacts.set_pair(s.ore(), s.fines(), {.restitution = 0.3, .friction = 0.55});
  for (const auto& solid : {s.ore(), s.fines()}) {
    contacts.set_pair(solid, s.rubber(), {.restitution = 0.3, .friction = 0.8});
    contacts.set_pair(solid, s.steel(), {.restitution = 0.4, .friction = 0.35});
  }
  return contacts;
}

inline auto make_simulation(const Scene& s) {
  const double w = Scene::half_width, top = Scene::top, a = Scene::across, h = Scene::skirt;
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, contacts_of(s), Age{}};
  sim.gravity = {0, 0, -g};

  const double x0 = -Scene::length, y0 = Scene::behind, long_y = Scene::end - Scene::behind;
  sim.add_wall(silt::rectangle({x0, -w, top}, {Scene::length, 0, 0}, {0, 2 * w, 0}), s.rubber(),
               {.name = "upper belt", .surface_velocity = {.velocity = {s.upper, 0, 0}}});
  sim.add_wall(silt::rectangle({-a, y0, 0}, {2.2 * a, 0, 0}, {0, long_y, 0}), s.rubber(),
               {.name = "lower belt", .surface_velocity = {.velocity = {0, s.lower, 0}}});
  const double hair = 1e-3;  // [m] between a belt and what stands over it
  sim.add_wall(silt::rectangle({x0, -w, top + hair}, {Scene::length, 0, 0}, {0, 0, h}), s.steel(),
               {.name = "upper skirt, right"});
  sim.add_wall(silt::rectangle({x0, w, top + hair}, {Scene::length, 0, 0}, {0, 0, h}), s.steel(),
               {.name = "upper skirt, left"});
  sim.add_wall(silt::rectangle({x0, -w, top + hair}, {0, 2 * w, 0}, {0, 0, 2 * h}), s.steel(),
               {.name = "upper back"});
  sim.add_wall(silt::rectangle({-a, y0, hair}, {0, long_y, 0}, {0, 0, 1.5 * h}), s.steel(),
               {.name = "lower skirt, near"});
  sim.add_wall(silt::rectangle({1.2 * a, y0, hair}, {0, long_y, 0}, {0, 0, 1.5 * h}), s.steel(),
               {.name = "lower skirt, far"});
  sim.add_wall(silt::rectangle({-a, y0, hair}, {2.2 * a, 0, 0}, {0, 0, 1.5 * h}), s.steel(),
               {.name = "lower back"});
  // Hangs from its upper edge, and swings in the plane of the stream.
  const double x = Scene::at_plate, L = Scene::plate;
  sim.add_wall(silt::rectangle({x, -1.4 * w, Scene::hinge - L}, {0, 2.8 * w, 0}, {0, 0, L}),
               s.steel(),
               {.name = "plate",
                .drive = silt::Hinge{.centre = {x, 0, Scene::hinge},
                                     .axis = {0, -1, 0},
                                     .inertia = s.plate_mass * L * L / 3,
                                     .mass = s.plate_mass,
                                     .centre_of_mass = {x, 0, Scene::hinge - L / 2},
                                     .damping = 0.05}});  // [N m s/rad] of its bearings
  sim.set_reference("plate", {x, 0, Scene::hinge});

  sim.add_inlet(silt::Box{{x0 + 0.01, -w + 0.01, top + 0.11}, {x0 + 0.13, w - 0.01, top + 0.2}},
                {.radius = silt::uniform(Scene::small[0], Scene::small[1]),
                 .density = Scene::density,
                 .velocity = {0, 0, -1},
                 .material = sim.find_material("fines"),
                 .mass_rate = s.rate,
                 .recipe = {{.share = Scene::lumps,
                             .radius = silt::uniform(Scene::large[0], Scene::large[1]),
                             .density = Scene::density,
                             .material = sim.find_material("ore")}}});
  sim.add_outlet({{-1, Scene::end, -1}, {1, 1, -0.05}});   // over the lower belt's end
  sim.add_outlet({{-1, -1, -1}, {1, Scene::end, -0.05}});  // what is spilled
  return sim;
}

}  // namespace conveyor
