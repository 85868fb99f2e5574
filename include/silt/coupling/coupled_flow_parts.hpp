// silt - BSD-3-Clause, see LICENSE
#pragma once

// Part of CoupledFlow: exchange between particles and cells in a fluid step.

#include <limits>

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/coupled_flow.hpp>

namespace silt::inline SILT_TARGET {

/// Spreads the volume of the particles that have left since the last step, each on the side if its
/// place is outside the grid.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::spread_left(const CoupledParticles& of,
                                                                const Team& team) {
  emptied_.reset();
  const AveragedParticles& present = of.shape;
  const std::size_t earlier = left_.size() / of_left, n = earlier + of.taken_out.size();
  if (n == 0) return;
  DynArray<Vec3d> position(n);
  DynArray<double> radius(n), volume(n);
  DynArray<Quaternion> orientation(n);
  DynArray<std::uint32_t> form(n);
  for (std::size_t p = 0; p < n; ++p) {
    if (p < earlier) {
      const double* const l = &left_[p * of_left];
      position[p] = {l[0], l[1], l[2]}, radius[p] = l[3], volume[p] = l[4];
      orientation[p] = {l[5], l[6], l[7], l[8]}, form[p] = static_cast<std::uint32_t>(l[9]);
    } else {
      const LeftParticle& l = of.taken_out[p - earlier];
      position[p] = l.position, radius[p] = l.radius, volume[p] = l.volume;
      orientation[p] = l.orientation, form[p] = l.form;
    }
    position[p] = at_the_side(position[p], std::numeric_limits<double>::infinity());
    // Forms of fragments are given up with their last owner; the volume counts.
    if (form[p] >= present.forms.size()) form[p] = 0;
  }
  AveragedParticles shape{position, radius};
  if (!present.forms.empty())
    shape.orientation = orientation, shape.form = form, shape.forms = present.forms;
  averaging_->place(shape, team);
  CellField* const to[] = {&emptied_.emplace(flow_.grid())};
  const std::span<const double> volumes[] = {volume};
  averaging_->spread(volumes, to, team);
  if (const auto* joined = flow_.joined_cells()) joined->spread(*emptied_);
}

/// Turns `more` [m3], the volume put into each cell since the last step, into the change of the
/// solids that the fluid sees: clipped at the minimum void fraction, with what has left.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::find_change(CellField& more,
                                                                const Team& team) const {
  const Grid& g = flow_.grid();
  CellValues::for_rows(flow_, team, [&](int j, int k) {
    const double* const s = solids_.row(j, k);
    const double* const gone = emptied_ ? emptied_->row(j, k) : nullptr;
    double* const change = more.row(j, k);
    const double* const open = flow_.open_row(j, k);
    for (int i = 0; i < g.nx(); ++i) {
      const double most =
          (1 - least_voidage) * g.cell_volume() * fluid_detail::fluid_share(open, i);
      const double before = s[i] - change[i] + (gone ? gone[i] : 0);
      change[i] = std::min(s[i], most) - std::min(std::max(before, 0.0), most);
    }
  });
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::spread_volume(const CoupledParticles& of,
                                                                  CoupledStep& done,
                                                                  const Team& team) {
  CellField* const to[] = {&solids_};
  const std::span<const double> volume[] = {of.volume};
  averaging_->spread(volume, to, team);
  if (const auto* joined = flow_.joined_cells()) joined->spread(solids_);
  const Grid& g = flow_.grid();
  change_.reset();
  if constexpr (requires { flow_.put_in(solids_, least_voidage, team); })
    if (!of.put_in.empty() || emptied_) {
      CellField* const there[] = {&change_.emplace(g)};
      const std::span<const double> volumes[] = {of.put_in};
      if (!of.put_in.empty()) averaging_->spread(volumes, there, team);
      if (const auto* joined = flow_.joined_cells()) joined->spread(*change_);
      find_change(*change_, team);
    }
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

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::gather(std::size_t n, const Team& team,
                                                           bool all) {
  constexpr std::size_t most = 22;  // velocity, slope, stress, voidage, curl, strain, convection
  std::array<const CellField*, most> from;
  std::array<std::span<double>, most> to;
  std::size_t count = 0;
  const auto take = [&](CellField& field, ParticleColumn& column) {
    join(field);
    column.resize(n);
    from[count] = &field, to[count++] = column;
  };
  const auto take3 = [&](auto& fields, ParticleColumns& columns) {
    for (std::size_t d = 0; d < 3; ++d) take(fields[d], columns[d]);
  };
  FluidAtParticles& at = exchange_.at;
  take3(cells_.velocity, at.velocity);
  if (in_pressure()) take3(cells_.slope, at.slope), take3(cells_.stress, at.stress);
  if (all) take(flow_.voidage(), at.voidage);
  if constexpr (needs_curl)
    if (all) take3(cells_.curl, at.curl);
  if constexpr (needs_strain)
    if (all) take3(cells_.stretch, at.stretch), take3(cells_.strain, at.strain);
  if constexpr (has_added_mass)
    if (all) take3(cells_.convection, at.convection);
  averaging_->gather(ConstCellFields(from.data(), count), GatheredValues(to.data(), count), team);
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::spread_exchange(const CoupledParticles& of,
                                                                    double dt, const Team& team) {
  exchange_.give(of, dt, true);
  const bool moves = exchange_.moves(), bears = exchange_.bears();
  if (moves || bears || flow_.responds())
    flow_.response().moves = moves, flow_.response().bears = bears;
  std::array<CellField*, 10> to;
  std::array<std::span<const double>, 10> from;
  std::size_t count = 0;
  const auto take = [&](CellField& field, const ParticleColumn& column) {
    from[count] = column, to[count++] = &field;
  };
  const GivenToFluid& given = exchange_.given;
  if (moves) {
    ParticleResponse* const answer = &flow_.response();
    take(answer->with_fluid, given.with_fluid), take(answer->with_pressure, given.with_pressure);
    for (std::size_t d = 0; d < 3; ++d) take(answer->flux[d], given.flux[d]);
  }
  for (int d = 0; d < 3; ++d)
    take(flow_.drag_velocity(d), given.offset[static_cast<std::size_t>(d)]);
  take(flow_.drag(), given.coefficient);
  if (bears) take(flow_.response().borne, given.borne);
  averaging_->spread(Quantities(from.data(), count), CellFields(to.data(), count), team);
  share_out(CellFields(to.data(), count), team);
}

/// Converts distributed sums to densities per fluid volume of the cells.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::share_out(CellFields fields, const Team& team) {
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

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::make_averaging(const CoupledParticles& of,
                                                                   const Team& team) {
  if (of.velocity.empty() && !diameter) return;
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
