// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/error.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Calls visit(x) for the centres of the lattice's cells in the region, and in `layers` more of
/// them beyond it where it does not repeat.
template <class Visit>
void for_each_site(const SphSetup& setup, int layers, const Visit& visit) {
  const double s = setup.spacing;
  const Vec3d low = setup.region.min, e = setup.region.extent();
  const double length[3] = {e.x, e.y, e.z};
  int from[3], to[3];
  for (std::size_t d = 0; d < 3; ++d) {
    const int more = setup.periodic[d] ? 0 : layers;
    from[d] = -more, to[d] = static_cast<int>(std::ceil(length[d] / s - 1e-6)) + more;
  }
  if (setup.dimensions == 2) from[1] = 0, to[1] = 1;
  for (int i = from[0]; i < to[0]; ++i)
    for (int j = from[1]; j < to[1]; ++j)
      for (int k = from[2]; k < to[2]; ++k)
        visit(Vec3d{low.x + (i + 0.5) * s, setup.dimensions == 2 ? low.y : low.y + (j + 0.5) * s,
                    low.z + (k + 0.5) * s});
}

/// The particles of walls: sites of the lattice that are behind surfaces by less than the kernel's
/// support, each with its mirror image in the liquid, its ghost. They move with their wall.
class WallParticles {
 public:
  void add(const Surfaces& surfaces, const WallSetup& setup) {
    for (const Surface& one : surfaces.parts)
      visit_surface(one, [](const auto& s) {
        if constexpr (requires { s.check(); }) s.check();
      });
    require(setup.drive.index() == 0 && setup.surface_velocity.is_zero(), "Sph: wall ",
            in_quotes(setup.name),
            " has a drive or a surface velocity; a wall of the liquid may "
            "have a motion");
    check(surfaces.parts, setup.name);
    walls_.push_back({surfaces.parts, setup.name, setup.motion, nullptr});
    place(walls_.back(), 0, 1);
    walls_.back().first = walls_.back().pose;
    fresh_ = true;
  }
  /// The walls of a Simulation, which it moves; they must stay where they are in memory. True if
  /// there are others than before.
  bool follow(const std::vector<Wall>& walls) {
    bool same = followed_ == walls.size();
    for (std::size_t w = 0; w < walls.size() && same; ++w)
      same = walls_[w].of == &walls[w] && walls_[w].surfaces.size() == walls[w].surfaces.size();
    if (same) return false;
    require(followed_ == walls_.size(),
            "Sph: it has walls of its own, and the Simulation has some too; add all of them to the "
            "Simulation");
    const bool restored = restored_.size() == walls.size() && !walls.empty();
    walls_.clear();
    for (const Wall& w : walls) {
      require(!w.is_driven() && !w.has_belt(), "Sph: wall ", in_quotes(w.name),
              " has a drive or a surface velocity; walls of a liquid may have a motion");
      check(w.surfaces, w.name);
      walls_.push_back({w.surfaces, w.name, w.motion, &w});
      Part& part = walls_.back();
      part.pose = part.last = part.next = part.first = part.listed = w.pose;
    }
    followed_ = walls.size();
    if (restored) {
      take_restored();
      return false;
    }
    fresh_ = true;
    return true;
  }
  /// The lists were made with walls where they are now.
  void note_pose() {
    for (Part& w : walls_) w.listed = w.pose;
  }
  /// [m] How far no particle has gone beyond since then: as far as a corner of the box around those
  /// of its wall.
  double way() const {
    double most = 0;
    for (std::size_t w = 0; w < boxes_.size() && w < walls_.size(); ++w) {
      const Part& of = walls_[w];
      if (!of.motion || !is_finite(boxes_[w].min)) continue;
      for (int c = 0; c < 8; ++c) {
        const Vec3d &a = boxes_[w].min, &b = boxes_[w].max;
        const Vec3d x{c & 1 ? b.x : a.x, c & 2 ? b.y : a.y, c & 4 ? b.z : a.z};
        most = std::max(most, norm(of.pose.to_space(x) - of.listed.to_space(x)));
      }
    }
    return most;
  }
  /// Walls of its own, not of a Simulation.
  std::size_t own_walls() const { return walls_.size() - followed_; }

