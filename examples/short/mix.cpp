// silt - BSD-3-Clause, see LICENSE
//
// Three shapes in one box. Spheres, pills (superellipsoids) and bricks (polyhedra) of equal volume
// fall into a box together; the program prints the solid fraction and the coordination number of
// each shape.
//
// picture: draw mix/particles.pvd --colour form --names brick,pill,sphere --time 0.05 0.4 --view iso --width 1200 -o mix.png

#include <array>
#include <cstdio>

#include <silt/shape/mix.hpp>
#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material plastic{
      .youngs_modulus = 1e7,  // [Pa]
      .poisson_ratio = 0.3,
      .restitution = 0.5,
      .friction = 0.3,
  };

  // A particle type that contains three shapes; each particle has a form of one of them.
  using Grain = silt::Mix<silt::Sphere, silt::SuperEllipsoid, silt::Polyhedron>;
  silt::Particles<Grain> grains;

  const double radius = 3e-3;                          // [m] of the spheres
  const double volume = silt::Sphere::volume(radius);  // [m3] of each grain

  silt::SuperEllipsoid pill{.a = 3.5e-3, .b = 3.5e-3, .c = 2e-3, .s1 = 3, .s2 = 2};  // [m], [-]
  pill.c *= volume / pill.volume();

  const double length = 7e-3, width = 4.5e-3;  // [m]
  const silt::Vec3d corner{length / 2, width / 2, volume / (length * width) / 2};
  const auto brick =
      silt::Polyhedron::from_mesh(silt::corners_of(silt::box_mesh(-1 * corner, corner)));

  const silt::Box region{{0, 0, 0}, {0.05, 0.05, 0.15}};  // [m]
  const std::array forms{grains.add_form(brick, "brick"), grains.add_form(pill, "pill"),
                         grains.add_form(silt::Sphere{}, "sphere")};
  // Sizes are those of bounding spheres; the form of a Sphere has no size of its own.
  for (const auto form : forms)
    grains.fill(region, {.radius = form == forms[2] ? radius : grains.forms()[form].radius,
                         .density = 1200,
                         .count = 90,
                         .arrangement = silt::Arrangement::Random,
                         .form = form});

  silt::Simulation sim{std::move(grains), silt::Contacts<silt::HertzMindlin>{plastic}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.05, 0.05, 0.2}), plastic);
  sim.run(0.4, silt::vtk_series("mix", silt::every(0.05)), silt::progress());

  const auto contacts = silt::coordination(sim);  // partners of each grain, walls too
  std::array<double, 3> mean{};
  for (std::size_t k = 0; k < sim.size(); ++k)
    mean[sim.form(k)] += static_cast<double>(contacts.of[k]) / 90;
  // The bed is level, and twice as high as its centre of mass.
  const double solid =
      static_cast<double>(sim.size()) * volume / (0.05 * 0.05 * 2 * sim.centre_of_mass().z);
  std::printf("solid fraction %.2f; contacts of a sphere %.1f, a pill %.1f, a brick %.1f\n", solid,
              mean[2], mean[1], mean[0]);
  // Fails for grains that pass through each other (denser than any packing; spheres: 0.74) or
  // float, and for shapes without contact with each other.
  const bool touching = mean[0] > 3 && mean[1] > 3 && mean[2] > 3;
  return solid > 0.5 && solid < 0.72 && touching ? 0 : 1;
}
