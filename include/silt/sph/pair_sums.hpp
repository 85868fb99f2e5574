// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <silt/core/lanes.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/seen.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What the neighbours of a particle do to it.
struct alignas(64) SphRates {
  Vec3d acceleration;  // [m/s2]
  double density;      // [kg/(m3 s)]
  Vec3d slope;         // [1/m] grad C, of shifting
  double divergence;   // [-] div r
};
static_assert(sizeof(SphRates) == 64);

struct SphConstants {
  double mass, h, normalisation;  // [kg], [m], a of the kernel
  double sound, density;          // [m/s], [kg/m3]
  Vec3d gravity;                  // [m/s2]
};

/// The sums over pairs of an SPH liquid (Sph says which), of a pack of particles at a time:
///
///   d rho_a/dt = rho_a sum V_b v_ab.grad W + D_a
///   d v_a/dt   = -sum m_b (P_a + P_b)/(rho_a rho_b) grad W + viscosity
///
/// Walls and bodies push and never pull: beside them P_a + P_b is at least 0. A thin film would be
/// drawn into a wall otherwise, as its density is known badly.
/// Each pair is computed from both of its ends, by terms that are odd in them: momentum is kept to
/// rounding, and threads share nothing.
template <class Kernel, class Viscosity, class Diffusion, class Shifting, class Arch = DefaultArch>
class SphPairs {
 public:
  using Real = typename Lanes<Arch, double>::Real;
  static constexpr std::size_t W = Lanes<Arch, double>::width;

  SphPairs(const SphConstants& c, const Viscosity& viscosity, const Diffusion& diffusion)
      : constants_(c) {
    slope_ = c.normalisation / (c.h * c.h), over_h_ = 1 / c.h, small_ = 0.01 * c.h * c.h;
    if constexpr (Viscosity::artificial) alpha_ = viscosity.alpha * c.sound * c.h;
    if constexpr (Viscosity::laminar) twice_nu_ = 2 * viscosity.kinematic;
    if constexpr (Diffusion::diffuses) delta_ = 2 * diffusion.delta * c.h * c.sound;
    hydrostatic_ = (-c.density / (c.sound * c.sound)) * c.gravity;
  }

  /// Sets the rates of a pack; returns the largest |h v.r/(r^2 + (0.1 h)^2)| [m/s].
  double of_liquid(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
                   const ClusterLists& lists, std::span<SphRates> out) const {
    const Own own(rows.data() + pack * W);
    Sums sums;
    add<true>(own, rows, volume, lists, lists.liquid(pack), sums);
    add<false>(own, rows, volume, lists, lists.walls(pack), sums);
    return put(own, sums, out.data() + pack * W);
  }
  /// The same of particles of walls, which feel the liquid alone.
  double of_wall(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
                 const ClusterLists& lists, std::span<SphRates> out) const {
    const Own own(rows.data() + pack * W);
    Sums sums;
    add<false>(own, rows, volume, lists, lists.liquid(pack), sums);
    return put(own, sums, out.data() + pack * W);
  }

  /// What each probe of a pack sees.
  void look(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
            const ClusterLists& lists, std::span<SphSeen> out) const {
    const Own own(rows.data() + pack * W);
    const Real zero(0);
    Real n = zero, rho = zero, xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
    Vec3<Real> way{zero, zero, zero}, rho_way = way, flow = way;
    for (const auto entry : lists.liquid(pack)) {
      const SphRow& b = rows[entry.row()];
      Vec3d at{b.x, b.y, b.z};
      if (entry.image() != ClusterLists::here) at += lists.shift(entry.image());
      const Real dx = Real(at.x) - own.x.x, dy = Real(at.y) - own.x.y, dz = Real(at.z) - own.x.z;
      const Real r2 = dx * dx + dy * dy + dz * dz;
      const Real w = Real(volume[entry.row()] * constants_.normalisation) *
                     Kernel::weight(sqrt(r2) * Real(over_h_));
      const Real wx = w * dx, wy = w * dy, wz = w * dz, d(b.density);
      n += w, way.x += wx, way.y += wy, way.z += wz;
      rho = multiply_add(w, d, rho), rho_way.x = multiply_add(wx, d, rho_way.x);
      rho_way.y = multiply_add(wy, d, rho_way.y), rho_way.z = multiply_add(wz, d, rho_way.z);
      xx = multiply_add(wx, dx, xx), xy = multiply_add(wx, dy, xy), xz = multiply_add(wx, dz, xz);
      yy = multiply_add(wy, dy, yy), yz = multiply_add(wy, dz, yz), zz = multiply_add(wz, dz, zz);
      flow.x = multiply_add(w, Real(b.vx), flow.x), flow.y = multiply_add(w, Real(b.vy), flow.y);
      flow.z = multiply_add(w, Real(b.vz), flow.z);
    }
    alignas(64) double of[17][W];
    const Real all[17] = {n,  rho, way.x, way.y, way.z, rho_way.x, rho_way.y, rho_way.z, xx,
                          xy, xz,  yy,    yz,    zz,    flow.x,    flow.y,    flow.z};
    for (int c = 0; c < 17; ++c) store(of[c], all[c]);
    for (std::size_t l = 0; l < W; ++l)
      out[l] = {of[0][l],
                of[1][l],
                {of[2][l], of[3][l], of[4][l]},
                {of[5][l], of[6][l], of[7][l]},
                {of[14][l], of[15][l], of[16][l]},
                of[8][l],
                of[9][l],
                of[10][l],
                of[11][l],
                of[12][l],
                of[13][l]};
  }

