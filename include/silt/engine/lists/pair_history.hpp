// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <silt/core/storage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Which values of a history are stored in rows: the first `first` of them, and the next `more` in
/// separate rows.
struct HistoryRows {
  std::size_t first = 0, more = 0;
};

/// H history values for each place of a list. Some of them are stored in rows (place by place), for
/// loops that access scattered places; the others, the last ones, in columns (value by value), for
/// loops over all places. The second rows are allocated only while they are used; else their values
/// are 0.
template <std::size_t H, class Scalar, HistoryRows InRows>
class PairHistory {
  static constexpr std::size_t first = InRows.first, in_rows = InRows.first + InRows.more;
  static_assert(in_rows <= H);
  static constexpr std::size_t rows_of_four(std::size_t n) { return (n + 3) / 4 * 4; }

 public:
  static constexpr std::size_t width = rows_of_four(first), more_width = rows_of_four(InRows.more);

  Scalar* column(std::size_t h) { return columns_[h - in_rows].data(); }
  const Scalar* column(std::size_t h) const { return columns_[h - in_rows].data(); }
  Scalar* row(std::size_t place) { return rows_.data() + place * width; }
  const Scalar* row(std::size_t place) const { return rows_.data() + place * width; }
  Scalar* more_row(std::size_t place) { return more_.data() + place * more_width; }
  const Scalar* more_row(std::size_t place) const { return more_.data() + place * more_width; }

  /// Allocates the second rows, all 0, or releases them.
  void use_more([[maybe_unused]] bool yes) {
    if constexpr (InRows.more > 0) {
      if (yes == uses_more_) return;
      uses_more_ = yes;
      more_.clear();
      if (yes) more_.resize(rows_.size() / width * more_width, 0);
    }
  }

  Scalar at(std::size_t h, std::size_t place) const {
    if (h < first) return row(place)[h];
    if (h < in_rows) return uses_more_ ? more_row(place)[h - first] : Scalar(0);
    return column(h)[place];
  }
  std::array<Scalar, H> values(std::size_t place) const {
    std::array<Scalar, H> v{};
    for (std::size_t h = 0; h < H; ++h) v[h] = at(h, place);
    return v;
  }
  void set(std::size_t place, const std::array<Scalar, H>& values) {
    for (std::size_t h = 0; h < width; ++h) row(place)[h] = h < first ? values[h] : 0;
    if (uses_more_)
      for (std::size_t h = 0; h < more_width; ++h)
        more_row(place)[h] = first + h < in_rows ? values[first + h] : 0;
    for (std::size_t h = in_rows; h < H; ++h) column(h)[place] = values[h];
  }
  /// As set(), with the values of another history, or zeros.
  void copy(std::size_t place, const PairHistory* from, std::size_t from_place) {
    if constexpr (first > 0)
      for (std::size_t h = 0; h < width; ++h) row(place)[h] = from ? from->row(from_place)[h] : 0;
    if (uses_more_) {
      const bool known = from && from->uses_more_;
      for (std::size_t h = 0; h < more_width; ++h)
        more_row(place)[h] = known ? from->more_row(from_place)[h] : 0;
    }
    for (std::size_t h = in_rows; h < H; ++h)
      column(h)[place] = from ? from->column(h)[from_place] : 0;
  }
  void clear(std::size_t place) { copy(place, nullptr, 0); }
  bool remembers(std::size_t place) const {
    for (std::size_t h = 0; h < H; ++h)
      if (at(h, place) != 0) return true;
    return false;
  }

  void clear() {
    rows_.clear(), more_.clear();
    for (auto& c : columns_) c.clear();
  }
  void resize(std::size_t places) {
    make_room(rows_, places * width);
    if (uses_more_) make_room(more_, places * more_width);
    for (auto& c : columns_) make_room(c, places);
  }
  /// As resize(), keeping the present values.
  void extend(std::size_t places) {
    rows_.resize(places * width, 0);
    if (uses_more_) more_.resize(places * more_width, 0);
    for (auto& c : columns_) c.resize(places, 0);
  }
  std::size_t bytes_per_place() const {
    return (width + (uses_more_ ? more_width : 0) + H - in_rows) * sizeof(Scalar);
  }
  bool uses_more() const { return uses_more_; }

 private:
  AlignedVector<Scalar> rows_, more_;
  bool uses_more_ = false;
  std::array<AlignedVector<Scalar>, H - in_rows> columns_;
};

}  // namespace silt::detail
