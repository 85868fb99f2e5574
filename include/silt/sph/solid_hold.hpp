// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// [s] Time after which walls and bodies have forgotten a push: in which sound goes to and fro
/// through a cube, or in 2D a square, of all `particles` of the liquid.
inline double sph_memory(std::size_t particles, const SphSetup& setup, const Liquid& liquid) {
  const double across = std::pow(static_cast<double>(particles), 1.0 / setup.dimensions);
  return 2 * std::max(across, 1.0) * setup.spacing / liquid.sound_speed;
}

/// Which particles of mirrored walls and bodies hold the liquid, that is, may pull it.
///
/// A liquid that is struck answers with sound: pressure, and after its return from a free surface
/// tension of the same size. A wall that only pushes gives the first and not the second, so that
/// the impulse of a blow was twice what it is in a liquid that cannot be compressed. Here a
/// particle may return as much impulse as it has received, and forgets it like a sound that leaves:
///
///   dJ/dt = p - J/T >= 0,   it pulls while J > 0                                          (1)
///
/// p [Pa] is the pressure of the liquid behind the surface, T the time in which sound goes to and
/// fro through the liquid. Liquid under a lid is let go after about T. For a speed of sound that
/// tends to infinity T tends to 0, and walls only push. Drops and films, by the neighbourhood of
/// the mirror image, are not held: their tension is inaccurate and draws them into walls.
///
/// Source: ours.
/// Valid:  any; DynamicWalls do without it.
/// Tests:  tests/sph/collision.cpp.
class SolidHold {
 public:
  /// Whether a mirror image that sees 1/`over` of a full neighbourhood is in no drop or film.
  static bool sees_bulk(double over) { return over > 0 && over < 1 / 0.6; }
  bool holds(std::size_t k) const { return k < pushed_.size() && pushed_[k] > 0; }
  /// After a step of dt [s]: (1) for each particle of the `solids`.
  template <class Solids>
  void keep(const Solids& solids, const SphColumns& columns, const ClusterLists& lists, double dt,
            double T, const Team& team) {
    pushed_.resize(solids.size());
    const double left = std::exp(-dt / T);
    team.for_ranges(pushed_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        const std::uint32_t row = solids.wall_row[k];
        const bool is_near = row != ClusterLists::none && lists.sees_liquid(row / lists.width);
        const double p = is_near ? columns.rows[row].pressure : 0;
        pushed_[k] = std::max(0.0, left * pushed_[k] + dt * p);
      }
    });
  }
  /// Of particle `first` and those after it.
  void forget_from(std::size_t first) {
    if (first < pushed_.size()) pushed_.resize(first);
  }
  const DynArray<double>& state() const { return pushed_; }
  void restore(const DynArray<double>& state) { pushed_ = state; }

 private:
  DynArray<double> pushed_;  // [Pa s] J
};

}  // namespace silt::detail
