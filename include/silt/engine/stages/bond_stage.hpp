// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include <silt/bond/concept.hpp>
#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/row4.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/upper3.hpp>
#include <silt/engine/contact/contact_energy.hpp>
#include <silt/engine/contact/virial.hpp>
#include <silt/engine/lists/bond_list.hpp>
#include <silt/engine/stages/ask_bond_on_lanes.hpp>
#include <silt/engine/stages/turn_spheres.hpp>
#include <silt/engine/stages/wall_bonds.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Bonds and their stage of a time step: computes the loads on their ends and finds overloaded
/// bonds. Results do not depend on the number of threads.
template <class Model, class Domain, class Arch>
class BondStage {
  using Real = typename Lanes<Arch>::Real;
  static constexpr std::size_t W = Lanes<Arch>::width;
  using List = BondList<Model, W>;
  static_assert(bond_fits_lanes<Model, Arch>());

 public:
  using Bond = detail::Bond<Model>;
  using AtWalls = WallBonds<Model>;

  Model model;
  std::uint64_t seed = 1, made = 0, broken = 0;
  bool fresh = false;   // several ranks: some new bonds end at particles that are not ghosts yet,
  bool loaded = false;  // ... because a checkpoint of another number of ranks was loaded
  List list;
  AtWalls at_walls;
  /// Ends of bonds that the user breaks, lower id first, or particle and id_of_wall(): they break
  /// in the next step, as overloaded ones do.
  DynArray<std::pair<ParticleId, ParticleId>> asked;

  void add(Bond bond) { bond.number = made++, list.add(bond); }
  void add(typename AtWalls::Bond bond) { bond.number = made++, at_walls.all.push_back(bond); }
  /// Counts a bond that is stored on other ranks.
  void count() { ++made; }
  /// Present number of bonds.
  template <class Engine>
  std::size_t size(const Engine& e) {
    follow(e);
    if constexpr (Engine::of_ranks) {
      std::size_t own = at_walls.all.size();
      list.for_each_bond([&](const Bond& b) { own += e.find(b.i) < e.owners(); });
      return own;
    }
    return list.size() + at_walls.all.size();
  }

