// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/engine/lists/near_list.hpp>
#include <silt/engine/ranks/near_reach.hpp>
#include <silt/engine/state/module_columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Pair interactions of a module within its cut-off, at one instant; this module has none.
template <class M, class Domain, bool Acts = ActsInPairs<M>>
struct NearPairs {};

/// Each pair is evaluated once, by any thread, and the result is stored for the pair; then each
/// particle sums over its own pairs in order of place. Results are bitwise independent of the
/// number of threads, and the exchange between the two particles of a pair cancels exactly.
template <class M, class Domain>
class NearPairs<M, Domain, true> {
 public:
  NearList<Domain> list;
  AlignedVector<Vec3d> force;              // [N] on each particle
  AlignedVector<double> flux;              // [.../s] into each
  AlignedVector<double> stiffness, slope;  // [N/m], [.../s]: sums from the last look that measured

  /// `fields(k)`: of the particle at place k.
  template <class Fields>
  void look(const M& module, const NearParticles& of, const Fields& fields, const Domain& domain,
            const Team& team, bool measure) {
    const std::string name = name_of_module<M>();
    list.renew(of, domain, team, reach_of(module), name.c_str());
    const auto ask = [&](auto& of_pairs, auto& of_particles, const auto& answer, auto sum) {
      ask_all(of, fields, domain, team, of_pairs, of_particles, answer, sum);
    };
    using Of = FieldsOf<M>;
    using D = const Apart&;
    using P = const Seen&;
    using F = const Of&;
    if constexpr (PushesPairsWithoutFields<M>)
      ask(
          forces_, force, [&](D d, P a, F, P b, F) { return Vec3d(module.pair_force(d, a, b)); },
          opposite);
    else if constexpr (PushesPairs<M>)
      ask(
          forces_, force,
          [&](D d, P a, F f, P b, F g) { return Vec3d(module.pair_force(d, a, f, b, g)); },
          opposite);
    if constexpr (PushesBoth<M>)
      if (module.pushes_both()) {
        ask(
            forces_, common_,
            [&](D d, P a, F f, P b, F g) {
              return Vec3d(module.pair_force_on_both(d, a, f, b, g));
            },
            alike);
        for (std::size_t k = 0; k < force.size(); ++k) force[k] += common_[k];
      }
    if constexpr (FlowsInPairs<M>)
      ask(
          numbers_, flux,
          [&](D d, P a, F f, P b, F g) { return double(module.pair_flux(d, a, f, b, g)); },
          opposite);
    if (!measure) return;
    if constexpr (SaysPairStiffnessWithoutFields<M>)
      ask(
          numbers_, stiffness,
          [&](D d, P a, F, P b, F) { return double(module.pair_stiffness(d, a, b)); }, alike);
    else if constexpr (SaysPairStiffness<M>)
      ask(
          numbers_, stiffness,
          [&](D d, P a, F f, P b, F g) { return double(module.pair_stiffness(d, a, f, b, g)); },
          alike);
    if constexpr (SaysPairSlope<M>)
      ask(
          numbers_, slope,
          [&](D d, P a, F f, P b, F g) { return double(module.pair_slope(d, a, f, b, g)); }, alike);
  }
  /// Rate [1/s] of the particle at place k, as last measured: exact for two masses on a spring,
  /// else an upper bound (Gershgorin).
  double rate(std::size_t k, double mass) const {
    return k < stiffness.size() ? std::sqrt(2 * stiffness[k] / mass) : 0;
  }
  double slope_of(std::size_t k) const { return k < slope.size() ? slope[k] : 0; }

  /// Whether two particles are there and within the cut-off.
  bool sees(const Seen& a, const Seen& b, const Domain& domain) const {
    if (a.id == no_particle || b.id == no_particle) return false;
    const Vec3d d = way(a, b, domain);
    return list.within(dot(d, d), a.radius, b.radius);
  }

  static typename NearList<Domain>::Reach reach_of(const M& module) {
    double length = 0;
    if constexpr (SaysReach<M>)
      length = module.reach();
    else
      length = module.gap_reach();
    require_positive(text(name_of_module<M>(), SaysReach<M> ? "::reach()" : "::gap_reach()"),
                     length, "m");
    return {length, !SaysReach<M>};
  }

 private:
  static constexpr auto opposite = [](int sign, const auto& x) { return double(sign) * x; };
  static constexpr auto alike = [](int, const auto& x) { return x; };

