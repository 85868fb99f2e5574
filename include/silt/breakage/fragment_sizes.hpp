// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <span>

#include <silt/breakage/concept.hpp>
#include <silt/breakage/size_table.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>

namespace silt::inline SILT_TARGET {

/// Draws the fragments of one parent. The mean mass in fragments below any diameter is that of the
/// breakage function B, and the mass of each event is exact.
///
/// From coarse to fine, with R the remaining mass of the parent's mass M and B_0 the share below
/// the size reached so far (R = M, B_0 = 1 at the start):
///   1. fragments of the remaining sizes have the mean number dK = (R/B_0) dB/m(x)           (1)
///   2. of the next two fragments the first is at K = u, the second at K = 2 - u, u uniform in
///      (0, 1): a large one comes with a small one, and each has the mean density of (1)     (2)
///   3. R is reduced by their masses, and B_0 is that at K = 2; repeat until x = dust_below. The
///      remaining mass is dust.
/// As R is a factor in (1), the mean of R remains M B_0, and all mean masses are exact. However, a
/// fragment cannot be heavier than the remaining mass: such a fragment is reduced to it and is the
/// last. This makes fragments finer than B, by the errors below.
///
/// B is linear in the mass within classes of 1/12 octave of the diameter.
///
/// Source: own.
/// Error:  computed, largest deviation of the mean of 300 000 events from B at any x, as a share of
///         the parent's mass, for dust_below/d of 0.1 and 0.3; statistical part up to 0.05 %:
///           GaudinSchuhmann, k 0.5 to 0.9, exponents 0.5 to 1.5; RosinRammler of x63 = 0.3 d;
///             T10Sizes from 10 times E50 on (the classes' linear B)                         0.16 %
///           GaudinSchuhmann with k = 1, exponent 1; RosinRammler of x63 = 0.7 d, n = 1.5;
///             VogelPeukertSizes of q = 0.7                                            0.2 to 0.3 %
///           GaudinSchuhmann with k = 1, exponent 1.5; Austin; T10Sizes of twice E50   0.6 to 0.8 %
///           GaudinSchuhmann with k = 1, exponent 2.5                                         1.7 %
///           Austin without a fine part, coarse exponent 4                                    2.6 %
/// Cost:   computed, one core: 1 to 30 us per event, T10Sizes 13 to 55 us.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range. check_sizes is not called here.
/// Tests:  tests/breakage/fragment_sizes.cpp.
struct FragmentLimits {
  double dust_below;      // [m] > 0: smaller fragments are dust
  std::size_t most = 12;  // [-] >= 1 per event: the largest are kept, all others are dust

  void check() const {
    require_positive("FragmentLimits.dust_below", dust_below, "m");
    require(most >= 1, "FragmentLimits.most = ", most, " [-] must be at least 1");
  }
};

/// Result of fragment_sizes() for one event.
struct FragmentSizes {
  DynArray<double> masses;  // [kg] descending, diameters of at least dust_below
  double dust;              // [kg] mass of the parent minus that of all fragments
  double dust_largest;      // [m] largest size in the dust: dust_below, or more if `most` has
                            // limited the number of fragments
};

namespace detail {

/// Mean number of fragments of one parent, from coarse to fine: K [1/kg] per unit mass, dK = dB/m.
class FragmentNumbers {
 public:
  template <class Function>
  FragmentNumbers(const Function& function, const Broken& parent, double density, double least)
      : per_volume_(density * std::numbers::pi / 6) {
    const double largest = function.largest(parent);
    const double classes = std::max(std::ceil(12 * std::log2(largest / least)), 1.0);
    require(classes <= 1e5, "fragment_sizes: dust_below = ", least,
            " [m] is too far below the largest fragment, of ", largest, " [m]");
    const auto count = static_cast<std::size_t>(classes);
    for (std::size_t j = 0; j <= count; ++j) {
      const double x = j == count ? least : largest * std::exp2(-static_cast<double>(j) / 12);
      mass_.push_back(per_volume_ * x * x * x);
      below_.push_back(j == 0 ? 1 : std::min(function.finer(x, parent), below_[j - 1]));
      number_.push_back(
          j == 0 ? 0 : number_[j - 1] + (below_[j - 1] - below_[j]) * log_ratio(j) / width(j));
    }
  }

  double end() const { return number_.back(); }
  double end_mass() const { return mass_.back(); }
  /// [kg] of the fragment at K < end()
  double mass(double K) const {
    const std::size_t j = class_of(K);
    const double part = (K - number_[j - 1]) / (number_[j] - number_[j - 1]);
    return std::max(mass_[j - 1] * std::exp(-part * log_ratio(j)), mass_[j]);
  }
  double diameter(double K) const { return std::cbrt(mass(K) / per_volume_); }  // [m]
  /// [-] share of the parent's mass beyond K < end()
  double below(double K) const {
    const std::size_t j = class_of(K);
    return below_[j] + (below_[j - 1] - below_[j]) * (mass(K) - mass_[j]) / width(j);
  }

 private:
  double log_ratio(std::size_t j) const { return std::log(mass_[j - 1] / mass_[j]); }
  double width(std::size_t j) const { return mass_[j - 1] - mass_[j]; }
  std::size_t class_of(double K) const {
    const auto after = std::upper_bound(number_.begin() + 1, number_.end() - 1, K);
    return static_cast<std::size_t>(after - number_.begin());
  }

