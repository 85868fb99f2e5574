// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/columns.hpp>
#include <silt/sph/driven_walls.hpp>
#include <silt/sph/dry_gaps.hpp>
#include <silt/sph/growth_sums.hpp>
#include <silt/sph/herschel_bulkley.hpp>
#include <silt/sph/lattice_sites.hpp>
#include <silt/sph/ledger.hpp>
#include <silt/sph/liquid_check.hpp>
#include <silt/sph/opening_sums.hpp>
#include <silt/sph/openings.hpp>
#include <silt/sph/pair_sums.hpp>
#include <silt/sph/policies.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/solid_sums.hpp>
#include <silt/sph/solids.hpp>
#include <silt/sph/start_check.hpp>
#include <silt/sph/surface_slope.hpp>
#include <silt/sph/time_step.hpp>
#include <silt/sph/turbulence.hpp>
#include <silt/sph/upkeep.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Core of an Sph: particles, solids, lists, and the time step. `Axes` has the policies.
///
///   find_rates()   lists, pressures, walls and sums over pairs, at the present positions
///   step()         one step by the policy of time integration
template <class Axes>
struct SphCore {
  using Kernel = typename Axes::Kernel;
  using Viscosity = typename Axes::Viscosity;
  using Diffusion = typename Axes::Diffusion;
  using Shift = typename Axes::Shift;
  using Time = typename Axes::Time;
  using Walls = typename Axes::Walls;
  using Grains = typename Axes::Grains;
  using Book = SphBookOf<Axes::ledger>;
  using Volume = typename Axes::Volume;
  // Unresolved grains and volume restoration need the fullness of kernels, as shifting does.
  static constexpr bool asks_fullness = Grains::averaged || Volume::restores;
  using Pairs =
      SphPairs<Kernel, Viscosity, Diffusion, std::conditional_t<asks_fullness, Shifting, Shift>,
               typename Axes::PairScalar, Grains::averaged>;
  static constexpr bool turbulent = requires { requires Viscosity::turbulent; };
  using Lists = ClusterLists;
  using Row = SphRow;
  struct Always {
    bool operator()(std::size_t) const { return true; }
  };

  Liquid liquid;
  SphSetup setup;
  Viscosity viscosity;
  Diffusion diffusion;
  Shift shift;
  Time scheme;
  Walls walls;
  typename Grains::State grains;
  Volume keeper;
  Vec3d gravity = setup.gravity;                   // [m/s2]
  double least_density = 0.7, most_density = 1.3;  // [-] of the liquid's

  SphSurfaceSlope<Kernel> surface_slope{};
  SphSolids solids{};
  SphOpenings openings{};
  DryGaps<Kernel> gaps{};
  // Loads on walls of a Simulation: constant until the next advance(), and of the last step.
  DynArray<LiquidOnWall> on_walls{}, in_step{};
  Lists lists{};
  SphColumns columns{};
  NearLiquid near{};
  DynArray<double> slack{};  // [m] of each row, for the lists
  struct Extremes {
    double pair = 0, acceleration = 0, speed = 0;  // [m/s], [m/s2], [m/s]
  } most{};
  std::uint32_t next_number = 0;
  std::size_t left = 0, displaced = 0;
  double time = 0, now = 0, last_step = 0;  // [s] now: of the rates
  double full = 0;                          // [-] div r of a lattice
  double moment = 0;                        // [-] second moment of the kernel over h^2
  double exchange = INFINITY;               // [s] sph_longest_exchange() of the last step
  std::int64_t steps = 0;
  bool stale = true;   // lists must be rebuilt
  bool fresh = true;   // lists are new: rows of solids have no values yet
  bool known = false;  // rates are those of the present state
  bool made = false;   // solids are in the columns
  bool begun = false;  // with LeapfrogTime: growth and extremes of an earlier step are known
  [[no_unique_address]] Book book{};
  struct {
    double radius = 0, mass = 0, of_disc = 0;  // [m], [kg]
  } disc{};                                    // first sphere in 2D that has not the mass of a disc
  DynArray<std::size_t> resolved{};            // particles that are bodies in the liquid
  DynArray<ParticleId> body_ids{};             // of these