  /// For a state: ten numbers a particle, and fourteen a wall, where it was as they were made, and
  /// the lists.
  std::pair<std::vector<double>, std::vector<double>> state() const {
    std::pair<std::vector<double>, std::vector<double>> of;
    for (const Particle& p : particles_) {
      for (const Vec3d& x : {p.at, p.ghost, p.normal})
        of.first.insert(of.first.end(), {x.x, x.y, x.z});
      of.first.push_back(static_cast<double>(p.wall));
    }
    for (const Part& w : walls_)
      for (const Pose& pose : {w.first, w.listed}) {
        const Vec3d& x = pose.translation;
        const Quaternion& q = pose.rotation;
        of.second.insert(of.second.end(), {x.x, x.y, x.z, q.w, q.x, q.y, q.z});
      }
    return of;
  }
  /// Those of a state. Walls of a Simulation are told later, by follow().
  void restore(std::span<const double> particles, std::span<const double> poses) {
    const std::size_t n = particles.size() / 10, walls = poses.size() / 14;
    require(particles.size() == 10 * n && poses.size() == 14 * walls, "Sph: a state of walls has ",
            particles.size(), " and ", poses.size(), " numbers");
    particles_.clear(), restored_.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const double* const p = particles.data() + 10 * k;
      require(p[9] == std::floor(p[9]) && p[9] >= 0 && p[9] < static_cast<double>(walls),
              "Sph: particle ", k, " of walls of a state is of wall ", p[9], " of ", walls);
      particles_.push_back({{p[0], p[1], p[2]},
                            {p[3], p[4], p[5]},
                            {p[6], p[7], p[8]},
                            static_cast<std::uint32_t>(p[9])});
    }
    for (std::size_t w = 0; w < walls; ++w) {
      const auto pose = [&](std::size_t k) {
        const double* const p = poses.data() + 14 * w + 7 * k;
        return Pose{{p[3], p[4], p[5], p[6]}, {p[0], p[1], p[2]}};
      };
      restored_.push_back({pose(0), pose(1)});
    }
    fresh_ = false;
    if (walls_.size() == walls && followed_ == 0) take_restored();
  }

  bool fresh() const { return fresh_; }
  std::size_t size() const { return particles_.size(); }
  std::size_t walls() const { return walls_.size(); }

  /// [m] from the nearest wall, negative behind it.
  double distance(const Vec3d& x) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Part& wall : walls_) least = std::min(least, nearest(wall, x).distance);
    return least;
  }

  void make(const SphSetup& setup) {
    fresh_ = false;
    particles_.clear();
    const double support = 2 * setup.h();
    const int layers = static_cast<int>(std::ceil(support / setup.spacing));
    const double thick = (layers + 0.001) * setup.spacing;
    for_each_site(setup, layers, [&](const Vec3d& x) {
      std::size_t of = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t w = 0; w < walls_.size(); ++w)
        if (const double d = nearest(walls_[w], x).distance; d < least) least = d, of = w;
      if (!(least < 1e-9 * setup.spacing) || least < -thick) return;
      const Vec3d surface = to_surface(x, 1e-9 * setup.spacing);
      if (norm(x - surface) > thick) return;
      const Part& wall = walls_[of];
      const Vec3d out = surface - x;  // towards the liquid
      const bool flat = std::holds_alternative<Plane>(wall.surfaces[nearest_surface(wall, x)]);
      particles_.push_back({wall.pose.to_body(x), wall.pose.to_body(x + 2 * out),
                            flat && norm(out) > 0 ? normalised(out) : Vec3d{0, 0, 0},
                            static_cast<std::uint32_t>(of)});
    });
    find_boxes();
  }
  Vec3d place(std::size_t k) const { return in_space(particles_[k], particles_[k].at); }
  Vec3d ghost(std::size_t k) const { return in_space(particles_[k], particles_[k].ghost); }
  std::size_t wall_of(std::size_t k) const { return particles_[k].wall; }
  /// [m/s] of the wall's material half way between particle and ghost.
  Vec3d velocity(std::size_t k) const {
    const Part& wall = walls_[particles_[k].wall];
    if (!wall.motion) return {0, 0, 0};
    const Vec3d at = 0.5 * (particles_[k].at + particles_[k].ghost);
    return (1 / wall.span) * (wall.next.to_space(at) - wall.last.to_space(at));
  }
  bool any_moves() const {
    for (const Part& w : walls_)
      if (w.motion) return true;
    return false;
  }
  /// To `time` [s]; velocities are those of the `span` [s] before.
  void move_to(double time, double span) {
    for (Part& w : walls_) place(w, time, span);
  }

 private:
  struct Part {
    std::vector<Surface> surfaces;
    std::string name;
    Motion motion;
    const Wall* of;  // of a Simulation; null: its own
    Pose pose{}, last{}, next{}, first{}, listed{};
    double span = 1;
  };
  void find_boxes() {
    boxes_.assign(walls_.size(), Box{});
    for (const Particle& p : particles_)
      boxes_[p.wall].include(p.at), boxes_[p.wall].include(p.ghost);
  }
  void take_restored() {
    for (std::size_t w = 0; w < walls_.size(); ++w)
      walls_[w].first = restored_[w].first, walls_[w].listed = restored_[w].second;
    restored_.clear();
    find_boxes();
  }
  static void place(Part& w, double time, double span) {
    if (!w.motion) return;
    const auto at = [&w](double t) { return w.of != nullptr ? w.of->pose_at(t) : w.motion(t); };
    const double from = std::max(time - span, 0.0);  // motions need not be known before 0
    w.pose = at(time), w.last = at(from), w.next = at(from + span), w.span = span;
  }
  static void check(const std::vector<Surface>& surfaces, const std::string& name) {
    for (const Surface& one : surfaces)
      visit_surface(one, [&](const auto& s) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, TriangleMesh>)
          require(s.is_closed(), "Sph: the mesh of wall ", in_quotes(name),
                  " is not closed, so that it has no side behind it; close it, or use planes, "
                  "cylinders and cones");
      });
  }
  struct Particle {
    Vec3d at, ghost;  // [m] in the wall's own coordinates
    Vec3d normal;     // [-] of a plane, else 0
    std::uint32_t wall;
  };

  /// A plane that slides along itself leaves its particles where they are: it has no end.
  Vec3d in_space(const Particle& p, const Vec3d& own) const {
    const Part& wall = walls_[p.wall];
    const Quaternion &now = wall.pose.rotation, &then = wall.first.rotation;
    const bool slides = now.w == then.w && now.x == then.x && now.y == then.y && now.z == then.z;
    if (!slides || dot(p.normal, p.normal) == 0) return wall.pose.to_space(own);
    const Vec3d way = wall.pose.translation - wall.first.translation;
    return wall.first.to_space(own) + dot(way, p.normal) * p.normal;
  }

  static std::size_t nearest_surface(const Part& wall, const Vec3d& x) {
    std::size_t which = 0;
    nearest(wall, x, &which);
    return which;
  }
  static SurfacePoint nearest(const Part& wall, const Vec3d& x, std::size_t* which = nullptr) {
    constexpr double far = std::numeric_limits<double>::infinity();
    SurfacePoint least{{0, 0, 0}, far, 0};
    const Vec3d own = wall.pose.to_body(x);
    for (std::size_t k = 0; k < wall.surfaces.size(); ++k)
      visit_surface(wall.surfaces[k], [&](const auto& s) {
        SurfacePoint p;
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(s)>, TriangleMesh>) {
          p = s.nearest_point(own);
          // Free is the side that the triangles' normals point to.
          if (s.contains(own) == (s.volume() > 0)) p.distance *= -1, p.normal = -1.0 * p.normal;
        } else {
          if (s.contacts(own, 1e300, &p) == 0) return;
        }
        if (!(p.distance < least.distance)) return;
        least = p;
        if (which != nullptr) *which = k;
      });
    least.normal = wall.pose.rotate(least.normal);
    return least;
  }
  /// The nearest point that is behind no wall, by steps to one surface after the other.
  Vec3d to_surface(Vec3d x, double enough) const {
    for (int n = 0; n < 50; ++n) {
      SurfacePoint deepest{{0, 0, 0}, 0, 0};
      for (const Part& wall : walls_)
        if (const SurfacePoint p = nearest(wall, x); p.distance < deepest.distance) deepest = p;
      if (deepest.distance > -enough) break;
      x -= deepest.distance * deepest.normal;
    }
    return x;
  }

  std::vector<Part> walls_;
  std::vector<Particle> particles_;
  std::vector<Box> boxes_;    // around those of each wall, with their images
  std::size_t followed_ = 0;  // walls of a Simulation
  std::vector<std::pair<Pose, Pose>>
      restored_;  // first and listed, of walls of a Simulation that have not been told yet
  bool fresh_ = true;
};

}  // namespace silt::detail
