// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/names.hpp>
#include <silt/core/vec3.hpp>
#include <silt/engine/checks/ended_contacts.hpp>
#include <silt/engine/population/arrivals.hpp>
#include <silt/fill/particles.hpp>
#include <silt/parallel/comm.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Changes of single particles, between runs and in observers; member functions of Simulation. None
/// of them forces a search in the next step: the lists stay valid. InputError: no such particle, or
/// an invalid value.
///
/// With several ranks a call acts on the rank that owns the particle and does nothing on others:
/// all ranks may make the call, or only the owner, as in a loop over its own rows. Other ranks are
/// informed when the observers of the step, or the calls before a run, have ended (share_edits); an
/// id that no rank has is then refused. Changed sizes, materials and forms, and removals, force a
/// search in the next step in this case. Tests: tests/parallel/edits.cpp, bonds_removed.cpp,
/// forms.cpp.
template <class Sim>
class ParticleEdits {
 public:
  /// Removes the particle with this id, and all its contacts at once. Its own energy is booked in
  /// the ledger's `openings`. The energy in its contacts is booked in `friction` (tangential
  /// springs) and `openings` (normal springs), to first order in the step; for bodies it stays in
  /// residual().
  void remove(ParticleId id) {
    const std::size_t k = place_of(id, "remove");
    if (is_elsewhere(k)) return;
    sim().book_leaving(k);
    if constexpr (Sim::has_ranks) note_rows(), sim().ranks_scene_.edits.removed.push_back(id);
    if constexpr (Sim::has_ledger && !Sim::of_bodies && !deforms<typename Sim::Domain>)
      if (!sim().first_kick_) {
        const auto row = static_cast<std::uint32_t>(k);
        const EndedContacts ended(sim().engine_, sim().domain_, std::span(&row, 1),
                                  sim().kicked_ ? 0 : sim().dt_, sim().dt_);
        sim().book_.removed(ended.work, ended.normal);
        if constexpr (Sim::has_ranks) note_ended(row);
      }
    sim().engine_.remove(k, sim().domain_, sim().dt_);
    if constexpr (Sim::has_ranks) sim().engine_.lists.forget();
  }
  /// Sets the velocity [m/s] of the particle with this id, at the present time.
  void set_velocity(ParticleId id, const Vec3d& velocity) {
    require(is_finite(velocity), "Simulation::set_velocity: ", velocity, " [m/s] must be finite");
    const std::size_t k = place_of(id, "set_velocity");
    if (is_elsewhere(k)) return;
    const auto before = sim().kinetic(k);
    const Vec3d change = velocity - sim().velocity(k);
    sim().engine_.change_velocity(k, change);
    if (sim().kicked_) sim().engine_.mover.synchronous[k].velocity = velocity;
    changed(k, before);
  }
  /// The same for its angular velocity [rad/s].
  void set_angular_velocity(ParticleId id, const Vec3d& velocity) {
    static_assert(Sim::rotates, "set_angular_velocity: no policy makes these particles rotate");
    require(is_finite(velocity), "Simulation::set_angular_velocity: ", velocity,
            " [rad/s] must be finite");
    const std::size_t k = place_of(id, "set_angular_velocity");
    if (is_elsewhere(k)) return;
    const auto before = sim().kinetic(k);
    const Vec3d change = velocity - sim().angular_velocity(k);
    sim().engine_.change_angular_velocity(k, change);
    if (sim().kicked_) sim().engine_.set_angular_velocity_now(k, velocity);
    changed(k, before);
  }
  /// Sets the radius [m] of the particle with this id; for a body, that of the bounding sphere, and
  /// the whole body is scaled. Density, position, velocity, angular velocity and the history of its
  /// contacts are kept. The change of its own energy is booked in the ledger's `openings`; the work
  /// of growth against its contacts (normal force times change of the radius) is not booked and
  /// stays in residual(). No contact is missed.
  void set_radius(ParticleId id, double radius) {
    require(std::isfinite(radius) && radius > 0, "Simulation::set_radius: radius = ", radius,
            " [m] must be finite and greater than 0");
    if constexpr (Sim::Domain::periodic)
      for (int d = 0; d < 3; ++d)
        if (sim().domain_.repeats(d) && sim().domain_.length(d) < 6 * radius)
          throw InputError(text(
              "Simulation::set_radius: the length ", sentence(sim().domain_.length(d)), " [m] of ",
              Sim::Domain::policy_name, " must be at least 3 diameters of particle ", id,
              " of radius ", radius, " m: ", sentence(6 * radius), " m"));
    const std::size_t k = place_of(id, "set_radius");
    if (is_elsewhere(k)) return;
    const double before = energy_of(k), smallest = sim().engine_.particles.smallest_radius;
    const double mass = sim().mass(k);
    sim().engine_.set_radius(k, radius, sim().domain_, sim().dt_);
    brought_in(k, before), feed_change(k, mass);
    if constexpr (Sim::has_ranks) note_rows(), sim().engine_.lists.forget();
    // Lighter particles have shorter contacts, which the guard and the next run check.
    sim().scene_changed_ = true, sim().scene_step_ = sim().step_;
    note_resized(id, "Simulation::set_radius");
    if (sim().engine_.particles.smallest_radius < smallest) sim().checked_speed_ = 0;
  }
  /// Sets the material of the particle with this id, by number or name; radius, mass and the
  /// history of its contacts are kept.
  void set_material(ParticleId id, const WhichMaterial& which) {
    static_assert(Sim::ContactsType::several_materials,
                  "set_material: particles are of several materials with Contacts<Law, "
                  "SeveralMaterials> alone");
    require(which.by_name() || which.number() < sim().contacts_.materials(),
            "Simulation::set_material: material ", which.number(), " is not in the table of ",
            sim().contacts_.materials(), " materials");
    const std::size_t material = sim().contacts_.material_number(which);
    const std::size_t k = place_of(id, "set_material");
    if (is_elsewhere(k)) return;
    if (material >= sim().engine_.coefficients.materials)
      sim().engine_.set_coefficients(sim().contacts_);
    sim().engine_.set_material(k, material);
    if constexpr (Sim::has_ranks) note_rows(), sim().engine_.lists.forget();
    sim().scene_changed_ = true, sim().checked_speed_ = 0;
  }
  /// Gives the body with this id another shape from forms(), by number or name; new forms are added
  /// with add() of particles that contain only forms. Centre of mass, orientation, radius of the
  /// bounding sphere, density, velocity, angular velocity, material and fields are kept; its
  /// contacts begin anew. The change of its own energy is booked in the ledger's `openings`; the
  /// energy of its contacts as in remove().
  void set_form(ParticleId id, const WhichForm& which) {
    static_assert(Sim::of_bodies, "set_form: spheres have no form; set_radius changes their size");
    require(which.by_name() || which.number() < sim().forms().size(), "Simulation::set_form: form ",
            which.number(), " is none of the ", sim().forms().size(), " forms of the simulation");
    const std::size_t form = sim().form_number(which);
    const std::size_t k = place_of(id, "set_form");
    if (is_elsewhere(k) || form == sim().form(k)) return;
    const double before = energy_of(k), mass = sim().mass(k);
    replace_body(k, form);
    const std::size_t now = sim().rows() - 1;
    if constexpr (Sim::has_ledger) sim().book_.bring_in(energy_of(now) - before);
    feed_change(now, mass);
    sim().scene_changed_ = true, sim().scene_step_ = sim().step_, sim().checked_speed_ = 0;
    note_resized(id, "Simulation::set_form");
  }

