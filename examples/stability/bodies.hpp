// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>
#include <silt/simulation.hpp>

/// The bodies of the stability suite: all kinds of shapes, including needles, plates and
/// sharp-edged boxes.
namespace stability {

using Grains = silt::Mix<silt::Sphere, silt::MultiSphere, silt::SuperEllipsoid, silt::Polyhedron,
                         silt::Compound<silt::Polyhedron>>;

inline silt::Polyhedron brick(double a, double b, double c, double dilation = 0) {
  std::vector<silt::Vec3d> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? a : -a, k & 2 ? b : -b, k & 4 ? c : -c});
  return silt::Polyhedron::from_points(corners, dilation);
}

struct Form {
  std::string name;
  Grains shape;
  bool slender = false;  // aspect ratio 10 or more
  bool sharp = false;    // super-ellipsoid with flat faces
};

/// `few`: one of each kind.
inline std::vector<Form> all_forms(bool few) {
  using silt::SuperEllipsoid;
  std::vector<Form> all{
      {"ellipsoid 3:2:1", SuperEllipsoid{.a = 3, .b = 2, .c = 1}},
      {"box s = 40", SuperEllipsoid{.a = 1, .b = 1, .c = 1, .s1 = 40, .s2 = 40}, false, true},
      {"needle 30:1, s = 20", SuperEllipsoid{.a = 1, .b = 1, .c = 30, .s1 = 20, .s2 = 20}, true,
       true},
      {"cube", brick(1, 1, 1)},
      {"brick 30:3:1", brick(30, 3, 1), true},
      {"angle of two bricks",
       silt::Compound<silt::Polyhedron>{
           {{brick(1, 0.3, 0.8), {0, -0.7, 0}}, {brick(0.3, 0.7, 0.8), {-0.7, 0.3, 0}}}}}};
  if (few) return all;
  all.push_back({"disc 1:30", SuperEllipsoid{.a = 30, .b = 30, .c = 1}, true});
  all.push_back({"tablet s = 6, 2", SuperEllipsoid{.a = 2, .b = 2, .c = 1, .s1 = 6, .s2 = 2}});
  all.push_back(
      {"die s = 8", SuperEllipsoid{.a = 1, .b = 1, .c = 1, .s1 = 8, .s2 = 8}, false, true});
  all.push_back({"tetrahedron", silt::Polyhedron::from_points(
                                    {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})});
  all.push_back({"plate 30:30:1", brick(30, 30, 1), true});
  all.push_back({"rounded cube", brick(1, 1, 1, 0.3)});
  all.push_back({"dumbbell of spheres", silt::MultiSphere{{{{-0.8, 0, 0}, 1}, {{0.8, 0, 0}, 1}}}});
  return all;
}

/// Bounding radius [m] at the volume of a sphere of `radius` [m].
inline double reach_of(const silt::BodyForm<Grains>& form, double radius) {
  return form.radius * radius * std::cbrt(silt::Sphere::volume(1) / form.mass.volume);
}

/// Kinetic energy [J] in a frame that moves at `frame` [m/s].
template <class Sim>
double energy_of(const Sim& sim, const silt::Vec3d& frame = {0, 0, 0}) {
  double sum = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const auto& mass = sim.forms()[sim.form(k)].mass;
    const double unit = sim.mass(k) / mass.volume * sim.scale(k) * sim.scale(k);
    const silt::Vec3d v = sim.velocity(k) - frame, I = unit * mass.inertia;
    const silt::Vec3d w =
        rotate(conjugate(sim.orientation(k) * mass.axes), sim.angular_velocity(k));
    sum += 0.5 * (sim.mass(k) * dot(v, v) + I.x * w.x * w.x + I.y * w.y * w.y + I.z * w.z * w.z);
  }
  return sum;
}

inline silt::Contacts<silt::HertzMindlin> law(double modulus, double e, double friction) {
  return silt::Contacts<silt::HertzMindlin>{
      {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = e, .friction = friction}};
}

}  // namespace stability
