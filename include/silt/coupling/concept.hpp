// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

struct CoupledParticles;  // coupling/particles_in_fluid.hpp
struct LeftParticle;      // coupling/left_particle.hpp
struct Wall;              // boundary/wall.hpp
namespace detail {
struct ParticlesInFluid;
}

/// Time of a fluid.
struct FluidClock {
  double time = 0;         // [s] time of the fluid's state
  std::int64_t steps = 0;  // [-] of the fluid, since the start
  double last_step = 0;    // [s] length of the last one; 0: none

  void count(double dt) { time += dt, ++steps, last_step = dt; }
  /// For a checkpoint: three numbers, "fluid.clock".
  template <class Visit>
  void for_each_state(const Visit& visit) {
    std::array<double, 3> all{time, static_cast<double>(steps), last_step};
    visit("fluid.clock", std::span<double>(all));
    time = all[0], steps = static_cast<std::int64_t>(all[1]), last_step = all[2];
  }
};

/// Scene of a simulation, for checks by its fluid.
struct FluidScene {
  std::array<bool, 3> periodic{};  // periodic directions of the particles,
  Box box;                         // between its min and its max
  /// The simulation's walls; they do not move in memory between two calls of prepare().
  const DynArray<Wall>* walls = nullptr;
};

/// Data about the particles for the choice of the fluid step.
struct FluidPace {
  double step;   // [s] of the particles
  double speed;  // [m/s] of the fastest particle
  /// [s] largest particle step that resolves the contacts; empty if their law has no closed form.
  /// Expensive.
  std::function<std::optional<double>()> contact_limit;
};

/// The fastest fluid in a scene, for the choice of the particles' time step.
struct FastestFluid {
  double velocity = 0;                // [m/s]
  double density = 0, viscosity = 0;  // [kg/m3], [Pa s]
  double way = INFINITY;              // [m] over which it can carry particles

  /// [m/s] Estimated speed of a sphere that starts at rest: its drag at rest (Schiller and Naumann)
  /// all the way, and at most the fluid's velocity.
  double carries(double diameter, double mass) const {
    if (!(velocity > 0)) return 0;
    const double area = 0.25 * std::numbers::pi * diameter * diameter,
                 Re = viscosity > 0 ? density * velocity * diameter / viscosity : INFINITY,
                 coefficient = Re < 1000 ? 24 / Re * (1 + 0.15 * std::pow(Re, 0.687)) : 0.44,
                 force = 0.5 * density * velocity * velocity * coefficient * area;
    return std::min(velocity, std::sqrt(2 * force / mass * way));
  }
};

namespace detail {

/// Declares itself a fluid.
template <class F>
concept MeantAsFluid = requires {
  { F::active } -> std::convertible_to<bool>;
};
template <class F>
concept HasClock = requires(F& fluid) {
  { (fluid.clock) } -> std::same_as<FluidClock&>;
};
template <class F>
concept PreparesFluid = requires(F& fluid, const FluidScene& scene) {
  fluid.prepare(scene);
};
template <class F>
concept PacesFluid = requires(const F& fluid, const FluidPace& pace, const Team& team) {
  { fluid.steps_wanted(pace, team) } -> std::convertible_to<int>;
};
template <class F>
concept AdvancesFluid = requires(F& fluid, const CoupledParticles& particles, double dt,
                                 std::span<Vec3d> loads, const Team& team) {
  fluid.advance(particles, dt, loads, team, loads);
};
struct AnyVisitor {
  template <class Values>
  void operator()(const std::string&, Values&&) const {}
};
template <class F>
concept KeepsFluidState = requires(F& fluid) {
  fluid.for_each_state(AnyVisitor{});
};
template <class F>
concept ActiveFluid =
    HasClock<F> && PreparesFluid<F> && PacesFluid<F> && AdvancesFluid<F> && KeepsFluidState<F>;

}  // namespace detail

