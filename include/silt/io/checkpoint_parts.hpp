// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint_archive.hpp>
#include <silt/io/scene_description.hpp>
#include <silt/simulation.hpp>

/// State of a simulation, component by component. Each visit() names numbers and columns, for
/// saving and loading, and gives the allowed values of single numbers. Consistency with each other
/// and with the scene is checked in io/checkpoint_checks.hpp.

namespace silt::inline SILT_TARGET::detail {

struct ClockState {
  double time = 0, step_length = 0, time_origin = 0;
  double checked_speed = 0, peak_overlap = 0;
  double largest_speed = 0, largest_overlap = 0, largest_share = 0;
  std::int64_t step = 0, step_origin = 0, flux_every = 1;
  std::uint64_t safeguards = 0;
  ParticleId next_id = 0, next_part = 0;
  bool first_kick = true, kicked = false, observed = false, scene_changed = false;

  template <class Archive>
  void visit(Archive& a) {
    a.number("clock.time", time, not_negative_number);
    a.number("clock.step_length", step_length, not_negative_number);
    a.number("clock.time_origin", time_origin, not_negative_number);
    a.number("clock.step", step, count_number);
    a.number("clock.step_origin", step_origin, count_number);
    a.number("clock.first_kick", first_kick, flag_number);
    a.number("clock.kicked", kicked, flag_number);
    a.number("clock.observed", observed, flag_number);
    a.number("clock.scene_changed", scene_changed, flag_number);
    a.number("next_id", next_id, count_number);
    a.number("next_part", next_part, count_number);
    a.number("guard.checked_speed", checked_speed, not_negative_number);
    a.number("guard.peak_overlap", peak_overlap, not_negative_number);
    a.number("guard.safeguards", safeguards, count_number);
    a.number("largest.speed", largest_speed, not_negative_number);
    a.number("largest.overlap", largest_overlap, not_negative_number);
    a.number("largest.share", largest_share, not_negative_number);
  }
  /// Where modules have fluxes.
  template <class Archive>
  void visit_fluxes(Archive& a) {
    a.number("modules.flux_every", flux_every, positive_number);
  }
};

template <class Archive, class Upkeep, class Reference>
void visit_upkeep(Archive& a, Upkeep& u, Reference& reference, std::size_t rows) {
  a.number("lists.searched_at", u.searched_at, count_or_never);
  a.number("lists.pruned_at", u.pruned_at, count_or_never);
  a.number("lists.used", u.used, not_negative_number);
  a.number("lists.outer_wall", u.outer_wall, finite_number);
  a.number("lists.inner_wall", u.inner_wall, finite_number);
  a.number("lists.outer_time", u.plan.outer_time, not_negative_number);
  a.number("lists.inner_time", u.plan.inner_time, not_negative_number);
  a.number("lists.least_outer", u.plan.least_outer, not_negative_number);
  a.number("lists.most_outer", u.plan.most_outer, not_negative_number);
  a.number("lists.least_inner", u.plan.least_inner, not_negative_number);
  a.number("lists.most_inner", u.plan.most_inner, not_negative_number);
  a.rows("lists.reference", reference, rows);
  rows = reference.size();
  a.rows("lists.outer_reach", u.outer, rows);
  a.rows("lists.inner_reach", u.inner, rows);
}

/// Columns of a table with `n` rows. When loading with n = any_count, the first column determines
/// the number.
template <class Archive, class Table>
void visit_columns(Archive& a, Table& table, std::size_t n) {
  for_each_column(table, [&](const auto& c, auto& values) {
    if constexpr (std::is_integral_v<typename std::remove_cvref_t<decltype(c)>::Value>)
      a.column(c.name.text(), values, n);
    else
      a.rows(c.name.text(), values, n);
    if constexpr (Archive::loads) n = values.size();
  });
}
template <class Archive, class State>
void visit_particles(Archive& a, State& p, std::size_t n) {
  visit_columns(a, p, n);
  a.number("largest.radius", p.largest_radius, not_negative_number);
  a.number("mean_diameter", p.mean_diameter, not_negative_number);
}

/// PairList: pairs of the outer list, which of them are in the inner list, and their history.
template <class Archive, class Pairs, class Memory>
void visit_pairs(Archive& a, Pairs& pairs, const Memory& memory) {
  a.number("pairs.grouped", pairs.grouped, count_number);
  bool has_ghosts = pairs.owned < pairs.grouped;
  if constexpr (Archive::loads) has_ghosts = a.has("pairs.owned");
  if (has_ghosts)
    a.number("pairs.owned", pairs.owned, count_number);
  else
    pairs.owned = pairs.grouped;
  if constexpr (Archive::loads) {
    const auto outer = a.template column<std::uint32_t>("pairs.outer");
    a.need(outer.size() % 2 == 0, "pairs.outer has ", outer.size(), " places, not two each");
    pairs.outer.resize(outer.size() / 2);
    for (std::size_t k = 0; k < pairs.outer.size(); ++k)
      pairs.outer[k] = {outer[2 * k], outer[2 * k + 1]};
    a.column("pairs.inner", pairs.origin, Archive::any_count);
  } else {
    DynArray<std::uint32_t> outer;
    outer.reserve(2 * pairs.outer.size());
    for (const auto [i, j] : pairs.outer) outer.push_back(i), outer.push_back(j);
    a.copied("pairs.outer", std::move(outer));
    a.column("pairs.inner", pairs.origin, 0);
  }
  for (std::size_t h = 0; h < pairs.history.size(); ++h)
    a.column(text("pairs.", memory.name_of(h)), pairs.history[h], pairs.origin.size());
}

template <class Archive, class Candidate>
void visit_candidates(Archive& a, const std::string& name, DynArray<Candidate>& all) {
  DynArray<std::uint32_t> flat;
  if constexpr (Archive::loads) {
    flat = a.template column<std::uint32_t>(name);
    a.need(flat.size() % 7 == 0, name, " has ", flat.size(), " numbers, not 7 each");
    constexpr std::uint32_t most = std::numeric_limits<std::uint16_t>::max();
    for (std::size_t k = 0; k < flat.size(); k += 7) {
      a.need(flat[k + 1] <= most && flat[k + 2] <= most, name, "[", k / 7, "] is at wall ",
             flat[k + 1], ", surface ", flat[k + 2], ", which cannot be");
      const auto wall = static_cast<std::uint16_t>(flat[k + 1]),
                 surface = static_cast<std::uint16_t>(flat[k + 2]);
      all.push_back({WallCandidate{flat[k], wall, surface, flat[k + 3], flat[k + 4], flat[k + 5],
                                   flat[k + 6]}});
    }
    if (!a.has(name + "_images")) return;
    const auto images = a.template column<std::int64_t>(name + "_images", all.size());
    for (std::size_t k = 0; k < all.size(); ++k)
      if constexpr (std::is_same_v<Candidate, ImageCandidate>)
        all[k].image = images[k];
      else
        a.need(images[k] == 0, name, "_images[", k, "] = ", images[k],
               ", which is not an image of a wall in this box");
  } else {
    flat.reserve(7 * all.size());
    for (const auto& c : all)
      flat.insert(flat.end(),
                  {c.particle, c.wall, c.surface, c.slot, c.facets, c.facet_count, c.origin});
    a.copied(name, std::move(flat));
    // In a periodic box, if there are any.
    DynArray<std::int64_t> images;
    for (const auto& c : all) images.push_back(image_of(c));
    if (std::any_of(images.begin(), images.end(), [](std::int64_t image) { return image != 0; }))
      a.copied(name + "_images", std::move(images));
  }
}

/// WallContacts. `rows`: slot by slot, the normal, then 1 if it touches.
template <class Archive, class Contacts, class Memory>
void visit_wall_contacts(Archive& a, Contacts& s, const Memory& memory) {
  visit_candidates(a, "walls.outer", s.outer), visit_candidates(a, "walls.inner", s.inner);
  constexpr std::size_t any = CheckpointLoader::any_count;
  a.column("walls.outer_facets", s.outer_facets, any);
  a.column("walls.inner_facets", s.inner_facets, any);
  a.column("walls.pieces", s.pieces, any);
  DynArray<double> slots;
  if constexpr (Archive::loads) {
    a.column("walls.slots", slots, any);
    a.need(slots.size() % 4 == 0, "walls.slots has ", slots.size(), " numbers, not 4 each");
    DynArray<std::uint32_t> features;
    a.column("walls.features", features, slots.size() / 4);
    for (std::size_t k = 0; k < slots.size(); k += 4) {
      a.need(flag_number.holds(slots[k + 3]), "walls.slots[", k + 3, "] = ", slots[k + 3], " ",
             flag_number.words);
      s.slots.push_back(
          {{slots[k], slots[k + 1], slots[k + 2]}, slots[k + 3] == 1, features[k / 4]});
    }
  } else {
    DynArray<std::uint32_t> features;
    slots.reserve(4 * s.slots.size()), features.reserve(s.slots.size());
    for (const auto& slot : s.slots) {
      const Vec3d& n = slot.normal;
      slots.insert(slots.end(), {n.x, n.y, n.z, slot.touching ? 1.0 : 0.0});
      features.push_back(slot.feature);
    }
    a.copied("walls.slots", std::move(slots)), a.copied("walls.features", std::move(features));
  }
  for (std::size_t h = 0; h < s.history.size(); ++h)
    a.column(text("walls.", memory.name_of(h)), s.history[h], s.slots.size());
}

/// Numbers in a contact history must fit the type that stores them.
template <class Engine, class History>
void check_memory(const CheckpointLoader& a, const char* of, const History& history) {
  for (std::size_t h = 0; h < history.size(); ++h)
    for (const double x : history[h])
      a.need(
          std::abs(x) <= static_cast<double>(std::numeric_limits<typename Engine::Scalar>::max()),
          of, Engine::memory.name_of(h), " has ", x, ", beyond what contacts can store");
}

/// Poses and loads of walls, and their poses when the lists were built.
struct WallsState {
  DynArray<std::uint64_t> surfaces;  // of each wall; 0: removed
  DynArray<std::uint64_t> drive;     // kind of its drive (WallDrive), 0: none
  DynArray<std::uint64_t> moves;     // 1: the lists treat it as moving
  DynArray<Pose> pose, last_pose;
  DynArray<Vec3d> force, torque, reference, impulse, angular_impulse, turned;
  DynArray<WallState> state;
  DynArray<std::uint64_t> deforming, deformed, vertices;  // vertices: number of vertex_steps
  DynArray<Vec3d> vertex_steps;
  DynArray<double> worn;                 // where modules wear walls
  DynArray<std::uint64_t> worn_numbers;  // of each wall
  std::array<DynArray<Pose>, 2> marks;   // at the search, at the pruning
  DynArray<Box> regions;                 // of both

