// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <silt/core/error.hpp>
#include <silt/module/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Fields of modules of heat.
struct HeatFields {
  double temperature = 293.15;  // [K]
};

/// Temperature of particles [K], for any module that has it: sim.field<silt::Temperature>(k).
struct Temperature {
  using Of = HeatFields;
  static constexpr auto member = &HeatFields::temperature;
};

/// Thermal properties of a solid.
struct ThermalMaterial {
  double conductivity = 0;     // [W/(m K)] > 0
  double heat_capacity = 0;    // [J/(kg K)] > 0
  double youngs_modulus = 0;   // [Pa] of the real solid if contacts are softer; 0: as in the
                               // contacts
  double poisson_ratio = 0.3;  // [-] of the real solid
  double density = 0;          // [kg/m3] of the real solid, for FrictionHeat; 0: as its partner's
};

/// Thermal condition of a wall: held_at(), heated_by() or insulated().
class WallHeat {
 public:
  using OfTime = std::function<double(double)>;
  enum class Kind { Insulated, HeldAt, HeatedBy };

  WallHeat() = default;
  WallHeat(Kind kind, OfTime value) : kind_(kind), value_(std::move(value)) {}
  /// With a constant value.
  WallHeat(Kind kind, double value) : kind_(kind), value_([value](double) { return value; }) {
    constant_ = true;
  }
  Kind kind() const { return kind_; }
  bool is_constant() const { return constant_; }
  /// [K] or [W] at a time [s]; empty for a wall of another kind.
  std::optional<double> value(Kind kind, double time) const {
    if (kind != kind_ || !value_) return std::nullopt;
    return value_(time);
  }

 private:
  Kind kind_ = Kind::Insulated;
  bool constant_ = false;
  OfTime value_;
};

/// No heat flux through the wall.
inline WallHeat insulated() { return {}; }
/// Wall with this temperature [K].
inline WallHeat held_at(double temperature) {
  require_not_negative("held_at: temperature", temperature, "K");
  return {WallHeat::Kind::HeldAt, temperature};
}
/// Wall with a temperature that is a function of time [s].
inline WallHeat held_at(WallHeat::OfTime temperature) {
  require(bool(temperature), "held_at: the function of time is empty; give one that returns [K]");
  return {WallHeat::Kind::HeldAt, std::move(temperature)};
}
/// The wall gives this heat flow [W] to all particles in contact with it together, like a plate of
/// uniform temperature and no heat capacity. Without contacts the flow is 0. Negative: cooling.
inline WallHeat heated_by(double power) {
  require(std::isfinite(power), "heated_by: power = ", power, " [W] must be finite");
  return {WallHeat::Kind::HeatedBy, power};
}
inline WallHeat heated_by(WallHeat::OfTime power) {
  require(bool(power), "heated_by: the function of time is empty; give one that returns [W]");
  return {WallHeat::Kind::HeatedBy, std::move(power)};
}

}  // namespace silt
