// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/cell_grid.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/hashed_grid.hpp>
#include <silt/search/nbs.hpp>
#include <silt/search/space_order.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Name of a type as written by the compiler, without namespaces.
template <class T>
std::string_view type_name() {
#if defined(__GNUC__)
  std::string_view name = __PRETTY_FUNCTION__;
  name.remove_prefix(name.find("T = ") + 4);
  name = name.substr(0, name.find_first_of(";]"));
  const auto scope = name.substr(0, name.find('<')).rfind("::");
  return scope == std::string_view::npos ? name : name.substr(scope + 2);
#else
  return "a search";
#endif
}

/// Sorts pairs into an order that does not depend on the search: lower number first, ascending.
inline void sort_pairs(std::vector<IndexPair>& pairs, std::size_t spheres, const Team& team) {
  DynArray<std::uint32_t> next(spheres + 1, 0);
  for (IndexPair& p : pairs) {
    p = {std::min(p.a, p.b), std::max(p.a, p.b)};
    ++next[p.a];
  }
  std::uint32_t place = 0;
  for (auto& first : next) place += std::exchange(first, place);
  std::vector<IndexPair> sorted(pairs.size());
  for (const IndexPair& p : pairs) sorted[next[p.a]++] = p;
  team.for_ranges(spheres, [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t a = from; a < to; ++a) {
      const std::size_t first = a == 0 ? 0 : next[a - 1];
      if (next[a] - first > 32) {
        std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(first), sorted.begin() + next[a],
                  [](const IndexPair& p, const IndexPair& q) { return p.b < q.b; });
        continue;
      }
      for (std::size_t k = first + 1; k < next[a]; ++k)  // usually three or four
        for (std::size_t j = k; j > first && sorted[j].b < sorted[j - 1].b; --j)
          std::swap(sorted[j], sorted[j - 1]);
    }
  });
  pairs.swap(sorted);
}

}  // namespace detail

/// Measures several searches on the spheres of the simulation and uses the fastest.
///
///   silt::VerletList<silt::AutoSearch>{}               all searches of silt
///   silt::FastestOf<silt::HashedGrid, MySearch>{}      the searches listed
///
/// It measures at the first search and when the number of spheres has doubled or halved. It starts
/// with some thousand neighbouring spheres, then takes eight times as many, and so on. A search
/// that takes more than three times as long as the best is dropped; an unsuitable search thus costs
/// little. report() gives the choice and the reason.
///
/// Pairs come in the same order from every search, and order() is the same for all. The choice
/// therefore changes only the run time; results are equal to the last bit.
/// Shapes: none. Units: SI. Errors: those of the searches.
/// Tests:  tests/search/fastest_of.cpp.
/// Source: silt's own.
/// Valid:  every scene for which its searches are valid.
template <NeighbourSearch... Finders>
class FastestOf {
  static_assert(sizeof...(Finders) > 0, "FastestOf needs at least one search");

 public:
  /// Result of one candidate in the last measurement.
  struct Trial {
    std::string_view name;
    std::size_t spheres = 0;  // on which it was timed last
    double time = 0;          // [s] time for them
    bool given_up = false;    // it took far longer than another
  };
  /// State kept in checkpoints.
  struct Choice {
    std::uint64_t finder = 0, spheres = 0;  // spheres: at the trial; 0: none yet
  };

  template <class Domain>
  void order(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
             std::vector<std::uint32_t>& order) {
    detail::space_order(spheres, reach, domain, team, order);
  }

  template <class Domain>
  void find(const SphereSet& spheres, double reach, const Domain& domain, const Team& team,
            std::vector<IndexPair>& pairs) {
    const std::size_t n = spheres.rows.size();
    if (choice_.spheres == 0 || n >= 2 * choice_.spheres || 2 * n <= choice_.spheres)
      choose(spheres, reach, domain, team);
    with(finders_, choice_.finder,
         [&](auto& finder) { finder.find(spheres, reach, domain, team, pairs); });
    detail::sort_pairs(pairs, n, team);
  }

