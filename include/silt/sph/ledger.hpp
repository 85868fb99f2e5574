// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/ledger_sums.hpp>

namespace silt::inline SILT_TARGET {

/// Energy balance of an Sph with an EnergyLedger since its first step [J]; [J/m] in 2D.
struct LiquidBalance {
  // Present.
  double kinetic, gravity;  // - m g x, relative to the origin
  double elastic;           // compression: m times the integral of P/rho^2 from rho_0 on
  // Dissipated since the start.
  double artificial, laminar, turbulent;  // by viscosities, including walls and bodies
  double diffusion;                       // diffusion of density: from `elastic`; may be < 0
  double restored;                        // RestoredVolume: from `elastic`; may be < 0
  double shifting;                        // from `gravity`; may be < 0
  double tension;  // from `elastic`: tension removed at particles with few neighbours, pressure of
                   // spray
  double displaced;  // with particles displaced by bodies or walls
  // Supplied since the start.
  double walls;                // work of walls that move, rotate, or are belts
  double bodies;               // work of bodies in the liquid, which they lose
  double at_walls, at_bodies;  // in addition, by pressures and velocities that their particles
                               // take from the liquid at their mirror images; with DynamicWalls:
                               // by their own densities
  double grains;               // by UnresolvedGrains: drag, pressure and changes of their void
                               // fraction
  double openings;             // with particles that entered, minus those that left
  double changed_gravity;      // by new values of `gravity`
  double going_round;  // by gravity, of particles that left a periodic region and entered it again
  double initial;      // energy at the first step

  double held() const { return kinetic + gravity + elastic; }
  double mirrored() const { return at_walls + at_bodies; }
  double viscosity() const { return artificial + laminar + turbulent; }
  double dissipated() const {
    return viscosity() + diffusion + restored + shifting + tension + displaced;
  }
  double supplied() const {
    return walls + bodies + mirrored() + grains + openings + changed_gravity + going_round;
  }
  /// Closure error: the error of time integration, second order in the step. With Mixed also
  /// rounding of floats, some 1e-6 of the exchanged energies.
  double residual() const { return held() + dissipated() - supplied() - initial; }
};

namespace detail {

/// Ledger of an Sph without an EnergyLedger: empty.
struct NoSphBook {
  static constexpr bool kept = false;
};
struct SphBook {
  static constexpr bool kept = true;
  struct Numbers {
    SphPowers worked;       // [J] since the start
    SphPowers power, last;  // [W] of the last evaluation, and of the one before (VerletTime)
    double last_step = 0;   // [s] between the two
    double shifting = 0, tension = 0, displaced = 0, openings = 0, changed_gravity = 0,
           going_round = 0;
    double initial = 0, started = 0;
    Vec3d gravity{0, 0, 0};  // [m/s2] used by the ledger
  } now;
  DynArray<double> unheld;  // [kg/m3] densities of rows before removal of tension
  DynArray<double> worked;  // [J/kg] elastic energy of rows at the start, and the work of pressures
  DynArray<double> parted;  // [-] share of SphGrowth::parting that acted on a row
  // [m/s] LeapfrogTime: `sticking` of SphColumns with the velocities at the start of the step.
  AlignedVector<Vec3d> stuck;

