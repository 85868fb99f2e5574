// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <utility>

#include <silt/module/field.hpp>

namespace silt::inline SILT_TARGET {

/// Force on each particle, given by any function of the particle's state and optionally of a field:
/// an electric field, a magnet, a centrifuge.
///
///   silt::BodyForce{[](const silt::Seen& p) { return -0.1 * p.velocity; }}                 // [N]
///   silt::BodyForce{silt::Field<"charge">{}, [=](const silt::Seen& p, double q) {
///     return q * cross(p.velocity, B);
///   }}
///
/// The function returns a Vec3d [N], or a Push with a torque. Other members of a module (rate(),
/// update()) need a struct: silt/module/concept.hpp.
/// Tests:  tests/engine/modules.cpp.
///
/// Source: none.
/// Valid:  forces that change little within a time step.
/// Units:  [N], [N m].
/// Errors: does not compile if the function returns neither a Vec3d nor a Push.
template <class Function, class Own = void>
struct BodyForce;

template <class Function>
struct BodyForce<Function, void> {
  Function function;
  auto force(const Seen& p) const { return function(p); }
};

template <class Function, FixedName Name, class T>
struct BodyForce<Function, Field<Name, T>> {
  Field<Name, T> field;
  Function function;
  using Fields = typename Field<Name, T>::Fields;
  static constexpr auto names = Field<Name, T>::names;
  Fields start(const Seen& p) const { return field.start(p); }
  auto force(const Seen& p, const Fields& own) const { return function(p, own.value); }
};

template <class Function>
BodyForce(Function) -> BodyForce<Function, void>;
template <FixedName Name, class T, class Function>
BodyForce(Field<Name, T>, Function) -> BodyForce<Function, Field<Name, T>>;

}  // namespace silt
