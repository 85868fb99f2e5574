// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/state/columns.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Values serialised one after the other as bytes, for messages between ranks of one program.
class Packed {
 public:
  template <class T>
  requires(std::is_trivially_copyable_v<T>) void put(const T& value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  DynArray<std::byte> bytes_;
};

class Unpacked {
 public:
  explicit Unpacked(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_ = bytes_.subspan(sizeof(T));
    return value;
  }
  bool done() const { return bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
};

/// Appends one row of a table, all columns.
template <class Table>
void pack_row(Table& table, std::size_t k, Packed& out) {
  for_each_column(table, [&](const auto&, auto& values) { out.put(values[k]); });
}
/// Reads a row and appends it to the table.
template <class Table>
void unpack_row(Table& table, Unpacked& in) {
  for_each_column(table, [&](const auto& c, auto& values) {
    values.push_back(in.get<typename std::remove_cvref_t<decltype(c)>::Value>());
  });
}

}  // namespace silt::detail
