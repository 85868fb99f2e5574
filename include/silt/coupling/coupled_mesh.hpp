// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/cell_space.hpp>
#include <silt/coupling/concept.hpp>
#include <silt/coupling/coupled_step.hpp>
#include <silt/coupling/mean_diameter.hpp>
#include <silt/coupling/particle_exchange.hpp>
#include <silt/coupling/step_choice.hpp>

namespace silt::inline SILT_TARGET {

/// Action of particles on the fluid of each cell in its coming step: f = push - drag u' [N/m3], u'
/// its velocity at the end of the step.
struct CellLoads {
  std::span<const double> voidage;              // [-] at the end of the step
  std::span<const double> drag;                 // [kg/(m3 s)]
  std::array<std::span<const double>, 3> push;  // [N/m3] by direction
};

/// Flow on the cells of a user-defined mesh:
///   FluidProperties fluid() const
///   std::span<const double> velocity(int d) const     [m/s] interstitial, one per cell
///   std::span<const double> slope(int d) const        [Pa/m] grad p - div tau, without the fluid's
///                                                     weight; each may be empty: 0 everywhere
///   void step(const CellLoads&, double dt)            one step [s] with the force
///                                                     -eps (grad p - div tau) + f; throws Error
///   double stable_step(double speed) const            [s] longest step, with particles of that
///                                                     speed [m/s]
///   void for_each_state(visit)                        as FluidCoupling
template <class F>
concept MeshFlow = requires(F& flow, const F& seen, const CellLoads& loads, double x, int d) {
  { seen.fluid() } -> std::convertible_to<FluidProperties>;
  { seen.velocity(d) } -> std::convertible_to<std::span<const double>>;
  { seen.slope(d) } -> std::convertible_to<std::span<const double>>;
  flow.step(loads, x);
  { seen.stable_step(x) } -> std::convertible_to<double>;
  flow.for_each_state(detail::AnyVisitor{});
};

/// Two-way coupling of particles and a flow on any mesh: the fluid of a Simulation.
///
///   silt::CoupledMesh fluid{silt::PointWeights{slabs}, gas, silt::Ergun{}};
///
/// As CoupledFlow (1) to (4), in momentum model A. The particles' part of the pressure is that of
/// the previous step; therefore particles must be heavier than (1 - eps)/eps of the fluid.
///
/// Errors: InputError for settings; Error, with a sentence, for particles that are too light.
/// Tests:  tests/coupling/coupled_mesh.cpp; docs/code/own_mesh.cpp.
/// Source: as CoupledFlow.
/// Valid:  particles heavier than (1 - eps)/eps of the fluid.
/// Units:  SI.
template <CellSpace Space, MeshFlow Flow, class Drag, class... Forces>
class CoupledMesh {
  using Exchange = ParticleExchange<Drag, Forces...>;
  using Column = DynArray<double>;
  static_assert(
      !Exchange::follows && !Exchange::needs_curl && !Exchange::has_added_mass,
      "CoupledMesh has no derivatives of the velocity, and forces are constant over its step: "
      "leave lift, virtual mass, histories and FollowedDrag out");

 public:
  static constexpr bool active = true, turns = Exchange::turns, needs_spin = Exchange::needs_spin,
                        needs_rotation = Exchange::needs_rotation,
                        sees_forms = Exchange::sees_forms;

  CoupledMesh(Space space, Flow flow, const Drag& drag, const Forces&... forces)
      : space_(std::move(space)), flow_(std::move(flow)), exchange_(drag, forces...) {
    exchange_.settings.fluid = flow_.fluid();
    exchange_.check_fluid();
  }

  Flow& flow() { return flow_; }
  const Flow& flow() const { return flow_; }
  const Space& space() const { return space_; }
  Vec3d gravity{0, 0, 0};      // [m/s2]; a Simulation sets its own
  double least_voidage = 0.3;  // [-] of a cell; the clipped volume is counted
  std::optional<int> steps;    // particle steps per fluid step; left out: by Flow::stable_step
  int most_steps = 50;         // upper limit
  FluidClock clock;
  const CoupledStep& last_step() const { return last_; }
  const FluidClosure& closure() const { return closure_; }
  std::span<const double> voidage() const { return eps_; }  // [-] of each cell

  void prepare(const FluidScene&) const { detail::check_steps("CoupledMesh", steps, most_steps); }
  int steps_wanted(const FluidPace& pace, const Team&) const {
    if (steps) return *steps;
    if (clock.steps == 0) return 1;
    const double longest = detail::longest_held_step(exchange_.held_answer(), clock,
                                                     flow_.stable_step(pace.speed), pace);
    return detail::steps_in(longest, pace, most_steps);
  }
  void check_step(double span, const FluidPace& pace) const {
    if (steps)
      detail::check_held_step("CoupledMesh", *steps, exchange_.held_answer(), span, pace, "");
  }

