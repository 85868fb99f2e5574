// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include <silt/core/quaternion.hpp>
#include <silt/coupling/lift/magnus.hpp>
#include <silt/coupling/lift/saffman_mei.hpp>
#include <silt/coupling/unsteady/forces.hpp>

namespace silt::inline SILT_TARGET {

struct FormInFlow;  // coupling/drag/form_in_flow.hpp

/// A particle in the fluid as input of the forces of a CoupledFlow, at the start of a fluid step.
struct InFluid {
  double density, viscosity;  // [kg/m3], [Pa s] of the fluid
  double voidage;             // [-] at the particle
  double diameter;            // [m] of the sphere of equal volume
  double volume, mass;        // [m3], [kg]; infinite: fixed
  double mean_diameter;    // [m] Sauter mean around the particle; if the drag or a force needs it
  double dt;               // [s] the fluid step
  Vec3d slip;              // [m/s] fluid's velocity minus the particle's
  Vec3d curl;              // [1/s] of the fluid's velocity; if a force needs it
  Vec3d angular_velocity;  // [rad/s] of the particle, unless needs_spin = false in all forces
  Quaternion orientation;  // principal axes to space, and
  std::uint32_t form;      // number of the form: for bodies
  const FormInFlow* body;  // shape of that form; null for spheres
  /// [1/s] rates of strain xx, yy, zz and yz, zx, xy (half of the sums) if a force needs them
  Vec3d stretch, strain;
  std::size_t place;            // index among the particles of this step
  double inertia_factor = 0.4;  // [-] I/(m r^2), of spheres
};

/// Fluid force on a particle in addition to drag, pressure and viscous stress: a struct with one of
///   Vec3d force_on(const InFluid&) const        [N]
///   Vec3d torque_on(const InFluid&) const       [N m]
///   double added_mass(const InFluid&) const     [kg] accelerated with the particle
/// and optionally `static constexpr bool needs_curl = true`, needs_strain (which includes the
/// curl), needs_mean_diameter, or sees_forms. needs_spin = true refuses spheres that do not rotate,
/// whose angular velocity is 0; needs_spin = false, in all forces, saves reading the angular
/// velocities. The reaction acts on the fluid in the same step. FollowedDrag, which changes the
/// integration of drag, is given in the same place (followed_drag.hpp).
template <class F>
concept FluidForce = requires(const F& f, const InFluid& at) {
  { f.force_on(at) } -> std::same_as<Vec3d>;
}
|| requires(const F& f, const InFluid& at) {
  { f.torque_on(at) } -> std::same_as<Vec3d>;
}
|| requires(const F& f, const InFluid& at) {
  { f.added_mass(at) } -> std::same_as<double>;
}
|| F::follows_velocity;

/// Lift in a shear flow (SaffmanMei).
/// Source: as SaffmanMei (coupling/lift/saffman_mei.hpp).
/// Valid:  as SaffmanMei.
/// Units:  SI.
/// Errors: none.
/// Tests:  tests/coupling/lift.cpp, tests/coupling/simulation.cpp.
struct ShearLift {
  static constexpr bool needs_curl = true, needs_spin = false;
  Vec3d force_on(const InFluid& p) const {
    return SaffmanMei::force(p.diameter, p.density, p.viscosity, p.slip, p.curl);
  }
};

/// Lift by rotation, Magnus (OesterleBuiDinh).
/// Source: as OesterleBuiDinh (coupling/lift/magnus.hpp).
/// Valid:  as OesterleBuiDinh.
/// Units:  SI.
/// Errors: does not compile with spheres that do not rotate (a contact law without friction).
/// Tests:  tests/coupling/lift.cpp, prescribed_flow.cpp, simulation.cpp.
struct SpinLift {
  static constexpr bool needs_curl = true, needs_spin = true;
  Vec3d force_on(const InFluid& p) const {
    return OesterleBuiDinh::force(p.diameter, p.density, p.viscosity, p.slip,
                                  0.5 * p.curl - p.angular_velocity);
  }
};

/// Torque of the fluid against relative rotation (rotational_torque), integrated exactly over the
/// step with a constant coefficient: T = (I/dt)(1 - exp(-C dt/I)) Omega, with C Omega the present
/// torque. It does not limit the step.
/// Source: as rotational_torque() (coupling/lift/magnus.hpp).
/// Valid:  as OesterleBuiDinh.
/// Units:  SI.
/// Errors: none.
/// Tests:  tests/coupling/lift.cpp, tests/coupling/simulation.cpp.
struct SpinTorque {
  static constexpr bool needs_curl = true, needs_spin = true;
  Vec3d torque_on(const InFluid& p) const {
    const Vec3d Omega = 0.5 * p.curl - p.angular_velocity;
    const double spin = norm(Omega);
    if (spin == 0 || !std::isfinite(p.mass)) return {0, 0, 0};
    const Vec3d now = rotational_torque(p.diameter, p.density, p.viscosity, Omega);
    const double inertia = 0.25 * p.inertia_factor * p.mass * p.diameter * p.diameter;
    const double X = norm(now) / spin * p.dt / inertia;
    return (-std::expm1(-X) / X) * now;
  }
};

/// Virtual mass, F = C rho V (Du/Dt - dv/dt), with dv/dt from all forces including this one, and
/// Du/Dt of the same step: stable for light particles, and exact where a flow starts suddenly. It
/// cannot be combined with FollowedDrag, which integrates with the mass of the particle only; this
/// does not compile.
/// Source: unsteady/forces.hpp.
/// Valid:  spheres, `coefficient` 0.5; other bodies with their own value.
/// Units:  SI.
/// Errors: does not compile with FollowedDrag.
/// Tests:  tests/coupling/simulation.cpp, tests/coupling/impulsive_start.cpp.
struct VirtualMass {
  static constexpr bool needs_spin = false;
  double coefficient = 0.5;  // [-] of a sphere
  double added_mass(const InFluid& p) const { return coefficient * p.density * p.volume; }
};

}  // namespace silt