  double per_volume_;        // [kg/m3] of the cube of a diameter
  DynArray<double> mass_;    // [kg] of fragments at the classes' edges, descending
  DynArray<double> below_;   // [-] B there; linear in the mass within a class
  DynArray<double> number_;  // [1/kg] K there; linear in ln m within a class
};

/// Fragments of one event, in pairs.
class FragmentDraw {
 public:
  FragmentDraw(const FragmentNumbers& numbers, double mass, std::size_t most)
      : numbers_(numbers), left_(mass), most_(most) {}

  DynArray<double> run(Random& random) {
    DynArray<double> masses;
    while (masses.size() < most_ && at_ < numbers_.end()) {
      const double one = numbers_.below(at_) / left_;  // of K, for a mean of one fragment
      const double u = random.uniform(), first = at_ + u * one, second = at_ + (2 - u) * one;
      at_ += one;
      if (!take(first, masses) || masses.size() == most_) break;
      at_ += one;
      if (!take(second, masses)) break;
    }
    return masses;
  }
  double left() const { return left_; }  // [kg] for the dust
  /// Largest diameter [m] of the dust if `most` has limited the fragments; else `least`.
  double largest_left(double least) const {
    return left_ > 0 && at_ < numbers_.end() && left_ >= numbers_.end_mass()
               ? std::max(numbers_.diameter(at_), least)
               : least;
  }

 private:
  bool take(double K, DynArray<double>& masses) {
    if (!(K < numbers_.end())) return true;
    const double m = std::min(numbers_.mass(K), left_);
    if (m < numbers_.end_mass()) return false;
    masses.push_back(m), left_ -= m;
    return left_ > 0;
  }

  const FragmentNumbers& numbers_;
  double left_;  // [kg] R
  std::size_t most_;
  double at_ = 0;  // [1/kg] the K reached so far
};

}  // namespace detail

/// Fragments and dust of a parent. `density` [kg/m3] converts diameters to masses; a sphere of the
/// parent's diameter should have its mass. Random numbers come only from `random`.
template <BreakageFunction Function>
FragmentSizes fragment_sizes(const Function& function, const Broken& parent, double density,
                             const FragmentLimits& limits, Random& random) {
  limits.check();
  require_positive("fragment_sizes: density", density, "kg/m3");
  require_positive("fragment_sizes: the parent's mass", parent.mass, "kg");
  const double least = limits.dust_below;
  if (!(function.largest(parent) > least)) return {{}, parent.mass, least};
  const detail::FragmentNumbers numbers(function, parent, density, least);
  detail::FragmentDraw draw(numbers, parent.mass, limits.most);
  FragmentSizes out{draw.run(random), 0, least};
  if (draw.left() > 0) {
    const double kept = std::accumulate(out.masses.begin(), out.masses.end(), 0.0);
    out.dust = std::max(parent.mass - kept, 0.0);
    out.dust_largest = draw.largest_left(least);
  }
  return out;
}

/// Shares [-] of the dust's mass in the diameter classes [edges[k], edges[k + 1]) [m], by the
/// breakage function below dust_largest. Mass beyond the outer edges counts in the outer classes;
/// the shares sum to 1.
template <BreakageFunction Function>
DynArray<double> dust_shares(const Function& function, const Broken& parent,
                             const FragmentSizes& sizes, std::span<const double> edges) {
  const auto falls = [](double edge, double next) { return !(edge < next); };
  require(edges.size() >= 2 && std::adjacent_find(edges.begin(), edges.end(), falls) == edges.end(),
          "dust_shares: the ", edges.size(), " edges must be two or more, and ascend");
  const double top = sizes.dust_largest, all = function.finer(top, parent);
  DynArray<double> shares(edges.size() - 1);
  double before = 0;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const double edge = edges[k + 1];
    const bool last = k + 1 == shares.size() || edge >= top;
    const double below = last ? 1 : all > 0 ? function.finer(edge, parent) / all : 0;
    shares[k] = std::max(below - before, 0.0);
    before = std::max(below, before);
  }
  return shares;
}

/// Adds the dust of an event to a table, mass by class. The numbers are those of spheres of this
/// density [kg/m3] and the mean diameter of a class (geometric; in the first class half its upper
/// edge).
template <BreakageFunction Function>
void add_dust(SizeTable& table, const Function& function, const Broken& parent,
              const FragmentSizes& sizes, double density, double time) {
  if (!(sizes.dust > 0)) return;
  DynArray<double> edges;
  const std::size_t last = SizeTable::class_of(sizes.dust_largest);
  for (std::size_t k = 0; k <= last; ++k) edges.push_back(SizeTable::edge(k));
  // The last class ends at the largest dust size, unless that is its lower edge.
  edges.push_back(std::max(sizes.dust_largest, edges.back() * (1 + 1e-12)));
  const auto shares = dust_shares(function, parent, sizes, edges);
  double rest = sizes.dust;  // the table gets all of the mass
  for (std::size_t k = 0; k <= last; ++k) {
    const double mass = k == last ? rest : std::min(sizes.dust * shares[k], rest);
    const double x = k == 0 ? 0.5 * edges[1] : std::sqrt(edges[k] * edges[k + 1]);
    if (mass > 0) table.add(x, mass, mass / (density * std::numbers::pi / 6 * x * x * x), time);
    rest -= mass;
  }
  table.include(sizes.dust_largest);
}

}  // namespace silt
