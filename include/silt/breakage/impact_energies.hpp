// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Histogram of impact energies 1/2 m* v^2 [J], v the speed of approach along the normal: classes
/// by factors of 2, from 2^-100 J on.
class ImpactEnergies {
 public:
  static constexpr int classes = 128, lowest = -100;

  void add(double m_eff, double speed, bool at_wall) {
    const double energy = 0.5 * m_eff * speed * speed;
    const int c = energy > 0 ? std::clamp(std::ilogb(energy) - lowest, 0, classes - 1) : 0;
    auto& one = (at_wall ? walls_ : pairs_)[static_cast<std::size_t>(c)];
    ++one.count, one.energy += energy;
  }
  struct Class {
    double from, to;                    // [J]
    std::uint64_t at_walls, in_pairs;   // [-]
    double walls_energy, pairs_energy;  // [J] their sum
  };
  /// Classes from the first to the last non-empty one.
  DynArray<Class> table() const {
    DynArray<Class> all;
    for (std::size_t c = 0; c < classes; ++c) {
      if (walls_[c].count + pairs_[c].count == 0 && all.empty()) continue;
      all.push_back({std::ldexp(1.0, static_cast<int>(c) + lowest),
                     std::ldexp(1.0, static_cast<int>(c) + lowest + 1), walls_[c].count,
                     pairs_[c].count, walls_[c].energy, pairs_[c].energy});
    }
    while (!all.empty() && all.back().at_walls + all.back().in_pairs == 0) all.pop_back();
    return all;
  }
  DynArray<double> state() const {
    DynArray<double> all;
    for (const auto* of : {&walls_, &pairs_})
      for (const One& one : *of)
        all.insert(all.end(), {static_cast<double>(one.count), one.energy});
    return all;
  }
  static constexpr std::size_t numbers = 4 * classes;
  void restore(const DynArray<double>& all) {
    std::size_t at = 0;
    for (auto* of : {&walls_, &pairs_})
      for (One& one : *of)
        one.count = static_cast<std::uint64_t>(all[at]), one.energy = all[at + 1], at += 2;
  }

 private:
  struct One {
    std::uint64_t count = 0;
    double energy = 0;
  };
  std::array<One, classes> walls_{}, pairs_{};
};

}  // namespace silt
