// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <silt/core/target.hpp>

/// Convex polygons in a plane, and the arched depth over one, for face_patch.hpp.
/// Tests: tests/shape/face_patch.cpp

namespace silt::inline SILT_TARGET::detail {

struct Flat {
  double x, y;
  friend Flat operator+(Flat a, Flat b) { return {a.x + b.x, a.y + b.y}; }
  friend Flat operator-(Flat a, Flat b) { return {a.x - b.x, a.y - b.y}; }
  friend Flat operator*(double s, Flat a) { return {s * a.x, s * a.y}; }
};
inline double dot(Flat a, Flat b) { return a.x * b.x + a.y * b.y; }
inline double cross(Flat a, Flat b) { return a.x * b.y - a.y * b.x; }

/// A convex polygon, counter-clockwise; each corner knows the edge that leaves it.
struct FlatPolygon {
  struct Corner {
    Flat at;
    Flat way;   // along the edge from here
    bool of_i;  // the edge belongs to i
  };
  static constexpr std::size_t room = 96;
  std::array<Corner, room> corner;  // the first `size` of them; no others are copied
  std::size_t size = 0;

  FlatPolygon() {}
  FlatPolygon(const FlatPolygon& p) : size(p.size) {
    std::copy_n(p.corner.begin(), size, corner.begin());
  }
  FlatPolygon& operator=(const FlatPolygon& p) {
    size = p.size;
    std::copy_n(p.corner.begin(), size, corner.begin());
    return *this;
  }
  void add(const Corner& c) {
    if (size < room) corner[size++] = c;
  }
  const Corner& after(std::size_t k) const { return corner[k + 1 < size ? k + 1 : 0]; }
  const Corner& before(std::size_t k) const { return corner[k > 0 ? k - 1 : size - 1]; }

  /// Keeps the part to the left of a line.
  void cut(const Flat& point, const Flat& way, bool of_i) {
    std::array<double, room> height;
    bool all = true;
    for (std::size_t k = 0; k < size; ++k)
      height[k] = cross(way, corner[k].at - point), all = all && height[k] >= 0;
    if (all) return;
    const FlatPolygon whole(*this);
    size = 0;
    for (std::size_t k = 0; k < whole.size; ++k) {
      const Corner &here = whole.corner[k], &next = whole.after(k);
      const double a = height[k], b = height[k + 1 < whole.size ? k + 1 : 0];
      if (a >= 0) add(here);
      if ((a >= 0) == (b >= 0)) continue;
      const Flat at = here.at + (a / (a - b)) * (next.at - here.at);
      if (a >= 0)
        add({at, way, of_i});
      else
        add({at, here.way, here.of_i});
    }
  }
  double area() const {
    double twice = 0;
    for (std::size_t k = 1; k + 1 < size; ++k)
      twice += cross(corner[k].at - corner[0].at, corner[k + 1].at - corner[0].at);
    return 0.5 * twice;
  }
  /// The part of it that is symmetric about z, to `slack` [-] of its edges.
  FlatPolygon about(const Flat& z, double slack) const {
    FlatPolygon out = *this;
    for (std::size_t k = 0; k < size && out.size > 0; ++k) {
      const Flat way = corner[k].way, point = 2 * z - corner[k].at;
      out.cut(point + slack * Flat{-way.y, way.x}, -1 * way, corner[k].of_i);
    }
    return out;
  }
  /// xx, yy, xy about z: of the area; of a polygon without one, as of a line.
  std::array<double, 3> covariance(const Flat& z, double thin) const {
    double weight = 0;
    std::array<double, 3> sum{};
    const auto add_to = [&](double w, const Flat& a, const Flat& b) {
      sum[0] += w * a.x * b.x, sum[1] += w * a.y * b.y;
      sum[2] += 0.5 * w * (a.x * b.y + a.y * b.x);
    };
    for (std::size_t k = 0; k < size; ++k) {
      const Flat a = corner[k].at - z, b = after(k).at - z, ab = a + b;
      const double part = 0.5 * cross(a, b), edge = thin * std::sqrt(dot(b - a, b - a));
      add_to(part / 12, a, a), add_to(part / 12, b, b), add_to(part / 12, ab, ab);
      add_to(edge / 6, a, a), add_to(edge / 6, b, b);
      weight += part + edge;
    }
    for (double& s : sum) s = weight > 0 ? s / weight : 0;
    return sum;
  }
};

/// Solution of (1) of face_patch.hpp: z, S and the multipliers of at most three corners.
struct ArchedDepth {
  struct Basis {
    std::array<std::size_t, 3> corner{};
    std::array<double, 3> share{};
    std::size_t size = 0;
    Flat z{0, 0};
    double value = 0;
  };
  const FlatPolygon& q;
  const std::array<double, FlatPolygon::room>& depth;
  double scale;     // [m]
  double bend = 0;  // [1/m] eta S/rho^2
  Basis best{};

