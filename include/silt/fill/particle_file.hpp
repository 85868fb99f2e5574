// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/text_lines.hpp>

namespace silt::inline SILT_TARGET {

/// Particles read from or written to a text table. Position and radius have one entry per particle;
/// other columns too, or none if the file has no such column.
struct ParticleTable {
  DynArray<Vec3d> position;          // [m]
  DynArray<double> radius;           // [m]
  DynArray<double> density;          // [kg/m3]
  DynArray<Vec3d> velocity;          // [m/s]
  DynArray<Vec3d> angular_velocity;  // [rad/s]
  DynArray<std::uint32_t> material;  // [-] number of the material, from 0
  std::size_t size() const { return position.size(); }
};

namespace detail {

/// Reads one table; knows its position, which every refusal reports as file, line and column.
class ParticleReader {
 public:
  ParticleReader(const std::string& path, std::string_view content) : path_(path), rest_(content) {}

  ParticleTable read() {
    std::string_view line;
    if (!next_line(line))
      throw FileError(text("file '", path_, "' is empty; it needs a line ", expected));
    read_header(line);
    ParticleTable table;
    std::array<double, column_count> row{};
    while (next_line(line)) {
      read_row(line, row);
      append(table, row);
    }
    if (table.size() == 0)
      throw FileError(text("file '", path_, "' has a header but no particles"));
    return table;
  }

 private:
  enum Column {
    X,
    Y,
    Z,
    Radius,
    Diameter,
    Density,
    Vx,
    Vy,
    Vz,
    Wx,
    Wy,
    Wz,
    Material,
    column_count,
    Skipped = column_count  // of a table by write_particle_csv
  };
  static constexpr std::array<std::string_view, column_count> column_names{
      "x",  "y",  "z",  "radius", "diameter", "density", "vx",
      "vy", "vz", "wx", "wy",     "wz",       "material"};
  static constexpr std::array<std::string_view, column_count> units{
      "m", "m", "m", "m", "m", "kg/m3", "m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s", "-"};
  static constexpr std::string_view of_csv =
      "id,x,y,z,velocity x,velocity y,velocity z,radius,material";
  static constexpr std::string_view of_csv_spin =
      ",angular velocity x,angular velocity y,angular velocity z";
  static constexpr std::string_view expected =
      "that names its columns, among: x y z, radius or diameter, and optionally density, vx vy vz, "
      "wx wy wz, material";

  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    throw FileError(text("file '", path_, "', line ", line_number_, ": ", parts...));
  }

  /// Next line that is not blank or only a comment.
  bool next_line(std::string_view& line) {
    while (!rest_.empty()) {
      const auto end = std::min(rest_.find('\n'), rest_.size());
      line = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++line_number_;
      comments_ = comments_ || line.find('#') != line.npos;
      line = trimmed(line.substr(0, std::min(line.find('#'), line.size())));
      if (!line.empty()) return true;
    }
    return false;
  }

  /// Takes the next value off `line`, which becomes null after the last one; then false.
  bool next_value(std::string_view& line, std::string_view& value) const {
    if (line.data() == nullptr) return false;
    std::size_t end = 0;
    while (end < line.size() && (separator_ ? line[end] != separator_ : !is_blank(line[end])))
      ++end;
    value = trimmed(line.substr(0, end));
    if (end == line.size()) {
      line = {};
    } else {
      line.remove_prefix(end + 1);
      if (!separator_) line = trimmed(line);
    }
    return true;
  }

