// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/checkpoint_wall_checks.hpp>

namespace silt::inline SILT_TARGET {

/// Everything that a checkpoint changes, kept outside the simulation: first it is read and checked,
/// then put in place by moves, which cannot fail.
template <class Sim>
class Checkpoint<Sim>::Staged {
  static auto parts_of() {
    if constexpr (Sim::has_ranks) {
      using Ranks = std::remove_cvref_t<decltype(std::declval<Engine&>().ranks)>;
      if constexpr (Ranks::template tells_parts<detail::BytesIn>)
        return std::type_identity<typename Ranks::PartsType>{};
      else
        return std::type_identity<Nothing>{};
    } else {
      return std::type_identity<Nothing>{};
    }
  }
  using Parts = typename decltype(parts_of())::type;

 public:
  explicit Staged(const Sim& sim) : sim_(sim), e_(sim.engine_) {
    if constexpr (Sim::has_ledger) book_ = sim.book_;
    if constexpr (Sim::Fluid::active) fluid_ = std::make_unique<typename Sim::Fluid>(sim.fluid_);
  }

  void read(const detail::CheckpointLoader& a, const std::string& path,
            const AcceptedChanges& accepted) {
    read_scene(a, path, accepted);
    clock_.visit(a);
    if constexpr (Sim::Modules::flux) clock_.visit_fluxes(a);
    detail::check_clock(a, clock_);
    require(!sim_.running_ || clock_.step_length > 0, "load_checkpoint: '", path,
            "' was saved before the first run, when it had no time step; load it between runs, not "
            "in an observer");
    const std::size_t inlets = sim_.openings_.inlets().size();
    const std::size_t outlets = sim_.openings_.outlets().size();
    openings_.visit(a, accepted.outlets ? detail::CheckpointLoader::any_count : outlets,
                    accepted.inlets ? detail::CheckpointLoader::any_count : inlets);
    detail::check_openings(a, openings_, sim_.openings_, clock_, accepted);
    read_particles(a);
    if constexpr (Sim::has_bonds) {
      bonds_.visit(a), bonds_.check(a, particles_, walls_.surfaces);
      stage_ = std::make_unique<BondStage>();
      stage_->model = sim_.bonds_.model, stage_->seed = sim_.bonds_.seed;
      bonds_.put(*stage_, particles_);
    }
    if constexpr (Sim::has_breakage) breaks_.visit(a), breaks_.check(a);
    if constexpr (Sim::Modules::flux) {
      a.column("modules.from_walls", from_walls_, detail::CheckpointLoader::any_count);
      auto books = e_.fluxes();  // to try them
      a.need(books.take_wall_books(from_walls_, e_.walls.size()), "modules.from_walls has ",
             from_walls_.size(), " numbers, which do not match ", e_.walls.size(), " walls");
    }
    detail::with_wall_heat(sim_.modules_.modules, [&](const auto& module) {
      wall_heat_ = detail::load_wall_heat(a, sim_, module.walls, clock_.time);
    });
    read_lists(a, accepted);
    if constexpr (detail::deforms<typename Sim::Domain>) read_box(a, path);
    if constexpr (Sim::has_ledger) read_ledger(a);
    if constexpr (Sim::Fluid::active) read_fluid(a, path);
    if constexpr (chooses_search) {
      const auto choice = a.template column<std::uint64_t>("search.choice", 2);
      using Finder = std::remove_cvref_t<decltype(detail::finder_of(sim_.search_))>;
      a.need(choice[0] < Finder::searches, "search.choice[0] = ", choice[0], " must be less than ",
             Finder::searches, ", the number of searches");
      choice_ = {choice[0], choice[1]};
    }
  }

