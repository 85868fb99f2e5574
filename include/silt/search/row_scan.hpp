// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/level_plan.hpp>
#include <silt/search/occupied_rows.hpp>
#include <silt/search/pair_scan.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Finds the pairs of a HashedGrid row by row: those within the level of the row, and those with
/// other levels that the plan assigns to it.
template <class Arch, class Domain>
class RowScan {
 public:
  RowScan(const OccupiedRows& grid, const LevelPlan& plan, double reach, const Domain& domain,
          PairBuffer& found)
      : grid_(grid),
        spheres_(grid.spheres()),
        plan_(plan),
        reach_(reach),
        domain_(domain),
        found_(found),
        cursors_(grid.levels().size()) {}

  void operator()(std::size_t row) {
    const std::size_t level = grid_.level_of(row), levels = grid_.levels().size();
    look_at_own_level(row, level);
    if (levels == 1) return;
    blocks_.clear();
    for (std::size_t other = 0; other < levels; ++other) {
      if (other == level) continue;
      const bool own_look =
          plan_.coarse_look(std::min(level, other), std::max(level, other)) == (level < other);
      if (!own_look) continue;
      if (blocks_.empty()) cut_into_blocks(row, level);
      if (level < other)
        look_at_fines(row, level, other);
      else
        look_at_coarse(level, other);
    }
  }

 private:
  using Partners = PartnerScan<Arch, Domain>;
  using Frame = GridFrame;
  using Range = SphereRange;
  static constexpr std::size_t width = Lanes<Arch>::width;

  // --- within a level -----------------------------------------------------------------------

  void look_at_own_level(std::size_t row, std::size_t level) {
    const auto& [cutoff, frame, first_row, first_sphere] = grid_.levels()[level];
    open_neighbours(row, level, frame);
    if constexpr (Domain::periodic) {
      if (domain_.repeats(0) && !frame.wraps[0])  // so short that any sphere of a row may be near
        return sweep_own_level<Images::Any>(row, INFINITY);
      if (frame.wraps[0]) sweep_across_faces(row, cutoff);
      return sweep_own_level<Images::Direct>(row, cutoff);
    }
    sweep_own_level<Images::Any>(row, cutoff);
  }
  template <Images Which>
  void sweep_own_level(std::size_t row, double cutoff) {
    const Range own = grid_.in_row(row);
    const double slack = slack_for(cutoff);
    for (std::size_t p = own.begin; p < own.end; ++p) {
      const Partners partners_of(spheres_, p, reach_, domain_);
      const double x = spheres_.x[p], begin = x - cutoff - slack,
                   end = x + spheres_.r[p] + 0.5 * (cutoff + reach_) + slack;
      std::size_t next = p + 1;
      partners_of.template sweep<Which>(next, own.end, -INFINITY, end, found_);
      for (int k = 0; k < neighbours_; ++k)
        partners_of.template sweep<Which>(neighbour_[k].begin, neighbour_[k].end, begin, end,
                                          found_);
    }
  }
  /// The same across the ends of a box that is periodic along x.
  void sweep_across_faces(std::size_t row, double cutoff) {
    const double low = domain_.box().min.x, length = domain_.length(0),
                 around = cutoff + slack_for(cutoff);
    const Range own = grid_.in_row(row);
    for (std::size_t p = own.begin; p < own.end; ++p) {
      const Partners partners_of(spheres_, p, reach_, domain_);
      const double begin = spheres_.x[p] - around, end = spheres_.x[p] + around;
      const auto sweep = [&](Range r, double from, double to) {
        std::size_t next = grid_.first_from(r, from);
        partners_of.template sweep<Images::AcrossFaces>(next, r.end, from, to, found_);
      };
      if (end > low + length) sweep(own, -INFINITY, end - length);
      for (int k = 0; k < neighbours_; ++k) {
        if (end > low + length) sweep(neighbour_[k], -INFINITY, end - length);
        if (begin < low) sweep(neighbour_[k], begin + length, INFINITY);
      }
    }
  }
  /// Enlargement [m] of an interval along x for the disorder of rows and for rounding.
  double slack_for(double cutoff) const {
    return grid_.disorder() + 1e-9 * cutoff + 1e-15 * grid_.scale();
  }

