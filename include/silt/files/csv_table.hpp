// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>

namespace silt::inline SILT_TARGET {

/// Table of numbers as a CSV file that grows row by row. Each number is written in the shortest
/// form that reads back exactly. A row is passed to the system at once: a killed run keeps all of
/// its rows. If a row does not fit on the disk, no part of it remains.
///
///   silt::CsvTable energy{"out/energy.csv", {"time [s]", "kinetic [J]"}};
///   energy.add_row({t, e});
///
/// Creates its folder.
/// Errors: InputError for unusable column names or a row of another length; FileError if the file
/// cannot be written or, in `resume`, is not such a table.
class CsvTable {
 public:
  /// A new table; replaces an existing one.
  CsvTable(const std::string& path, const DynArray<std::string>& columns)
      : CsvTable(path, columns.size(), header(path, columns)) {}

  /// Continues a table after a restart: keeps the rows whose first number is at most `limit` (the
  /// time of the restart), and drops later ones and an incomplete last row. Without a file it
  /// starts a new table. The first numbers of the rows must be finite and must not decrease, as
  /// times do; they determine which rows are kept.
  static CsvTable resume(const std::string& path, const DynArray<std::string>& columns,
                         double limit) {
    std::string content = header(path, columns);
    const std::size_t rows = content.size();
    if (detail::file_exists(path)) content += rows_up_to(path, content, columns.size(), limit);
    CsvTable table(path, columns.size(), content);
    if (content.size() > rows) table.kept_ = last_row(content, columns.size());
    return table;
  }
  /// The last row that `resume` kept; empty if there is none.
  const DynArray<double>& kept_row() const { return kept_; }

  void add_row(std::span<const double> row) {
    require(row.size() == columns_, "CsvTable '", file_.name(), "': a row of ", row.size(),
            row.size() == 1 ? " number, but the table has " : " numbers, but the table has ",
            columns_, columns_ == 1 ? " column" : " columns");
    line_.clear();
    for (const double number : row) {
      if (!line_.empty()) line_ += ',';
      detail::append(line_, number);
    }
    line_ += '\n';
    try {
      file_.write(line_.data(), line_.size());
    } catch (const FileError&) {
      file_.truncate(bytes_);
      throw;
    }
    bytes_ += line_.size();
  }
  void add_row(std::initializer_list<double> row) {
    add_row(std::span<const double>(row.begin(), row.size()));
  }

  /// The first line of such a table. InputError for unusable column names.
  static std::string header(const std::string& path, const DynArray<std::string>& columns) {
    require(!columns.empty(), "CsvTable '", path, "': there are no columns");
    std::string line;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto& name = columns[k];
      require(!name.empty(), "CsvTable '", path, "': the name of column ", k, " is empty");
      require(name.find_first_of(",\"") == std::string::npos &&
                  std::none_of(name.begin(), name.end(),
                               [](unsigned char c) { return c < 32 || c == 127; }),
              "CsvTable '", path, "': the column name ", in_quotes(name),
              " must not contain commas, quotes or control characters");
      for (std::size_t other = 0; other < k; ++other)
        require(columns[other] != name, "CsvTable '", path, "': there are two columns named ",
                in_quotes(name));
      if (k > 0) line += ',';
      line += name;
    }
    return line += '\n';
  }

 private:
  CsvTable(const std::string& path, std::size_t columns, const std::string& content)
      : columns_(columns), bytes_(content.size()), file_(opened(path, content)) {}

  static detail::File opened(const std::string& path, const std::string& content) {
    make_folder_of(path);
    AtomicFile start(path);
    start.write(content);
    start.commit();
    return {path, O_WRONLY | O_APPEND, path};
  }

  static std::string rows_up_to(const std::string& path, std::string_view header_line,
                                std::size_t columns, double limit) {
    const std::string content = detail::read_text(path);
    std::string_view rest = content;
    if (!rest.starts_with(header_line))
      throw FileError(text("table '", path, "' cannot be continued: its first line is ",
                           in_quotes(rest.substr(0, rest.find('\n'))), ", but the columns are ",
                           in_quotes(header_line.substr(0, header_line.size() - 1))));
    rest.remove_prefix(header_line.size());
    std::string kept;
    std::size_t line = 2;
    double before = -std::numeric_limits<double>::infinity();
    for (std::size_t end; (end = rest.find('\n')) != std::string_view::npos; ++line) {
      const double first = first_number(path, line, rest.substr(0, end), columns);
      if (!std::isfinite(first) || first < before)
        throw FileError(text("table '", path, "' line ", line, " begins with ", first,
                             std::isfinite(first)
                                 ? text(", less than the ", before, " of the line above")
                                 : std::string(", which is not a time"),
                             "; correct or remove the table"));
      if (first <= limit) kept += rest.substr(0, end + 1);
      before = first;
      rest.remove_prefix(end + 1);
    }
    return kept;
  }

  /// First number of a row; FileError unless the row is `columns` numbers separated by commas.
  static double first_number(const std::string& path, std::size_t line, std::string_view row,
                             std::size_t columns) {
    const char* at = row.data();
    const char* const end = at + row.size();
    double first = 0, number = 0;
    for (std::size_t k = 0; k < columns; ++k) {
      const auto [after, error] = std::from_chars(at, end, number);
      const bool last = k + 1 == columns;
      if (error != std::errc{} || (last ? after != end : after == end || *after != ','))
        throw FileError(text("table '", path, "' line ", line, " is not ", columns,
                             " numbers with commas between: ", in_quotes(row)));
      if (k == 0) first = number;
      at = after + (last ? 0 : 1);
    }
    return first;
  }

  static DynArray<double> last_row(std::string_view content, std::size_t columns) {
    content.remove_suffix(1);
    content.remove_prefix(content.rfind('\n') + 1);
    DynArray<double> row(columns);
    for (double& number : row) {
      const char* const after =
          std::from_chars(content.data(), content.data() + content.size(), number).ptr;
      const auto read = static_cast<std::size_t>(after - content.data());
      content.remove_prefix(std::min(read + 1, content.size()));
    }
    return row;
  }

  std::size_t columns_;
  DynArray<double> kept_;
  std::uint64_t bytes_;  // [bytes] the header and all complete rows
  detail::File file_;
  std::string line_;
};

namespace detail {

/// Forms of a row: a single number, or an array or vector of double.
template <class Row>
auto row_of(Row row) {
  if constexpr (std::is_arithmetic_v<Row>) {
    return std::array<double, 1>{static_cast<double>(row)};
  } else {
    static_assert(std::is_constructible_v<std::span<const double>, const Row&>,
                  "table: the function must return the numbers of a row: one number, or a "
                  "std::array or std::vector of double");
    return row;
  }
}

/// Writes a whole table at once; it is complete or absent.
template <class Rows>
void write_csv(const std::string& path, const DynArray<std::string>& columns, const Rows& rows) {
  std::string all;
  for (const auto& name : columns) all += (all.empty() ? "" : ",") + name;
  all += '\n';
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k > 0) all += ',';
      append(all, row[k]);
    }
    all += '\n';
  }
  AtomicFile out(path);
  out.write(all);
  out.commit();
}

}  // namespace detail
}  // namespace silt
