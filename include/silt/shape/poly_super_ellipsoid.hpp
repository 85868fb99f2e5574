// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/core/dyn_array.hpp>
#include <silt/shape/super_ellipsoid.hpp>

namespace silt::inline SILT_TARGET {

/// Eight octants of super-ellipsoids with common exponents: the semi-axes on the two sides of each
/// plane differ. Smooth, convex, without symmetry.
///
///   octant moments  M_ijk = integral of x^i y^j z^k over one octant with axes a, b, c
///     = a^(i+1) b^(j+1) c^(k+1) / (s1 s2^2) G((i+1)/s2) G((j+1)/s2) / G(1 + (i+j+2)/s2)
///       B((k+1)/s1, 1 + (i+j+2)/s1)                                                            (1)
///
/// Points and normals are in the shape's frame, with its origin where the octants meet. The centre
/// of mass is elsewhere and the principal axes are rotated: mass_properties().
///
/// Source: S. Zhao, J. Zhao, Int. J. Numer. Anal. Methods Geomech. 43 (2019) 2147; (1) by
///         substitution, checked by sampling.
/// Valid:  as SuperEllipsoid. Units: SI. Errors: check() throws InputError.
/// Tests:  tests/shape/super_ellipsoid.cpp.
struct PolySuperEllipsoid {
  static constexpr bool is_body = true, one_part = false;  // its origin is not its centroid
  using Kinds = KindList<PolySuperEllipsoid>;

  Vec3d plus;     // [m] semi-axes towards +x, +y, +z
  Vec3d minus;    // [m] towards -x, -y, -z
  double s1 = 2;  // [-]
  double s2 = 2;  // [-]
  double face_rounding = 1e-4;

  bool operator==(const PolySuperEllipsoid&) const = default;

  void check() const {
    const auto largest = largest_octant(), smallest = smallest_octant();
    smallest.check(), largest.check();
    const double aspect = std::max({largest.a, largest.b, largest.c}) / smallest.smallest_axis();
    require(aspect <= 30 * (1 + 1e-12),
            "PolySuperEllipsoid: largest over smallest semi-axis = ", aspect,
            " [-] must not be greater than 30");
  }

  /// The super-ellipsoid that has the octant at x as a part.
  SuperEllipsoid octant(const Vec3d& x) const {
    return {x.x < 0 ? minus.x : plus.x,
            x.y < 0 ? minus.y : plus.y,
            x.z < 0 ? minus.z : plus.z,
            s1,
            s2,
            face_rounding};
  }

  double value(const Vec3d& x) const { return octant(x).value(x); }
  Vec3d gradient(const Vec3d& x) const { return octant(x).gradient(x); }
  /// The octant of a normal is that of its point: each component of the gradient has the sign of x.
  double height(const Vec3d& n) const { return octant(n).height(n); }
  Vec3d support(const Vec3d& n) const { return octant(n).support(n); }

  double volume() const { return moment(0, 0, 0); }  // [m3]
  /// Description of the form for comparison (checkpoints): visit(name, number).
  template <class Visit>
  void describe(const Visit& visit) const {
    visit("semi-axis towards +x [m]", plus.x), visit("semi-axis towards +y [m]", plus.y);
    visit("semi-axis towards +z [m]", plus.z), visit("semi-axis towards -x [m]", minus.x);
    visit("semi-axis towards -y [m]", minus.y), visit("semi-axis towards -z [m]", minus.z);
    visit("exponent s1", s1), visit("exponent s2", s2), visit("face_rounding", face_rounding);
  }
  /// About the shape's origin, by (1).
  Moments moments() const {
    return {volume(),
            {moment(1, 0, 0), moment(0, 1, 0), moment(0, 0, 1)},
            {moment(2, 0, 0), moment(0, 2, 0), moment(0, 0, 2), moment(1, 1, 0), moment(0, 1, 1),
             moment(1, 0, 1)}};
  }
  MassProperties mass_properties() const { return silt::mass_properties(moments()); }
  DynArray<SolidPart<Kinds>> solids(const MassProperties& mass) const {
    return {{*this, rotate(conjugate(mass.axes), -mass.centroid), conjugate(mass.axes)}};
  }
  double equal_volume_radius() const {
    return std::cbrt(0.75 * volume() / std::numbers::pi_v<double>);
  }

  /// About the shape's origin [m]: every octant is inside the ball of its own super-ellipsoid.
  double bounding_radius() const { return largest_octant().bounding_radius(); }

  SuperEllipsoid largest_octant() const {
    return with_axes([](double a, double b) { return std::max(a, b); });
  }
  SuperEllipsoid smallest_octant() const {
    return with_axes([](double a, double b) { return std::min(a, b); });
  }

 private:
  /// A super-ellipsoid with semi-axes chosen from both sides of each plane.
  template <class Choose>
  SuperEllipsoid with_axes(const Choose& choose) const {
    return {choose(plus.x, minus.x),
            choose(plus.y, minus.y),
            choose(plus.z, minus.z),
            s1,
            s2,
            face_rounding};
  }

  /// Integral of x^i y^j z^k over the body, by (1).
  double moment(int i, int j, int k) const {
    const auto both = [](double p, double m, int power) {  // the octants on both sides, with sign
      return std::pow(p, power + 1) + (power % 2 == 0 ? 1 : -1) * std::pow(m, power + 1);
    };
    const double in_plane = (i + j + 2.0),
                 gamma = std::exp(std::lgamma((i + 1) / s2) + std::lgamma((j + 1) / s2) -
                                  std::lgamma(1 + in_plane / s2));
    return both(plus.x, minus.x, i) * both(plus.y, minus.y, j) * both(plus.z, minus.z, k) /
           (s1 * s2 * s2) * gamma * SuperEllipsoid::beta((k + 1) / s1, 1 + in_plane / s1);
  }
};

static_assert(SolidShape<PolySuperEllipsoid>);

}  // namespace silt