  /// Opens four of the eight rows around `row`: the next of its layer, and three of the next layer.
  void open_neighbours(std::size_t row, std::size_t level, const Frame& frame) {
    const std::size_t y = grid_.y_of(row), z = grid_.z_of(row), end_y = frame.count[1];
    const bool last_layer = z + 1 == frame.count[2];
    neighbours_ = 0;
    if (y + 1 < end_y)
      open(row + 1, level, y + 1, y + 1, z);
    else if (frame.wraps[1])
      open(grid_.seek(row, grid_.row_key(level, 0, z)), level, 0, 0, z);
    if (last_layer && !frame.wraps[2]) return;
    const std::size_t next = last_layer ? 0 : z + 1, from = y - std::min<std::size_t>(y, 1);
    cursor_ = grid_.seek(cursor_, grid_.row_key(level, from, next));
    open(cursor_, level, from, std::min(y + 1, end_y - 1), next);
    if (!frame.wraps[1]) return;
    for (const std::size_t across : {std::size_t{0}, end_y - 1})
      if ((across == 0 ? end_y - 1 : 0) == y)
        open(grid_.seek(cursor_, grid_.row_key(level, across, next)), level, across, across, next);
  }
  /// Opens the rows from `at` on that belong to y_from ... y_to of a layer.
  void open(std::size_t at, std::size_t level, std::size_t y_from, std::size_t y_to,
            std::size_t z) {
    const std::uint64_t first = grid_.row_key(level, y_from, z), last = first + (y_to - y_from);
    for (; grid_.is_before(at, last + 1) && !grid_.is_before(at, first); ++at)
      neighbour_[neighbours_++] = grid_.in_row(at);
  }

  // --- across levels ------------------------------------------------------------------------

  /// Largest cutoff between spheres of two levels, plus a margin for rounding [m].
  double cutoff_between(std::size_t a, std::size_t b) {
    const double cutoff = 0.5 * (grid_.levels()[a].cutoff + grid_.levels()[b].cutoff);
    margin_ = 1e-9 * cutoff + 1e-15 * grid_.scale();
    return cutoff + margin_;
  }

  /// Calls visit(from, to, turn) for the cells that an interval [m] meets: those in the box, and
  /// those of the images at `turn` = -1 or 1. `turn` is `everywhere` if all cells are met.
  static constexpr int everywhere = 2;
  template <class Visit>
  static SILT_INLINE void for_cells(double low, double high, const Frame& frame, int d,
                                    const Visit& visit) {
    const double cells = static_cast<double>(frame.count[d]);
    const double from = std::floor((low - frame.low[d]) * frame.per_length[d]),
                 to = std::floor((high - frame.low[d]) * frame.per_length[d]);
    const auto part = [&](double first, double last, int turn) {
      if (first <= last)
        visit(static_cast<std::size_t>(first), static_cast<std::size_t>(last), turn);
    };
    if (frame.count[d] == 1 || (frame.wraps[d] && to - from + 1 >= cells))
      return part(0, cells - 1, everywhere);
    if (!frame.wraps[d])
      return part(std::clamp(from, 0.0, cells - 1), std::clamp(to, 0.0, cells - 1), 0);
    part(from + cells, std::min(to, -1.0) + cells, -1);
    part(std::max(from, 0.0), std::min(to, cells - 1), 0);
    part(std::max(from, cells) - cells, to - cells, 1);
  }

  /// A few neighbouring spheres of a row.
  struct Block {
    Range spheres;
    Box box;         // [m] around their centres
    double largest;  // [m] radius
  };

