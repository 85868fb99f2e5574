// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is measured of throws: the share of grains that breaks, the sizes of their fragments, the
// number of impacts that they survive, and the books of mass, momentum and energy. Beside each
// stands what the laws of the scene say.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "drop_test/scene.hpp"

namespace drop_test {

/// Number of the impact that breaks a grain of this strength, at most `most` + 1, under the same
/// load at each impact.
inline std::size_t breaking_impact(const silt::PowerFatigue& fatigue, double strength, double load,
                                   std::size_t most) {
  std::size_t n = 1;
  for (; n <= most && load < strength; ++n) strength = fatigue.weakened(strength, load);
  return n;
}

/// Fraction of all grains [-] that are broken after 1, 2, ... `most` impacts: those weaker than the
/// strength above which one more impact is needed. Bisection finds that strength.
inline std::vector<double> broken_after(const Scene& s, double diameter, double speed,
                                        std::size_t most) {
  const double load = s.load(diameter, speed);
  std::vector<double> shares;
  for (std::size_t n = 1; n <= most; ++n) {
    double low = load, high = 1e3 * load;  // [N]
    for (int halving = 0; halving < 100; ++halving) {
      const double middle = std::sqrt(low * high);
      (breaking_impact(s.fatigue(), middle, load, most) <= n ? low : high) = middle;
    }
    shares.push_back(s.strength().weaker(n == 1 ? load : low, diameter, s.mass(diameter)));
  }
  return shares;
}

/// Conservation errors: the worst of all runs.
struct Books {
  double mass = 0, momentum = 0, energy = 0;  // [-] unexplained, over all that there was

  /// `start`: momentum along z of all grains; `dust`: momentum carried away by dust [kg m/s].
  template <class Sim>
  void add(const Sim& sim, double start, double dust) {
    const auto balance = sim.mass_balance();
    mass = std::max(mass, std::abs(balance.residual()) / balance.fed);
    const auto& plate = sim.wall("plate");
    double held = dust;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) held += sim.mass(k) * sim.velocity(k).z;
    // The velocities are those of the present: the last force has acted for half of its step.
    const double taken = plate.impulse.z - 0.5 * sim.step_length() * plate.force.z;
    momentum = std::max(momentum, std::abs((held + taken) / start - 1));
    const auto e = sim.energy();
    energy = std::max(energy, std::abs(e.residual()) / e.initial);
  }
};

/// All grains of one size at one speed.
struct Throw {
  double diameter, speed;  // [m], [m/s]
  std::size_t grains;
  double expected;  // [-] selection function
  std::size_t broken = 0;
  double dust = 0;  // [-] share of the broken grains' mass
  double load = 0;  // [-] largest deviation from Hertz' closed form

  double share() const { return static_cast<double>(broken) / static_cast<double>(grains); }
  double deviation() const {  // [-] standard, of the share
    return std::sqrt(expected * (1 - expected) / static_cast<double>(grains));
  }
  double off() const { return (share() - expected) / deviation(); }
};

/// Mass fraction finer than each size, of all fragments and their dust: observed, and by the
/// breakage function of each grain that broke.
struct Sizes {
  std::vector<double> x;                    // [m]
  std::vector<double> seen, wanted, error;  // [-]; standard error of `seen`
};

/// Sizes at which they are compared: down to the dust limit four per factor of 2, below it the
/// edges of the dust table.
inline std::vector<double> sizes_to_see(double diameter) {
  std::vector<double> x;
  const double least = Scene::dust * diameter;
  for (std::size_t k = 1; silt::SizeTable::edge(k) < 0.999 * least; ++k)
    x.push_back(silt::SizeTable::edge(k));
  for (double at = least; at < 1.001 * diameter; at *= std::exp2(0.25)) x.push_back(at);
  return x;
}

template <class Sim>
Sizes see_sizes(const Scene& s, const Sim& sim, double diameter,
                const std::vector<silt::BreakEvent>& events) {
  Sizes out{.x = sizes_to_see(diameter), .seen = {}, .wanted = {}, .error = {}};
  const auto n = static_cast<double>(events.size());
  const auto sizes = s.sizes();
  const double least = 0.999 * Scene::dust * diameter;  // [m]
  for (const double x : out.x) {
    double sum = 0, squares = 0, wanted = 0;
    for (const silt::BreakEvent& b : events) {
      const silt::Broken parent{b.diameter, b.mass, b.strength, b.load, b.speed};
      double finer = x < least ? sim.dust().finer(x) * b.dust : b.dust;
      for (std::size_t f = 0; f < b.fragments; ++f) {
        const std::size_t k = sim.find(b.first + f);
        if (2 * sim.radius(k) < x) finer += sim.mass(k);
      }
      sum += finer / b.mass, squares += finer / b.mass * finer / b.mass;
      wanted += sizes.finer(x, parent);
    }
    out.seen.push_back(sum / n), out.wanted.push_back(wanted / n);
    out.error.push_back(std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0) / n));
  }
  return out;
}

