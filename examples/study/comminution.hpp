// silt - BSD-3-Clause, see LICENSE
#pragma once

// The mill of the comminution study: a state of the jet mill from which all variants start, and the
// cost and results of a variant from there.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <silt/study/clock.hpp>

#include "jet_mill/scene.hpp"

namespace comminution_study {

using jet_mill::Scene;

/// Which economies a run uses, besides its search and its law.
struct Way {
  bool followed = false;           // drag found anew in each step, instead of held
  double cell = 0, tolerance = 0;  // [m], [-] of FollowedDrag
  int steps = 1;                   // particle steps a fluid step; 0: chosen by silt
  double softened = 0;             // [m] radius, R_full; 0: true moduli
  double dust = 20e-6;             // [m]
  double gravity = 9.81;           // [m/s2]

  Scene scene(const Scene& of) const {
    Scene s = of;
    s.dust = dust, s.full_radius = softened;
    return s;
  }
};

/// The mill after some running time.
struct State {
  struct Grain {
    silt::Particles<silt::Sphere>::Particle particle;
    double strength, generation;
  };
  std::vector<Grain> grains;
  silt::FlowSolver gas;
};

/// Size distributions of a run: `all`, in the mill and out of it; `product`, only dust and what has
/// left the mill.
struct Outcome {
  silt::SizeTable all, product;
  double broken = 0;  // grains

  void add(const Outcome& other) {
    all.merge(other.all), product.merge(other.product), broken += other.broken;
  }
  /// Largest difference of the fractions finer than any size.
  double off(const Outcome& other) const { return largest(all, other.all); }
  double product_off(const Outcome& other) const { return largest(product, other.product); }

 private:
  static double largest(const silt::SizeTable& a, const silt::SizeTable& b) {
    double most = 0;
    for (std::size_t k = 1; k <= std::max(a.classes(), b.classes()); ++k) {
      const double x = silt::SizeTable::edge(k);
      most = std::max(most, std::abs(a.finer(x) - b.finer(x)));
    }
    return most;
  }
};

/// A mill that continues from a state, with its own search, law and economies.
template <class L, bool followed, class Search>
auto mill_from(const State& state, const Scene& base, const Way& way, const Search& search) {
  const Scene s = way.scene(base);
  auto gas = [&] {
    if constexpr (followed)
      return silt::CoupledFlow{silt::DiFelice{}, silt::Kernel{}, state.gas,
                               silt::FollowedDrag{.cell = way.cell, .tolerance = way.tolerance}};
    else
      return silt::CoupledFlow{silt::DiFelice{}, silt::Kernel{}, state.gas};
  }();
  gas.diameter = s.feed, gas.most_steps = 400;
  if (way.steps > 0) gas.steps = way.steps;
  silt::Particles<silt::Sphere> grains;
  for (const auto& g : state.grains) grains.add(g.particle);
  silt::Simulation sim{std::move(grains), jet_mill::contacts<L>(s), std::move(gas),
                       jet_mill::breakage(s), search};
  jet_mill::furnish<L>(sim, s);
  sim.threads = 1;
  // Softened fines between grain and wall, or between two grains.
  sim.guard.max_overlap = 0.89, sim.guard.max_travel = 0.1;
  sim.set_max_overlap("salt", "salt", 1.9);
  sim.gravity = {0, 0, -way.gravity};
  using Policy = std::remove_cvref_t<decltype(sim.breakage())>;
  for (std::size_t k = 0; k < state.grains.size(); ++k) {
    auto& own = sim.template field<Policy>(sim.find(k));
    own.strength = state.grains[k].strength, own.generation = state.grains[k].generation;
  }
  return sim;
}

/// Results of a run.
template <class Sim>
Outcome outcome_of(const Sim& sim) {
  Outcome out;
  out.product = sim.dust(), out.product.merge(sim.left());
  out.all = silt::sizes_present(sim), out.all.merge(out.product);
  out.broken = static_cast<double>(sim.broken());
  return out;
}

/// Grains that overlap others or walls, as new fragments do, are left out: the mechanism that
/// separates them gently is not part of a state.
template <class Sim>
State state_of(const Sim& sim, const Scene& s) {
  using Policy = std::remove_cvref_t<decltype(sim.breakage())>;
  State state{{}, sim.fluid().flow()};
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) order.push_back(k);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return sim.radius(a) != sim.radius(b) ? sim.radius(a) > sim.radius(b) : sim.id(a) < sim.id(b);
  });
  for (const std::size_t k : order) {
    const silt::Vec3d x = sim.position(k);
    // An overlap of 2 % of the radius would eject a grain of real modulus at 12 m/s, this one at
    // 0.3 m/s.
    const double r = sim.radius(k), most = 1e-3 * r;  // [m]
    bool free = jet_mill::room(s, x) > r - most && std::hypot(x.x, x.y) + r < s.radius + most;
    for (const auto& other : state.grains) {
      if (!free) break;
      free = norm(x - other.particle.position) > r + other.particle.radius - most;
    }
    if (!free) continue;
    state.grains.push_back({{.position = x,
                             .radius = r,
                             .density = Scene::density,
                             .velocity = sim.velocity(k),
                             .angular_velocity = sim.angular_velocity(k)},
                            sim.template field<Policy>(k).strength,
                            sim.template field<Policy>(k).generation});
  }
  return state;
}

/// Continues for `duration` [s]; writes the final state, if requested.
template <class L, bool followed, class Search>
Outcome found(const State& from, const Scene& base, const Way& way, double duration,
              const Search& search, State* end = nullptr) {
  auto sim = mill_from<L, followed>(from, base, way, search);
  sim.run(duration);
  if (end) *end = state_of(sim, base);
  return outcome_of(sim);
}

/// [s] processor time per millisecond in the mill, from about `seconds` of computing: whole fluid
/// steps, without the first ones.
template <class L, bool followed, class Search>
double cost_of(const State& from, const Scene& base, const Way& way, double seconds,
               const Search& search) {
  auto sim = mill_from<L, followed>(from, base, way, search);
  const auto clock = silt::processor_time();
  sim.run(1e-12);  // to know the step
  const double round = sim.step_length() * (way.steps > 0 ? 2.0 * way.steps : 1000);  // [s]
  // The first fluid steps after a start are short, if silt chooses them.
  sim.run(way.steps > 0 ? round : 4e-5);
  const double start = clock.now(), from_time = sim.time();
  while (clock.now() - start < seconds) sim.run(round);
  return 1e-3 * (clock.now() - start) / (sim.time() - from_time);
}

/// Searches done at each step: the full mesh with all 26 neighbours, one hashed grid, two, the half
/// stencil with edge proximity. Followed drag: the full mesh only.
enum class Search { FullMesh, HashedGrid, SubGrid, HalfStencil };
double direct_cost(const State& from, const Scene& base, const Way& way, double seconds,
                   Search search);

}  // namespace comminution_study
