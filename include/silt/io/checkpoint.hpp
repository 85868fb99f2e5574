// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/checkpoint_file.hpp>
#include <silt/io/checkpoint_bonds.hpp>
#include <silt/io/checkpoint_breaks.hpp>
#include <silt/io/checkpoint_cells.hpp>
#include <silt/io/checkpoint_checks.hpp>
#include <silt/io/checkpoint_ranks.hpp>
#include <silt/io/checkpoint_wall_heat.hpp>
#include <silt/io/describe_scene.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Saves and restores the complete state of a simulation: particles, contact history, lists, walls,
/// inlets and outlets, fluid, clock. A run continued from a checkpoint gives the same bits as an
/// uninterrupted run.
///
///   silt::save_checkpoint(sim, "run.silt");
///   silt::load_checkpoint(sim, "run.silt");    // sim: the same scene, built by the same program
///
/// On many ranks both functions are collective, and the file is an index with a folder of blocks
/// beside it (io/checkpoint_ranks.hpp). The same number of ranks continues with the same bits.
/// Another number, or a program without Ranks, continues with the same particles and contact
/// history. Many ranks can likewise start from the file of one process.
///
/// Walls, materials, limits and gravity come from the program; the state replaces all particles.
/// The file contains a description of the scene that wrote it (io/describe_scene.hpp). A difference
/// between the two scenes is named, and refused unless it is one of AcceptedChanges. The file is
/// read and every number checked before the simulation changes.
/// Errors: FileError for a file that is damaged, cannot be read or written, or was written by
///         another program (other policies); InputError for a file of another scene. The simulation
///         is then unchanged.
/// Tests:  tests/io/checkpoint.cpp, checkpoint_scene.cpp, fuzz_checkpoint.cpp.
template <class Sim>
class Checkpoint {
  using Engine = typename Sim::Engine;
  static constexpr bool chooses_search = requires(typename Sim::Search s) {
    detail::finder_of(s).choice();
  };

 private:
  class Staged;  // io/checkpoint_staged.hpp
  class Merged;  // io/checkpoint_merged.hpp

 public:
  static void save(const Sim& sim, const std::string& path) {
    if constexpr (Sim::has_ranks)  // then all ranks know what users have changed
      const_cast<Sim&>(sim).share_edits(), save_blocks(sim, path);
    else
      make_folder_of(path), write(sim, path);
  }

  static void load(Sim& sim, const std::string& path, const AcceptedChanges& accepted = {}) {
    std::unique_ptr<Staged> staged;
    detail::on_all_ranks(sim, "load_checkpoint", [&] {
      try {
        staged = read(sim, path, accepted);
      } catch (const std::bad_alloc&) {
        throw FileError(text("checkpoint '", path, "' exceeds the memory"));
      }
    });
    staged->put_into(sim, accepted);
    if constexpr (Sim::FluidIs::pushes_walls) sim.prepare_fluid();  // a liquid knows walls by it
  }

  /// Programs that can continue from the file: the policies that determine the state and the
  /// contact history.
  static std::string signature() {
    return text("silt state 29; particles ", name_of<typename Sim::ShapeType>(), "; contacts ",
                name_of<typename Sim::ContactsType>(), "; search ", name_of<typename Sim::Search>(),
                "; domain ", name_of<typename Sim::Domain>(), "; precision ",
                name_of<typename Sim::Precision>(), Sim::has_ledger ? "; ledger" : "",
                Sim::has_events ? "; events" : "",
                Sim::has_bonds ? text("; bonds ", name_of<typename Sim::Composition::Bonds>()) : "",
                Sim::Fluid::active ? text("; fluid ", name_of<typename Sim::Fluid>()) : "",
                "; integrator ", name_of<typename Sim::Integrator>(),
                Sim::of_bodies ? text("; rotation ", name_of<typename Sim::Rotation>()) : "",
                Sim::Modules::exist ? text("; modules ", module_names()) : "", "; contacts keep ",
                Engine::memory.words());
  }