  /// [m] from the second particle to the first.
  static Vec3d way(const Seen& a, const Seen& b, [[maybe_unused]] const Domain& domain) {
    const Vec3d d = a.position - b.position;
    if constexpr (Domain::periodic)
      return domain.shortest(d);
    else
      return d;
  }
  /// The first particle of a pair is the one at the lower place; if the other belongs to another
  /// rank, the one with the lower id, so that both ranks compute the same.
  template <class Fields, class Value, class Answer, class Sum>
  void ask_all(const NearParticles& of, const Fields& fields, const Domain& domain,
               const Team& team, AlignedVector<Value>& of_pairs, AlignedVector<Value>& of_particles,
               const Answer& answer, const Sum& sum) {
    of_pairs.resize(list.pairs());
    list.for_each(team, [&](std::size_t pair, std::size_t i, std::size_t j) {
      of_pairs[pair] = Value{};
      if (of.seen[i].id == no_particle || of.seen[j].id == no_particle) return;
      const bool turned = j >= of.own && of.seen[i].id > of.seen[j].id;
      if (turned) std::swap(i, j);
      const Seen &a = of.seen[i], &b = of.seen[j];
      const Vec3d d = way(a, b, domain);
      const double distance2 = dot(d, d);
      if (!list.within(distance2, a.radius, b.radius)) return;
      const Value found = answer(Apart{d, std::sqrt(distance2)}, a, fields(i), b, fields(j));
      of_pairs[pair] = turned ? sum(-1, found) : found;
    });
    of_particles.assign(of.own, Value{});
    list.gather(team, [&](std::size_t k, std::size_t pair, int sign) {
      of_particles[k] += sum(sign, of_pairs[pair]);
    });
  }

  AlignedVector<Vec3d> forces_;  // one per pair
  AlignedVector<Vec3d> common_;  // [N] on each particle, from pair_force_on_both()
  AlignedVector<double> numbers_;
};

/// All modules with pair interactions.
template <class List, class Domain>
class NearStage;

template <class Domain, class... Ms>
class NearStage<ModuleList<Ms...>, Domain> {
 public:
  static constexpr bool active = ModuleList<Ms...>::in_pairs;
  NearParticles particles;  // of the last look

