// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>

#include <silt/breakage/concept.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Breakage functions: B(x), share of the mass of a parent of diameter d in fragments with
/// diameters below x.
///
///   GaudinSchuhmann    B = (x/(k d))^q up to x = k d,  k = coarsest (strength/load)^refining  (1)
///   RosinRammler       B = (1 - exp(-(x/x63)^n))/(1 - exp(-(d/x63)^n))                        (2)
///   Austin             B = share (x/d)^fine + (1 - share) (x/d)^coarse                        (3)
///   VogelPeukertSizes  B = (x/d)^q h(x)/h(d),  h = 1 + tanh((x - x0)/x0),  q = c v + q0       (4)
///   T10Sizes: breakage/t10_sizes.hpp
///
/// Source: (1) to (3) textbooks; the decrease of k with the load is silt's own form; without
///         `refining` k is constant. (4) Vogel and Peukert 2005 (recalled), here divided by its
///         value at d, which is 1 - 2 exp(2 - 2 d/x0): 3e-8 below 1 at d = 10 x0. No material data
///         are built in.
/// Valid:  0 <= x; 1 from largest() on.
/// Units:  SI.
/// Errors: check() throws InputError naming field, value, unit and allowed range; check_sizes tests
///         any breakage function.
/// Tests:  tests/breakage/sizes.cpp.
struct GaudinSchuhmann {
  double exponent;      // [-] q > 0
  double coarsest;      // [-] in (0, 1]: largest fragment over the parent at load = strength
  double refining = 0;  // [-] >= 0: how fast the largest fragment shrinks with the load
  static constexpr std::array names{"exponent", "coarsest", "refining"};

  double finer(double x, const Broken& parent) const {
    const double share = x / largest(parent);
    return share >= 1 ? 1 : share > 0 ? std::pow(share, exponent) : 0;
  }
  double largest(const Broken& parent) const {
    const double k = parent.load > parent.strength && refining > 0
                         ? coarsest * std::pow(parent.strength / parent.load, refining)
                         : coarsest;
    return k * parent.diameter;
  }
  void check() const {
    require_positive("GaudinSchuhmann.exponent", exponent, "-");
    require(coarsest > 0 && coarsest <= 1, "GaudinSchuhmann.coarsest = ", coarsest,
            " [-] must be in (0, 1]");
    require_not_negative("GaudinSchuhmann.refining", refining, "-");
  }
};

struct RosinRammler {
  double characteristic;  // [-] x63/d > 0
  double exponent;        // [-] n > 0
  static constexpr std::array names{"characteristic", "exponent"};

  double finer(double x, const Broken& parent) const {
    const double share = x / parent.diameter;
    if (share >= 1) return 1;
    return share > 0 ? below(share) / below(1) : 0;
  }
  double largest(const Broken& parent) const { return parent.diameter; }
  void check() const {
    require_positive("RosinRammler.characteristic", characteristic, "-");
    require_positive("RosinRammler.exponent", exponent, "-");
  }

 private:
  double below(double share) const {
    return -std::expm1(-std::pow(share / characteristic, exponent));
  }
};

struct Austin {
  double share;            // [-] phi in [0, 1] of the fine part
  double coarse_exponent;  // [-] >= fine_exponent
  double fine_exponent;    // [-] > 0
  static constexpr std::array names{"share", "coarse_exponent", "fine_exponent"};

  double finer(double x, const Broken& parent) const {
    const double ratio = x / parent.diameter;
    if (ratio >= 1) return 1;
    if (!(ratio > 0)) return 0;
    return share * std::pow(ratio, fine_exponent) + (1 - share) * std::pow(ratio, coarse_exponent);
  }
  double largest(const Broken& parent) const { return parent.diameter; }
  void check() const {
    require_in("Austin.share", share, "-", 0, 1);
    require_positive("Austin.fine_exponent", fine_exponent, "-");
    require(std::isfinite(coarse_exponent) && coarse_exponent >= fine_exponent,
            "Austin.coarse_exponent = ", coarse_exponent,
            " [-] must be finite and not below fine_exponent = ", fine_exponent, " [-]");
  }
};

struct VogelPeukertSizes {
  double per_speed;  // [s/m] c >= 0
  double exponent;   // [-] q0 > 0: q of a slow impact
  double finest;     // [m] x0 > 0, lower end of the power law
  static constexpr std::array names{"per_speed", "exponent", "finest"};

  double finer(double x, const Broken& parent) const {
    const double d = parent.diameter, ratio = x / d;
    if (ratio >= 1) return 1;
    if (!(ratio > 0)) return 0;
    return std::pow(ratio, per_speed * parent.speed + exponent) * fines(x) / fines(d);
  }
  double largest(const Broken& parent) const { return parent.diameter; }
  void check() const {
    require_not_negative("VogelPeukertSizes.per_speed", per_speed, "s/m");
    require_positive("VogelPeukertSizes.exponent", exponent, "-");
    require_positive("VogelPeukertSizes.finest", finest, "m");
  }

 private:
  double fines(double x) const { return 1 + std::tanh((x - finest) / finest); }
};

static_assert(BreakageFunction<GaudinSchuhmann> && BreakageFunction<RosinRammler> &&
              BreakageFunction<Austin> && BreakageFunction<VogelPeukertSizes>);

/// Refuses a breakage function that would create or lose mass, tested at 1200 sizes from 1e-9 d to
/// d: shares outside [0, 1], a share that decreases with size, not 0 at 0, not 1 from the largest
/// fragment on, or a largest fragment larger than the parent. A decrease below 1e-6 is accepted
/// (fragment_sizes takes no mass from it), because fits of several t_n cross by as much.
template <BreakageFunction Function>
void check_sizes(const Function& function, const Broken& parent) {
  const double d = parent.diameter, most = function.largest(parent);
  require_positive("breakage function: the parent's diameter", d, "m");
  require(most > 0 && most <= d * (1 + 1e-12), "breakage function: largest() = ", most,
          " [m] must be greater than 0 and no more than the parent's diameter ", d, " [m]");
  const auto at = [&](double x) {
    const double share = function.finer(x, parent);
    require(share >= 0 && share <= 1 + 1e-12, "breakage function: finer(", x, " [m]) = ", share,
            " [-] of a parent of ", d, " [m] must be in [0, 1]");
    return share;
  };
  double before = at(0), x_before = 0;
  require(before == 0, "breakage function: finer(0) = ", before,
          " [-] must be 0: no fragment is smaller than size 0");
  for (const double x : {most, 0.5 * (most + d), d, 2 * d})
    require(at(x) >= 1 - 1e-12, "breakage function: finer(", x, " [m]) = ", at(x),
            " [-] must be 1 from largest() = ", most, " [m] on: otherwise mass is lost");
  for (int k = 0; k <= 1200; ++k) {
    const double x = d * std::pow(10.0, -9.0 * (1200 - k) / 1200), share = at(x);
    require(share >= before - 1e-6, "breakage function: finer(", x, " [m]) = ", share,
            " [-] is below finer(", x_before, " [m]) = ", before,
            " [-], and the mass between them would be negative: finer() must not decrease");
    before = share, x_before = x;
  }
}

}  // namespace silt