 private:
  struct Own {
    Vec3<Real> x, v;
    Real density, pressure, over_density;
    explicit Own(const SphRow* rows) {
      alignas(64) double of[8][W];
      for (std::size_t l = 0; l < W; ++l) {
        const SphRow& r = rows[l];
        const double values[8] = {r.x, r.y, r.z, r.vx, r.vy, r.vz, r.density, r.pressure};
        for (int c = 0; c < 8; ++c) of[c][l] = values[c];
      }
      x = load3<Real>(of[0], of[1], of[2]), v = load3<Real>(of[3], of[4], of[5]);
      density = load<Real>(of[6]), pressure = load<Real>(of[7]);
      over_density = Real(1) / density;
    }
  };
  struct Sums {
    Vec3<Real> push{Real(0), Real(0), Real(0)}, slope{Real(0), Real(0), Real(0)};
    Real spread = Real(0), diffusion = Real(0), divergence = Real(0), fastest = Real(0);
  };

  template <bool liquid>
  SILT_INLINE void add(const Own& a, std::span<const SphRow> rows, std::span<const double> volume,
                       const ClusterLists& lists, std::span<const ClusterLists::Entry> entries,
                       Sums& sums) const {
    for (const auto entry : entries) {
      const SphRow& b = rows[entry.row()];
      Vec3d at{b.x, b.y, b.z};
      if (entry.image() != ClusterLists::here) at += lists.shift(entry.image());
      pair<liquid>(a, b, at, volume[entry.row()], sums);
    }
  }
  template <bool liquid>
  SILT_INLINE void pair(const Own& a, const SphRow& b, const Vec3d& at, double volume,
                        Sums& sums) const {
    const Real dx = a.x.x - Real(at.x), dy = a.x.y - Real(at.y), dz = a.x.z - Real(at.z);
    const Real r2 = dx * dx + dy * dy + dz * dz;
    // grad W = f r, V f
    const Real Vf = Real(volume * slope_) * Kernel::slope(sqrt(r2) * Real(over_h_));
    const Real ux = a.v.x - Real(b.vx), uy = a.v.y - Real(b.vy), uz = a.v.z - Real(b.vz);
    const Real along = ux * dx + uy * dy + uz * dz;
    sums.spread = multiply_add(Vf, along, sums.spread);
    const Real mean = Real(0.5) * (a.density + Real(b.density)), wide = r2 + Real(small_);
    const Real over = Real(1) / (wide * mean);
    Real both = a.pressure + Real(b.pressure);
    if constexpr (!liquid) both = max(both, Real(0));
    Real k = -both * a.over_density;
    const Real approach = along * over;  // [m4/(kg s)]
    if constexpr (Viscosity::artificial)
      k = multiply_add(Real(alpha_ * b.density), min(approach, Real(0)), k);
    k = k * Vf;
    sums.push.x = multiply_add(k, dx, sums.push.x);
    sums.push.y = multiply_add(k, dy, sums.push.y);
    sums.push.z = multiply_add(k, dz, sums.push.z);
    sums.fastest = max(sums.fastest, abs(approach * mean));
    if constexpr (Viscosity::laminar) {
      const Real drag = Real(twice_nu_ * b.density) * r2 * over * Vf;
      sums.push.x = multiply_add(drag, ux, sums.push.x);
      sums.push.y = multiply_add(drag, uy, sums.push.y);
      sums.push.z = multiply_add(drag, uz, sums.push.z);
    }
    if constexpr (Diffusion::diffuses && liquid) {
      Real difference = a.density - Real(b.density);
      if constexpr (Diffusion::hydrostatic)
        difference +=
            dx * Real(hydrostatic_.x) + dy * Real(hydrostatic_.y) + dz * Real(hydrostatic_.z);
      sums.diffusion = multiply_add(difference * r2 * mean, over * Vf, sums.diffusion);
    }
    if constexpr (Shifting::shifts) {
      sums.slope.x = multiply_add(Vf, dx, sums.slope.x);
      sums.slope.y = multiply_add(Vf, dy, sums.slope.y);
      sums.slope.z = multiply_add(Vf, dz, sums.slope.z);
      sums.divergence -= Vf * r2;
    }
  }

  double put(const Own& own, const Sums& s, SphRates* out) const {
    alignas(64) double of[8][W];
    Real rate = own.density * s.spread;
    if constexpr (Diffusion::diffuses) rate += Real(delta_) * s.diffusion;
    store(of[0], s.push.x), store(of[1], s.push.y), store(of[2], s.push.z), store(of[3], rate);
    store(of[4], s.slope.x), store(of[5], s.slope.y), store(of[6], s.slope.z);
    store(of[7], s.divergence);
    for (std::size_t l = 0; l < W; ++l)
      out[l] = {{of[0][l], of[1][l], of[2][l]}, of[3][l], {of[4][l], of[5][l], of[6][l]}, of[7][l]};
    store(of[0], s.fastest);
    double most = 0;
    for (std::size_t l = 0; l < W; ++l) most = std::max(most, of[0][l]);
    return most * constants_.h;
  }

  SphConstants constants_;
  double slope_ = 0, over_h_ = 0, small_ = 0;
  double alpha_ = 0, twice_nu_ = 0, delta_ = 0;
  Vec3d hydrostatic_{0, 0, 0};
};

}  // namespace silt::detail