  CoupledStep advance(const CoupledParticles& of, double dt, std::span<Vec3d> force,
                      const Team& team = {}, std::span<Vec3d> torque = {}) {
    const std::size_t n = of.velocity.size();
    exchange_.settings = {flow_.fluid(), MomentumModel::A, gravity, least_voidage};
    exchange_.check(of, force.size(), torque.size());
    CoupledStep done;
    space_.place(of.shape, team);
    spread_volume(of, done, team);
    gather(n, team);
    exchange_.at.voidage.resize(n);
    space_.gather(eps_, exchange_.at.voidage, team);
    if constexpr (Exchange::needs_mean_diameter) {
      Column sum(space_.cells());
      detail::find_mean_diameters(of, exchange_.at.mean_diameter,
                                  [&](std::span<const double> from, std::span<double> to) {
                                    space_.spread(from, sum, team);
                                    space_.gather(sum, to, team);
                                  });
    }
    exchange_.find(of, dt, torque, team);
    if (!(exchange_.gain() < 1))
      throw Error(
          text("CoupledMesh: particles are so light, or cells so full, that the fluid's "
               "answer to them grows ",
               exchange_.gain(), " times a step; use CoupledFlow, which solves for both"));
    exchange_.give(of, dt, false);
    spread_exchange(team);
    flow_.step({eps_, drag_, {push_[0], push_[1], push_[2]}}, dt);
    gather(n, team);
    const Exchanged exchanged = exchange_.take(of, dt, force);
    done.exchanged = exchanged.magnitudes;
    done.momentum_error = exchanged.on_particles - taken_from_fluid();
    clock.count(dt), last_ = done, closure_.add(done);
    return done;
  }

  template <class Visit>
  void for_each_state(const Visit& visit) {
    flow_.for_each_state(visit);
    clock.for_each_state(visit);
    double in_contact = exchange_.held_answer().in_contact;
    visit("fluid.in_contact", std::span<double>(&in_contact, 1));
    exchange_.restore_held(in_contact);
  }

 private:
  void spread_volume(const CoupledParticles& of, CoupledStep& done, const Team& team) {
    const std::size_t cells = space_.cells();
    eps_.resize(cells), drag_.resize(cells), resize(push_, cells);
    space_.spread(of.volume, eps_, team);
    double spread = 0;
    for (const double v : of.volume) done.solids += v;
    for (std::size_t c = 0; c < cells; ++c) {
      const double V = space_.volume(c), most = (1 - least_voidage) * V;
      spread += eps_[c], done.clipped += std::max(0.0, eps_[c] - most);
      eps_[c] = std::max(1 - eps_[c] / V, least_voidage);
    }
    for (std::size_t p = 0; p < of.volume.size(); ++p)
      if (space_.locate(of.shape.position[p]) == no_cell) ++done.averaging.outside;
    done.averaging.particles = of.volume.size();
    if (done.solids > 0 && done.averaging.outside == 0)
      done.volume_error = spread / done.solids - 1;
  }
  /// Velocity and slope of the flow at the particles.
  void gather(std::size_t n, const Team& team) {
    const auto take = [&](std::span<const double> of, ParticleColumn& to) {
      to.assign(n, 0);
      if (!of.empty()) space_.gather(of, to, team);
    };
    for (int d = 0; d < 3; ++d) {
      const auto k = static_cast<std::size_t>(d);
      take(flow_.velocity(d), exchange_.at.velocity[k]);
      take(flow_.slope(d), exchange_.at.slope[k]);
      exchange_.at.stress[k].assign(n, 0);  // included in the slope
    }
  }
  void spread_exchange(const Team& team) {
    const auto spread = [&](const ParticleColumn& of, Column& to) {
      space_.spread(of, to, team);
      for (std::size_t c = 0; c < to.size(); ++c) to[c] /= space_.volume(c);
    };
    spread(exchange_.given.coefficient, drag_);
    for (std::size_t d = 0; d < 3; ++d) spread(exchange_.given.offset[d], push_[d]);
  }
  /// [N] force taken from the flow, as a force on the particles.
  Vec3d taken_from_fluid() const {
    const auto of = [&](int d) {
      const std::span<const double> u = flow_.velocity(d);
      const Column& push = push_[static_cast<std::size_t>(d)];
      double sum = 0;
      for (std::size_t c = 0; c < push.size(); ++c)
        sum += space_.volume(c) * (drag_[c] * (u.empty() ? 0 : u[c]) - push[c]);
      return sum;
    };
    return {of(0), of(1), of(2)};
  }

  Space space_;
  Flow flow_;
  Exchange exchange_;
  Column eps_, drag_;
  std::array<Column, 3> push_;
  CoupledStep last_;
  FluidClosure closure_;
};

}  // namespace silt
