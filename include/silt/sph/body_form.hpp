// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <type_traits>
#include <variant>

#include <silt/boundary/mesh_inside.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/shape/surface_mesh.hpp>
#include <silt/sph/edge_image.hpp>
#include <silt/sph/face_exit.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Particle of a body in the body's frame, and its mirror image across the surface [m].
struct BodySite {
  Vec3d at, ghost;
};

/// Particles of a body, each with the same `share` [-] of a particle's volume. `under` [m]: places
/// that the lattice has below them, within the support of their kernels; they are no particles.
struct BodySites {
  DynArray<BodySite> sites;
  DynArray<Vec3d> under;
  double share = 1;
};

/// Shape of a body for the liquid, in its principal frame, about its centroid [m]: the surfaces of
/// its parts.
///
/// Accuracy: curved surfaces are triangulated with 24 by 24 cells on each side of the bounding box
/// of a part: an error of 0.1 % of an ellipsoid's radius.
class LiquidForm {
 public:
  template <class S>
  explicit LiquidForm(const S& shape) {
    const MassProperties mass = shape.mass_properties();
    volume_ = mass.volume;
    for (const auto& part : SolidsOf<S>::solids(shape, mass))
      std::visit([&](const auto& solid) { add(solid, part.centre, part.axes); }, part.solid);
  }

  double radius() const { return std::cbrt(0.75 * volume_ / std::numbers::pi); }  // of that volume
  double reach() const { return reach_; }  // [m] from the centroid
  bool contains(const Vec3d& x) const {
    return dot(x, x) <= reach_ * reach_ && nearest(x).distance < 0;
  }

  /// Particles of a body scaled by `scale`: on a lattice with the spacing of the liquid, to the
  /// depth of the kernel's support. If possible the lattice is placed with the faces of the
  /// bounding box half a spacing beyond the outermost particles. Their share makes the volume of
  /// the lattice equal to that of the body.
  BodySites lay(const SphSetup& setup, double scale) const {
    const double s = setup.spacing / scale, deep = 2 * setup.h() / scale;
    const bool flat = setup.dimensions == 2;
    const auto count = [s](double length) {
      return std::max(1, static_cast<int>(std::lround(length / s)));
    };
    const Vec3d e = box_.extent(), mid = 0.5 * (box_.min + box_.max);
    const int n[3] = {count(e.x) + 2, flat ? 1 : count(e.y) + 2, count(e.z) + 2};
    BodySites of;
    std::size_t inside = 0;
    double deepest = 0;
    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j)
        for (int k = 0; k < n[2]; ++k) {
          const Vec3d x =
              mid + s * Vec3d{i - 0.5 * (n[0] - 1), j - 0.5 * (n[1] - 1), k - 0.5 * (n[2] - 1)};
          const double d = nearest(x).distance;
          if (!(d < -1e-9 * s)) continue;
          ++inside, deepest = std::max(deepest, -d);
          const Way way = to_surface(x, 1e-9 * s);
          if (way.length > 2 * deep) continue;
          if (way.length > deep) {
            of.under.push_back(scale * x);
            continue;
          }
          const auto past = way_out_at_edge(x, -d, setup.h() / scale, flat,
                                            [&](const Vec3d& at) { return nearest(at).distance; });
          const Vec3d out = past ? *past : way.end - x;
          require(!flat || std::abs(out.y) < 1e-6 * s,
                  "Sph: in 2D, where forces are those of 1 m, a body must be a prism along y and "
                  "1 m long; one is ",
                  scale * e.y, " m long");
          // In a notch the image may be in another part; then it is at the surface.
          const Vec3d ghost = x + 2 * out;
          of.sites.push_back({scale * x, scale * (contains(ghost) ? x + out : ghost)});
        }
    require(deepest >= 0.9 * s, "Sph: a body of ", scale * e, " m is too thin for a spacing of ",
            setup.spacing,
            " m: its thickest part must be at least 2 spacings thick; use a "
            "smaller spacing");
    if (!flat) of.share = volume_ / (static_cast<double>(inside) * s * s * s);
    return of;
  }

 private:
  struct Part {
    TriangleMesh surface;
    Vec3d centre;
    Quaternion axes;
  };
  struct Nearest {
    double distance;  // [m] negative inside
    Vec3d point;
    const Part* part;
  };
  struct Way {
    Vec3d end;
    double length;  // [m] to the nearest face
  };

  template <class Solid>
  void add(const Solid& solid, const Vec3d& centre, const Quaternion& axes) {
    const SurfaceMesh mesh = [&] {
      if constexpr (std::is_same_v<Solid, Ball>) {
        SurfaceMesh ball = surface_of(SuperEllipsoid{solid.radius, solid.radius, solid.radius}, 24);
        for (Vec3d& p : ball.points) p += solid.centre;
        return ball;
      } else {
        return surface_of(solid, 24);
      }
    }();
    DynArray<std::array<Vec3d, 3>> soup;
    for (const auto& t : mesh.triangles)
      soup.push_back({mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]});
    for (const Vec3d& p : mesh.points) {
      const Vec3d x = centre + rotate(axes, p);
      box_.include(x), reach_ = std::max(reach_, norm(x));
    }
    parts_.push_back({TriangleMesh(soup), centre, axes});
  }
  /// Nearest point on the union of all parts; inside, for the part in which x is deepest.
  Nearest nearest(const Vec3d& x) const {
    Nearest least{std::numeric_limits<double>::infinity(), x, nullptr};
    for (const Part& part : parts_) {
      const Vec3d own = rotate(conjugate(part.axes), x - part.centre);
      const SurfacePoint p = part.surface.nearest_point(own);
      const double d = part.surface.contains(own) ? -p.distance : p.distance;
      if (d < least.distance)
        least = {d, part.centre + rotate(part.axes, own - p.distance * p.normal), &part};
    }
    return least;
  }
  /// Nearest point outside all parts, by steps to the surface of one after the other.
  Way to_surface(Vec3d x, double enough) const {
    Way way{x, 0};
    for (int n = 0; n < 50; ++n) {
      const Nearest p = nearest(way.end);
      if (p.distance > -enough) break;
      way.end = exit(way.end, p), way.length = norm(p.point - x);
    }
    return way;
  }
  /// Nearest point on the surface of one part from x inside.
  static Vec3d exit(const Vec3d& x, const Nearest& p) {
    const Vec3d own = rotate(conjugate(p.part->axes), x - p.part->centre);
    const TriangleMesh& surface = p.part->surface;
    const auto way = way_out(surface, own, -p.distance, surface.volume() > 0 ? 1 : -1);
    return way ? x + rotate(p.part->axes, *way) : p.point;
  }

  DynArray<Part> parts_;
  Box box_;
  double volume_ = 0, reach_ = 0;  // [m3], [m]
};

}  // namespace silt::detail
