// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of CoupledFlow: what passes between particles and cells in a fluid step.

#include <silt/coupling/coupled_flow.hpp>

namespace silt::inline SILT_TARGET {

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::check(const CoupledParticles& of, std::size_t forces,
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
  require(least_voidage > 0 && least_voidage < 1, "CoupledFlow.least_voidage = ", least_voidage,
          " must be in (0, 1)");
}

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::spread_volume(const CoupledParticles& of,
                                                            CoupledStep& done, const Team& team) {
  CellField* const to[] = {&solids_};
  const std::span<const double> volume[] = {of.volume};
  averaging_->spread(volume, to, team);
  if (const auto* joined = flow_.joined_cells()) joined->spread(solids_);
  const Grid& g = flow_.grid();
  for (const double v : of.volume) done.solids += v;
  if (done.solids > 0 && done.averaging.outside == 0)
    done.volume_error = total(solids_) / done.solids - 1;
  done.clipped = clipped_solids(solids_, least_voidage);
  const double over = 1 / g.cell_volume();
  CellValues::for_rows(flow_, team, [&](int j, int k) {
    const double* const s = solids_.row(j, k);
    double* const eps = flow_.voidage().row(j, k);
    const double* const open = flow_.open_row(j, k);
    for (int i = 0; i < g.nx(); ++i)
      eps[i] = std::max(1 - s[i] * over / fluid_detail::fluid_share(open, i), least_voidage);
  });
}

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::gather(std::size_t n, const Team& team, bool all) {
  std::array<const CellField*, quantities> from;
  std::array<std::span<double>, quantities> to;
  std::size_t count = 0;
  const auto take = [&](CellField& field, std::size_t column) {
    join(field);
    values_[column].resize(n);
    from[count] = &field, to[count++] = values_[column];
  };
  const auto take3 = [&](auto& fields, std::size_t column) {
    for (std::size_t d = 0; d < 3; ++d) take(fields[d], column + d);
  };
  take3(cells_.velocity, u_at);
  if (in_pressure()) take3(cells_.slope, slope_at), take3(cells_.stress, stress_at);
  if (all) take(flow_.voidage(), eps_at);
  if constexpr (needs_curl)
    if (all) take3(cells_.curl, curl_at);
  if constexpr (needs_strain)
    if (all) take3(cells_.stretch, strain_at), take3(cells_.strain, strain_at + 3);
  if constexpr (has_added_mass)
    if (all) take3(cells_.convection, convection_at);
  averaging_->gather(ConstCellFields(from.data(), count), GatheredValues(to.data(), count), team);
}

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::remember([[maybe_unused]] const CoupledParticles& of,
                                                       [[maybe_unused]] double dt,
                                                       [[maybe_unused]] const Team& team) {
  if constexpr (has_history) {
    slips_.resize(of.velocity.size());
    for (std::size_t p = 0; p < slips_.size(); ++p)
      slips_[p] = is_outside(p) ? Vec3d{NAN, NAN, NAN} : value(u_at, p) - of.velocity[p];
    detail::remember_slips(forces_, of.id, slips_, dt, team);
  }
}

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::find_exchange(const CoupledParticles& of, double dt,
                                                            std::span<Vec3d> torque,
                                                            const Team& team) {
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
      const InFluid at = particle(of, p, dt);
      response_[p] = response_of(of, at, p);
      largest[range] = std::max(largest[range], gain_of(at, response_[p]));
      if (const double lag = response_[p].lag; lag > HeldAnswer::least_lag)
        held[range].include(lag, at.mass / (at.volume * at.density), is_pushed(of, p, dt));
      if constexpr (turns)
        if (!torque.empty()) torque[p] = torque_on(at);
    }
  });
  held_answer_ = {0, 0, 0.9 * held_answer_.in_contact};
  for (const HeldAnswer& one : held) {
    held_answer_.include(one.lag, one.density_ratio, false);
    held_answer_.in_contact = std::max(held_answer_.in_contact, one.in_contact);
  }
  const bool moves = *std::max_element(largest.begin(), largest.end()) > most_lagged_gain;
  const bool bears = in_pressure() && (moves || held_answer_.lag > most_lagged_share);
  if (moves || bears || flow_.responds())
    flow_.response().moves = moves, flow_.response().bears = bears;
}

/// Whether more than gravity and the fluid has accelerated particle p in the last step.
template <class Drag, class Mode, class... Forces>
bool BasicCoupledFlow<Drag, Mode, Forces...>::is_pushed(const CoupledParticles& of, std::size_t p,
                                                        double dt) const {
  if (of.acceleration.empty()) return false;
  const double rounding = 1e-6 * norm(gravity) + 1e-9 / dt * norm(of.velocity[p]);  // [m/s2]
  return norm(of.acceleration[p] - gravity) > rounding;
}

template <class Drag, class Mode, class... Forces>
auto BasicCoupledFlow<Drag, Mode, Forces...>::particle(const CoupledParticles& of, std::size_t p,
                                                       double dt) const -> InFluid {
  InFluid at{};
  at.density = flow_.fluid().density, at.viscosity = flow_.fluid().viscosity;
  const bool alone = flow_.options().model == MomentumModel::Simplified;
  at.voidage = alone ? 1 : std::clamp(values_[eps_at][p], least_voidage, 1.0);
  at.diameter = 2 * of.shape.radius[p], at.volume = of.volume[p], at.mass = of.mass[p];
  at.inertia_factor = of.inertia_factor;
  at.dt = dt, at.place = p, at.slip = value(u_at, p) - of.velocity[p];
  if constexpr (needs_curl) at.curl = value(curl_at, p);
  if constexpr (needs_strain) at.stretch = value(strain_at, p), at.strain = value(strain_at + 3, p);
  if (!of.angular_velocity.empty()) at.angular_velocity = of.angular_velocity[p];
  if (!of.shape.orientation.empty()) at.orientation = of.shape.orientation[p];
  if (!of.shape.form.empty()) at.form = of.shape.form[p];
  if constexpr (sees_forms)
    if (!of.forms.empty()) at.body = &of.forms[at.form];
  return at;
}

