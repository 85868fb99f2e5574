// silt - BSD-3-Clause, see LICENSE
#pragma once

// The heap's scene: a channel with grains glued on its floor, periodic across, and a column of
// grains behind a gate.
//
//   heap::Scene s;
//   auto sim = heap::make_simulation<heap::Grains>(s, silt::Contacts<heap::Law>{s.material()});
//   sim.run(s.settling);
//   sim.remove_wall(heap::Scene::gate);
//   sim.run(1.0, silt::vtk_series("out", silt::every(0.05)));

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

namespace heap {

using Law = silt::HertzMindlin;
using silt::Sphere, silt::Vec3d;
using Grains = silt::Mix<Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron>;

struct Scene {
  std::size_t particles = 500;
  double grain = 4e-3;     // [m] radius of the sphere of a grain's volume
  double length = 0.088;   // [m] of the column, to the gate: 10 glued grains
  double width = 0.0352;   // [m] of a period: 4 glued grains
  double channel = 0.264;  // [m] to the wall at its end: 30 glued grains
  double density = 2500;   // [kg/m3]
  double rolling = 0.1;    // [-] rolling friction of rough-spheres
  double settling = 0.4;   // [s] before the gate is taken away
  double longest = 3;      // [s] after that; most heaps are at rest in a fifth of it
  double at_rest = 1e-5;   // [-] mean kinetic energy over weight times diameter
  std::string shapes = "cubes";

  static constexpr std::size_t gate = 3;  // number of that wall

  double diameter() const { return 2 * grain; }      // [m]
  double apart() const { return 1.1 * diameter(); }  // [m] of the glued grains' middles
  double top() const {  // [m] of the loose grains at the start, and some more
    const double pitch = 3.2 * grain, layer = length * width / (pitch * pitch);
    return pitch * (4 + 1.6 * static_cast<double>(particles) / layer);
  }
  Law::Material material() const {
    return {.youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.3, .friction = 0.5};
  }
};

/// Sizes do not matter: every grain is scaled to the same volume.
inline std::vector<Grains> forms() {
  std::vector<Vec3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
  return {Sphere{}, silt::MultiSphere{{{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}}},
          silt::SuperEllipsoid{.a = 1, .b = 1, .c = 0.6, .s1 = 4, .s2 = 2},
          silt::Polyhedron::from_points(corners)};
}
inline std::vector<std::size_t> forms_of(const std::string& shapes) {
  if (shapes == "spheres" || shapes == "rough-spheres") return {0};
  if (shapes == "multi-spheres") return {1};
  if (shapes == "super-ellipsoids") return {2};
  if (shapes == "cubes") return {3};
  return {0, 1, 2, 3};
}

/// Loose grains on a lattice above the column, of all forms in turn, and spheres glued by their
/// centres to the floor, except where walls stand.
template <class Shape>
silt::Particles<Shape> fill(const Scene& s) {
  constexpr bool bodies = silt::BodyShape<Shape>;
  silt::Particles<Shape> grains;
  std::vector<double> reach{s.grain};  // [m] bounding radius of each form
  if constexpr (bodies) {
    reach.clear();
    for (const auto& form : forms()) grains.add_form(form);
    for (const auto& form : grains.forms())
      reach.push_back(form.radius * s.grain * std::cbrt(Sphere::volume(1) / form.mass.volume));
  }
  silt::Random random(1);
  const auto kinds = forms_of(s.shapes);
  double pitch = 0;
  for (const std::size_t k : kinds) pitch = std::max(pitch, 2.05 * reach[k]);
  const int nx = static_cast<int>(s.length / pitch), ny = static_cast<int>(s.width / pitch);
  for (std::size_t k = 0; k < s.particles; ++k) {
    const int n = static_cast<int>(k), layer = n / (nx * ny);
    typename silt::Particles<Shape>::Particle p{};
    p.position = {(n % nx + 0.5) * s.length / nx, (n / nx % ny + 0.5) * s.width / ny,
                  s.diameter() + (layer + 0.5) * pitch};
    p.radius = reach[kinds[k % kinds.size()]], p.density = s.density;
    p.velocity = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0};
    if constexpr (bodies)
      p.form = kinds[k % kinds.size()], p.orientation = silt::random_orientation(random);
    grains.add(p);
  }
  for (double x = s.apart() / 2; x < s.channel; x += s.apart())
    for (double y = s.apart() / 2; y < s.width; y += s.apart()) {
      typename silt::Particles<Shape>::Particle p{};
      p.position = {x, y, 0}, p.radius = s.grain, p.density = s.density, p.fixed = true;
      grains.add(p);
    }
  return grains;
}

/// The column behind its gate.
template <class Shape, class Contacts>
auto make_simulation(const Scene& s, const Contacts& contacts) {
  const silt::Box channel{{0, 0, 0}, {s.channel, s.width, s.top()}};
  silt::Simulation sim{fill<Shape>(s), contacts, silt::PeriodicBox{channel, {false, true, false}}};
  sim.gravity = {0, 0, -9.81};
  sim.guard.domain = silt::Box{{0, -s.width, 0}, {s.channel, 2 * s.width, s.top()}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.material());
  sim.add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}}, s.material());
  sim.add_wall(silt::Plane{{s.channel, 0, 0}, {-1, 0, 0}}, s.material());
  const Vec3d a{s.length, -s.width, 0}, b{s.length, 2 * s.width, 0}, up{0, 0, s.top()};
  sim.add_wall(silt::TriangleMesh({{a, b, b + up}, {a, b + up, a + up}}), s.material());
  return sim;
}

/// The contacts of rough-spheres, which resist rolling.
inline auto rough_contacts(const Scene& s) {
  return silt::Contacts<Law, silt::RollingEpsd>{s.material(), {.rolling_friction = s.rolling}};
}

}  // namespace heap
