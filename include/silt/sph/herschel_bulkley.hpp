// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/packed_rows.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/terms.hpp>

namespace silt::inline SILT_TARGET {

/// Viscosity of mud, slurry, paste: a liquid that yields, and shears thinner or thicker:
///
///   mu = min(most_viscosity, (yield_stress + consistency g^index)/g),  g = sqrt(2 S:S),
///   S the symmetric part of grad v without its trace
///
/// Bingham's with index 1, a power law with yield_stress 0, a Newtonian liquid with both. Below the
/// yield stress it creeps at the rate stress/most_viscosity. grad v = sum V_b (v_b - v_a) grad W,
/// with the correction that makes it exact for linear fields. Pairs have the harmonic mean of both
/// viscosities, in the term of LaminarViscosity, and those with a wall or body that of the liquid.
///
/// The time step is at most rho h^2/(8 most_viscosity). It costs one more sum over all pairs.
///
/// Source: W. H. Herschel, R. Bulkley, Kolloid-Z. 39 (1926) 291; the upper bound: E. J. O'Donovan,
///         R. I. Tanner, J. Non-Newtonian Fluid Mech. 15 (1984) 75; harmonic mean: P. W. Cleary, J.
///         J. Monaghan, J. Comput. Phys. 148 (1999) 227 (all recalled).
/// Valid:  as LaminarViscosity; creep is small where most_viscosity times the rate of shear of the
///         flow is a hundred times the yield stress.
/// Tests:  tests/sph/herschel_bulkley.cpp.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
struct HerschelBulkley {
  double yield_stress = 0;    // [Pa]
  double consistency = 0;     // [Pa s^index]; with index 1 the plastic viscosity
  double index = 1;           // [-] below 1: thinner in shear, above: thicker
  double most_viscosity = 0;  // [Pa s]
  double alpha = 0.02;        // [-] of an additional ArtificialViscosity

  static constexpr SphAxis sph_axis = SphAxis::Viscosity;
  static constexpr bool artificial = true, laminar = true, varies = true;
  static constexpr const char* policy_name = "HerschelBulkley";
  void check() const {
    require_not_negative("HerschelBulkley.yield_stress", yield_stress, "Pa");
    require_not_negative("HerschelBulkley.consistency", consistency, "Pa s^index");
    require(index > 0 && index <= 3, "HerschelBulkley.index = ", index,
            " must be above 0, and at most 3; muds have 0.3 to 1");
    require(std::isfinite(most_viscosity) && most_viscosity > 0,
            "HerschelBulkley.most_viscosity = ", most_viscosity,
            " [Pa s] must be given, above 0: the mud creeps at the rate stress/most_viscosity "
            "below its yield stress, and the time step is rho h^2/(8 most_viscosity)");
    require(yield_stress > 0 || consistency > 0,
            "HerschelBulkley: yield_stress and consistency are both 0; give one of them, or take "
            "Inviscid");
    require(index != 1 || most_viscosity > consistency,
            "HerschelBulkley.most_viscosity = ", most_viscosity,
            " Pa s must be above the plastic viscosity consistency = ", consistency,
            " Pa s, or the liquid is Newtonian with that of most_viscosity; take a hundred times "
            "it, or LaminarViscosity");
    require(std::isfinite(alpha) && alpha >= 0, "HerschelBulkley.alpha = ", alpha,
            " must be at least 0; 0.01 keeps impacts calm");
  }
  /// [Pa s] at a rate of shear [1/s].
  double viscosity(double rate) const {
    rate = std::max(rate, 1e-12);  // the limit where there is one
    const double stress = yield_stress + consistency * std::pow(rate, index);
    return stress < most_viscosity * rate ? stress / rate : most_viscosity;
  }
  double longest_step(double h, double c, double density) const {
    return std::min(0.125 * h * h * density / most_viscosity, detail::artificial_step(alpha, h, c));
  }
};

namespace detail {

/// Rates of shear for a pack of particles at a time, in double precision.
template <class Kernel, class Arch = DefaultArch>
class SphShear {
 public:
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t lanes = Lanes<Arch>::width;

  SphShear(const SphConstants& c, int dimensions)
      : slope_(c.normalisation / (c.h * c.h)), over_h_(1 / c.h), flat_(dimensions == 2) {}

