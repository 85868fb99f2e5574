// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/mix.hpp>

namespace silt::inline SILT_TARGET {

/// Shape of a body for averaging: points that fill it, and its extent.
///
///   const silt::AveragedForm form = silt::averaged_form(silt::SuperEllipsoid{2e-3, 1e-3, 1e-3},
///   100);
///
/// Lengths are in radii of the sphere of equal volume, in the principal frame, about the centroid.
/// Points are quasi-random (additive recurrence with powers of the root of g^4 = g + 1) with equal
/// weights. They are shifted to give the body's centroid; the distributed quantities then have the
/// right first moment on average.
///
/// gauge(x) is the factor by which the body must be scaled about its centroid to reach x: exact for
/// super-ellipsoids; other shapes are replaced by the ellipsoid with their moments of inertia. It
/// is 1 on the surface and homogeneous of degree one.
/// Sources: sequence: M. Roberts, The unreasonable effectiveness of quasirandom sequences (2018).
/// Errors:  InputError for fewer than 1 or more than 1e6 points.
/// Tests:   tests/coupling/averaging_bodies.cpp.
struct AveragedForm {
  DynArray<Vec3d> points;    // [-]
  Vec3d axes{1, 1, 1};       // [-] semi-axes of the (super-)ellipsoid of the gauge
  double s1 = 2, s2 = 2;     // [-] its exponents
  double smallest_axis = 1;  // [-]
  /// The gauge is that of a sphere (also for a cube), and so are kernels.
  bool sphere = false;

  bool ellipsoid() const { return s1 == 2 && s2 == 2; }
};

namespace detail {

inline bool holds_point(const Ball& b, const Vec3d& x) {
  return dot(x - b.centre, x - b.centre) <= b.radius * b.radius;
}
inline bool holds_point(const SuperEllipsoid& s, const Vec3d& x) { return s.value(x) <= 0; }
inline bool holds_point(const PolySuperEllipsoid& s, const Vec3d& x) { return s.value(x) <= 0; }
inline bool holds_point(const Polyhedron& s, const Vec3d& x) {
  if (s.radius() > 0) return sphere_contact(x, 0, PlacedPolyhedron{&s, {}}).overlap > 0;
  for (const auto& face : s.faces())
    if (dot(face.normal, x) > face.offset) return false;
  return true;
}
/// Bounding sphere about the part's origin, and position of the origin.
inline Ball bounding_ball(const Ball& b) { return b; }
template <class S>
Ball bounding_ball(const S& s) {
  return {{0, 0, 0}, s.bounding_radius()};
}

}  // namespace detail

/// Averaging form of any of silt's shapes, with this number of interior points.
template <class S>
AveragedForm averaged_form(const S& shape, int points = 100) {
  require(points >= 1 && points <= 1000000, "averaged_form: ", points,
          " interior points must be in [1, 1000000]");
  AveragedForm form;
  if constexpr (std::is_same_v<S, Sphere>) {
    form.sphere = true;
    return averaged_form(SuperEllipsoid{1, 1, 1}, points);
  } else {
    shape.check();
    const MassProperties mass = shape.mass_properties();
    const auto parts = detail::SolidsOf<S>::solids(shape, mass);
    const double radius = std::cbrt(0.75 * mass.volume / std::numbers::pi);
    Box box;
    for (const auto& part : parts) {
      const Ball bound =
          std::visit([](const auto& solid) { return detail::bounding_ball(solid); }, part.solid);
      const Vec3d centre = part.centre + rotate(part.axes, bound.centre);
      const double r = bound.radius;
      box.include(Box{centre - Vec3d{r, r, r}, centre + Vec3d{r, r, r}});
    }
    const auto inside = [&](const Vec3d& x) {
      for (const auto& part : parts)
        if (std::visit(
                [&](const auto& solid) {
                  return detail::holds_point(solid, rotate(conjugate(part.axes), x - part.centre));
                },
                part.solid))
          return true;
      return false;
    };
    // Root of g^4 = g + 1: 1/g, 1/g^2, 1/g^3.
    constexpr double step[3]{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    const Vec3d e = box.extent();
    Vec3d mean{0, 0, 0};
    const double most = 1e5 * points + 1e6;
    for (double k = 1; static_cast<int>(form.points.size()) < points; ++k) {
      require(k < most, "averaged_form: the shape fills too little of the box around it");
      const auto at = [&](int d) { return std::fmod(0.5 + k * step[d], 1.0); };
      const Vec3d x = box.min + Vec3d{at(0) * e.x, at(1) * e.y, at(2) * e.z};
      if (!inside(x)) continue;
      form.points.push_back(x * (1 / radius));
      mean += form.points.back();
    }
    mean *= 1.0 / points;
    for (Vec3d& x : form.points) x -= mean;
    if constexpr (std::is_same_v<S, SuperEllipsoid>) {
      form.axes = {shape.a / radius, shape.b / radius, shape.c / radius};
      form.s1 = shape.s1, form.s2 = shape.s2;
      form.sphere = shape.a == shape.b && shape.b == shape.c && form.ellipsoid();
    } else {
      // I_x = V/5 (b^2 + c^2) and so on; then scaled to the body's volume.
      const Vec3d& I = mass.inertia;
      const auto axis = [&](double u, double v, double w) {
        return std::sqrt(std::max(2.5 / mass.volume * (v + w - u), 1e-6 * radius * radius));
      };
      const Vec3d a{axis(I.x, I.y, I.z), axis(I.y, I.z, I.x), axis(I.z, I.x, I.y)};
      form.axes = a * (1 / std::cbrt(a.x * a.y * a.z));
      form.sphere = std::max({a.x, a.y, a.z}) <= (1 + 1e-3) * std::min({a.x, a.y, a.z});
    }
    form.smallest_axis = std::min({form.axes.x, form.axes.y, form.axes.z});
    return form;
  }
}

}  // namespace silt
