// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include <silt/core/target.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Plane opening through which liquid enters or leaves an Sph: a rectangle, in 2D a segment. The
/// lengths of its edges must be multiples of the spacing.
struct Opening {
  Vec3d corner{0, 0, 0};       // [m]
  Vec3d edge{0, 0, 0};         // [m] from the corner to the next
  Vec3d second_edge{0, 0, 0};  // [m] normal to the first; omitted in 2D
  Vec3d into{0, 0, 0};         // normal to both, towards the liquid; any length
};

/// Value at an opening: a constant, or a function of position [m] and time [s]; or not given.
template <class Value>
class OpeningValue {
 public:
  using Function = std::function<Value(const Vec3d& place, double time)>;
  OpeningValue() = default;
  OpeningValue(const Value& value) : of_(value) {}  // NOLINT: implicit
  template <class Call>
  requires std::is_invocable_r_v<Value, const Call&, const Vec3d&, double> OpeningValue(Call call)
      : of_(Function(std::move(call))) {}  // NOLINT: implicit
  OpeningValue(double x, double y, double z) requires std::same_as<Value, Vec3d>
      : of_(Vec3d{x, y, z}) {}

  bool given() const { return of_.index() != 0; }
  const Value* constant() const { return std::get_if<Value>(&of_); }
  Value at(const Vec3d& place, double time) const {
    if (const Value* const value = constant()) return *value;
    return std::get<Function>(of_)(place, time);
  }

 private:
  std::variant<std::monostate, Value, Function> of_;
};

/// Pressure of a liquid at rest under gravity.
struct Hydrostatic {
  double surface = 0;  // [m] height of its surface, against gravity
};
/// Pressure at an opening of an Sph: [Pa], a function of place and time, or Hydrostatic.
class OpeningPressure : public OpeningValue<double> {
 public:
  using OpeningValue<double>::OpeningValue;
  OpeningPressure(const Hydrostatic& of) : hydrostatic(of) {}  // NOLINT: implicit
  bool given() const { return hydrostatic || OpeningValue<double>::given(); }
  std::optional<Hydrostatic> hydrostatic{};
};

/// Conditions at an opening. Values that are not given are taken from the liquid in front of it.
struct OpeningSetup {
  std::string name{};
  OpeningValue<Vec3d> velocity{};   // [m/s]; a function is called with points on the opening
  OpeningPressure pressure{};       // [Pa]
  std::optional<double> surface{};  // [m] height, against gravity; no liquid enters above it
};

/// Flow through an opening into the liquid, or out of it, since the start.
struct OpeningFlow {
  std::size_t particles = 0;
  double mass = 0;            // [kg]; 2D: [kg/m], and so on
  Vec3d momentum{0, 0, 0};    // [kg m/s]
  double kinetic_energy = 0;  // [J]
  double pressure_work = 0;   // [J] p/rho of its mass
};
struct OpeningBooks {
  OpeningFlow in, out;
  double mass() const { return in.mass - out.mass; }  // [kg] inflow minus outflow
};

}  // namespace silt
