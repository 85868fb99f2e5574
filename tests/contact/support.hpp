// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <silt/contact/concept.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>

#include "near.hpp"

namespace contact_test {

using namespace silt;

/// Calls `action`, which must throw an InputError whose sentence contains all of `words`.
template <class Action>
void refuses(Action&& action, const std::vector<std::string>& words) {
  std::string sentence = "(nothing thrown)";
  try {
    action();
  } catch (const InputError& error) {
    sentence = error.what();
  }
  CAPTURE(sentence);
  for (const auto& word : words) CHECK(sentence.find(word) != std::string::npos);
}

inline Vec3d random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size), y = random.uniform(-size, size);
  return {x, y, random.uniform(-size, size)};
}
inline Vec3d across(const Vec3d& v, const Vec3d& normal) { return v - dot(v, normal) * normal; }

/// At rest along z: 10 um deep, R* = 1 mm, m* = 1 mg, steps of 1 us.
inline Contact<double> contact_at_rest() {
  Contact<double> c{};
  c.normal = {0, 0, 1};
  c.overlap = 1e-5;
  c.R_eff = 1e-3;
  c.m_eff = 1e-6, c.inverse_m_eff = 1e6;
  c.time_step = c.lag = 1e-6;
  return c;
}

/// A contact of two spheres of some millimetres, in any direction and motion.
inline Contact<double> random_contact(Random& random) {
  Contact<double> c = contact_at_rest();
  c.normal = normalised(random_vector(random, 1));
  c.overlap = random.uniform(1e-7, 1e-4);
  c.normal_velocity = random.uniform(-2, 2);
  c.tangential_velocity = across(random_vector(random, 1), c.normal);
  c.R_eff = random.uniform(1e-4, 2e-3);
  c.m_eff = random.uniform(1e-7, 1e-5), c.inverse_m_eff = 1 / c.m_eff;
  c.turn = random_vector(random, 1e-3);
  return c;
}

/// The Reals of an aggregate.
template <class Real, class Aggregate>
auto reals(const Aggregate& a) {
  return std::bit_cast<std::array<Real, sizeof(Aggregate) / sizeof(Real)>>(a);
}

/// The largest difference of force and history between the law on doubles and on a batch, over the
/// size of what it belongs to; 500 packs of random contacts. `history_size` scales the history;
/// half of the contacts of a law with a range [m] are gaps.
template <class Law>
double largest_lane_difference(const typename Law::template Coefficients<double>& p,
                               double history_size, double range = 0) {
  using Batch = typename Lanes<DefaultArch>::Real;
  constexpr std::size_t W = Lanes<DefaultArch>::width;
  constexpr std::size_t H = detail::history_size<Law>(), C = sizeof(Contact<double>) / 8;
  using History = typename detail::HistoryOf<Law, double>::type;
  using Histories = typename detail::HistoryOf<Law, Batch>::type;
  Random random(5);
  double worst = 0;
  for (int pack = 0; pack < 500; ++pack) {
    std::array<Contact<double>, W> contacts;
    std::array<std::array<double, H>, W> before{};
    std::array<std::array<double, W>, C> lanes;
    for (std::size_t w = 0; w < W; ++w) {
      contacts[w] = random_contact(random);
      if (range > 0 && w % 2 == 0) contacts[w].overlap = random.uniform(-range, 0);
      for (double& h : before[w]) h = random.uniform(-history_size, history_size);
      for (std::size_t k = 0; k < C; ++k) lanes[k][w] = reals<double>(contacts[w])[k];
    }
    const auto load = [](const std::array<double, W>& values) {
      return load_any<Batch>(values.data());
    };
    std::array<Batch, C> packed;
    for (std::size_t k = 0; k < C; ++k) packed[k] = load(lanes[k]);
    Histories histories{};
    if constexpr (H > 0) {
      std::array<Batch, H> packed_history;
      for (std::size_t k = 0; k < H; ++k) {
        std::array<double, W> values;
        for (std::size_t w = 0; w < W; ++w) values[w] = before[w][k];
        packed_history[k] = load(values);
      }
      histories = std::bit_cast<Histories>(packed_history);
    }
    const auto answer = detail::law_force<Law, Batch>(
        std::bit_cast<Contact<Batch>>(packed),
        detail::broadcast<Law::template Coefficients, Batch>(p), histories);
    const auto forces = reals<Batch>(answer);
    for (std::size_t w = 0; w < W; ++w) {
      History history{};
      if constexpr (H > 0) history = std::bit_cast<History>(before[w]);
      const auto alone = reals<double>(detail::law_force<Law, double>(contacts[w], p, history));
      const auto lane = [&](const Batch& b) {
        alignas(64) double values[W];
        silt::store(values, b);
        return values[w];
      };
      // Round-off belongs to the parts of a sum: spring and dashpot may nearly cancel.
      Contact<double> still = contacts[w];
      still.normal_velocity = 0, still.tangential_velocity = {0, 0, 0};
      History held{};
      if constexpr (H > 0) held = std::bit_cast<History>(before[w]);
      double size = 0;
      for (const double f : alone) size = std::max(size, std::abs(f));
      for (const double f : reals<double>(detail::law_force<Law, double>(still, p, held)))
        size = std::max(size, std::abs(f));
      for (std::size_t k = 0; k < alone.size(); ++k)
        if (size > 0) worst = std::max(worst, std::abs(lane(forces[k]) - alone[k]) / size);
      if constexpr (H > 0) {
        const auto after = reals<double>(history);
        double most = 0;
        for (const double h : after) most = std::max(most, std::abs(h));
        for (const double h : before[w]) most = std::max(most, std::abs(h));
        for (std::size_t k = 0; k < H; ++k)
          if (most > 0)
            worst = std::max(worst, std::abs(lane(reals<Batch>(histories)[k]) - after[k]) / most);
      }
    }
  }
  return worst;
}

