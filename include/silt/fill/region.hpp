// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Possible rounding of a sum of coordinates of this size [m]: a sphere that touches the wall of
/// its region counts as inside.
inline double rounding(const Vec3d& p, double radius) {
  const double size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) + radius;
  return 8 * std::numeric_limits<double>::epsilon() * size;
}

}  // namespace detail

/// Inside of a box. A plain `Box` is a region too (see `region_of`).
struct BoxRegion {
  Box box;

  Box bounds() const { return box; }
  double volume() const { return box.volume(); }
  bool fits(const Vec3d& centre, double radius) const {
    return box.grown(detail::rounding(centre, radius) - radius).contains(centre);
  }
  std::string describe() const { return text("the box from ", box.min, " to ", box.max, " m"); }
};

/// Inside of a cylinder between the centres of its two end faces.
struct CylinderRegion {
  Vec3d from, to;  // [m]
  double radius;   // [m]

  Box bounds() const {
    // A disc of radius R with normal n reaches R sqrt(1 - n_x^2) along x.
    const Vec3d n = normalised(to - from);
    const auto reach = [&](double n_k) { return radius * std::sqrt(std::max(0.0, 1 - n_k * n_k)); };
    const Vec3d disc{reach(n.x), reach(n.y), reach(n.z)};
    Box box;
    box.include(from), box.include(to);
    return {box.min - disc, box.max + disc};
  }
  double volume() const { return std::numbers::pi * radius * radius * norm(to - from); }
  bool fits(const Vec3d& centre, double r) const {
    const double length = norm(to - from), slack = detail::rounding(centre, r);
    const Vec3d n = (to - from) * (1 / length), d = centre - from;
    const double along = dot(d, n);
    return along >= r - slack && along <= length - r + slack &&
           norm(d - along * n) <= radius - r + slack;
  }
  std::string describe() const {
    return text("the cylinder from ", from, " to ", to, " m of radius ", radius, " m");
  }
};

/// Inside of a closed triangle mesh, which must outlive the region. `Mesh` has `contains(point)`,
/// `bounds()`, `volume()`, `is_closed()` and `triangles_near(centre, reach, out)` (TriangleMesh,
/// boundary/triangle_mesh.hpp). Threads: one region per thread, as it caches results.
template <class Mesh>
class MeshRegion {
 public:
  explicit MeshRegion(const Mesh& mesh)
      : mesh_(&mesh), bounds_(mesh.bounds()), volume_(std::abs(mesh.volume())) {
    require(mesh.is_closed(), describe(),
            " has gaps and no inside to fill; close them, "
            "or fill a box or a cylinder");
  }
  explicit MeshRegion(const Mesh&&) = delete;

  Box bounds() const { return bounds_; }
  double volume() const { return volume_; }
  bool fits(const Vec3d& centre, double radius) const {
    return bounds_.contains(centre) && clear(centre, radius) && inside({centre, radius, false});
  }
  std::string describe() const {
    return text("the mesh between ", bounds_.min, " and ", bounds_.max, " m");
  }

 private:
  /// A ball that no triangle cuts: it is completely on one side of the surface, as is every other
  /// such ball that overlaps it.
  struct Ball {
    Vec3d centre;   // [m]
    double radius;  // [m]
    bool inside;
  };

  bool clear(const Vec3d& centre, double radius) const {
    mesh_->triangles_near(centre, radius, touched_);
    return touched_.empty();
  }
  /// `contains` tests every triangle: it is called only if no cached ball has the answer.
  bool inside(Ball ball) const {
    for (const auto& known : known_) {
      const Vec3d d = known.centre - ball.centre;
      const double reach = known.radius + ball.radius;
      if (dot(d, d) < 0.999 * reach * reach) return known.inside;
    }
    ball.inside = mesh_->contains(ball.centre);
    const double largest = norm(bounds_.extent());
    while (ball.radius < largest && clear(ball.centre, 1.5 * ball.radius)) ball.radius *= 1.5;
    if (known_.size() < 64) {
      known_.push_back(ball);
    } else {
      known_[oldest_++ % known_.size()] = ball;
    }
    return ball.inside;
  }

  const Mesh* mesh_;
  Box bounds_;
  double volume_;  // [m3]
  mutable DynArray<std::uint32_t> touched_;
  mutable DynArray<Ball> known_;
  mutable std::size_t oldest_ = 0;
};

/// The region for `r`: a Box means its inside, other types are regions themselves.
template <class R>
const R& region_of(const R& r) {
  return r;
}
inline BoxRegion region_of(const Box& box) { return {box}; }

/// A part of space to fill with whole spheres.
template <class R>
concept Region = requires(const R& r, const Vec3d& centre, double radius) {
  { region_of(r).bounds() } -> std::same_as<Box>;                   // encloses it [m]
  { region_of(r).volume() } -> std::same_as<double>;                // [m3]
  { region_of(r).fits(centre, radius) } -> std::same_as<bool>;      // the whole sphere is inside
  { region_of(r).describe() } -> std::convertible_to<std::string>;  // "the box from .. to .. m"
};

static_assert(Region<Box> && Region<BoxRegion> && Region<CylinderRegion>);

}  // namespace silt
