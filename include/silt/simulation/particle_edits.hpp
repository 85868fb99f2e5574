// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/fill/particles.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What users change of single particles, between runs and in observers; a Simulation has these
/// functions as its own. None of them makes the next step search: the lists stay right.
/// InputError: there is no such particle, or a value that cannot be.
template <class Sim>
class ParticleEdits {
 public:
  /// Takes the particle with this id away, from all contacts and at once. The energy that was
  /// stored in its contacts is among the losses of the ledger, what it had itself in `openings`.
  void remove(ParticleId id) {
    const std::size_t k = place_of(id, "remove");
    sim().book_leaving(k);
    sim().engine_.remove(k, sim().domain_, sim().dt_);
  }
  /// Gives the particle with this id another velocity [m/s], that of this instant.
  void set_velocity(ParticleId id, const Vec3d& velocity) {
    const std::size_t k = place_of(id, "set_velocity");
    require(is_finite(velocity), "Simulation::set_velocity: ", velocity, " [m/s] must be finite");
    const auto before = sim().kinetic(k);
    const Vec3d change = velocity - sim().velocity(k);
    sim().engine_.change_velocity(k, change);
    if (sim().kicked_) sim().engine_.mover.synchronous[k].velocity = velocity;
    changed(k, before);
  }
  /// The same of its angular velocity [rad/s].
  void set_angular_velocity(ParticleId id, const Vec3d& velocity) {
    static_assert(Sim::rotates, "set_angular_velocity: no policy makes these particles rotate");
    const std::size_t k = place_of(id, "set_angular_velocity");
    require(is_finite(velocity), "Simulation::set_angular_velocity: ", velocity,
            " [rad/s] must be finite");
    const auto before = sim().kinetic(k);
    const Vec3d change = velocity - sim().angular_velocity(k);
    sim().engine_.change_angular_velocity(k, change);
    if (sim().kicked_) sim().engine_.set_angular_velocity_now(k, velocity);
    changed(k, before);
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }

  std::size_t place_of(ParticleId id, const char* function) {
    const std::size_t k = sim().find(id);
    require(k < sim().rows(), "Simulation::", function, ": there is no particle ", id,
            "; it has left, or never was (Simulation::find tells)");
    return k;
  }
  template <class Kinetic>
  void changed(std::size_t k, const Kinetic& before) {
    sim().engine_.follow_change(k);
    if constexpr (Sim::has_ledger)
      if (!sim().first_kick_ && std::isfinite(sim().mass(k)))
        sim().book_.bring_in(sim().kinetic(k).sum() - before.sum());
  }
};

}  // namespace silt::detail