/// Checks |F_t| <= mu F_n of a law on random contacts, whatever the normal velocity.
template <class Law>
void check_coulomb_limit(const typename Law::template Coefficients<double>& p, double friction,
                         double history_size) {
  Random random(9);
  int sliding = 0, pulled = 0;
  for (int k = 0; k < 20000; ++k) {
    auto c = random_contact(random);
    c.normal_velocity = random.uniform(-50, 50);
    typename Law::template History<double> history{
        across(random_vector(random, history_size), c.normal)};
    const auto f = Law::force(c, p, history);
    const double limit = friction * std::max(f.normal, 0.0);
    // Two products of a few factors each: 1e-14.
    CHECK(norm(f.tangential) <= limit * (1 + 1e-14));
    // Ten times that where spring and dashpot nearly cancel.
    CHECK(std::abs(dot(f.tangential, c.normal)) <= 1e-13 * norm(f.tangential));
    sliding += limit > 0 && norm(f.tangential) > 0.999 * limit;
    pulled += f.normal <= 0;
  }
  CHECK(sliding > 500);
  CHECK(pulled > 1000);
}

/// Work [J] that a contact gives in a path of displacements from no overlap to no overlap, the
/// tangential displacement returning to its start, and the work that went back and forth.
struct CycleWork {
  double gained = 0, turned_over = 0;
};
/// `path(t)`, t in [0, 1]: {tangential x, tangential y, overlap} [m].
template <class Law, class Path>
CycleWork cycle(const typename Law::template Coefficients<double>& p, const Path& path, int steps) {
  typename Law::template History<double> history{};
  CycleWork out;
  Vec3d before = path(0.0), last_force{0, 0, 0};
  for (int k = 1; k <= steps; ++k) {
    const Vec3d now = path(static_cast<double>(k) / steps), move = now - before;
    Contact<double> c = contact_at_rest();
    c.overlap = std::max(now.z, 0.0);
    c.normal_velocity = -move.z, c.tangential_velocity = {move.x, move.y, 0};
    c.time_step = c.lag = 1;
    const auto f = Law::force(c, p, history);
    // Along z the displacement that the force works on is the separation, minus the overlap.
    const Vec3d force{f.tangential.x, f.tangential.y, -f.normal};
    const double work = 0.5 * dot(force + last_force, move);
    out.gained += work, out.turned_over += std::abs(work);
    before = now, last_force = force;
  }
  return out;
}

/// A random smooth cycle: pressed in and let go once, moved to and fro meanwhile.
class RandomCycle {
 public:
  explicit RandomCycle(Random& random) {
    for (auto& a : amplitude_) a = random_vector(random, 2e-5);
  }
  Vec3d operator()(double t) const {
    Vec3d out{0, 0, 0};
    for (std::size_t k = 0; k < amplitude_.size(); ++k)
      out += std::sin(std::numbers::pi * static_cast<double>(k + 1) * t) * amplitude_[k];
    const double press = std::sin(std::numbers::pi * t);
    out.z = press * press * (3e-5 + 0.5 * out.z);
    return {out.x, out.y, std::max(out.z, 0.0)};
  }

 private:
  std::array<Vec3d, 5> amplitude_;
};

}  // namespace contact_test