  bool started() const { return now.started != 0; }
  using State = std::array<double, sizeof(Numbers) / sizeof(double)>;
  State state() const { return std::bit_cast<State>(now); }
  void restore(const DynArray<double>& all) {
    State s;
    require(all.size() == s.size(), "Sph: a state's ledger has ", all.size(), " numbers for ",
            s.size());
    std::copy(all.begin(), all.end(), s.begin());
    now = std::bit_cast<Numbers>(s);
  }
};
template <bool kept>
using SphBookOf = std::conditional_t<kept, SphBook, NoSphBook>;

/// Entries into the ledger of an SphCore; without a ledger all do nothing.
/// @{

/// [J] of a liquid particle in row k with the state `row`.
template <class Core>
double sph_energy(const Core& core, std::size_t k, const SphRow& row) {
  const Vec3d v = row.velocity();
  return core.mass_of(k) * (0.5 * dot(v, v) - dot(core.gravity, row.position()) +
                            core.liquid.elastic_energy(row.density));
}
template <class Core>
LiquidBalance sph_held(const Core& core) {
  LiquidBalance e{};
  for (std::size_t k = 0; k < core.columns.size(); ++k) {
    if (!core.columns.is_liquid(k)) continue;
    const SphRow& r = core.columns.rows[k];
    const double m = core.mass_of(k);
    e.kinetic += 0.5 * m * dot(r.velocity(), r.velocity());
    e.gravity -= m * dot(core.gravity, r.position());
    e.elastic += m * core.liquid.elastic_energy(r.density);
  }
  return e;
}
template <class Core>
LiquidBalance sph_balance(const Core& core) {
  LiquidBalance e = sph_held(core);
  const auto& n = core.book.now;
  e.artificial = -n.worked.artificial, e.laminar = -n.worked.laminar;
  e.turbulent = -n.worked.turbulent, e.diffusion = -n.worked.diffusion;
  e.restored = -n.worked.restored;
  e.walls = n.worked.walls, e.bodies = n.worked.bodies;
  e.at_walls = n.worked.at_walls, e.at_bodies = n.worked.at_bodies;
  e.grains = n.worked.grains, e.shifting = n.shifting, e.tension = n.tension,
  e.displaced = n.displaced;
  e.openings = n.openings, e.changed_gravity = n.changed_gravity, e.going_round = n.going_round;
  e.initial = n.started != 0 ? n.initial : e.held();
  return e;
}
/// Before rates are computed: gravity may have changed.
template <class Core>
void sph_follow_gravity(Core& core) {
  if constexpr (Core::Book::kept) {
    auto& n = core.book.now;
    const Vec3d more = core.gravity - n.gravity;
    if (core.book.started() && dot(more, more) > 0)
      for (std::size_t k = 0; k < core.columns.size(); ++k)
        if (core.columns.is_liquid(k))
          n.changed_gravity -= core.mass_of(k) * dot(more, core.columns.rows[k].position());
    n.gravity = core.gravity;
  }
}
/// The liquid particle of row k enters.
template <class Core>
void sph_comes(Core& core, std::size_t k) {
  if constexpr (Core::Book::kept)
    if (core.book.started()) core.book.now.openings += sph_energy(core, k, core.columns.rows[k]);
}
/// The liquid particle of row k is about to be removed. During a step the ledger contains its state
/// at the start of the step.
template <class Core>
void sph_goes(Core& core, std::size_t k, bool displaced) {
  if constexpr (Core::Book::kept) {
    if (!core.book.started()) return;
    const bool middle = core.now > core.time;
    const double energy =
        sph_energy(core, k, middle ? core.columns.start[k] : core.columns.rows[k]);
    (displaced ? core.book.now.displaced : core.book.now.openings) += displaced ? energy : -energy;
  }
}
/// The liquid particle of row k, which has gone as displaced, is back at another place.
template <class Core>
void sph_returns(Core& core, std::size_t k) {
  if constexpr (Core::Book::kept)
    if (core.book.started())
      core.book.now.displaced -=
          sph_energy(core, k, core.now > core.time ? core.columns.start[k] : core.columns.rows[k]);
}
/// The liquid particle of row k moves by `way` to another periodic image.
template <class Core>
void sph_goes_round(Core& core, std::size_t k, const Vec3d& way) {
  if constexpr (Core::Book::kept)
    if (core.book.started() && dot(way, way) > 0)
      core.book.now.going_round -= core.mass_of(k) * dot(core.gravity, way);
}
/// [J] of compression, at the start of the current step.
template <class Core>
double sph_elastic(const Core& core) {
  double sum = 0;
  const bool middle = core.now > core.time;
  for (std::size_t k = 0; k < core.columns.size(); ++k)
    if (core.columns.is_liquid(k))
      sum += core.mass_of(k) * core.liquid.elastic_energy(middle ? core.columns.start[k].density
                                                                 : core.columns.rows[k].density);
  return sum;
}
/// LeapfrogTime: keeps the velocities of walls and bodies with which the forces were computed.
template <class Core>
void sph_note_velocities(Core& core) {
  if constexpr (Core::Book::kept) {
    auto& of = core.columns;
    for (std::size_t k = core.lists.first_pack(Core::Lists::Wall) * Core::Pairs::W; k < of.size();
         ++k)
      of.start[k].move(of.rows[k].velocity());
    core.book.stuck = of.sticking;
  }
}
/// [m/s] Part of the velocity of a solid's row that only friction uses, mean over the step.
template <class Core>
Vec3d sph_sticking(const Core& core, std::size_t row) {
  const auto& now = core.columns.sticking;
  if (now.empty()) return {0, 0, 0};
  if constexpr (Core::Time::leaps) return 0.5 * (now[row] + core.book.stuck[row]);
  return now[row];
}
/// [W] with the rates just computed.
template <class Core>
SphPowers sph_powers(Core& core, const Team& team) {
  using Sums =
      SphPowerSums<typename Core::Kernel, typename Core::Viscosity, typename Core::Diffusion>;
  using Lists = typename Core::Lists;
  constexpr std::size_t W = Core::Pairs::W, per = 16;
  auto& of = core.columns;
  const std::size_t packs = core.lists.first_pack(Lists::Wall), first = packs * W;
  // LeapfrogTime has the velocities of the end in `rows`, and those of the start in `start`.
  const auto& then = Core::Time::leaps ? of.start : of.rows;
  const auto velocity = [&](std::size_t k) {
    return 0.5 * (of.rows[k].velocity() + then[k].velocity());
  };
  DynArray<typename Sums::Surface> surfaces(of.size() - first);
  for (std::size_t k = 0; k < core.solids.size(); ++k) {
    if (!core.solids.has_row(k)) continue;
    const std::size_t row = core.solids.wall_row[k];
    surfaces[row - first] = {core.solids.own_velocity(k), sph_sticking(core, row),
                             core.solids.is_wall(k) ? 0.0 : 1.0, of.beside().may_pull(row)};
  }
  const Sums sums(core.constants(), core.viscosity, core.diffusion);
  DynArray<SphPowers> parts((packs + per - 1) / per);
  team.for_parts(parts.size(), [&](std::size_t part) {
    for (std::size_t p = part * per; p < std::min(packs, (part + 1) * per); ++p)
      sums.add(
          p, W, of.rows, then, of.volume, core.book.parted, of.viscosity, surfaces, first,
          core.lists, [&](std::size_t k) { return core.mass_of(k); }, parts[part]);
  });
  SphPowers all;
  for (const SphPowers& p : parts) all.add(1, p);
  if constexpr (Core::turbulent) {
    const auto sps = core.sps();
    AlignedVector<SphRates> by(of.size());
    const std::size_t solid = core.lists.first_pack(Lists::Probe);
    team.for_ranges(
        solid, Lists::packs_a_range, [&](std::size_t, std::size_t from, std::size_t to) {
          for (std::size_t p = from; p < to; ++p)
            sps.accelerate(p, W, of.rows, of.volume, of.stress, core.lists, by, p < packs);
        });
    for (std::size_t k = 0; k < first; ++k)
      if (of.label[k] != Lists::none)
        all.turbulent += core.mass_of(k) * dot(velocity(k), by[k].acceleration);
    for (std::size_t k = 0; k < core.solids.size(); ++k) {
      if (!core.solids.has_row(k)) continue;
      const std::size_t row = core.solids.wall_row[k];
      const double work = -core.solids.share(k) * core.particle_mass() *
                          dot(surfaces[row - first].velocity, by[row].acceleration);
      (core.solids.is_wall(k) ? all.walls : all.bodies) += work, all.turbulent -= work;
    }
  }
  if constexpr (Core::Volume::restores) {
    for (std::size_t k = 0; k < first; ++k)
      if (of.is_liquid(k))
        all.restored +=
            core.mass_of(k) * of.rows[k].pressure / of.rows[k].density * core.restoring(k);
  }
  if constexpr (Core::Grains::averaged) {
    // Rest of the power of all pairs: the volume taken by grains.
    double pairs = 0;
    for (std::size_t k = 0; k < first; ++k) {
      if (of.label[k] == Lists::none) continue;
      const SphRow& r = of.rows[k];
      pairs += core.mass_of(k) * (dot(velocity(k), of.rates[k].acceleration - core.gravity) +
                                  r.pressure / (r.density * r.density) * of.rates[k].density);
    }
    all.grains = pairs - all.sum();
  }
  return all;
}
/// When rows may have been rearranged.
template <class Core>
void sph_size_book(Core& core) {
  core.book.unheld.assign(core.columns.size(), core.liquid.density);
  core.book.worked.assign(core.columns.size(), 0);
  core.book.parted.assign(core.columns.size(), 1);
}
/// Before a step; the first one starts the ledger.
template <class Core>
void sph_begin_book(Core& core) {
  if constexpr (Core::Book::kept) {
    auto& n = core.book.now;
    if (core.book.started()) return;
    n.started = 1, n.gravity = core.gravity, n.initial = sph_held(core).held();
  }
}
/// Powers at the middle of a step of dt [s].
template <class Core>
void sph_book_middle(Core& core, double dt, const Team& team) {
  if constexpr (Core::Book::kept) {
    core.book.now.worked.add(dt, sph_powers(core, team));
  }
}
/// Powers at its start and before it: second order (Adams-Bashforth).
template <class Core>
void sph_book_start(Core& core, double dt, const Team& team) {
  if constexpr (Core::Book::kept) {
    auto& n = core.book.now;
    n.last = n.power, n.power = sph_powers(core, team);
    const double more = n.last_step > 0 ? 0.5 * dt / n.last_step : 0;
    n.worked.add(dt * (1 + more), n.power), n.worked.add(-dt * more, n.last);
    n.last_step = dt;
  }
}
/// set() changes void fractions and thus densities.
template <class Core, class Set>
void sph_book_voidage(Core& core, const Set& set) {
  if constexpr (Core::Book::kept) {
    const double before = core.book.started() ? sph_elastic(core) : 0;
    set();
    if (core.book.started()) core.book.now.worked.grains += sph_elastic(core) - before;
  } else {
    set();
  }
}
/// Work of grains on velocities in a step of dt [s], after it.
template <class Core>
void sph_book_grains(Core& core, double dt) {
  if constexpr (Core::Book::kept) {
    auto& of = core.columns;
    for (std::size_t k = 0; k < of.size(); ++k) {
      if (!of.is_liquid(k)) continue;
      const Vec3d without = of.start[k].velocity() + dt * of.rates[k].acceleration,
                  with = of.rows[k].velocity(), more = with - without;
      core.book.now.worked.grains +=
          core.mass_of(k) * dot(more, 0.5 * (with + without) - 0.5 * dt * core.gravity);
    }
  }
}
/// After a step: energy lost by removal of tension and by the pressure that spray gives up, which
/// is what a particle held and what pressure did on it, less what it holds. `share` [-] of the time
/// over which a density was integrated that belongs to this step: a leap of VerletTime takes two
/// steps, and every second step is on the other of two chains.
template <class Core>
void sph_book_tension(Core& core, double share = 1) {
  if constexpr (Core::Book::kept) {
    auto& of = core.columns;
    for (std::size_t k = 0; k < of.size(); ++k)
      if (of.is_liquid(k) && core.book.unheld[k] != of.rows[k].density)
        core.book.now.tension +=
            share * core.mass_of(k) *
            (core.book.worked[k] - core.liquid.elastic_energy(of.rows[k].density));
  }
}
/// shift_of(k) [m]: displacement of a particle by shifting.
template <class Core, class ShiftOf>
void sph_book_shifts(Core& core, const ShiftOf& shift_of) {
  if constexpr (Core::Book::kept && Core::Shift::shifts)
    for (std::size_t k = 0; k < core.columns.size(); ++k)
      if (core.columns.is_liquid(k))
        core.book.now.shifting += core.mass_of(k) * dot(core.gravity, shift_of(k));
}
/// @}

}  // namespace detail
}  // namespace silt