/// One throw. Evaluated when the grains have left the plate; the fragments are still in flight and
/// do not break further.
inline Throw throw_once(const Scene& s, double diameter, double speed, std::uint64_t seed,
                        Books& books, const std::string& picture, Sizes* sizes, int threads) {
  Throw out{diameter, speed, s.grains, s.selection(diameter, speed)};
  const double gap = 0.05 * diameter;
  auto sim = make_simulation(s, diameter, speed, gap, seed);
  sim.threads = threads;
  std::vector<silt::BreakEvent> events;
  double lost = 0, dust = 0, mass = 0;  // [kg m/s], [kg]
  sim.run((gap + 0.5 * diameter) / speed, silt::on_break([&](const silt::BreakEvent& b) {
            events.push_back(b);
            dust += b.dust, lost += b.dust * b.velocity.z, mass += b.mass;
          }));
  for (const silt::BreakEvent& b : events) {
    out.broken += b.id < s.grains;
    out.load = std::max(out.load, std::abs(b.load / s.load(diameter, speed) - 1));
  }
  if (mass > 0) out.dust = dust / mass;
  books.add(sim, -speed * s.mass(diameter) * static_cast<double>(s.grains), lost);
  if (!picture.empty()) silt::write_particles(picture, sim);
  if (sizes != nullptr) *sizes = see_sizes(s, sim, diameter, events);
  return out;
}

/// Repeated throws of the same grains at one speed.
struct Again {
  double speed;  // [m/s]
  std::size_t grains;
  std::vector<std::size_t> broken;             // after 1, 2, ... impacts
  std::vector<double> expected;                // [-] share
  double mean = 0, wanted = 0, deviation = 0;  // impacts until they break, of those that broke

  double share(std::size_t k) const {
    return static_cast<double>(broken[k]) / static_cast<double>(grains);
  }
  double share_deviation(std::size_t k) const {
    return std::sqrt(expected[k] * (1 - expected[k]) / static_cast<double>(grains));
  }
  /// Mean number of impacts, its expectation, and the standard error.
  void evaluate() {
    double of_seen = 0, of_law = 0, squares = 0, before = 0;
    std::size_t seen_before = 0;
    for (std::size_t k = 0; k < broken.size(); ++k) {
      const auto n = static_cast<double>(k + 1);
      of_seen += n * static_cast<double>(broken[k] - seen_before);
      of_law += n * (expected[k] - before), squares += n * n * (expected[k] - before);
      seen_before = broken[k], before = expected[k];
    }
    mean = of_seen / static_cast<double>(seen_before), wanted = of_law / before;
    deviation = std::sqrt((squares / before - wanted * wanted) / static_cast<double>(seen_before));
  }
};

/// After each impact the fragments are removed and the unbroken grains thrown back from their
/// positions: each impact starts as far from the plate as the one before.
inline Again throw_again(const Scene& s, double diameter, double speed, std::uint64_t seed,
                         Books& books, int threads) {
  Again out{speed, s.grains, {}, broken_after(s, diameter, speed, s.again)};
  const double gap = 0.02 * diameter;
  auto sim = make_simulation(s, diameter, speed, gap, seed);
  sim.threads = threads;
  const double round =
      gap / speed * (1 + 1 / s.restitution) + 1.2 * s.touching(diameter, speed);  // [s]
  std::size_t broken = 0;
  const auto count = silt::on_break([&](const silt::BreakEvent& b) { broken += b.id < s.grains; });
  for (std::size_t n = 0; n < s.again; ++n) {
    sim.run(round, count);
    out.broken.push_back(broken);
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      if (sim.id(k) < s.grains)
        sim.set_velocity(sim.id(k), {0, 0, -speed});
      else
        sim.remove(sim.id(k));
    }
  }
  const auto balance = sim.mass_balance();
  books.mass = std::max(books.mass, std::abs(balance.residual()) / balance.fed);
  out.evaluate();
  return out;
}

}  // namespace drop_test
