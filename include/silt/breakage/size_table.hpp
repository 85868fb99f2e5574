// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Compensated sum.
/// Source: A. Neumaier, ZAMM 54 (1974) 39. Error of some 1e-16 of the sum of absolute values, for
///         any number of terms.
class CompensatedSum {
 public:
  CompensatedSum() = default;
  CompensatedSum(double sum, double rest) : sum_(sum), rest_(rest) {}

  void add(double x) {
    const double next = sum_ + x;
    rest_ += std::abs(sum_) >= std::abs(x) ? (sum_ - next) + x : (x - next) + sum_;
    sum_ = next;
  }
  void add(const CompensatedSum& other) { add(other.sum_), add(other.rest_); }
  double value() const { return sum_ + rest_; }
  double sum() const { return sum_; }
  double rest() const { return rest_; }

 private:
  double sum_ = 0, rest_ = 0;
};

/// Mass and number of particles by size, with their arrival times: the dust, which is no longer
/// simulated, or what has left.
///
/// Diameter classes [edge(k), edge(k + 1)): ten of 1 um each up to 10 um, then each wider than the
/// previous one by sqrt(2), without limit. The time since 0 is divided into at most `most_bins`
/// equal intervals; when a time is beyond the last one, intervals are merged in pairs and their
/// width doubles.
///
/// Source: the classes are those of Brosh, Kalman and Levy 2014.
/// Valid:  sums of mass and number of 1e7 additions are right to 1e-12 (computed: 1e-15). finer()
///         is as exact at class edges. Within a class it errs, mostly upwards: by up to 1.5 % of
///         itself where the share is proportional to x, by 2 % at the kink of T10Sizes at d/10 for
///         parents of one size d.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range. A state is restored completely
///         or refused.
/// Tests:  tests/breakage/size_table.cpp.
class SizeTable {
 public:
  static constexpr std::size_t most_bins = 64;

  /// `bin_width` [s]: initial width of the time intervals.
  explicit SizeTable(double bin_width = 1e-3) : bin_width_(bin_width) {
    require_positive("SizeTable: bin_width", bin_width, "s");
  }

  /// Lower edge [m] of class k: 0, 1 um, 2 um, ..., 10 um, 14.1 um, 20 um, ...
  static double edge(std::size_t k) {
    if (k <= 10) return static_cast<double>(k) / 1e6;
    const auto doublings = static_cast<int>((k - 10) / 2);
    return std::ldexp(k % 2 == 0 ? 1e-5 : 1e-5 * 1.4142135623730951, doublings);
  }
  static std::size_t class_of(double diameter) {
    if (diameter < 1e-5) {
      auto k = static_cast<std::size_t>(std::max(diameter, 0.0) * 1e6);
      while (k > 0 && diameter < edge(k)) --k;  // the product is rounded
      return diameter >= edge(k + 1) ? k + 1 : k;
    }
    auto k = 10 + static_cast<std::size_t>(2 * std::log2(diameter / 1e-5));
    while (diameter < edge(k)) --k;
    return diameter >= edge(k + 1) ? k + 1 : k;
  }

  /// Adds `number` particles of this diameter [m] with the total mass [kg] at a time [s].
  void add(double diameter, double mass, double number, double time) {
    require_in("SizeTable: diameter", diameter, "m", 1e-300, 1e6);
    require_not_negative("SizeTable: mass", mass, "kg");
    require_not_negative("SizeTable: number", number, "-");
    require_not_negative("SizeTable: time", time, "s");
    const std::size_t bin = bin_of(time), k = class_of(diameter);
    if (k >= classes_.size()) classes_.resize(k + 1);
    classes_[k].mass.add(mass), classes_[k].number.add(number), classes_[k].in_time[bin].add(mass);
    include(diameter);
  }
  /// Adds another table. Both must have been made with the same bin width.
  void merge(const SizeTable& other) {
    int exponent = 0;
    require(std::frexp(other.bin_width_ / bin_width_, &exponent) == 0.5,
            "SizeTable: merge of a table with bins of ", other.bin_width_, " [s] into one of ",
            bin_width_,
            " [s]: one must be a power of 2 times the other; make both with the "
            "same bin_width");
    while (bin_width_ < other.bin_width_) double_bins();
    SizeTable added = other;
    while (added.bin_width_ < bin_width_) added.double_bins();
    if (classes_.size() < added.classes_.size()) classes_.resize(added.classes_.size());
    for (std::size_t k = 0; k < added.classes_.size(); ++k) {
      classes_[k].mass.add(added.classes_[k].mass);
      classes_[k].number.add(added.classes_[k].number);
      for (std::size_t bin = 0; bin < most_bins; ++bin)
        classes_[k].in_time[bin].add(added.classes_[k].in_time[bin]);
    }
    bins_ = std::max(bins_, added.bins_);
    include(added.largest_);
  }