  /// One corner is deeper than all others by more than the arch.
  bool is_corner(double per_depth) {
    std::size_t deepest = 0;
    for (std::size_t k = 1; k < q.size; ++k)
      if (depth[k] > depth[deepest]) deepest = k;
    best = {{deepest}, {1}, 1, q.corner[deepest].at, depth[deepest]};
    bend = per_depth * best.value;
    return worst().second == deepest;
  }
  /// Newton's method for S; `per_depth` [1/m2] eta/rho^2.
  void solve(double per_depth) {
    double s = best.value;
    climb();
    for (int step = 0; step < 20; ++step) {
      const double error = s - best.value;
      s -= error / (1 - per_depth * square());
      if (std::abs(error) <= 1e-14 * s) break;
      bend = per_depth * s;
      const Basis before = best;
      if (!place(best)) best = before, best.value = at(best.corner[0], best.z);
      climb();
    }
    best.value = s;
  }
  /// sum_k l_k |v_k - z|^2
  double square() const {
    double sum = 0;
    for (std::size_t b = 0; b < best.size; ++b) {
      const Flat arm = q.corner[best.corner[b]].at - best.z;
      sum += best.share[b] * dot(arm, arm);
    }
    return sum;
  }

 private:
  double at(std::size_t k, const Flat& z) const {
    const Flat arm = q.corner[k].at - z;
    return depth[k] + bend * dot(arm, arm);
  }
  /// By how much the worst corner exceeds the value, and which it is.
  std::pair<double, std::size_t> worst() const {
    std::pair<double, std::size_t> out{0, best.corner[0]};
    for (std::size_t k = 0; k < q.size; ++k)
      if (const double more = at(k, best.z) - best.value; more > out.first) out = {more, k};
    return out;
  }
  /// Takes in the corner that exceeds most until none does; the value rises each time.
  void climb() {
    for (std::size_t step = 0; step < 4 * q.size + 8; ++step) {
      const auto [more, k] = worst();
      if (!(more > 1e-14 * (std::abs(best.value) + bend * scale * scale)) || !take_in(k)) return;
    }
  }
  /// The best basis of two or three among the present one's corners and k, which is in it. False if
  /// by rounding there is none.
  bool take_in(std::size_t k) {
    const Basis old = best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](std::size_t a, std::size_t b, std::size_t size) {
      Basis trial;
      trial.corner = {k, a, b}, trial.size = size;
      if (!place(trial)) return;
      double most = trial.value;
      for (std::size_t c = 0; c < old.size; ++c) most = std::max(most, at(old.corner[c], trial.z));
      if (most < least) least = most, best = trial;
    };
    for (std::size_t a = 0; a < old.size; ++a) {
      consider(old.corner[a], 0, 2);
      for (std::size_t b = 0; b < a; ++b) consider(old.corner[a], old.corner[b], 3);
    }
    return least < std::numeric_limits<double>::infinity();
  }
  /// Where the corners of a basis are equal, with shares >= 0.
  bool place(Basis& b) const {
    const Flat v0 = q.corner[b.corner[0]].at;
    const double e0 = depth[b.corner[0]];
    b.share = {1, 0, 0}, b.z = v0;
    if (b.size >= 2) {
      const Flat p = q.corner[b.corner[1]].at - v0;
      const double pp = dot(p, p), of_p = 0.5 * (pp + (depth[b.corner[1]] - e0) / bend);
      if (!(pp > 0)) return false;
      if (b.size == 2) {
        const double t = of_p / pp;
        b.share = {1 - t, t, 0}, b.z = v0 + t * p;
      } else {
        const Flat r = q.corner[b.corner[2]].at - v0;
        const double rr = dot(r, r), of_r = 0.5 * (rr + (depth[b.corner[2]] - e0) / bend);
        const double det = cross(p, r);
        if (!(std::abs(det) > 1e-12 * (pp + rr))) return false;
        const Flat z{(of_p * r.y - of_r * p.y) / det, (of_r * p.x - of_p * r.x) / det};
        b.share[1] = cross(z, r) / det, b.share[2] = cross(p, z) / det;
        b.share[0] = 1 - b.share[1] - b.share[2], b.z = v0 + z;
      }
      for (std::size_t k = 0; k < b.size; ++k)
        if (!(b.share[k] >= 0)) return false;
    }
    b.value = at(b.corner[0], b.z);
    return true;
  }
};

}  // namespace silt::detail
