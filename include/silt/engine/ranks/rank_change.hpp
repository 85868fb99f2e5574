// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/ranks/choose_ghosts.hpp>
#include <silt/engine/ranks/packed.hpp>
#include <silt/engine/ranks/rank_stage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The migration of rows at a search on several ranks, before and after pairs are found: particles
/// go to the ranks that own their positions, with the history of their contacts; then ghosts are
/// exchanged.
///
/// Contact histories are stored by the places of their particles before the search (PairArchive,
/// WallContacts). A particle that was not known on this rank before also gets such a place, behind
/// all others, and the histories that it brings are stored there.
template <class State, class Mover, class Pairs, class Walls>
class RankChange {
  using Memory = typename Pairs::Memory;
  struct PairMemory {
    ParticleId a, b;  // a < b
    Memory values;
  };

 public:
  using BroughtPair = typename Pairs::Brought;
  using BroughtWall = typename Walls::Kept;

  /// Data per row of a scene in addition to its columns: its place before the search, and its
  /// anticipated speed [m/s].
  struct Rows {
    State& particles;
    Mover& mover;
    DynArray<std::uint32_t>& previous;
    DynArray<double>& anticipated;
    const Team& team;
  };

  /// Sends the owned rows to their new ranks (collective). Ghosts are removed.
  template <class Stage>
  void move(Stage& ranks, const Rows& rows, const Pairs& pairs, const Walls& walls,
            std::int64_t step) {
    const AddsSeconds timed(ranks.seconds.searches);
    State& particles = rows.particles;
    const std::size_t owned = particles.owned(), before = particles.size();
    weigh(rows, std::exchange(ranks.near_work, {}), pairs, owned);
    const DynArray<int> to = ranks.choose_ranks(particles, rows.mover, weights_, step);
    if constexpr (State::bonded) ranks.bonds->leave(to);
    const auto goes = [&](std::size_t k) { return to[k] >= 0 && to[k] != ranks.rank(); };
    next_place_ = static_cast<std::uint32_t>(before);
    places_.clear(), pairs_.clear(), walls_.clear();
    for (std::size_t k = 0; k < before; ++k)
      if (k >= owned || goes(k)) places_[particles.id[k]] = static_cast<std::uint32_t>(k);

    DynArray<Packed> out(static_cast<std::size_t>(ranks.size()));
    pack(rows, to, goes, pairs, walls, out);
    DynArray<std::uint32_t> stay;
    for (std::uint32_t k = 0; k < owned; ++k)
      if (to[k] == ranks.rank()) stay.push_back(k);
    particles.ghosts = 0;
    if (stay.size() != before) {
      particles.reorder(stay, rows.team);
      gather(rows.previous, stay, rows.team), gather(rows.anticipated, stay, rows.team);
    }
    particles.parked = 0;
    particles.take_off_pads();
    for (const Arrival& came : ranks.pass(out)) unpack(came.bytes, rows, ranks.counts.migrated);
    particles.pad();
    particles.measure();
    ranks.measure(particles);
    ++ranks.counts.searches;
  }

