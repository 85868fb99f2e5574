// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>
#include <variant>
#include <vector>

#include <silt/core/target.hpp>
#include <silt/shape/mass_properties.hpp>

namespace silt::inline SILT_TARGET {

/// A sphere, by its radius alone: of particles that have no orientation. Needs
///   static double volume(double radius)          [m3]
///   static double inertia_factor()               [-] I / (m r^2), isotropic
template <class S>
concept Shape = requires(double radius) {
  { S::volume(radius) } -> std::same_as<double>;
  { S::inertia_factor() } -> std::same_as<double>;
};

/// A sphere that belongs to a body.
struct Ball {
  Vec3d centre;   // [m] in the body's frame
  double radius;  // [m]
  bool operator==(const Ball&) const = default;
};

/// A shape with an orientation. A value of it is one form, which many particles may have, each in
/// its own size. Needs
///   void check() const                           throws InputError, one sentence
///   MassProperties mass_properties() const       of unit density
/// Forms that operator== says are equal are one form of a simulation; without it, copies are.
template <class S>
concept BodyShape = requires(const S& form) {
  requires S::is_body;
  form.check();
  { form.mass_properties() } -> std::same_as<MassProperties>;
};

/// The kinds of convex parts that bodies may have: Ball, SuperEllipsoid, PolySuperEllipsoid,
/// Polyhedron, in this order.
template <class... Kind>
struct KindList {
  static constexpr std::size_t count = sizeof...(Kind);
  template <class K>
  static constexpr bool has = (std::is_same_v<K, Kind> || ...);
  template <class K>
  static constexpr std::size_t index = [] {
    std::size_t k = 0;
    (void)((std::is_same_v<K, Kind> || (++k, false)) || ...);
    return k;
  }();
};

/// A convex part of a body.
template <class Kinds>
struct SolidPart;
template <class... Kind>
struct SolidPart<KindList<Kind...>> {
  std::variant<Kind...> solid;  // in its own frame
  Vec3d centre{0, 0, 0};        // [m] of that frame's origin, in the body's principal frame
  Quaternion axes{};            // turns that frame into the body's
};

/// A body shape whose parts have narrow phases of their own (shape/narrow/). Needs besides
///   using Kinds = KindList<...>                  that its parts may have
///   static constexpr bool one_part               a single part, in the principal frame, always
///   std::vector<SolidPart<Kinds>> solids(const MassProperties&) const
///   SurfaceMesh surface_of(form)                 to show it
/// Others are spheres that belong together: std::vector<Ball> parts() const, in any frame.
template <class S>
concept SolidShape = BodyShape<S> && requires(const S& form, const MassProperties& mass) {
  { form.solids(mass) } -> std::same_as<std::vector<SolidPart<typename S::Kinds>>>;
  { S::one_part } -> std::convertible_to<bool>;
};

}  // namespace silt