 private:
  /// State of a process, or of a rank.
  static detail::CheckpointStamp write(const Sim& sim, const std::string& path) {
    const Engine& e = sim.engine_;
    CheckpointWriter out(signature());
    detail::CheckpointSaver a(out);
    DynArray<bool> removed;
    for (const auto& w : e.walls) removed.push_back(w.surfaces.empty());
    const auto coefficients = Engine::coefficients_of(sim.contacts_);
    auto scene = detail::describe_scene(sim, coefficients, sim.openings_, removed, removed.size());
    describe_bonds(sim, scene), describe_breaks(sim, scene);
    out.add_text("scene", scene.written());
    auto clock = clock_of(sim);
    clock.visit(a);
    if constexpr (Sim::Modules::flux) clock.visit_fluxes(a);
    auto walls = detail::WallsState::of(e.walls, e.lists);
    walls.visit(a, e.walls.size());
    if constexpr (Sim::Modules::wear) walls.visit_wear(a, e.walls.size());
    auto openings = detail::OpeningsState::of(sim.openings_);
    openings.visit(a, openings.out_count.size(), openings.placed.size());

    detail::visit_particles(a, e.particles, e.particles.size());
    [[maybe_unused]] detail::BlockState block;
    if constexpr (Sim::has_ranks) block = detail::BlockState::of_engine(e), block.visit(a);
    [[maybe_unused]] CellsState cells;
    if constexpr (has_cells)
      cells = CellsState::of(std::span<const Form>(e.mover.forms).last(e.mover.cells)),
      cells.visit(a);
    [[maybe_unused]] BondsState bonds;
    if constexpr (Sim::has_bonds) {
      sim.need_no_fresh_bonds("save_checkpoint");
      sim.bonds_.follow(e);
      bonds = BondsState::of(sim.bonds_, e.particles.bonds), bonds.visit(a);
    }
    [[maybe_unused]] BreaksState breaks;
    if constexpr (Sim::has_breakage) breaks = BreaksState::of(sim.breaks_), breaks.visit(a);
    if constexpr (Sim::of_bodies) a.rows("bodies", e.mover.bodies, e.mover.bodies.size());
    a.rows("synchronous", e.mover.synchronous, sim.kicked_ ? e.owners() : 0);
    detail::visit_upkeep(a, e.lists.upkeep, e.lists.reference, e.lists.reference.size());
    auto pairs = e.lists.pairs.state();
    detail::visit_pairs(a, pairs, Engine::memory);
    auto contacts = e.lists.walls.state();
    detail::visit_wall_contacts(a, contacts, Engine::memory);

    DynArray<double> books;
    if constexpr (Sim::has_ledger) {
      books = sim.book_.state();
      books.insert(books.end(),
                   {sim.gravity_booked_.x, sim.gravity_booked_.y, sim.gravity_booked_.z});
      a.column("ledger", books, books.size());
    }
    DynArray<double> box;
    if constexpr (detail::deforms<typename Sim::Domain>) {
      box = sim.domain_.state();
      e.lists.flow.put_state(box);
      a.column("box", box, box.size());
    }
    std::size_t owners = e.particles.size();  // with ghosts
    if constexpr (Sim::of_bodies) owners = e.mover.bodies.size();
    detail::visit_columns(a, e.modules(), owners);
    if constexpr (Sim::Modules::flux) a.copied("modules.from_walls", e.fluxes().wall_books());
    detail::with_wall_heat(sim.modules_.modules, [&](const auto& module) {
      detail::save_wall_heat(a, module.walls, sim.time_);
    });
    if constexpr (Sim::Fluid::active) {
      detail::visit_columns(a, e.fluid_loads(), e.owners());
      if (const Vec3d& left = e.fluid_loads().left; Sim::follows_fluid)
        a.copied("fluid.taken_by_left", DynArray{left.x, left.y, left.z});
      // visit() takes its arguments as mutable; saving does not change them.
      const_cast<typename Sim::Fluid&>(sim.fluid_)
          .for_each_state([&](const std::string& name, const auto& values) {
            a.copied(name, DynArray<double>(values.begin(), values.end()));
          });
    }
    DynArray<std::uint64_t> search;
    if constexpr (chooses_search) {
      const auto& choice = detail::finder_of(sim.search_).choice();
      search = {choice.finder, choice.spheres};
      a.column("search.choice", search, 2);
    }
    return out.commit(path);
  }

