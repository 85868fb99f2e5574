// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>

#include <silt/breakage/concept.hpp>
#include <silt/breakage/impact.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

/// Equivalence functions: the load of an impact.
///
///   HertzEquivalence   F = F_el, of Hertz k_H^(2/5) (5/4 m* v^2)^(3/5) r^(3/2)               (1)
///                      r: largest overlap over that without damping (contact/impact.hpp)     (2)
///   PowerEquivalence   F = C v^p d^q                                                        (3)
///   EnergyEquivalence  E = m* v^2/2                                                         (4)
///   ForceEquivalence   F = the largest normal force of the contact
///
/// (1) is the elastic part of the largest force. The part of the dashpot is excluded, as it belongs
/// to the numerical damping, not to the particle. F_el is `Impact::elastic_force`, given by the
/// contact law; laws other than Hertz' have their own formula.
///
/// Source: (1), (2) Hertz; closed forms of contact/impact.hpp. (3) a power law of the kind used
///         with measured equivalences (recalled); with p = 1.2, q = 2 it is (1) for one pair of
///         materials. (4) Vogel and Peukert (recalled).
/// Valid:  as Hertz' theory. At a wall m* is the particle's mass; (4) is then its whole kinetic
///         energy.
/// Units:  SI.
/// Errors: InputError naming field, value, unit and allowed range.
/// Tests:  tests/breakage/equivalence.cpp.
struct HertzEquivalence {
  static constexpr LoadUnit unit = LoadUnit::Force;

  double load(const Impact& impact) const {
    require(!std::isnan(impact.elastic_force),
            "HertzEquivalence: Impact.elastic_force = nan [N]: the contact law has no closed form "
            "for it; use PowerEquivalence, EnergyEquivalence or ForceEquivalence");
    return impact.elastic_force;
  }
  void check() const {}
};

struct PowerEquivalence {
  double coefficient;           // [N (s/m)^p m^-q] C > 0
  double speed_exponent = 1.2;  // [-] p > 0
  double size_exponent = 2;     // [-] q
  static constexpr LoadUnit unit = LoadUnit::Force;
  static constexpr std::array names{"coefficient", "speed_exponent", "size_exponent"};

  double load(const Impact& impact) const {
    return coefficient * std::pow(impact.speed, speed_exponent) *
           std::pow(impact.diameter, size_exponent);
  }
  void check() const {
    require_positive("PowerEquivalence.coefficient", coefficient, "N (s/m)^p m^-q");
    require_positive("PowerEquivalence.speed_exponent", speed_exponent, "-");
    require(std::isfinite(size_exponent), "PowerEquivalence.size_exponent = ", size_exponent,
            " [-] must be finite");
  }
};

struct EnergyEquivalence {
  static constexpr LoadUnit unit = LoadUnit::Energy;

  double load(const Impact& impact) const {
    return 0.5 * impact.m_eff * impact.speed * impact.speed;
  }
  void check() const {}
};

struct ForceEquivalence {
  static constexpr LoadUnit unit = LoadUnit::Force;
  static constexpr bool by_force = true;  // contacts store their largest force

  double load(const Impact& impact) const {
    require(!std::isnan(impact.contact_force),
            "ForceEquivalence: Impact.contact_force = nan [N]: it is set only where breakage "
            "goes by the largest force; use HertzEquivalence, PowerEquivalence or "
            "EnergyEquivalence for impacts at first touch");
    return impact.contact_force;
  }
  void check() const {}
};

static_assert(Equivalence<HertzEquivalence> && Equivalence<PowerEquivalence> &&
              Equivalence<EnergyEquivalence> && Equivalence<ForceEquivalence>);

}  // namespace silt
