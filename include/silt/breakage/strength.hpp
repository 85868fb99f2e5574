// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include <silt/breakage/concept.hpp>
#include <silt/core/error.hpp>
#include <silt/core/random.hpp>

namespace silt::inline SILT_TARGET {

/// Strengths of particles with the diameter d and the rank P in (0, 1):
///
///   LogLogisticStrength   P = 1 - 1/(1 + (F/F50)^s),       F = F50 (P/(1 - P))^(1/s)      (1)
///   WeibullStrength       P = 1 - exp(-(F/F0)^m),          F = F0 (-ln(1 - P))^(1/m)      (2)
///   LogNormalStrength     P = Phi(ln(F/F50)/sigma),        F = F50 exp(sigma z(P))        (3)
///       F50 or F0 = its value at the diameter d0 times (d/d0)^b                           (4)
///   TavaresStrength       P = Phi(ln(E*/E50)/sigma), E* = Emax E/(Emax - E)               (5)
///       E50 = Einf/(1 + kp/kst) (1 + (d0/d)^phi)   per mass [J/kg]                        (6)
///   VogelPeukertStrength  P = 1 - exp(-f_mat d (W - W_min)), d W_min given; W [J/kg]      (7)
///
/// (1) to (4) hold for forces [N] and energies [J]: values have the unit of the loads with which
/// they are compared. (5) to (7) are energies [J]: the particle's mass times (5), (7). In (5) E50
/// is the median of E*; the median of E is E50/(1 + E50/Emax). (7) is for one impact (k = 1).
///
/// Source: (1) by Rozenblat et al. 2011 (recalled); (2), (3) textbooks; (5), (6) Tavares and King
///         1998, Tavares and Carvalho 2009 (recalled); (7) Vogel and Peukert 2003 (recalled). No
///         material data are built in; those of docs/breakage.md are recalled or synthetic.
/// Valid:  d > 0. `weaker` at loads >= 0. The two functions are inverse to rounding.
/// Units:  SI: d [m], mass [kg].
/// Errors: check() throws InputError naming field, value, unit and allowed range.
/// Tests:  tests/breakage/strength.cpp.
namespace detail {
inline void require_exponent(std::string_view name, double value) {
  require(std::isfinite(value), name, " = ", value, " [-] must be finite");
}
}  // namespace detail

struct LogLogisticStrength {
  double median;       // [N or J] F50 at `at_diameter`, > 0
  double at_diameter;  // [m] d0 > 0
  double exponent;     // [-] b
  double spread;       // [-] s > 0: larger is narrower
  static constexpr std::array names{"median", "at_diameter", "exponent", "spread"};

  double strength(double diameter, double /*mass*/, double rank) const {
    return median_at(diameter) * std::pow(rank / (1 - rank), 1 / spread);
  }
  double weaker(double load, double diameter, double /*mass*/) const {
    return 1 / (1 + std::pow(median_at(diameter) / load, spread));
  }
  double median_at(double diameter) const {
    return median * std::pow(diameter / at_diameter, exponent);
  }
  void check() const {
    require_positive("LogLogisticStrength.median", median, "N or J");
    require_positive("LogLogisticStrength.at_diameter", at_diameter, "m");
    detail::require_exponent("LogLogisticStrength.exponent", exponent);
    require_positive("LogLogisticStrength.spread", spread, "-");
  }
};

struct WeibullStrength {
  double scale;        // [N or J] F0 at `at_diameter`, > 0: 63 % are weaker
  double at_diameter;  // [m] d0 > 0
  double exponent;     // [-] b
  double modulus;      // [-] m > 0: larger is narrower
  static constexpr std::array names{"scale", "at_diameter", "exponent", "modulus"};

  double strength(double diameter, double /*mass*/, double rank) const {
    return scale_at(diameter) * std::pow(-std::log1p(-rank), 1 / modulus);
  }
  double weaker(double load, double diameter, double /*mass*/) const {
    return -std::expm1(-std::pow(load / scale_at(diameter), modulus));
  }
  double scale_at(double diameter) const {
    return scale * std::pow(diameter / at_diameter, exponent);
  }
  void check() const {
    require_positive("WeibullStrength.scale", scale, "N or J");
    require_positive("WeibullStrength.at_diameter", at_diameter, "m");
    detail::require_exponent("WeibullStrength.exponent", exponent);
    require_positive("WeibullStrength.modulus", modulus, "-");
  }
};

struct LogNormalStrength {
  double median;       // [N or J] F50 at `at_diameter`, > 0
  double at_diameter;  // [m] d0 > 0
  double exponent;     // [-] b
  double deviation;    // [-] sigma > 0, of ln F
  static constexpr std::array names{"median", "at_diameter", "exponent", "deviation"};