  /// Receives the ghosts, behind the owned rows, with their reaches [m] (collective).
  /// `grown`: the owned rows, grown by these; beyond that modules that act in pairs need ghosts.
  template <class Stage, class Domain, class Reaches>
  void add_ghosts(Stage& ranks, const Rows& rows, std::span<const PositionRow> grown,
                  const Domain& domain, Reaches& reaches) {
    const AddsSeconds timed(ranks.seconds.searches);
    State& particles = rows.particles;
    auto to = choose_ghosts(ranks, rows, grown, domain);
    if constexpr (State::bonded) {
      const auto wanted = ranks.bonds->pass();
      for (std::size_t r = 0; r < to.size(); ++r) {
        to[r].insert(to[r].end(), wanted[r].begin(), wanted[r].end());
        std::sort(to[r].begin(), to[r].end());
        to[r].erase(std::unique(to[r].begin(), to[r].end()), to[r].end());
      }
    }
    DynArray<Packed> out(to.size());
    for (std::size_t r = 0; r < to.size(); ++r) {
      if constexpr (State::of_bodies)
        if (!to[r].empty()) pack_bodies(particles, rows.mover, to[r], out[r]);
      for (const std::uint32_t k : to[r]) {
        pack_row(particles, k, out[r]), pack_row(particles.modules, k, out[r]);
        out[r].put(reaches[k]);
      }
    }
    ranks.neighbours.clear();
    const std::size_t owned = particles.size();
    particles.take_off_pads();
    const DynArray<Arrival> arrivals = ranks.pass(out);
    auto came = arrivals.begin();
    for (std::size_t r = 0; r < to.size(); ++r) {
      RankNeighbour other{static_cast<int>(r), std::move(to[r]), row_count(particles), 0};
      if (came != arrivals.end() && came->rank == other.rank) {
        Unpacked from((came++)->bytes);
        const auto bodies = unpack_bodies(rows, from);
        while (!from.done()) {
          unpack_one(particles, bodies, from);
          reaches.push_back(from.get<double>());
          rows.previous.push_back(place_of(particles.id.back()));
          rows.anticipated.push_back(0);
        }
      }
      other.end = row_count(particles);
      if (!other.send.empty() || other.end > other.first)
        ranks.neighbours.push_back(std::move(other));
    }
    particles.ghosts = particles.size() - owned;
    particles.pad();
    ++particles.changes;
  }

  /// Number of places before the search, including those of newcomers.
  std::size_t places() const { return next_place_; }
  /// The pair histories of newcomers, by those places.
  DynArray<BroughtPair> pairs_brought(const Rows& rows) const {
    std::unordered_map<ParticleId, std::uint32_t> place;
    for (const PairMemory& m : pairs_) place[m.a] = place[m.b] = no_place;
    if (!place.empty())
      for (std::size_t k = 0; k < rows.particles.size(); ++k)
        if (const auto found = place.find(rows.particles.id[k]); found != place.end())
          found->second = rows.previous[k];
    DynArray<BroughtPair> brought;
    for (const PairMemory& m : pairs_) {
      const std::uint32_t a = place[m.a], b = place[m.b];
      if (a != no_place && b != no_place) brought.push_back({a, b, m.values});
    }
    return brought;
  }
  const DynArray<BroughtWall>& walls_brought() const { return walls_; }

 private:
  static std::uint32_t row_count(const State& particles) {
    return static_cast<std::uint32_t>(particles.size());
  }
  std::uint32_t place_of(ParticleId id) {
    const auto known = places_.find(id);
    return known != places_.end() ? known->second : next_place_++;
  }

  struct NoBodies {};
  static auto unpack_bodies([[maybe_unused]] const Rows& rows, [[maybe_unused]] Unpacked& from) {
    if constexpr (State::of_bodies)
      return BodiesThatCome<Mover>(rows.mover, from);
    else
      return NoBodies{};
  }
  template <class Bodies>
  static void unpack_one(State& particles, [[maybe_unused]] const Bodies& bodies, Unpacked& from) {
    unpack_row(particles, from), unpack_row(particles.modules, from);
    if constexpr (State::of_bodies)
      particles.part.back().body = bodies.place_of(particles.part.back().body);
  }

  /// ghosts_in_reach(); for bodies with all parts. Parts are tested where the body has them, not
  /// wrapped into a periodic box, because parts that extend beyond it would be far from the others.
  template <class Stage, class Domain>
  static auto choose_ghosts(Stage& ranks, const Rows& rows, std::span<const PositionRow> grown,
                            const Domain& domain) {
    if constexpr (State::of_bodies) {
      DynArray<PositionRow> in_body(grown.begin(), grown.end());
      for (std::size_t k = 0; k < in_body.size(); ++k) {
        const Vec3d at = grown[k].centre() - rows.particles.part[k].image;
        in_body[k] = {at.x, at.y, at.z, grown[k].r};
      }
      auto to = ghosts_in_reach(ranks.comm(), std::span<const PositionRow>(in_body), domain);
      for (auto& some : to) take_whole_bodies(rows.particles, rows.mover, some);
      return to;
    } else {
      return ghosts_in_reach(ranks.comm(), grown, domain);
    }
  }

