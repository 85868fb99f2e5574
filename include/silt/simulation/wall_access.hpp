// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <concepts>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <silt/boundary/deforming_box.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/engine/advance/wall_motion.hpp>
#include <silt/engine/checks/ended_contacts.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A drive that rotates a wall must know the extent of the wall.
inline void check_fits(const WallDrive& drive, const Box& extent) {
  require(
      !std::holds_alternative<FreeBody>(drive) || (is_finite(extent.min) && is_finite(extent.max)),
      "a FreeBody needs surfaces of finite size, as meshes, cylinders and cones; a plane is "
      "infinite");
}

/// Read access to walls and changes of them, between runs and in observers; member functions of
/// Simulation. A wall is given by its number or its name. InputError: no such wall, or an invalid
/// value. Tests: tests/engine/wall_setup.cpp, free_walls.cpp.
template <class Sim>
class WallAccess {
 public:
  const Wall& wall(const WhichWall& which) const {
    const auto& walls = sim().engine().walls;
    return walls[number_of(walls, which)];
  }
  /// See Simulation::add_wall.
  template <std::convertible_to<Motion> M, class S = Sim>
  std::size_t add_wall(Surfaces surfaces, const typename S::ContactsType::Material& solid,
                       M motion) {
    return sim().add_wall(std::move(surfaces), solid, WallSetup{.motion = std::move(motion)});
  }
  /// Refused: the material of another law.
  template <class Other, class S = Sim>
  requires(!std::is_convertible_v<const Other&, typename S::ContactsType::Material>) std::size_t
      add_wall(const Surfaces&, const Other&, const WallSetup& = {}) {
    return refuse_material<Other>(), 0;
  }
  template <class Other, std::convertible_to<Motion> M, class S = Sim>
  requires(!std::is_convertible_v<const Other&, typename S::ContactsType::Material>) std::size_t
      add_wall(const Surfaces&, const Other&, const M&) {
    return refuse_material<Other>(), 0;
  }
  std::size_t walls() const { return sim().engine().walls.size(); }
  std::size_t wall_number(const WhichWall& which) const {
    return number_of(sim().engine().walls, which);
  }
  /// The number of the wall with this name.
  std::size_t find_wall(std::string_view name) const {
    return number_of(sim().engine().walls, name);
  }
  /// The name used in messages: "wall 2 'lid'".
  std::string wall_name(std::size_t k) const { return name_of_wall(sim().engine().walls, k); }
  void name_wall(const WhichWall& which, std::string name) {
    const std::size_t k = number(which);
    check_wall_name(all(), name, k);
    all()[k].name = std::move(name);
  }
  /// Removes the surfaces of a wall, e.g. a lid that opens. Its number stays in use; its name is
  /// free for a new wall. Its loads can still be read; changes of it are refused. The energy in its
  /// contacts is booked as in ParticleEdits::remove.
  void remove_wall(const WhichWall& which) {
    const std::size_t k = number(which);
    if constexpr (Sim::has_ledger && !Sim::of_bodies && !deforms<typename Sim::Domain>) {
      auto& s = sim();
      using Ended = EndedContacts<typename Sim::Engine, typename Sim::Domain>;
      if (!s.first_kick_) {
        const Ended ended(s.engine_, s.domain_, typename Ended::OfWall{k}, s.kicked_ ? 0 : s.dt_,
                          s.dt_);
        s.book_.removed(ended.work, ended.normal);
      }
    }
    all()[k].surfaces.clear();
    sim().engine_.lists.forget();
  }
  /// Sets the point [m] about which torque and angular impulse are taken from now on.
  void set_reference(const WhichWall& which, const Vec3d& point) {
    require(is_finite(point), "Simulation::set_reference: ", point, " [m] must be finite");
    const std::size_t k = number(which);
    Wall& wall = all()[k];
    const Vec3d back = wall.reference - point;
    if constexpr (Sim::has_ranks) sim().engine_.ranks.move_reference(k, back);
    wall.torque += cross(back, wall.force), wall.angular_impulse += cross(back, wall.impulse);
    wall.reference = point;
  }
  /// Prescribes the motion of the wall from now on: it continues from its present pose with the
  /// increments of `motion` from the present time on. For a motion that starts now:
  /// from(sim.time(), motion). An empty one stops the wall.
  void set_motion(const WhichWall& which, Motion motion) {
    const std::size_t k = number(which);
    Wall& wall = all()[k];
    const Pose pose = wall.pose;
    wall.drive = {}, wall.state = {};
    wall.state.start = pose, wall.state.since = sim().time_, wall.state.changed = 1;
    wall.motion = motion ? std::move(motion) : Motion([](double) { return Pose{}; });
    changed(k);
  }
  /// Lets the loads on the wall move it from now on, from its present pose; a prescribed Motion is
  /// discarded. An empty drive stops the wall. A servo that gets another load, speed or gain goes
  /// on with its integral, which may happen in every step.
  void set_drive(const WhichWall& which, WallDrive drive) {
    const std::size_t k = number(which);
    if (drive.index() == 0) return set_motion(k, {});
    check_drive(drive), check_fits(drive, all()[k].extent);
    Wall& wall = all()[k];
    if (goes_on(wall.drive, drive, wall.state)) return void(wall.drive = std::move(drive));
    release(k, std::move(drive));
    changed(k);
  }
  /// Sets a tangential surface velocity, as of a belt.
  void set_surface_velocity(const WhichWall& which, const SurfaceVelocity& velocity) {
    velocity.check();
    const std::size_t k = number(which);
    Wall& wall = all()[k];
    // It may have been a plane at rest, which the lists treat specially.
    if (!wall.moves() || wall.has_belt() != !velocity.is_zero()) changed(k);
    wall.belt = velocity;
  }
  /// Replaces the mesh of the wall, in its own coordinates, at `surface` (0: the first). With the
  /// same triangles and displaced vertices, the vertices move there during the next step, and
  /// contacts feel their velocity; to deform a wall, call it in every step. With other triangles
  /// the surface is a new one, at rest. Contacts keep their history where the normal stays nearly
  /// the same. Each call forces a search in the next step. A FreeBody keeps its mass.
  void set_mesh(const WhichWall& which, TriangleMesh mesh, std::size_t surface = 0) {
    const std::size_t k = number(which);
    Wall& wall = all()[k];
    require(surface < wall.surfaces.size() && is_mesh(wall.surfaces[surface]),
            "Simulation::set_mesh: surface ", surface, " of ", wall_name(k),
            " is no mesh; give the number of a surface that is one");
    auto& held = std::get<std::shared_ptr<const TriangleMesh>>(wall.surfaces[surface]);
    const bool same =
        held->triangles() == mesh.triangles() && held->vertices().size() == mesh.vertices().size();
    wall.vertex_steps.clear();
    for (std::size_t v = 0; same && v < mesh.vertices().size(); ++v)
      wall.vertex_steps.push_back(mesh.vertices()[v] - held->vertices()[v]);
    wall.deforming = same && sim().dt_ > 0 ? 2 : 0, wall.deformed = surface;
    if (!same) sim().engine_.lists.walls.forget_facets(k), wall.worn.clear();
    held = std::make_shared<const TriangleMesh>(std::move(mesh));
    wall.extent = extent_of(wall.surfaces);
    changed(k);
  }
  /// Energy of a free wall [J] at time(): kinetic, in gravity and in its spring.
  WallEnergy wall_energy(const WhichWall& which) const {
    return energy_of(wall(which), sim().gravity);
  }

 protected:
  /// Gives wall k a drive; in the middle of a run it gets the half kick that others have had.
  void release(std::size_t k, WallDrive drive) {
    Wall& wall = all()[k];
    wall.motion = {}, wall.drive = std::move(drive);
    wall.state = released(wall.drive, wall.pose, sim().time_);
    if (sim().kicked_ && is_free(wall.drive))
      push_wall(wall, sim().gravity, 0.5 * sim().dt_, sim().dt_, true);
  }

 private:
  Sim& sim() { return static_cast<Sim&>(*this); }
  const Sim& sim() const { return static_cast<const Sim&>(*this); }
  auto& all() { return sim().engine_.walls; }
  /// Of a wall that is there.
  std::size_t number(const WhichWall& which) {
    const std::size_t k = number_of(all(), which);
    require(!all()[k].is_removed(), wall_name(k),
            " was removed, perhaps before a checkpoint was saved; leave this change of it out, or "
            "add a new wall");
    return k;
  }
  /// Forces new lists and a check of the time step.
  void changed(std::size_t) {
    sim().engine_.lists.forget();
    sim().scene_changed_ = true, sim().checked_speed_ = 0;
  }
};

}  // namespace silt::inline SILT_TARGET::detail
