// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/parallel/agreed.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Data on a failed run: the particles named by the error, their contacts, and their surroundings.
template <class Sim>
class FailureScene {
 public:
  enum Role : std::uint32_t { Near = 0, Touching = 1, Named = 2 };

  /// `back` [s]: time by which positions are ahead of the forces.
  FailureScene(const Sim& sim, const SimulationError& error, double back)
      : sim_(sim), role_(sim.rows(), Near) {
    DynArray<ParticleId> ids(error.particles.begin(), error.particles.end());
    if (ids.empty()) ids = fastest();
    for (const ParticleId id : ids)
      if (const std::size_t k = sim.find(id); k < sim.rows()) role_[k] = Named, named_.push_back(k);
    find_contacts(back);
    find_near(error.position);
  }

  void write_particles_csv(const std::string& path) const {
    DynArray<DynArray<double>> rows;
    for (const Role wanted : {Named, Touching})
      for (std::size_t k = 0; k < sim_.rows(); ++k) {
        if (!sim_.is_present(k) || role_[k] != wanted) continue;
        const Vec3d x = sim_.position(k), v = sim_.velocity(k);
        Vec3d w{0, 0, 0};
        if constexpr (Sim::rotates) w = sim_.angular_velocity(k);
        rows.push_back({static_cast<double>(sim_.id(k)), wanted == Named ? 1.0 : 0.0, x.x, x.y, x.z,
                        v.x, v.y, v.z, w.x, w.y, w.z, sim_.radius(k), sim_.mass(k),
                        static_cast<double>(sim_.material(k))});
      }
    write_csv(path,
              {"id", "named by the error", "x [m]", "y [m]", "z [m]", "velocity x [m/s]",
               "velocity y [m/s]", "velocity z [m/s]", "angular velocity x [rad/s]",
               "angular velocity y [rad/s]", "angular velocity z [rad/s]", "radius [m]",
               "mass [kg]", "material"},
              rows);
  }
  void write_contacts_csv(const std::string& path) const {
    write_csv(path,
              {"id", "other id (-1: a wall)", "wall (-1: none)",
               "overlap [-] of the smaller radius", "approach [m/s]", "x [m]", "y [m]", "z [m]"},
              contacts_);
  }
  /// Writes particles near those named, or only these and their contact partners, for ParaView and
  /// `silt draw --colour role`. Role 2: named by the error, 1: in contact with those, 0: others.
  void write_particles_vtp(const std::string& path, bool others) const {
    DynArray<std::size_t> shown;
    for (const std::size_t k : near_)
      if (others || role_[k] != Near) shown.push_back(k);
    if constexpr (Sim::has_surfaces)
      write_bodies(path, shown);
    else
      write_spheres(path, shown);
  }
  void write_walls(const std::string& path) const {
    silt::write_walls(path, wall_triangles(sim_, around_));
  }
  bool has_walls() const { return sim_.walls() > 0 && around_.min.x <= around_.max.x; }
  std::size_t contacts() const { return contacts_.size(); }
  bool has_named() const { return !named_.empty(); }
  /// Whether the whole state is finite, and a checkpoint of it can be loaded.
  bool is_finite() const {
    for (std::size_t k = 0; k < sim_.rows(); ++k)
      if (sim_.is_present(k) &&
          !(silt::is_finite(sim_.position(k)) && silt::is_finite(sim_.velocity(k))))
        return false;
    return true;
  }