  /// With several ranks: informs all ranks of the changes that any of them has made to its
  /// particles, so that size() is updated and contacts of other ranks' particles with removed ones
  /// end (collective). It is called automatically after observers, before runs, and before a
  /// checkpoint is written.
  void share_edits() {
    if constexpr (Sim::has_ranks) share_edits("changes of particles", [] {});
  }

 protected:
  /// The same after work() of each rank.
  template <class Work>
  void share_edits(const char* call, const Work& work) {
    auto& s = sim();
    auto& e = s.engine_;
    auto& edits = s.ranks_scene_.edits;
    const auto any = e.ranks.together(call, work, [&] {
      const auto flag = [](bool is) { return is ? 1.0 : 0.0; };
      return std::array<double, 6>{flag(!edits.missed.empty()),  flag(edits.rows),
                                   flag(!edits.removed.empty()), flag(s.scene_changed_),
                                   flag(s.checked_speed_ == 0),  flag(!edits.reshaped.empty())};
    });
    if (any[3] > 0) s.scene_changed_ = true;
    if (any[4] > 0) s.checked_speed_ = 0;
    if (any[0] > 0) refuse_unknown(edits);
    if (any[2] > 0) remove_from_others(edits);
    if constexpr (Sim::of_bodies)
      if (any[5] > 0) reshape_on_others(edits);
    if (any[1] > 0) {
      e.particles.measure(), e.ranks.measure(e.particles);
      if (e.coefficients.materials < s.contacts_.materials()) e.set_coefficients(s.contacts_);
      e.lists.forget();
      s.scene_step_ = s.step_;
    }
    edits = {};
  }
  /// The function that changed the size of the particle with this id in step `now` or the one
  /// before, after which its contacts are checked; null if none.
  const char* resized_by(ParticleId id, std::int64_t now) const {
    if (now > resized_at_ + 1) return nullptr;
    const auto found = std::find_if(resized_.begin(), resized_.end(),
                                    [id](const auto& one) { return one.first == id; });
    return found == resized_.end() ? nullptr : found->second;
  }