  void put_into(Sim& sim, const AcceptedChanges& accepted) noexcept {
    Engine& e = sim.engine_;
    sim.time_ = clock_.time, sim.dt_ = clock_.step_length, sim.time_origin_ = clock_.time_origin;
    // Other materials and walls have another limit of the time step, which is checked again.
    sim.checked_speed_ =
        accepted.materials || known_walls_ < e.walls.size() ? 0 : clock_.checked_speed;
    sim.peak_overlap_ = clock_.peak_overlap, sim.checked_overlap_ = 0;
    sim.step_ = clock_.step, sim.step_origin_ = clock_.step_origin;
    sim.flux_every_ = clock_.flux_every;
    sim.next_ = {clock_.next_id, clock_.next_part};
    sim.first_kick_ = clock_.first_kick, sim.kicked_ = clock_.kicked, sim.continued_ = true;
    sim.past_runs_.failed_at = -1, sim.past_runs_.restarted = true;
    sim.past_runs_.gravity = sim.gravity;
    sim.observed_ = clock_.observed;
    sim.scene_changed_ = clock_.scene_changed || known_walls_ < e.walls.size();
    sim.laws_changed_ = laws_changed_;
    if (known_walls_ < e.walls.size()) sim.scene_step_ = sim.step_;
    e.coefficients = std::move(coefficients_);
    e.safeguards = clock_.safeguards;
    if constexpr (Sim::has_bonds) sim.bonds_ = std::move(*stage_), sim.bonds_broken_.clear();
    if constexpr (Sim::has_breakage) {
      breaks_.put(sim.breaks_);
      if (laws_changed_) sim.breaks_.sizes.coming_step = 0, sim.breaks_.sizes.forget();
    }
    e.particles = std::move(particles_);
    e.mover.synchronous = std::move(synchronous_);
    if constexpr (Sim::of_bodies) {
      e.mover.bodies = std::move(bodies_), e.mover.rows = std::move(rows_);
      if constexpr (has_cells) e.mover.forms = std::move(forms_), e.mover.cells = cells_;
      if constexpr (Sim::Fluid::active) e.mover.fluid = std::move(loads_);
      e.mover.modules = std::move(fields_);
    }
    e.lists = std::move(lists_);
    for (std::size_t w = 0; w < e.walls.size(); ++w) {
      Wall& wall = e.walls[w];
      if (walls_.surfaces[w] == 0) wall.surfaces.clear();
      wall.pose = walls_.pose[w], wall.last_pose = walls_.last_pose[w];
      wall.force = walls_.force[w], wall.torque = walls_.torque[w];
      wall.impulse = walls_.impulse[w], wall.angular_impulse = walls_.angular_impulse[w];
      wall.reference = walls_.reference[w], wall.turned = walls_.turned[w];
      put_motion(wall, w, sim, accepted);
      wall.deforming = static_cast<int>(walls_.deforming[w]), wall.deformed = walls_.deformed[w];
      wall.vertex_steps = std::move(vertex_steps_[w]);
      if constexpr (Sim::Modules::wear) wall.worn = std::move(worn_[w]);
    }
    openings_.put(sim.openings_, accepted.inlets, accepted.outlets, clock_.time);
    if constexpr (detail::deforms<typename Sim::Domain>) {
      sim.domain_ = *box_;
      if constexpr (Sim::of_bodies) e.mover.flow = {box_->gradient(), box_->centre()};
    }
    if constexpr (Sim::Modules::flux) e.fluxes().take_wall_books(from_walls_, e.walls.size());
    detail::with_wall_heat(sim.modules_.modules,
                           [this](auto& module) { module.walls = std::move(wall_heat_); });
    if constexpr (Sim::has_ledger)
      sim.book_ = std::move(book_), sim.gravity_booked_ = gravity_booked_;
    if constexpr (Sim::Fluid::active) sim.fluid_ = std::move(*fluid_);
    if constexpr (chooses_search) detail::finder_of(sim.search_).keep({choice_[0], choice_[1]});
    if constexpr (Sim::has_ranks) {
      block_.put(e.ranks);
      sim.ranks_scene_.edits = {};  // of the state before
      if constexpr (Sim::of_bodies)
        e.mover.ghosts = e.mover.bodies.size() - block_.owners,
        follow_bodies(e.ranks.neighbours, e.particles);
      if (!parts_) e.ranks.part_anew();
      if constexpr (!std::is_same_v<Parts, Nothing>)
        if (parts_) e.ranks.set_parts(std::move(*parts_));
    }
    e.restored(clock_.largest_speed, clock_.largest_overlap, clock_.largest_share);
  }

 private:
  friend class Merged;

  /// A wall with an accepted difference in its motion continues from its present pose: a drive is
  /// released now, a changed motion starts now.
  void put_motion(Wall& wall, std::size_t w, const Sim& sim,
                  const AcceptedChanges& accepted) const noexcept {
    if (wall.is_driven() && walls_.drive[w] != wall.drive.index()) {
      wall.state = detail::released(wall.drive, wall.pose, clock_.time);
      if (clock_.kicked && detail::is_free(wall.drive))
        detail::push_wall(wall, sim.gravity, 0.5 * clock_.step_length, clock_.step_length, true);
      return;
    }
    wall.state = walls_.state[w];
    if (!accepted.motions || wall.is_driven() || wall.state.changed == 0) return;
    wall.state.start = wall.pose, wall.state.since = clock_.time;
  }

  void read_scene(const detail::CheckpointLoader& a, const std::string& path,
                  const AcceptedChanges& accepted);

  void read_particles(const detail::CheckpointLoader& a);
  /// State of a decomposition, if it has any.
  void read_parts(const detail::CheckpointLoader& a) requires(Sim::has_ranks) {
    using Ranks = std::remove_cvref_t<decltype(e_.ranks)>;
    if constexpr (Ranks::template tells_parts<detail::BytesIn>) {
      parts_ = e_.ranks.parts();
      detail::BytesIn in{a, block_.parts};
      parts_->for_each_state(in);
    }
  }
  /// Divides space anew.
  void forget_parts() { parts_.reset(); }

