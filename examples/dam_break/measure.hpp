// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of the liquid: its front, height and energies over time.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dam_break/measured.hpp"
#include "dam_break/scene.hpp"

namespace dam_break {

/// The liquid at present: front over a, front of the liquid 0.2 a deep, height at the wall over 2
/// a, energies over the initial potential energy, largest speed over the speed of sound, largest
/// change of density.
struct Look {
  double front = 0, deep = 0, height = 0, kinetic = 0, potential = 0, elastic = 0, speed = 0,
         density = 0;
  double behind = 0;  // [-] how deep behind a wall, over the spacing
  double energy() const { return kinetic + potential + elastic; }
};
template <class Water>
Look look_at(const Water& water, double start) {
  Look out;
  const double s = water.setup().spacing, breadth = water.setup().region.extent().y;
  std::vector<double> depth;  // [m] of the liquid, spacing by spacing along the floor
  const double half = 0.5 * water.setup().spacing, rest = water.liquid().density,
               c = water.liquid().sound_speed;
  water.for_each([&](std::uint32_t, const Vec3d& x, const Vec3d& v, double rho, double) {
    out.front = std::max(out.front, x.x + half);
    const auto column = static_cast<std::size_t>(std::max(x.x / s, 0.0));
    if (column >= depth.size()) depth.resize(column + 1, 0.0);
    depth[column] += breadth > 0 ? s * s / breadth : s;
    if (x.x < 4 * half) out.height = std::max(out.height, x.z + half);
    const double dense = rho / rest;
    out.potential += Scene::g * x.z, out.kinetic += 0.5 * dot(v, v);
    // The integral of P d rho/rho^2 from rho_0.
    out.elastic += c * c / 7 * ((std::pow(dense, 6) - 1) / 6 + 1 / dense - 1);
    out.speed = std::max(out.speed, norm(v) / c);
    out.density = std::max(out.density, std::abs(dense - 1));
    out.behind = std::max({out.behind, -x.x / (2 * half), -x.z / (2 * half)});
  });
  for (std::size_t k = 0; k < depth.size(); ++k)
    if (depth[k] > (Scene::deep - 1e-9) * Scene::a)
      out.deep = static_cast<double>(k + 1) * s / Scene::a;
  const double share = water.particle_mass() / start;
  out.kinetic *= share, out.potential *= share, out.elastic *= share;
  out.front /= Scene::a, out.height /= 2 * Scene::a;
  return out;
}

/// [Pa] of each particle, by number.
template <class Water>
std::vector<double> pressures(const Water& water) {
  std::vector<double> all(water.size(), 0.0);
  water.for_each([&](std::uint32_t number, const Vec3d&, const Vec3d&, double, double p) {
    if (number < all.size()) all[number] = p;
  });
  return all;
}
/// [-] rms change of pressures over that of the column's height.
inline double change_of(const std::vector<double>& from, const std::vector<double>& to) {
  double sum = 0;
  for (std::size_t k = 0; k < from.size(); ++k) sum += std::pow(to[k] - from[k], 2);
  return std::sqrt(sum / static_cast<double>(from.size())) / (1000 * Scene::g * 2 * Scene::a);
}

struct Record {
  std::vector<double> T;
  std::vector<Look> looks;
  double jolt = 0;  // [-] change of pressures until T = 0.1

  Curve curve(double Look::*of) const {
    Curve c{"computed", "", T, {}};
    for (const Look& l : looks) c.value.push_back(l.*of);
    return c;
  }
  double most(double Look::*of) const {
    double m = 0;
    for (const Look& l : looks) m = std::max(m, l.*of);
    return m;
  }
};

}  // namespace dam_break
