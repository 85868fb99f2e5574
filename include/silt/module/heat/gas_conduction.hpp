// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <silt/module/heat/surroundings.hpp>

namespace silt::inline SILT_TARGET {

/// A gas in the gaps between particles that are close to each other or touch:
/// particle-fluid-particle conduction.
struct GapGas {
  double conductivity = 0.026;  // [W/(m K)] k_g; air at 20 C
  double roughness = 0;         // [m] h > 0, the smallest gap
  double gap = 0;               // [m] L > h, the largest gap through which heat flows

  /// [W/K] of two spheres of reduced radius R_eff [m] at the surface distance s [m]; s < 0: they
  /// touch. At a wall R_eff is the radius.
  ///
  ///   H = 2 pi k_g R* (1 - s/h + ln(L/h))    for s < h, and s = 0 if they touch             (1)
  ///   H = 2 pi k_g R* ln(L/s)                for h < s < L                                  (2)
  double conductance(double R_eff, double s) const {
    const double apart = std::max(s, 0.0);
    if (!(apart < gap)) return 0;
    const double flat = std::max(0.0, 1 - apart / roughness);
    return 2 * std::numbers::pi * conductivity * R_eff *
           (flat + std::log(gap / std::max(apart, roughness)));
  }
  void check(const std::string& name) const {
    require_positive(name + ".conductivity", conductivity, "W/(m K)");
    require_positive(name + ".roughness", roughness, "m");
    require(std::isfinite(gap) && gap > roughness, name, ".gap = ", gap,
            " [m] must be finite and greater than roughness = ", roughness);
  }
};

/// Module: heat (HeatConduction, FrictionHeat, Heat or MutualRadiation), and conduction through the
/// gas in the gaps between neighbouring particles, in contact or not.
///
///   silt::GasConduction{silt::HeatConduction{...}, {.conductivity = 0.026, .roughness = 1e-6,
///                                                   .gap = 0.2e-3}}
///
///   H = integral of 2 pi r k_g/max(l(r), h) dr over l < L,   l = s + r^2/(2 R*)              (1)
///
/// between isothermal surfaces: the gas conducts straight across the local gap l, and no farther
/// than l = L. The closed form is in GapGas. The result depends on both lengths by their
/// logarithms. L stands for the width at which other particles take over the heat; with L = 0.4 R
/// a particle has a gas film of 0.2 R, as is usual (recalled).
///
/// Source: (1) D. Rong, M. Horio, Inter. Conf. CFD in the Mineral and Process Industries (1999),
///         recalled, here with the gap as a parabola; leading term of G. K. Batchelor,
///         R. W. O'Brien, Proc. R. Soc. A 355 (1977) 313, recalled.
/// Valid:  particles that conduct far better than the gas, as their surfaces are taken as
///         isothermal; L up to some 0.4 R, where the parabola gives 1.01 to 1.06 times the integral
///         between equal spheres (tests/physics/gas_conduction.cpp).
/// Units:  SI. Shapes: spheres; bodies as their bounding sphere.
/// Errors: InputError naming field, value and unit.
/// Tests:  tests/physics/gas_conduction.cpp.
template <class Base>
struct GasConduction : Base {
  GapGas gas;

  GasConduction(Base base, const GapGas& of) : Base(std::move(base)), gas(of) {}

  double gap_reach() const {
    if constexpr (base_in_pairs)
      return std::max(gas.gap, Base::gap_reach());
    else
      return gas.gap;
  }
  double pair_flux(const Apart& d, const Seen& a, const HeatFields& of_a, const Seen& b,
                   const HeatFields& of_b) const {  // [W]
    double flux = conductance(d, a, b) * (of_b.temperature - of_a.temperature);
    if constexpr (base_in_pairs)
      if (surface_distance(d, a, b) < Base::gap_reach())
        flux += Base::pair_flux(d, a, of_a, b, of_b);
    return flux;
  }
  double pair_slope(const Apart& d, const Seen& a, const HeatFields& of_a, const Seen& b,
                    const HeatFields& of_b) const {  // [W/K]
    double slope = conductance(d, a, b);
    if constexpr (base_in_pairs)
      if (surface_distance(d, a, b) < Base::gap_reach())
        slope += Base::pair_slope(d, a, of_a, b, of_b);
    return slope;
  }
  template <class Sim>
  void check(const Sim& sim) const {
    Base::check(sim);
    gas.check("GasConduction");
  }

 private:
  static constexpr bool base_in_pairs = requires { &Base::pair_flux; };
  static double surface_distance(const Apart& d, const Seen& a, const Seen& b) {
    return d.distance - a.radius - b.radius;
  }
  double conductance(const Apart& d, const Seen& a, const Seen& b) const {
    return gas.conductance(a.radius * b.radius / (a.radius + b.radius), surface_distance(d, a, b));
  }
};

/// Part of Heat: conduction through the gas between particles and a plane of one temperature, as in
/// GasConduction.
/// Source: as GasConduction, with R* = R.
/// Valid:  as GasConduction; the plane is large compared with the particles.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/physics/gas_conduction.cpp.
struct PlaneGasConduction {
  Vec3d point{0, 0, 0};         // [m]
  Vec3d normal{0, 0, 1};        // [-] any length, towards the particles
  double temperature = 293.15;  // [K]
  GapGas gas = {};

  double watts(const Seen& p, double T, double, double) const {
    return slope(p, T) * (temperature - T);
  }
  double slope(const Seen& p, double) const {  // [W/K]
    const double s = dot(p.position - point, normal) / norm(normal) - p.radius;
    return s > -p.radius ? gas.conductance(p.radius, s) : 0;
  }
  void check() const {
    gas.check("PlaneGasConduction.gas");
    require_not_negative("PlaneGasConduction.temperature", temperature, "K");
    require(is_finite(point) && is_finite(normal) && norm(normal) > 0,
            "PlaneGasConduction: its point ", point, " [m] and normal ", normal,
            " must be finite, and the normal not 0");
  }
};

}  // namespace silt
