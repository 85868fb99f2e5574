// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/fluid/flow_solids.hpp>

namespace silt::inline SILT_TARGET {

/// A wall of the particles as a wall of a flow.
struct FlowWall {
  Surfaces surfaces;
  Motion motion{};  // empty: at rest
  /// Side of a mesh with the fluid: inside or outside closed meshes; normals of open ones
  /// (right-hand rule) point outside. Planes, cylinders and cones have a side of their own.
  Side fluid = Side::Inside;
};

namespace detail {

/// Signed distance to a mesh. For a closed mesh the sign is that of the enclosed volume, for either
/// orientation of the triangles. For an open one it is that of the pseudonormal at the nearest
/// point (the sum of its triangles' normals, weighted by angle at a vertex), which is right
/// wherever that point is not on a rim: J. A. Baerentzen, H. Aanaes, IEEE Trans. Vis. Comput.
/// Graph. 11 (2005) 243.
class MeshDistance {
 public:
  MeshDistance(std::shared_ptr<const TriangleMesh> mesh, Side fluid)
      : mesh_(std::move(mesh)), sign_(fluid == Side::Outside ? 1 : -1) {
    if (!mesh_->is_closed()) find_normals();
  }

  double operator()(const Vec3d& x) const {
    const SurfacePoint p = mesh_->nearest_point(x);
    if (mesh_->is_closed()) return (mesh_->contains(x) ? -sign_ : sign_) * p.distance;
    refuse_rim(p, x);
    return (dot(p.normal, normals_[p.feature]) < 0 ? -sign_ : sign_) * p.distance;
  }

 private:
  void find_normals() {
    const auto& topology = mesh_->topology();
    const auto faces = static_cast<std::uint32_t>(mesh_->triangles().size());
    const auto edges = static_cast<std::uint32_t>(topology.edges.size());
    normals_.assign(faces + edges + mesh_->vertices().size(), {0, 0, 0});
    rims_.resize(normals_.size());
    for (std::uint32_t t = 0; t < faces; ++t) {
      const auto& corners = mesh_->triangles()[t];
      normals_[t] = mesh_->normals()[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d& at = mesh_->vertices()[corners[k]];
        const Vec3d a = normalised(mesh_->vertices()[corners[(k + 1) % 3]] - at),
                    b = normalised(mesh_->vertices()[corners[(k + 2) % 3]] - at);
        normals_[faces + edges + corners[k]] +=
            std::atan2(norm(cross(a, b)), dot(a, b)) * normals_[t];
        normals_[faces + topology.edges_of[t][k]] += normals_[t];
      }
    }
    for (std::uint32_t e = 0; e < edges; ++e) {
      const auto sharing = topology.triangles_at_edge[e];
      const auto& edge = topology.edges[e];
      require(sharing.size() <= 2 &&
                  (sharing.size() == 1 || runs(sharing[0], edge) != runs(sharing[1], edge)),
              "boundary_of: the mesh is open, and at its edge from ", mesh_->vertices()[edge.from],
              " to ", mesh_->vertices()[edge.to], " [m] ",
              sharing.size() > 2 ? "more than two triangles meet"
                                 : "two triangles have opposite orientations",
              ", and its sides cannot be distinguished; close it, or orient all triangles the same "
              "way");
      if (sharing.size() == 2) continue;
      const double turn = runs(sharing[0], edge) ? 1 : -1;
      const Vec3d outwards = turn * cross(edge.direction, normals_[sharing[0]]);
      for (const auto f : {faces + e, faces + edges + edge.from, faces + edges + edge.to})
        rims_[f].push_back(outwards);
    }
  }
  /// Whether a triangle traverses an edge from its lower to its higher vertex.
  bool runs(std::uint32_t triangle, const MeshEdge& edge) const {
    const auto& c = mesh_->triangles()[triangle];
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] == edge.from && c[(k + 1) % 3] == edge.to) return true;
    return false;
  }
  /// Beyond a rim the side is undefined.
  void refuse_rim(const SurfacePoint& p, const Vec3d& x) const {
    const double slack = 1e-6 * p.distance + mesh_->plane_tolerance();
    for (const auto& outwards : rims_[p.feature])
      require(!(p.distance * dot(p.normal, outwards) > slack),
              "boundary_of: the mesh is open, and the flow's point ", x,
              " [m] is beyond its rim, where it has no sides; close the mesh, or extend it by "
              "three cells beyond the flow's box");
  }

  std::shared_ptr<const TriangleMesh> mesh_;
  double sign_;
  DynArray<Vec3d> normals_;         // of faces, edges, vertices
  DynArray<DynArray<Vec3d>> rims_;  // of the same: directions away from the surface
};

/// One surface of a wall, at one time.
struct FlowSurface {
  std::function<double(const Vec3d&)> distance;  // [m] in the body's coordinates
  Pose pose;
  Motion motion;
};

}  // namespace detail