  void begin() {
    liquid.check(), setup.check(), viscosity.check(), diffusion.check(), shift.check(),
        scheme.check(), keeper.check();
    require(Walls::mirrored || !setup.slip,
            "SphSetup.slip has no effect with DynamicWalls; leave it out, or use MirroredWalls");
    choose_courant();
    full = sph_divergence_of_lattice<Kernel>(setup);
    moment = sph_second_moment<Kernel>(setup.dimensions);
    if constexpr (Shift::shifts || Volume::restores)
      surface_slope = SphSurfaceSlope<Kernel>(setup.dimensions);
    if constexpr (!Time::two_stages) check_verlet();
    static_assert(Pairs::W <= Lists::most_width);
    lists.width = Pairs::W, lists.spacing = setup.spacing, lists.dimensions = setup.dimensions;
    lists.probes_meet_walls = Grains::averaged;
    if (setup.dimensions == 2) solids.plane = setup.region.min.y;
    const Vec3d e = setup.region.extent();
    lists.repeats = {
        setup.region.min,
        {setup.periodic[0] ? e.x : 0, setup.periodic[1] ? e.y : 0, setup.periodic[2] ? e.z : 0}};
  }
  /// SymplecticTime amplifies sound, more in long steps; without diffusion of density nothing damps
  /// it.
  void choose_courant() {
    if (setup.courant == 0)
      setup.courant = Time::leaps                               ? SphSetup::usual_courant
                      : Time::two_stages && Diffusion::diffuses ? 0.3
                                                                : 0.2;
    if constexpr (Time::leaps) return;
    require(setup.courant <= Time::most_courant, "SphSetup.courant = ", setup.courant,
            " is too long for ", Time::policy_name, ", which was tested up to ", Time::most_courant,
            "; use at most that, or LeapfrogTime");
    if constexpr (Time::two_stages && !Diffusion::diffuses)
      require(setup.courant <= 0.2, "SphSetup.courant = ", setup.courant,
              " is too long for SymplecticTime with NoDiffusion, where noise grows; use at most "
              "0.2, or LeapfrogTime or Fourtakas");
  }
  void check_verlet() const requires(!Time::two_stages) {
    const double longest = Time::longest / setup.courant;
    require(scheme.restart <= longest, "VerletTime.restart = ", scheme.restart,
            " steps at SphSetup.courant = ", setup.courant,
            " decouples odd and even steps; use at most ", static_cast<int>(longest),
            ", or leave it out (default 5)");
    require(Diffusion::diffuses || !std::is_same_v<Viscosity, Inviscid>,
            "Sph: VerletTime with Inviscid and NoDiffusion has no damping, and gains "
            "energy; use SymplecticTime, or Fourtakas");
  }
  /// [m/s2] Gravity that is balanced by pressure at rest; along periodic directions it drives a
  /// flow.
  Vec3d weight() const {
    return {setup.periodic[0] ? 0 : gravity.x, setup.periodic[1] ? 0 : gravity.y,
            setup.periodic[2] ? 0 : gravity.z};
  }
  double particle_mass() const { return liquid.density * setup.volume(); }  // [kg]; 2D: [kg/m]
  /// Solids or liquid were added or removed.
  void renewed() { stale = true, known = false; }
  /// Removes liquid displaced by a new solid, by the positions of particle centres.
  template <class Inside>
  void take_out(const Inside& inside) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns.is_liquid(k) && inside(columns.rows[k].position()))
        sph_goes(*this, k, true), columns.take_out(k), ++displaced;
    made = false, renewed();
  }
  /// Whether a particle of this radius [m] is a body in the liquid, and no unresolved grain.
  bool resolves(double radius) const {
    if constexpr (Grains::averaged) return !grains.is_small(radius, setup);
    return true;
  }
  /// Sets the particles of a Simulation that are in the liquid.
  void take_particles(const CoupledParticles& of) {
    // In the order of their ids, because a Simulation sorts its rows at intervals.
    resolved.resize(of.shape.position.size());
    std::iota(resolved.begin(), resolved.end(), std::size_t{0});
    if (of.id.size() == resolved.size())
      std::sort(resolved.begin(), resolved.end(),
                [&](std::size_t a, std::size_t b) { return of.id[a] < of.id[b]; });
    if constexpr (Grains::averaged)
      if (!grains.pick_small(of, setup, resolved)) made = false, renewed();
    body_ids.clear();
    for (const std::size_t p : resolved) body_ids.push_back(of.id.empty() ? p : of.id[p]);
    if (setup.dimensions == 2) refuse_off_plane(of), look_for_discs(of);
    gaps.find_bodies(body_ids);
    if (solids.bodies.set(of, resolved, setup))
      solids.holding.forget_from(solids.walls.size()), make_room_for_bodies();
    solids.walls.take_drives(time), on_walls.assign(solids.walls.walls(), {});
    exchange = sph_longest_exchange(*this, of);
    known = false;  // of the present positions, whatever was read in between
  }
  /// Bodies off the plane of a liquid in 2D, where their sections are others.
  void refuse_off_plane(const CoupledParticles& of) const {
    const double plane = setup.region.min.y;
    for (std::size_t b = 0; b < resolved.size(); ++b) {
      const Vec3d& at = of.shape.position[resolved[b]];
      if (std::abs(at.y - plane) > 0.05 * setup.spacing)
        throw Error(sentence("particle ", body_ids[b], " at ", at,
                             " m is off the plane y = ", plane,
                             " m of a liquid in 2D; place its centre there, and let nothing push "
                             "it along y"));
    }
  }
  /// Spheres with a density that a substance has: a disc's mass takes a larger one.
  void look_for_discs(const CoupledParticles& of) {
    constexpr double densest = 25000;  // [kg/m3]
    disc = {};
    for (const std::size_t p : resolved) {
      const double R = of.shape.radius[p], density = of.mass[p] / of.volume[p];
      if (!of.shape.form.empty() || disc.mass > 0 || !(density < densest)) continue;
      disc = {R, of.mass[p], density * std::numbers::pi * R * R};
    }
  }
  /// Adds a share of the loads of the last step.
  void add_loads(double part, std::span<Vec3d> force, std::span<Vec3d> torque) {
    for (std::size_t w = 0; w < std::min(on_walls.size(), in_step.size()); ++w)
      on_walls[w].add(part, in_step[w]);
    const auto& bodies = solids.bodies.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const std::size_t p = resolved[b];
      force[p] += part * bodies[b].force, torque[p] += part * bodies[b].torque;
    }
    if constexpr (Grains::averaged)
      for (std::size_t g = 0; g < grains.number.size(); ++g)
        force[grains.number[g]] += part * grains.force[g];
  }
  /// [s] limit due to driven walls in the last advance(); number of the wall.
  std::pair<double, std::size_t> longest_hold() const {
    std::pair<double, std::size_t> least{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t w = 0; w < std::min(on_walls.size(), solids.walls.walls()); ++w)
      if (solids.walls.is_driven(w))
        least = std::min(least, {detail::longest_hold(solids.walls.wall(w), on_walls[w]), w});
    return least;
  }
  /// [m] Centres of unresolved grains.
  std::span<const Vec3d> small_grains() const {
    if constexpr (Grains::averaged)
      return grains.place;
    else
      return {};
  }
  std::size_t liquid_particles() const { return next_number - left - displaced - openings.went(); }
  /// [kg] of the particle of a row.
  double mass_of(std::size_t k) const { return particle_mass() * columns.share_of(k); }
  void make_room_for_bodies() {
    take_out([this](const Vec3d& x) { return body_at(x).has_value(); });
  }
  /// Index of the body that contains a point, in the order of ids; empty: none.
  std::optional<std::size_t> body_at(const Vec3d& x) const {
    const auto& bodies = solids.bodies.bodies;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Vec3d arm = lists.repeats.shortest(x - bodies[b].centre);
      if (dot(arm, arm) < bodies[b].reach * bodies[b].reach && solids.bodies.holds(bodies[b], arm))
        return b;
    }
    return std::nullopt;
  }

  Slip slip() const { return setup.slip.value_or(Viscosity::laminar ? Slip::None : Slip::Free); }

  /// @name What a step goes by
  /// @{
  SphConstants constants() const {
    const double h = setup.h();
    const double viscous = setup.dimensions / (moment * h * h);
    return {particle_mass(),
            h,
            Kernel::normalisation(setup.dimensions, h),
            liquid.sound_speed,
            liquid.density,
            weight(),
            viscous};
  }
  Pairs pairs() const { return Pairs(constants(), viscosity, diffusion, lists.extent()); }
  /// For mixed precision: converts rows for the pair sums, all or those of some packs.
  void shorten(const Pairs& pairs, const Team& team) { shorten(pairs, 0, lists.packs(), team); }
  template <class Seen = Always>
  void shorten(const Pairs& pairs, std::size_t first, std::size_t last, const Team& team,
               const Seen& is_seen = {}) {
    for_brief(first, last, team, is_seen, [&](const auto& part) {
      pairs.shorten(part(columns.rows), part(columns.volume), part(columns.brief));
    });
  }
  template <class Seen>
  void shorten_velocities(const Pairs& pairs, std::size_t first, std::size_t last, const Team& team,
                          const Seen& is_seen) {
    for_brief(first, last, team, is_seen, [&](const auto& part) {
      pairs.shorten_velocities(part(columns.rows), part(columns.brief));
    });
  }
  /// use(part) with part(column) the span of a pack.
  template <class Seen, class Use>
  void for_brief([[maybe_unused]] std::size_t first, [[maybe_unused]] std::size_t last,
                 [[maybe_unused]] const Team& team, [[maybe_unused]] const Seen& is_seen,
                 [[maybe_unused]] const Use& use) {
    if constexpr (Pairs::mixed) {
      constexpr std::size_t W = Pairs::W;
      make_room(columns.brief, columns.size());
      team.for_ranges(last - first, Lists::packs_a_range,
                      [&](std::size_t, std::size_t from, std::size_t to) {
                        for (std::size_t p = first + from; p < first + to; ++p)
                          if (is_seen(p))
                            use([p](auto& of) { return std::span(of).subspan(p * W, W); });
                      });
    }
  }
  /// Adds to the rate of density in row k what parting from walls and bodies takes within `span`
  /// [s] from a density `from` [kg/m3].
  void part(std::size_t k, double from, double parting, double span) {
    double& rate = columns.rates[k].density;
    const double taken = sph_parting(from, rate, parting, liquid.density, span);
    if constexpr (Book::kept) book.parted[k] = parting < 0 ? taken / parting : 1;
    rate += taken;
  }
  /// [1/s] RestoredVolume's part of the growth of a density, over it.
  double restoring(std::size_t k) const requires Volume::restores {
    const SphRates& of = columns.rates[k];
    const double filled = of.divergence / full;
    return keeper.growth(of.slope, filled, surface_slope(filled),
                         columns.rows[k].density / liquid.density, setup.h(), liquid.sound_speed);
  }
  /// Whether a particle has so few neighbours that it takes no tension.
  bool is_loose([[maybe_unused]] const SphRates& rate) const {
    if constexpr (Shift::shifts || asks_fullness)
      return rate.divergence < 0.4 * setup.dimensions;
    else
      return false;
  }
  /// With LeapfrogTime, after the sums: no tension in the first half of the next step either. What
  /// lowers the density of a loose particle does so down to that at rest, as parting from walls.
  void keep_growth(std::size_t k) {
    if (!columns.is_liquid(k) || !is_loose(columns.rates[k])) return;
    auto& [rate, parting] = columns.growth[k];
    if (rate < 0) parting += rate, rate = 0;
  }
  /// Finds what the next step begins with.
  void find_start(const Team& team) {
    if constexpr (Time::leaps) {
      if (begun) {
        // Rows were added or removed, which the first half of the step goes over.
        if (stale) renew(team);
        return;
      }
      find_rates(team), begun = true;
      for (std::size_t k = 0; k < columns.size(); ++k)
        columns.growth[k].density = columns.rates[k].density, keep_growth(k);
    } else {
      find_rates(team);
    }
  }
  double stable_step() const { return stable_step(setup.courant); }
  double stable_step(double courant) const {
    constexpr double most_of_fall = 0.5;  // [-] a particle moves by half its square times h
    const double h = setup.h();
    double dt = courant * h / (liquid.sound_speed + most.pair);
    if (most.acceleration > 0)
      dt = std::min(dt, std::min(courant, most_of_fall) * std::sqrt(h / most.acceleration));
    return std::min(dt, viscous_step());
  }
  /// [s] longest step that the viscosity allows.
  double viscous_step() const {
    if constexpr (sph_varies<Viscosity>)
      return viscosity.longest_step(setup.h(), liquid.sound_speed, liquid.density);
    else if constexpr (requires { viscosity.longest_step(setup.h(), liquid.sound_speed); })
      return viscosity.longest_step(setup.h(), liquid.sound_speed);
    else
      return INFINITY;
  }

  void renew(const Team& team) { sph_renew(*this, team), move_walls(), place_solids(true, team); }
  /// Computes the rates at the present positions, unless they are known.
  void find_rates(const Team& team) {
    if (known) return;
    sph_follow_gravity(*this);
    const bool stand = made && solids.have_rows(small_grains().size());
    bool renews = stale;
    if (stand) move_walls(), renews = renews || !sph_lists_hold(*this, team);
    if (stand && (!renews || !sph_chooses_solids<SphCore>)) place_solids(renews, team);
    if (renews) renew(team);
    const Pairs pairs = this->pairs();
    if constexpr (Grains::averaged)
      sph_book_voidage(*this, [&] {
        grains.template set<Kernel>(columns, lists, solids.grain_rows(), Pairs::W, particle_mass(),
                                    setup.h(), team);
      });
    set_pressures(team);
    if (!openings.empty()) sph_set_buffers(*this, team);
    const std::size_t liquid_packs = lists.first_pack(Lists::Wall);
    shorten(pairs, 0, liquid_packs, team);
    if constexpr (Walls::mirrored) sph_mirror(*this, pairs, team);
    shorten(pairs, liquid_packs, lists.first_pack(Lists::Probe), team,
            [&](std::size_t p) { return fresh || lists.sees_liquid(p); });
    fresh = false;
    find_stresses(team), sph_find_viscosities(*this, team);
    constexpr std::size_t W = Pairs::W, per = 16;
    const std::size_t packs = lists.first_pack(Lists::Wall);
    columns.growth.resize(columns.size());
    DynArray<Extremes> of_parts(pieces(packs, per));
    team.for_parts(of_parts.size(), [&](std::size_t part) {
      Extremes& m = of_parts[part];
      for (std::size_t p = part * per; p < std::min(packs, (part + 1) * per); ++p) {
        m.pair =
            std::max(m.pair, pairs.of_liquid(p, columns.rows, columns.volume, lists, columns.rates,
                                             columns.growth, columns.brief, columns.beside()));
        if constexpr (turbulent)
          sps().accelerate(p, W, columns.rows, columns.volume, columns.stress, lists, columns.rates,
                           true);
        for (std::size_t k = p * W; k < (p + 1) * W; ++k) {
          if (columns.label[k] == Lists::none) continue;
          m.speed = std::max(m.speed, norm(columns.rows[k].velocity()));
          if (columns.is_of_opening(k)) continue;  // forces on them are not used
          Vec3d& a = columns.rates[k].acceleration;
          if constexpr (Grains::averaged) {
            a = (1 / columns.voidage[k]) * a;
            columns.fullness[k] = columns.rates[k].divergence / setup.dimensions;
          }
          if constexpr (Volume::restores) {
            columns.rates[k].density += columns.rows[k].density * restoring(k);
          }
          a += gravity;
          m.acceleration = std::max(m.acceleration, norm(a));
        }
      }
    });
    most = {};
    for (const Extremes& m : of_parts) {
      most.pair = std::max(most.pair, m.pair), most.speed = std::max(most.speed, m.speed);
      most.acceleration = std::max(most.acceleration, m.acceleration);
    }
    if constexpr (!Walls::mirrored) sph_solid_rates(*this, team);
    known = true;
  }
  void set_pressures(const Team& team) {
    const double mass = particle_mass();
    // Mirrored walls take their values from the liquid.
    const bool all = fresh || !Walls::mirrored || Grains::averaged;
    const std::size_t n = all ? columns.size() : lists.first_pack(Lists::Wall) * Pairs::W;
    team.for_ranges(n, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        Row& r = columns.rows[k];
        r.pressure = liquid.pressure(r.density), columns.volume[k] = mass / r.density;
        if constexpr (Grains::averaged) columns.volume[k] *= columns.share[k] / columns.voidage[k];
        if (!Walls::mirrored && columns.kind[k] == Lists::Wall && columns.label[k] != Lists::none)
          columns.volume[k] *= solids.share(columns.label[k]);
      }
    });
  }
  SpsSums<Kernel> sps() const requires turbulent { return {constants(), setup.spacing, viscosity}; }
  void find_stresses([[maybe_unused]] const Team& team) {
    if constexpr (turbulent) {
      columns.stress.assign(columns.size(), {});
      const SpsSums<Kernel> sums = sps();
      team.for_ranges(lists.first_pack(Lists::Wall), Lists::packs_a_range,
                      [&](std::size_t, std::size_t from, std::size_t to) {
                        for (std::size_t p = from; p < to; ++p)
                          sums.stresses(p, Pairs::W, columns.rows, columns.volume, lists,
                                        columns.stress);
                      });
    }
  }
  /// Moves walls to the time of these rates.
  void move_walls() {
    if (solids.walls.any_moves())
      solids.walls.move_to(now, 0.1 * setup.courant * setup.h() / liquid.sound_speed);
  }
  /// Moves the rows of walls and bodies: those that may be near liquid, or all.
  void place_solids(bool all, const Team& team) {
    solids.move_rows(columns, lists, solids.walls.any_moves(), Walls::mirrored, small_grains(), all,
                     team);
  }
  /// @}

  /// One step, by the policy of time integration.
  void step(double dt, const Team& team) {
    setup.check_gravity(gravity);  // it may have been changed, or come from a Simulation
    find_start(team);
    if (steps == 0) sph_check_sound(*this);
    sph_follow_gravity(*this);
    sph_begin_book(*this);
    if constexpr (Book::kept) sph_size_book(*this);
    if constexpr (Time::leaps)
      SphStep(*this, dt, team).leapfrog();
    else if constexpr (Time::two_stages)
      SphStep(*this, dt, team).symplectic();
    else
      SphStep(*this, dt, team).verlet();
    if constexpr (Walls::mirrored)
      solids.holding.keep(solids, columns, lists, dt, sph_memory(liquid_particles(), setup, liquid),
                          team);
    time += dt, now = time, ++steps, last_step = dt, known = false;
    if (!openings.empty() && openings.pass(columns, lists.first_pack(Lists::Wall) * Pairs::W,
                                           particle_mass(), next_number, team))
      renewed();
  }
};

}  // namespace silt::detail