  /// Number of classes up to the largest diameter added.
  std::size_t classes() const { return classes_.size(); }
  double mass(std::size_t k) const { return at(k).mass.value(); }      // [kg]
  double number(std::size_t k) const { return at(k).number.value(); }  // [-]
  double mass() const { return sum_of(&Class::mass); }                 // [kg] of all
  double number() const { return sum_of(&Class::number); }             // [-] of all

  /// Number of time intervals up to the last time added.
  std::size_t bins() const { return bins_; }
  double bin_width() const { return bin_width_; }  // [s]
  /// [kg] of class k in the time interval [bin, bin + 1) bin_width().
  double mass(std::size_t k, std::size_t bin) const {
    require(bin < bins_, "SizeTable: interval ", bin, " of time: there are ", bins_,
            ", counted from 0");
    return at(k).in_time[bin].value();
  }

  /// [m] largest diameter that was added, or passed to include().
  double largest() const { return largest_; }
  /// [m] end of class k: its upper edge; for the last class the largest diameter.
  double end_of(std::size_t k) const {
    if (k + 1 < classes_.size()) return edge(k + 1);
    return std::clamp(largest_, edge(k) + 1e-12 * edge(k + 1), edge(k + 1));
  }
  /// Extends the last class to this diameter [m].
  void include(double diameter) { largest_ = std::max(largest_, diameter); }

  /// Share of the mass [-] below the diameter x [m]. Linear in ln x within a class, in the first
  /// class in x; the last class ends at largest(). 0 for an empty table.
  double finer(double x) const {
    const double all = mass();
    if (!(x > 0) || !(all > 0)) return 0;
    if (x >= std::min(largest_, edge(classes_.size()))) return 1;
    const std::size_t within = class_of(x);
    CompensatedSum below;
    for (std::size_t k = 0; k < within; ++k) below.add(classes_[k].mass);
    const double a = edge(within), b = end_of(within);
    below.add(mass(within) * (within == 0 ? x / b : std::log(x / a) / std::log(b / a)));
    return std::min(below.value() / all, 1.0);
  }
  /// Diameter [m] below which this share in [0, 1] of the mass is, the inverse of finer():
  /// quantile(0.5) is d50.
  double quantile(double share) const {
    require_in("SizeTable: share", share, "-", 0, 1);
    const double all = mass();
    require(all > 0, "SizeTable: quantile(", share, ") of a table without mass");
    CompensatedSum below;
    double x = 0;
    for (std::size_t k = 0; k < classes_.size(); ++k) {
      if (!(mass(k) > 0)) continue;
      const double rest = share * all - below.value(), a = edge(k), b = end_of(k);
      if (rest <= 0 && below.value() > 0) return x;  // the upper edge of the previous class
      const double part = std::clamp(rest / mass(k), 0.0, 1.0);
      x = k == 0 ? b * part : a * std::pow(b / a, part);
      if (part < 1) return x;
      below.add(classes_[k].mass);
    }
    return x;
  }

