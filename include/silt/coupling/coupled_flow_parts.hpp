// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of CoupledFlow: what passes between particles and cells in a fluid step.

#include <silt/coupling/coupled_flow.hpp>

namespace silt::inline SILT_TARGET {

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::check(const CoupledParticles& of, std::size_t forces,
                                               std::size_t torques) const {
  const std::size_t n = of.velocity.size();
  const auto same = [n](std::size_t count, const char* what) {
    require(count == n, "CoupledParticles: ", count, " ", what, " for ", n,
            " velocities; give one each");
  };
  same(of.shape.position.size(), "positions"), same(of.volume.size(), "volumes");
  same(of.mass.size(), "masses"), same(forces, "forces");
  if (!of.acceleration.empty()) same(of.acceleration.size(), "accelerations");
  if (!of.last_force.empty()) same(of.last_force.size(), "last forces");
  if (!of.owed.empty()) same(of.owed.size(), "impulses owed");
  if (!of.drag.empty()) same(of.drag.size(), "held drags");
  if (!of.angular_velocity.empty()) same(of.angular_velocity.size(), "angular velocities");
  if (torques > 0) same(torques, "torques");
  if constexpr (has_history) same(of.id.size(), "ids, which a history needs,");
  if constexpr (sees_forms) detail::check_forms(of, drag_, forces_);
  require(least_voidage > 0 && least_voidage < 1, "CoupledFlow.least_voidage = ", least_voidage,
          " must be in (0, 1)");
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::spread_volume(const CoupledParticles& of,
                                                       CoupledStep& done, const Team& team) {
  Field* const to[] = {&solids_};
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

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::gather(std::size_t n, const Team& team, bool all) {
  std::array<const Field*, quantities> from;
  std::array<std::span<double>, quantities> to;
  std::size_t count = 0;
  const auto take = [&](Field& field, std::size_t column) {
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
    if (all) take3(cells_.acceleration, Du_at);
  averaging_->gather(ConstCellFields(from.data(), count), GatheredValues(to.data(), count), team);
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::remember([[maybe_unused]] const CoupledParticles& of,
                                                  [[maybe_unused]] double dt,
                                                  [[maybe_unused]] const Team& team) {
  if constexpr (has_history) {
    slips_.resize(of.velocity.size());
    for (std::size_t p = 0; p < slips_.size(); ++p)
      slips_[p] = is_outside(p) ? Vec3d{NAN, NAN, NAN} : value(u_at, p) - of.velocity[p];
    detail::remember_slips(forces_, of.id, slips_, dt, team);
  }
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::find_exchange(const CoupledParticles& of, double dt,
                                                       std::span<Vec3d> torque, const Team& team) {
  exchange_.resize(of.velocity.size());
  if constexpr (follows) others_.resize(of.velocity.size());
  team.for_ranges(exchange_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t p = from; p < to; ++p) {
      exchange_[p] = {0, {0, 0, 0}};
      if constexpr (turns)
        if (!torque.empty()) torque[p] = {0, 0, 0};
      if (is_outside(p)) continue;
      const InFluid at = particle(of, p, dt);
      exchange_[p] = exchange_of(of, at, p);
      if constexpr (turns)
        if (!torque.empty()) torque[p] = torque_on(at);
    }
  });
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
auto CoupledFlow<Drag, Mode, Forces...>::particle(const CoupledParticles& of, std::size_t p,
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

template <class Drag, AveragingMode Mode, FluidForce... Forces>
Vec3d CoupledFlow<Drag, Mode, Forces...>::last_exchange(const CoupledParticles& of,
                                                        const InFluid& at, std::size_t p) const {
  if (!in_pressure() || of.last_force.empty()) return Vec3d{NAN, 0, 0};
  if constexpr (follows) {
    Vec3d other = others_[p];
    if (held_drag().cell > 0)
      other -= static_force(at.volume, p) + at.volume * flow_.fluid().density * gravity;
    if (!of.owed.empty()) other -= (1 / at.dt) * of.owed[p];
    return of.last_force[p] + other;
  }
  return of.last_force[p] - static_force(at.volume, p);
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
MomentumExchange<double> CoupledFlow<Drag, Mode, Forces...>::exchange_of(const CoupledParticles& of,
                                                                         const InFluid& at,
                                                                         std::size_t p) {
  const double K = coefficient(of, at, p);
  Vec3d push{0, 0, 0};
  double added = 0;
  const auto ask = [&](const auto& force) {
    using F = std::decay_t<decltype(force)>;
    if constexpr (pushes<F>) push += force.force_on(at);
    if constexpr (adds_mass<F>) added += force.added_mass(at);
  };
  std::apply([&](const auto&... force) { (ask(force), ...); }, forces_);
  if constexpr (follows) others_[p] = push;
  Vec3d Du{0, 0, 0};
  if constexpr (has_added_mass) Du = value(Du_at, p);
  if (!std::isfinite(at.mass)) return {K, -(push + added * Du)};
  const Vec3d others = static_force(at.volume, p) + push;
  Vec3d a = (1 / at.mass) * others;
  if (!of.acceleration.empty()) a += of.acceleration[p];
  const double all = at.mass + added, share = at.mass / all;
  a = share * a + (added / all) * Du;
  const auto e = momentum_exchange(all, K, at.dt, a);
  const Vec3d offset = share * e.offset - push - added * (Du - a);
  // (5): G (F' - F) joins the offset.
  const Vec3d F = last_exchange(of, at, p);
  if (std::isnan(F.x)) return {share * e.coefficient, offset};
  const double lag = K > 0 ? 1 - e.coefficient / K : 0;  // 1 - E/X
  const double G = share * (lag + added / at.mass) * (1 - at.voidage) / at.voidage;
  const double part = 1 / (1 + G);
  return {part * share * e.coefficient, part * (offset - G * F)};
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::spread_exchange(const CoupledParticles& of, std::size_t n,
                                                         double dt, const Team& team) {
  values_[b_at].resize(n);
  for (std::size_t p = 0; p < n; ++p) {
    const auto& e = exchange_[p];
    Vec3d push = e.coefficient * of.velocity[p] + e.offset;
    if constexpr (follows) {
      if (!of.owed.empty()) push -= (1 / dt) * of.owed[p];
      if (!of.owed.empty() && is_outside(p)) lost_ += of.owed[p];
    }
    values_[0][p] = push.x, values_[1][p] = push.y, values_[2][p] = push.z;
    values_[b_at][p] = e.coefficient;
  }
  Field* const to[] = {&flow_.drag_velocity(0), &flow_.drag_velocity(1), &flow_.drag_velocity(2),
                       &flow_.drag()};
  const std::span<const double> from[] = {values_[0], values_[1], values_[2], values_[b_at]};
  averaging_->spread(from, to, team);
  if (const auto* joined = flow_.joined_cells())
    for (Field* f : to) joined->spread(*f);
  const double over = 1 / flow_.grid().cell_volume();
  CellValues::for_rows(flow_, team, [&](int j, int k) {
    const double* const open = flow_.open_row(j, k);
    for (Field* f : to) {
      double* const row = f->row(j, k);
      for (int i = 0; i < flow_.grid().nx(); ++i)
        row[i] *= over / fluid_detail::fluid_share(open, i);
    }
  });
}

template <class Drag, AveragingMode Mode, FluidForce... Forces>
void CoupledFlow<Drag, Mode, Forces...>::make_averaging(const CoupledParticles& of,
                                                        const Team& team) {
  if (of.velocity.empty()) return;
  if (!averaging_) {
    if (!diameter) diameter = 2 * *std::max_element(of.shape.radius.begin(), of.shape.radius.end());
    averaging_.emplace(mode_, flow_.grid(), *diameter);
  } else if (opened_ == flow_.boundaries()) {
    return;
  }
  if (const Field* open = flow_.open_cells()) averaging_->open(*open, team);
  opened_ = flow_.boundaries();
}

}  // namespace silt
