// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/packed_rows.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/terms.hpp>

namespace silt::inline SILT_TARGET {

/// Viscosity of the liquid and of eddies smaller than its particles (sub-particle scale, SPS):
///
///   tau/rho = 2 nu_t (S - tr S/3 I) - 2/3 C_I D^2 |S|^2 I,  nu_t = (C_s D)^2 |S|,
///   |S| = sqrt(2 S:S),  S from grad v = sum V_b (v_b - v_a) grad W,  D the spacing
///   d v_a/dt += sum m_b (tau_a/rho_a^2 + tau_b/rho_b^2).grad W
///
/// with tau of the liquid for solids, pair by pair (0 there, as in other codes, loses half of the
/// wall shear), in addition to the terms of LaminarViscosity. It needs two more sums over all
/// pairs.
///
/// Source: R. A. Dalrymple, B. D. Rogers, Coast. Eng. 53 (2006) 141, with their constants
///         (recalled).
/// Tests:  tests/sph/turbulence.cpp.
/// Valid:  as LaminarViscosity, for eddies larger than a spacing.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct SpsTurbulence {
  double kinematic = 0;       // [m2/s] of the liquid
  double alpha = 0.02;        // [-] of an additional ArtificialViscosity
  double smagorinsky = 0.12;  // [-] C_s
  double isotropic = 0.0066;  // [-] C_I

  static constexpr SphAxis sph_axis = SphAxis::Viscosity;
  static constexpr bool artificial = true, laminar = true, turbulent = true;
  static constexpr const char* policy_name = "SpsTurbulence";
  void check() const {
    require_positive("SpsTurbulence.kinematic", kinematic, "m2/s");
    require(std::isfinite(alpha) && alpha >= 0, "SpsTurbulence.alpha = ", alpha,
            " must be at least 0; 0.01 keeps impacts calm");
    require(smagorinsky >= 0 && smagorinsky <= 1, "SpsTurbulence.smagorinsky = ", smagorinsky,
            " must be in [0, 1]; 0.12 is usual");
    require(isotropic >= 0 && isotropic <= 1, "SpsTurbulence.isotropic = ", isotropic,
            " must be in [0, 1]; 0.0066 is usual");
  }
  double longest_step(double h, double c) const {
    return std::min(0.125 * h * h / kinematic, detail::artificial_step(alpha, h, c));
  }
};

namespace detail {

/// Sums of SpsTurbulence for a pack of particles at a time, in double precision.
template <class Kernel, class Arch = DefaultArch>
class SpsSums {
 public:
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t lanes = Lanes<Arch>::width;

  SpsSums(const SphConstants& c, double spacing, const SpsTurbulence& of)
      : slope_(c.normalisation / (c.h * c.h)), over_h_(1 / c.h) {
    mixing2_ = of.smagorinsky * of.smagorinsky * spacing * spacing;
    isotropic_ = 2.0 / 3 * of.isotropic * spacing * spacing;
  }

