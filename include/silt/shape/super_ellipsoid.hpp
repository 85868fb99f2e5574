// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <silt/core/dyn_array.hpp>
#include <silt/shape/concept.hpp>

namespace silt::inline SILT_TARGET {

/// Super-ellipsoid (|x/a|^s2 + |y/b|^s2)^(s1/s2) + |z/c|^s1 <= 1: sphere, ellipsoid (s1 = s2 = 2),
/// cylinder (s1 large, s2 = 2), box (both large). Convex, symmetric about three planes.
///
///   f = A^(s1/s2) + |z/c|^s1 - 1,  A = |x/a|^s2 + |y/b|^s2                                    (1)
///   h(n) = ((|a nx|^p2 + |b ny|^p2)^(p1/p2) + |c nz|^p1)^(1/p1),  p = s/(s - 1)               (2)
///   r^2 = |(|(a^2, b^2)|_t2, c^2)|_t1,  t = s/(s - 2): the largest |x|, a dual norm too       (3)
///   V = 2 a b c e1 e2 B(e1/2 + 1, e1) B(e2/2, e2/2),  e = 2/s, B Euler's beta function        (4)
///   kappa_m = (|g|^2 tr H - g.H g) / (2 |g|^3),  g, H gradient and Hessian of f               (5)
///
/// Source: A. H. Barr, IEEE Comput. Graph. Appl. 1 (1981) 11; A. Jaklic et al., Segmentation and
///         Recovery of Superquadrics (2000), ch. 2 (volume, inertia); (2), (3): Hoelder's
///         inequality.
/// Valid:  s1, s2 in [2, 40], largest over smallest semi-axis <= 30.
/// Units:  SI; points and normals in the body's own axes, normals of any length except 0.
/// Errors: check() throws InputError: field, value, unit, range.
/// Tests:  tests/shape/super_ellipsoid.cpp.
struct SuperEllipsoid {
  static constexpr bool is_body = true, one_part = true;
  using Kinds = KindList<SuperEllipsoid>;

  double a, b, c;  // [m] semi-axes
  double s1 = 2;   // [-] exponent between z and the x-y plane
  double s2 = 2;   // [-] exponent in the x-y plane
  /// [-] Faces are slightly rounded in the contact search, because on a flat face the normal does
  /// not determine the point. The rounding is at most 3 times this part of the smallest semi-axis,
  /// and 0 at s = 2. See shape/narrow/super_ellipsoid_cap.hpp.
  double face_rounding = 1e-4;

  bool operator==(const SuperEllipsoid&) const = default;

  void check() const {
    require_positive("SuperEllipsoid.a", a, "m");
    require_positive("SuperEllipsoid.b", b, "m");
    require_positive("SuperEllipsoid.c", c, "m");
    require_in("SuperEllipsoid.s1", s1, "-", 2, 40);
    require_in("SuperEllipsoid.s2", s2, "-", 2, 40);
    require_in("SuperEllipsoid.face_rounding", face_rounding, "-", 1e-8, 1e-2);
    const double aspect = std::max({a, b, c}) / smallest_axis();
    require(aspect <= 30 * (1 + 1e-12),
            "SuperEllipsoid: largest over smallest semi-axis = ", aspect,
            " [-] must not be greater than 30");
  }

  double smallest_axis() const { return std::min({a, b, c}); }
  /// Description of the form for comparison (checkpoints): visit(name, number).
  template <class Visit>
  void describe(const Visit& visit) const {
    visit("semi-axis a [m]", a), visit("semi-axis b [m]", b), visit("semi-axis c [m]", c);
    visit("exponent s1", s1), visit("exponent s2", s2), visit("face_rounding", face_rounding);
  }

  // ---- the surface ------------------------------------------------------------------------------

  /// f of (1) [-]: negative inside.
  double value(const Vec3d& x) const {
    return std::pow(in_plane(x), s1 / s2) + std::pow(std::abs(x.z / c), s1) - 1;
  }

  /// grad f [1/m]; on the surface along the outward normal.
  Vec3d gradient(const Vec3d& x) const {
    const double A = in_plane(x), q = A > 0 ? s1 * std::pow(A, s1 / s2 - 1) : 0;
    return {q / a * odd_power(x.x / a, s2 - 1), q / b * odd_power(x.y / b, s2 - 1),
            s1 / c * odd_power(x.z / c, s1 - 1)};
  }

