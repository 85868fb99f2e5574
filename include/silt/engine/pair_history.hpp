// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cstddef>

#include <silt/core/storage.hpp>

namespace silt::inline SILT_TARGET::detail {

/// H numbers for each place of a list. The first `InRows` of them stand in rows, place by place,
/// for loops that take some places here and there; the others in columns, number by number, for
/// loops that take all in turn.
template <std::size_t H, class Scalar, std::size_t InRows>
class PairHistory {
  static_assert(InRows <= H);

 public:
  static constexpr std::size_t width = (InRows + 3) / 4 * 4;  // of a row: whole rows of four

  Scalar* column(std::size_t h) { return columns_[h - InRows].data(); }
  const Scalar* column(std::size_t h) const { return columns_[h - InRows].data(); }
  Scalar* row(std::size_t place) { return rows_.data() + place * width; }
  const Scalar* row(std::size_t place) const { return rows_.data() + place * width; }

  Scalar at(std::size_t h, std::size_t place) const {
    return h < InRows ? row(place)[h] : column(h)[place];
  }
  std::array<Scalar, H> values(std::size_t place) const {
    std::array<Scalar, H> v{};
    for (std::size_t h = 0; h < H; ++h) v[h] = at(h, place);
    return v;
  }
  void set(std::size_t place, const std::array<Scalar, H>& values) {
    for (std::size_t h = 0; h < InRows; ++h) row(place)[h] = values[h];
    for (std::size_t h = InRows; h < width; ++h) row(place)[h] = 0;
    for (std::size_t h = InRows; h < H; ++h) column(h)[place] = values[h];
  }
  /// As set(), with numbers of another history, or zeros.
  void copy(std::size_t place, const PairHistory* from, std::size_t from_place) {
    if constexpr (InRows > 0)
      for (std::size_t h = 0; h < width; ++h) row(place)[h] = from ? from->row(from_place)[h] : 0;
    for (std::size_t h = InRows; h < H; ++h)
      column(h)[place] = from ? from->column(h)[from_place] : 0;
  }
  void clear(std::size_t place) { copy(place, nullptr, 0); }
  bool remembers(std::size_t place) const {
    for (std::size_t h = 0; h < H; ++h)
      if (at(h, place) != 0) return true;
    return false;
  }

  void clear() {
    rows_.clear();
    for (auto& c : columns_) c.clear();
  }
  void resize(std::size_t places) {
    make_room(rows_, places * width);
    for (auto& c : columns_) make_room(c, places);
  }

 private:
  AlignedVector<Scalar> rows_;
  std::array<AlignedVector<Scalar>, H - InRows> columns_;
};

}  // namespace silt::detail
