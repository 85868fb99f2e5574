// silt - BSD-3-Clause, see LICENSE
#pragma once

// Part of ParticleExchange: its stages for one particle.

#include <silt/coupling/particle_exchange.hpp>

namespace silt::inline SILT_TARGET {

template <class Drag, class... Forces>
void ParticleExchange<Drag, Forces...>::check_fluid() const {
  const auto& [density, viscosity] = settings.fluid;
  bool fits = viscosity > 0;
  // Laws that do not read Re, as Stokes, give no drag in an inviscid fluid; others are not numbers.
  if constexpr (!OrientedDragLaw<Drag>)
    if (!fits)
      fits = std::isfinite(drag_coefficient(
          drag_, 1.0, slip_reynolds(1.0, density, 1.0, 1.0, viscosity), 1.0, viscosity));
  require(fits, "FluidProperties.viscosity = ", viscosity,
          " Pa s must be given and positive, as the drag law needs a Reynolds number: air at 20 C "
          "has 1.8e-5, water 1e-3");
}

template <class Drag, class... Forces>
void ParticleExchange<Drag, Forces...>::check(const CoupledParticles& of, std::size_t forces,
                                              std::size_t torques) const {
  const std::size_t n = of.velocity.size();
  const auto same = [n](std::size_t count, const char* what) {
    require(count == n, "CoupledParticles: ", count, " ", what, " for ", n,
            " velocities; give one each");
  };
  same(of.shape.position.size(), "positions"), same(of.volume.size(), "volumes");
  same(of.mass.size(), "masses"), same(forces, "forces");
  if (!of.acceleration.empty()) same(of.acceleration.size(), "accelerations");
  if (!of.owed.empty()) same(of.owed.size(), "impulses owed");
  if (!of.drag.empty()) same(of.drag.size(), "held drags");
  if (!of.angular_velocity.empty()) same(of.angular_velocity.size(), "angular velocities");
  if (torques > 0) same(torques, "torques");
  if constexpr (has_history) same(of.id.size(), "ids, which a history needs,");
  if constexpr (sees_forms) detail::check_forms(of, drag_, forces_);
  require(settings.least_voidage > 0 && settings.least_voidage < 1,
          "CoupledFlow.least_voidage = ", settings.least_voidage, " must be in (0, 1)");
}

/// Passes the present slips to forces with a history.
template <class Drag, class... Forces>
void ParticleExchange<Drag, Forces...>::remember([[maybe_unused]] const CoupledParticles& of,
                                                 [[maybe_unused]] double dt,
                                                 [[maybe_unused]] const Team& team) {
  if constexpr (has_history) {
    slips_.resize(of.velocity.size());
    for (std::size_t p = 0; p < slips_.size(); ++p)
      slips_[p] = is_outside(p) ? Vec3d{NAN, NAN, NAN} : vector_of(at.velocity, p) - of.velocity[p];
    detail::remember_slips(forces_, of.id, slips_, dt, team);
  }
}

template <class Drag, class... Forces>
void ParticleExchange<Drag, Forces...>::find(const CoupledParticles& of, double dt,
                                             std::span<Vec3d> torque, const Team& team) {
  if constexpr (needs_mean_diameter)
    require(at.mean_diameter.size() == of.velocity.size(),
            "ParticleExchange: ", at.mean_diameter.size(), " mean diameters for ",
            of.velocity.size(),
            " particles; set at.mean_diameter, which this drag law or force needs");
  remember(of, dt, team);
  response_.resize(of.velocity.size());
  if constexpr (follows) others_.resize(of.velocity.size());
  std::array<double, Team::most_ranges> largest{};
  std::array<HeldAnswer, Team::most_ranges> held{};
  team.for_ranges(response_.size(), [&](std::size_t range, std::size_t from, std::size_t to) {
    for (std::size_t p = from; p < to; ++p) {
      response_[p] = {};
      if constexpr (turns)
        if (!torque.empty()) torque[p] = {0, 0, 0};
      if (is_outside(p)) continue;
      const InFluid here = particle(of, p, dt);
      response_[p] = response_of(of, here, p);
      largest[range] = std::max(largest[range], gain_of(here, response_[p]));
      if (const double lag = response_[p].lag; lag > HeldAnswer::least_lag)
        held[range].include(lag, here.mass / (here.volume * here.density), is_pushed(of, p, dt));
      if constexpr (turns)
        if (!torque.empty()) torque[p] = torque_on(here);
    }
  });
  held_answer_ = {0, 0, 0.9 * held_answer_.in_contact};
  for (const HeldAnswer& one : held) {
    held_answer_.include(one.lag, one.density_ratio, false);
    held_answer_.in_contact = std::max(held_answer_.in_contact, one.in_contact);
  }
  gain_ = *std::max_element(largest.begin(), largest.end());
  moves_ = gain_ > most_lagged_gain;
  bears_ = in_pressure() && (moves_ || held_answer_.lag > most_lagged_share);
}

/// Whether more than gravity and the fluid has accelerated particle p in the last step.
template <class Drag, class... Forces>
bool ParticleExchange<Drag, Forces...>::is_pushed(const CoupledParticles& of, std::size_t p,
                                                  double dt) const {
  if (of.acceleration.empty()) return false;
  const double rounding =
      1e-6 * norm(settings.gravity) + 1e-9 / dt * norm(of.velocity[p]);  // [m/s2]
  return norm(of.acceleration[p] - settings.gravity) > rounding;
}

template <class Drag, class... Forces>
auto ParticleExchange<Drag, Forces...>::particle(const CoupledParticles& of, std::size_t p,
                                                 double dt) const -> InFluid {
  InFluid here{};
  here.density = settings.fluid.density, here.viscosity = settings.fluid.viscosity;
  here.voidage = voidage(p);
  here.diameter = 2 * of.shape.radius[p], here.volume = of.volume[p], here.mass = of.mass[p];
  here.inertia_factor = of.inertia_factor;
  if constexpr (needs_mean_diameter) here.mean_diameter = at.mean_diameter[p];
  here.dt = dt, here.place = p, here.slip = vector_of(at.velocity, p) - of.velocity[p];
  if constexpr (needs_curl) here.curl = vector_of(at.curl, p);
  if constexpr (needs_strain)
    here.stretch = vector_of(at.stretch, p), here.strain = vector_of(at.strain, p);
  if (!of.angular_velocity.empty()) here.angular_velocity = of.angular_velocity[p];
  if (!of.shape.orientation.empty()) here.orientation = of.shape.orientation[p];
  if (!of.shape.form.empty()) here.form = of.shape.form[p];
  if constexpr (sees_forms)
    if (!of.forms.empty()) here.body = &of.forms[here.form];
  return here;
}

template <class Drag, class... Forces>
StepResponse ParticleExchange<Drag, Forces...>::response_of(const CoupledParticles& of,
                                                            const InFluid& here, std::size_t p) {
  StepLoads loads{};
  loads.mass = here.mass, loads.dt = here.dt, loads.volume = in_pressure() ? here.volume : 0;
  loads.velocity = of.velocity[p], loads.fluid = vector_of(at.velocity, p);
  const auto ask = [&](const auto& force) {
    using F = std::decay_t<decltype(force)>;
    if constexpr (pushes<F>) loads.push += force.force_on(here);
    if constexpr (adds_mass<F>) loads.added += force.added_mass(here);
  };
  std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
  if constexpr (follows) others_[p] = loads.push;
  if constexpr (has_added_mass) loads.convection = vector_of(at.convection, p);
  loads.drag = coefficient(of, here, p);
  if (!std::isfinite(here.mass)) return step_response(loads);
  loads.others = (-here.volume * settings.fluid.density) * settings.gravity;
  if (!of.acceleration.empty()) loads.others += here.mass * of.acceleration[p];
  StepResponse response = step_response(loads);
  // Drag that relaxes within the step is evaluated at the mean of both slips. With that at the
  // start a drag ~ slip^2 would alternate between slip and (terminal velocity)^2/slip.
  if (here.dt * loads.drag > stiff_drag * (loads.mass + loads.added)) {
    const double last = norm(loads.fluid - response.velocity(loads.fluid, slope(p)));
    loads.drag = coefficient(here, 0.5 * (norm(here.slip) + last));
    response = step_response(loads);
  }
  return response;
}

template <class Drag, class... Forces>
double ParticleExchange<Drag, Forces...>::coefficient(double eps, double slip, double d) const {
  const auto& fluid = settings.fluid;
  const double Re = slip_reynolds(eps, fluid.density, slip, d, fluid.viscosity);
  const double K = drag_coefficient(drag_, eps, Re, d, fluid.viscosity);
  return settings.model == MomentumModel::B ? model_b(K, eps) : K;
}

template <class Drag, class... Forces>
double ParticleExchange<Drag, Forces...>::coefficient([[maybe_unused]] const CoupledParticles& of,
                                                      const InFluid& here,
                                                      [[maybe_unused]] std::size_t p) const {
  if constexpr (follows)
    if (!of.drag.empty()) {
      HeldDrag& held = of.drag[p];
      const double tolerance = followed().tolerance;
      if (norm(here.slip - held.slip) <= tolerance * norm(held.slip) &&
          std::abs(here.voidage - held.voidage) <= tolerance)
        return held.coefficient;
      held = {coefficient(here.voidage, norm(here.slip), here.diameter), here.slip, here.voidage};
      return held.coefficient;
    }
  return coefficient(here, norm(here.slip));
}

template <class Drag, class... Forces>
double ParticleExchange<Drag, Forces...>::coefficient(const InFluid& here, double slip) const {
  const double Re = slip_reynolds(here.voidage, here.density, slip, here.diameter, here.viscosity);
  const double K = detail::drag_on(drag_, here, Re);
  return settings.model == MomentumModel::B ? model_b(K, here.voidage) : K;
}

template <class Drag, class... Forces>
void ParticleExchange<Drag, Forces...>::give(const CoupledParticles& of, double dt, bool implicit) {
  const std::size_t n = of.velocity.size();
  if (!implicit) moves_ = bears_ = false;
  if (moves_) {
    given.with_fluid.resize(n), given.with_pressure.resize(n), resize(given.flux, n);
    for (std::size_t p = 0; p < n; ++p) {
      const auto& r = response_[p];
      const double V = of.volume[p];
      Vec3d flux = r.start;
      if (in_pressure()) flux += r.with_pressure * vector_of(at.stress, p);
      given.with_fluid[p] = V * r.with_fluid;
      given.with_pressure[p] = V * r.with_pressure;
      given.flux[0][p] = V * flux.x, given.flux[1][p] = V * flux.y, given.flux[2][p] = V * flux.z;
    }
  }
  given.coefficient.resize(n), resize(given.offset, n);
  if (bears_) given.borne.resize(n);
  const bool lagged = in_pressure() && !bears_;
  for (std::size_t p = 0; p < n; ++p) {
    auto& r = response_[p];
    if (lagged)
      r.offset -= r.borne * (vector_of(at.slope, p) - vector_of(at.stress, p)), r.borne = 0;
    Vec3d push = r.offset;
    if constexpr (follows) {
      if (!of.owed.empty()) push -= (1 / dt) * of.owed[p];
      if (!of.owed.empty() && is_outside(p)) lost += of.owed[p];
    }
    given.offset[0][p] = push.x, given.offset[1][p] = push.y, given.offset[2][p] = push.z;
    given.coefficient[p] = r.coefficient;
    if (bears_) given.borne[p] = r.borne;
  }
}

template <class Drag, class... Forces>
Exchanged ParticleExchange<Drag, Forces...>::take(const CoupledParticles& of, double dt,
                                                  std::span<Vec3d> force) {
  const std::size_t n = of.velocity.size();
  Exchanged done;
  if constexpr (follows) start_.assign(n, {});
  for (std::size_t p = 0; p < n; ++p) {
    if (is_outside(p)) {
      force[p] = {0, 0, 0};
      continue;
    }
    const Vec3d exchanged = response_[p].force(vector_of(at.velocity, p), slope(p));
    done.on_particles += exchanged, done.magnitudes += norm(exchanged);
    force[p] = exchanged + static_force(of.volume[p], p);
    if constexpr (follows) start_following(of, p, exchanged, dt, done);
  }
  return done;
}

/// After the fluid's step, in which it gave `exchanged` [N] to particle p.
template <class Drag, class... Forces>
void ParticleExchange<Drag, Forces...>::start_following(const CoupledParticles& of, std::size_t p,
                                                        const Vec3d& exchanged, double dt,
                                                        Exchanged& done) {
  const double V = of.volume[p];
  const Vec3d others = others_[p];  // lift and so on
  const Vec3d weight = -V * settings.fluid.density * settings.gravity, all = static_force(V, p);
  const bool from_cells = followed().cell > 0;  // then pressure is part of the exchange
  start_[p] = {vector_of(at.velocity, p),
               exchanged - others + (from_cells ? all - weight : Vec3d{0, 0, 0}),
               others + (from_cells ? weight : all), voidage(p)};
  if (of.owed.empty()) return;
  done.owed += of.owed[p], done.on_particles += (1 / dt) * of.owed[p];
  done.magnitudes += norm(of.owed[p]) / dt;
}

template <class Drag, class... Forces>
template <class Row>
Vec3d ParticleExchange<Drag, Forces...>::follow(const FollowedRow<Row>& row, const Vec3d& u,
                                                const Vec3d& read, const Vec3d& v, double mass,
                                                const Vec3d& contacts, double dt) const {
  auto &held = row.held, &reference = row.reference;
  const Vec3d push = held.vector();
  const Vec3d slip = u - v, change = slip - reference.vector();
  const double tolerance = followed().tolerance, tolerance2 = tolerance * tolerance;
  if (!(dot(change, change) <= tolerance2 * dot(reference.vector(), reference.vector()))) {
    reference = {slip.x, slip.y, slip.z, row.flow.fourth};
    held.fourth = coefficient(row.flow.fourth, norm(slip), row.given.fourth);
  }
  const Vec3d a = (1 / mass) * (contacts + push + read) + settings.gravity;
  const Vec3d exchanged = momentum_exchange(mass, held.fourth, dt, a).force(u, v) + read;
  auto& taken = row.taken;
  taken.x += dt * exchanged.x, taken.y += dt * exchanged.y, taken.z += dt * exchanged.z;
  return exchanged + push;
}

}  // namespace silt
