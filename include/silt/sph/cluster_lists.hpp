// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <silt/core/box.hpp>
#include <silt/core/compress.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Periodic directions and their lengths [m]; 0: not periodic.
struct Repeats {
  Vec3d low{0, 0, 0}, length{0, 0, 0};
  double along(int d) const { return d == 0 ? length.x : d == 1 ? length.y : length.z; }
  double from(int d) const { return d == 0 ? low.x : d == 1 ? low.y : low.z; }
  /// Shortest image of a distance vector [m].
  Vec3d shortest(Vec3d d) const {
    double* const of[3] = {&d.x, &d.y, &d.z};
    for (int k = 0; k < 3; ++k)
      if (along(k) > 0) *of[k] -= along(k) * std::round(*of[k] / along(k));
    return d;
  }
  Vec3d wrapped(Vec3d p) const {
    double* const of[3] = {&p.x, &p.y, &p.z};
    for (int d = 0; d < 3; ++d)
      if (along(d) > 0) *of[d] -= along(d) * std::floor((*of[d] - from(d)) / along(d));
    return p;
  }
};

/// Particles in packs of `width` neighbours, and for each pack the list of all particles that may
/// be within the kernel's support of one of its particles (the box around a pack has up to half as
/// many again). There are three kinds with separate
/// packs: liquid, which interacts with liquid and walls; walls, and probes (points where the liquid
/// is evaluated), which interact with liquid, and on request with walls.
///
/// Vertical columns, sorted along z, are cut into packs about as high as wide. The lanes of a pack
/// process the particles of its list one by one: each is loaded once for all lanes, nothing is
/// gathered, and sums stay in registers. With packs of 8 and a support of 2.8 spacings half of the
/// lanes process neighbours. Results depend only on positions.
///
/// Tests:   tests/sph/cluster_lists.cpp, against all pairs.
class ClusterLists {
 public:
  /// List entry: the row, and its image.
  struct Entry {
    std::uint32_t packed;
    std::uint32_t row() const { return packed & (most - 1); }
    std::uint32_t image() const { return packed >> bits; }
  };
  static constexpr int bits = 27;
  static constexpr std::uint32_t most = 1u << bits;  // rows
  static constexpr std::uint32_t here = 13;          // image number of the particle itself
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr std::size_t most_width = 16;
  static constexpr std::size_t packs_a_range = 16;  // worth a range of Team::for_ranges

  std::size_t width = 8;  // particles a pack, at most most_width
  double spacing = 0;     // [m] of particles
  int dimensions = 3;     // 2: in x and z
  bool probes_meet_walls = false;
  Repeats repeats;

  enum Kind { Liquid, Wall, Probe, Gone };
  static constexpr int kinds = 3;

  /// Order of the particles, by kind and pack; `none` for empty lanes.
  template <class KindOf>
  const DynArray<std::uint32_t>& sort(std::span<const SphRow> rows, const KindOf& kind,
                                      const Team& team) {
    lay_columns(rows, kind);
    order_.clear();
    for (Group& g : groups_) {
      g.first_row = order_.size();
      sort_columns(g, rows, team);
      const std::size_t columns = g.begin.size() - 1;
      g.start.assign(columns + 1, 0);
      for (std::size_t c = 0; c < columns; ++c) {
        g.start[c] = static_cast<std::uint32_t>(order_.size());
        for (std::size_t k = g.begin[c]; k < g.begin[c + 1]; ++k) order_.push_back(g.sorted[k].row);
        g.count[c] = static_cast<std::uint32_t>(g.begin[c + 1] - g.begin[c]);
        while ((order_.size() - g.first_row) % width != 0) order_.push_back(none);
      }
      g.start[columns] = static_cast<std::uint32_t>(order_.size());
    }
    require(order_.size() < most, "SPH: ", order_.size(), " particles are more than ", most);
    return order_;
  }
  /// First pack of a kind; for Gone: the end of all.
  std::size_t first_pack(int kind) const {
    return (kind < kinds ? groups_[at(kind)].first_row : order_.size()) / width;
  }
  std::size_t packs() const { return order_.size() / width; }