  void cut_into_blocks(std::size_t row, std::size_t level) {
    const double longest = level > 0 ? grid_.levels()[level - 1].cutoff : INFINITY;  // [m]
    row_box_ = Box();
    const Range own = grid_.in_row(row);
    for (std::size_t p = own.begin; p < own.end;) {
      const std::size_t first = p;
      Block b{{first, first}, Box(), 0};
      do {
        b.box.include(Vec3d{spheres_.x[p], spheres_.y[p], spheres_.z[p]});
        b.largest = std::max(b.largest, spheres_.r[p]);
        ++p;
      } while (p < own.end && p - first < most_in_block &&
               spheres_.x[p] - spheres_.x[first] < longest);
      b.spheres.end = p;
      row_box_.include(b.box);
      blocks_.push_back(b);
    }
  }

  /// A row of another level; y and z that contain its centres [m].
  struct Strip {
    Range spheres;
    double y_low, y_high, z_low, z_high;
  };

  /// Opens the rows of a level that are nearer than `around` to the current row.
  void open_strips(std::size_t level, double around) {
    const Frame& frame = grid_.levels()[level].frame;
    strips_.clear();
    std::size_t slot = 0;
    auto& cursors = cursors_[level];
    const auto in_layer = [&](std::size_t z, double z_low, double z_high) {
      for_cells(row_box_.min.y - around, row_box_.max.y + around, frame, 1,
                [&](std::size_t from, std::size_t to, int turn) {
                  if (slot == cursors.size()) cursors.push_back(grid_.levels()[level].first_row);
                  std::size_t& cursor = cursors[slot++];
                  cursor = grid_.seek(cursor, grid_.row_key(level, from, z));
                  const std::uint64_t end = grid_.row_key(level, to, z) + 1;
                  for (std::size_t row = cursor; grid_.is_before(row, end); ++row) {
                    const auto [y_low, y_high] = faces(grid_.y_of(row), turn, frame, 1);
                    strips_.push_back({grid_.in_row(row), y_low, y_high, z_low, z_high});
                  }
                });
    };
    for_cells(row_box_.min.z - around, row_box_.max.z + around, frame, 2,
              [&](std::size_t from, std::size_t to, int turn) {
                for (std::size_t z = from; z <= to; ++z) {
                  const auto [z_low, z_high] = faces(z, turn, frame, 2);
                  in_layer(z, z_low, z_high);
                }
              });
  }
  static std::pair<double, double> faces(std::size_t k, int turn, const Frame& frame, int d) {
    if (turn == everywhere) return {-INFINITY, INFINITY};
    const double cell = static_cast<double>(k) + turn * static_cast<double>(frame.count[d]);
    return {frame.low[d] + cell * frame.edge(d), frame.low[d] + (cell + 1) * frame.edge(d)};
  }

  /// Calls visit(first, end, x_end) for the disjoint parts of a strip that may contain spheres
  /// between x = low and high [m]: spheres first ... end-1 that are not beyond x_end.
  template <class Visit>
  SILT_INLINE void for_stretch(const Strip& s, double low, double high, const Visit& visit) {
    const Range all = s.spheres;
    if constexpr (Domain::periodic)
      if (domain_.repeats(0)) {
        const double from = domain_.box().min.x, length = domain_.length(0);
        if (high - low >= length) return visit(all.begin, all.end, double{INFINITY});
        const std::size_t first = grid_.first_from(all, low), end = grid_.first_beyond(all, high);
        visit(first, end, double{INFINITY});
        if (low < from)
          visit(std::max(end, grid_.first_from(all, low + length)), all.end, double{INFINITY});
        if (high > from + length)
          visit(all.begin, std::min(first, grid_.first_beyond(all, high - length)),
                double{INFINITY});
        return;
      }
    visit(grid_.first_from(all, low), all.end, high + grid_.disorder());
  }

