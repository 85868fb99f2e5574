// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/io/checkpoint.hpp>

namespace silt::inline SILT_TARGET {

/// State of a run that continues on another number of ranks, assembled from blocks: rows of this
/// rank, the history of their contacts, and the partners of these contacts as ghosts. The lists
/// contain only such contacts. The next search starts from them and sends particles to their ranks.
template <class Sim>
class Checkpoint<Sim>::Merged {
  using State = typename Engine::State;
  using Pairs = decltype(Engine::Lists::pairs);
  using Walls = decltype(Engine::Lists::walls);
  static constexpr std::uint32_t no_row = no_place;

 public:
  Merged(const Sim& sim, const AcceptedChanges& accepted) : sim_(sim), accepted_(accepted) {
    own_.take_off_pads(), others_.take_off_pads();
  }

  /// Takes from a block its own particles with numbers `from` to `to`.
  void take(const CheckpointReader& in, const std::string& name, std::size_t from, std::size_t to) {
    auto block = std::make_unique<Staged>(sim_);
    block->read(detail::CheckpointLoader(in, name), name, accepted_);
    if constexpr (Sim::of_bodies)
      take_bodies(*block, from, to);
    else
      take_rows(*block, from, to);
    take_pairs(*block);
    take_walls(*block);
    if constexpr (Sim::has_bonds) take_bonds(*block);
    take_wall_sums(in);
    if constexpr (Sim::has_ledger) books_.push_back(block->book_);
    if (!first_) first_ = std::move(block);
  }
  /// Takes only the ledgers of a block.
  void take_books(const CheckpointReader& in, [[maybe_unused]] const std::string& name) {
    if constexpr (Sim::has_ledger) {
      Staged block(sim_);
      block.read_ledger(detail::CheckpointLoader(in, name));
      books_.push_back(block.book_);
    }
    take_wall_sums(in);
  }
  /// Number of particles in the file of one process.
  std::size_t count(const CheckpointReader& in, [[maybe_unused]] const std::string& name) const {
    if constexpr (Sim::of_bodies) {
      DynArray<detail::Body> bodies;
      detail::CheckpointLoader(in, name).rows("bodies", bodies,
                                              detail::CheckpointLoader::any_count);
      return static_cast<std::size_t>(std::count_if(
          bodies.begin(), bodies.end(), [](const auto& b) { return b.id != no_particle; }));
    } else {
      const auto ids = in.get<ParticleId>("id");
      return ids.size() - static_cast<std::size_t>(std::count(ids.begin(), ids.end(), no_particle));
    }
  }
  std::uint64_t safeguards() const { return first_->clock_.safeguards; }  // of the first block

  /// `all`: particles of all blocks; `safeguards`: of all.
  std::unique_ptr<Staged> finish(const std::string& path, std::size_t all,
                                 std::uint64_t safeguards) {
    Staged& s = *first_;
    const std::size_t owned = own_.size();
    if constexpr (Sim::of_bodies) s.block_.owners = own_bodies_.bodies.size();
    const typename Pairs::State pairs = put_pairs(path);
    const std::size_t ghosts = own_.size() - owned, rows = own_.size();
    if constexpr (Sim::of_bodies) put_bodies(s);
    put_rows(s, ghosts);
    if constexpr (Sim::has_ledger) put_books(s);
    put_lists(s, pairs, rows);
    if constexpr (Sim::has_bonds) put_bonds(s);
    const bool is_first = sim_.rank() == 0;
    if constexpr (Sim::Modules::flux) s.from_walls_ = of_first(from_walls_, is_first);
    if constexpr (Sim::Modules::wear) put_worn(s, is_first);
    s.clock_.safeguards = is_first ? safeguards : 0;
    s.block_.rank = static_cast<std::uint64_t>(sim_.rank());
    s.block_.of = static_cast<std::uint64_t>(sim_.ranks());
    s.block_.present = all;
    s.block_.counts.assign(6, 0);
    s.block_.counts[5] = static_cast<std::uint64_t>(s.clock_.step);
    s.block_.balance = {0, -1};
    s.block_.neighbours.clear(), s.block_.sent.clear(), s.block_.impulses.clear();
    for (std::size_t w = 0; w < s.walls_.impulse.size(); ++w) {
      const Vec3d &impulse = s.walls_.impulse[w], &angular = s.walls_.angular_impulse[w];
      const double own = is_first ? 1 : 0;
      s.block_.impulses.insert(s.block_.impulses.end(),
                               {own * impulse, own * angular, impulse, angular});
    }
    s.forget_parts();
    return std::move(first_);
  }

