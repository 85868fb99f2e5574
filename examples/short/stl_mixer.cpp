// silt - BSD-3-Clause, see LICENSE
//
// Mixer with blades from an STL file. Four blades on a shaft lift grains of two colours, which lie
// side by side at the start. The program prints torque and power; both become steady within half a
// turn.
//
// picture: draw stl_mixer/particles.pvd --colour side --names left,right --time 0.3 0.7 1.8 --view top --walls-as solid -o stl_mixer.png
// picture: curves stl_mixer/torque.csv --x time --y torque -o stl_mixer_torque.png

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <silt/silt.hpp>

// Writes the STL file, in millimetres: four plates tilted back by 45 degrees, and a shaft.
void write_blades(const char* file) {
  std::vector<std::array<silt::Vec3d, 3>> triangles;
  const auto add = [&](const silt::TriangleMesh& mesh) {
    for (const auto& triangle : silt::corners_of(mesh)) triangles.push_back(triangle);
  };
  for (int k = 0; k < 4; ++k) {
    const double angle = k * std::numbers::pi / 2, c = std::cos(angle), s = std::sin(angle);
    const silt::Vec3d out{c, s, 0}, back{s, -c, 0}, up{0, 0, 1};
    add(silt::rectangle(5.0 * out + 1.0 * up, 38.0 * out, 20.0 * (back + up)));
  }
  add(silt::capped_cylinder({0, 0, 1}, {0, 0, 23}, 5, 24));
  silt::write_stl(file, triangles);
}

int main() {
  const silt::HertzMindlin::Material grain{
      .youngs_modulus = 5e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.4};
  const silt::HertzMindlin::Material steel{
      .youngs_modulus = 5e6, .poisson_ratio = 0.3, .restitution = 0.5, .friction = 0.3};
  silt::Contacts<silt::HertzMindlin> contacts{grain};
  contacts.set_pair(grain, steel, {.restitution = 0.5, .friction = 0.3});

  const double radius = 0.05, height = 0.07;  // [m] of the vessel
  silt::Particles<silt::Sphere> grains;
  grains.fill(silt::CylinderRegion{{0, 0, 0.024}, {0, 0, height}, radius},
              {.radius = silt::uniform(2.7e-3, 3.3e-3), .density = 2500, .count = 700});

  silt::Simulation sim{std::move(grains), contacts, silt::Field<"side">{}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::capped_cylinder({0, 0, 0}, {0, 0, height}, radius, 64, true), steel,
               {.name = "vessel"});  // open at its top

  silt::make_folder("stl_mixer");
  write_blades("stl_mixer/blades.stl");
  sim.add_wall(silt::mesh_wall("stl_mixer/blades.stl", 1e-3), steel, {.name = "blades"});
  sim.run(0.3);  // the grains come to rest on the blades
  for (std::size_t k = 0; k < sim.rows(); ++k) sim.field<"side">(k) = sim.position(k).x > 0;

  const double rate = 4 * std::numbers::pi / 3;  // [rad/s], 40 1/min
  sim.set_motion("blades", silt::from(sim.time(), silt::rotation({0, 0, 0}, {0, 0, 1}, rate)));
  silt::MeanLoad blades(sim, "blades"), all(sim, "blades");
  sim.run(1.5, silt::vtk_series("stl_mixer", silt::every(0.05)),
          silt::table("stl_mixer/torque.csv", {"time [s]", "torque [N m]"}, silt::every(0.02),
                      [&](const auto& s) {
                        return std::array{s.time(), -blades.read(s).torque.z};  // of the motor
                      }));
  const double torque = -all.read(sim).torque.z;
  std::printf("torque %.4f N m, power %.4f W at 40 1/min\n", torque, torque * rate);

  // Scale of the torque: the weight of the grains with a lever arm of a third of the radius. Fails
  // for blades that pass through the grains (a file in another unit), and for a wrong sign.
  const double scale = 0.4 * sim.total_mass() * 9.81 * radius / 3;
  return torque > 0.1 * scale && torque < 10 * scale ? 0 : 1;
}
