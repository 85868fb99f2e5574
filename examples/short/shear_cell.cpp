// silt - BSD-3-Clause, see LICENSE
//
// Shear at constant pressure. Spheres in a periodic box are sheared at increasing rates under
// constant normal stress: the effective friction increases with the inertial number, and the bed
// dilates.
//
// picture: draw shear_cell/particles.pvd --colour velocity.x --view top --frame 0 -1 -o shear_cell.png
// picture: curves shear_cell/friction.csv --x inertial --y friction,solid --log x -o shear_cell_friction.png

#include <cmath>
#include <cstdio>

#include <silt/silt.hpp>

int main() {
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  const double d = 1e-3, density = 2500, pressure = 1000;          // [m], [kg/m3], [Pa]
  const double inertial_time = d * std::sqrt(density / pressure);  // [s]

  const silt::Box space{{0, 0, 0}, {12 * d, 12 * d, 12 * d}};
  silt::Particles<silt::Sphere> beads;
  beads.fill(space, {.radius = silt::uniform(0.4 * d, 0.6 * d),
                     .density = density,
                     .count = 700,
                     .arrangement = silt::Arrangement::Random});
  double volume = 0;  // [m3]
  silt::Simulation sim{std::move(beads), silt::Contacts<silt::HertzMindlin>{glass},
                       silt::DeformingBox{space}};
  for (std::size_t k = 0; k < sim.rows(); ++k) volume += silt::Sphere::volume(sim.radius(k));

  const silt::BoxDrive kept{.stress = pressure, .most_rate = 0.05 / inertial_time};
  sim.deform({.x = kept, .y = kept, .z = kept});
  sim.run(60 * inertial_time);  // compressed to the pressure

  auto files = silt::vtk_series("shear_cell", silt::every(0.05));
  silt::CsvTable table("shear_cell/friction.csv",
                       {"inertial number", "friction", "solid fraction"});
  double first = 0, last = 0;
  for (const double inertial : {0.02, 0.05, 0.1, 0.3}) {
    // The velocity along x increases with y; the box can expand along y only.
    const double rate = inertial / inertial_time;  // [1/s]
    sim.deform({.y = kept, .xy = {.rate = rate}});
    sim.run(1 / rate, files);  // a strain of 1 until the flow is steady
    double across = 0, shear = 0, solid = 0, samples = 0;
    sim.run(2 / rate, files, silt::at(silt::every(0.01 / rate), [&](const auto& now) {
              across += now.domain().stress().y, shear += now.domain().stress().xy;
              solid += volume / now.domain().volume(), samples += 1;
            }));
    last = shear / across;
    if (first == 0) first = last;
    table.add_row({inertial, last, solid / samples});
    std::printf("inertial number %.2f: friction %.3f, solid fraction %.3f\n", inertial, last,
                solid / samples);
  }
  // Fails for stresses of the wrong sign and beads without friction (about 0.1).
  return first > 0.25 && first < 0.5 && last > first + 0.05 ? 0 : 1;
}