 private:
  struct PairMemory {
    ParticleId a, b;  // a < b
    typename Pairs::Memory values;
    bool has_a;  // a is one of its own rows; block that it is from
  };

  static void append_row(State& to, State& from, std::size_t k) {
    detail::for_each_column(to,
                            [&](const auto& c, auto& values) { values.push_back(c.at(from)[k]); });
    detail::for_each_column(
        to.modules, [&](const auto& c, auto& values) { values.push_back(c.at(from.modules)[k]); });
  }
  void take_rows(Staged& block, std::size_t from, std::size_t to) {
    State& p = block.particles_;
    row_.assign(p.size(), no_row);
    std::size_t number = 0;
    for (std::size_t k = 0; k < p.size() - block.block_.ghosts; ++k) {
      if (p.is_parked(k)) continue;
      if (number >= from && number < to) {
        row_[k] = static_cast<std::uint32_t>(own_.size());
        append_row(own_, p, k);
        if (!block.synchronous_.empty()) synchronous_.push_back(block.synchronous_[k]);
      }
      ++number;
    }
  }
  /// Bodies and the values of modules for each; rows of the state beside them have their places.
  struct Bodies {
    DynArray<detail::Body> bodies;
    [[no_unique_address]] std::remove_cvref_t<decltype(std::declval<Engine&>().modules())> fields;

