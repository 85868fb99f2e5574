// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include <silt/boundary/wall.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/engine/pair_list.hpp>
#include <silt/engine/rows.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A sphere that is near a surface, and the slots that keep its contacts with it.
struct WallCandidate {
  std::uint32_t particle;
  std::uint16_t wall, surface;        // surface of this wall
  std::uint32_t slot;                 // its first slot
  std::uint32_t facets, facet_count;  // where its triangles stand in the pool, if it is a mesh
  auto key() const { return std::tie(particle, wall, surface); }
};

/// A plane as a row: unit normal, and the distance of the origin against it [m].
struct alignas(32) PlaneRow {
  double x = 0, y = 0, z = 0, offset = 0;
};

/// Which spheres are near which surfaces, in two stages like PairList, and H Reals of history for
/// each contact with a wall. A candidate has as many slots as the surface can have contacts with
/// one sphere; slots come in blocks that one thread computes at a time, and all candidates of a
/// sphere stand side by side in one block. Lone candidates, of a sphere that is near nothing but
/// one plane at rest, which most are, stand behind all others, one slot each without gaps.
template <std::size_t H>
class WallContacts {
 public:
  static constexpr std::size_t block = 64;  // slots
  struct Slot {
    Vec3d normal;  // [-] at the last step
    bool touching;
  };

  std::size_t slots() const { return slots_.size(); }
  std::size_t blocks() const { return block_begin_.empty() ? 0 : block_begin_.size() - 1; }
  std::span<const WallCandidate> candidates() const { return inner_; }
  std::span<const WallCandidate> block_candidates(std::size_t b) const {
    return {inner_.data() + block_begin_[b], block_begin_[b + 1] - block_begin_[b]};
  }
  std::span<const std::uint32_t> facets(const WallCandidate& c) const {
    return {inner_facets_.data() + c.facets, c.facet_count};
  }
  Slot& slot(std::size_t k) { return slots_[k]; }
  /// Whether a block holds lone candidates; the plane of each as {normal, distance of the origin}.
  bool is_lone(std::size_t b) const { return block_begin_[b] >= lone_from_; }
  const PlaneRow* planes(std::size_t b) const {
    return planes_.data() + (block_begin_[b] - lone_from_);
  }
  double* history(std::size_t component) { return history_[component].data(); }

