// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
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
};

/// A shape with an orientation. A value of it is one form, which many particles may have, each in
/// its own size. Needs
///   void check() const                           throws InputError, one sentence
///   MassProperties mass_properties() const       of unit density
///   std::vector<Ball> parts() const              the spheres that it consists of, any frame
template <class S>
concept BodyShape = requires(const S& form) {
  requires S::is_body;
  form.check();
  { form.mass_properties() } -> std::same_as<MassProperties>;
  { form.parts() } -> std::same_as<std::vector<Ball>>;
};

/// A convex body shape, one part, whose contacts are found by its own narrow phase. Needs besides
///   static constexpr bool is_convex = true
///   form_of(form): what the kernels take (shape/narrow/), in the principal frame
///   double least_radius() const                  [m] of the largest sphere inside
template <class S>
concept ConvexShape = BodyShape<S> && requires(const S& form) {
  requires S::is_convex;
  { form.least_radius() } -> std::same_as<double>;
};

}  // namespace silt
