// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <type_traits>
#include <variant>

#include <silt/core/dyn_array.hpp>
#include <silt/core/target.hpp>
#include <silt/shape/mass_properties.hpp>

namespace silt::inline SILT_TARGET {

/// Shape without orientation: a sphere, given by its radius. Required:
///   static double volume(double radius)          [m3]
///   static double inertia_factor()               [-] I / (m r^2), isotropic
template <class S>
concept Shape = requires(double radius) {
  { S::volume(radius) } -> std::same_as<double>;
  { S::inertia_factor() } -> std::same_as<double>;
};

/// A sphere of a body.
struct Ball {
  Vec3d centre;   // [m] in the body's frame
  double radius;  // [m]
  bool operator==(const Ball&) const = default;
};

/// Shape with an orientation. A value of it is one form, shared by many particles, each with its
/// own size. Required:
///   void check() const                           throws InputError, one sentence
///   MassProperties mass_properties() const       for density 1
/// Optional: operator==. Equal forms are one form of a simulation; without it, every copy is a
/// form.
template <class S>
concept BodyShape = requires(const S& form) {
  requires S::is_body;
  form.check();
  { form.mass_properties() } -> std::same_as<MassProperties>;
};

/// Kinds of convex parts of bodies: Ball, SuperEllipsoid, PolySuperEllipsoid, Polyhedron, in this
/// order.
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

/// Convex part of a body.
template <class Kinds>
struct SolidPart;
template <class... Kind>
struct SolidPart<KindList<Kind...>> {
  std::variant<Kind...> solid;  // in its own frame
  Vec3d centre{0, 0, 0};        // [m] origin of that frame, in the body's principal frame
  Quaternion axes{};            // rotates that frame into the body's
};

/// Body shape whose parts have their own narrow phases (shape/narrow/). Also required:
///   using Kinds = KindList<...>                  kinds of its parts
///   static constexpr bool one_part               always a single part, in the principal frame
///   DynArray<SolidPart<Kinds>> solids(const MassProperties&) const
///   SurfaceMesh surface_of(form)                 for display
/// Other body shapes are sets of spheres: DynArray<Ball> parts() const, in any frame.
template <class S>
concept SolidShape = BodyShape<S> && requires(const S& form, const MassProperties& mass) {
  { form.solids(mass) } -> std::convertible_to<DynArray<SolidPart<typename S::Kinds>>>;
  { S::one_part } -> std::convertible_to<bool>;
};

}  // namespace silt