/// Coupling of particles with a fluid: NoFluid, CoupledFlow (coupled_flow.hpp), CoupledMesh
/// (coupled_mesh.hpp), PrescribedFlow (prescribed_flow.hpp), or a user-defined struct.
///
/// It has `static constexpr bool active`. If this is false, nothing else is required, and the time
/// loop has no stage for a fluid. If it is true:
///
///   FluidClock clock             time of the fluid. advance() counts its steps; the simulation
///                                sets clock.time to its own time, to the last digit
///   void prepare(scene)          throws InputError for invalid settings, or if it does not match
///                                the scene; called at the start of each run
///   int steps_wanted(pace, team) const       number of particle steps in its next step
///   void advance(particles, dt, force, team, torque)
///                                one fluid step of dt [s]: reads CoupledParticles, sets the force
///                                [N], and with `turns` the torque [N m], of each particle; these
///                                are constant until the next step. Throws Error on failure;
///                                FlowStepError if a shorter step would succeed
///   void for_each_state(visit)   state for checkpoints: visit(name, values), which may change
///                                them; values: a span of doubles, or a std::vector
///
/// Optional members, detected by detail::FluidTraits:
///
///   static constexpr bool turns       it has torques
///   static constexpr bool needs_spin  it reads angular velocities of particles; true if it `turns`
///   static constexpr bool needs_rotation       it refuses spheres that do not rotate
///   static constexpr bool sees_forms  it reads CoupledParticles::forms of bodies
///   void take_form(form, shape)       gets each form of bodies by number, with the type of the
///                                     particles' shape, before the first advance() that uses it
///   static constexpr bool follows     drag follows each particle's velocity: FollowingFluid
///   Vec3d gravity                     [m/s2] set to the simulation's before each step
///   Vec3d at_the_side(x, radius)      position for the fluid of a particle with its centre outside
///   bool reaches(x)                   with it: whether a particle at that position is in the fluid
///   void take_away(left)              gets each particle that an outlet or remove() takes out of
///                                     the fluid (LeftParticle), before the next advance()
///   void check_step(span, pace)       after advance(): throws Error if the step was too long
///   void check_state(name, values)    throws InputError for invalid restored values
///   warnings()                        sentences that progress() and on_warnings() pass on after a
///                                     run: std::vector<std::string>
///   static constexpr bool warns_at_start       and after the first step of a run
///   FastestFluid fastest(scene)       its largest velocity in a box: the particles' time step is
///                                     chosen for the speed that it gives them
///   double longest_particle_step(radius, mass) [s] longest step of the particles in which its
///                                     loads on one of this radius [m] and mass [kg] may be constant
///   load_on_driven(w)                 its load on the driven wall w of the scene, and its
///                                     stiffness for a servo: LiquidOnWall, sph/driven_walls.hpp
///   void write(path), file_kind       writes the fluid for ParaView (vtk_series); its ending
///   static constexpr const char* series_name   and the name of the series, if not "flow"
///   void describe(is)                 is(name, value): items that the scene of a checkpoint must
///                                     match
///
/// Results must be equal, bit for bit, for any number of threads.
/// Tests: tests/coupling/own_coupling.cpp, tests/compile/refused/fluid_*.cpp.
template <class F>
concept FluidCoupling = detail::MeantAsFluid<F> &&(!F::active || detail::ActiveFluid<F>);

/// Rows of one particle that a fluid with following drag reads and changes (see FluidLoads in
/// engine/state/fluid_loads.hpp).
template <class Row>
struct FollowedRow {
  Row& held;
  const Row& flow;
  Row& reference;
  const Row& given;
  Row& taken;
};

/// Fluid whose drag is computed in each particle step: `follows` is true, and it has
///   start_of(p)                       FollowStart of particle p, after advance()
///   lose(impulse)                     [N s] that removed particles had taken beyond their share
///   prepare_to_follow(team)           before the particles of a step
///   follow(row, x, v, mass, contacts, dt)      force [N] on one particle; changes its FollowedRow
/// An example is CoupledFlow with FollowedDrag.
template <class F>
concept FollowingFluid = FluidCoupling<F> && F::active && requires(F& fluid, const Team& team) {
  requires F::follows;
  fluid.start_of(std::size_t{});
  fluid.lose(Vec3d{});
  fluid.prepare_to_follow(team);
};

namespace detail {

/// Optional abilities of a fluid.
template <class F>
struct FluidTraits {
  static constexpr bool active = F::active;
  static constexpr bool turns = requires { requires F::turns; };
  static constexpr bool needs_spin = turns || requires { requires F::needs_spin; };
  static constexpr bool needs_rotation = requires { requires F::needs_rotation; };
  static constexpr bool follows = requires { requires F::follows; };
  static constexpr bool carries = requires(const F& f, const Box& scene) {
    { f.fastest(scene) } -> std::same_as<FastestFluid>;
  };
  static constexpr bool limits_steps = requires(const F& f) {
    { f.longest_particle_step(1.0, 1.0) } -> std::same_as<double>;
  };
  static constexpr bool sees_forms = requires { requires F::sees_forms; };
  template <class Shape>
  static constexpr bool takes_forms = requires(F& f, const Shape& shape) {
    f.take_form(std::size_t{}, shape);
  };
  static constexpr bool has_sides = requires(const F& f, const Vec3d& x) { f.at_the_side(x, 1.0); };
  static_assert(
      !has_sides || requires(const F& f, const Vec3d& x) { bool(f.reaches(x)); },
      "a fluid with at_the_side() must also have `bool reaches(const silt::Vec3d& x) "
      "const`: whether a particle at that position is in the fluid");
  static constexpr bool sees_leaving = requires(F & f, const LeftParticle& p) { f.take_away(p); };
  static constexpr bool pushes_walls = requires(const F& f) { f.load_on_driven(std::size_t{}); };
  static constexpr bool checks_steps = requires(const F& f, const FluidPace& pace) {
    f.check_step(1.0, pace);
  };
  static constexpr bool checks_state = requires(const F& f, std::span<const double> values) {
    f.check_state(std::string{}, values);
  };
  static constexpr bool is_written = requires(const F& f) {
    f.write(std::string{});
    std::string(F::file_kind);
  };
  static constexpr const char* series_name() {
    if constexpr (requires { std::string(F::series_name); })
      return F::series_name;
    else
      return "flow";
  }
  static void tell_gravity(F& fluid, const Vec3d& gravity) {
    if constexpr (requires { fluid.gravity = gravity; }) fluid.gravity = gravity;
  }
  /// A type that must be complete only with a fluid.
  using Particles = std::conditional_t<active, ParticlesInFluid, F>;
};

}  // namespace detail
}  // namespace silt
