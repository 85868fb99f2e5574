// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/lists/pair_list.hpp>
#include <silt/engine/lists/planes_apart.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/engine/lists/wall_search.hpp>
#include <silt/engine/state/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Which spheres are near which surfaces, in two lists like PairList, with H Scalars of history for
/// each contact with a wall. A candidate has as many slots as its surface can have contacts with
/// one sphere, or the number given here. Slots form blocks that one thread computes at a time, and
/// all candidates of a sphere are adjacent in one block. Most wall contacts are of spheres near
/// planes at rest and nothing else; they come after all others, one slot per candidate, in pieces
/// that share no sphere. Within a piece they are sorted by plane, so that the lanes of a pack have
/// the same plane. In a periodic box a candidate belongs to one image of the wall; the images of
/// one surface share their slots, because a contact continues where one image passes into the next.
template <std::size_t H, class Scalar, std::size_t PlaneSlots = 0, std::size_t OtherSlots = 0,
          bool Repeats = false>
class WallContacts {
 public:
  static constexpr bool repeats = Repeats;  // walls repeat with the periodic box
  using Candidate = std::conditional_t<Repeats, ImageCandidate, WallCandidate>;
  static constexpr std::size_t block = OtherSlots > 4 ? 128 : 64;  // slots
  struct Slot {
    Vec3d normal;               // [-] at the last step
    bool touching;              // or within the law's range
    std::uint32_t feature = 0;  // of SolidContact
  };
  /// What is kept of a contact while the lists are rebuilt.
  struct Kept {
    std::uint32_t particle;
    std::uint16_t wall, surface;
    Slot slot;
    std::array<Scalar, H> history;
    auto key() const { return std::tie(particle, wall, surface); }
  };
  double range = 0;          // [m] gap up to which the law acts
  bool planes_apart = true;  // spheres at planes only are computed by PlanePipeline
  Vec3d period{0, 0, 0};     // [m] lengths of a periodic box; 0 where it is not periodic

  /// Position, relative to a candidate's wall or image, of a point [m] given near its sphere.
  Vec3d seen([[maybe_unused]] const Candidate& c, const Vec3d& point) const {
    if constexpr (Repeats)
      if (c.image != 0) return point + way_of(c.image, period);
    return point;
  }

  std::size_t slots() const { return slots_.size(); }
  std::size_t blocks() const { return block_begin_.empty() ? 0 : block_begin_.size() - 1; }
  std::span<const Candidate> candidates() const { return inner_; }
  std::span<const Candidate> block_candidates(std::size_t b) const {
    return {inner_.data() + block_begin_[b], block_begin_[b + 1] - block_begin_[b]};
  }
  std::span<const std::uint32_t> facets(const WallCandidate& c) const {
    return {inner_facets_.data() + c.facets, c.facet_count};
  }
  Slot& slot(std::size_t k) { return slots_[k]; }
  const Slot& slot(std::size_t k) const { return slots_[k]; }
  Scalar* history(std::size_t component) { return history_[component].data(); }
  Scalar history(std::size_t component, std::size_t slot) const {
    return history_[component][slot];
  }
  /// Sets the components [from, to) of all histories to 0.
  void clear_history(std::size_t from, std::size_t to) {
    for (std::size_t h = from; h < to; ++h) std::fill(history_[h].begin(), history_[h].end(), 0);
  }
  /// Pieces of the candidates at planes, and the runs of each.
  std::size_t plane_pieces() const { return piece_begin_.size() - 1; }
  std::span<const PlaneRun> runs(std::size_t piece) const {
    return {runs_.data() + run_begin_[piece], run_begin_[piece + 1] - run_begin_[piece]};
  }
  /// The sphere of a slot in a run; behind the run's end, up to a whole pack, a dummy sphere.
  const std::uint32_t* at_planes(std::size_t slot) const {
    return at_planes_.data() + (slot - first_plane_slot_);
  }