  double strength(double diameter, double /*mass*/, double rank) const {
    return median_at(diameter) * std::exp(deviation * detail::normal_quantile(rank));
  }
  double weaker(double load, double diameter, double /*mass*/) const {
    return detail::normal_probability_below(std::log(load / median_at(diameter)) / deviation);
  }
  double median_at(double diameter) const {
    return median * std::pow(diameter / at_diameter, exponent);
  }
  void check() const {
    require_positive("LogNormalStrength.median", median, "N or J");
    require_positive("LogNormalStrength.at_diameter", at_diameter, "m");
    detail::require_exponent("LogNormalStrength.exponent", exponent);
    require_positive("LogNormalStrength.deviation", deviation, "-");
  }
};

struct TavaresStrength {
  double infinite;                 // [J/kg] Einf > 0
  double at_diameter;              // [m] d0 > 0
  double exponent;                 // [-] phi >= 0
  double deviation;                // [-] sigma > 0
  double contact_stiffness_ratio;  // [-] kp/kst >= 0, particle over steel
  double largest_ratio = std::numeric_limits<double>::infinity();  // [-] Emax/E50 > 0; inf: none
  static constexpr LoadUnit unit = LoadUnit::Energy;
  static constexpr std::array names{
      "infinite",     "at_diameter", "exponent", "deviation", "contact_stiffness_ratio",
      "largest_ratio"};

  double strength(double diameter, double mass, double rank) const {
    const double star = std::exp(deviation * detail::normal_quantile(rank));  // E*/E50
    return mass * specific_median(diameter) * star / (1 + star / largest_ratio);
  }
  double weaker(double load, double diameter, double mass) const {
    const double ratio = load / (mass * specific_median(diameter));  // E/E50
    if (ratio >= largest_ratio) return 1;
    const double star = ratio / (1 - ratio / largest_ratio);
    return detail::normal_probability_below(std::log(star) / deviation);
  }
  /// (6): E50 [J/kg]
  double specific_median(double diameter) const {
    return infinite / (1 + contact_stiffness_ratio) *
           (1 + std::pow(at_diameter / diameter, exponent));
  }
  void check() const {
    require_positive("TavaresStrength.infinite", infinite, "J/kg");
    require_positive("TavaresStrength.at_diameter", at_diameter, "m");
    require_not_negative("TavaresStrength.exponent", exponent, "-");
    require_positive("TavaresStrength.deviation", deviation, "-");
    require_not_negative("TavaresStrength.contact_stiffness_ratio", contact_stiffness_ratio, "-");
    require(largest_ratio > 0, "TavaresStrength.largest_ratio = ", largest_ratio,
            " [-] must be greater than 0 (infinity: no upper limit of strengths)");
  }
};

struct VogelPeukertStrength {
  double f_mat;  // [kg/(J m)] > 0
  double least;  // [J m/kg] d W_min >= 0: no breakage below
  static constexpr LoadUnit unit = LoadUnit::Energy;
  static constexpr std::array names{"f_mat", "least"};

  double strength(double diameter, double mass, double rank) const {
    return mass * (least - std::log1p(-rank) / f_mat) / diameter;
  }
  double weaker(double load, double diameter, double mass) const {
    const double above = diameter * load / mass - least;  // [J m/kg]
    return above > 0 ? -std::expm1(-f_mat * above) : 0;
  }
  void check() const {
    require_positive("VogelPeukertStrength.f_mat", f_mat, "kg/(J m)");
    require_not_negative("VogelPeukertStrength.least", least, "J m/kg");
  }
};

static_assert(Strength<LogLogisticStrength> && Strength<WeibullStrength> &&
              Strength<LogNormalStrength> && Strength<TavaresStrength> &&
              Strength<VogelPeukertStrength>);

}  // namespace silt