/// Walls of the particles as the boundary of a flow: the fluid is where all of them have their free
/// side. Pose and velocity are those at `time` [s]:
///
///   flow.set_boundary(silt::boundary_of(silt::Cylinder{from, to, radius, silt::Side::Inside}));
///
/// Flow and particles then have the same walls. The velocity of the surface acts on the flow, as
/// for a rotating drum. A surface that changes its position is not tracked: set the boundary again.
///
/// Valid:  cylinders and cones are open at their ends: extend them by three cells beyond the flow's
///         box. For fluid in the union of several walls (branching pipes) use one mesh.
/// Errors: InputError for no walls and invalid surfaces; for an open mesh with inconsistently
///         oriented triangles, or with its rim in the flow (when the distance is evaluated).
/// Tests:  tests/fluid/boundary_of.cpp
inline FlowBoundary boundary_of(const DynArray<FlowWall>& walls, double time = 0) {
  auto all = std::make_shared<DynArray<detail::FlowSurface>>();
  bool moves = false;
  for (const FlowWall& wall : walls)
    for (const Surface& part : wall.surfaces.parts) {
      const Pose pose = wall.motion ? wall.motion(time) : Pose{};
      detail::visit_surface(part, [&](const auto& surface) {
        using S = std::decay_t<decltype(surface)>;
        if constexpr (std::is_same_v<S, TriangleMesh>) {
          all->push_back({detail::MeshDistance(std::get<std::shared_ptr<const TriangleMesh>>(part),
                                               wall.fluid),
                          pose, wall.motion});
        } else {
          surface.check();
          const auto distance = [surface](const Vec3d& x) {
            SurfacePoint p{{0, 0, 0}, std::numeric_limits<double>::quiet_NaN(), 0};
            surface.contacts(x, std::numeric_limits<double>::infinity(), &p);
            return p.distance;
          };
          all->push_back({distance, pose, wall.motion});
        }
      });
      moves = moves || wall.motion;
    }
  require(!all->empty(), "boundary_of: no walls are given");
  const auto nearest = [all](const Vec3d& x) {
    std::pair<double, const detail::FlowSurface*> best{std::numeric_limits<double>::infinity(),
                                                       nullptr};
    for (const auto& surface : *all) {
      const double distance = surface.distance(surface.pose.to_body(x));
      if (best.second == nullptr || !(distance >= best.first)) best = {distance, &surface};
    }
    return best;
  };
  FlowBoundary boundary{[nearest](const Vec3d& x) { return nearest(x).first; }};
  if (moves)
    boundary.velocity = [nearest, time](const Vec3d& x) {
      const detail::FlowSurface& surface = *nearest(x).second;
      if (!surface.motion) return Vec3d{0, 0, 0};
      constexpr double dt = 1e-6;  // [s] its square is negligible for any period
      const Vec3d at = surface.pose.to_body(x);
      return (0.5 / dt) *
             (surface.motion(time + dt).to_space(at) - surface.motion(time - dt).to_space(at));
    };
  return boundary;
}
inline FlowBoundary boundary_of(const Surfaces& surfaces, const Motion& motion = {},
                                double time = 0) {
  return boundary_of(DynArray<FlowWall>{{surfaces, motion}}, time);
}

namespace detail {

/// Motion of a wall near `now` [s]; for a driven wall with its present velocity.
inline Motion motion_seen(const Wall& wall, double now) {
  if (!wall.is_driven()) {
    if (!wall.motion || wall.state.changed == 0) return wall.motion;
    return [wall](double time) { return wall.pose_at(time); };
  }
  const Vec3d v = wall.driven_velocity({0, 0, 0});
  const Vec3d w{dot(wall.driven_velocity({0, 1, 0}) - v, {0, 0, 1}),
                dot(wall.driven_velocity({0, 0, 1}) - v, {1, 0, 0}),
                dot(wall.driven_velocity({1, 0, 0}) - v, {0, 1, 0})};
  return [pose = wall.pose, v, w, now](double time) {
    const double rate = norm(w), dt = time - now;
    const Quaternion turn = rate > 0 ? rotation_about(w * (1 / rate), rate * dt) : Quaternion{};
    return Pose{turn * pose.rotation, rotate(turn, pose.translation) + dt * v};
  };
}

}  // namespace detail

/// All walls of a Simulation in their present poses; `fluid`: for its meshes, see FlowWall.
template <class Sim>
FlowBoundary boundary_of_walls(const Sim& sim, Side fluid = Side::Inside) {
  DynArray<FlowWall> walls;
  for (std::size_t k = 0; k < sim.walls(); ++k)
    walls.push_back(
        {Surfaces(sim.wall(k).surfaces), detail::motion_seen(sim.wall(k), sim.time()), fluid});
  return boundary_of(walls, sim.time());
}

}  // namespace silt