  /// Finds all spheres nearer than `reach` [m] to a surface or one of its images. `nobody`: the row
  /// of the dummy sphere.
  template <class Domain>
  void search(std::span<const Wall> walls, std::span<const PositionRow> rows, double reach,
              std::span<const std::uint32_t> previous, [[maybe_unused]] const Domain& domain,
              const Team& team, std::size_t nobody) {
    archive();
    particles_ = static_cast<std::uint32_t>(nobody);
    previous_.assign(previous.begin(), previous.end());
    renewed_ = true;
    if constexpr (Repeats) images_.choose(walls, rows, reach, domain);
    team.for_ranges(rows.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      found_[r].clear();
      images_.find(walls, rows, {from, to, reach}, period, found_[r]);
    });
    collect(outer_, outer_facets_);
  }

  /// Archives the histories of contacts; kept_of() then returns those of the particle at a place.
  void set_aside() { archive(); }
  std::span<const Kept> kept_of(std::uint32_t particle) const {
    const auto before = [](const Kept& kept, std::uint32_t k) { return kept.particle < k; };
    const auto from = std::lower_bound(archive_.begin(), archive_.end(), particle, before);
    return {from, std::lower_bound(from, archive_.end(), particle + 1, before)};
  }
  /// Adds the histories of contacts whose particles arrived with the last search, by their places
  /// before it.
  void take_in(std::span<const Kept> brought) {
    if (brought.empty()) return;
    archive_.insert(archive_.end(), brought.begin(), brought.end());
    std::stable_sort(archive_.begin(), archive_.end(), by_key);
  }

  /// Makes lists of only these contacts; the next search continues from them.
  void remember(DynArray<Kept> contacts, std::span<const Wall> walls, std::size_t particles);

  DynArray<Candidate>& found() { return outer_; }  // by the last search; some may be removed

  /// Adds the spheres from `first` on, which were added since the search; prune() must follow.
  template <class Domain>
  void join(std::span<const Wall> walls, std::span<const PositionRow> rows, std::size_t first,
            double reach, [[maybe_unused]] const Domain& domain) {
    particles_ = static_cast<std::uint32_t>(rows.size());
    WallFinds<Candidate>& found = found_[0];
    found.clear();
    if constexpr (Repeats) images_.choose(walls, rows.subspan(first), reach, domain);
    images_.find(walls, rows, {first, rows.size(), reach}, period, found);
    const auto offset = static_cast<std::uint32_t>(outer_facets_.size());
    for (Candidate c : found.candidates) c.facets += offset, outer_.push_back(c);
    outer_facets_.insert(outer_facets_.end(), found.facets.begin(), found.facets.end());
    found.clear();
  }

  /// Keeps the candidates that are now nearer than the reaches [m] of sphere and wall; histories
  /// stay with their contacts.
  void prune(std::span<const Wall> walls, const PositionRow* rows, const double* reach,
             double wall_reach, const Team& team) {
    if (!renewed_) archive();
    team.for_ranges(outer_.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      found_[r].clear();
      for (std::size_t k = from; k < to; ++k) {
        Candidate c = outer_[k];
        c.origin = static_cast<std::uint32_t>(k);
        if (rows[c.particle].r == 0) continue;  // it has left
        const Wall& wall = walls[c.wall];
        const Vec3d centre = in_wall(wall, seen(c, rows[c.particle].centre()));
        const double within = rows[c.particle].r + reach[c.particle] + wall_reach;
        visit_surface(wall.surfaces[c.surface], [&](const auto& surface) {
          found_[r].keep(surface, c, centre, within, outer_facets_);
        });
      }
    });
    collect(inner_, inner_facets_);
    part_planes(walls);
    lay_out_slots(walls);
    lay_out_planes(walls);
    recall();
    renewed_ = false;
  }

  /// Must be called after the triangles of a wall have changed: no contacts are found there until
  /// the next search, but their histories are kept.
  void forget_facets(std::size_t wall) {
    for (auto* const all : {&outer_, &inner_})
      for (Candidate& c : *all)
        if (c.wall == wall) c.facet_count = 0;
  }

  /// State for a checkpoint: candidates, facets and slots as they stand.
  struct State {
    DynArray<Candidate> outer, inner;
    DynArray<std::uint32_t> outer_facets, inner_facets;
    DynArray<Slot> slots;
    std::array<DynArray<double>, H> history;
    DynArray<std::uint64_t> pieces;  // first candidate at planes of each piece, and the end
  };
  State state() const;
  void restore(State s, std::span<const Wall> walls, std::size_t particles);

  /// Whether the inner candidates of a restored state are laid out as by a pruning, each in slots
  /// of its own. This is required because several threads work on the blocks at a time.
  bool is_laid_out(const State& s, std::span<const Wall> walls) const;
  /// The weaker condition if walls were removed since the lists were made, and these only describe
  /// past contacts: archive() finds slots for all candidates.
  static bool has_slots(const State& s);

  static constexpr std::size_t slots_of(const Surface& surface) {
    return visit_surface(surface, [](const auto& s) {
      using S = std::remove_cvref_t<decltype(s)>;
      constexpr std::size_t given = std::is_same_v<S, Plane> ? PlaneSlots : OtherSlots;
      return given > 0 ? given : static_cast<std::size_t>(S::max_contacts);
    });
  }

 private:
  /// Joins the results of the ranges, in order.
  void collect(DynArray<Candidate>& candidates, DynArray<std::uint32_t>& facets) {
    candidates.clear(), facets.clear();
    for (WallFinds<Candidate>& found : found_) {
      const auto offset = static_cast<std::uint32_t>(facets.size());
      for (Candidate c : found.candidates) c.facets += offset, candidates.push_back(c);
      facets.insert(facets.end(), found.facets.begin(), found.facets.end());
      found.clear();
    }
  }

  static constexpr std::size_t padding = 16;  // the widest pack of lanes
  std::size_t planes_from() const { return piece_begin_.front(); }

  /// Moves the candidates at planes to the end, in pieces, each plane by plane.
  void part_planes(std::span<const Wall> walls) {
    piece_begin_ = put_planes_last(walls, planes_apart, inner_);
  }
  /// For a restored state: a plane that was removed, or has begun to move, since the lists were
  /// made. The lists are renewed before they are used; contacts with a plane that moves keep their
  /// history.
  bool is_gone_plane(std::span<const Wall> walls, const WallCandidate& c) {
    if (walls[c.wall].surfaces.empty()) return true;
    if (plane_at_rest(walls, c) != nullptr) return false;
    const auto* const plane = std::get_if<Plane>(&walls[c.wall].surfaces[c.surface]);
    if (plane != nullptr && remembers(c.slot)) slots_[c.slot] = {plane->unit().normal, true};
    return true;
  }
  static bool same_plane(const WallCandidate& a, const WallCandidate& b) {
    return a.wall == b.wall && a.surface == b.surface;
  }

  void lay_out_slots(std::span<const Wall> walls) {
    block_begin_.assign(1, 0);
    std::size_t next = 0;
    const auto count = [&](std::size_t k) {
      return slots_of(walls[inner_[k].wall].surfaces[inner_[k].surface]);
    };
    for (std::size_t k = 0; k < planes_from(); ++k) {
      std::size_t together = count(k);  // slots that must stay in the same block
      if (k == 0 || inner_[k - 1].particle != inner_[k].particle)
        for (std::size_t m = k + 1; m < planes_from() && inner_[m].particle == inner_[k].particle;
             ++m)
          if (together + count(m) <= block) together += count(m);
      if (next % block + together > block) next = pieces(next, block) * block;
      if (next / block >= block_begin_.size()) block_begin_.push_back(k);
      inner_[k].slot = static_cast<std::uint32_t>(next);
      next += count(k);
    }
    if (planes_from() > 0)
      block_begin_.push_back(planes_from());
    else
      block_begin_.clear();
    next = pieces(next, block) * block;
    for (std::size_t p = 0; p < plane_pieces(); ++p)
      for (std::size_t k = piece_begin_[p]; k < piece_begin_[p + 1]; ++k) {
        if (k == piece_begin_[p] || !same_plane(inner_[k - 1], inner_[k]))
          next = pieces(next, padding) * padding;
        inner_[k].slot = static_cast<std::uint32_t>(next++);
      }
    slots_.assign(pieces(next, padding) * padding, Slot{{0, 0, 1}, false});
    for (auto& h : history_) h.assign(slots_.size(), 0);
  }

  /// Records the runs, and the sphere of each slot in them.
  void lay_out_planes(std::span<const Wall> walls) {
    runs_.clear(), run_begin_.assign(1, 0);
    first_plane_slot_ = planes_from() < inner_.size() ? inner_[planes_from()].slot : slots_.size();
    at_planes_.assign(slots_.size() - first_plane_slot_, particles_);
    for (std::size_t p = 0; p < plane_pieces(); ++p) {
      for (std::size_t k = piece_begin_[p]; k < piece_begin_[p + 1]; ++k) {
        const Candidate& c = inner_[k];
        at_planes_[c.slot - first_plane_slot_] = c.particle;
        if (k == piece_begin_[p] || !same_plane(inner_[k - 1], c)) {
          if (is_gone_plane(walls, c)) continue;
          const Plane plane = plane_at_rest(walls, c)->unit();
          runs_.push_back(
              {c.wall, c.surface, plane.normal, dot(plane.point, plane.normal), c.slot, c.slot});
        }
        if (!is_gone_plane(walls, c)) ++runs_.back().to;
      }
      run_begin_.push_back(runs_.size());
    }
  }

  /// Archives all touching contacts in the order of the outer list: by particle, wall, surface.
  void archive() {
    for (const PlaneRun& run : runs_)
      for (std::size_t s = run.from; s < run.to; ++s)
        if (remembers(s)) slots_[s] = {run.normal, true};
    DynArray<std::uint32_t> inner(outer_.size(), no_place);  // place in the inner list
    for (std::uint32_t k = 0; k < inner_.size(); ++k) inner[inner_[k].origin] = k;
    archive_.clear(), archived_.assign(outer_.size() + 1, 0);
    for (std::size_t o = 0; o < outer_.size(); ++o) {
      if (inner[o] != no_place) archive(inner[o]);
      archived_[o + 1] = static_cast<std::uint32_t>(archive_.size());
    }
  }
  void archive(std::size_t k) {
    const Candidate& c = inner_[k];
    std::size_t end = c.slot + 1;
    if (k < planes_from())
      end = k + 1 < planes_from() && inner_[k + 1].slot / block == c.slot / block
                ? inner_[k + 1].slot
                : pieces(end, block) * block;
    for (std::size_t s = c.slot; s < end; ++s)
      if (slots_[s].touching) {
        archive_.push_back({c.particle, c.wall, c.surface, slots_[s], {}});
        for (std::size_t h = 0; h < H; ++h) archive_.back().history[h] = history_[h][s];
      }
  }
  bool remembers(std::size_t slot) const {
    for (const auto& h : history_)
      if (h[slot] != 0) return true;
    return false;
  }
  /// Returns archived contacts to their candidates; the candidates of all images of a surface share
  /// them.
  void recall() {
    for (std::size_t k = 0, next = 1; k < inner_.size(); k = next++) {
      const Candidate& c = inner_[k];
      std::uint32_t first = c.origin, last = c.origin + 1;  // in the outer list
      if constexpr (Repeats) {
        while (next < inner_.size() && same_surface(inner_[next], c)) ++next;
        while (first > 0 && same_surface(outer_[first - 1], c)) --first;
        while (last < outer_.size() && same_surface(outer_[last], c)) ++last;
      }
      auto from = archive_.begin(), to = from;
      if (renewed_) {
        const std::uint32_t before = previous_.empty() ? c.particle : previous_[c.particle];
        std::tie(from, to) = std::equal_range(archive_.begin(), archive_.end(),
                                              Kept{before, c.wall, c.surface, {}, {}}, by_key);
      } else {
        from += archived_[first], to += archived_[last];
      }
      if constexpr (Repeats) to = from + std::min(to - from, slots_from(k, next));
      for (std::size_t s = c.slot; from != to; ++from, ++s) {
        slots_[s] = from->slot;
        for (std::size_t h = 0; h < H; ++h) history_[h][s] = from->history[h];
      }
    }
  }
  static bool by_key(const Kept& a, const Kept& b) { return a.key() < b.key(); }
  /// Number of slots of the candidates k ... next-1.
  std::ptrdiff_t slots_from(std::size_t k, std::size_t next) const {
    const std::size_t end = next < inner_.size() ? inner_[next].slot : slots_.size();
    return static_cast<std::ptrdiff_t>(end - inner_[k].slot);
  }

  DynArray<Candidate> outer_, inner_;
  DynArray<std::uint32_t> outer_facets_, inner_facets_;
  std::array<WallFinds<Candidate>, Team::most_ranges> found_;
  WallSearch<Repeats> images_;
  DynArray<std::size_t> block_begin_;     // first candidate of each block
  DynArray<std::size_t> piece_begin_{0};  // first candidate of each piece at planes
  DynArray<PlaneRun> runs_;
  DynArray<std::size_t> run_begin_{0};  // first run of each piece
  DynArray<std::uint32_t> at_planes_;   // sphere of each slot at planes
  std::size_t first_plane_slot_ = 0;
  std::uint32_t particles_ = 0;
  DynArray<Slot> slots_;
  std::array<AlignedVector<Scalar>, H> history_;
  DynArray<Kept> archive_;
  DynArray<std::uint32_t> archived_;  // first kept contact of each outer candidate
  DynArray<std::uint32_t> previous_;
  bool renewed_ = false;
};

}  // namespace silt::detail

#include <silt/engine/lists/wall_contacts_state.hpp>
