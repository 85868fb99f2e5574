// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>

#include <silt/core/error.hpp>
#include <silt/coupling/averaging/concept.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/particle_exchange.hpp>

namespace silt::inline SILT_TARGET {

/// Velocity [m/s] of a fluid at position x [m] and time t [s]; called by several threads at once.
template <class V>
concept VelocityField = requires(const V& velocity, const Vec3d& x, double t) {
  { velocity(x, t) } -> std::convertible_to<Vec3d>;
};

/// One-way coupling: particles in a given flow, which they do not change: wind, a vortex, a shear.
/// The fluid of a Simulation, without a grid.
///
///   silt::PrescribedFlow wind{silt::SchillerNaumann{}, {.density = 1.2, .viscosity = 1.8e-5},
///                             [](const silt::Vec3d& x, double) { return silt::Vec3d{x.z, 0, 0};
///                             }};
///
///   m dv/dt = K (u - v) + rho V (Du/Dt - g) + further forces + all else,  u = u(x, t)          (1)
///
/// K from the drag law at a void fraction of 1; rho V Du/Dt is the force of pressure and viscous
/// stress of the undisturbed flow. Each particle step is a fluid step, integrated exactly for
/// constant K and u (StepResponse). Du/Dt is a central difference over the step along the fluid's
/// path; curl and strain, if a force needs them, are central differences over the particle's
/// diameter: all exact for a steady u that is linear in x.
///
/// Valid:  dilute suspensions, whose drag does not change the flow.
/// Errors: InputError for an invalid density or viscosity, and if u is not finite.
/// Tests:  tests/coupling/prescribed_flow.cpp.
/// Source: M. R. Maxey, J. J. Riley, Phys. Fluids 26 (1983) 883 (force of the undisturbed flow).
/// Units:  SI.
template <VelocityField Velocity, class Drag, class... Forces>
class PrescribedFlow {
  using Exchange = ParticleExchange<Drag, Forces...>;
  static_assert(!(AveragingMode<Forces> || ...),
                "PrescribedFlow has no cells and takes no averaging mode: leave it out "
                "(silt/coupling/prescribed_flow.hpp)");
  static_assert(!Exchange::needs_mean_diameter,
                "PrescribedFlow has no cells, and no mean diameter of the particles around: use a "
                "drag law without Polydisperse, or a CoupledFlow");
  static_assert(!Exchange::follows,
                "PrescribedFlow computes drag in each particle step: leave out FollowedDrag");

 public:
  static constexpr bool active = true, turns = Exchange::turns, needs_spin = Exchange::needs_spin,
                        needs_rotation = Exchange::needs_rotation,
                        sees_forms = Exchange::sees_forms;

  PrescribedFlow(const Drag& drag, const FluidProperties& fluid, Velocity velocity,
                 const Forces&... forces)
      : velocity_(std::move(velocity)), exchange_(drag, forces...), fluid_(fluid) {
    require(std::isfinite(fluid.density) && fluid.density > 0,
            "FluidProperties.density = ", fluid.density, " kg/m3 must be given and positive");
    require(std::isfinite(fluid.viscosity) && fluid.viscosity > 0,
            "FluidProperties.viscosity = ", fluid.viscosity, " Pa s must be given and positive");
  }
  const FluidProperties& fluid() const { return fluid_; }
  const Velocity& velocity() const { return velocity_; }
  Vec3d gravity{0, 0, 0};  // [m/s2]; a Simulation sets its own
  FluidClock clock;

