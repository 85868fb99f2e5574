// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>

/// State is stored in tables of columns, each with one row per particle (or part of a body). A
/// table declares its columns once, in columns(). Adding, sorting, removing and copying rows,
/// checkpoints and the memory per particle are derived from that declaration.
///
///   struct Charges {
///     DynArray<double> charge;  // [C]
///     static constexpr auto columns() {
///       return std::tuple{column("charge", [](auto& t) -> auto& { return t.charge; })};
///     }
///   };

namespace silt::inline SILT_TARGET::detail {

/// The name of a column in checkpoints: a plain name, or one with a number ("module2.fields").
struct ColumnName {
  const char* before;
  int number = -1;
  const char* after = "";
  constexpr ColumnName(const char* name) : before(name) {}
  constexpr ColumnName(const char* b, std::size_t n, const char* a)
      : before(b), number(static_cast<int>(n)), after(a) {}
  std::string text() const { return number < 0 ? before : before + std::to_string(number) + after; }
};

/// `at(table)` is the vector that holds the values.
template <class At, class T>
struct Column {
  using Value = T;
  ColumnName name;
  At at;
  T start;   // of a new row
  T parked;  // of a row whose particle has left
};
/// A column of a table with values of type T.
template <class T, class At>
constexpr Column<At, T> column(ColumnName name, At at, const T& start = {}, const T& parked = {}) {
  return {name, at, start, parked};
}
/// The tuple of columns that make() returns if a table has them; else an empty one.
template <bool Has, class Make>
constexpr auto columns_if(const Make& make) {
  if constexpr (Has)
    return make();
  else
    return std::tuple<>{};
}

template <class Table>
concept HasColumns = requires {
  Table::columns();
};

/// Calls visit(declaration, values) for each column of a table.
template <class Table, class Visit>
void for_each_column(Table& table, const Visit& visit) {
  if constexpr (HasColumns<std::remove_const_t<Table>>)
    std::apply([&](const auto&... c) { (visit(c, c.at(table)), ...); },
               std::remove_const_t<Table>::columns());
}
template <class... Columns>
constexpr std::size_t bytes_of_columns(std::type_identity<std::tuple<Columns...>>) {
  return (std::size_t{0} + ... + sizeof(typename Columns::Value));
}
/// Bytes of one row.
template <HasColumns Table>
constexpr std::size_t bytes_of_row() {
  return bytes_of_columns(std::type_identity<decltype(Table::columns())>{});
}

template <class Table>
void add_row(Table& table) {
  for_each_column(table, [](const auto& c, auto& values) { values.push_back(c.start); });
}
template <class Table>
void park_row(Table& table, std::size_t k) {
  for_each_column(table, [k](const auto& c, auto& values) { values[k] = c.parked; });
}
template <class Table>
void copy_row(Table& table, std::size_t from, std::size_t to) {
  for_each_column(table, [&](const auto&, auto& values) { values[to] = values[from]; });
}
/// values[k] = what was values[order[k]].
template <class V>
void gather(V& values, std::span<const std::uint32_t> order, const Team& team) {
  V sorted(order.size());
  team.for_ranges(order.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) sorted[k] = values[order[k]];
  });
  values.swap(sorted);
}
/// Moves row order[k] to place k; rows not in `order` are dropped.
template <class Table>
void gather_rows(Table& table, std::span<const std::uint32_t> order, const Team& team) {
  for_each_column(table, [&](const auto&, auto& values) { gather(values, order, team); });
}

}  // namespace silt::detail