  /// Complete state as numbers, for checkpoints.
  DynArray<double> state() const {
    DynArray<double> out{bin_width_, static_cast<double>(bins_),
                         static_cast<double>(classes_.size()), largest_};
    for (const Class& c : classes_) {
      for (const auto* sum : {&c.mass, &c.number})
        out.push_back(sum->sum()), out.push_back(sum->rest());
      for (std::size_t bin = 0; bin < bins_; ++bin)
        out.push_back(c.in_time[bin].sum()), out.push_back(c.in_time[bin].rest());
    }
    return out;
  }
  void restore(std::span<const double> state) {
    const auto wanted = [&](bool condition) {
      require(condition, "SizeTable: these ", state.size(),
              " numbers are not a state of a SizeTable");
    };
    wanted(state.size() >= 4 && std::isfinite(state[0]) && state[0] > 0 && state[1] >= 0 &&
           state[1] <= most_bins && state[2] >= 0 && state[2] <= 1e5);
    SizeTable read(state[0]);
    read.bins_ = static_cast<std::size_t>(state[1]);
    const auto count = static_cast<std::size_t>(state[2]), each = 2 * (2 + read.bins_);
    wanted(static_cast<double>(read.bins_) == state[1] && static_cast<double>(count) == state[2] &&
           state.size() == 4 + count * each);
    wanted(std::all_of(state.begin(), state.end(), [](double x) { return std::isfinite(x); }));
    read.classes_.resize(count);
    read.largest_ = state[3];
    wanted(count == 0 ? state[3] == 0 : state[3] >= edge(count - 1) && state[3] <= 1e6);
    auto from = state.begin() + 4;
    const auto next = [&] {
      const CompensatedSum sum(from[0], from[1]);
      from += 2;
      wanted(sum.value() >= 0);
      return sum;
    };
    for (Class& c : read.classes_) {
      c.mass = next(), c.number = next();
      for (std::size_t bin = 0; bin < read.bins_; ++bin) c.in_time[bin] = next();
    }
    *this = std::move(read);
  }

 private:
  struct Class {
    CompensatedSum mass, number;
    std::array<CompensatedSum, most_bins> in_time;
  };

  const Class& at(std::size_t k) const {
    require(k < classes_.size(), "SizeTable: class ", k, ": there are ", classes_.size(),
            ", counted from 0");
    return classes_[k];
  }
  double sum_of(CompensatedSum Class::*what) const {
    CompensatedSum sum;
    for (const Class& c : classes_) sum.add(c.*what);
    return sum.value();
  }
  std::size_t bin_of(double time) {
    while (time / bin_width_ >= most_bins) double_bins();
    const auto bin = static_cast<std::size_t>(time / bin_width_);
    bins_ = std::max(bins_, bin + 1);
    return bin;
  }
  void double_bins() {
    for (Class& c : classes_)
      for (std::size_t bin = 0; bin < most_bins; ++bin) {
        CompensatedSum pair;
        if (2 * bin < most_bins) pair = c.in_time[2 * bin], pair.add(c.in_time[2 * bin + 1]);
        c.in_time[bin] = pair;
      }
    bin_width_ *= 2;
    bins_ = (bins_ + 1) / 2;
  }

  double bin_width_;  // [s]
  std::size_t bins_ = 0;
  double largest_ = 0;  // [m]
  DynArray<Class> classes_;
};

/// Size tables: one for all, and with several materials one for each.
struct SizeTables {
  SizeTable all;
  DynArray<SizeTable> of;  // by material number, as far as any was added

  /// The table of this material; an empty one if nothing was added.
  SizeTable of_material(std::size_t material) const {
    return material < of.size() ? of[material] : SizeTable();
  }
  /// Calls add(table) for each table to which this material belongs.
  template <bool SeveralMaterials, class Add>
  void add(std::size_t material, const Add& add) {
    add(all);
    if constexpr (SeveralMaterials) {
      if (of.size() <= material) of.resize(material + 1);
      add(of[material]);
    }
  }
  /// State of the tables of materials as numbers: for each the length, then the numbers.
  DynArray<double> state_of_materials() const {
    DynArray<double> out;
    for (const SizeTable& table : of) {
      const auto numbers = table.state();
      out.push_back(static_cast<double>(numbers.size()));
      out.insert(out.end(), numbers.begin(), numbers.end());
    }
    return out;
  }
  /// InputError if the numbers are not a valid state.
  void restore_of_materials(const DynArray<double>& numbers) {
    of.clear();
    for (std::size_t at = 0; at < numbers.size();) {
      const double count = numbers[at++];
      require(count >= 0 && count <= static_cast<double>(numbers.size() - at),
              "SizeTables: the state has too few numbers");
      const auto from = numbers.begin() + static_cast<std::ptrdiff_t>(at);
      at += static_cast<std::size_t>(count);
      of.emplace_back().restore({from, numbers.begin() + static_cast<std::ptrdiff_t>(at)});
    }
  }
};

}  // namespace silt
