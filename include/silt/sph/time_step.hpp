// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>

#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/growth_sums.hpp>
#include <silt/sph/ledger.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/solid_sums.hpp>
#include <silt/sph/volume.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Advances an SphCore by dt [s]: liquid, walls with their own densities, bodies. The rates are
/// those of the start.
template <class Core>
class SphStep {
  using Row = SphRow;
  using Lists = typename Core::Lists;

 public:
  SphStep(Core& core, double dt, const Team& team) : core_(core), dt_(dt), team_(team) {}

  void symplectic() {
    for_liquid([this](std::size_t k, Row& r, Row& start, const SphRates& rate) {
      start = r;
      r.place(r.position() + 0.5 * dt_ * r.velocity());
      r.move(r.velocity() + 0.5 * dt_ * rate.acceleration);
      const double parting =
          parted(r.density, rate.density, core_.columns.growth[k].parting, 0.5 * dt_);
      r.density = held(r.density + 0.5 * dt_ * (rate.density + parting), rate, 0);
    });
    for_walls([this](std::size_t k, Row& r, Row& start, double rate) {
      start.density = r.density;
      r.density += 0.5 * dt_ * (rate + core_.columns.growth[k].parting);
    });
    find_middle();
    size_book(), part(dt_, [](const Row&, const Row& start) { return start.density; });
    sph_book_middle(core_, dt_, team_);
    for_liquid([this](std::size_t k, Row& r, const Row& start, const SphRates& rate) {
      const Vec3d v = pushed(k, start.velocity() + dt_ * rate.acceleration);
      r.place(start.position() + 0.5 * dt_ * (start.velocity() + v) + shift_of(rate, norm(v)));
      r.move(v), finish(k, r, start.density, grown(start.density, rate.density, r.density), dt_);
    });
    for_walls([this](std::size_t, Row& r, const Row& start, double rate) {
      r.density = grown(start.density, rate, r.density);
    });
    finish();
  }

  void leapfrog() {
    auto& growth = core_.columns.growth;
    for_liquid([&](std::size_t k, Row& r, Row& start, const SphRates&) {
      start = r;
      const auto& [rate, parting] = growth[k];
      r.place(r.position() + 0.5 * dt_ * r.velocity());
      r.density += 0.5 * dt_ * (rate + parted(r.density, rate, parting, 0.5 * dt_));
    });
    for_walls([&](std::size_t k, Row& r, Row& start, double) {
      start.density = r.density, r.density += 0.5 * dt_ * (growth[k].density + growth[k].parting);
    });
    find_middle();
    sph_note_velocities(core_);
    for_liquid([this](std::size_t k, Row& r, const Row&, const SphRates& rate) {
      r.move(pushed(k, r.velocity() + dt_ * rate.acceleration));
    });
    size_book(), sph_find_growth(core_, dt_, team_);
    sph_book_middle(core_, dt_, team_);
    for_liquid([&](std::size_t k, Row& r, const Row& start, const SphRates& rate) {
      r.place(r.position() + 0.5 * dt_ * r.velocity() + shift_of(rate, norm(r.velocity())));
      finish(k, r, start.density, grown(start.density, rate.density, r.density), dt_);
      core_.keep_growth(k);
    });
    for_walls([&](std::size_t, Row& r, const Row& start, double rate) {
      r.density = grown(start.density, rate, r.density);
    });
    finish();
  }

  void verlet() {
    const bool restart = core_.steps % core_.scheme.restart == 0;
    const double span = restart ? dt_ : dt_ + core_.last_step;
    sph_body_loads(core_, team_);
    part(span, [&](const Row& r, const Row& start) { return restart ? r.density : start.density; });
    sph_book_start(core_, dt_, team_);
    for_liquid([&](std::size_t k, Row& r, Row& start, const SphRates& rate) {
      const Row from = restart ? r : start;
      start = r;
      const Vec3d v = r.velocity(), &a = rate.acceleration;
      r.place(r.position() + dt_ * v + 0.5 * dt_ * dt_ * a + shift_of(rate, norm(v)));
      r.move(from.velocity() + span * a);
      finish(k, r, from.density, from.density + span * rate.density, span);
    });
    for_walls([&](std::size_t, Row& r, Row& start, double rate) {
      const double from = restart ? r.density : start.density;
      start.density = r.density, r.density = from + span * rate;
    });
    book_shifts(core_.columns.start), sph_book_tension(core_, dt_ / span);
    core_.openings.move(core_.columns, dt_, true);
    move_solids(dt_);
  }

 private:
  static constexpr bool averaged = Core::Grains::averaged;
  static constexpr double longest_shift = 0.05;  // [-] of the spacing

