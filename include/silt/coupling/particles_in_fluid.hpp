// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/position_row.hpp>
#include <silt/coupling/averaging/averaged_form.hpp>
#include <silt/coupling/averaging/averaged_particles.hpp>
#include <silt/coupling/drag/form_in_flow.hpp>
#include <silt/coupling/heat_exchange.hpp>
#include <silt/coupling/left_particle.hpp>

namespace silt::inline SILT_TARGET {

/// Drag coefficient of a particle, and the state of its last update.
struct HeldDrag {
  double coefficient;  // [kg/s]
  Vec3d slip;          // [m/s] NaN: not known
  double voidage;      // [-]
};

/// Particles of a coupling step, one value each, at its end; velocities are those at its start.
struct CoupledParticles {
  AveragedParticles shape;                       // positions and sizes
  std::span<const Vec3d> velocity;               // [m/s]
  std::span<const double> volume;                // [m3]
  std::span<const double> mass;                  // [kg]; infinite: fixed
  std::span<const Vec3d> acceleration = {};      // [m/s2] by all other forces; left out: none
  std::span<const Vec3d> angular_velocity = {};  // [rad/s]; if a force needs it; left out: none
  // With FollowedDrag:
  std::span<const Vec3d> owed = {};  // [N s] taken beyond what the fluid gave in its last step
  std::span<HeldDrag> drag = {};     // updated according to the tolerance
  std::span<const FormInFlow> forms = {};  // of bodies, if a force or the drag uses forms
  std::span<const ParticleId> id = {};     // permanent; if a force has a history
  double inertia_factor = 0.4;             // [-] I/(m r^2) of spheres
  // [m3] by which each has grown in the fluid since its last step: by its volume if it was not
  // there; left out: none.
  std::span<const double> put_in = {};
  std::span<const LeftParticle> taken_out = {};  // those that have left, and what others have lost
  const ParticleHeat* heat = nullptr;            // exchange with a fluid that has heat
};

namespace detail {

/// Particles of a simulation, in sequence, as input of its fluid.
struct ParticlesInFluid {
  DynArray<std::size_t> place;  // in the rows of particles
  DynArray<Vec3d> position, velocity, acceleration, spin, force, torque;
  DynArray<double> radius, volume, mass;
  DynArray<Vec3d> owed;     // with FollowedDrag
  DynArray<HeldDrag> drag;  // with FollowedDrag
  DynArray<Quaternion> orientation;
  DynArray<std::uint32_t> form;
  DynArray<AveragedForm> forms;
  DynArray<FormInFlow> forms_in_flow;  // if asked for
  DynArray<std::uint64_t> made;        // BodyForm::made of each form
  DynArray<ParticleId> id;
  DynArray<double> temperature, capacity;  // [K], [J/K] of modules with heat exchange
  double inertia_factor = 0.4;             // [-]
  DynArray<double> displaced, put_in;      // [m3] in the fluid; since its last step
  DynArray<LeftParticle> taken_out;
  bool any_put_in = false;

  void resize(std::size_t n, bool bodies, bool spins, bool turns, bool follows) {
    for (auto* v : {&position, &velocity, &acceleration, &force}) v->resize(n);
    for (auto* v : {&radius, &volume, &mass, &displaced, &put_in}) v->resize(n);
    if (follows) owed.resize(n), drag.resize(n);
    if (spins) spin.resize(n);
    if (turns) torque.resize(n);
    id.resize(n);
    if (bodies) orientation.resize(n), form.resize(n);
  }
  CoupledParticles view() {
    CoupledParticles all{{position, radius, orientation, form, forms},
                         velocity,
                         volume,
                         mass,
                         acceleration,
                         spin,
                         owed,
                         drag};
    all.forms = forms_in_flow, all.id = id, all.inertia_factor = inertia_factor;
    if (any_put_in) all.put_in = put_in;
    all.taken_out = taken_out;
    return all;
  }
  /// For form f, which exists or is the next one.
  template <class Value>
  static void put(DynArray<Value>& of_forms, std::size_t f, Value value) {
    if (f < of_forms.size())
      of_forms[f] = std::move(value);
    else
      of_forms.push_back(std::move(value));
  }
};

}  // namespace detail
}  // namespace silt
