// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>

#include <silt/core/position_row.hpp>
#include <silt/core/vec3.hpp>
#include <silt/simulation/total_readings.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Read access to particles by their place in memory; member functions of Simulation.
template <class Sim>
class ParticleReadings : public TotalReadings<Sim> {
 public:
  std::size_t size() const {
    if constexpr (Sim::has_ranks)
      return sim().engine_.ranks.present();
    else
      return sim().engine_.present();
  }
  /// Places 0 ... rows()-1 in memory; where id() is silt::no_particle the particle has left.
  std::size_t rows() const { return sim().engine_.owners(); }
  ParticleId id(std::size_t k) const { return owner(k).id(); }
  bool is_present(std::size_t k) const { return id(k) != no_particle; }
  Vec3d position(std::size_t k) const { return owner(k).centre(); }  // [m] of the centre of mass
  double radius(std::size_t k) const {
    return owner(k).radius();
  }  // [m] of bodies that of the bounding sphere
  double mass(std::size_t k) const { return owner(k).mass(); }  // [kg] infinite: fixed
  Vec3d velocity(std::size_t k) const {                         // [m/s] at time()
    const auto p = owner(k);
    return sim().kicked_ ? p.velocity_now() : p.velocity();
  }
  template <class S = Sim>
  Vec3d angular_velocity(std::size_t k) const  // [rad/s] at time()
      requires(S::rotates) {
    const auto p = owner(k);
    return sim().kicked_ ? p.angular_velocity_now() : p.angular_velocity();
  }
  std::size_t material(std::size_t k) const { return owner(k).material(); }
  /// The present place of the particle with this id; rows() if it has left or never existed.
  /// Constant time, except for the first call after a search has sorted the particles, which takes
  /// O(rows()); that call, and the first one after particles were added, must not be made by
  /// several threads at once.
  std::size_t find(ParticleId wanted) const { return sim().engine_.find(wanted); }

 private:
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  auto owner(std::size_t k) const { return sim().engine_.owner(sim().known(k)); }
};

}  // namespace silt::detail