  template <class Walls, class Lists>
  static WallsState of(const Walls& walls, const Lists& lists) {
    WallsState s;
    for (const auto& w : walls) {
      s.surfaces.push_back(w.surfaces.size());
      s.pose.push_back(w.pose), s.last_pose.push_back(w.last_pose);
      s.drive.push_back(w.drive.index()), s.moves.push_back(w.moves());
      s.force.push_back(w.force), s.torque.push_back(w.torque), s.impulse.push_back(w.impulse);
      s.reference.push_back(w.reference), s.angular_impulse.push_back(w.angular_impulse);
      s.turned.push_back(w.turned), s.state.push_back(w.state);
      s.deforming.push_back(static_cast<std::uint64_t>(w.deforming));
      s.deformed.push_back(w.deformed), s.vertices.push_back(w.vertex_steps.size());
      s.worn_numbers.push_back(w.worn.size());
      s.worn.insert(s.worn.end(), w.worn.begin(), w.worn.end());
      s.vertex_steps.insert(s.vertex_steps.end(), w.vertex_steps.begin(), w.vertex_steps.end());
    }
    for (const auto* mark : {&lists.searched_walls, &lists.pruned_walls}) {
      s.marks[s.regions.size()].assign(mark->poses().begin(), mark->poses().end());
      s.regions.push_back(mark->region());
    }
    return s;
  }
  template <class Archive>
  void visit(Archive& a, std::size_t walls) {
    a.column("walls.surfaces", surfaces, walls);
    a.rows("walls.pose", pose, walls), a.rows("walls.last_pose", last_pose, walls);
    a.rows("walls.force", force, walls), a.rows("walls.torque", torque, walls);
    a.rows("walls.impulse", impulse, walls), a.rows("walls.reference", reference, walls);
    a.rows("walls.angular_impulse", angular_impulse, walls), a.rows("walls.turned", turned, walls);
    a.column("walls.drive", drive, walls), a.column("walls.moves", moves, walls);
    a.rows("walls.state", state, walls);
    a.column("walls.deforming", deforming, walls), a.column("walls.deformed", deformed, walls);
    a.column("walls.vertices", vertices, walls);
    a.rows("walls.vertex_steps", vertex_steps,
           Archive::loads ? CheckpointLoader::any_count : vertex_steps.size());
    constexpr bool loads = Archive::loads;
    a.rows("walls.searched", marks[0], loads ? CheckpointLoader::any_count : marks[0].size());
    a.rows("walls.pruned", marks[1], loads ? CheckpointLoader::any_count : marks[1].size());
    a.rows("walls.regions", regions, 2);
  }
  /// Where modules wear walls.
  template <class Archive>
  void visit_wear(Archive& a, std::size_t walls) {
    a.column("walls.worn_numbers", worn_numbers, walls);
    a.column("walls.worn", worn, Archive::loads ? CheckpointLoader::any_count : worn.size(),
             not_negative_number);
  }
  /// Wear of each wall of a scene, which must match the scene; `modules`: number of those that
  /// wear.
  template <class Walls>
  DynArray<DynArray<double>> worn_of(const CheckpointLoader& a, const Walls& scene,
                                     std::size_t modules) const {
    DynArray<DynArray<double>> all(scene.size());
    std::size_t from = 0;
    for (std::size_t w = 0; w < worn_numbers.size(); ++w) {
      const std::size_t n = worn_numbers[w];
      a.need(n == 0 || surfaces[w] == 0 || n == facets_of(scene[w]) * modules,
             "walls.worn_numbers[", w, "] = ", n, " are not those of the facets of ",
             name_of_wall(scene, w));
      a.need(n <= worn.size() - from, "walls.worn has ", worn.size(), " numbers, too few");
      if (surfaces[w] > 0)
        all[w].assign(worn.begin() + static_cast<std::ptrdiff_t>(from),
                      worn.begin() + static_cast<std::ptrdiff_t>(from + n));
      from += n;
    }
    a.need(from == worn.size(), "walls.worn has ", worn.size(), " numbers, not ", from);
    return all;
  }
  /// Adds a wall of the scene that is not in the file.
  void add(const Wall& wall, double time) {
    const Pose at = wall.motion ? wall.pose_at(time) : wall.pose;
    surfaces.push_back(wall.surfaces.size());
    pose.push_back(at), last_pose.push_back(at);
    drive.push_back(wall.drive.index()), moves.push_back(wall.moves());
    force.push_back({0, 0, 0}), torque.push_back({0, 0, 0}), impulse.push_back({0, 0, 0});
    reference.push_back(wall.reference), angular_impulse.push_back({0, 0, 0});
    turned.push_back({0, 0, 0}), state.push_back(wall.state);
    deforming.push_back(static_cast<std::uint64_t>(wall.deforming));
    deformed.push_back(wall.deformed);
  }
};

struct OpeningsState {
  DynArray<std::uint64_t> out_count, placed, waiting, insertions, seed, counter;
  DynArray<double> out_mass, in_mass, start, interval, before;