  /// Second derivatives of f [1/m2]. On the z axis those of s1 = 2 < s2 depend on the direction;
  /// the ones along x and y are returned.
  Symmetric3 hessian(const Vec3d& x) const {
    const double A = in_plane(x), r = s1 / s2;
    Symmetric3 H;
    H.zz = s1 * (s1 - 1) / (c * c) * std::pow(std::abs(x.z / c), s1 - 2);
    if (A <= 0) {
      if (s1 == 2) H.xx = 2 / (a * a), H.yy = 2 / (b * b);
      return H;
    }
    const double Ax = s2 / a * odd_power(x.x / a, s2 - 1), Ay = s2 / b * odd_power(x.y / b, s2 - 1);
    const double first = r * std::pow(A, r - 1), second = first * (r - 1) / A;
    const double curve = s2 * (s2 - 1) * first;
    H.xx = second * Ax * Ax + curve / (a * a) * std::pow(std::abs(x.x / a), s2 - 2);
    H.yy = second * Ay * Ay + curve / (b * b) * std::pow(std::abs(x.y / b), s2 - 2);
    H.xy = second * Ax * Ay;
    return H;
  }

  /// Point of the surface on the ray from the centre through x.
  Vec3d surface_point(const Vec3d& x) const {
    // First to a point near the surface: far from it powers overflow, or are lost beside the 1 of
    // f.
    const Vec3d y = x * (1 / std::max({std::abs(x.x / a), std::abs(x.y / b), std::abs(x.z / c)}));
    return y * std::pow(value(y) + 1, -1 / s1);
  }

  /// Mean curvature (5) [1/m] at a point of the surface; 1/R for a sphere.
  double mean_curvature(const Vec3d& x) const {
    const Vec3d g = gradient(x);
    const Symmetric3 H = hessian(x);
    const double g2 = dot(g, g);
    const double gHg = H.xx * g.x * g.x + H.yy * g.y * g.y + H.zz * g.z * g.z +
                       2 * (H.xy * g.x * g.y + H.yz * g.y * g.z + H.zx * g.z * g.x);
    return (g2 * H.trace() - gHg) / (2 * g2 * std::sqrt(g2));
  }

  /// Radius of curvature [m] for Hertz' law at a point of the surface: from the mean curvature, at
  /// most the bounding radius (faces), at least 0.05 radii of the sphere of equal volume (corners).
  double contact_radius(const Vec3d& x) const {
    const double smallest = 0.05 * equal_volume_radius(), largest = bounding_radius();
    return 1 / std::clamp(mean_curvature(x), 1 / largest, 1 / smallest);
  }

  // ---- support ----------------------------------------------------------------------------------

  /// h(n) of (2) [m] for unit n: distance from the centre to the tangent plane with normal n.
  double height(const Vec3d& n) const {
    const double p1 = dual(s1);
    return std::pow(std::pow(height_in_plane(n), p1) + std::pow(std::abs(c * n.z), p1), 1 / p1);
  }

  /// Point of the surface with the outward normal n; the middle of a face if n is the face's
  /// normal.
  Vec3d support(const Vec3d& n) const {
    const double p1 = dual(s1), p2 = dual(s2), h = height(n), A = height_in_plane(n);
    const double q = A > 0 ? std::pow(A / h, p1 - 1) : 0;
    const auto in = [&](double u) { return A > 0 ? q * odd_power(u / A, p2 - 1) : 0; };
    return {a * in(a * n.x), b * in(b * n.y), c * odd_power(c * n.z / h, p1 - 1)};
  }

  // ---- mass -------------------------------------------------------------------------------------

  double volume() const {  // [m3]
    return 2 * a * b * c * e1() * e2() * beta(0.5 * e1() + 1, e1()) * beta(0.5 * e2(), 0.5 * e2());
  }

  double equal_volume_radius() const {  // [m] of the sphere
    return std::cbrt(0.75 * volume() / std::numbers::pi_v<double>);
  }

  /// Moments of inertia about the axes at density 1 [m5].
  Vec3d inertia() const {
    const double common = 0.5 * a * b * c * e1() * e2();
    const double plane = beta(1.5 * e2(), 0.5 * e2()) * beta(0.5 * e1(), 2 * e1() + 1);
    const double axial = 4 * c * c * beta(0.5 * e2(), 0.5 * e2() + 1) * beta(1.5 * e1(), e1() + 1);
    return {common * (b * b * plane + axial), common * (a * a * plane + axial),
            common * (a * a + b * b) * plane};
  }