 private:
  /// If the error names no particle, the fastest are shown.
  DynArray<ParticleId> fastest() const {
    ParticleId who = no_particle;
    double most = -1;
    for (std::size_t k = 0; k < sim_.rows(); ++k)
      if (sim_.is_present(k) && norm(sim_.velocity(k)) > most)
        most = norm(sim_.velocity(k)), who = sim_.id(k);
    return who == no_particle ? DynArray<ParticleId>{} : DynArray<ParticleId>{who};
  }
  void find_contacts(double back) {
    const auto& e = sim_.engine();
    if (e.lists.upkeep.searched_at < 0) return;  // before the first search no contacts are known
    for_each_overlap(
        e, sim_.domain(), back,
        [&](std::uint32_t a, std::uint32_t b, std::size_t wall, bool with_wall, double overlap) {
          const std::size_t i = e.owner_of(a), j = with_wall ? i : e.owner_of(b);
          const auto is_named = [&](std::size_t k) {
            return k < role_.size() && role_[k] == Named;
          };
          if (!(overlap > 0) || !(is_named(i) || is_named(j))) return;
          for (const std::size_t k : {i, j})  // without those of other ranks
            if (k < role_.size() && role_[k] != Named) role_[k] = Touching;
          const auto velocity = [&](std::size_t k) {
            return k < role_.size() ? sim_.velocity(k) : e.owner(k).velocity();
          };
          const Vec3d x = e.owner(i).centre(), y = with_wall ? x : e.owner(j).centre();
          Vec3d apart = x - y;
          if constexpr (Sim::Domain::periodic) apart = sim_.domain().shortest(apart);
          const double far = norm(apart);
          const Vec3d v = velocity(i) - velocity(j);
          const double approach =
              with_wall || !(far > 0) ? norm(velocity(i)) : -dot(v, apart) / far;
          const Vec3d middle = with_wall ? x : x - 0.5 * apart;
          contacts_.push_back({static_cast<double>(e.owner(i).id()),
                               with_wall ? -1 : static_cast<double>(e.owner(j).id()),
                               with_wall ? static_cast<double>(wall) : -1, overlap, approach,
                               middle.x, middle.y, middle.z});
        });
    std::sort(contacts_.begin(), contacts_.end(),
              [](const auto& a, const auto& b) { return a[3] > b[3]; });
  }
  void find_near(const Vec3d& where) {
    double largest = 0;
    for (std::size_t k = 0; k < sim_.rows(); ++k)
      if (sim_.is_present(k)) largest = std::max(largest, sim_.radius(k));
    Box box;
    for (const std::size_t k : named_)
      if (silt::is_finite(sim_.position(k))) box.include(sim_.position(k));
    if (!(box.min.x <= box.max.x) && silt::is_finite(where)) box.include(where);
    if (!(box.min.x <= box.max.x)) return;
    around_ = box.grown(reach * largest);
    for (std::size_t k = 0; k < sim_.rows(); ++k)
      if (sim_.is_present(k) && silt::is_finite(sim_.position(k)) &&
          (role_[k] != Near || around_.contains(sim_.position(k))) && near_.size() < most_near)
        near_.push_back(k);
  }
  void write_spheres(const std::string& path, const DynArray<std::size_t>& shown) const {
    DynArray<Vec3d> place;
    DynArray<float> radius;
    DynArray<ParticleId> id;
    DynArray<std::uint32_t> role;
    DynArray<std::array<float, 3>> velocity;
    const auto& e = sim_.engine();
    DynArray<char> wanted(sim_.rows(), 0);
    for (const std::size_t k : shown) wanted[k] = 1;
    for (std::size_t row = 0; row < e.particles.owned(); ++row) {
      if (e.particles.is_parked(row) || !wanted[e.owner_of(row)]) continue;
      const std::size_t k = e.owner_of(row);
      const Vec3d v = sim_.velocity(k);
      place.push_back(e.particles.position[row].centre());
      radius.push_back(static_cast<float>(e.particles.position[row].r));
      id.push_back(sim_.id(k)), role.push_back(role_[k]);
      velocity.push_back(
          {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
    }
    VtkFields fields;
    fields.add("radius", radius).add("id", id).add("role", role).add("velocity", velocity);
    write_vtp_points(path, place, fields);
  }
  void write_bodies(const std::string& path, const DynArray<std::size_t>& shown) const
      requires(Sim::has_surfaces) {
    SurfaceMesh all;
    DynArray<ParticleId> id;
    DynArray<std::uint32_t> role;
    for (const std::size_t k : shown) {
      const SurfaceMesh mesh = surface_of(sim_.forms()[sim_.form(k)].shape);
      const auto first = static_cast<std::uint32_t>(all.points.size());
      const Vec3d centroid = sim_.forms()[sim_.form(k)].mass.centroid;
      for (const Vec3d& p : mesh.points)
        all.points.push_back(sim_.position(k) +
                             rotate(sim_.orientation(k), sim_.scale(k) * (p - centroid)));
      for (const auto& t : mesh.triangles)
        all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      id.insert(id.end(), mesh.points.size(), sim_.id(k));
      role.insert(role.end(), mesh.points.size(), role_[k]);
    }
    VtkFields fields;
    fields.add("id", id).add("role", role);
    write_vtp_triangles(path, all.points, all.triangles, fields);
  }

  static constexpr double reach = 8;              // [-] in largest radii
  static constexpr std::size_t most_near = 2000;  // limit of particles in the picture

  const Sim& sim_;
  DynArray<Role> role_;
  DynArray<std::size_t> named_, near_;
  DynArray<std::array<double, 8>> contacts_;
  Box around_;
};

/// Names of walls, materials and forms by the numbers that the files contain, one per line.
template <class Sim>
std::string lines_of_names(const Sim& sim) {
  std::string lines;
  const auto add = [&](const std::string& words, std::string_view name) {
    if (!name.empty()) lines += words + '\n';
  };
  for (std::size_t w = 0; w < sim.walls(); ++w) add(sim.wall_name(w), sim.wall(w).name);
  for (std::size_t k = 0; k < sim.contacts().materials(); ++k)
    add(sim.material_name(k), sim.contacts().given_name(k));
  if constexpr (Sim::of_bodies)
    for (std::size_t f = 0; f < sim.forms().size(); ++f) add(sim.form_name(f), sim.forms()[f].name);
  return lines;
}

}  // namespace detail

/// Keeps the data needed to analyse a failed run. When the run stops with a SimulationError,
/// `folder` contains
///
///   failure.txt      message of the error, step, time and particles, and the names of walls,
///                    materials and forms, which the other files give by number
///   last_good.silt   checkpoint of the last state that was kept: the start of the run, or the last
///                    time of the schedule; a run from it fails again
///   at_failure.silt  checkpoint of the state at the failure, for inspection; not if that state has
///                    numbers that are not finite
///   particles.csv    particles named by the error (the fastest, if it names none), and those in
///                    contact with them
///   contacts.csv     contacts of those named, deepest first
///   touching.vtp     those named and those in contact with them, with `role`: 2 named, 1 touching;
///                    for ParaView, or `silt draw touching.vtp --colour role`
///   around.vtp       the same with all surrounding particles, role 0
///   walls.vtp        the walls around
///
/// and the error is thrown again with a sentence that names these files. Each file is complete or
/// absent. A file that cannot be written is named in that sentence, and the original error is kept.
/// On several ranks the checkpoints contain all particles, and rank 0 writes failure.txt. Each rank
/// with particles that the error names writes the other files for its part: particles_r2.csv.
///
///   sim.run(1.0, silt::on_failure("failed", silt::every(0.1)));
///
/// Cost:   one checkpoint at the start of the first run and at each time of the schedule.
/// Errors: FileError if the checkpoint of the start cannot be written.
/// Tests:  tests/io/failure.cpp.
class OnFailure {
 public:
  static constexpr bool only_reads = true, saves = true;  // as checkpoints(): see observing.hpp

