// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>

#include <silt/core/lanes.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// [W] Power of the forces on an SPH liquid, kinetic and elastic; of viscosities < 0.
struct SphPowers {
  double artificial = 0, laminar = 0, turbulent = 0, diffusion = 0, restored = 0;
  double walls = 0, bodies = 0, at_walls = 0, at_bodies = 0, grains = 0;

  void add(double times, const SphPowers& p) {
    artificial += times * p.artificial, laminar += times * p.laminar;
    turbulent += times * p.turbulent, diffusion += times * p.diffusion;
    restored += times * p.restored;
    walls += times * p.walls, bodies += times * p.bodies;
    at_walls += times * p.at_walls, at_bodies += times * p.at_bodies;
    grains += times * p.grains;
  }
  double sum() const {
    return artificial + laminar + turbulent + diffusion + restored + walls + bodies + at_walls +
           at_bodies + grains;
  }
};

/// Powers of the forces of SphPairs, for a pack of particles at a time, in double precision. For
/// pairs of liquid, f the force on a:
///
///   viscosity   f.(v_a - v_b)/2          loss of both
///   pressure    none: energy is exchanged between compression and motion
///
/// For a and a particle b of a solid with the velocity u, whose velocity in the sums is v_b:
///
///   work        f.u
///   viscosity   f.(v_a - u)
///   mirrored    pressure's f.(v_a - u) + V_a P_a V_b (v_a - v_b).grad W, v_b without `sticking`,
///               and of a parting pair the share `parted` that acted, all where a solid holds
///
/// The last one is 0 if v_b - u = u - v_a across the surface and P_b = P_a.
template <class Kernel, class Viscosity, class Diffusion, class Arch = DefaultArch>
class SphPowerSums {
 public:
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t lanes = Lanes<Arch>::width;
  /// Of a row of a solid.
  struct Surface {
    Vec3d velocity{0, 0, 0};  // [m/s] u
    Vec3d sticking{0, 0, 0};  // [m/s] part of v_b that the density does not use
    double of_body = 0;       // 1: a body's, 0: a wall's
    bool holds = false;       // may pull the liquid
  };

  SphPowerSums(const SphConstants& c, const Viscosity& viscosity, const Diffusion& diffusion)
      : slope_(c.normalisation / (c.h * c.h)), over_h_(1 / c.h) {
    small_ = sph_softening<Viscosity>() * c.h * c.h;
    if constexpr (Viscosity::artificial) damping_ = 2 * viscosity.alpha * c.sound * c.h;
    if constexpr (Viscosity::laminar) drag_ = 4 * sph_kinematic(viscosity) * c.viscous;
    if constexpr (Diffusion::diffuses) delta_ = 2 * diffusion.delta * c.h * c.sound;
    still_ = (-c.density / (c.sound * c.sound)) * c.gravity;
  }

  /// Adds the powers of a pack of `width`; `mass_of(k)` [kg]; `surfaces` of the rows from `first`
  /// on. Viscosities act with the velocities in `then`, and all forces work on the mean of those
  /// and the velocities in `rows`.
  template <class MassOf>
  void add(std::size_t pack, std::size_t width, std::span<const SphRow> rows,
           std::span<const SphRow> then, std::span<const double> volume,
           std::span<const double> parted, std::span<const double> viscosity,
           std::span<const Surface> surfaces, std::size_t first, const ClusterLists& lists,
           const MassOf& mass_of, SphPowers& to) const {
    for (std::size_t l = 0; l < width; l += lanes) {
      const std::size_t row = pack * width + l, n = std::min(lanes, width - l);
      const Sums s =
          sums(row, n, rows, then, volume, parted, viscosity, surfaces, first, lists, pack);
      const Real all[count] = {s.artificial, s.laminar,  s.diffusion, s.walls,
                               s.bodies,     s.at_walls, s.at_bodies};
      alignas(64) double of[count][lanes];
      for (std::size_t c = 0; c < count; ++c) store(of[c], all[c]);
      for (std::size_t k = 0; k < n; ++k) {
        const SphRow& a = rows[row + k];
        if (!a.is_there()) continue;
        const double force = slope_ * volume[row + k];
        to.artificial += force * of[0][k], to.laminar += force * of[1][k];
        to.diffusion +=
            slope_ * delta_ * mass_of(row + k) * a.pressure / (a.density * a.density) * of[2][k];
        to.walls += force * of[3][k], to.bodies += force * of[4][k];
        to.at_walls += force * of[5][k], to.at_bodies += force * of[6][k];
      }
    }
  }

