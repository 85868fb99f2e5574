// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

/// Exact overlap volumes of a sphere with the cells of a grid, in closed form.
///
/// C(a, b, c) is the volume of the unit ball with x > a, y > b, z > c; a cell's share is the
/// eightfold difference of C at its corners. For a, b, c >= 0 with the corner inside the ball, by
/// the divergence theorem
///
///   3 C = O - a A_a - b A_b - c A_c                                                            (1)
///   O   = 2 pi - E_ab - E_bc - E_ca - a P_a - b P_b - c P_c                                    (2)
///   E_ab = acos(-a b / (r_a r_b)),  r_a = sqrt(1 - a^2)                                        (3)
///   P_a = acos(b/r_a) + acos(c/r_a) - pi/2                                                     (4)
///   2 A_a = r_a^2 P_a - b (s_ab - c) - c (s_ca - b),  s_ab = sqrt(1 - a^2 - b^2) (5)
///
/// with A_a the plane face at x = a, O the solid angle of the spherical patch by Gauss-Bonnet (E
/// exterior angles, a P_a the integral of the geodesic curvature of the arc at x = a). Without the
/// third plane C(a, b) = 2 C(a, b, 0); C(-a, b, c) = C(b, c) - C(a, b, c). Angles belong to pairs
/// of planes, and are computed once per pair.
///
/// Valid:  any sphere and cells; errors of 1e-14 of the ball's volume, 1e-11 in rare cases where an
///         edge grazes it. Units: lengths in radii, about the sphere's centre.
/// Source: own derivation. Check: the cap of height 0.3 of a ball of radius 0.5 is 0.113097.
/// Tests:  tests/coupling/averaging_overlap.cpp.
class SphereOverlap {
 public:
  /// Part of the unit ball beyond three planes, and beyond two and one (others at -1).
  static double corner(double a, double b, double c) {
    SphereOverlap s;
    const double planes[3][3] = {{-1, a, 1}, {-1, b, 1}, {-1, c, 1}};
    double share = 0;
    s.shares(planes[0], planes[1], planes[2], {2, 2, 2}, [&](int i, int j, int k, double v) {
      if (i == 1 && j == 1 && k == 1) share = v;
    });
    return share;
  }