  void read_header(std::string_view line) {
    if (line.find(',') != line.npos) separator_ = ',';
    if (line.find(';') != line.npos) separator_ = ';';
    std::string_view name;
    if (line.starts_with(of_csv)) return read_csv_header(line);
    while (next_value(line, name)) {
      const auto unit = name.substr(std::min(name.find('['), name.size()));
      name = trimmed(name.substr(0, name.size() - unit.size()));
      if (name.empty() && !unit.empty() && !columns_.empty()) {  // `x [m]` in a table with blanks
        check_unit(columns_.back(), unit);
        continue;
      }
      const auto known = std::find(column_names.begin(), column_names.end(), name);
      if (known == column_names.end())
        fail(in_quotes(name),
             " is not a column name; the first line that is not a comment must be one ", expected,
             comments_ ? "; a header that begins with '#' is a comment" : "");
      const auto column = static_cast<Column>(known - column_names.begin());
      if (has_[column]) fail("column '", name, "' is named twice");
      has_[column] = true;
      columns_.push_back(column);
      if (!unit.empty()) check_unit(column, unit);
    }
    if (has_[Radius] && has_[Diameter]) fail("give either 'radius' or 'diameter', not both");
    if (!has_[Radius] && !has_[Diameter]) fail("the column 'radius' or 'diameter' is missing");
    need_all_of(X, true);
    need_all_of(Vx, has_[Vx] || has_[Vy] || has_[Vz]);
    need_all_of(Wx, has_[Wx] || has_[Wy] || has_[Wz]);
  }

  /// FileError unless `unit` is the column's own in brackets.
  void check_unit(Column column, std::string_view unit) const {
    if (unit != text('[', units[column], ']'))
      fail("column '", column_names[column], "' has the unit ", in_quotes(unit),
           ", but numbers are read in [", units[column],
           "]; convert them, or leave the unit out if they are");
  }

