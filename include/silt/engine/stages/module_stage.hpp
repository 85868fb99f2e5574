// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/stages/module_fields.hpp>
#include <silt/engine/stages/near_stage.hpp>
#include <silt/engine/state/module_columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What modules do in a step: apply forces to particles and advance their fields.
template <class List, class Domain>
class ModuleStage;

template <class Domain, class... Ms>
class ModuleStage<ModuleList<Ms...>, Domain> {
  using List = ModuleList<Ms...>;

 public:
  std::tuple<Ms...> modules;
  [[no_unique_address]] NearStageOf<List, Domain> near;

  explicit ModuleStage(std::tuple<Ms...> all) : modules(std::move(all)) {}

  template <class M>
  M& get() {
    return std::get<M>(modules);
  }
  template <class M>
  const M& get() const {
    return std::get<M>(modules);
  }

  /// Sets the initial field values of the new particle k.
  template <class Columns>
  void start(Columns& columns, const Seen& p, std::size_t k) const {
    (start_one<Ms>(columns, p, k), ...);
  }

  /// The new particle k has the fields of one that has broken, and this share of its volume.
  template <class Columns>
  void divide(Columns& columns, std::size_t k, double share) const {
    const auto one = [&]<class M>(std::type_identity<M>) {
      if constexpr (DividesFields<M>) get<M>().divide(columns.template of<M>()[k], share);
    };
    (one(std::type_identity<Ms>{}), ...);
  }

  /// Called before a run.
  template <class Sim>
  void check([[maybe_unused]] const Sim& sim) const {
    (check_one<Ms>(sim), ...);
  }

  /// Evaluates the pair interactions of modules within their cut-off.
  template <class Engine>
  void look_near([[maybe_unused]] const Engine& e, [[maybe_unused]] const Domain& domain,
                 [[maybe_unused]] double time, [[maybe_unused]] bool asked,
                 [[maybe_unused]] bool measure) {
    if constexpr (List::in_pairs) near.look(modules, e, domain, time, asked, measure);
  }