  /// Adds what parting from solids takes from densities from(row, its start) within `span` [s].
  template <class From>
  void part(double span, const From& from) {
    const auto& growth = core_.columns.growth;
    for_liquid([&](std::size_t k, Row& r, Row& start, const SphRates&) {
      core_.part(k, from(r, start), growth[k].parting, span);
    });
    if constexpr (!Core::Walls::mirrored)
      for (std::size_t k = core_.lists.first_pack(Lists::Wall) * Core::Pairs::W; k < growth.size();
           ++k)
        core_.columns.rates[k].density += growth[k].parting;
  }
  double parted(double from, double rate, double parting, double span) const {
    return sph_parting(from, rate, parting, core_.liquid.density, span);
  }
  void size_book() {
    if constexpr (Core::Book::kept) sph_size_book(core_);
  }
  /// [m/s] A new velocity, after drag and push of unresolved grains.
  Vec3d pushed([[maybe_unused]] std::size_t k, const Vec3d& v) const {
    if constexpr (averaged) {
      const double over = dt_ / core_.mass_of(k);
      return (1 / (1 + over * core_.grains.coefficient[k])) * (v + over * core_.grains.push[k]);
    }
    return v;
  }
  /// [kg/m3] after a step, by the rate and the density in its middle.
  double grown(double start, double rate, double middle) const {
    const double eps = -dt_ * rate / middle;
    return start * (2 - eps) / (2 + eps);
  }
  /// Moves all but the liquid to the middle of the step; rates there.
  void find_middle() {
    core_.openings.move(core_.columns, 0.5 * dt_, true);
    core_.now = core_.time + 0.5 * dt_, core_.known = false;
    move_solids(0.5 * dt_);
    core_.find_rates(team_), sph_body_loads(core_, team_);
    if constexpr (averaged)
      core_.grains.find(core_.columns, {core_.liquid.density, core_.grains.settings.viscosity},
                        core_.gravity, dt_, team_);
  }
  /// The second half of all but the liquid, after it.
  void finish() {
    core_.openings.move(core_.columns, 0.5 * dt_, false);
    if constexpr (averaged) core_.grains.give_back(core_.columns, team_);
    book_shifts(core_.columns.rows), sph_book_tension(core_);
    if constexpr (averaged) sph_book_grains(core_, dt_);
    move_solids(0.5 * dt_);
  }
  /// Removes tension at a particle with few neighbours, and pressure in spray.
  ///
  /// Tension: the density of such a particle depends only on its few neighbours and would drift, in
  /// spray below zero. Applied where div r is below 0.4 of its value inside; a flat surface has
  /// more than half. Pressure: see sph_spray_loss (volume.hpp). It acts over `span` [s], once a
  /// step and at its end, where the energy ledger accounts for it.
  ///
  /// Both need the fullness of the kernel, which is known with shifting, UnresolvedGrains or
  /// RestoredVolume.
  double held(double density, [[maybe_unused]] const SphRates& rate,
              [[maybe_unused]] double span) const {
    if constexpr (Core::Shift::shifts || Core::asks_fullness) {
      const double rest = core_.liquid.density;
      if (core_.is_loose(rate)) density = std::max(density, rest);
      if (density > rest && rate.divergence < 0.7 * core_.full)
        density = std::max(
            density * (1 - span * sph_spray_loss(rate.slope, rate.divergence / core_.full,
                                                 core_.setup.h(), core_.liquid.sound_speed)),
            rest);
    }
    return density;
  }
  /// Gives the particle of row k, with the state that the forces had, its density after `span` [s].
  void finish(std::size_t k, Row& r, [[maybe_unused]] double start, double density, double span) {
    const SphRates& rate = core_.columns.rates[k];
    if constexpr (Core::Book::kept) {
      core_.book.unheld[k] = density;
      core_.book.worked[k] = core_.liquid.elastic_energy(start) +
                             r.pressure / (r.density * r.density) * span * rate.density;
    }
    r.density = held(density, rate, span);
  }
  /// update(row, its particle, its state at the start, rates) for each liquid particle.
  template <class Update>
  void for_liquid(const Update& update) {
    auto& of = core_.columns;
    const std::size_t n = core_.lists.first_pack(Lists::Wall) * Core::Pairs::W;
    team_.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k)
        if (of.label[k] < SphColumns::of_openings) update(k, of.rows[k], of.start[k], of.rates[k]);
    });
  }
  /// Densities of walls and bodies that have their own.
  template <class Update>
  void for_walls(const Update& update) {
    if constexpr (!Core::Walls::mirrored) {
      auto& of = core_.columns;
      const std::size_t first = core_.lists.first_pack(Lists::Wall) * Core::Pairs::W,
                        n = core_.lists.first_pack(Lists::Probe) * Core::Pairs::W - first;
      team_.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
        for (std::size_t k = first + from; k < first + to; ++k) {
          if (of.label[k] == Lists::none) continue;
          update(k, of.rows[k], of.start[k], of.rates[k].density);
          of.rows[k].density = std::max(of.rows[k].density, core_.liquid.density);
        }
      });
    }
  }
  void move_solids(double dt) {
    core_.solids.bodies.move(dt);
    if constexpr (averaged) core_.grains.move(dt);
  }
  Vec3d shift_of([[maybe_unused]] const SphRates& rate, [[maybe_unused]] double speed) const {
    if constexpr (Core::Shift::shifts) {
      const SphSetup& setup = core_.setup;
      const double full = setup.dimensions, none = core_.shift.threshold_in(setup.dimensions);
      const double share = std::clamp((rate.divergence - none) / (full - none), 0.0, 1.0);
      const double steep = setup.h() * norm(rate.slope), filled = rate.divergence / core_.full;
      double uneven = steep - core_.surface_slope(filled);
      if constexpr (Core::Shift::by_fastest)
        speed = core_.most.speed, uneven = steep - core_.surface_slope.beyond_inside(filled);
      if (!(uneven > 0)) return {0, 0, 0};
      const double length = std::min(core_.shift.strength * speed * dt_ * share * uneven,
                                     longest_shift * setup.spacing);
      return (-length * setup.h() / steep) * rate.slope;
    }
    return {0, 0, 0};
  }
  /// Counts the shifts with the speeds of these rows.
  void book_shifts([[maybe_unused]] const AlignedVector<Row>& of) {
    if constexpr (Core::Book::kept)
      sph_book_shifts(core_, [&](std::size_t k) {
        return shift_of(core_.columns.rates[k], norm(of[k].velocity()));
      });
  }

  Core& core_;
  const double dt_;
  const Team& team_;
};

}  // namespace silt::detail