  /// Finds all particles within `reach` [m] of each pack, and some that are beyond by up to 1e-6 of
  /// the space's extent; `rows` are in the order of sort(). With `slack` [m] of each row: all that
  /// can come within reach before one of them has moved by more than its slack.
  void find(std::span<const SphRow> rows, double reach, const Team& team,
            std::span<const double> slack = {}) {
    ++version_;
    const std::size_t n = packs();
    for (auto* const of : {&x_, &y_, &z_, &slack_}) make_room(*of, rows.size());
    for (auto* const of : {&near_x_, &near_y_, &near_z_, &near_slack_})
      make_room(*of, rows.size() + lanes);
    team.for_ranges(rows.size(), [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) {
        x_[k] = rows[k].x, y_[k] = rows[k].y, z_[k] = rows[k].z;
        slack_[k] = slack.empty() ? 0 : slack[k];
        const Near x = near(rows[k].position());
        near_x_[k] = x.x, near_y_[k] = x.y, near_z_[k] = x.z;
        near_slack_[k] = static_cast<float>(slack_[k]);
      }
    });
    const Vec3d e = extent_.extent(), &l = repeats.length;
    reach += 1e-6 * (e.x + e.y + e.z + l.x + l.y + l.z);  // [m] more than floats lose
    for (Group& g : groups_) {
      g.slack.assign(g.count.size(), 0), g.most_slack = 0;
      for (std::size_t c = 0; c < g.count.size(); ++c) {
        for (std::size_t k = g.start[c]; k < g.start[c] + g.count[c]; ++k)
          g.slack[c] = std::max(g.slack[c], slack_[k]);
        g.most_slack = std::max(g.most_slack, g.slack[c]);
      }
    }
    lists_.resize(pieces(n, packs_a_part));
    sees_liquid_.resize(n);
    const std::size_t liquid = first_pack(Wall), probes = first_pack(Probe);
    team.for_parts(lists_.size(), [&](std::size_t part) {
      List& list = lists_[part];
      list.entries.clear(), list.begin.clear();
      const std::size_t from = part * packs_a_part, to = std::min(n, from + packs_a_part);
      for (std::size_t p = from; p < to; ++p) {
        list.begin.push_back(list.entries.size());
        find_of(groups_[Liquid], rows, p, reach, list.entries);
        sees_liquid_[p] = list.entries.size() > list.begin.back();
        list.begin.push_back(list.entries.size());
        if (p < liquid || (probes_meet_walls && p >= probes))
          find_of(groups_[Wall], rows, p, reach, list.entries);
      }
      list.begin.push_back(list.entries.size());
    });
  }
  /// Liquid and walls in the list of a pack.
  std::span<const Entry> liquid(std::size_t pack) const { return of(pack, 0); }
  std::span<const Entry> walls(std::size_t pack) const { return of(pack, 1); }
  /// Whether there is liquid in it: from a table that stays in the cache.
  bool sees_liquid(std::size_t pack) const { return sees_liquid_[pack] != 0; }
  /// Changes when the lists do; > 0 with lists.
  std::uint64_t version() const { return version_; }
  /// Extent of the particles at the last sort().
  const Box& extent() const { return extent_; }
  /// Position [m] of a row when the lists were built.
  Vec3d built(std::size_t row) const { return {x_[row], y_[row], z_[row]}; }
  double slack(std::size_t row) const { return slack_[row]; }  // [m]
  /// Whether the lists are still valid for a row at `now`.
  bool hold(std::size_t row, const Vec3d& now) const {
    const Vec3d way = now - built(row);
    return dot(way, way) <= slack_[row] * slack_[row];
  }
  Vec3d shift(std::uint32_t image) const {
    const int i = static_cast<int>(image);
    return {(i % 3 - 1) * repeats.length.x, (i / 3 % 3 - 1) * repeats.length.y,
            (i / 9 - 1) * repeats.length.z};
  }
  std::size_t bytes() const {
    std::size_t all = order_.capacity() * sizeof(std::uint32_t);
    for (const List& l : lists_)
      all += l.entries.capacity() * sizeof(Entry) + l.begin.capacity() * sizeof(std::size_t);
    return all;
  }

 private:
  static constexpr std::size_t packs_a_part = 64, room = 2048;
  // Distances are compared in floats, from the lowest corner of all particles on.
  using Real = Lanes<DefaultArch, float>::Real;
  using Near = Vec3<float>;
  static constexpr std::size_t lanes = Lanes<DefaultArch, float>::width;
  struct Key {
    double z;
    std::uint32_t row;
  };
  struct Group {
    std::size_t first_row = 0;
    DynArray<std::size_t> begin;    // of each column in `sorted`
    DynArray<Key> sorted;           // along z
    DynArray<std::uint32_t> start;  // first row of each column, in the new order
    DynArray<std::uint32_t> count;
    DynArray<double> slack;  // [m] largest of each column
    double most_slack = 0;
  };
  struct List {
    DynArray<Entry> entries;
    DynArray<std::size_t> begin;  // two per pack: liquid, walls
  };

  /// The particles of a pack, and how far each sees [m].
  class Members {
   public:
    Members(const ClusterLists& of, std::span<const SphRow> rows, std::size_t pack, double reach,
            const Vec3d& away) {
      for (std::size_t l = 0; l < of.width; ++l) {
        const std::size_t k = pack * of.width + l;
        if (!rows[k].is_there()) continue;
        const Near x = of.near(rows[k].position() - away);
        x_[count_] = x.x, y_[count_] = x.y, z_[count_] = x.z;
        reach_[count_++] = static_cast<float>(reach + of.slack_[k]);
      }
      for (; count_ % lanes != 0; ++count_)  // the first one again
        x_[count_] = x_[0], y_[count_] = y_[0], z_[count_] = z_[0], reach_[count_] = reach_[0];
    }
    /// Whether one of them sees a particle with this slack [m].
    SILT_INLINE bool see(float x, float y, float z, float slack) const {
      for (std::size_t k = 0; k < count_; k += lanes) {
        const Real dx = load<Real>(x_ + k) - Real(x), dy = load<Real>(y_ + k) - Real(y),
                   dz = load<Real>(z_ + k) - Real(z), within = load<Real>(reach_ + k) + Real(slack);
        if (lane_bits(dx * dx + dy * dy + dz * dz < within * within) != 0) return true;
      }
      return false;
    }

   private:
    alignas(64) float x_[most_width], y_[most_width], z_[most_width], reach_[most_width];
    std::size_t count_ = 0;
  };

  Near near(const Vec3d& x) const {
    return {static_cast<float>(x.x - extent_.min.x), static_cast<float>(x.y - extent_.min.y),
            static_cast<float>(x.z - extent_.min.z)};
  }
  std::span<const Entry> of(std::size_t pack, std::size_t which) const {
    const List& list = lists_[pack / packs_a_part];
    const std::size_t k = 2 * (pack % packs_a_part) + which;
    return {list.entries.data() + list.begin[k], list.begin[k + 1] - list.begin[k]};
  }

  template <class KindOf>
  void lay_columns(std::span<const SphRow> rows, const KindOf& kind) {
    Box all;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (kind(k) != Gone) all.include(rows[k].position());
    if (!is_finite(all.min)) all = {{0, 0, 0}, {0, 0, 0}};
    extent_ = all;
    const double w = spacing * (dimensions == 2 ? std::sqrt(static_cast<double>(width))
                                                : std::cbrt(static_cast<double>(width)));
    for (int d = 0; d < 2; ++d) {
      const double low = d == 0 ? all.min.x : all.min.y, high = d == 0 ? all.max.x : all.max.y;
      const bool round = repeats.along(d) > 0;
      low_[at(d)] = round ? repeats.from(d) : low;
      const double length = round ? repeats.along(d) : high - low;
      const double across = length / w;
      require(across < 1e7, "SPH: particles are spread over ", length, " m, ", across,
              " columns of ", w, " m; some have been thrown far off");
      int n = std::max(1, round ? static_cast<int>(across) : static_cast<int>(across) + 1);
      if (dimensions == 2 && d == 1) n = 1;
      columns_[at(d)] = n;
      size_[at(d)] = round ? length / n : w;
    }
    const std::size_t columns =
        static_cast<std::size_t>(columns_[0]) * static_cast<std::size_t>(columns_[1]);
    for (int g = 0; g < kinds; ++g) {
      groups_[at(g)].begin.assign(columns + 1, 0);
      groups_[at(g)].count.assign(columns, 0);
    }
    column_.resize(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const int g = kind(k);
      if (g == Gone) continue;
      column_[k] = column_of(rows[k]);
      ++groups_[at(g)].begin[column_[k] + 1];
    }
    for (Group& g : groups_) {
      for (std::size_t c = 0; c < columns; ++c) g.begin[c + 1] += g.begin[c];
      g.sorted.resize(g.begin[columns]);
    }
    std::array<DynArray<std::size_t>, kinds> next;
    for (int g = 0; g < kinds; ++g) next[at(g)] = groups_[at(g)].begin;
    for (std::size_t k = 0; k < rows.size(); ++k)
      if (const int g = kind(k); g != Gone)
        groups_[at(g)].sorted[next[at(g)][column_[k]]++] = {rows[k].z,
                                                            static_cast<std::uint32_t>(k)};
  }
  std::size_t column_of(const SphRow& r) const {
    const auto place = [&](double x, int d) {
      const int n = columns_[at(d)];
      return std::clamp(static_cast<int>((x - low_[at(d)]) / size_[at(d)]), 0, n - 1);
    };
    const int i = place(r.x, 0), j = columns_[1] == 1 ? 0 : place(r.y, 1);
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(columns_[1]) +
           static_cast<std::size_t>(j);
  }
  static void sort_columns(Group& g, std::span<const SphRow>, const Team& team) {
    team.for_ranges(g.begin.size() - 1, 16, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t c = from; c < to; ++c)
        std::sort(
            g.sorted.begin() + static_cast<std::ptrdiff_t>(g.begin[c]),
            g.sorted.begin() + static_cast<std::ptrdiff_t>(g.begin[c + 1]),
            [](const Key& a, const Key& b) { return a.z < b.z || (a.z == b.z && a.row < b.row); });
    });
  }

  /// Adds the particles of a group that are near a pack.
  void find_of(const Group& g, std::span<const SphRow> rows, std::size_t pack, double reach,
               DynArray<Entry>& out) const {
    Box box;
    double slack = 0;
    for (std::size_t l = 0; l < width; ++l)
      if (const SphRow& r = rows[pack * width + l]; r.is_there())
        box.include(r.position()), slack = std::max(slack, slack_[pack * width + l]);
    if (!is_finite(box.min) || g.sorted.empty()) return;
    const double own = reach + slack, far = own + g.most_slack;
    const auto [left, right] = images(0, box.min.x - far, box.max.x + far);
    const auto [front, back] = images(1, box.min.y - far, box.max.y + far);
    const auto [below, above] = images(2, box.min.z - far, box.max.z + far);
    for (int a = left; a <= right; ++a)
      for (int b = front; b <= back; ++b)
        for (int c = below; c <= above; ++c) {
          const Vec3d way{a * repeats.length.x, b * repeats.length.y, c * repeats.length.z};
          const auto image = static_cast<std::uint32_t>(a + 1 + 3 * (b + 1) + 9 * (c + 1));
          const Box seen{box.min - way, box.max - way};
          const Members members(*this, rows, pack, reach, way);
          find_in(g, seen, members, own, image << bits, out);
        }
  }
  /// Range of images in a direction that may reach into an interval.
  std::pair<int, int> images(int d, double low, double high) const {
    if (!(repeats.along(d) > 0)) return {0, 0};
    return {low < repeats.from(d) ? -1 : 0, high > repeats.from(d) + repeats.along(d) ? 1 : 0};
  }
  /// `own` [m]: reach of the pack, to which the slack of each other particle is added.
  void find_in(const Group& g, const Box& box, const Members& members, double own,
               std::uint32_t image, DynArray<Entry>& out) const {
    const double reach = own + g.most_slack;
    const auto range = [&](int d, double low, double high) {
      const int n = columns_[at(d)];
      const double a = (low - low_[at(d)]) / size_[at(d)], b = (high - low_[at(d)]) / size_[at(d)];
      return std::pair{static_cast<int>(std::clamp(a, 0.0, n - 1.0)),
                       static_cast<int>(std::clamp(b, 0.0, n - 1.0))};
    };
    // [m] distance of the box to a column, rounded down: column indices come from rounded numbers.
    const auto beside = [&](int d, int k, double low, double high) {
      if (columns_[at(d)] == 1) return 0.0;
      const double from = low_[at(d)] + k * size_[at(d)];
      return std::max(0.0, std::max(low - from - size_[at(d)], from - high) - 1e-6 * size_[at(d)]);
    };
    const auto [i0, i1] = range(0, box.min.x - reach, box.max.x + reach);
    const auto [j0, j1] =
        columns_[1] == 1 ? std::pair{0, 0} : range(1, box.min.y - reach, box.max.y + reach);
    const Near first = near(box.min), last = near(box.max);
    const Vec3<Real> from{Real(first.x), Real(first.y), Real(first.z)},
        to{Real(last.x), Real(last.y), Real(last.z)};
    std::uint32_t found[room + 16], *next = found;
    for (int i = i0; i <= i1; ++i)
      for (int j = j0; j <= j1; ++j) {
        const std::size_t c = static_cast<std::size_t>(i) * static_cast<std::size_t>(columns_[1]) +
                              static_cast<std::size_t>(j);
        if (g.count[c] == 0) continue;
        const double x = beside(0, i, box.min.x, box.max.x), y = beside(1, j, box.min.y, box.max.y),
                     far = own + g.slack[c], left = far * far - x * x - y * y;
        if (!(left > 0)) continue;
        const auto up = static_cast<float>(std::sqrt(left));
        const float low = first.z - up, high = last.z + up;
        const std::size_t end = g.start[c] + g.count[c];
        const auto* const z = near_z_.data();
        std::size_t k =
            static_cast<std::size_t>(std::lower_bound(z + g.start[c], z + end, low) - z);
        for (; k < end && z[k] <= high; k += lanes) {
          const Real dx = outside(load_any<Real>(&near_x_[k]), from.x, to.x),
                     dy = outside(load_any<Real>(&near_y_[k]), from.y, to.y),
                     dz = outside(load_any<Real>(&z[k]), from.z, to.z);
          const Real within = Real(static_cast<float>(own)) + load_any<Real>(&near_slack_[k]);
          std::uint64_t seen = lane_bits(dx * dx + dy * dy + dz * dz < within * within);
          if (end - k < lanes) seen &= (std::uint64_t{1} << (end - k)) - 1;
          next = put_places<lanes>(k, seen, next);
          if (next > found + room) take(found, next, members, image, out), next = found;
        }
      }
    take(found, next, members, image, out);
  }
  /// Takes those of what is near the box that are near a particle in it.
  void take(const std::uint32_t* from, const std::uint32_t* to, const Members& members,
            std::uint32_t image, DynArray<Entry>& out) const {
    for (; from != to; ++from)
      if (members.see(near_x_[*from], near_y_[*from], near_z_[*from], near_slack_[*from]))
        out.push_back({*from | image});
  }
  static SILT_INLINE Real outside(const Real& x, const Real& low, const Real& high) {
    return max(max(low - x, x - high), Real(0));
  }
  static std::size_t at(int d) { return static_cast<std::size_t>(d); }

  std::uint64_t version_ = 0;
  std::array<Group, kinds> groups_;
  Box extent_{{0, 0, 0}, {0, 0, 0}};
  DynArray<std::size_t> column_;
  std::array<double, 2> low_{}, size_{};
  std::array<int, 2> columns_{};
  DynArray<std::uint32_t> order_;
  DynArray<List> lists_;
  DynArray<std::uint8_t> sees_liquid_;       // by pack
  AlignedVector<double> x_, y_, z_, slack_;  // [m] of rows
  AlignedVector<float> near_x_, near_y_, near_z_, near_slack_;
};

}  // namespace silt::detail