 private:
  void note_resized(ParticleId id, const char* function) {
    if (resized_at_ != sim().step_) resized_.clear();
    resized_at_ = sim().step_, resized_.push_back({id, function});
  }
  DynArray<std::pair<ParticleId, const char*>> resized_;  // in step resized_at_
  std::int64_t resized_at_ = -2;
  /// [J] kinetic and potential energy as in the ledger; 0 without it.
  double energy_of([[maybe_unused]] std::size_t k) {
    if constexpr (Sim::has_ledger)
      if (!sim().first_kick_ && std::isfinite(sim().mass(k)))
        return sim().kinetic(k).sum() + sim().potential(k);
    return 0;
  }
  void brought_in([[maybe_unused]] std::size_t k, [[maybe_unused]] double before) {
    if constexpr (Sim::has_ledger) sim().book_.bring_in(energy_of(k) - before);
  }
  /// Books the growth of the mass of the particle at place k since it was `before` [kg] as fed.
  void feed_change([[maybe_unused]] std::size_t k, [[maybe_unused]] double before) {
    if constexpr (Sim::has_breakage)
      if (std::isfinite(before)) sim().breaks_.fed.add(sim().mass(k) - before);
  }
  /// Puts a body of another form, the last one of rows(), in the place of body k.
  void replace_body(std::size_t k, std::size_t form) {
    auto& e = sim().engine_;
    const Body old = e.mover.bodies[k];
    const double volume = e.mover.forms[old.form].mass.volume * old.scale * old.scale * old.scale;
    typename Sim::ParticlesType::Particle p{};
    p.form = form, p.position = old.centre, p.orientation = sim().orientation(k);
    p.radius = old.radius, p.density = old.inv_m > 0 ? 1 / (old.inv_m * volume) : 1;
    p.velocity = old.velocity, p.angular_velocity = old.angular_velocity(old.momentum);
    p.material = sim().material(k), p.fixed = old.inv_m == 0;

    const std::size_t behind = e.mover.bodies.size(), first_row = e.particles.size();
    NextIds ids{old.id, sim().next_.part};
    if constexpr (Sim::has_ranks) {
      ids.part = sim().ranks_scene_.edits.next_part;
      if (sim().kicked_) e.mover.synchronous.resize(behind);
    }
    take_in(e, std::span<const decltype(p)>(&p, 1), {}, sim().kicked_, ids);
    e.copy_columns(k, behind);
    if constexpr (Sim::has_ranks) {
      sim().ranks_scene_.edits.next_part = ids.part;
      sim().ranks_scene_.edits.reshaped.push_back(old.id), note_rows();
      e.remove(k, sim().domain_, sim().dt_);
      e.join_own(e.particles.size() - first_row);
    } else {
      sim().next_.part = ids.part;
      e.join_lists(sim().domain_, sim().dt_, first_row);
      e.remove(k, sim().domain_, sim().dt_);
    }
  }
  Sim& sim() { return static_cast<Sim&>(*this); }

