// silt - BSD-3-Clause, see LICENSE
#pragma once

// The beds of spheres in LAMMPS data files (atom style sphere): start and end states of all codes.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <silt/files/atomic_file.hpp>

#include "../bed.hpp"

namespace bench {

inline silt::Particles<silt::Sphere> read(const std::string& path) {
  std::ifstream in(path);
  silt::require(in.good(), "cannot read ", path);
  silt::Particles<silt::Sphere> spheres;
  for (std::string line; std::getline(in, line) && line != "Atoms";) {
  }
  double id, type, diameter, density, x, y, z;
  while (in >> id >> type >> diameter >> density >> x >> y >> z)
    spheres.add({.position = {x, y, z}, .radius = diameter / 2, .density = density});
  in.clear();
  for (std::string line; std::getline(in, line) && line != "Velocities";) {
  }
  silt::Vec3d v, w;
  while (in >> id >> v.x >> v.y >> v.z >> w.x >> w.y >> w.z) {
    auto& sphere = spheres[static_cast<std::size_t>(id) - 1];
    sphere.velocity = v, sphere.angular_velocity = w;
  }
  return spheres;
}

struct SphereState {
  std::uint64_t id;
  silt::Vec3d position, velocity, angular_velocity;  // [m], [m/s], [rad/s]
  double radius;                                     // [m]
};

/// Particles of this rank, if there are several.
template <class Sim>
std::vector<SphereState> states_of(const Sim& sim) {
  std::vector<SphereState> states;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    states.push_back({static_cast<std::uint64_t>(sim.id(k)), sim.position(k), sim.velocity(k),
                      sim.angular_velocity(k), sim.radius(k)});
  return states;
}

/// `room` [m]: height of the box above the highest centre; peers lose spheres that leave it.
inline void write(std::vector<SphereState> spheres, const std::string& path, double room = 0.02) {
  std::sort(spheres.begin(), spheres.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  const double width = width_for(spheres.size());
  double top = 0;
  for (const auto& s : spheres) top = std::max(top, s.position.z);
  std::string out =
      silt::text("spheres\n\n", spheres.size(), " atoms\n1 atom types\n\n0 ", width, " xlo xhi\n0 ",
                 width, " ylo yhi\n-0.01 ", top + room, " zlo zhi\n\nAtoms\n\n");
  std::size_t k = 0;
  for (const auto& s : spheres)
    out += silt::text(++k, " 1 ", 2 * s.radius, " 2500 ", s.position.x, ' ', s.position.y, ' ',
                      s.position.z, '\n');
  out += "\nVelocities\n\n";
  k = 0;
  for (const auto& s : spheres) {
    const auto &v = s.velocity, &w = s.angular_velocity;
    out += silt::text(++k, ' ', v.x, ' ', v.y, ' ', v.z, ' ', w.x, ' ', w.y, ' ', w.z, '\n');
  }
  silt::AtomicFile file(path);
  file.write(out);
  file.commit();
}

}  // namespace bench