  /// Collective.
  static void save_blocks(const Sim& sim, const std::string& path) requires(Sim::has_ranks) {
    const auto& ranks = sim.engine_.ranks;
    const auto rank = static_cast<std::size_t>(ranks.rank());
    detail::CheckpointIndex index;
    detail::on_all_ranks(sim, "save_checkpoint", [&] {
      if (rank > 0) return;
      make_folder(index.folder(path));
      index.blocks = index.new_blocks(path, sim.step_);
    });
    const auto name = ranks.comm().gather_bytes(std::as_bytes(std::span(index.blocks)));
    index.blocks.assign(reinterpret_cast<const char*>(name.values.data()), name.values.size());
    detail::CheckpointStamp own;
    detail::on_all_ranks(sim, "blocks of a checkpoint",
                         [&] { own = write(sim, index.block(path, rank)); });
    struct Block {
      std::uint64_t bytes, sum, owned, safeguards;
    };
    const auto blocks = gather_each(
        ranks.comm(), Block{own.bytes, own.sum, sim.engine_.present(), sim.engine_.safeguards});
    detail::on_all_ranks(sim, "the index of a checkpoint", [&] {
      if (rank > 0) return;
      for (const Block& b : blocks) {
        index.bytes.push_back(b.bytes), index.sums.push_back(b.sum);
        index.owned.push_back(b.owned), index.safeguards.push_back(b.safeguards);
        index.present += b.owned;
      }
      index.step = sim.step_;
      index.write(path, signature());
      index.remove_others(path);
    });
  }

  static std::unique_ptr<Staged> read(const Sim& sim, const std::string& path,
                                      const AcceptedChanges& accepted) {
    const auto read_whole = [&](const CheckpointReader& in, const std::string& name) {
      auto staged = std::make_unique<Staged>(sim);
      staged->read(detail::CheckpointLoader(in, name), name, accepted);
      return staged;
    };
    const CheckpointReader in(path);
    in.require_signature(signature());
    const bool is_index = in.has(detail::CheckpointIndex::mark);
    if (!is_index && !Sim::has_ranks) return read_whole(in, path);
    detail::CheckpointIndex index;
    if (is_index) index = detail::CheckpointIndex::read(in);
    const auto ranks = static_cast<std::size_t>(sim.ranks());
    const auto rank = static_cast<std::size_t>(sim.rank());
    if (Sim::has_ranks && is_index && index.size() == ranks)
      return read_whole(index.open(path, rank), index.block(path, rank));

    if constexpr (has_rows_alone) {
      Merged merged(sim, accepted);
      if (!is_index) {
        const std::size_t all = merged.count(in, path);
        merged.take(in, path, all * rank / ranks, all * (rank + 1) / ranks);
        return merged.finish(path, all, merged.safeguards());
      }
      const std::size_t all = index.present;
      const std::size_t from = all * rank / ranks, to = all * (rank + 1) / ranks;
      std::size_t before = 0;
      for (std::size_t b = 0; b < index.size(); before += index.owned[b], ++b) {
        const std::size_t first = std::max(from, before),
                          end = std::min(to, before + index.owned[b]);
        if (first >= end && b > 0) {  // the first one describes the scene
          if (rank == 0) merged.take_books(index.open(path, b), index.block(path, b));
          continue;
        }
        merged.take(index.open(path, b), index.block(path, b), first - before,
                    std::max(first, end) - before);
      }
      return merged.finish(path, all, index.safeguards_of_all());
    } else {
      throw InputError(text(
          "checkpoint '", path, "' is of ", is_index ? index.size() : 1,
          " ranks, and this run has ", ranks,
          ": a scene with breakage or a fluid continues only on the same number of ranks; start as "
          "many"));
    }
  }