  MassProperties mass_properties() const { return {volume(), {0, 0, 0}, inertia(), {}}; }

  DynArray<SolidPart<Kinds>> solids(const MassProperties&) const { return {{*this, {}, {}}}; }

  double bounding_radius() const {  // [m], (3)
    return std::sqrt(dual_norm(dual_norm(a * a, b * b, s2), c * c, s1));
  }

  /// By quadrature, error about 1e-6 [m2].
  double surface_area() const;

  /// Surface of the sphere of equal volume over its own [-]; 1 for a sphere.
  double sphericity() const {
    const double r = equal_volume_radius();
    return 4 * std::numbers::pi_v<double> * r * r / surface_area();
  }

  /// Euler's beta function.
  static double beta(double x, double y) {
    return std::exp(std::lgamma(x) + std::lgamma(y) - std::lgamma(x + y));
  }

 private:
  double e1() const { return 2 / s1; }
  double e2() const { return 2 / s2; }
  static double dual(double s) { return s / (s - 1); }
  static double odd_power(double x, double power) {
    return std::copysign(std::pow(std::abs(x), power), x);
  }
  double in_plane(const Vec3d& x) const {
    return std::pow(std::abs(x.x / a), s2) + std::pow(std::abs(x.y / b), s2);
  }
  double height_in_plane(const Vec3d& n) const {
    const double p2 = dual(s2);
    return std::pow(std::pow(std::abs(a * n.x), p2) + std::pow(std::abs(b * n.y), p2), 1 / p2);
  }
  /// (u^t + v^t)^(1/t), t = s/(s - 2); the larger of both at s = 2.
  static double dual_norm(double u, double v, double s) {
    const double large = std::max(u, v), ratio = std::min(u, v) / large;
    if (s == 2) return large;
    const double t = s / (s - 2);
    return large * std::exp(std::log1p(std::pow(ratio, t)) / t);
  }
};

static_assert(SolidShape<SuperEllipsoid>);

namespace detail {

/// Area of the part of the surface of a super-ellipsoid's first octant where x / a is largest;
/// `form` has its axes in the order of that part. Chart: the ray through (a, b u, c v); nodes are
/// concentrated at u, v = 1, where the edges are.
template <class Gauge>
double area_of_part(double a, double b, double c, const Gauge& gauge) {
  constexpr int panels = 40;
  constexpr double node[3]{0.5 - 0.3872983346207417, 0.5, 0.5 + 0.3872983346207417};
  constexpr double weight[3]{5.0 / 18, 8.0 / 18, 5.0 / 18};
  double u[3 * panels], w[3 * panels], area = 0;
  for (int k = 0; k < 3 * panels; ++k) {
    const double t = 1 - (k / 3 + node[k % 3]) / panels;
    u[k] = 1 - t * t * t, w[k] = 3 * t * t * weight[k % 3] / panels;
  }
  for (int k = 0; k < 3 * panels; ++k)
    for (int l = 0; l < 3 * panels; ++l) {
      Vec3d slope;  // of the gauge in (1, u, v)
      const double g = gauge(Vec3d{1, u[k], u[l]}, slope);
      const Vec3d p{a, b * u[k], c * u[l]};
      const Vec3d du = Vec3d{0, b, 0} - p * (slope.y / g), dv = Vec3d{0, 0, c} - p * (slope.z / g);
      area += w[k] * w[l] * norm(cross(du, dv)) / (g * g);
    }
  return area;
}

}  // namespace detail

inline double SuperEllipsoid::surface_area() const {
  const SuperEllipsoid unit{1, 1, 1, s1, s2};
  const auto part = [&](double along, double u, double v, auto to_axes, auto from_axes) {
    return detail::area_of_part(along, u, v, [&](const Vec3d& t, Vec3d& slope) {
      const Vec3d x = to_axes(t);
      const double f = unit.value(x) + 1, g = std::pow(f, 1 / s1);
      slope = from_axes(unit.gradient(x)) * (g / (s1 * f));
      return g;
    });
  };
  const auto same = [](const Vec3d& t) { return t; };
  // y is the part's first axis
  const auto on = [](const Vec3d& t) { return Vec3d{t.z, t.x, t.y}; };
  const auto back = [](const Vec3d& x) { return Vec3d{x.y, x.z, x.x}; };  // inverse of `on`
  return 8 * (part(a, b, c, same, same) + part(b, c, a, on, back) + part(c, a, b, back, on));
}

}  // namespace silt