  /// [1/s] sqrt(2 S:S) of the particles of a pack of `width`: put(row, rate).
  template <class Put>
  void rates(std::size_t pack, std::size_t width, std::span<const SphRow> rows,
             std::span<const double> volume, const ClusterLists& lists, const Put& put) const {
    for (std::size_t l = 0; l < width; l += lanes) {
      const std::size_t first = pack * width + l, n = std::min(lanes, width - l);
      Sums s;
      for (auto& of : s.of) of = Real(0);
      const Packed a(rows.data() + first, n);
      for (const auto& entries : {lists.liquid(pack), lists.walls(pack)})
        for (const auto entry : entries) {
          const SphRow& b = rows[entry.row()];
          add(a, b, b.position() + lists.shift(entry.image()), volume[entry.row()], s);
        }
      alignas(64) double of[sums][lanes];
      for (std::size_t c = 0; c < sums; ++c) store(of[c], s.of[c]);
      for (std::size_t k = 0; k < n; ++k) {
        std::array<double, sums> own;
        for (std::size_t c = 0; c < sums; ++c) own[c] = of[c][k];
        put(first + k, rate_of(own));
      }
    }
  }

 private:
  static constexpr std::size_t sums = 15;  // grad v, row by row, and 6 of the correction
  struct Sums {
    Real of[sums];
  };
  using Packed = SphPackedRows<Real, lanes>;
  SILT_INLINE void add(const Packed& a, const SphRow& b, const Vec3d& at, double volume,
                       Sums& s) const {
    const Real d[3] = {a.x.x - Real(at.x), a.x.y - Real(at.y), a.x.z - Real(at.z)};
    const Real r = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const Real V = Real(volume * slope_) * Kernel::slope(Real(r * Real(over_h_)));
    const Real u[3] = {V * (Real(b.vx) - a.v.x), V * (Real(b.vy) - a.v.y),
                       V * (Real(b.vz) - a.v.z)};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        s.of[3 * i + j] = multiply_add(u[i], d[j], s.of[3 * i + j]);
    const Real away[3] = {V * d[0], V * d[1], V * d[2]};
    s.of[9] -= away[0] * d[0], s.of[10] -= away[1] * d[1], s.of[11] -= away[2] * d[2];
    s.of[12] -= away[1] * d[2], s.of[13] -= away[2] * d[0], s.of[14] -= away[0] * d[1];
  }
  double rate_of(const std::array<double, sums>& s) const {
    const double xx = s[9], zz = s[11], yy = flat_ ? 0.5 * (xx + zz) : s[10], yz = s[12],
                 zx = s[13], xy = s[14];
    // The inverse of the symmetric correction, over its determinant.
    const double ixx = yy * zz - yz * yz, iyy = zz * xx - zx * zx, izz = xx * yy - xy * xy,
                 iyz = zx * xy - xx * yz, izx = xy * yz - yy * zx, ixy = yz * zx - zz * xy;
    const double det = xx * ixx + xy * ixy + zx * izx;
    // Else few neighbours, or all in a plane.
    const double third = (xx + yy + zz) / 3;
    const bool corrects = det > 0.02 * third * third * third;
    const auto along = [&](std::size_t i, std::size_t j) {
      const double *const g = s.data() + 3 * i,
                          inverse[3][3] = {{ixx, ixy, izx}, {ixy, iyy, iyz}, {izx, iyz, izz}};
      if (!corrects) return g[j];
      return (g[0] * inverse[0][j] + g[1] * inverse[1][j] + g[2] * inverse[2][j]) / det;
    };
    const double Sxx = along(0, 0), Syy = along(1, 1), Szz = along(2, 2),
                 Syz = 0.5 * (along(1, 2) + along(2, 1)), Szx = 0.5 * (along(2, 0) + along(0, 2)),
                 Sxy = 0.5 * (along(0, 1) + along(1, 0));
    const double mean = (Sxx + Syy + Szz) / (flat_ ? 2 : 3);
    const double x = Sxx - mean, y = flat_ ? 0 : Syy - mean, z = Szz - mean;
    return std::sqrt(2 * (x * x + y * y + z * z) + 4 * (Syz * Syz + Szx * Szx + Sxy * Sxy));
  }
  double slope_, over_h_;
  bool flat_;
};

/// Viscosities of all particles, if they vary.
template <class Core>
void sph_find_viscosities([[maybe_unused]] Core& core, [[maybe_unused]] const Team& team) {
  if constexpr (sph_varies<typename Core::Viscosity>) {
    auto& of = core.columns;
    of.viscosity.assign(of.size(), 0.0);
    const SphShear<typename Core::Kernel> shear(core.constants(), core.setup.dimensions);
    const auto put = [&](std::size_t row, double rate) {
      of.viscosity[row] = core.viscosity.viscosity(rate) / core.liquid.density;
    };
    team.for_ranges(core.lists.first_pack(ClusterLists::Wall), ClusterLists::packs_a_range,
                    [&](std::size_t, std::size_t from, std::size_t to) {
                      for (std::size_t p = from; p < to; ++p)
                        shear.rates(p, Core::Pairs::W, of.rows, of.volume, core.lists, put);
                    });
  }
}

}  // namespace detail
}  // namespace silt