  /// Evaluates the pair interactions of modules now; `measure`: also their rates of change. Modules
  /// whose contact flux is held in this step (`asked` is false) are skipped; their pair flux is
  /// held as well.
  template <class Engine>
  void look(const std::tuple<Ms...>& modules, const Engine& e, const Domain& domain, double time,
            bool asked, bool measure) {
    measured_ = measure, asked_ = asked || measure;
    if (!(wanted<Ms>(asked_) || ...)) return;
    see(e, e.places(), time);
    look_at_seen(modules, e, domain, asked, measure);
  }
  /// The same among these `particles`.
  template <class Engine>
  void look_at_seen(const std::tuple<Ms...>& modules, const Engine& e, const Domain& domain,
                    bool asked, bool measure) {
    measured_ = measure, asked_ = asked || measure;
    (look_one<Ms>(modules, e, domain, asked_, measure), ...);
  }
  /// The particles at the first places of the engine.
  template <class Engine>
  void see(const Engine& e, std::size_t places, double time) {
    particles.own = e.owners(), particles.seen.resize(places);
    e.team().for_ranges(places, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        particles.seen[k].id = no_particle;
        if (e.owner(k).is_there()) particles.seen[k] = e.seen(k, time);
      }
    });
  }
  /// With several ranks (NearOthers): fields of the particles behind the own ones that are no
  /// ghosts; else empty.
  template <class M>
  auto& of_others() {
    return std::get<ModuleList<Ms...>::template index_of<M>>(others_);
  }
  template <class M>
  const auto& of_others() const {
    return std::get<ModuleList<Ms...>::template index_of<M>>(others_);
  }
  /// The largest reach of all modules.
  static NearReach reach(const std::tuple<Ms...>& modules) {
    NearReach most;
    const auto include = [&]<class M>(const M& module) {
      if constexpr (ActsInPairs<M>) {
        const auto own = NearPairs<M, Domain>::reach_of(module);
        double& of = own.of_surfaces ? most.of_surfaces : most.of_centres;
        of = std::max(of, own.length);
      }
    };
    (include(std::get<Ms>(modules)), ...);
    return most;
  }
  /// In the first look after a search on several ranks: the work of each own particle's pairs, in
  /// units of a contact's, for the modules that look in this step.
  void weigh(const Domain& domain, DynArray<double>& work) const {
    if (!(wanted<Ms>(asked_) || ...) || work.size() == particles.own) return;
    work.assign(particles.own, 0);
    (weigh_one<Ms>(domain, work), ...);
  }
  /// Whether the last look measured rates.
  bool measured() const { return measured_; }
  /// Force on the particle at place k [N].
  Vec3d force(std::size_t k) const {
    Vec3d sum{0, 0, 0};
    (add_force<Ms>(sum, k), ...);
    return sum;
  }
  /// Adds the pair flux to the contact flux of each particle if the contact flux was just evaluated
  /// (`asked`); otherwise the held value already includes it.
  template <class Columns>
  void receive(Columns& columns, bool asked) const {
    (receive_one<Ms>(columns, asked), ...);
  }
  template <class M>
  double rate(std::size_t k, double mass) const {
    if constexpr (SaysPairStiffness<M>)
      return of<M>().rate(k, mass);
    else
      return 0;
  }
  template <class M>
  double slope(std::size_t k) const {
    if constexpr (SaysPairSlope<M>)
      return of<M>().slope_of(k);
    else
      return 0;
  }
  /// Pairs in the list of a module.
  template <class M>
  const NearPairs<M, Domain>& of() const {
    return std::get<ModuleList<Ms...>::template index_of<M>>(pairs_);
  }

 private:
  template <class M>
  static bool wanted(bool asked) {
    return ActsInPairs<M> && (asked || PushesPairs<M> || !Exchanges<M>);
  }
  template <class M, class Engine>
  void look_one(const std::tuple<Ms...>& modules, const Engine& e, const Domain& domain, bool asked,
                bool measure) {
    constexpr std::size_t own = ModuleList<Ms...>::template index_of<M>;
    if constexpr (ActsInPairs<M>)
      if (wanted<M>(asked))
        std::get<own>(pairs_).look(
            std::get<own>(modules), particles,
            [&](std::size_t k) -> decltype(auto) { return this->template fields<M>(e, k); }, domain,
            e.team(), measure);
  }
  template <class M, class Engine>
  decltype(auto) fields(const Engine& e, std::size_t k) const {
    if constexpr (!has_fields<M>)
      return NoFields{};
    else if constexpr (Engine::of_ranks)
      return (of_others<M>().empty() || k < particles.own ? e.modules().template of<M>()[k]
                                                          : of_others<M>()[k - particles.own]);
    else
      return (e.modules().template of<M>()[k]);
  }
  template <class M>
  void weigh_one(const Domain& domain, DynArray<double>& work) const {
    if constexpr (ActsInPairs<M>) {
      if (!wanted<M>(asked_)) return;
      constexpr double of_a_side = 0.25;
      of<M>().list.for_each(Team{}, [&](std::size_t, std::size_t i, std::size_t j) {
        if (!of<M>().sees(particles.seen[i], particles.seen[j], domain)) return;
        work[i] += of_a_side;
        if (j < particles.own) work[j] += of_a_side;
      });
    }
  }
  template <class M>
  void add_force(Vec3d& sum, std::size_t k) const {
    if constexpr (PushesPairs<M>)
      if (k < of<M>().force.size()) sum += of<M>().force[k];
  }
  template <class M, class Columns>
  void receive_one(Columns& columns, bool asked) const {
    if constexpr (FlowsInPairs<M>) {
      auto& received = columns.template received_of<M>();
      const auto& flux = of<M>().flux;
      if constexpr (Exchanges<M>) {
        if (!asked) return;
        for (std::size_t k = 0; k < flux.size(); ++k) received[k] += flux[k];
      } else {
        std::copy(flux.begin(), flux.end(), received.begin());
      }
    }
  }

  std::tuple<NearPairs<Ms, Domain>...> pairs_;
  std::tuple<DynArray<FieldsOf<Ms>>...> others_;
  bool measured_ = false, asked_ = false;  // by the last look
};

/// For compositions without pair interactions.
struct NoNearStage {
  static constexpr bool active = false;
};
template <class List, class Domain>
using NearStageOf = std::conditional_t<List::in_pairs, NearStage<List, Domain>, NoNearStage>;

}  // namespace silt::detail