  /// Of write_particle_csv: what is behind the motion are fields of modules.
  void read_csv_header(std::string_view line) {
    separator_ = ',';
    columns_ = {Skipped, X, Y, Z, Vx, Vy, Vz, Radius, Material};
    line.remove_prefix(of_csv.size());
    if (line.starts_with(of_csv_spin)) {
      columns_.insert(columns_.end(), {Wx, Wy, Wz});
      line.remove_prefix(of_csv_spin.size());
    }
    columns_.insert(columns_.end(),
                    static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')), Skipped);
    for (const Column column : columns_)
      if (column != Skipped) has_[column] = true;
  }

  void need_all_of(int first, bool needed) const {
    for (int c = first; needed && c < first + 3; ++c)
      if (!has_[c]) fail("the column '", column_names[c], "' is missing");
  }

  void read_row(std::string_view line, std::array<double, column_count>& row) const {
    std::string_view value;
    std::size_t found = 0;
    for (; next_value(line, value); ++found)
      if (found < columns_.size() && columns_[found] != Skipped)
        row[columns_[found]] = number(columns_[found], value);
    if (found != columns_.size())
      fail("has ", found, " values, but the header names ", columns_.size(), " columns");
  }

  double number(Column column, std::string_view value) const {
    double x = 0;
    if (const auto why = why_no_number(value, x); !why.empty()) refuse(column, value, why);
    if ((column == Radius || column == Diameter || column == Density) && !(x > 0))
      refuse(column, value, "must be greater than 0");
    if (column == Material && !(x >= 0 && x < 4294967296.0 && x == std::floor(x)))
      refuse(column, value, "must be a whole number from 0");
    return x;
  }
  [[noreturn]] void refuse(Column column, std::string_view value, std::string_view why) const {
    fail("column '", column_names[column], "': ", in_quotes(value), " ", why);
  }

  void append(ParticleTable& table, const std::array<double, column_count>& row) const {
    table.position.push_back({row[X], row[Y], row[Z]});
    table.radius.push_back(has_[Radius] ? row[Radius] : 0.5 * row[Diameter]);
    if (has_[Density]) table.density.push_back(row[Density]);
    if (has_[Vx]) table.velocity.push_back({row[Vx], row[Vy], row[Vz]});
    if (has_[Wx]) table.angular_velocity.push_back({row[Wx], row[Wy], row[Wz]});
    if (has_[Material]) table.material.push_back(static_cast<std::uint32_t>(row[Material]));
  }

  const std::string& path_;
  std::string_view rest_;
  std::size_t line_number_ = 0;
  bool comments_ = false;     // there was one
  char separator_ = 0;        // 0: white space
  DynArray<Column> columns_;  // in the order of the file
  std::array<bool, column_count> has_{};
};

/// InputError unless `column` has one valid value per particle, or none if it is optional.
template <class Value, class Good>
void require_column(std::string_view name, const DynArray<Value>& column, std::size_t particles,
                    bool may_be_empty, Good good, std::string_view what_is_good) {
  if (may_be_empty && column.empty()) return;
  require(column.size() == particles, "ParticleTable.", name, " has ", column.size(),
          " entries for ", particles, " positions; it needs one each",
          may_be_empty ? " or none" : "");
  for (std::size_t i = 0; i < column.size(); ++i)
    require(good(column[i]), "ParticleTable.", name, "[", i, "] = ", column[i], " must be ",
            what_is_good);
}

inline void require_writable(const ParticleTable& t) {
  const auto finite = [](const Vec3d& v) { return is_finite(v); };
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  const std::size_t n = t.size();
  require(n > 0, "ParticleTable has no particles to write");
  require_column("position", t.position, n, false, finite, "finite");
  require_column("radius", t.radius, n, false, positive, "finite and greater than 0");
  require_column("density", t.density, n, true, positive, "finite and greater than 0");
  require_column("velocity", t.velocity, n, true, finite, "finite");
  require_column("angular_velocity", t.angular_velocity, n, true, finite, "finite");
  require_column(
      "material", t.material, n, true, [](std::uint32_t) { return true; }, "");
}

}  // namespace detail

/// Reads a text table of particles. The first line names the columns, in any order: x y z [m],
/// radius or diameter [m], and optionally density [kg/m3], vx vy vz [m/s], wx wy wz [rad/s],
/// material [-] (a number from 0). Names may have these units, as in `x [m]`. Values are separated
/// by commas or semicolons if the first line has any, else by white space; `#` starts a comment;
/// the decimal sign is a point in every locale. In a table of write_particle_csv, columns of fields
/// are skipped.
///
/// Errors: FileError with file, line and column: missing or empty file; unknown, missing or
///         repeated column; another unit; wrong number of values; not a number; not finite; radius
///         or density not greater than 0.
inline ParticleTable read_particle_file(const std::string& path) {
  const std::string content = detail::read_text(path);
  return detail::ParticleReader(path, content).read();
}

/// Writes a table that read_particle_file reads back exactly, bit for bit. The file is complete or
/// absent.
/// Errors: InputError for an empty table, columns of different lengths or values that could not be
///         read back; FileError with the system's reason.
inline void write_particle_file(const std::string& path, const ParticleTable& table) {
  detail::require_writable(table);
  AtomicFile file(path);
  std::string line = "x,y,z,radius";
  if (!table.density.empty()) line += ",density";
  if (!table.velocity.empty()) line += ",vx,vy,vz";
  if (!table.angular_velocity.empty()) line += ",wx,wy,wz";
  if (!table.material.empty()) line += ",material";
  file.write(line += '\n');
  const auto add = [&](const auto& value) { detail::append(line, value), line += ','; };
  const auto add_vector = [&](const Vec3d& v) { add(v.x), add(v.y), add(v.z); };
  for (std::size_t i = 0; i < table.size(); ++i) {
    line.clear();
    add_vector(table.position[i]);
    add(table.radius[i]);
    if (!table.density.empty()) add(table.density[i]);
    if (!table.velocity.empty()) add_vector(table.velocity[i]);
    if (!table.angular_velocity.empty()) add_vector(table.angular_velocity[i]);
    if (!table.material.empty()) add(table.material[i]);
    line.back() = '\n';
    file.write(line);
  }
  file.commit();
}

}  // namespace silt