  template <class T>
  static std::string name_of() {
    std::string name(detail::type_in(__PRETTY_FUNCTION__, "T = "));
    // With other compile flags it is still the same scene.
    static constexpr std::string_view target = SILT_TEXT(SILT_TARGET) "::";
    for (auto at = name.find(target); at != name.npos; at = name.find(target, at))
      name.erase(at, target.size());
    return name;
  }
  static std::string module_names() {
    return detail::names_of_modules(static_cast<const typename Sim::Modules*>(nullptr),
                                    []<class M>(const M*) { return name_of<M>(); });
  }

  static detail::ClockState clock_of(const Sim& sim) {
    const Engine& e = sim.engine_;
    detail::ClockState c;
    c.time = sim.time_, c.step_length = sim.dt_, c.time_origin = sim.time_origin_;
    c.checked_speed = sim.checked_speed_, c.peak_overlap = sim.peak_overlap_;
    c.largest_speed = e.largest_speed, c.largest_overlap = e.largest_overlap;
    c.largest_share = e.largest_share, c.safeguards = e.safeguards;
    c.step = sim.step_, c.step_origin = sim.step_origin_;
    c.next_id = sim.next_.particle, c.next_part = sim.next_.part;
    c.first_kick = sim.first_kick_, c.kicked = sim.kicked_, c.observed = sim.observed_;
    c.scene_changed = sim.scene_changed_, c.flux_every = sim.flux_every_;
    return c;
  }

  /// Whether the whole state is in rows and contacts, or known to every rank, and can thus be
  /// assembled from blocks.
  static constexpr bool has_rows_alone =
      !Sim::has_breakage && !Sim::Fluid::active && !detail::deforms<typename Sim::Domain>;

  struct Nothing {};
  template <bool Has, class T>
  using If = std::conditional_t<Has, T, Nothing>;

  using BondStage = std::remove_cvref_t<decltype(std::declval<Sim&>().bonds_)>;
  using BondsState = detail::BondsState<BondStage>;
  static constexpr bool has_cells = Sim::has_breakage && Sim::of_bodies;
  using Form = BodyForm<typename Sim::ShapeType>;
  using CellsState = If<has_cells, detail::CellsState<Form>>;
  using BreaksState =
      If<Sim::has_breakage,
         detail::BreaksState<std::remove_cvref_t<decltype(std::declval<Sim&>().breaks_)>>>;
  static void describe_breaks([[maybe_unused]] const Sim& sim,
                              [[maybe_unused]] detail::SceneDescription& scene) {
    if constexpr (Sim::has_breakage)
      detail::describe_breakage({scene, detail::SceneDescription::Aspect::Material, ""},
                                sim.breakage());
  }
  static void describe_bonds([[maybe_unused]] const Sim& sim,
                             [[maybe_unused]] detail::SceneDescription& scene) {
    if constexpr (Sim::has_bonds)
      detail::describe_bonds({scene, detail::SceneDescription::Aspect::Material, ""}, sim.bonds_);
  }
};

template <class Sim>
void save_checkpoint(const Sim& sim, const std::string& path) {
  Checkpoint<Sim>::save(sim, path);
}
template <class Sim>
void load_checkpoint(Sim& sim, const std::string& path, const AcceptedChanges& accepted = {}) {
  Checkpoint<Sim>::load(sim, path, accepted);
}

}  // namespace silt

// clang-format off
#include <silt/io/checkpoint_staged.hpp>
#include <silt/io/checkpoint_merged.hpp>
// clang-format on