  static constexpr std::size_t searches = sizeof...(Finders);
  const Choice& choice() const { return choice_; }
  void keep(const Choice& choice) {
    require(choice.finder < sizeof...(Finders), "FastestOf: there is no search ", choice.finder);
    choice_ = choice;
  }
  /// Name of the search in use.
  std::string_view chosen() const { return names()[choice_.finder]; }
  /// Candidates of the last measurement; empty after a restart, which keeps the choice.
  const DynArray<Trial>& trials() const { return trials_; }
  /// The choice and its reason, in one sentence.
  std::string report() const {
    if (choice_.spheres == 0) return "no search has been tried yet";
    std::string text = silt::text(chosen(), " for ", choice_.spheres, " spheres");
    for (const Trial& t : trials_)
      text += silt::text(
          &t == trials_.data() ? ": " : ", ", t.name, " ",
          std::round(1e10 * t.time / static_cast<double>(std::max<std::size_t>(t.spheres, 1))) / 10,
          " ns a sphere",
          t.given_up ? silt::text(" (given up at ", t.spheres, ")") : std::string());
    return text;
  }

 private:
  static std::array<std::string_view, sizeof...(Finders)> names() {
    return {detail::type_name<Finders>()...};
  }

  using All = std::tuple<Finders...>;
  template <class Action>
  static void with(All& finders, std::size_t wanted, const Action& action) {
    std::size_t k = 0;
    std::apply([&](auto&... finder) { ((k++ == wanted ? action(finder) : void()), ...); }, finders);
  }

  template <class Domain>
  void choose(const SphereSet& spheres, double reach, const Domain& domain, const Team& team) {
    const std::size_t n = spheres.rows.size();
    auto candidates = finders_;  // a copy, which frees the memory of the others
    trials_.clear();
    for (const auto name : names()) trials_.push_back({.name = name});
    std::vector<std::uint32_t> order;
    detail::space_order(spheres, reach, domain, team, order);
    for (std::size_t size = std::min(n, first_sample);; size = std::min(n, 8 * size)) {
      DynArray<PositionRow> sample;  // from the middle of the order
      for (std::size_t k = 0; k < size; ++k)
        sample.push_back(spheres.rows[size == n ? k : order[(n - size) / 2 + k]]);
      double best = std::numeric_limits<double>::infinity();  // [s]
      for (std::size_t k = 0; k < trials_.size(); ++k) {
        Trial& t = trials_[k];
        if (t.given_up) continue;
        t.spheres = size;
        t.time = time_of(candidates, k, {sample, spheres.largest_radius}, reach, domain, team);
        if (t.time < best) best = t.time, choice_.finder = k;
      }
      if (size == n) break;
      for (Trial& t : trials_)
        if (t.spheres == size && t.time > 3 * best) t.given_up = true;
    }
    choice_.spheres = std::max<std::size_t>(n, 1);
  }

  /// Shortest of a few searches [s]; the first fills caches and buffers.
  template <class Domain>
  static double time_of(All& all, std::size_t k, const SphereSet& spheres, double reach,
                        const Domain& domain, const Team& team) {
    using Clock = std::chrono::steady_clock;
    double least = std::numeric_limits<double>::infinity();
    std::vector<IndexPair> pairs;
    for (int run = 0; run < 4; ++run) {
      const auto start = Clock::now();
      with(all, k, [&](auto& finder) { finder.find(spheres, reach, domain, team, pairs); });
      least = std::min(least, std::chrono::duration<double>(Clock::now() - start).count());
    }
    return least;
  }

  static constexpr std::size_t first_sample = 1000;  // spheres

  All finders_;
  Choice choice_;
  DynArray<Trial> trials_;
};

using AutoSearch = FastestOf<HashedGrid, CellGrid, Nbs, BruteForce>;

}  // namespace silt
