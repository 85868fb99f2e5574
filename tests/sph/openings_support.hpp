// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/sph.hpp>

#include "near.hpp"

/// What the tests of openings share.
namespace sph_openings_test {

using namespace silt;

inline constexpr double g = 9.81;
inline const auto everywhere = [](const Vec3d&) { return true; };

/// Liquid between slip walls, 2 m long and 1 m high, that streams with 1 m/s under 1 kPa.
template <class... Policies>
auto stream(double spacing, int dimensions, const OpeningSetup& out, const Policies&... policies) {
  const double width = dimensions == 3 ? 8 * spacing : 0, L = dimensions == 3 ? 0.6 : 2;
  Sph water{Liquid{.density = 1000, .sound_speed = 20},
            {.spacing = spacing,
             .region = {{0, 0, 0}, {L, width, 1}},
             .smoothing = dimensions == 3 ? 0.8 : 1.2,
             .dimensions = dimensions,
             .periodic = {false, dimensions == 3, false}},
            policies...};
  water.add_wall(Plane{{0, 0, 0}, {0, 0, 1}});
  water.add_wall(Plane{{0, 0, 1}, {0, 0, -1}});
  Opening one{.corner = {0, 0, 0}, .edge = {0, 0, 1}, .into = {1, 0, 0}},
      other{.corner = {L, 0, 0}, .edge = {0, 0, 1}, .into = {-2, 0, 0}};
  one.second_edge = other.second_edge = {0, width, 0};
  water.add_inlet(one, {.name = "in", .velocity = {1, 0, 0}});
  water.add_outlet(other, out);
  water.fill(
      everywhere,
      [](const Vec3d&) {
        return Vec3d{1, 0, 0};
      },
      [](const Vec3d&) { return 1000.0; });
  return water;
}
/// Largest errors of velocity [m/s] and pressure [Pa].
template <class Water>
std::array<double, 2> unrest(const Water& water) {
  std::array<double, 2> off{};
  water.for_each([&](std::uint32_t, const Vec3d&, const Vec3d& v, double, double p) {
    off[0] = std::max(off[0], norm(v - Vec3d{1, 0, 0})),
    off[1] = std::max(off[1], std::abs(p - 1000));
  });
  return off;
}
template <class Water>
std::vector<double> bits(const Water& water) {
  std::vector<double> all;
  water.for_each([&](std::uint32_t n, const Vec3d& x, const Vec3d& v, double rho, double) {
    all.insert(all.end(), {static_cast<double>(n), x.x, x.y, x.z, v.x, v.y, v.z, rho});
  });
  water.for_each_buffer([&](std::size_t o, const Vec3d& x, const Vec3d& v, double rho, double) {
    all.insert(all.end(), {static_cast<double>(o), x.x, x.y, x.z, v.x, v.y, v.z, rho});
  });
  for (std::size_t o = 0; o < water.openings(); ++o)
    for (const OpeningFlow& f : {water.opening_books(o).in, water.opening_books(o).out})
      all.insert(all.end(), {static_cast<double>(f.particles), f.mass, f.momentum.x,
                             f.kinetic_energy, f.pressure_work});
  return all;
}
/// Numbers of all liquid are true: what was there, came, left.
template <class Water>
void books_close(const Water& water, std::size_t start) {
  std::size_t in = 0, out = 0, seen = 0;
  double mass =
      (static_cast<double>(start) - static_cast<double>(water.left())) * water.particle_mass();
  for (std::size_t o = 0; o < water.openings(); ++o) {
    const OpeningBooks& b = water.opening_books(o);
    in += b.in.particles, out += b.out.particles, mass += b.mass();
  }
  water.for_each([&](std::uint32_t, const Vec3d&, const Vec3d&, double, double) { ++seen; });
  CHECK(water.size() == start + in - out - water.left());
  CHECK(water.size() == seen);
  CHECK(water.mass() == near(mass).epsilon(1e-9));
}

}  // namespace sph_openings_test
