// silt - BSD-3-Clause, see LICENSE
#pragma once
#include <cmath>
#include <silt/breakage/impact.hpp>
namespace silt::inline SILT_TARGET {
struct LogLogisticStrength { double median, at_diameter, exponent, spread;
  double strength(double d, double, double rank) const { return median * std::pow(d / at_diameter, exponent) * std::pow(rank / (1 - rank), 1 / spread); }
  double weaker(double load, double d, double) const { const double f50 = median * std::pow(d / at_diameter, exponent); return 1 - 1 / (1 + std::pow(load / f50, spread)); }
  void check() const {} };
struct HertzEquivalence { static constexpr LoadUnit unit = LoadUnit::Force;
  double load(const Impact& i) const { const double e = i.restitution, a = e >= 1 ? 0 : 4 / (5 * 3.14159265358979) * std::atan(3.14159265358979 / std::abs(std::log(e))); return i.elastic_force * (e >= 1 ? 1 : std::pow(std::pow(e, a), 1.5)); } void check() const {} };
struct ForceEquivalence { static constexpr LoadUnit unit = LoadUnit::Force; static constexpr bool by_force = true; double load(const Impact& i) const { return i.contact_force; } void check() const {} };
struct GaudinSchuhmann { double exponent, largest; void check() const {} };
}