  /// Adds the loads of bonds to the sums of their particles and to walls. Returns the power of
  /// their dashpots [W] for the energy ledger. `ago` [s]: age of the
  /// velocities relative to the positions.
  template <class Engine>
  double push(Engine& e, const Domain& domain, double dt, double ago) {
    overloaded_.clear();
    if constexpr (Engine::of_ranks) fresh = false;
    follow(e);
    double power = 0;
    if constexpr (deforms<Domain>) e.of_bonds = {{}, stiffness()};
    if (list.size() > 0) {
      const auto& groups = list.groups();
      DynArray<Done> done(groups.count());
      bool damped = true;
      if constexpr (requires { model.has_dashpots(); }) damped = model.has_dashpots();
      for (std::size_t p = 0; p < groups.phases(); ++p) {
        const auto [from, to] = list.busy(groups.phase(p));
        e.team().for_parts(to - from, [&, first = from](std::size_t g) {
          if (damped)
            run_group<true>(e, domain, list.group(first + g), ago, done[first + g]);
          else
            run_group<false>(e, domain, list.group(first + g), ago, done[first + g]);
          if constexpr (Engine::of_ranks)  // another rank has the bonds with ghosts too
            if (p >= groups.own_phases()) done[first + g].power *= 0.5;
        });
      }
      for (const Done& one : done) {
        power += one.power;
        if constexpr (deforms<Domain>) e.of_bonds.virial = e.of_bonds.virial + one.virial;
        for (const std::uint32_t k : one.over)
          if (tells(e, k)) overloaded_.push_back({seen(e, domain, k, dt), k});
      }
    }
    power += at_walls.push(e, domain, model, dt, ago, [&](const BondSeen& what, std::size_t k) {
      overloaded_.push_back({what, k});
    });
    if (!asked.empty()) break_asked(e, domain, dt);
    return power;
  }
  /// Removes the bonds of particles that leave before the next force computation. `rows`: rows of
  /// these particles, sorted, ghosts included; `dt` [s]: the last time step, 0 before the first
  /// one.
  template <class Engine>
  void end_of(const Engine& e, const Domain& domain, std::span<const std::uint32_t> rows,
              double dt) {
    follow(e);
    const auto goes = [rows](std::size_t at) {
      return std::binary_search(rows.begin(), rows.end(), static_cast<std::uint32_t>(at));
    };
    DynArray<Ending> ending;
    list.for_each([&](std::size_t k) {
      if (!goes(list.first()[k]) && !goes(list.second()[k])) return;
      if (tells(e, k))
        ending.push_back({seen(e, domain, k, dt, BondEnds::BeforeForces), k});
      else
        list.remove(k);
    });
    for (std::size_t k = 0; k < at_walls.all.size(); ++k)
      if (goes(e.find(at_walls.all[k].i)))
        ending.push_back({at_walls.seen(e, domain, model, k, dt, BondEnds::BeforeForces), k});
    take_out(ending);
  }
  /// The same with several ranks for particles that were removed on any of them; is_gone(id)
  /// identifies these particles. The bonds count neither as present nor as broken.
  template <class Engine, class IsGone>
  void leave(const Engine& e, const IsGone& is_gone) {
    list.remove_if([&](const Bond& b) {
      const bool goes = is_gone(b.i) || is_gone(b.j);
      if (goes) e.particles.bonds.remove(b.i, b.j);
      return goes;
    });
    at_walls.follow(e);
  }
  /// Removes the bonds that were overloaded in the last step. Returns them, together with those
  /// that ended before its force computation, in order of creation.
  DynArray<BondBreak> take_broken(double time) {
    take_out(overloaded_);
    overloaded_.clear();
    DynArray<BondBreak> gone;
    for (const BondSeen& one : std::exchange(ended_, {})) gone.push_back({one, time});
    std::sort(gone.begin(), gone.end(),
              [](const BondBreak& a, const BondBreak& b) { return a.number < b.number; });
    broken += gone.size();
    return gone;
  }
  bool any_broken() const { return !overloaded_.empty() || !ended_.empty(); }
  /// The same with several ranks (collective): each rank removes its copies of the bonds that any
  /// rank has reported, and returns those whose first end it owns; told(bond) is called for all.
  template <class Engine, class Told>
  DynArray<BondBreak> take_broken(Engine& e, double time, const Told& told) {
    DynArray<BrokenBond> own;
    const auto tell = [&](const BondSeen& b) { own.push_back({b.number, b.a, b.b, b.wall}); };
    for (const Ending& one : overloaded_) tell(one.what);
    for (const BondSeen& one : ended_) tell(one);
    auto all = silt::gather(e.ranks.comm(), std::span<const BrokenBond>(own)).values;
    std::sort(all.begin(), all.end(),
              [](const BrokenBond& a, const BrokenBond& b) { return a.number < b.number; });
    list.for_each([&](std::size_t k) {
      const std::uint64_t number = list.bond(k).number;
      if (!tells(e, k) && std::binary_search(all.begin(), all.end(), BrokenBond{number},
                                             [](const BrokenBond& a, const BrokenBond& b) {
                                               return a.number < b.number;
                                             }))
        list.remove(k);
    });
    auto gone = take_broken(time);
    broken += all.size() - gone.size();
    for (const BrokenBond& b : all) told(b);
    return gone;
  }
  /// Rotates the particles for a step of `dt` [s] once there has been a bond; before that nothing
  /// depends on their orientation.
  template <class Engine>
  void turn(Engine& e, double dt) const {
    if (made == 0) return;
    turn_spheres<Arch>(e.particles, dt, e.team());
  }
  /// Calls f(BondSeen) for each bond, in order of creation.
  template <class Engine, class F>
  void visit(const Engine& e, const Domain& domain, const F& f) {
    follow(e);
    DynArray<std::pair<std::uint64_t, std::size_t>> order;
    order.reserve(list.size() + at_walls.all.size());
    list.for_each([&](std::size_t k) {
      if (tells(e, k)) order.push_back({list.bond(k).number, k});
    });
    const std::size_t walls = std::size_t{1} << 63;
    for (std::size_t k = 0; k < at_walls.all.size(); ++k)
      order.push_back({at_walls.all[k].number, walls | k});
    std::sort(order.begin(), order.end());
    for (const auto& [number, k] : order)
      f(k >= walls ? at_walls.seen(e, domain, model, k - walls, 0) : seen(e, domain, k, 0));
  }
  /// [J] stored in the bonds at the present positions.
  template <class Engine>
  double energy(const Engine& e, const Domain& domain) {
    follow(e);
    double sum = 0;
    list.for_each([&](std::size_t k) {
      if (!tells(e, k)) return;
      const Bond b = list.bond(k);
      sum += model.energy(strain_of(b.rest, ends_at(e, domain, k)), b.numbers);
    });
    for (std::size_t k = 0; k < at_walls.all.size(); ++k)
      sum += at_walls.energy(e, domain, model, k);
    return sum;
  }
  /// The highest angular frequency [1/s] that bonds give to a particle, and that particle. It is an
  /// upper bound: all partners are taken to move against the particle. Also the longest step [s] in
  /// which bonds with their dashpots create no energy. Dashpots use velocities that are half a step
  /// old, so that the leapfrog needs w^2 dt^2 + 2 g dt < 4 for a mode of frequency w and decay rate
  /// g; here dt is 0.4 of that limit.
  struct Rate {
    double rate = 0, stable_step = INFINITY;
    ParticleId particle = no_particle;  // that sets the step
  };
  template <class Engine>
  Rate fastest(const Engine& e);
  /// Sorts the bonds again after rows were renumbered, or bonds or particles were added or removed.
  template <class Engine>
  void follow(const Engine& e) {
    if constexpr (Engine::of_ranks)
      if (fresh) return at_walls.follow(e);  // wait until the next step has searched
    list.follow(
        e.particles.size(), e.particles.owned(), e.particles.changes, e.particles.parked,
        [&e](ParticleId id) { return static_cast<std::uint32_t>(e.row_of(id)); },
        [&e](const Bond& gone) { e.particles.bonds.remove(gone.i, gone.j); });
    at_walls.follow(e);
  }

