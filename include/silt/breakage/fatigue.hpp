// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <silt/breakage/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Fatigue: strength of a particle after a load below its strength.
///
///   NoFatigue       F_s' = F_s
///   PowerFatigue    F_s' = F_s (1 - kappa (F/F_s)^psi)                                       (1)
///   TavaresFatigue  D = (2 g/(2 g - 5 D + 5) E/E_f)^(2 g/5),  E_f' = E_f (1 - D)             (2)
///                   of forces: E/E_f = (F/F_s)^(5/3),  F_s' = F_s (1 - D)^(3/5)              (3)
///
/// With a = 5/(2 g) and u = D^a, (2) is (1 + a) u - a u^(1 + 1/a) = E/E_f. In [0, 1] the left side
/// increases from 0 to 1 and is concave; there is one root. Newton's iterates from u = (E/E_f)/(1 +
/// a), below the root, increase to it and cannot pass it.
///
/// Source: (1) silt's own form with synthetic coefficients. (2) Tavares and King 2002 (recalled).
///         (3) Hertz: E ~ F^(5/3).
/// Valid:  0 <= load <= strength. D = 1 at load = strength; near it D behaves as a square root,
///         with an error of 1e-8.
/// Units:  those of the strength.
/// Errors: check() throws InputError naming field, value, unit and allowed range.
/// Tests:  tests/breakage/fatigue.cpp.
struct NoFatigue {
  double weakened(double strength, double /*load*/) const { return strength; }
  void check() const {}
};

struct PowerFatigue {
  double kappa;  // [-] in [0, 1): loss by a load just below the strength
  double psi;    // [-] > 0: a larger value reduces the effect of small loads
  static constexpr std::array names{"kappa", "psi"};

  double weakened(double strength, double load) const {
    return strength * (1 - kappa * std::pow(load / strength, psi));
  }
  void check() const {
    require(kappa >= 0 && kappa < 1, "PowerFatigue.kappa = ", kappa, " [-] must be in [0, 1)");
    require_positive("PowerFatigue.psi", psi, "-");
  }
};

struct TavaresFatigue {
  double gamma;   // [-] g > 0: a larger value reduces the effect of small loads; about 5
  LoadUnit unit;  // of strengths and loads

  /// (2): damage D [-] by a load of energy E, from E/E_f in [0, 1].
  double damage(double energy_ratio) const {
    const double a = 2.5 / gamma, ratio = std::clamp(energy_ratio, 0.0, 1.0);
    double u = ratio / (1 + a);
    for (int iteration = 0; iteration < 60; ++iteration) {
      const double D = std::pow(u, 1 / a);
      const double short_of = ratio - u * (1 + a - a * D), slope = (1 + a) * (1 - D);
      if (!(short_of > 1e-16 * ratio) || !(slope > 0)) break;
      u = std::min(u + short_of / slope, 1.0);
    }
    return std::pow(u, 1 / a);
  }
  double weakened(double strength, double load) const {
    const bool force = unit == LoadUnit::Force;
    const double ratio = load / strength;
    const double left = 1 - damage(force ? std::pow(ratio, 5.0 / 3.0) : ratio);
    return strength * (force ? std::pow(left, 0.6) : left);
  }
  void check() const { require_positive("TavaresFatigue.gamma", gamma, "-"); }
};

static_assert(Fatigue<NoFatigue> && Fatigue<PowerFatigue> && Fatigue<TavaresFatigue>);

}  // namespace silt
