// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <compare>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

#include <silt/shape/narrow/placed.hpp>

namespace silt::inline SILT_TARGET {

/// Data of a kind of convex part for the kernels:
///   Row                      a part of given size, as numbers that can be copied
///   row(part, scale, store, which)    the same, scaled by `scale` [-]; other data is in `store`,
///                            under the number of the part
///   place(row, axes, at)     a part at its place, a ConvexSet
///   bound, least_radius      [m] of the smallest sphere around it about its origin, and of a large
///                            inscribed sphere
///   in_lanes                 whether touch() of narrow/super_ellipsoids.hpp accepts it; Form is
///                            then Row with Reals for doubles
template <class Kind>
struct KernelOf;

/// Number of a part in a form (BodyForm::made).
struct PartOfForm {
  std::size_t form = 0, part = 0;
  auto operator<=>(const PartOfForm&) const = default;
};

template <>
struct KernelOf<Ball> {
  using Row = SphereForm<double>;
  struct Store {};
  static constexpr bool in_lanes = true;
  template <class Real, Exponents>
  using Form = SphereForm<Real>;

  static Row row(const Ball& ball, double scale, Store&, PartOfForm = {}) {
    return sphere_form(scale * ball.radius);
  }
  static PlacedBall place(const Row& row, const BodyAxes<double>&, const Vec3d& at) {
    return {row.bound, at};
  }
  static double bound(const Ball& ball) { return ball.radius; }
  static double least_radius(const Ball& ball) { return ball.radius; }
  static Exponents exponents(const Ball&) { return Exponents::Ball; }
};

namespace detail {
/// A form scaled by `scale` [-].
template <class Form>
Form scaled_form(Form f, double scale) {
  const double square = scale * scale;
  f.axes2 = f.axes2 * square;
  if constexpr (requires { f.minus2; }) f.minus2 = f.minus2 * square;
  f.e2 *= square, f.e_p1 *= std::pow(scale, f.p1), f.e_p2 *= std::pow(scale, f.p2);
  f.size *= scale, f.bound *= scale;
  return f;
}
}  // namespace detail

template <>
struct KernelOf<SuperEllipsoid> {
  using Row = SuperForm<double>;
  struct Store {};
  static constexpr bool in_lanes = true;
  template <class Real, Exponents E>
  using Form = SuperForm<Real, E>;

  static Row row(const SuperEllipsoid& shape, double scale, Store&, PartOfForm = {}) {
    return detail::scaled_form(form_of(shape), scale);
  }
  static PlacedSuper<Row> place(const Row& row, const BodyAxes<double>& axes, const Vec3d& at) {
    return {row, axes, at};
  }
  static double bound(const SuperEllipsoid& shape) { return shape.bounding_radius(); }
  static double least_radius(const SuperEllipsoid& shape) { return shape.smallest_axis(); }
  static Exponents exponents(const SuperEllipsoid& shape) { return exponents_of(shape); }
};

template <>
struct KernelOf<PolySuperEllipsoid> {
  using Row = PolyForm<double>;
  struct Store {};
  static constexpr bool in_lanes = true;
  template <class Real, Exponents E>
  using Form = PolyForm<Real, E>;

  static Row row(const PolySuperEllipsoid& shape, double scale, Store&, PartOfForm = {}) {
    return detail::scaled_form(form_of(shape), scale);
  }
  static PlacedSuper<Row> place(const Row& row, const BodyAxes<double>& axes, const Vec3d& at) {
    return {row, axes, at};
  }
  static double bound(const PolySuperEllipsoid& shape) { return shape.bounding_radius(); }
  static double least_radius(const PolySuperEllipsoid& shape) {
    return shape.smallest_octant().smallest_axis();
  }
  static Exponents exponents(const PolySuperEllipsoid& shape) {
    return exponents_of(shape.s1, shape.s2);
  }
};

template <>
struct KernelOf<Polyhedron> {
  struct Row {
    const Polyhedron* shape;
  };
  /// One entry per size of each part, as long as there are particles of that size.
  struct Store {
    std::map<std::pair<PartOfForm, double>, std::unique_ptr<Polyhedron>> now, before;
    void begin_renewal() { std::swap(now, before); }
    void end_renewal() { before.clear(); }
  };
  static constexpr bool in_lanes = false;

  static Row row(const Polyhedron& shape, double scale, Store& store, PartOfForm part = {}) {
    auto& kept = store.now[{part, scale}];
    if (auto one = store.before.extract({part, scale}); !kept && one)
      kept = std::move(one.mapped());
    if (!kept) kept = std::make_unique<Polyhedron>(shape.scaled(scale));
    return {kept.get()};
  }
  static PlacedPolyhedron place(const Row& row, const BodyAxes<double>& axes, const Vec3d& at) {
    return {row.shape, {at, RotationMatrix{axes.x, axes.y, axes.z}}};
  }
  static double bound(const Polyhedron& shape) { return shape.bounding_radius(); }
  static double least_radius(const Polyhedron& shape) {
    double inside = shape.bounding_radius();
    for (const auto& face : shape.faces()) inside = std::min(inside, face.offset);
    return inside + shape.radius();
  }
  static Exponents exponents(const Polyhedron&) { return Exponents::Ball; }
};

}  // namespace silt