    std::uint32_t add(const detail::Body& body, auto& from, std::size_t k) {
      bodies.push_back(body);
      detail::for_each_column(
          fields, [&](const auto& c, auto& values) { values.push_back(c.at(from)[k]); });
      return static_cast<std::uint32_t>(bodies.size() - 1);
    }
  };
  void take_bodies(Staged& block, std::size_t from, std::size_t to) {
    State& p = block.particles_;
    row_.assign(p.size(), no_row);
    const std::size_t ghosts = block.block_.ghosts;
    const std::size_t own = ghosts > 0 ? block.block_.owners : block.bodies_.size();
    DynArray<std::uint32_t> place(block.bodies_.size(), no_place);
    std::size_t number = 0;
    for (std::size_t k = 0; k < own; ++k) {
      if (block.bodies_[k].id == no_particle) continue;
      if (number >= from && number < to) {
        place[k] = own_bodies_.add(block.bodies_[k], block.fields_, k);
        if (!block.synchronous_.empty()) synchronous_.push_back(block.synchronous_[k]);
      }
      ++number;
    }
    for (std::size_t k = 0; k < p.size() - ghosts; ++k)
      if (const std::uint32_t body = place[p.part[k].body]; body != no_place) {
        row_[k] = static_cast<std::uint32_t>(own_.size());
        append_row(own_, p, k);
        own_.part.back().body = body;
      }
  }
  /// Keeps a particle of another rank, of which this is a row.
  void keep_other(Staged& block, std::uint32_t row) {
    State& p = block.particles_;
    if (other_.count(p.id[row]) > 0) return;
    const auto keep = [&](std::uint32_t k) {
      other_[p.id[k]] = others_.size();
      append_row(others_, p, k);
    };
    if constexpr (Sim::of_bodies) {
      const std::uint32_t of = p.part[row].body;
      const detail::Body& b = block.bodies_[of];
      const std::uint32_t body = other_bodies_.add(b, block.fields_, of);
      first_row_.push_back(others_.size());
      for (std::size_t k = 0; k < sim_.engine().mover.forms[b.form].parts.size(); ++k)
        keep(block.rows_[b.first + k]), others_.part.back().body = body;
    } else {
      keep(row);
    }
  }
  void take_pairs(Staged& block) {
    State& p = block.particles_;
    const Pairs& pairs = block.lists_.pairs;
    pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = pairs.first()[k], b = pairs.second()[k];
      if (!pairs.remembers(k) || (row_[a] == no_row && row_[b] == no_row)) return;
      if (p.is_parked(a) || p.is_parked(b)) return;
      pairs_.push_back({p.id[a], p.id[b], pairs.memory(k), row_[a] != no_row});
      for (const std::uint32_t end : {a, b})
        if (row_[end] == no_row) keep_other(block, end);
    });
  }
  void take_walls(Staged& block) {
    Walls& walls = block.lists_.walls;
    walls.set_aside();
    for (std::uint32_t k = 0; k < row_.size(); ++k)
      if (row_[k] != no_row)
        for (auto contact : walls.kept_of(k)) {
          if (block.walls_.surfaces[contact.wall] == 0) continue;
          contact.particle = row_[k], walls_.push_back(contact);
        }
  }

  /// Bonds of the rows that are taken, each once.
  void take_bonds(Staged& block) requires(Sim::has_bonds) {
    const State& p = block.particles_;
    std::unordered_set<ParticleId> taken;
    for (std::size_t k = 0; k < row_.size(); ++k)
      if (row_[k] != no_row) taken.insert(p.id[k]);
    const auto& from = block.bonds_;
    for (std::size_t k = 0; k < from.number.size(); ++k) {
      const ParticleId i = from.ids[2 * k], j = from.ids[2 * k + 1];
      if (!(taken.count(i) + taken.count(j) > 0) || !known_bonds_.insert(from.number[k]).second)
        continue;
      bonds_.ids.insert(bonds_.ids.end(), {i, j}), bonds_.number.push_back(from.number[k]);
      bonds_.rest.push_back(from.rest[k]), bonds_.numbers.push_back(from.numbers[k]);
    }
    for (std::size_t k = 0; k < from.wall_number.size(); ++k) {
      const ParticleId i = from.wall_ids[2 * k];
      if (taken.count(i) == 0) continue;
      bonds_.wall_ids.insert(bonds_.wall_ids.end(), {i, from.wall_ids[2 * k + 1]});
      bonds_.wall_number.push_back(from.wall_number[k]);
      bonds_.wall_place.push_back(from.wall_place[k]);
      bonds_.wall_rest.push_back(from.wall_rest[k]);
      bonds_.wall_numbers.push_back(from.wall_numbers[k]);
      bonds_.wall_excludes.push_back(from.wall_excludes[k]);
    }
    if (bonds_.asked.empty()) bonds_.asked = from.asked;  // all ranks have the same
    for (std::size_t k = 0; k + 1 < from.freed.size(); k += 2)
      if (taken.count(from.freed[k]) > 0)
        bonds_.freed.insert(bonds_.freed.end(), {from.freed[k], from.freed[k + 1]});
  }
  /// The other ends become ghosts at the next search.
  void put_bonds(Staged& s) requires(Sim::has_bonds) {
    bonds_.made = s.bonds_.made, bonds_.broken = s.bonds_.broken;
    s.bonds_ = std::move(bonds_);
    s.stage_ = std::make_unique<BondStage>();
    s.stage_->model = sim_.bonds_.model, s.stage_->seed = sim_.bonds_.seed;
    s.bonds_.put(*s.stage_, s.particles_);
    s.stage_->fresh = s.stage_->loaded = sim_.ranks() > 1;
  }
  /// Heat and charge from walls to the particles of all blocks, and the wear of the walls.
  void take_wall_sums([[maybe_unused]] const CheckpointReader& in) {
    if constexpr (Sim::Modules::flux) {
      const auto more = in.get<double>("modules.from_walls");
      if (more.size() > from_walls_.size())  // not initialised yet
        from_walls_ = more;
      else if (more.size() == from_walls_.size())
        for_each_sum(from_walls_, [&](std::size_t k) { from_walls_[k] += more[k]; });
    }
    if constexpr (Sim::Modules::wear) {
      const auto numbers = in.get<std::uint64_t>("walls.worn_numbers");
      const auto more = in.get<double>("walls.worn");
      worn_.resize(std::max(worn_.size(), numbers.size()));
      std::size_t at = 0;
      for (std::size_t w = 0; w < numbers.size(); ++w) {
        worn_[w].resize(std::max<std::size_t>(worn_[w].size(), numbers[w]), 0);
        for (std::size_t k = 0; k < numbers[w] && at < more.size(); ++k) worn_[w][k] += more[at++];
      }
    }
  }
  void put_worn(Staged& s, bool is_first) {
    for (std::size_t w = 0; w < s.worn_.size(); ++w)
      s.worn_[w] = is_first && w < worn_.size() ? worn_[w] : DynArray<double>();
  }
  /// Visits the sums in such ledgers; a count precedes the numbers of each module.
  template <class Visit>
  static void for_each_sum(const DynArray<double>& books, const Visit& visit) {
    for (std::size_t at = 0; at < books.size();) {
      const auto count = 2 * static_cast<std::size_t>(books[at++]);
      for (std::size_t k = 0; k < count && at < books.size(); ++k) visit(at++);
    }
  }
  static DynArray<double> of_first(DynArray<double> books, bool is_first) {
    if (!is_first) for_each_sum(books, [&](std::size_t k) { books[k] = 0; });
    return books;
  }

  /// Pairs of contacts, by rows; needed rows of other ranks follow the own rows.
  typename Pairs::State put_pairs(const std::string& path) {
    std::unordered_map<ParticleId, std::uint32_t> place;
    for (std::uint32_t k = 0; k < own_.size(); ++k) place[own_.id[k]] = k;
    const auto is_own = [&, owned = own_.size()](ParticleId id) {
      const auto found = place.find(id);
      return found != place.end() && found->second < owned;
    };
    erase_if(pairs_, [&](const PairMemory& m) { return !m.has_a && is_own(m.a); });
    const auto append = [&](std::size_t row) {
      place[others_.id[row]] = static_cast<std::uint32_t>(own_.size());
      append_row(own_, others_, row);
    };
    const auto row_of = [&](ParticleId id) {
      if (const auto found = place.find(id); found != place.end()) return found->second;
      if (!Sim::has_ranks)
        throw FileError(text("checkpoint '", path, "' is damaged: particle ", id,
                             ", which touches others, is in none of its blocks"));
      const std::size_t row = other_.at(id);
      if constexpr (Sim::of_bodies) {
        const std::uint32_t of = others_.part[row].body;
        const detail::Body& b = other_bodies_.bodies[of];
        const std::uint32_t body = own_bodies_.add(b, other_bodies_.fields, of);
        for (std::size_t k = 0; k < sim_.engine().mover.forms[b.form].parts.size(); ++k)
          append(first_row_[of] + k), own_.part.back().body = body;
      } else {
        append(row);
      }
      return place.at(id);
    };
    DynArray<typename Pairs::Brought> all;
    for (const PairMemory& m : pairs_) {
      const std::uint32_t a = row_of(m.a), b = row_of(m.b);
      all.push_back({a, b, m.values});
    }
    return Pairs::state_of(all, own_.size());
  }
  void put_rows(Staged& s, [[maybe_unused]] std::size_t ghosts) {
    const State& before = s.particles_;
    const double largest = before.largest_radius, mean = before.mean_diameter;
    const double smallest = before.smallest_radius;
    const bool some_fixed = before.some_fixed;
    if constexpr (Sim::has_ranks) own_.ghosts = ghosts;
    own_.pad();
    own_.restored(largest, mean);
    own_.smallest_radius = smallest, own_.some_fixed = some_fixed;
    s.particles_ = std::move(own_);
    s.synchronous_ = std::move(synchronous_);
    s.block_.ghosts = ghosts;
  }
  /// Bodies, and the rows of their parts.
  void put_bodies(Staged& s) {
    const auto& forms = sim_.engine().mover.forms;
    std::uint32_t first = 0;
    for (detail::Body& b : own_bodies_.bodies)
      b.first = first, first += static_cast<std::uint32_t>(forms[b.form].parts.size());
    s.rows_.assign(own_.size(), no_place);
    for (std::uint32_t k = 0; k < own_.size(); ++k)
      s.rows_[own_bodies_.bodies[own_.part[k].body].first + own_.part[k].local] = k;
    s.bodies_ = std::move(own_bodies_.bodies), s.fields_ = std::move(own_bodies_.fields);
  }
  /// The first rank gets the sums of the ledgers of all ranks, the others what is equal on all.
  void put_books(Staged& s) {
    s.book_ = books_.front();
    if (sim_.rank() > 0) s.book_.forget_own();
    for (std::size_t k = 1; k < books_.size() && sim_.rank() == 0; ++k)
      s.book_.add_own_of(books_[k]);
  }
  void put_lists(Staged& s, const typename Pairs::State& pairs, std::size_t rows) {
    const DynArray<double> none(rows, 0);
    auto& lists = s.lists_;
    lists.reference.assign(rows, Vec3d{0, 0, 0});
    lists.upkeep.restore(none, none);
    lists.pairs.restore(pairs, rows);
    lists.walls.remember(std::move(walls_), sim_.engine_.walls, rows);
    lists.forget();
  }

  const Sim& sim_;
  const AcceptedChanges& accepted_;
  std::unique_ptr<Staged> first_;  // has the walls, clock and openings of all
  State own_, others_;             // without pads
  decltype(Engine::Mover::synchronous) synchronous_;
  std::unordered_map<ParticleId, std::size_t> other_;  // rows of others_
  [[no_unique_address]] If<Sim::of_bodies, Bodies> own_bodies_, other_bodies_;
  DynArray<std::size_t> first_row_;  // in others_, of other_bodies_
  DynArray<If<Sim::has_ledger, decltype(Sim::book_)>> books_;
  DynArray<std::uint32_t> row_;  // of the block's rows
  DynArray<PairMemory> pairs_;
  DynArray<typename Walls::Kept> walls_;
  [[no_unique_address]] If<Sim::has_bonds, BondsState> bonds_;
  std::unordered_set<std::uint64_t> known_bonds_;  // numbers
  DynArray<double> from_walls_;                    // where modules have fluxes
  DynArray<DynArray<double>> worn_;                // of each wall, where modules wear them
};

}  // namespace silt
