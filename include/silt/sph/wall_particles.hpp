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

#include <silt/boundary/motion.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/sph/driven_walls.hpp>
#include <silt/sph/edge_image.hpp>
#include <silt/sph/face_exit.hpp>
#include <silt/sph/lattice_sites.hpp>
#include <silt/sph/setup.hpp>
#include <silt/sph/wall_part.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Particles of walls: lattice sites within the kernel's support behind surfaces, each with its
/// mirror image in the liquid (ghost). They move with their wall.
class WallParticles {
  using Part = WallPart;
  static constexpr double on_wall = 1e-9;  // [-] of the spacing: nearer sites are behind the wall

 public:
  void add(const Surfaces& surfaces, const WallSetup& setup) {
    for (const Surface& one : surfaces.parts)
      visit_surface(one, [](const auto& s) {
        if constexpr (requires { s.check(); }) s.check();
      });
    const std::size_t number = walls_.size();
    Part part{surfaces.parts, setup.name, setup.motion, setup.surface_velocity, nullptr};
    require(setup.drive.index() == 0, "Sph: wall ", part.called(number),
            " has a drive, which needs a Simulation; add the wall to a Simulation that "
            "has the Sph as its fluid, or give it a motion");
    for (const Part& other : walls_)
      require(setup.name.empty() || other.name != setup.name, "Sph: there is a wall '", setup.name,
              "' already; give each wall a name of its own, or none");
    part.check(number);
    setup.surface_velocity.check();
    part.move_to(0, 1, number);
    part.first = part.pose;
    walls_.push_back(std::move(part));
    fresh_ = true;
  }
  /// The walls of a Simulation, which moves them; they must not move in memory. True if walls were
  /// added or removed.
  bool follow(const DynArray<Wall>& walls) {
    bool same = followed_ == walls.size();
    for (std::size_t w = 0; w < walls.size() && same; ++w)
      same = walls_[w].of == &walls[w] && walls_[w].surfaces.size() == walls[w].surfaces.size();
    for (std::size_t w = 0; w < walls.size(); ++w)
      require(walls[w].deforming == 0, "Sph: the mesh of ", name_of_wall(walls, w),
              " deforms (set_mesh); walls of a liquid are rigid: move it by a motion or a drive");
    if (same) return false;
    require(followed_ == walls_.size(),
            "Sph: both the Sph and the Simulation have walls; add all of them to the "
            "Simulation");
    const bool restored = restored_.size() == walls.size() && !walls.empty();
    walls_.clear();
    for (const Wall& w : walls) {
      walls_.push_back({w.surfaces, w.name, {}, {}, &w});
      Part& part = walls_.back();
      part.check(walls_.size() - 1);
      part.pose = part.last = part.next = part.first = part.listed = w.pose;
    }
    followed_ = walls.size();
    find_belts();
    if (restored) {
      take_restored();
      return false;
    }
    fresh_ = true;
    return true;
  }
  /// The lists were built with the present poses.
  void note_pose() {
    for (Part& w : walls_) w.listed = w.pose;
  }
  /// [m] Upper bound of the displacement since then: that of the corners of each wall's bounding
  /// box.
  double way() const {
    return most_at_corners([](const Part& of, const Vec3d& x) {
      return norm(of.pose.to_space(x) - of.listed.to_space(x));
    });
  }
  /// [m/s] upper bound.
  double fastest() const {
    return most_at_corners([](const Part& of, const Vec3d& x) {
      return norm(of.next.to_space(x) - of.last.to_space(x)) / of.span;
    });
  }
  /// Walls of the Sph itself, not of a Simulation.
  std::size_t own_walls() const { return walls_.size() - followed_; }