template <class Drag, class Mode, class... Forces>
StepResponse BasicCoupledFlow<Drag, Mode, Forces...>::response_of(const CoupledParticles& of,
                                                                  const InFluid& at,
                                                                  std::size_t p) {
  StepLoads loads{};
  loads.mass = at.mass, loads.dt = at.dt, loads.volume = in_pressure() ? at.volume : 0;
  loads.velocity = of.velocity[p], loads.fluid = value(u_at, p);
  const auto ask = [&](const auto& force) {
    using F = std::decay_t<decltype(force)>;
    if constexpr (pushes<F>) loads.push += force.force_on(at);
    if constexpr (adds_mass<F>) loads.added += force.added_mass(at);
  };
  std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
  if constexpr (follows) others_[p] = loads.push;
  if constexpr (has_added_mass) loads.convection = value(convection_at, p);
  loads.drag = coefficient(of, at, p);
  if (!std::isfinite(at.mass)) return step_response(loads);
  loads.others = (-at.volume * flow_.fluid().density) * gravity;
  if (!of.acceleration.empty()) loads.others += at.mass * of.acceleration[p];
  StepResponse response = step_response(loads);
  // A drag that dies within the step is that of the mean of both slips: with that of the first one
  // a drag ~ slip^2 never comes to rest, slip and (terminal velocity)^2/slip by turns.
  if (at.dt * loads.drag > stiff_drag * (loads.mass + loads.added)) {
    const Vec3d slope = in_pressure() ? value(slope_at, p) - value(stress_at, p) : Vec3d{0, 0, 0};
    const double last = norm(loads.fluid - response.velocity(loads.fluid, slope));
    loads.drag = coefficient(at, 0.5 * (norm(at.slip) + last));
    response = step_response(loads);
  }
  return response;
}

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::spread_exchange(const CoupledParticles& of,
                                                              std::size_t n, double dt,
                                                              const Team& team) {
  std::array<CellField*, 10> to;
  std::array<std::span<const double>, 10> from;
  std::size_t count = 0;
  const auto take = [&](CellField& field, std::size_t column) {
    values_[column].resize(n);
    from[count] = values_[column], to[count++] = &field;
  };
  if (moves()) {
    ParticleResponse* const answer = &flow_.response();
    take(answer->with_fluid, with_fluid_at), take(answer->with_pressure, with_pressure_at);
    for (std::size_t d = 0; d < 3; ++d) take(answer->flux[d], flux_at + d);
    for (std::size_t p = 0; p < n; ++p) {
      const auto& r = response_[p];
      const double V = of.volume[p];
      Vec3d flux = r.start;
      if (in_pressure()) flux += r.with_pressure * value(stress_at, p);
      values_[with_fluid_at][p] = V * r.with_fluid;
      values_[with_pressure_at][p] = V * r.with_pressure;
      values_[flux_at][p] = V * flux.x, values_[flux_at + 1][p] = V * flux.y,
      values_[flux_at + 2][p] = V * flux.z;
    }
  }
  for (int d = 0; d < 3; ++d) take(flow_.drag_velocity(d), static_cast<std::size_t>(d));
  take(flow_.drag(), b_at);
  const bool bears_now = bears(), lagged = in_pressure() && !bears_now;
  if (bears_now) take(flow_.response().borne, borne_at);
  for (std::size_t p = 0; p < n; ++p) {
    auto& r = response_[p];
    if (lagged) r.offset -= r.borne * (value(slope_at, p) - value(stress_at, p)), r.borne = 0;
    Vec3d push = r.offset;
    if constexpr (follows) {
      if (!of.owed.empty()) push -= (1 / dt) * of.owed[p];
      if (!of.owed.empty() && is_outside(p)) lost_ += of.owed[p];
    }
    values_[0][p] = push.x, values_[1][p] = push.y, values_[2][p] = push.z;
    values_[b_at][p] = r.coefficient;
    if (bears_now) values_[borne_at][p] = r.borne;
  }
  averaging_->spread(Quantities(from.data(), count), CellFields(to.data(), count), team);
  const CellFields fields(to.data(), count);
  if (const auto* joined = flow_.joined_cells())
    for (CellField* f : fields) joined->spread(*f);
  const double over = 1 / flow_.grid().cell_volume();
  CellValues::for_rows(flow_, team, [&](int j, int k) {
    const double* const open = flow_.open_row(j, k);
    for (CellField* f : fields) {
      double* const row = f->row(j, k);
      for (int i = 0; i < flow_.grid().nx(); ++i)
        row[i] *= over / fluid_detail::fluid_share(open, i);
    }
  });
}

template <class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Drag, Mode, Forces...>::make_averaging(const CoupledParticles& of,
                                                             const Team& team) {
  if (of.velocity.empty()) return;
  if (!averaging_) {
    if (!diameter) diameter = 2 * *std::max_element(of.shape.radius.begin(), of.shape.radius.end());
    averaging_.emplace(mode_, flow_.grid(), *diameter);
  } else if (opened_ == flow_.boundaries()) {
    return;
  }
  if (const CellField* open = flow_.open_cells()) averaging_->open(*open, team);
  opened_ = flow_.boundaries();
}

}  // namespace silt
