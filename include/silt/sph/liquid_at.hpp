// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/symmetric3.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/kernels.hpp>
#include <silt/sph/sph.hpp>

namespace silt::inline SILT_TARGET {

/// Values of an Sph at a point.
struct LiquidValues {
  Vec3d velocity;   // [m/s]
  double pressure;  // [Pa] above that of the air, with the weight of the liquid
  double density;   // [kg/m3]
  double filled;  // [-] by liquid, within a smoothing length or so: 1 inside, 1/2 at a flat wall or
                  // surface
};

namespace detail {

/// What reads an Sph from outside: places relative to a point, by the nearest periodic image.
template <class Sph>
class LiquidReader {
 public:
  explicit LiquidReader(const Sph& water) : water_(water), setup_(water.setup()) {
    const Vec3d e = setup_.region.extent();
    repeats_.low = setup_.region.min;
    repeats_.length = {setup_.periodic[0] ? e.x : 0, setup_.periodic[1] ? e.y : 0,
                       setup_.periodic[2] ? e.z : 0};
  }
  double h() const { return setup_.h(); }
  /// visit(way to the particle [m], its volume, as the share of the kernel where w(q) = 1, ...)
  template <class Visit>
  void for_each(const Vec3d& x, const Visit& visit) const {
    water_.for_each(
        [&](std::uint32_t, const Vec3d& at, const Vec3d& v, double density, double pressure) {
          Vec3d way = repeats_.shortest(at - x);
          if (setup_.dimensions == 2) way.y = 0;
          visit(way, water_.particle_mass() / density * per_volume_, v, density, pressure);
        });
  }

 private:
  const Sph& water_;
  const SphSetup& setup_;
  Repeats repeats_;
  const double per_volume_ = WendlandC2::normalisation(setup_.dimensions, setup_.h());
};

/// x of S x = b, S symmetric and positive definite.
inline Vec3d solved(const Symmetric3& S, const Vec3d& b) {
  const Vec3d x{S.xx, S.xy, S.zx}, y{S.xy, S.yy, S.yz}, z{S.zx, S.yz, S.zz};
  return (1 / dot(x, cross(y, z))) *
         Vec3d{dot(b, cross(y, z)), dot(x, cross(b, z)), dot(x, cross(y, b))};
}

}  // namespace detail

/// The liquid at a point, by a fit that is linear in space to the particles within 2 h: a linear
/// velocity or pressure is exact, also at walls. Where `filled` is below 0.01 all others are 0.
/// Each call goes over all particles. Errors: InputError if x is not finite. Tests:
/// tests/sph/liquid_at.cpp.
template <class... Policies>
LiquidValues liquid_at(const Sph<Policies...>& water, const Vec3d& x) {
  require(is_finite(x), "liquid_at: the point ", x, " [m] must be finite");
  const detail::LiquidReader reader(water);
  const double h = reader.h();
  // Around the mean place: sum (r - mean) a = sum r a - mean sum a.
  double weight = 0, density = 0, pressure = 0;
  Vec3d mean{0, 0, 0}, v{0, 0, 0}, density_way{0, 0, 0}, pressure_way{0, 0, 0};
  Vec3d v_way[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  Symmetric3 spread;
  reader.for_each(x, [&](const Vec3d& r, double volume, const Vec3d& u, double rho, double p) {
    const double w = volume * WendlandC2::weight(std::sqrt(dot(r, r)) / h);
    if (!(w > 0)) return;
    weight += w, mean += w * r, spread += w * outer(r);
    v += w * u, density += w * rho, pressure += w * p;
    density_way += w * rho * r, pressure_way += w * p * r;
    v_way[0] += w * u.x * r, v_way[1] += w * u.y * r, v_way[2] += w * u.z * r;
  });
  constexpr double least = 0.01;  // beyond, a fit would extrapolate
  if (!(weight > least)) return {{0, 0, 0}, 0, 0, weight};
  mean = (1 / weight) * mean;
  spread += -weight * outer(mean);
  // Directions in which particles do not differ, as across a film, have no slope.
  const double little = 1e-9 * weight * h * h;
  spread.xx += little, spread.yy += little, spread.zz += little;
  const Vec3d back = detail::solved(spread, mean);
  const auto fitted = [&](double sum, const Vec3d& way) {
    return sum / weight - dot(back, way - sum * mean);
  };
  return {{fitted(v.x, v_way[0]), fitted(v.y, v_way[1]), fitted(v.z, v_way[2])},
          fitted(pressure, pressure_way),
          fitted(density, density_way),
          weight};
}

/// [m] Level of the free surface on the line through x against gravity (z without gravity), as the
/// coordinate in that direction: z for gravity along -z. It is the highest place that is filled by
/// half as much as the fullest of the line, so that single drops do not count above a liquid, and
/// walls beside the line do not matter. Not a number where there is no liquid. Each call goes over
/// all particles.
/// Errors: InputError if x is not finite.
/// Tests:  tests/sph/liquid_at.cpp.
template <class... Policies>
double liquid_level(const Sph<Policies...>& water, const Vec3d& x) {
  require(is_finite(x), "liquid_level: the point ", x, " [m] must be finite");
  const detail::LiquidReader reader(water);
  const double g = norm(water.gravity), h = reader.h(), step = 0.125 * h;
  const Vec3d up = g > 0 ? (-1 / g) * water.gravity : Vec3d{0, 0, 1};
  struct Near {
    double along, aside, volume;  // [m], [m2], [-]
  };
  DynArray<Near> near;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  reader.for_each(x, [&](const Vec3d& r, double volume, const Vec3d&, double, double) {
    const double along = dot(r, up), aside = dot(r, r) - along * along;
    if (aside >= 4 * h * h) return;
    near.push_back({along, std::max(aside, 0.0), volume});
    low = std::min(low, along), high = std::max(high, along);
  });
  if (near.empty()) return std::numeric_limits<double>::quiet_NaN();
  low -= 2 * h;
  DynArray<double> filled(static_cast<std::size_t>((high + 2 * h - low) / step) + 2, 0.0);
  for (const Near& a : near) {
    const auto first = static_cast<std::size_t>(std::max(0.0, (a.along - 2 * h - low) / step));
    for (std::size_t k = first; k < filled.size(); ++k) {
      const double off = low + static_cast<double>(k) * step - a.along;
      if (off > 2 * h) break;
      filled[k] += a.volume * WendlandC2::weight(std::sqrt(a.aside + off * off) / h);
    }
  }
  const double half = 0.5 * *std::max_element(filled.begin(), filled.end());
  std::size_t k = filled.size() - 1;
  while (k > 0 && filled[k] < half) --k;
  // Between k and the next, which is less filled.
  const double more =
      k + 1 < filled.size() ? (filled[k] - half) / (filled[k] - filled[k + 1]) : 0.0;
  return dot(x, up) + low + (static_cast<double>(k) + more) * step;
}

}  // namespace silt