  /// For a state: ten numbers per particle, and 31 per wall: poses when the particles were made and
  /// when the lists were built, and the motion of a driven wall since the last step.
  std::pair<DynArray<double>, DynArray<double>> state() const {
    std::pair<DynArray<double>, DynArray<double>> of;
    for (const Particle& p : particles_) {
      for (const Vec3d& x : {p.at, p.ghost, p.normal})
        of.first.insert(of.first.end(), {x.x, x.y, x.z});
      of.first.push_back(static_cast<double>(p.wall));
    }
    for (const Part& w : walls_) {
      for (const Pose& pose : {w.first, w.listed, w.driven.from}) {
        const Vec3d& x = pose.translation;
        const Quaternion& q = pose.rotation;
        of.second.insert(of.second.end(), {x.x, x.y, x.z, q.w, q.x, q.y, q.z});
      }
      for (const Vec3d& x : {w.driven.centre, w.driven.velocity, w.driven.spin})
        of.second.insert(of.second.end(), {x.x, x.y, x.z});
      of.second.push_back(w.driven.since);
    }
    return of;
  }
  /// Restores a state. Walls of a Simulation are set later by follow().
  void restore(std::span<const double> particles, std::span<const double> poses) {
    constexpr std::size_t per = 31;
    const std::size_t n = particles.size() / 10, walls = poses.size() / per;
    require(particles.size() == 10 * n && poses.size() == per * walls, "Sph: a state of walls has ",
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
        const double* const p = poses.data() + per * w + 7 * k;
        return Pose{{p[3], p[4], p[5], p[6]}, {p[0], p[1], p[2]}};
      };
      const double* const p = poses.data() + per * w + 21;
      restored_.push_back(
          {pose(0), pose(1),
           DrivenMotion{
               pose(2), {p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}, p[9]}});
    }
    fresh_ = false;
    find_belts();
    if (walls_.size() == walls && followed_ == 0) take_restored();
  }

  bool fresh() const { return fresh_; }
  std::size_t size() const { return particles_.size(); }
  std::size_t walls() const { return walls_.size(); }

  /// [m] from the nearest wall, negative behind it.
  double distance(const Vec3d& x) const { return nearest(x).distance; }
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  // [m]
    Vec3d normal{0, 0, 0};                                      // [-] towards the free side
    std::size_t wall = 0;
  };
  /// The wall of the smallest distance: for a point behind several walls, the one in which it is
  /// deepest.
  enum class Which { All, AtRest };
  Nearest nearest(const Vec3d& x, Which which = Which::All) const {
    Nearest least;
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      if (which == Which::AtRest && walls_[w].moves()) continue;
      if (const SurfacePoint p = walls_[w].nearest(x); p.distance < least.distance)
        least = {p.distance, p.normal, w};
    }
    return least;
  }
  bool is_behind(std::size_t wall, const Vec3d& x) const {
    return walls_[wall].nearest(x).distance < 0;
  }
  /// Whether no liquid starts at a lattice site. A wall across an axis leaves half a spacing before
  /// the first row. At curved and oblique walls the sites in front are liquid and those behind are
  /// wall: the lattice has no gap, and the volume is right on average. (With half a spacing there
  /// too, the liquid in a cone 12 spacings across had 0.88 of its volume, and the pressure on its
  /// floor was 8 % too high for its level; computed.)
  bool is_too_near(const Vec3d& x, double spacing) const {
    const Nearest to = nearest(x);
    if (!(to.distance < 0.499 * spacing)) return false;
    return is_across(to.normal) || to.distance < on_wall * spacing;
  }
  /// Whether a site too near to a wall lies on an oblique or curved one.
  bool lies_on(const Vec3d& x, double spacing) const {
    const Nearest to = nearest(x);
    return std::abs(to.distance) < on_wall * spacing && !is_across(to.normal);
  }
  /// "'lid'", or its number.
  std::string called(std::size_t wall) const { return walls_[wall].called(wall); }
  /// Transforms a point from space to a wall's own coordinates, and back.
  Vec3d to_wall(std::size_t wall, const Vec3d& x) const { return walls_[wall].pose.to_body(x); }
  Vec3d to_space(std::size_t wall, const Vec3d& x) const { return walls_[wall].pose.to_space(x); }
  /// Calls visit(wall, point, normal) for each plane of the walls, at its present pose.
  template <class Visit>
  void for_each_plane(const Visit& visit) const {
    for (std::size_t w = 0; w < walls_.size(); ++w)
      for (const Surface& one : walls_[w].surfaces)
        if (const auto* const plane = std::get_if<Plane>(&one))
          visit(w, walls_[w].pose.to_space(plane->point),
                normalised(walls_[w].pose.rotate(plane->normal)));
  }

  /// Sites behind a resting wall belong to it, for any moving wall: behind a retracting piston the
  /// floor continues. No particles where hold(x) is true.
  template <class Hold>
  void make(const SphSetup& setup, const Hold& hold) {
    fresh_ = false;
    particles_.clear();
    const double support = 2 * setup.h(), enough = on_wall * setup.spacing;
    const int layers = static_cast<int>(std::ceil(support / setup.spacing));
    const double thick = (layers + 0.001) * setup.spacing;
    for_each_site(setup, layers, [&](const Vec3d& x) {
      const Nearest rest = nearest(x, Which::AtRest), all = nearest(x);
      const bool at_rest = rest.distance < enough;
      const Nearest& least = at_rest ? rest : all;
      if (!(least.distance < enough) || least.distance < -thick) return;
      const Which which = at_rest ? Which::AtRest : Which::All;
      Vec3d surface = to_surface(x, enough, which);
      if (norm(x - surface) > thick || hold(x)) return;
      if (const auto past = way_past_edge(x, least, which, setup)) surface = x + *past;
      const Part& wall = walls_[least.wall];
      const Vec3d out = surface - x;  // towards the liquid
      const bool flat = std::holds_alternative<Plane>(wall.surfaces[wall.nearest_surface(x)]);
      particles_.push_back({wall.pose.to_body(x), wall.pose.to_body(x + 2 * out),
                            flat && norm(out) > 0 ? normalised(out) : Vec3d{0, 0, 0},
                            static_cast<std::uint32_t>(least.wall)});
    });
    refuse_what_has_none(setup);
    find_belts();
    find_boxes();
  }
  /// [m] In the wall's own coordinates.
  const Vec3d& own_place(std::size_t k) const { return particles_[k].at; }
  const Vec3d& own_ghost(std::size_t k) const { return particles_[k].ghost; }
  /// Whether a particle moves with its wall, i.e. is not on a belt.
  bool goes_along(std::size_t k) const {
    const Part& wall = walls_[particles_[k].wall];
    const SurfaceVelocity& belt = wall.of != nullptr ? wall.of->belt : wall.belt;
    return belt.is_zero() &&
           (!wall.is_belt || dot(particles_[k].normal, particles_[k].normal) == 0);
  }
  Vec3d place(std::size_t k) const { return in_space(particles_[k], particles_[k].at); }
  Vec3d ghost(std::size_t k) const { return in_space(particles_[k], particles_[k].ghost); }
  std::size_t wall_of(std::size_t k) const { return particles_[k].wall; }
  /// [m/s] of the wall's material halfway between particle and ghost.
  Vec3d velocity(std::size_t k) const {
    const Vec3d at = 0.5 * (particles_[k].at + particles_[k].ghost);
    return velocity_of(particles_[k].wall, at) + belt_velocity(k);
  }
  /// [m/s] at a point in a wall's own coordinates.
  Vec3d velocity_of(std::size_t w, const Vec3d& own) const { return walls_[w].velocity(own); }
  /// ... at a point in space.
  Vec3d velocity_at(std::size_t w, const Vec3d& x) const {
    return velocity_of(w, walls_[w].pose.to_body(x));
  }
  /// ... at the particle.
  Vec3d own_velocity(std::size_t k) const {
    return velocity_of(particles_[k].wall, particles_[k].at) + belt_velocity(k);
  }
  /// [m] depth of a particle below the surface.
  double depth(std::size_t k) const { return 0.5 * norm(particles_[k].ghost - particles_[k].at); }
  bool any_moves() const {
    for (const Part& w : walls_)
      if (w.moves()) return true;
    return false;
  }
  /// @name Walls of a Simulation that have a drive
  /// @{
  bool is_driven(std::size_t wall) const { return walls_[wall].is_driven(); }
  bool any_driven() const {
    for (std::size_t w = 0; w < walls_.size(); ++w)
      if (is_driven(w)) return true;
    return false;
  }
  /// They continue from their present pose with their present velocities.
  void take_drives(double time) {
    for (std::size_t w = 0; w < walls_.size(); ++w)
      if (is_driven(w)) walls_[w].driven = DrivenMotion::of(*walls_[w].of, time);
  }
  const Wall& wall(std::size_t w) const { return *walls_[w].of; }
  const DrivenMotion& driven(std::size_t w) const { return walls_[w].driven; }
  /// @}
  /// Moves to `time` [s]; velocities are those of the `span` [s] before.
  void move_to(double time, double span) {
    for (std::size_t w = 0; w < walls_.size(); ++w) walls_[w].move_to(time, span, w);
  }

 private:
  static bool is_across(const Vec3d& n) {
    return std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) > 1 - 1e-9;
  }
  template <class Of>
  double most_at_corners(const Of& of) const {
    double most = 0;
    for (std::size_t w = 0; w < boxes_.size() && w < walls_.size(); ++w) {
      if (!walls_[w].moves() || !is_finite(boxes_[w].min)) continue;
      for (int c = 0; c < 8; ++c) {
        const Vec3d &a = boxes_[w].min, &b = boxes_[w].max;
        most = std::max(most,
                        of(walls_[w], {c & 1 ? b.x : a.x, c & 2 ? b.y : a.y, c & 4 ? b.z : a.z}));
      }
    }
    return most;
  }
  /// Refuses a wall in free space that has no lattice site between its surfaces.
  void refuse_what_has_none(const SphSetup& setup) const {
    DynArray<char> has(walls_.size(), 0);
    for (const Particle& p : particles_) has[p.wall] = 1;
    if (std::all_of(has.begin(), has.end(), [](char h) { return h != 0; })) return;
    const double s = setup.spacing;
    for_each_site(setup, 0, [&](const Vec3d& x) {
      const Nearest here = nearest(x);
      if (here.distance < 0 || here.distance > s || has[here.wall] != 0) return;
      for (std::size_t w = 0; w < walls_.size(); ++w)
        if (w != here.wall && walls_[w].nearest(x).distance < here.distance + 1e-6 * s) return;
      throw InputError(text("Sph: wall ", called(here.wall), " near ", x,
                            " m is thinner than a spacing of ", s,
                            " m and has no particles; liquid passes through it; make it "
                            "thicker than 2 h = ",
                            2 * setup.h(), " m, or use a smaller spacing"));
    });
  }
  void find_boxes() {
    boxes_.assign(walls_.size(), Box{});
    for (const Particle& p : particles_)
      boxes_[p.wall].include(p.at), boxes_[p.wall].include(p.ghost);
  }
  void take_restored() {
    for (std::size_t w = 0; w < walls_.size(); ++w)
      walls_[w].first = restored_[w].first, walls_[w].listed = restored_[w].listed,
      walls_[w].driven = restored_[w].driven;
    restored_.clear();
    find_boxes();
  }
  struct Particle {
    Vec3d at, ghost;  // [m] in the wall's own coordinates
    Vec3d normal;     // [-] of a plane, else 0
    std::uint32_t wall;
  };

  /// [m/s] of a belt, along the surface.
  Vec3d belt_velocity(std::size_t k) const {
    const Part& wall = walls_[particles_[k].wall];
    const SurfaceVelocity& belt = wall.of != nullptr ? wall.of->belt : wall.belt;
    if (belt.is_zero()) return {0, 0, 0};
    const Vec3d x = place(k), out = ghost(k) - x;
    return belt.at(x + 0.5 * out, norm(out) > 0 ? normalised(out) : Vec3d{0, 0, 0});
  }
  /// Particles of a plane that slides along itself do not move: the plane is infinite.
  Vec3d in_space(const Particle& p, const Vec3d& own) const {
    const Part& wall = walls_[p.wall];
    const Quaternion &now = wall.pose.rotation, &then = wall.first.rotation;
    const bool turned = now.w != then.w || now.x != then.x || now.y != then.y || now.z != then.z;
    if (turned || !wall.is_belt || dot(p.normal, p.normal) == 0) return wall.pose.to_space(own);
    const Vec3d way = wall.pose.translation - wall.first.translation;
    return wall.first.to_space(own) + dot(way, p.normal) * p.normal;
  }
  /// Only walls of parallel planes may slide along themselves. In a tank that moves as a whole
  /// (other walls move in the same way) particles move with it, otherwise it would open at its
  /// edges.
  void find_belts() {
    const auto across = [](const Surface& one) {
      const auto* const plane = std::get_if<Plane>(&one);
      return plane == nullptr ? Vec3d{0, 0, 0} : normalised(plane->normal);
    };
    for (Part& w : walls_) {
      w.is_belt = true;
      for (const Part& other : walls_)
        if (goes_with(w, other))
          for (const Surface& a : w.surfaces)
            for (const Surface& b : other.surfaces)
              if (std::abs(dot(across(a), across(b))) < 1 - 1e-9) w.is_belt = false;
    }
  }
  static bool goes_with(const Part& a, const Part& b) {
    if (&a == &b) return true;
    const auto prescribed = [](const Part& w) { return w.moves() && !w.is_driven(); };
    if (!prescribed(a) || !prescribed(b)) return false;
    // Two functions are compared by their values.
    const auto at = [](const Part& w, double t) {
      return w.of != nullptr ? w.of->pose_at(t) : w.motion(t);
    };
    for (const double t : {0.0, 0.0123, 0.217})
      if (!(at(a, t) == at(b, t))) return false;
    return true;
  }

  /// Nearest point that is behind no wall, by steps to one surface after the other.
  Vec3d to_surface(Vec3d x, double enough, Which which) const {
    for (int n = 0; n < 50; ++n) {
      const Nearest deepest = nearest(x, which);
      if (deepest.distance > -enough) break;
      x += way_out_of(deepest, x);
    }
    return x;
  }
  /// Of walls only meshes have convex edges.
  std::optional<Vec3d> way_past_edge(const Vec3d& x, const Nearest& deepest, Which which,
                                     const SphSetup& setup) const {
    const Part& wall = walls_[deepest.wall];
    if (!(deepest.distance < 0) || !std::holds_alternative<std::shared_ptr<const TriangleMesh>>(
                                       wall.surfaces[wall.nearest_surface(x)]))
      return std::nullopt;
    return way_out_at_edge(x, -deepest.distance, setup.h(), setup.dimensions == 2,
                           [&](const Vec3d& at) { return nearest(at, which).distance; });
  }
  Vec3d way_out_of(const Nearest& deepest, const Vec3d& x) const {
    const Part& wall = walls_[deepest.wall];
    const auto* const mesh =
        std::get_if<std::shared_ptr<const TriangleMesh>>(&wall.surfaces[wall.nearest_surface(x)]);
    if (mesh != nullptr)
      if (const auto way = way_out(**mesh, wall.pose.to_body(x), -deepest.distance, 1))
        return wall.pose.rotate(*way);
    return -deepest.distance * deepest.normal;
  }

  DynArray<Part> walls_;
  DynArray<Particle> particles_;
  DynArray<Box> boxes_;       // around the particles of each wall, with their images
  std::size_t followed_ = 0;  // walls of a Simulation
  struct Restored {
    Pose first, listed;
    DrivenMotion driven;
  };
  DynArray<Restored> restored_;  // of walls of a Simulation that are not set yet
  bool fresh_ = true;
};

}  // namespace silt::detail