  /// tau/rho of the particles of a pack of `width`.
  void stresses(std::size_t pack, std::size_t width, std::span<const SphRow> rows,
                std::span<const double> volume, const ClusterLists& lists,
                std::span<SphStress> out) const {
    for (std::size_t l = 0; l < width; l += lanes) {
      const SphRow* const own = rows.data() + pack * width + l;
      Real grad[3][3];
      for (auto& row : grad)
        for (Real& g : row) g = Real(0);
      const Packed a(own, std::min(lanes, width - l));
      for (const auto& entries : {lists.liquid(pack), lists.walls(pack)})
        for (const auto entry : entries) {
          const SphRow& b = rows[entry.row()];
          const Vec3d at = b.position() + lists.shift(entry.image());
          const Real d[3] = {a.x.x - Real(at.x), a.x.y - Real(at.y), a.x.z - Real(at.z)};
          const Real V = Real(volume[entry.row()] * slope_) * slope_at(d);
          const Real u[3] = {V * (Real(b.vx) - a.v.x), V * (Real(b.vy) - a.v.y),
                             V * (Real(b.vz) - a.v.z)};
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) grad[i][j] = multiply_add(u[i], d[j], grad[i][j]);
        }
      alignas(64) double G[3][3][lanes];
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) store(G[i][j], grad[i][j]);
      for (std::size_t k = 0; k < std::min(lanes, width - l); ++k) {
        const auto S = [&](std::size_t i, std::size_t j) {
          return 0.5 * (G[i][j][k] + G[j][i][k]);
        };
        out[pack * width + l + k] = stress({S(0, 0), S(1, 1), S(2, 2), S(1, 2), S(2, 0), S(0, 1)});
      }
    }
  }
  /// Adds the accelerations of a pack, liquid or not, from the stresses of all.
  void accelerate(std::size_t pack, std::size_t width, std::span<const SphRow> rows,
                  std::span<const double> volume, std::span<const SphStress> stress,
                  const ClusterLists& lists, std::span<SphRates> out, bool liquid) const {
    for (std::size_t l = 0; l < width; l += lanes) {
      const std::size_t first = pack * width + l, n = std::min(lanes, width - l);
      const Packed a(rows.data() + first, n);
      alignas(64) double own[7][lanes] = {};
      std::fill_n(own[6], lanes, 1.0);
      for (std::size_t k = 0; k < n; ++k) {
        const SphStress& t = stress[first + k];
        const double values[7] = {t.xx, t.yy, t.zz, t.yz, t.zx, t.xy, rows[first + k].density};
        for (std::size_t c = 0; c < 7; ++c) own[c][k] = values[c];
      }
      Real t[6];
      for (std::size_t c = 0; c < 6; ++c) t[c] = load<Real>(own[c]);
      const Real rho = load<Real>(own[6]);
      Real push[3] = {Real(0), Real(0), Real(0)};
      const auto add = [&](std::span<const ClusterLists::Entry> entries, bool own_too,
                           bool others_too) {
        for (const auto entry : entries) {
          const SphRow& b = rows[entry.row()];
          const SphStress& s = stress[entry.row()];
          const Vec3d at = b.position() + lists.shift(entry.image());
          const Real d[3] = {a.x.x - Real(at.x), a.x.y - Real(at.y), a.x.z - Real(at.z)};
          const Real V = Real(volume[entry.row()] * slope_) * slope_at(d);
          const Real of_a = V * Real(b.density) / rho, all = of_a + V;
          const auto both = [&](std::size_t c, double of_b) {
            if (!own_too) return all * Real(of_b);
            return others_too ? multiply_add(V, Real(of_b), of_a * t[c]) : all * t[c];
          };
          const Real xx = both(0, s.xx), yy = both(1, s.yy), zz = both(2, s.zz), yz = both(3, s.yz),
                     zx = both(4, s.zx), xy = both(5, s.xy);
          push[0] += xx * d[0] + xy * d[1] + zx * d[2];
          push[1] += xy * d[0] + yy * d[1] + yz * d[2];
          push[2] += zx * d[0] + yz * d[1] + zz * d[2];
        }
      };
      add(lists.liquid(pack), liquid, true), add(lists.walls(pack), true, false);
      alignas(64) double of[3][lanes];
      for (std::size_t c = 0; c < 3; ++c) store(of[c], push[c]);
      for (std::size_t k = 0; k < n; ++k)
        out[first + k].acceleration += Vec3d{of[0][k], of[1][k], of[2][k]};
    }
  }
  /// From a rate of strain [1/s].
  SphStress stress(const SphStress& S) const {
    const double trace = (S.xx + S.yy + S.zz) / 3;
    const double square = 2 * (S.xx * S.xx + S.yy * S.yy + S.zz * S.zz) +
                          4 * (S.yz * S.yz + S.zx * S.zx + S.xy * S.xy);
    const double twice = 2 * mixing2_ * std::sqrt(square), more = isotropic_ * square;
    return {twice * (S.xx - trace) - more,
            twice * (S.yy - trace) - more,
            twice * (S.zz - trace) - more,
            twice * S.yz,
            twice * S.zx,
            twice * S.xy};
  }

 private:
  using Packed = SphPackedRows<Real, lanes>;
  SILT_INLINE Real slope_at(const Real (&d)[3]) const {
    return Kernel::slope(Real(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * Real(over_h_)));
  }
  double slope_, over_h_, mixing2_ = 0, isotropic_ = 0;
};

}  // namespace detail
}  // namespace silt