  /// What ranks send to each other about a broken bond.
  struct BrokenBond {
    std::uint64_t number = 0;
    ParticleId a = no_particle, b = no_particle;
    std::size_t wall = 0;
  };

 private:
  template <class Engine>
  [[gnu::cold]] void break_asked(const Engine& e, const Domain& domain, double dt) {
    std::sort(asked.begin(), asked.end());
    const std::size_t before = overloaded_.size();
    const auto breaks = [&](ParticleId a, ParticleId b, std::uint64_t number) {
      return std::binary_search(asked.begin(), asked.end(), std::pair{a, b}) &&
             std::none_of(overloaded_.begin(),
                          overloaded_.begin() + static_cast<std::ptrdiff_t>(before),
                          [&](const Ending& one) { return one.what.number == number; });
    };
    list.for_each([&](std::size_t k) {
      const Bond b = list.bond(k);
      if (breaks(b.i, b.j, b.number) && tells(e, k))
        overloaded_.push_back({seen(e, domain, k, dt), k});
    });
    for (std::size_t k = 0; k < at_walls.all.size(); ++k) {
      const auto& b = at_walls.all[k];
      if (breaks(b.i, e.particles.bonds.id_of_wall(b.wall), b.number))
        overloaded_.push_back({at_walls.seen(e, domain, model, k, dt), k});
    }
    asked.clear();
  }
  /// Whether this rank reports bond k: with several ranks the owner of its first end does.
  template <class Engine>
  bool tells([[maybe_unused]] const Engine& e, [[maybe_unused]] std::size_t k) const {
    if constexpr (Engine::of_ranks) return list.first()[k] < e.particles.owned();
    return true;
  }
  static constexpr std::size_t block = 16;  // bonds whose loads fit into the first-level cache
  static constexpr std::size_t row = 16;    // per bond: force and torques over radii, four each
  using Row = Row4<Arch>;

  struct Ending {
    BondSeen what;
    std::size_t place;  // in the list it belongs to
  };
  void take_out(const DynArray<Ending>& all) {
    for (const Ending& one : all) {
      ended_.push_back(one.what);
      if (one.what.b == no_particle)
        at_walls.all[one.place].i = no_particle;
      else
        list.remove(one.place);
    }
    at_walls.close_up();
  }
  /// Result of one group.
  struct Done {
    DynArray<std::uint32_t> over;  // places of overloaded bonds
    double power = 0;              // [W] of dashpots
    [[no_unique_address]] std::conditional_t<deforms<Domain>, Upper3, NoVirial> virial;  // [J]
  };
  using Virial = std::conditional_t<deforms<Domain>, VirialLanes<Real>, NoVirial>;
  /// [J] sum of stiffness times length^2 over all bonds, the same in any order of them.
  double stiffness();

