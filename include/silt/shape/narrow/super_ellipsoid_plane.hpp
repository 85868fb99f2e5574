// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/shape/narrow/super_ellipsoids.hpp>

namespace silt::inline SILT_TARGET {

/// Contact of a super-ellipsoid i with a plane j, exact and without iteration: the lowest point of
/// the body is its support point.
///
///   overlap = h_i(-n) - distance,  point = p_i(-n) + n overlap / 2,  R_eff = R_i
///
/// `normal` n is the plane's unit normal towards the body, `distance` [m] that of the centre from
/// the plane. `first_R_eff` is the memory: R_eff of the first touch, 0 while apart; see
/// ContactRadius.
/// Shapes:  Real = double or a pack of doubles. Tests: tests/shape/super_ellipsoid_contact.cpp.
template <ContactRadius Radius = ContactRadius::AtFirstTouch, class Form,
          class Real = typename Form::Real>
inline BodyContact<Real> touch_plane(const Form& form, const BodyAxes<Real>& axes,
                                     const Vec3<Real>& normal, const Real& distance,
                                     Real& first_R_eff) {
  const Real zero(0);
  Vec3<Real> s, t;
  tangents(normal, s, t);
  const auto cap = cap_at(form, -axes.to_body(normal), axes.to_body(s), axes.to_body(t));
  BodyContact<Real> out;
  out.overlap = cap.height - distance;
  out.touches = out.overlap > zero;
  out.normal = normal;
  out.point = s * cap.along_s + t * cap.along_t - normal * (cap.height - Real(0.5) * out.overlap);
  out.R_eff = contact_radius(form, cap);
  if constexpr (Radius == ContactRadius::AtFirstTouch)
    out.R_eff = select(first_R_eff > zero, first_R_eff, out.R_eff);
  first_R_eff = select(out.touches, out.R_eff, zero);
  out.residual = zero;
  out.solved = distance == distance;
  return out;
}

}  // namespace silt