  /// Finds the pairs of all spheres of a row with those of a finer level.
  void look_at_fines(std::size_t row, std::size_t level, std::size_t fine) {
    open_strips(fine, cutoff_between(level, fine));
    if (strips_.empty()) return;
    const double further = 0.5 * (grid_.levels()[fine].cutoff + reach_) + margin_;
    const Range own = grid_.in_row(row);
    for (std::size_t p = own.begin; p < own.end; ++p) {
      const double x = spheres_.x[p], y = spheres_.y[p], z = spheres_.z[p];
      const double cutoff = spheres_.r[p] + further, cutoff2 = cutoff * cutoff;
      const Partners partners_of(spheres_, p, reach_, domain_);
      for (const Strip& s : strips_) {
        const double dy = std::max({s.y_low - y, y - s.y_high, 0.0}),
                     dz = std::max({s.z_low - z, z - s.z_high, 0.0});
        const double chord2 = cutoff2 - dy * dy - dz * dz;
        if (!(chord2 > 0)) continue;
        const double half = std::sqrt(chord2) + margin_;
        for_stretch(s, x - half, x + half, [&](std::size_t first, std::size_t end, double x_end) {
          partners_of.sweep(first, end, -INFINITY, x_end, found_);
        });
      }
    }
  }

  /// Finds the pairs of all blocks of a row with spheres of a coarser level.
  void look_at_coarse(std::size_t level, std::size_t coarse) {
    const double around = cutoff_between(level, coarse);
    open_strips(coarse, around);
    for (const Block& b : blocks_)
      for (const Strip& s : strips_)
        for_stretch(s, b.box.min.x - around, b.box.max.x + around,
                    [&](std::size_t first, std::size_t end, double x_end) {
                      meet(b, {first, end}, x_end);
                    });
  }

  /// Pairs of a block's spheres with the coarse spheres of a range, up to about x_end, that reach
  /// its bounding box.
  void meet(const Block& b, Range coarse, double x_end) {
    using Real = typename Lanes<Arch>::Real;
    const Vec3d m = b.box.centre(), h = half_width(b.box);
    const Vec3<Real> centre{Real(m.x), Real(m.y), Real(m.z)}, half{Real(h.x), Real(h.y), Real(h.z)};
    const Real zero(0), further(b.largest + reach_ + margin_);
    for (std::size_t q = coarse.begin; q < coarse.end && spheres_.x[q] <= x_end; q += width) {
      Vec3<Real> d{centre.x - load_any<Real>(spheres_.x.data() + q),
                   centre.y - load_any<Real>(spheres_.y.data() + q),
                   centre.z - load_any<Real>(spheres_.z.data() + q)};
      if constexpr (Domain::periodic) d = domain_.shortest(d);
      const Vec3<Real> out{max(abs(d.x) - half.x, zero), max(abs(d.y) - half.y, zero),
                           max(abs(d.z) - half.z, zero)};
      const Real cutoff = load_any<Real>(spheres_.r.data() + q) + further;
      std::uint64_t bits = lane_bits(dot(out, out) < cutoff * cutoff) &
                           ~std::uint64_t{0} >> (64 - std::min(width, coarse.end - q));
      for (; bits != 0; bits &= bits - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
        const Partners partners_of(spheres_, q + lane, reach_, domain_);
        const std::size_t most = b.spheres.end - b.spheres.begin + width;
        found_.take_up_to(partners_of(b.spheres, found_.room_for(most)));
      }
    }
  }
  /// Half of the box [m]. Infinite if it is so long that the image nearest to its centre may not be
  /// the nearest to all of it.
  Vec3d half_width(const Box& box) const {
    Vec3d h = 0.5 * box.extent();
    if constexpr (Domain::periodic) {
      double* const half[3] = {&h.x, &h.y, &h.z};
      for (int d = 0; d < 3; ++d)
        if (domain_.repeats(d) &&
            2 * *half[d] + grid_.levels()[0].cutoff > 0.49 * domain_.length(d))
          *half[d] = INFINITY;
    }
    return h;
  }

  static constexpr std::size_t most_in_block = 64;  // spheres

  const OccupiedRows& grid_;
  const SphereColumns& spheres_;
  const LevelPlan& plan_;
  double reach_, margin_ = 0;  // [m]
  const Domain& domain_;
  PairBuffer& found_;
  std::size_t cursor_ = 0;            // row of the next layer
  std::array<Range, 4> neighbour_{};  // rows beside, from where they are needed
  int neighbours_ = 0;
  DynArray<Block> blocks_;
  Box row_box_;
  DynArray<Strip> strips_;
  DynArray<DynArray<std::size_t>> cursors_;  // in the rows of each level
};

}  // namespace silt::detail
