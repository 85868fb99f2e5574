// silt - BSD-3-Clause, see LICENSE
#pragma once

// Parts of Checkpoint::Staged: read and check the scene, the particles and the lists.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint_staged.hpp>

namespace silt::inline SILT_TARGET {

template <class Sim>
void Checkpoint<Sim>::Staged::read_scene(const detail::CheckpointLoader& a, const std::string& path,
                                         const AcceptedChanges& accepted) {
  coefficients_ = Engine::coefficients_of(sim_.contacts_);  // throws where a pair has no values
  const std::string written = a.words("scene");
  a.column("walls.surfaces", walls_.surfaces, detail::CheckpointLoader::any_count);
  DynArray<bool> removed(e_.walls.size(), false);  // in the file, or in both
  for (std::size_t w = 0; w < std::min(removed.size(), walls_.surfaces.size()); ++w)
    removed[w] = walls_.surfaces[w] == 0;
  known_walls_ = accepted.walls ? std::min(removed.size(), walls_.surfaces.size()) : removed.size();
  auto scene = detail::describe_scene(sim_, coefficients_, sim_.openings_, removed,
                                      std::min(removed.size(), walls_.surfaces.size()));
  describe_bonds(sim_, scene), describe_breaks(sim_, scene);
  const std::string difference = scene.difference(written, accepted);
  require(difference.empty(), "checkpoint '", path,
          "' is of another scene: ", detail::with_names(difference, sim_));
  AcceptedChanges but_laws = accepted;
  but_laws.materials = false;
  laws_changed_ = accepted.materials && !scene.difference(written, but_laws).empty();
  walls_.visit(a, known_walls_);
  if constexpr (Sim::Modules::wear) {
    walls_.visit_wear(a, known_walls_);
    worn_ = walls_.worn_of(a, e_.walls, Sim::Modules::wearing);
  }
  for (std::size_t w = 0; w < known_walls_; ++w)
    a.need(walls_.surfaces[w] == 0 || walls_.surfaces[w] == e_.walls[w].surfaces.size(),
           detail::name_of_wall(e_.walls, w), " has ", walls_.surfaces[w],
           " surfaces, the scene's ", e_.walls[w].surfaces.size());
}

template <class Sim>
void Checkpoint<Sim>::Staged::read_particles(const detail::CheckpointLoader& a) {
  const std::size_t materials = Sim::ContactsType::several_materials ? coefficients_.materials : 1;
  detail::visit_particles(a, particles_, detail::CheckpointLoader::any_count);
  const bool is_block = detail::BlockState::is_in(a);
  if (is_block) {
    block_.visit(a), block_.check(a, particles_.size(), walls_.surfaces.size());
    if constexpr (Sim::has_ranks) read_parts(a);
  }
  detail::check_particles(a, particles_, materials, !is_block);
  detail::check_ids(a, Sim::of_bodies ? "part" : "particle", particles_.id,
                    Sim::of_bodies ? clock_.next_part : clock_.next_id);
  std::size_t count = particles_.size();
  if constexpr (Sim::of_bodies) {
    a.rows("bodies", bodies_, detail::CheckpointLoader::any_count);
    if constexpr (has_cells) read_cells(a);
    rows_ = detail::check_bodies(a, bodies_, particles_, forms());
    count = bodies_.size();
    DynArray<ParticleId> ids;
    for (const auto& b : bodies_) ids.push_back(b.id);
    detail::check_ids(a, "body", std::move(ids), clock_.next_id);
  }
  a.rows("synchronous", synchronous_, !clock_.kicked ? 0 : is_block ? block_.owners : count);
  for (std::size_t k = 0; k < synchronous_.size(); ++k) {
    const auto& [velocity, spin] = synchronous_[k];
    a.need(is_finite(velocity) && is_finite(spin), "synchronous: velocity ", velocity,
           " m/s and spin of particle ", k, " must be finite");
  }
  auto& fields = fields_of_particles();
  detail::visit_columns(a, fields, count);
  detail::for_each_column(fields, [&](const auto& c, auto& values) {
    detail::check_finite_rows(a, c.name.text(), values);
  });
  if constexpr (Sim::Fluid::active) {
    auto& loads = loads_of_particles();
    detail::visit_columns(a, loads, count);
    detail::check_loads(a, loads);
    if constexpr (Sim::follows_fluid) {
      const auto left = a.template column<double>("fluid.taken_by_left", 3);
      loads.left = {left[0], left[1], left[2]};
    }
  }
  particles_.pad();
  if constexpr (Sim::has_ranks) particles_.ghosts = block_.ghosts;
  particles_.restored(particles_.largest_radius, particles_.mean_diameter);
  if (is_block)
    particles_.smallest_radius = block_.smallest_radius, particles_.some_fixed = block_.some_fixed;
}

template <class Sim>
void Checkpoint<Sim>::Staged::read_lists(const detail::CheckpointLoader& a,
                                         const AcceptedChanges& accepted) {
  auto& upkeep = lists_.upkeep;
  detail::visit_upkeep(a, upkeep, lists_.reference, detail::CheckpointLoader::any_count);
  const std::size_t listed = lists_.reference.size();
  detail::check_upkeep(a, clock_, upkeep, listed, particles_.size());
  for (std::size_t k = 0; k < listed; ++k)
    a.need(is_finite(lists_.reference[k]), "lists.reference of row ", k, " must be finite");
  // Lists that treat a wall as resting do not fit a moving one: they are rebuilt.
  for (std::size_t w = 0; w < known_walls_; ++w)
    if (walls_.moves[w] != e_.walls[w].moves() && walls_.surfaces[w] > 0)
      upkeep.searched_at = upkeep.pruned_at = -1;
  const bool forgotten = upkeep.searched_at < 0;
  const auto walls = std::span<const Wall>(e_.walls).first(known_walls_);
  detail::check_walls(a, walls_, walls, clock_, forgotten, accepted);
  auto vertex = walls_.vertex_steps.begin();
  for (const std::uint64_t count : walls_.vertices) {
    const auto next = vertex + static_cast<std::ptrdiff_t>(count);
    vertex_steps_.emplace_back(vertex, next), vertex = next;
  }

  // Particles inserted in front of the ghosts have moved the rows of pairs since the search.
  const bool moved = detail::BlockState::is_in(a) && forgotten;
  const std::size_t paired = moved ? particles_.size() : listed;
  typename decltype(Engine::Lists::pairs)::State pairs;
  detail::visit_pairs(a, pairs, Engine::memory);
  detail::check_pairs<Engine>(a, pairs, particles_, paired);
  typename decltype(Engine::Lists::walls)::State contacts;
  detail::visit_wall_contacts(a, contacts, Engine::memory);
  lists_.walls.planes_apart = !Engine::State::of_bodies;
  lists_.set_period(sim_.domain());
  // A plane that starts or stops moving has its contacts at another place than in the file.
  const bool laid_out = detail::check_wall_contacts<Engine>(a, contacts, lists_.walls, walls,
                                                            listed, forgotten, accepted.motions);
  const DynArray<double> outer(upkeep.outer.begin(), upkeep.outer.end()),
      inner(upkeep.inner.begin(), upkeep.inner.end());
  upkeep.restore(outer, inner);
  lists_.pairs.restore(pairs, paired);
  lists_.walls.restore(std::move(contacts), walls, listed);
  lists_.searched_walls.restore(std::move(walls_.marks[0]), walls_.regions[0]);
  lists_.pruned_walls.restore(std::move(walls_.marks[1]), walls_.regions[1]);
  for (std::size_t w = known_walls_; w < e_.walls.size(); ++w)
    walls_.add(e_.walls[w], clock_.time), vertex_steps_.push_back(e_.walls[w].vertex_steps);
  // Particles that rest in a different outlet leave, too.
  const bool outlets = accepted.outlets && !sim_.openings_.outlets().empty();
  if (known_walls_ < e_.walls.size() || !laid_out || outlets) lists_.forget();
}

template <class Sim>
void Checkpoint<Sim>::Staged::read_box(const detail::CheckpointLoader& a, const std::string& path) {
  constexpr std::size_t own = Sim::Domain::state_size;
  const auto all = a.template column<double>("box", own + decltype(lists_.flow)::state_size);
  box_ = sim_.domain_;
  try {
    box_->restore({all.begin(), all.begin() + own});
  } catch (const InputError& error) {
    throw FileError(text("checkpoint '", path, "' is damaged: ", error.what()));
  }
  lists_.flow.restore(all.data() + own);
  const auto& flow = lists_.flow;
  a.need(flow.map.determinant() > 0 && flow.searched > 0 && flow.searched <= 1 &&
             flow.pruned >= flow.searched && flow.pruned <= 1 && flow.tightest >= 0,
         "box: the deformation since the last search is invalid");
}

}  // namespace silt