  template <class Openings>
  static OpeningsState of(const Openings& openings) {
    OpeningsState s;
    for (const auto& o : openings.outlets())
      s.out_count.push_back(o.count), s.out_mass.push_back(o.mass);
    for (const auto& i : openings.inlets()) {
      s.placed.push_back(i.placed), s.waiting.push_back(i.waiting);
      s.insertions.push_back(i.insertions), s.in_mass.push_back(i.mass);
      s.seed.push_back(i.random.state().seed), s.counter.push_back(i.random.state().counter);
      s.start.push_back(i.start), s.interval.push_back(i.interval);
      s.before.push_back(i.before);
    }
    return s;
  }
  template <class Archive>
  void visit(Archive& a, std::size_t outlets, std::size_t inlets) {
    a.column("outlets.count", out_count, outlets);
    a.column("outlets.mass", out_mass, outlets, not_negative_number);
    a.column("inlets.placed", placed, inlets), a.column("inlets.waiting", waiting, inlets);
    a.column("inlets.insertions", insertions, inlets);
    a.column("inlets.mass", in_mass, inlets, not_negative_number);
    a.column("inlets.seed", seed, inlets), a.column("inlets.counter", counter, inlets);
    a.column("inlets.start", start, inlets, not_negative_number);
    a.column("inlets.interval", interval, inlets, not_negative_number);
    a.column("inlets.before", before, inlets, not_negative_number);
  }
  /// State from which inlets and outlets continue. `anew`: inlets begin at `time` [s], as if just
  /// added; `count_anew`: outlets count from 0.
  template <class Openings>
  void put(Openings& openings, bool anew, bool count_anew, double time) const noexcept {
    std::size_t k = 0;
    for (auto& o : openings.outlets())
      o.count = count_anew ? 0 : out_count[k], o.mass = count_anew ? 0 : out_mass[k], ++k;
    k = 0;
    if (anew) {
      for (auto& i : openings.inlets()) {
        i.start = time, i.interval = i.before = 0, i.placed = i.waiting = i.insertions = 0,
        i.mass = 0;
        i.random = Random(i.flow.seed);
      }
      return;
    }
    for (auto& i : openings.inlets()) {
      i.placed = placed[k], i.waiting = waiting[k], i.insertions = insertions[k];
      i.mass = in_mass[k];
      i.random = Random(Random::State{seed[k], counter[k]});
      i.start = start[k], i.interval = interval[k], i.before = before[k], ++k;
    }
  }
};

}  // namespace silt::detail