  void read_cells(const detail::CheckpointLoader& a) requires has_cells {
    CellsState state;
    state.visit(a);
    auto cells = state.forms(a);
    const auto& now = e_.mover.forms;
    forms_.assign(now.begin(), now.end() - static_cast<std::ptrdiff_t>(e_.mover.cells));
    cells_ = cells.size();
    std::move(cells.begin(), cells.end(), std::back_inserter(forms_));
  }
  /// Forms of the bodies in the file.
  const auto& forms() const {
    if constexpr (has_cells)
      return forms_;
    else
      return e_.mover.forms;
  }
  auto& fields_of_particles() {
    if constexpr (Sim::of_bodies)
      return fields_;
    else
      return particles_.modules;
  }
  auto& loads_of_particles() {
    if constexpr (Sim::of_bodies)
      return loads_;
    else
      return particles_.fluid;
  }

  void read_lists(const detail::CheckpointLoader& a, const AcceptedChanges& accepted);

  void read_box(const detail::CheckpointLoader& a, const std::string& path);

  void read_ledger(const detail::CheckpointLoader& a) requires(Sim::has_ledger) {
    auto books = a.template column<double>("ledger");
    constexpr std::size_t least = decltype(sim_.book_)::least_size + 3;
    a.need(books.size() >= least && (books.size() - least) % 9 <= 1 &&
               (books.size() - least) / 9 <= e_.walls.size(),
           "ledger has ", books.size(), " numbers, which do not match ", e_.walls.size(), " walls");
    const std::size_t last = books.size() - 3;
    gravity_booked_ = {books[last], books[last + 1], books[last + 2]};
    books.resize(last);
    book_.restore(books);
  }

  void read_fluid(const detail::CheckpointLoader& a,
                  const std::string& path) requires(Sim::Fluid::active) {
    try {
      fluid_->for_each_state([&](const std::string& name, auto&& values) {
        // A part that is a vector has any length.
        if constexpr (requires { values.resize(std::size_t{}); }) {
          values = a.template column<double>(name);
          detail::check_fluid_part(a, name, values, *fluid_);
        } else {
          const auto read = a.template column<double>(name, values.size());
          detail::check_fluid_part(a, name, read, *fluid_);
          std::copy(read.begin(), read.end(), values.begin());
        }
      });
    } catch (const InputError& error) {
      throw FileError(text("checkpoint '", path, "' is damaged: ", error.what()));
    }
    const double ahead = fluid_->clock.time - clock_.time;
    const double most = fluid_->clock.last_step * (1 + 1e-9) + clock_.step_length;
    a.need(fluid_->clock.steps == 0 || (ahead > -most && ahead < most),
           "fluid.clock: the fluid "
           "is at ",
           fluid_->clock.time, " s, the particles at ", clock_.time, " s");
  }

  const Sim& sim_;
  const Engine& e_;
  [[no_unique_address]] BondsState bonds_;
  [[no_unique_address]] BreaksState breaks_;
  std::unique_ptr<BondStage> stage_;  // of bonds
  detail::ClockState clock_;
  detail::WallsState walls_;
  detail::BlockState block_;  // of a run on many ranks
  std::optional<Parts> parts_;
  DynArray<DynArray<Vec3d>> vertex_steps_;  // of each wall
  DynArray<DynArray<double>> worn_;         // of each wall, where modules wear them
  DynArray<double> from_walls_;             // where modules have fluxes
  WallValues<WallHeat> wall_heat_;          // where a module has it
  std::size_t known_walls_ = 0;             // number of walls of the scene that the file has
  bool laws_changed_ = false;               // materials or rules of breakage differ from the file
  detail::OpeningsState openings_;
  decltype(Engine::coefficients) coefficients_;
  typename Engine::State particles_;
  decltype(Engine::Mover::synchronous) synchronous_;
  DynArray<detail::Body> bodies_;
  [[no_unique_address]] If<has_cells, DynArray<Form>> forms_;  // where polyhedra break
  std::size_t cells_ = 0;                                      // of them, the last ones
  DynArray<std::uint32_t> rows_;
  std::remove_cvref_t<decltype(std::declval<Engine&>().fluid_loads())> loads_;
  [[no_unique_address]] std::remove_cvref_t<decltype(std::declval<Engine&>().modules())> fields_;
  typename Engine::Lists lists_;
  [[no_unique_address]] If<Sim::has_ledger, decltype(Sim::book_)> book_;
  Vec3d gravity_booked_{0, 0, 0};
  std::optional<typename Sim::Domain> box_;  // that deforms
  std::unique_ptr<typename Sim::Fluid> fluid_;
  std::array<std::size_t, 2> choice_{};
};

}  // namespace silt

#include <silt/io/checkpoint_staged_read.hpp>