  template <class Engine>
  BondedEnds<double> ends_at(const Engine& e, const Domain& domain, std::size_t k) const {
    const std::uint32_t a = list.first()[k], b = list.second()[k];
    const auto &p = e.particles.position[a], &q = e.particles.position[b];
    const auto &m = e.particles.motion[a], &n = e.particles.motion[b];
    const Vec3d whole = p.centre() - q.centre();
    Vec3d d = whole, velocity = m.velocity() - n.velocity();
    if constexpr (Domain::periodic) d = domain.shortest(whole);
    if constexpr (deforms<Domain>) velocity -= domain.carried(whole - d);
    return {d,
            velocity,
            e.particles.orientation[a],
            e.particles.orientation[b],
            m.inv_r * m.spin_velocity(),
            n.inv_r * n.spin_velocity()};
  }
  template <class Engine>
  BondSeen seen(const Engine& e, const Domain& domain, std::size_t k, double dt,
                BondEnds when = BondEnds::AfterForces) const {
    const Bond b = list.bond(k);
    const auto ends = ends_at(e, domain, k);
    auto strain = strain_of(b.rest, ends);
    take_rates_of(0.5 * dt, ends, strain);
    BondSeen out = see_bond(model, strain, b.numbers, dt, when);
    out.a = b.i, out.b = b.j, out.number = b.number;
    out.to = e.particles.position[list.first()[k]].centre(), out.from = out.to - ends.apart;
    return out;
  }

  /// The ends of a pack of bonds, and the inverse radii [1/m].
  template <class R>
  struct Pack {
    BondedEnds<R> ends;
    R inv_r_i, inv_r_j;
  };
  static constexpr std::size_t columns = sizeof(Pack<double>) / sizeof(double);
  /// Whether a column holds velocities, which only dashpots need.
  static constexpr bool of_rates(std::size_t column) {
    using Ends = BondedEnds<double>;
    const auto is_of = [&](std::size_t first) {
      return column * sizeof(double) >= first && column * sizeof(double) < first + sizeof(Vec3d);
    };
    return is_of(offsetof(Ends, velocity)) || is_of(offsetof(Ends, spin_i)) ||
           is_of(offsetof(Ends, spin_j));
  }
  /// Ends in columns and loads in rows, passed between the stages of a block.
  struct Block {
    alignas(64) double ends[columns][block];
    alignas(64) double loads[block * row];
  };

  /// `damped`: the bonds have dashpots; without them no velocities are read.
  template <bool damped, class Engine>
  void run_group(Engine& e, const Domain& domain, const typename List::Group& g, double ago,
                 Done& done);
  /// Transposes the rows of the ends of `count` bonds into lanes.
  template <bool damped, class Engine>
  __attribute__((flatten)) void gather(Engine& e, const Domain& domain, std::size_t from,
                                       std::size_t count, bool ahead, Block& b) const;
  template <bool damped, class State>
  SILT_INLINE Pack<Real> ends_of(const State& particles, const Domain& domain, std::size_t k) const;
  /// Prefetches the rows of a later pack (PairPipeline::fetch).
  template <class Engine>
  SILT_INLINE void fetch(Engine& e, std::size_t k) const;
  SILT_INLINE static void put(const Vec3<Real>& v, double* to);
  /// Writes the loads of the pack at place k of a block, which is at place `of_list` of the list.
  /// Returns which of its bonds are overloaded.
  template <bool damped, class Engine>
  __attribute__((flatten)) std::uint64_t run_pack(const Engine&, std::size_t of_list, std::size_t k,
                                                  const Real& ago, Block& b, Real& power,
                                                  Virial& virial) const;
  /// Adds the loads in strides, because neighbours in the list share particles
  /// (PairPipeline::add_up).
  template <class Engine>
  void add_up(Engine& e, std::size_t from, std::size_t count, const double* loads);
  double stiffness_ = 0;
  std::uint64_t counted_made_ = 0;  // when stiffness_ was summed: bonds made, and present
  std::size_t counted_ = 0;
  DynArray<Ending> overloaded_;
  DynArray<BondSeen> ended_;  // since take_broken() was called last
};

/// The stage of a policy Bonds<Model>; empty without one.
template <class Policy, class Domain, class Arch>
struct BondsOf {
  struct type {};
};
template <class Model, class Domain, class Arch>
struct BondsOf<Bonds<Model>, Domain, Arch> {
  using type = BondStage<Model, Domain, Arch>;
};

}  // namespace silt::detail

#include <silt/engine/stages/bond_lanes.hpp>
#include <silt/engine/stages/bond_rates.hpp>