  OnFailure(std::string folder, std::optional<Schedule> keep)
      : folder_(std::move(folder)), keep_(std::move(keep)) {}

  template <class Sim>
  void begin(const Sim& sim, double) {
    if (keep_) keep_->begin(sim, true);
    if (!good_) keep_state(sim);
  }
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return keep_ && keep_->is_due(sim);
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    keep_state(sim);
    keep_->mark(sim);
  }
  /// Writes all files of a failure; returns the sentence to append to the error.
  template <class Sim>
  std::string failed(const Sim& sim, const SimulationError& error, double back) noexcept {
    try {
      return write_all(sim, error, back);
    } catch (...) {
      return text(" (on_failure could not write to ", in_quotes(folder_), ")");
    }
  }

 private:
  struct State {
    double time;  // [s]
    std::int64_t step;
  };

  template <class Sim>
  void keep_state(const Sim& sim) {
    detail::on_all_ranks(sim, "the folder of on_failure", [&] { make_folder(folder_); });
    save_checkpoint(sim, folder_ + "/last_good.silt");
    good_ = State{sim.time(), sim.step()};
  }
  template <class Sim>
  std::string write_all(const Sim& sim, const SimulationError& error, double back) {
    std::string written, lacking;
    const auto attempt = [&](const char* name, const auto& write) {
      try {
        write(text(folder_, '/', name));
        const bool is_of_all = std::string_view(name) == "at_failure.silt";
        if (!is_of_all || sim.rank() == 0) written += text(written.empty() ? "" : ", ", name);
      } catch (const std::exception& e) {
        if (!detail::is_agreed() || sim.rank() == 0)
          lacking += text("; ", name, " could not be written: ", e.what());
      }
    };
    try {
      make_folder(folder_);
    } catch (const std::exception& e) {
      return text(" (on_failure could not write: ", e.what(), ")");
    }
    std::optional<detail::FailureScene<Sim>> seen;
    detail::on_all_ranks(sim, "a look at a failure", [&] { seen.emplace(sim, error, back); });
    const auto& scene = *seen;
    const std::string of_rank = sim.ranks() > 1 ? text("_r", sim.rank()) : "";
    const bool shows = sim.ranks() == 1 || scene.has_named();
    const auto attempt_own = [&](const std::string& name, const auto& write) {
      if (shows) attempt(detail::before_ending(name, of_rank).c_str(), write);
    };
    if (sim.rank() == 0)
      attempt("failure.txt", [&](const std::string& path) {
        AtomicFile out(path);
        out.write(text(error.what(), "\nstep ", error.step, "\ntime [s] ", sim.time(),
                       "\nparticles named:"));
        for (const auto id : error.particles) out.write(text(' ', id));
        out.write(text("\n", detail::lines_of_names(sim)));
        out.commit();
      });
    attempt_own("particles.csv", [&](const auto& path) { scene.write_particles_csv(path); });
    attempt_own("contacts.csv", [&](const auto& path) { scene.write_contacts_csv(path); });
    attempt_own("touching.vtp", [&](const auto& path) { scene.write_particles_vtp(path, false); });
    attempt_own("around.vtp", [&](const auto& path) { scene.write_particles_vtp(path, true); });
    if (scene.has_walls())
      attempt_own("walls.vtp", [&](const auto& path) { scene.write_walls(path); });
    const bool finite = sim.largest_over_ranks(scene.is_finite() ? 0 : 1) == 0;
    if (finite) attempt("at_failure.silt", [&](const auto& path) { save_checkpoint(sim, path); });
    if constexpr (Sim::has_ranks) {
      written = detail::words_of_ranks(sim, written, ", ");
      lacking = detail::words_of_ranks(sim, lacking, "");
    }
    std::string words = text(" (on_failure wrote to ", in_quotes(folder_), ": ", written);
    if (good_)
      words += text("; last_good.silt is the state at step ", good_->step, ", t = ", good_->time,
                    " s, before the failure");
    words += finite ? "; at_failure.silt is the state at the failure"
                    : "; the state at the failure is not finite, and was not written";
    return words + lacking + ')';
  }

  std::string folder_;
  std::optional<Schedule> keep_;
  std::optional<State> good_;
};

inline OnFailure on_failure(std::string folder) { return {std::move(folder), std::nullopt}; }
inline OnFailure on_failure(std::string folder, Schedule keep) { return {std::move(folder), keep}; }

}  // namespace silt
