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
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/core/error.hpp>
#include <silt/fluid/flow_solids.hpp>

namespace silt::inline SILT_TARGET {

/// A wall of the particles as a wall of a flow.
struct FlowWall {
  Surfaces surfaces;
  Motion motion{};  // empty: at rest
  /// Where the fluid is, of meshes: inside closed ones, or outside; normals of open ones
  /// (right-hand rule) point outside. Planes, cylinders and cones say it themselves.
  Side fluid = Side::Inside;
};

namespace detail {

/// Signed distance to a mesh. Inside a closed mesh is what it encloses, whichever way its triangles
/// turn. Of an open one the sign is that of the pseudonormal at the nearest point (the sum of its
/// triangles' normals, at a corner by their angles), which is right wherever that point is no rim:
/// J. A. Baerentzen, H. Aanaes, IEEE Trans. Vis. Comput. Graph. 11 (2005) 243.
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
  /// Whether a triangle runs along an edge from its lower vertex to the higher.
  bool runs(std::uint32_t triangle, const MeshEdge& edge) const {
    const auto& c = mesh_->triangles()[triangle];
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] == edge.from && c[(k + 1) % 3] == edge.to) return true;
    return false;
  }
  /// Beyond a rim there is no side.
  void refuse_rim(const SurfacePoint& p, const Vec3d& x) const {
    const double slack = 1e-6 * p.distance + mesh_->plane_tolerance();
    for (const auto& outwards : rims_[p.feature])
      require(!(p.distance * dot(p.normal, outwards) > slack),
              "boundary_of: the mesh is open, and the flow's place ", x,
              " [m] is beyond its rim, where it has no sides; close the mesh, or extend it by "
              "three cells beyond the flow's box");
  }

  std::shared_ptr<const TriangleMesh> mesh_;
  double sign_;
  std::vector<Vec3d> normals_;            // of faces, edges, vertices
  std::vector<std::vector<Vec3d>> rims_;  // of the same: directions out of the surface
};

/// One surface of a wall, at one time.
struct FlowSurface {
  std::function<double(const Vec3d&)> distance;  // [m] in the body's coordinates
  Pose pose;
  Motion motion;
};

}  // namespace detail

/// Walls of the particles as the boundary of a flow, which is where all of them have their free
/// side; as they are at `time` [s], with the velocity that they have then:
///
///   flow.set_boundary(silt::boundary_of(silt::Cylinder{from, to, radius, silt::Side::Inside}));
///
/// Flow and particles then have the same walls. Their velocity is felt, as a drum's that turns; but
/// surfaces that come elsewhere are not followed: set the boundary anew.
///
/// Valid:  cylinders and cones have free space beyond their ends: let them go on for three cells
///         beyond the flow's box. Fluid that is in one wall or in the other (pipes that branch)
///         takes a mesh of all.
/// Errors: InputError for no walls and surfaces that cannot be; for an open mesh whose triangles do
///         not turn the same way, or whose rim is in the flow (when the distance is asked for).
/// Tests:  tests/fluid/boundary_of.cpp
inline FlowBoundary boundary_of(const std::vector<FlowWall>& walls, double time = 0) {
  auto all = std::make_shared<std::vector<detail::FlowSurface>>();
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
      constexpr double dt = 1e-6;  // [s] its square is nothing beside that of any period
      const Vec3d at = surface.pose.to_body(x);
      return (0.5 / dt) *
             (surface.motion(time + dt).to_space(at) - surface.motion(time - dt).to_space(at));
    };
  return boundary;
}
inline FlowBoundary boundary_of(const Surfaces& surfaces, const Motion& motion = {},
                                double time = 0) {
  return boundary_of(std::vector<FlowWall>{{surfaces, motion}}, time);
}

namespace detail {

/// The motion of a wall near `now` [s]; of one that a drive moves, with its present velocity.
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

/// All walls of a Simulation, as they are now; `fluid`: of its meshes, see FlowWall.
template <class Sim>
FlowBoundary boundary_of_walls(const Sim& sim, Side fluid = Side::Inside) {
  std::vector<FlowWall> walls;
  for (std::size_t k = 0; k < sim.walls(); ++k)
    walls.push_back(
        {Surfaces(sim.wall(k).surfaces), detail::motion_seen(sim.wall(k), sim.time()), fluid});
  return boundary_of(walls, sim.time());
}

}  // namespace silt