 private:
  static constexpr std::size_t count = 7;
  struct Sums {
    Real artificial = Real(0), laminar = Real(0), diffusion = Real(0), walls = Real(0),
         bodies = Real(0), at_walls = Real(0), at_bodies = Real(0);
  };
  static Vec3d mean(const SphRow& a, const SphRow& b) {
    return 0.5 * (a.velocity() + b.velocity());
  }
  Sums sums(std::size_t row, std::size_t n, std::span<const SphRow> rows,
            std::span<const SphRow> then, std::span<const double> volume,
            std::span<const double> parted, std::span<const double> viscosity,
            std::span<const Surface> surfaces, std::size_t first, const ClusterLists& lists,
            std::size_t pack) const {
    constexpr bool varies = sph_varies<Viscosity>;
    alignas(64) double of[13][lanes];
    for (std::size_t l = 0; l < lanes; ++l) {
      const SphRow &r = rows[row + std::min(l, n - 1)], &t = then[row + std::min(l, n - 1)];
      const Vec3d w = mean(r, t);
      const double values[13] = {r.x,
                                 r.y,
                                 r.z,
                                 w.x,
                                 w.y,
                                 w.z,
                                 r.density,
                                 r.pressure,
                                 t.vx,
                                 t.vy,
                                 t.vz,
                                 parted[row + std::min(l, n - 1)],
                                 varies ? viscosity[row + std::min(l, n - 1)] : 1};
      for (std::size_t c = 0; c < 13; ++c) of[c][l] = values[c];
    }
    const auto x = load3<Real>(of[0], of[1], of[2]), v = load3<Real>(of[3], of[4], of[5]),
               v_then = load3<Real>(of[8], of[9], of[10]);
    const Real rho = load<Real>(of[6]), P = load<Real>(of[7]), share = load<Real>(of[11]);
    [[maybe_unused]] const Real nu = load<Real>(of[12]);
    Sums s;
    const auto meet = [&](const ClusterLists::Entry& entry, auto solid) {
      const SphRow& b = rows[entry.row()];
      const Vec3d at = b.position() + lists.shift(entry.image());
      const Real dx = x.x - Real(at.x), dy = x.y - Real(at.y), dz = x.z - Real(at.z);
      const Real r2 = dx * dx + dy * dy + dz * dz;
      const Real Vf = Real(volume[entry.row()]) * Kernel::slope(Real(sqrt(r2) * Real(over_h_)));
      const Real mf = Real(b.density) * Vf;
      const SphRow& t = then[entry.row()];
      const Vec3d of_b_now = mean(b, t);
      const auto along_of = [&](const Vec3<Real>& a, const Vec3d& other) {
        return (a.x - Real(other.x)) * dx + (a.y - Real(other.y)) * dy + (a.z - Real(other.z)) * dz;
      };
      const Real along = along_of(v, of_b_now), acting = along_of(v_then, t.velocity());
      const Real wide = r2 + Real(small_);
      const Real over = rho * mf / (wide * (rho + Real(b.density)));
      const Real artificial = Real(damping_) * min(acting, Real(0)) * over;  // force over d
      Real laminar = Real(drag_) * acting * over * wide;
      if constexpr (varies)
        laminar *= sph_viscosity_of_pair<!decltype(solid)::value>(nu, Real(viscosity[entry.row()]));
      if constexpr (!decltype(solid)::value) {
        if constexpr (Viscosity::artificial)
          s.artificial = multiply_add(Real(0.5) * artificial, along, s.artificial);
        if constexpr (Viscosity::laminar)
          s.laminar = multiply_add(Real(0.5) * laminar, along, s.laminar);
        if constexpr (Diffusion::diffuses) {
          Real difference = rho - Real(b.density);
          if constexpr (Diffusion::hydrostatic)
            difference += dx * Real(still_.x) + dy * Real(still_.y) + dz * Real(still_.z);
          s.diffusion = multiply_add(difference * r2 / wide, Vf, s.diffusion);
        }
      } else {
        const Surface& of_b = surfaces[entry.row() - first];
        const Vec3d& u = of_b.velocity;
        const Real wx = v.x - Real(u.x), wy = v.y - Real(u.y), wz = v.z - Real(u.z);
        const Real d_w = dx * wx + dy * wy + dz * wz;
        const Real d_u = dx * Real(u.x) + dy * Real(u.y) + dz * Real(u.z);
        const Real both = P + Real(b.pressure),
                   push = -(of_b.holds ? both : max(both, Real(0))) * Vf;
        const Vec3d& stuck = of_b.sticking;
        const Real slipping = along + dx * Real(stuck.x) + dy * Real(stuck.y) + dz * Real(stuck.z);
        const Real mirrored =
            push * d_w +
            P * Vf *
                (min(slipping, Real(0)) + (of_b.holds ? Real(1) : share) * max(slipping, Real(0)));
        Real work = push * d_u;
        if constexpr (Viscosity::artificial) {
          s.artificial = multiply_add(artificial, d_w, s.artificial);
          work = multiply_add(artificial, d_u, work);
        }
        if constexpr (Viscosity::laminar) {
          s.laminar = multiply_add(laminar, d_w, s.laminar);
          work = multiply_add(laminar, d_u, work);
        }
        const Real body = Real(of_b.of_body), wall = Real(1 - of_b.of_body);
        s.walls = multiply_add(wall, work, s.walls), s.bodies = multiply_add(body, work, s.bodies);
        s.at_walls = multiply_add(wall, mirrored, s.at_walls);
        s.at_bodies = multiply_add(body, mirrored, s.at_bodies);
      }
    };
    for (const auto& entry : lists.liquid(pack)) meet(entry, std::false_type{});
    for (const auto& entry : lists.walls(pack)) meet(entry, std::true_type{});
    return s;
  }

  double slope_, over_h_, small_ = 0, damping_ = 0, drag_ = 0, delta_ = 0;
  Vec3d still_;
};

}  // namespace silt::detail