  /// Finds all spheres nearer than `reach` [m] to a surface.
  void search(std::span<const Wall> walls, std::span<const PositionRow> rows, double reach,
              std::span<const std::uint32_t> previous, const Team& team) {
    archive();
    previous_.assign(previous.begin(), previous.end());
    renewed_ = true;
    team.for_ranges(rows.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      Found& found = found_[r];
      found.clear();
      for (std::size_t w = 0; w < walls.size(); ++w)
        for (std::size_t s = 0; s < walls[w].surfaces.size(); ++s)
          visit_surface(walls[w].surfaces[s], [&](const auto& surface) {
            search_surface(surface, walls[w], w, s, rows, from, to, reach, found);
          });
      std::sort(found.candidates.begin(), found.candidates.end(),
                [](const WallCandidate& a, const WallCandidate& b) { return a.key() < b.key(); });
    });
    collect(outer_, outer_facets_);
  }

  /// Keeps of those found the ones nearer than the sphere's and the wall's reach [m] now; history
  /// stays with its contact.
  void prune(std::span<const Wall> walls, const PositionRow* rows, const double* reach,
             double wall_reach, const Team& team) {
    if (!renewed_) archive();
    team.for_ranges(outer_.size(), [&](std::size_t r, std::size_t from, std::size_t to) {
      found_[r].clear();
      for (std::size_t k = from; k < to; ++k) {
        const WallCandidate& c = outer_[k];
        if (rows[c.particle].r == 0) continue;  // it has left
        const Wall& wall = walls[c.wall];
        const Vec3d centre = in_body(wall, rows[c.particle].centre());
        const double within = rows[c.particle].r + reach[c.particle] + wall_reach;
        visit_surface(wall.surfaces[c.surface],
                      [&](const auto& surface) { keep(surface, c, centre, within, found_[r]); });
      }
    });
    collect(inner_, inner_facets_);
    part_lone(walls);
    lay_out_slots(walls);
    recall();
    renewed_ = false;
  }

  /// State for a checkpoint: candidates, facets and slots as they stand.
  struct State {
    std::vector<WallCandidate> outer, inner;
    std::vector<std::uint32_t> outer_facets, inner_facets;
    std::vector<Slot> slots;
    std::array<std::vector<double>, H> history;
    std::size_t lone_from = 0;
  };
  State state() const {
    State s{outer_, inner_, outer_facets_, inner_facets_, slots_, {}, lone_from_};
    for (std::size_t h = 0; h < H; ++h) s.history[h].assign(history_[h].begin(), history_[h].end());
    return s;
  }
  void restore(State s, std::span<const Wall> walls) {
    outer_ = std::move(s.outer), inner_ = std::move(s.inner);
    outer_facets_ = std::move(s.outer_facets), inner_facets_ = std::move(s.inner_facets);
    // Blocks by the slots as they were: a wall may have lost its surfaces since.
    block_begin_.clear();
    for (std::size_t k = 0; k < inner_.size(); ++k)
      if (inner_[k].slot / block >= block_begin_.size()) block_begin_.push_back(k);
    if (!inner_.empty()) block_begin_.push_back(inner_.size());
    lone_from_ = s.lone_from;
    note_planes(walls);
    slots_ = std::move(s.slots);
    for (std::size_t h = 0; h < H; ++h)
      history_[h].assign(s.history[h].begin(), s.history[h].end());
    renewed_ = false;
  }

  static Vec3d in_body(const Wall& wall, const Vec3d& point) {
    return wall.moves() ? wall.pose.to_body(point) : point;
  }
  static constexpr std::size_t slots_of(const Surface& surface) {
    return visit_surface(surface, [](const auto& s) {
      return static_cast<std::size_t>(std::remove_cvref_t<decltype(s)>::max_contacts);
    });
  }

 private:
  /// What one range of spheres or candidates gave, with a pool of triangles of its own.
  struct Found {
    std::vector<WallCandidate> candidates;
    std::vector<std::uint32_t> facets, near;
    void clear() { candidates.clear(), facets.clear(); }
    void add(WallCandidate c, std::span<const std::uint32_t> of) {
      c.facets = static_cast<std::uint32_t>(facets.size());
      c.facet_count = static_cast<std::uint32_t>(of.size());
      facets.insert(facets.end(), of.begin(), of.end());
      candidates.push_back(c);
    }
  };

  template <class S>
  static void search_surface(const S& surface, const Wall& wall, std::size_t w, std::size_t s,
                             std::span<const PositionRow> rows, std::size_t from, std::size_t to,
                             double reach, Found& found) {
    WallCandidate c{0, static_cast<std::uint16_t>(w), static_cast<std::uint16_t>(s), 0, 0, 0};
    for (std::size_t p = from; p < to; ++p) {
      const Vec3d centre = in_body(wall, rows[p].centre());
      const double within = rows[p].r + reach;
      found.near.clear();
      if constexpr (requires { surface.triangles_near(centre, within, found.near); }) {
        if (!surface.bounds().grown(within).contains(centre)) continue;
        surface.triangles_near(centre, within, found.near);
        if (found.near.empty()) continue;
      } else {
        SurfacePoint point[S::max_contacts];
        if (surface.contacts(centre, within, point) == 0) continue;
      }
      c.particle = static_cast<std::uint32_t>(p);
      found.add(c, found.near);
    }
  }

  /// Keeps the candidate if it is within reach, with those of its triangles that are.
  template <class S>
  void keep(const S& surface, const WallCandidate& c, const Vec3d& centre, double within,
            Found& found) const {
    found.near.clear();
    if constexpr (requires { surface.triangles_near(centre, within, found.near); }) {
      for (std::uint32_t k = c.facets; k < c.facets + c.facet_count; ++k)
        if (surface.distance_to(outer_facets_[k], centre) < within)
          found.near.push_back(outer_facets_[k]);
      if (found.near.empty()) return;
    } else {
      SurfacePoint point[S::max_contacts];
      if (surface.contacts(centre, within, point) == 0) return;
    }
    found.add(c, found.near);
  }

  /// Joins what the ranges found, in their order.
  void collect(std::vector<WallCandidate>& candidates, std::vector<std::uint32_t>& facets) {
    candidates.clear(), facets.clear();
    for (Found& found : found_) {
      const auto offset = static_cast<std::uint32_t>(facets.size());
      for (WallCandidate c : found.candidates) c.facets += offset, candidates.push_back(c);
      facets.insert(facets.end(), found.facets.begin(), found.facets.end());
      found.clear();
    }
  }

  /// Brings the lone candidates to the end, both parts still in order.
  void part_lone(std::span<const Wall> walls) {
    const auto is_lone = [&](std::size_t k) {
      const WallCandidate& c = inner_[k];
      return !walls[c.wall].moves() &&
             std::holds_alternative<Plane>(walls[c.wall].surfaces[c.surface]) &&
             (k == 0 || inner_[k - 1].particle != c.particle) &&
             (k + 1 == inner_.size() || inner_[k + 1].particle != c.particle);
    };
    std::vector<WallCandidate> sorted, lone;
    for (std::size_t k = 0; k < inner_.size(); ++k)
      (is_lone(k) ? lone : sorted).push_back(inner_[k]);
    lone_from_ = sorted.size();
    sorted.insert(sorted.end(), lone.begin(), lone.end());
    inner_ = std::move(sorted);
    note_planes(walls);
  }
  void note_planes(std::span<const Wall> walls) {
    planes_.assign(inner_.size() - lone_from_, {});
    for (std::size_t k = lone_from_; k < inner_.size(); ++k) {
      const auto& surfaces = walls[inner_[k].wall].surfaces;
      if (surfaces.empty()) continue;  // taken away; the lists will be renewed before they are used
      const Plane plane = std::get<Plane>(surfaces[inner_[k].surface]).unit();
      const Vec3d& n = plane.normal;
      planes_[k - lone_from_] = {n.x, n.y, n.z, dot(plane.point, n)};
    }
  }

  void lay_out_slots(std::span<const Wall> walls) {
    block_begin_.assign(1, 0);
    std::size_t next = 0;
    const auto count = [&](std::size_t k) {
      return slots_of(walls[inner_[k].wall].surfaces[inner_[k].surface]);
    };
    for (std::size_t k = 0; k < inner_.size(); ++k) {
      std::size_t together = count(k);  // slots that must not be parted from this candidate's
      if (k == 0 || inner_[k - 1].particle != inner_[k].particle)
        for (std::size_t m = k + 1; m < inner_.size() && inner_[m].particle == inner_[k].particle;
             ++m)
          if (together + count(m) <= block) together += count(m);
      if (next % block + together > block || k == lone_from_) next = pieces(next, block) * block;
      if (next / block >= block_begin_.size()) block_begin_.push_back(k);
      inner_[k].slot = static_cast<std::uint32_t>(next);
      next += count(k);
    }
    if (inner_.empty())
      block_begin_.clear();
    else
      block_begin_.push_back(inner_.size());
    slots_.assign(pieces(next, block) * block, Slot{{0, 0, 1}, false});
    for (auto& h : history_) h.assign(slots_.size(), 0.0);
  }

  struct Kept {
    std::uint32_t particle;
    std::uint16_t wall, surface;
    Slot slot;
    std::array<double, H> history;
    auto key() const { return std::tie(particle, wall, surface); }
  };

  /// Sets aside all touching contacts, by particle, wall and surface.
  void archive() {
    archive_.clear();
    const auto keep = [&](const WallCandidate& c, std::size_t s, const Slot& slot) {
      Kept kept{c.particle, c.wall, c.surface, slot, {}};
      for (std::size_t h = 0; h < H; ++h) kept.history[h] = history_[h][s];
      archive_.push_back(kept);
    };
    for (std::size_t k = 0; k < lone_from_; ++k) {
      const auto& c = inner_[k];
      const std::size_t end = k + 1 < lone_from_ && inner_[k + 1].slot / block == c.slot / block
                                  ? inner_[k + 1].slot
                                  : pieces(c.slot + 1, block) * block;
      for (std::size_t s = c.slot; s < end; ++s)
        if (slots_[s].touching) keep(c, s, slots_[s]);
    }
    const auto first_lone = static_cast<std::ptrdiff_t>(archive_.size());
    for (std::size_t k = lone_from_; k < inner_.size(); ++k) {
      const PlaneRow& n = planes_[k - lone_from_];
      if (remembers(inner_[k].slot)) keep(inner_[k], inner_[k].slot, {{n.x, n.y, n.z}, true});
    }
    std::inplace_merge(archive_.begin(), archive_.begin() + first_lone, archive_.end(),
                       [](const Kept& a, const Kept& b) { return a.key() < b.key(); });
  }
  bool remembers(std::size_t slot) const {
    for (const auto& h : history_)
      if (h[slot] != 0) return true;
    return false;
  }
  /// Gives kept contacts back to their candidates. Without a search since, candidates and archive
  /// are in the same order: each is near the one before.
  void recall() {
    const bool moved = renewed_ && !previous_.empty();
    auto found = archive_.begin();
    for (std::size_t k = 0; k < inner_.size(); ++k) {
      const auto& c = inner_[k];
      const std::uint32_t before = moved ? previous_[c.particle] : c.particle;
      const auto key = std::tie(before, c.wall, c.surface);
      if (moved || k == lone_from_)
        found = std::lower_bound(archive_.begin(), archive_.end(), key,
                                 [](const Kept& a, const auto& b) { return a.key() < b; });
      while (found != archive_.end() && found->key() < key) ++found;
      auto same = found;
      for (std::size_t s = c.slot; same != archive_.end() && same->key() == key; ++same, ++s) {
        if (k < lone_from_) slots_[s] = same->slot;
        for (std::size_t h = 0; h < H; ++h) history_[h][s] = same->history[h];
      }
    }
  }

  std::vector<WallCandidate> outer_, inner_;
  std::vector<std::uint32_t> outer_facets_, inner_facets_;
  std::array<Found, Team::most_ranges> found_;
  std::vector<std::size_t> block_begin_;  // first candidate of each block
  std::size_t lone_from_ = 0;             // first lone candidate
  AlignedVector<PlaneRow> planes_;        // of the lone candidates
  std::vector<Slot> slots_;
  std::array<AlignedVector<double>, H> history_;
  std::vector<Kept> archive_;
  std::vector<std::uint32_t> previous_;
  bool renewed_ = false;
};

}  // namespace silt::detail