  /// The work of each owned row: 1, plus 0.5 for each pair that it belongs to, plus what modules
  /// that act in pairs have with its particle.
  void weigh(const Rows& rows, const DynArray<double>& near, const Pairs& pairs,
             std::size_t owned) {
    weights_.assign(owned, 1);
    for (std::size_t k = 0; k < owned && !near.empty(); ++k)
      if constexpr (State::of_bodies) {
        const auto& part = rows.particles.part[k];
        if (part.local == 0 && part.body < near.size()) weights_[k] += near[part.body];
      } else {
        if (k < near.size()) weights_[k] += near[k];
      }
    pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = pairs.first()[k], b = pairs.second()[k];
      if (a < owned) weights_[a] += 0.5;
      if (b < owned) weights_[b] += 0.5;
    });
  }

  /// For each rank: its rows, the histories of their pairs, and their histories at walls.
  template <class Goes>
  void pack(const Rows& rows, std::span<const int> to, const Goes& goes, const Pairs& pairs,
            const Walls& walls, DynArray<Packed>& out) const {
    const State& particles = rows.particles;
    DynArray<DynArray<std::uint32_t>> leave(out.size());
    DynArray<DynArray<std::size_t>> known(out.size());
    std::size_t leaving = 0;
    for (std::uint32_t k = 0; k < to.size(); ++k)
      if (goes(k)) leave[static_cast<std::size_t>(to[k])].push_back(k), ++leaving;
    if (leaving == 0) return;
    pairs.for_each([&](std::size_t k) {
      if (!pairs.remembers(k)) return;
      int last = -1;
      for (const std::uint32_t end : {pairs.first()[k], pairs.second()[k]})
        if (end < to.size() && goes(end) && to[end] != last)
          known[static_cast<std::size_t>(last = to[end])].push_back(k);
    });
    for (std::size_t r = 0; r < out.size(); ++r) {
      if (leave[r].empty()) continue;
      if constexpr (State::of_bodies) pack_bodies(particles, rows.mover, leave[r], out[r]);
      out[r].put(leave[r].size());
      for (const std::uint32_t k : leave[r]) {
        pack_row(particles, k, out[r]), pack_row(particles.modules, k, out[r]);
        out[r].put(rows.anticipated[k]);
      }
      out[r].put(known[r].size());
      for (const std::size_t k : known[r])
        out[r].put(PairMemory{particles.id[pairs.first()[k]], particles.id[pairs.second()[k]],
                              pairs.memory(k)});
      for (std::uint32_t n = 0; n < leave[r].size(); ++n)
        for (BroughtWall contact : walls.kept_of(leave[r][n]))
          contact.particle = n, out[r].put(contact);  // its place in this message
    }
  }

  void unpack(std::span<const std::byte> bytes, const Rows& rows, std::uint64_t& migrated) {
    State& particles = rows.particles;
    const std::size_t first = particles.size();
    Unpacked from(bytes);
    const auto bodies = unpack_bodies(rows, from);
    for (auto n = from.get<std::size_t>(); n > 0; --n, ++migrated) {
      unpack_one(particles, bodies, from);
      rows.anticipated.push_back(from.get<double>());
      rows.previous.push_back(place_of(particles.id.back()));
    }
    for (auto n = from.get<std::size_t>(); n > 0; --n) pairs_.push_back(from.get<PairMemory>());
    while (!from.done()) {
      walls_.push_back(from.get<BroughtWall>());
      walls_.back().particle = rows.previous[first + walls_.back().particle];
    }
  }

  std::unordered_map<ParticleId, std::uint32_t> places_;  // of ghosts and rows sent away
  std::uint32_t next_place_ = 0;
  DynArray<double> weights_;
  DynArray<PairMemory> pairs_;
  DynArray<BroughtWall> walls_;
};

}  // namespace silt::detail
