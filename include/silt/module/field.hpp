// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/module/concept.hpp>

namespace silt::inline SILT_TARGET {

/// A name as a template argument.
template <std::size_t N>
struct FixedName {
  char characters[N];
  constexpr FixedName(const char (&name)[N]) { std::copy_n(name, N, characters); }  // NOLINT
  constexpr std::string_view view() const { return {characters, N - 1}; }
};

/// A user-defined number or vector per particle: set and read by name, saved in checkpoints, sorted
/// with the particles, written to VTK and CSV.
///
///   silt::Simulation sim{beads, contacts, silt::Field<"charge">{}};
///   sim.field<"charge">(k) = 1e-12;
///
/// T: double or Vec3d. Tests: tests/engine/modules.cpp.
/// Source: none.
/// Valid:  every shape.
/// Units:  chosen by the user.
/// Errors: a T other than double or Vec3d, and an unknown name, do not compile.
template <FixedName Name, class T = double>
struct Field {
  static_assert(std::is_same_v<T, double> || std::is_same_v<T, Vec3d>,
                "Field<Name, T>: T must be double or silt::Vec3d");
  T initial{};  // of each new particle
  /// Of the whole particle, as a charge: a fragment has its share by volume. Otherwise a fragment
  /// has the value of the grain that broke, as a temperature.
  bool extensive = false;
  struct Fields {
    T value;
  };
  static constexpr std::array<std::string_view, 1> names{Name.view()};
  Fields start(const Seen&) const { return {initial}; }
  void divide(Fields& f, double share) const {
    if (extensive) f.value *= share;
  }
};

}  // namespace silt