  /// The largest velocity at 5^3 points of a box.
  FastestFluid fastest(const Box& scene) const {
    double most = 0;
    const Vec3d e = scene.extent();
    for (int k = 0; k < 125; ++k) {
      const Vec3d at{0.25 * (k % 5) * e.x, 0.25 * (k / 5 % 5) * e.y, 0.25 * (k / 25) * e.z};
      const double speed = norm(Vec3d(velocity_(scene.min + at, clock.time)));
      if (std::isfinite(speed)) most = std::max(most, speed);
    }
    return {.velocity = most, .density = fluid_.density, .viscosity = fluid_.viscosity};
  }
  void prepare(const FluidScene&) const {}
  int steps_wanted(const FluidPace&, const Team&) const { return 1; }
  void advance(const CoupledParticles& of, double dt, std::span<Vec3d> force, const Team& team = {},
               std::span<Vec3d> torque = {}) {
    exchange_.settings = {fluid_, MomentumModel::A, gravity};
    exchange_.check(of, force.size(), torque.size());
    make_room(of.velocity.size());
    const double now = clock.time + 0.5 * dt;
    team.for_ranges(of.velocity.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p)
        look(p, of.shape.position[p], of.shape.radius[p], now, dt);
    });
    for (std::size_t p = 0; p < of.velocity.size(); ++p)
      require(is_finite(vector_of(exchange_.at.velocity, p)), "PrescribedFlow: its velocity at ",
              of.shape.position[p], " m, t = ", now, " s is ", vector_of(exchange_.at.velocity, p),
              " m/s, which must be finite");
    exchange_.find(of, dt, torque, team);
    exchange_.take(of, dt, force);
    clock.count(dt);
  }
  template <class Visit>
  void for_each_state(const Visit& visit) {
    clock.for_each_state(visit);
    exchange_.for_each_state(visit);
  }
  template <class Describer>
  void describe(const Describer& is) const {
    is("density [kg/m3]", fluid_.density), is("viscosity [Pa s]", fluid_.viscosity);
  }

 private:
  void make_room(std::size_t n) {
    FluidAtParticles& at = exchange_.at;
    at.voidage.assign(n, 1), resize(at.velocity, n), resize(at.slope, n), resize(at.stress, n);
    if constexpr (Exchange::needs_curl) resize(at.curl, n);
    if constexpr (Exchange::needs_strain) resize(at.stretch, n), resize(at.strain, n);
    if constexpr (Exchange::has_added_mass) resize(at.convection, n);
  }
  static void put(ParticleColumns& to, std::size_t p, const Vec3d& v) {
    to[0][p] = v.x, to[1][p] = v.y, to[2][p] = v.z;
  }
  /// Fluid at particle p, at x, in the middle of a step of dt.
  void look(std::size_t p, const Vec3d& x, double radius, double now, double dt) {
    FluidAtParticles& at = exchange_.at;
    const Vec3d u = velocity_(x, now);
    const Vec3d way = 0.5 * dt * u;
    const Vec3d ahead = velocity_(x + way, now + 0.5 * dt),
                behind = velocity_(x - way, now - 0.5 * dt);
    const Vec3d acceleration = (1 / dt) * (ahead - behind);  // Du/Dt
    put(at.velocity, p, u);
    put(at.slope, p, -fluid_.density * acceleration), put(at.stress, p, {0, 0, 0});
    // The velocity does not change between find() and take(): this is all of Du/Dt.
    if constexpr (Exchange::has_added_mass) put(at.convection, p, acceleration);
    if constexpr (Exchange::needs_curl) {
      const double over = 0.5 / radius;
      const auto slope = [&](const Vec3d& to) {
        return over * (Vec3d(velocity_(x + to, now)) - Vec3d(velocity_(x - to, now)));
      };
      const Vec3d dx = slope({radius, 0, 0}), dy = slope({0, radius, 0}),
                  dz = slope({0, 0, radius});
      put(at.curl, p, {dy.z - dz.y, dz.x - dx.z, dx.y - dy.x});
      if constexpr (Exchange::needs_strain) {
        put(at.stretch, p, {dx.x, dy.y, dz.z});
        put(at.strain, p, {0.5 * (dy.z + dz.y), 0.5 * (dz.x + dx.z), 0.5 * (dx.y + dy.x)});
      }
    }
  }

  Velocity velocity_;
  Exchange exchange_;
  FluidProperties fluid_;
};

template <class Drag, class Velocity, class... Forces>
PrescribedFlow(const Drag&, const FluidProperties&, Velocity, const Forces&...)
    -> PrescribedFlow<Velocity, Drag, Forces...>;

namespace detail {
/// In place of the velocity, where arguments of a PrescribedFlow do not fit.
struct NoVelocity {
  Vec3d operator()(const Vec3d&, double) const { return {0, 0, 0}; }
};
}  // namespace detail

/// Gives the message, and no further errors.
template <class Drag>
class PrescribedFlow<detail::NoVelocity, Drag> {
  static_assert(std::is_void_v<Drag>,
                "PrescribedFlow takes a drag law, FluidProperties, a velocity (x [m], t [s]) -> "
                "silt::Vec3d, and forces, in this order; it has no cells and takes no averaging "
                "mode (silt/coupling/prescribed_flow.hpp)");

 public:
  static constexpr bool active = false;  // avoids further errors in Simulation
  template <class... Args>
  PrescribedFlow(const Drag&, const FluidProperties&, const Args&...) {}
  template <class Second, class... Args>
  PrescribedFlow(const Drag&, const Second&, const FluidProperties&, const Args&...) {}
};
template <class Drag, class Third, class... More>
requires(!VelocityField<Third>)
    PrescribedFlow(const Drag&, const FluidProperties&, const Third&, const More&...)
->PrescribedFlow<detail::NoVelocity, Drag>;
template <class Drag, class Second, class... More>
requires(!std::convertible_to<Second, FluidProperties>)
    PrescribedFlow(const Drag&, const Second&, const FluidProperties&, const More&...)
->PrescribedFlow<detail::NoVelocity, Drag>;

}  // namespace silt