  /// Whether it is not an owned particle of this rank.
  bool is_elsewhere([[maybe_unused]] std::size_t k) {
    if constexpr (Sim::has_ranks)
      return k >= sim().rows();
    else
      return false;
  }
  void note_rows() {
    if constexpr (Sim::has_ranks) sim().ranks_scene_.edits.rows = true;
  }
  /// The contacts of an owned sphere that is being removed with particles of other ranks.
  template <class Row>
  void note_ended(Row row) {
    auto& s = sim();
    const auto& e = s.engine_;
    const auto& pairs = e.lists.pairs;
    using Ended = EndedContacts<typename Sim::Engine, typename Sim::Domain>;
    pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = pairs.first()[k], b = pairs.second()[k], other = a == row ? b : a;
      if ((a != row && b != row) || other < e.particles.owned()) return;
      const Ended one(e, s.domain_, typename Ended::OfPair{k}, s.kicked_ ? 0 : s.dt_, s.dt_);
      s.ranks_scene_.edits.ended.push_back(
          {e.particles.id[row], e.particles.id[other], one.work, one.normal});
    });
  }
  /// Collective: all ids given by the ranks, sorted.
  DynArray<ParticleId> all_of(const DynArray<ParticleId>& own) {
    auto all = gather(sim().engine_.ranks.comm(), std::span<const ParticleId>(own)).values;
    std::sort(all.begin(), all.end());
    return all;
  }
  /// Collective: refuses ids that no rank has.
  template <class Edits>
  void refuse_unknown(Edits& edits) {
    const auto found = all_of(edits.found);
    const auto missed = std::exchange(edits.missed, {});
    edits.found.clear();
    sim().engine_.ranks.together("changes of particles by their ids", [&] {
      for (const auto& [id, function] : missed)
        require(std::binary_search(found.begin(), found.end(), id), "Simulation::", function,
                ": there is no particle ", id,
                " on any rank; it has left, or never was (Simulation::find tells its own rank)");
    });
  }
  /// Collective: removes the ghosts of removed particles. A contact between two particles that two
  /// ranks have removed is booked by the rank of the lower id.
  template <class Edits>
  void remove_from_others(const Edits& edits) {
    auto& e = sim().engine_;
    const auto gone = all_of(edits.removed);
    if constexpr (Sim::has_ledger)
      for (const auto& c : edits.ended)
        if (c.own < c.other || !std::binary_search(gone.begin(), gone.end(), c.other))
          sim().book_.removed(c.work, c.normal);
    const auto is_gone = [&](ParticleId id) {
      return std::binary_search(gone.begin(), gone.end(), id);
    };
    e.park_ghosts(is_gone);
    if constexpr (Sim::has_bonds) sim().bonds_.leave(e, is_gone);
  }
  /// Collective: ends the contacts of the ghosts of bodies that have another form; the next search
  /// brings them anew. The new parts get ids that no other part has: those of the body with the
  /// lowest id first, whatever the number of ranks.
  template <class Edits>
  void reshape_on_others(Edits& edits) {
    struct Reshaped {
      ParticleId id;
      std::size_t parts;
    };
    auto& e = sim().engine_;
    std::sort(edits.reshaped.begin(), edits.reshaped.end());
    edits.reshaped.erase(std::unique(edits.reshaped.begin(), edits.reshaped.end()),
                         edits.reshaped.end());
    const auto rows_of = [&](ParticleId id) {
      const std::size_t k = e.find(id);  // it may have been removed since
      return k < e.owners() ? e.mover.rows_of(e.mover.bodies[k]) : std::span<const std::uint32_t>();
    };
    DynArray<Reshaped> own;
    for (const ParticleId id : edits.reshaped) own.push_back({id, rows_of(id).size()});
    auto all = gather(e.ranks.comm(), std::span<const Reshaped>(own)).values;
    const auto is_lower = [](const Reshaped& a, const Reshaped& b) { return a.id < b.id; };
    std::sort(all.begin(), all.end(), is_lower);
    for (const Reshaped& one : all) {
      for (const std::uint32_t row : rows_of(one.id))
        e.particles.id[row] = sim().next_.part + e.particles.part[row].local;
      sim().next_.part += one.parts;
      note_resized(one.id, "Simulation::set_form");
    }
    e.park_ghosts([&](ParticleId id) {
      return std::binary_search(all.begin(), all.end(), Reshaped{id, 0}, is_lower);
    });
  }

  std::size_t place_of(ParticleId id, const char* function) {
    require(
        id != no_particle, "Simulation::", function,
        ": the id is silt::no_particle, which is that of places whose particle has left, and in "
        "a ContactEvent stands for a wall");
    const std::size_t k = sim().find(id);
    if constexpr (Sim::has_ranks) {
      auto& edits = sim().ranks_scene_.edits;
      if (k < sim().rows())
        edits.found.push_back(id);
      else
        edits.missed.push_back({id, function});
      return k;
    }
    require(k < sim().rows(), "Simulation::", function, ": there is no particle ", id,
            "; it has left, or never was (Simulation::find tells)");
    return k;
  }
  template <class Kinetic>
  void changed(std::size_t k, const Kinetic& before) {
    sim().engine_.follow_change(k);
    if constexpr (Sim::has_ledger)
      if (!sim().first_kick_ && std::isfinite(sim().mass(k)))
        sim().book_.bring_in(sim().kinetic(k).sum() - before.sum());
  }
};

}  // namespace silt::detail
