// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include <silt/core/storage.hpp>
#include <silt/engine/lists/near_list.hpp>
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

  template <class Engine>
  void look(const M& module, const Engine& e, const Domain& domain, const std::vector<Seen>& seen,
            bool measure, const char* name) {
    list.renew(e, domain, reach_of(module, name), name);
    const auto ask = [&](auto& of_pairs, auto& of_particles, const auto& answer, auto sum) {
      ask_all(e, domain, seen, of_pairs, of_particles, answer, sum);
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

 private:
  static constexpr auto opposite = [](int sign, const auto& x) { return double(sign) * x; };
  static constexpr auto alike = [](int, const auto& x) { return x; };

  static typename NearList<Domain>::Reach reach_of(const M& module, const char* name) {
    double length = 0;
    if constexpr (SaysReach<M>)
      length = module.reach();
    else
      length = module.gap_reach();
    require_positive(text(name, SaysReach<M> ? "::reach()" : "::gap_reach()"), length, "m");
    return {length, !SaysReach<M>};
  }
  template <class Engine, class Value, class Answer, class Sum>
  void ask_all(const Engine& e, const Domain& domain, const std::vector<Seen>& seen,
               AlignedVector<Value>& of_pairs, AlignedVector<Value>& of_particles,
               const Answer& answer, const Sum& sum) {
    of_pairs.resize(list.pairs());
    list.for_each(e.team(), [&](std::size_t pair, std::size_t i, std::size_t j) {
      of_pairs[pair] = Value{};
      const Seen &a = seen[i], &b = seen[j];
      if (a.id == no_particle || b.id == no_particle) return;
      Vec3d d = a.position - b.position;
      if constexpr (Domain::periodic) d = domain.shortest(d);
      const double distance2 = dot(d, d);
      if (!list.within(distance2, a.radius, b.radius)) return;
      of_pairs[pair] = answer(Apart{d, std::sqrt(distance2)}, a, fields(e, i), b, fields(e, j));
    });
    of_particles.assign(seen.size(), Value{});
    list.gather(e.team(), [&](std::size_t k, std::size_t pair, int sign) {
      of_particles[k] += sum(sign, of_pairs[pair]);
    });
  }
  template <class Engine>
  static decltype(auto) fields(const Engine& e, std::size_t k) {
    if constexpr (has_fields<M>)
      return (e.modules().template of<M>()[k]);
    else
      return NoFields{};
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

  /// Evaluates the pair interactions of modules now; `measure`: also their rates of change. Modules
  /// whose contact flux is held in this step (`asked` is false) are skipped; their pair flux is
  /// held as well.
  template <class Engine>
  void look(const std::tuple<Ms...>& modules, const Engine& e, const Domain& domain, double time,
            bool asked, bool measure) {
    measured_ = measure;
    if (!(wanted<Ms>(asked || measure) || ...)) return;
    seen_.resize(e.owners());
    e.team().for_ranges(seen_.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        seen_[k].id = no_particle;
        if (e.owner(k).is_there()) seen_[k] = e.seen(k, time);
      }
    });
    (look_one<Ms>(modules, e, domain, asked || measure, measure), ...);
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
        std::get<own>(pairs_).look(std::get<own>(modules), e, domain, seen_, measure,
                                   name_of_module<M>().c_str());
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
  std::vector<Seen> seen_;
  bool measured_ = false;
};

/// For compositions without pair interactions.
struct NoNearStage {
  static constexpr bool active = false;
};
template <class List, class Domain>
using NearStageOf = std::conditional_t<List::in_pairs, NearStage<List, Domain>, NoNearStage>;

}  // namespace silt::detail
