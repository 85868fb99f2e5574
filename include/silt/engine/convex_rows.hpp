// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <vector>

#include <silt/core/row4.hpp>
#include <silt/core/storage.hpp>
#include <silt/engine/rows.hpp>
#include <silt/shape/narrow/super_ellipsoid_plane.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A Contacts type whose contacts keep, behind all else, what the narrow phase must know of the
/// last step: NormalMemory, number by number.
template <class ContactsType>
struct WithNormals : ContactsType {
  static constexpr bool rotates = true;
  static constexpr std::size_t memory_from = ContactsType::history;
  static constexpr std::size_t memory_size = sizeof(NormalMemory<double>) / sizeof(double);
  static constexpr std::size_t memory_radius = memory_from + memory_size - 1;  // R_eff: touching
  static constexpr std::size_t history = memory_from + memory_size;
};

/// Orientation and inertia of a convex body: one cache line.
struct alignas(64) PoseRow {
  Quaternion q;         // its axes to space
  Vec3d inv_inertia;    // [1/(kg m2)] about its axes
  double least_radius;  // [m] of the largest sphere inside
};
static_assert(sizeof(PoseRow) == 64);

/// A form as rows of four numbers.
template <class Form>
struct alignas(32) FormRow {
  static constexpr std::size_t rows = (sizeof(Form) / sizeof(double) + 3) / 4;
  double value[4 * rows] = {};
  void set(const Form& form) { std::memcpy(value, static_cast<const void*>(&form), sizeof form); }
};

/// A form `scale` [-] as large.
template <class Form>
Form scaled_form(Form f, double scale) {
  const double square = scale * scale;
  f.axes2 = f.axes2 * square;
  f.e2 *= square, f.e_p1 *= std::pow(scale, f.p1), f.e_p2 *= std::pow(scale, f.p2);
  f.size *= scale, f.bound *= scale;
  return f;
}

/// What the narrow phase knows of the rows of convex bodies.
template <class ShapeType>
struct ConvexRows {
  using Form = decltype(form_of(std::declval<const ShapeType&>()));
  AlignedVector<PoseRow> pose;            // of each row, and of two more: padding pairs
  AlignedVector<FormRow<Form>> form;      // of each row; of all, if there is only one
  Exponents exponents = Exponents::Ball;  // that all of them have

  double least_radius = 0;  // [m] of any of them

  bool one_form() const { return form.size() == 1; }
  const FormRow<Form>& form_row(std::size_t row) const { return form[one_form() ? 0 : row]; }
  template <Exponents E = Exponents::Any>
  auto form_at(std::size_t row) const {
    typename Form::template Of<double, E> f;
    std::memcpy(static_cast<void*>(&f), form_row(row).value, sizeof f);
    return f;
  }
};

template <class ShapeType>
struct ConvexRowsOf {
  using type = ConvexRows<ShapeType>;
};

/// Calls run with the exponents as a constant.
template <class Run>
auto with_exponents(Exponents e, const Run& run) {
  const auto as = [&]<Exponents E>() { return run(std::integral_constant<Exponents, E>{}); };
  switch (e) {
    case Exponents::Ball:
      return as.template operator()<Exponents::Ball>();
    case Exponents::Two:
      return as.template operator()<Exponents::Two>();
    case Exponents::Equal:
      return as.template operator()<Exponents::Equal>();
    default:
      return as.template operator()<Exponents::Any>();
  }
}

/// Rows of four numbers a lane, turned into columns.
template <class Arch, std::size_t Rows, class Real>
SILT_INLINE void gather_columns(const double* const* at, Real (&out)[4 * Rows]) {
  constexpr std::size_t W = Lanes<Arch>::width;
  for (std::size_t r = 0; r < Rows; ++r) {
    Row4<Arch> rows[W];
    for (std::size_t lane = 0; lane < W; ++lane) rows[lane] = Row4<Arch>::load(at[lane] + 4 * r);
    Real columns[4];
    rows_to_columns<Arch>(rows, columns);
    for (int c = 0; c < 4; ++c) out[4 * r + c] = columns[c];
  }
}

/// What of a body's motion its contacts need.
template <class Real>
struct BodyAtContact {
  Vec3<Real> velocity, spin;  // [m/s] of the centre, [rad/s]; at the last half step
  Real inv_m;                 // [1/kg]
  BodyAxes<Real> axes;
  Vec3<Real> inv_inertia;  // [1/(kg m2)] about these

  SILT_INLINE Vec3<Real> velocity_at(const Vec3<Real>& arm) const {
    return velocity + cross(spin, arm);
  }
  /// The inverse mass [1/kg] that a push along n meets at `arm`: 1/m + (r x n) I^-1 (r x n).
  SILT_INLINE Real inverse_mass(const Vec3<Real>& arm, const Vec3<Real>& n) const {
    const Vec3<Real> lever = axes.to_body(cross(arm, n));
    return inv_m + inv_inertia.x * lever.x * lever.x + inv_inertia.y * lever.y * lever.y +
           inv_inertia.z * lever.z * lever.z;
  }
};

inline BodyAtContact<double> body_at_contact(const MotionRow<true>& m, const PoseRow& p) {
  return {m.velocity(), m.spin_velocity() * m.inv_r, m.inv_m, body_axes(p.q), p.inv_inertia};
}

}  // namespace silt::detail