  /// The time at which forces are evaluated.
  struct When {
    std::int64_t step;
    double time;    // [s]
    double ahead;   // [s] from the time of the stored velocities to this time
    Vec3d gravity;  // [m/s2]
  };
  /// Computes the module force on each particle. `others(k)` [N]: the sum of all other forces.
  template <class Engine, class Others>
  void push(Engine& e, const When& when, const Others& others) const {
    if constexpr (List::push) {
      auto& columns = e.modules();
      std::array<std::size_t, Team::most_ranges> bad;
      bad.fill(none);
      e.team().for_ranges(e.owners(), [&](std::size_t r, std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
          Push sum{};
          const auto owner = e.owner(k);
          if (owner.is_there() && owner.inverse_mass() > 0) {
            Seen p = e.seen(k, when.time);
            sum = sum_of(columns, p, k);
            if constexpr (asks_for_velocity)
              if (when.ahead > 0)
                sum = at_whole_step(columns, p, k, when, others(k) + near_force(k), sum);
            sum.force += near_force(k);
            if (!(is_finite(sum.force) && is_finite(sum.torque))) bad[r] = std::min(bad[r], k);
          }
          columns.force[k] = VectorRow::of(sum.force);
          if constexpr (List::turn) columns.torque[k] = VectorRow::of(sum.torque);
        }
      });
      if (const std::size_t k = *std::min_element(bad.begin(), bad.end()); k != none)
        (stop_at<Ms>(e, when, k), ...);
    }
  }

  /// Advances the fields of all particles to the end of a step of `dt` [s].
  template <class Engine>
  void update(Engine& e, std::int64_t step, double time, double dt) const {
    if constexpr (List::update) {
      auto& columns = e.modules();
      std::array<std::size_t, Team::most_ranges> bad;
      bad.fill(none);
      e.team().for_ranges(e.owners(), [&](std::size_t r, std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
          if (!e.owner(k).is_there()) continue;
          const Seen p = e.seen(k, time);
          if (!(update_one<Ms>(columns, p, k, dt) && ...)) bad[r] = std::min(bad[r], k);
        }
      });
      if (const std::size_t k = *std::min_element(bad.begin(), bad.end()); k != none)
        (stop_at_field<Ms>(get<Ms>(), e, step, time, k), ...);
    }
  }

  /// Checks fields that no update() computes, after changes by observers or by the program.
  template <class Engine>
  void check_given(const Engine& e, [[maybe_unused]] std::int64_t step,
                   [[maybe_unused]] double time) const {
    (check_given_fields<Ms>(e, step, time), ...);
  }

  /// The largest acceleration [m/s2] that modules give to a particle now.
  template <class Engine>
  double largest_acceleration([[maybe_unused]] const Engine& e, [[maybe_unused]] std::int64_t step,
                              [[maybe_unused]] double time) const {
    double most = 0;
    if constexpr (List::push)
      for (std::size_t k = 0; k < e.owners(); ++k) {
        const auto p = e.owner(k);
        if (!p.is_there() || !(p.inverse_mass() > 0)) continue;
        const Vec3d force = sum_of(e.modules(), e.seen(k, time), k).force + near_force(k);
        if (!is_finite(force)) (stop_at<Ms>(e, {step, time, 0, {0, 0, 0}}, k), ...);
        most = std::max(most, p.inverse_mass() * norm(force));
      }
    return most;
  }
  /// Which rates of fluxes are included: as estimated by their modules, as measured in this step,
  /// or none.
  enum class OfFluxes { Estimated, Measured, LeftOut };
  /// The highest oscillation or decay rate [1/s] due to modules, and the particle that has it.
  struct Rate {
    double rate = 0;
    std::size_t particle = 0;
  };
  template <class Engine>
  Rate fastest(const Engine& e, double time, OfFluxes of_fluxes) const {
    Rate most;
    if constexpr (((SaysItsRate<Ms> || SaysItsFluxRate<Ms> || SaysPairStiffness<Ms>) || ...))
      for (std::size_t k = 0; k < e.owners(); ++k) {
        if (!e.owner(k).is_there()) continue;
        const Seen p = e.seen(k, time);
        if (const double rate = (0.0 + ... + rate_of_one<Ms>(e, p, k, of_fluxes)); rate > most.rate)
          most = {rate, k};
      }
    return most;
  }

  /// The fastest response of a field to fluxes [1/s], as measured in this step and as estimated.
  template <class Engine>
  double fastest_flux(const Engine& e, double time) const {
    double most = 0;
    for (std::size_t k = 0; k < e.owners(); ++k) {
      if (!e.owner(k).is_there()) continue;
      const Seen p = e.seen(k, time);
      for (const OfFluxes of : {OfFluxes::Estimated, OfFluxes::Measured})
        most = std::max({most, (Exchanges<Ms> ? field_rate<Ms>(e, p, k, of) : 0.0)...});
    }
    return most;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  /// A field that follows fluxes decays, at most at its rate; Euler's rule is stable, and keeps it
  /// between its neighbours' values, for steps of up to 2 over that. silt's own is 1 over the
  /// estimate, where a swing has pi/20.
  template <class M>
  static constexpr bool only_decays = Exchanges<M>&& SaysItsFluxRate<M> && !Pushes<M>;
  static constexpr double share_of_decays = std::numbers::pi / 20;
  static constexpr bool asks_for_velocity = ((Pushes<Ms> && needs_velocity<Ms>) || ...);

  /// Force [N] of the pair interactions of modules.
  Vec3d near_force([[maybe_unused]] std::size_t k) const {
    if constexpr (List::in_pairs)
      return near.force(k);
    else
      return {0, 0, 0};
  }

  template <class M, class Columns>
  static decltype(auto) fields_of(Columns& columns, std::size_t k) {
    if constexpr (has_fields<M>)
      return (columns.template of<M>()[k]);
    else
      return NoFields{};
  }
  template <class M, class Columns>
  void start_one(Columns& columns, const Seen& p, std::size_t k) const {
    if constexpr (has_fields<M>) {
      auto& own = columns.template of<M>()[k];
      if constexpr (requires(const M& m) { own = m.start(p); })
        own = get<M>().start(p);
      else
        own = FieldsOf<M>{};
    }
  }
  template <class M, class Columns>
  SILT_INLINE void add_push(Push& sum, const Columns& columns, const Seen& p, std::size_t k) const {
    if constexpr (Pushes<M>) {
      const Push one = push_of(get<M>(), p, fields_of<M>(columns, k));
      sum.force += one.force, sum.torque += one.torque;
    }
  }
  template <class Columns>
  Push sum_of(const Columns& columns, const Seen& p, std::size_t k) const {
    Push sum{};
    (add_push<Ms>(sum, columns, p, k), ...);
    return sum;
  }
  /// The force at the velocity of the whole step, which the force itself changes: iterated until
  /// both agree. `rest` [N]: the sum of all other forces.
  template <class Columns>
  Push at_whole_step(const Columns& columns, Seen& p, std::size_t k, const When& when,
                     const Vec3d& rest, Push sum) const {
    constexpr int most = 6;
    constexpr double close = 1e-10;
    const Vec3d before = p.velocity;
    for (int again = 0; again < most; ++again) {
      p.velocity = before + when.ahead * ((1 / p.mass) * (rest + sum.force) + when.gravity);
      const Push next = sum_of(columns, p, k);
      const Vec3d change = next.force - sum.force;
      sum = next;
      if (dot(change, change) <= close * close * dot(next.force, next.force)) break;
    }
    return sum;
  }
  template <class M, class Columns>
  bool update_one(Columns& columns, const Seen& p, std::size_t k, double dt) const {
    if constexpr (UpdatesByFlux<M>) {
      auto& own = columns.template of<M>()[k];
      get<M>().update(p, own, columns.template received_of<M>()[k], dt);
      return all_finite<M>(own) && allows_fields(get<M>(), own);
    } else if constexpr (Updates<M>) {
      auto& own = columns.template of<M>()[k];
      get<M>().update(p, own, dt);
      return all_finite<M>(own) && allows_fields(get<M>(), own);
    } else {
      return true;
    }
  }
  template <class M, class Sim>
  void check_one([[maybe_unused]] const Sim& sim) const {
    if constexpr (requires(const M& m) { m.check(sim); })
      get<M>().check(sim);
    else
      static_assert(!MembersNamed<M>::check,
                    "a module's check() does not fit: it must be `void check(const auto& "
                    "simulation) const`, and public: silt/module/concept.hpp");
    if constexpr (SaysFluxSteps<M>)
      require(get<M>().flux_every > 0, name_of_module<M>(),
              ".flux_every = 0 [steps] must be at least 1");
  }
  /// A rate that is not a number limits no step.
  template <class M>
  static void check_rate(double rate, const Seen& p) {
    require(rate >= 0 && std::isfinite(rate), "the rate() of the module ", name_of_module<M>(),
            " is ", rate, " 1/s for particle ", p.id, " at ", p.position,
            " m; it must be finite and at least 0: mend its rate()");
  }
  template <class M, class Engine>
  double rate_of_one(const Engine& e, const Seen& p, std::size_t k, OfFluxes of_fluxes) const {
    double rate = field_rate<M>(e, p, k, of_fluxes);
    check_rate<M>(rate, p);
    if (only_decays<M> && of_fluxes == OfFluxes::Estimated) rate *= share_of_decays;
    if constexpr (SaysPairStiffness<M>)
      if (std::isfinite(p.mass)) rate += near.template rate<M>(k, p.mass);
    return rate;
  }
  /// The force without pair interactions.
  template <class M, class Engine>
  double field_rate(const Engine& e, const Seen& p, std::size_t k, OfFluxes of_fluxes) const {
    const auto& columns = e.modules();
    if constexpr (SaysItsFluxRate<M>) {
      if (of_fluxes == OfFluxes::LeftOut) return 0;
      double slope = 0;
      if constexpr (List::in_pairs) slope += near.template slope<M>(k);
      if (of_fluxes == OfFluxes::Measured || !Exchanges<M>) {
        if constexpr (Exchanges<M>) slope += e.fluxes().template slope_of<M>(k);
        return get<M>().rate(p, fields_of<M>(columns, k), slope);
      }
    }
    if constexpr (SaysRateOfPair<M> || requires { get<M>().rate(p); }) {
      double rate;
      if constexpr (SaysRateOfPair<M>)
        rate = e.fluxes().template largest_rate<M>(get<M>(), p);
      else
        rate = get<M>().rate(p);
      if constexpr (SaysItsFluxRate<M> && SaysPairSlope<M>) {
        const auto& own = fields_of<M>(columns, k);
        rate += get<M>().rate(p, own, near.template slope<M>(k)) - get<M>().rate(p, own, 0.0);
      }
      return rate;
    } else if constexpr (SaysItsRate<M>)
      return get<M>().rate(p, fields_of<M>(columns, k));
    else
      return 0;
  }

  /// Aborts the run if this module's force is not finite.
  template <class M, class Engine>
  void stop_at(const Engine& e, const When& when, std::size_t k) const {
    if constexpr (PushesPairs<M>) {
      const Vec3d& force = near.template of<M>().force[k];
      if (!is_finite(force)) {
        const Seen p = e.seen(k, when.time);
        throw SimulationError(readable("step ", when.step, ", t = ", when.time,
                                       " s: the sum of pair_force() of the module ",
                                       name_of_module<M>(), " on particle ", p.id, " at ",
                                       p.position, " m is ", force, " N; mend its pair_force()"),
                              when.step, {p.id}, p.position);
      }
    }
    if constexpr (Pushes<M>) {
      const Seen p = e.seen(k, when.time);
      const Push push = push_of(get<M>(), p, fields_of<M>(e.modules(), k));
      if (is_finite(push.force) && is_finite(push.torque)) return;
      throw SimulationError(
          readable("step ", when.step, ", t = ", when.time, " s: the force of the module ",
                   name_of_module<M>(), " on particle ", p.id, " at ", p.position, " m is ",
                   push.force, " N",
                   List::turn ? text(" with a torque of ", push.torque, " N m") : "",
                   "; mend its force()"),
          when.step, {p.id}, p.position);
    }
  }
};

}  // namespace silt::detail