  /// Calls use(i, j, k, volume) for the cells between planes x[0] < x[1] ..., `cells` + 1 per
  /// direction; the first is at or below -1 and the last at or above 1 [radii].
  template <class Use>
  void shares(const double* x, const double* y, const double* z, const std::array<int, 3>& cells,
              const Use& use) {
    const double* at[3] = {x, y, z};
    for (std::size_t d = 0; d < 3; ++d) {
      planes_[d].resize(static_cast<std::size_t>(cells[d]) + 1);
      for (std::size_t m = 0; m < planes_[d].size(); ++m) planes_[d][m] = plane(at[d][m]);
    }
    for (std::size_t d = 0; d < 3; ++d) find_pairs(d);
    const std::size_t nx = planes_[0].size(), ny = planes_[1].size(), nz = planes_[2].size();
    beyond_.resize(nx * ny * nz);
    for (std::size_t k = 0, n = 0; k < nz; ++k)
      for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i) beyond_[n++] = beyond({i, j, k});
    const auto c = [&](std::size_t i, std::size_t j, std::size_t k) {
      return beyond_[(k * ny + j) * nx + i];
    };
    for (std::size_t k = 0; k + 1 < nz; ++k)
      for (std::size_t j = 0; j + 1 < ny; ++j)
        for (std::size_t i = 0; i + 1 < nx; ++i) {
          const double below =
              (c(i, j, k) - c(i + 1, j, k)) - (c(i, j + 1, k) - c(i + 1, j + 1, k));
          const double above =
              (c(i, j, k + 1) - c(i + 1, j, k + 1)) - (c(i, j + 1, k + 1) - c(i + 1, j + 1, k + 1));
          use(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k),
              std::max(0.0, below - above));
        }
  }

 private:
  static constexpr double pi = std::numbers::pi;
  enum class Side { Below, Cuts, Above };
  struct Plane {
    double a, r2, r, angle;  // |position|, 1 - a^2, its root, acos a
    bool negative;
    Side side;
  };
  struct Pair {
    double exterior, p_first, p_second, s;  // E_ab, acos(b/r_a), acos(a/r_b), s_ab
    bool meets;                             // the line of intersection of the planes cuts the ball
    double both;                            // C(|a|, |b|)
  };

  static Plane plane(double x) {
    if (x <= -1) return {1, 0, 0, 0, true, Side::Below};
    if (x >= 1) return {1, 0, 0, 0, false, Side::Above};
    const double a = std::abs(x), r2 = (1 - a) * (1 + a), r = std::sqrt(r2);
    return {a, r2, r, std::atan2(r, a), x < 0, Side::Cuts};
  }
  /// For direction d and the next one.
  void find_pairs(std::size_t d) {
    const auto &first = planes_[d], &second = planes_[(d + 1) % 3];
    pairs_[d].resize(first.size() * second.size());
    Pair* to = pairs_[d].data();
    for (const Plane& a : first)
      for (const Plane& b : second) {
        Pair& p = *to++;
        p = {};
        if (a.side != Side::Cuts || b.side != Side::Cuts) continue;
        const double s2 = a.r2 - b.a * b.a;
        p.meets = s2 > 0;
        if (!p.meets) continue;
        p.s = std::sqrt(s2);
        p.exterior = std::atan2(p.s, -a.a * b.a);
        p.p_first = std::atan2(p.s, b.a);
        p.p_second = std::atan2(p.s, a.a);
        const double O = pi - p.exterior - a.a * p.p_first - b.a * p.p_second;
        const double A = 0.5 * (a.r2 * p.p_first - b.a * p.s);
        const double B = 0.5 * (b.r2 * p.p_second - a.a * p.s);
        p.both = std::max(0.0, 2.0 / 3 * (O - a.a * A - b.a * B));
      }
  }
  const Pair& pair(std::size_t d, const std::array<std::size_t, 3>& at) const {
    const std::size_t e = (d + 1) % 3;
    return pairs_[d][at[d] * planes_[e].size() + at[e]];
  }
  static double one(const Plane& p) {  // C(a) with its sign
    if (p.side != Side::Cuts) return p.side == Side::Below ? 4 * pi / 3 : 0;
    const double h = 1 - p.a, cap = pi * h * h * (1 - h / 3);
    return p.negative ? 4 * pi / 3 - cap : cap;
  }
  double two(std::size_t d, const std::array<std::size_t, 3>& at) const {
    const Plane &a = planes_[d][at[d]], &b = planes_[(d + 1) % 3][at[(d + 1) % 3]];
    if (a.side == Side::Above || b.side == Side::Above) return 0;
    if (a.side == Side::Below) return one(b);
    if (b.side == Side::Below) return one(a);
    Plane up = a;
    up.negative = false;
    double v = pair(d, at).both;      // C(|a|, |b|)
    if (b.negative) v = one(up) - v;  // C(|a|, b)
    return a.negative ? one(b) - v : v;
  }
  double beyond(const std::array<std::size_t, 3>& at) const {
    const Plane &a = planes_[0][at[0]], &b = planes_[1][at[1]], &c = planes_[2][at[2]];
    if (a.side == Side::Above || b.side == Side::Above || c.side == Side::Above) return 0;
    if (a.side == Side::Below) return two(1, at);
    if (b.side == Side::Below) return two(2, at);
    if (c.side == Side::Below) return two(0, at);
    double v = 0;  // C(|a|, |b|, |c|)
    if (a.r2 > b.a * b.a + c.a * c.a) {
      const Pair &ab = pair(0, at), &bc = pair(1, at), &ca = pair(2, at);
      const double Pa = ab.p_first + ca.p_second - pi / 2, Pb = bc.p_first + ab.p_second - pi / 2,
                   Pc = ca.p_first + bc.p_second - pi / 2;
      const double O =
          2 * pi - ab.exterior - bc.exterior - ca.exterior - a.a * Pa - b.a * Pb - c.a * Pc;
      const double A = a.r2 * Pa - b.a * (ab.s - c.a) - c.a * (ca.s - b.a);
      const double B = b.r2 * Pb - a.a * (ab.s - c.a) - c.a * (bc.s - a.a);
      const double C = c.r2 * Pc - a.a * (ca.s - b.a) - b.a * (bc.s - a.a);
      v = std::max(0.0, (O - 0.5 * (a.a * A + b.a * B + c.a * C)) / 3);
    }
    const auto mixed = [&](std::size_t d, bool first_up, bool second_up) {  // C of two, |.| of some
      const Plane &p = planes_[d][at[d]], &q = planes_[(d + 1) % 3][at[(d + 1) % 3]];
      Plane u = p, w = q;
      u.negative = p.negative && !first_up, w.negative = q.negative && !second_up;
      Plane up = u;
      up.negative = false;
      double both = pair(d, at).both;
      if (w.negative) both = one(up) - both;
      return u.negative ? one(w) - both : both;
    };
    // C(|a|, |b|, c), then C(|a|, b, c), then C(a, b, c).
    if (c.negative) v = mixed(0, true, true) - v;
    if (b.negative) v = mixed(2, false, true) - v;
    if (a.negative) v = mixed(1, false, false) - v;
    return v;
  }

  std::array<DynArray<Plane>, 3> planes_;
  std::array<DynArray<Pair>, 3> pairs_;
  DynArray<double> beyond_;
};

}  // namespace silt
