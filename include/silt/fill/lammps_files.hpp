// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include <silt/core/dyn_array.hpp>
#include <silt/files/text_lines.hpp>
#include <silt/fill/particle_file.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Values of one particle in a LAMMPS file.
inline double positive(TextLines& lines, std::string_view what) {
  const auto before = lines.words();
  const double x = lines.real(what);
  if (!(x > 0)) {
    auto words = before;
    lines.fail(what, ": ", in_quotes(next_word(words)),
               " must be greater than 0; silt has no point particles");
  }
  return x;
}
inline std::uint32_t material_of_type(TextLines& lines) {
  const auto type = lines.count("type");
  if (type < 1 || type > 4294967295u)
    lines.fail("type: ", type, " must be a whole number from 1; type 1 becomes material 0");
  return static_cast<std::uint32_t>(type - 1);
}

/// A frame of a text dump of LAMMPS or LIGGGHTS, dump styles atom and custom.
/// Format: LAMMPS documentation, pages dump and Howto_triclinic.
/// Tests:  tests/fill/particle_formats.cpp
class LammpsDump {
 public:
  LammpsDump(const std::string& path, std::string_view content)
      : lines_(text("LAMMPS dump '", path, "'"), content, 0) {}

  /// The frame of this time step, or the last one.
  ParticleTable read(std::optional<std::uint64_t> timestep) {
    std::optional<Frame> chosen;
    std::size_t frames = 0;
    std::uint64_t first = 0, last = 0;
    while (lines_.next() || frames == 0) {
      const Frame frame = next_frame();
      first = frames++ == 0 ? frame.step : first, last = frame.step;
      if (!timestep || frame.step == *timestep) chosen = frame;
      for (std::uint64_t k = 0; k < frame.atoms; ++k)
        if (!lines_.next())  // messages are made only at the end: files are long
          lines_.need(text("atom ", k + 1, " of ", frame.atoms, " of time step ", frame.step));
    }
    if (!chosen)
      throw FileError(text(lines_.file(), " has no frame of time step ", *timestep, "; it has ",
                           frames, ", of the steps ", first, " to ", last));
    return table_of(*chosen);
  }

 private:
  struct Frame {
    std::uint64_t step = 0, atoms = 0;
    std::array<std::array<double, 3>, 3> box{};  // as in the file: low, high, tilt
    bool has_box = false, is_tilted = false;
    TextLines at;  // the line ITEM: ATOMS
  };
  enum Column { X, Y, Z, Radius, Diameter, Density, Mass, Vx, Vy, Vz, Wx, Wy, Wz, Type, columns };

  /// From ITEM: TIMESTEP, or the units and the time that LAMMPS writes before it, to ITEM: ATOMS.
  Frame next_frame() {
    while (lines_.line() == "ITEM: UNITS" || lines_.line() == "ITEM: TIME") {
      lines_.need("its value");
      lines_.need("'ITEM: TIMESTEP'");
    }
    if (lines_.line() != "ITEM: TIMESTEP")
      lines_.fail("expected 'ITEM: TIMESTEP', found ", in_quotes(lines_.line()),
                  "; silt reads text dumps of the styles atom and custom");
    lines_.need("the time step");
    Frame frame{.at = lines_};
    frame.step = lines_.count("time step");
    bool has_atoms = false;
    for (;;) {
      lines_.need("'ITEM: ATOMS'");
      const auto line = lines_.line();
      if (line.starts_with("ITEM: ATOMS")) break;
      if (line == "ITEM: NUMBER OF ATOMS") {
        lines_.need("the number of atoms");
        frame.atoms = lines_.count("number of atoms"), has_atoms = true;
      } else if (line.starts_with("ITEM: BOX BOUNDS")) {
        if (line.find("abc origin") != line.npos)
          lines_.fail(
              "the box is general triclinic, which silt does not read; write the dump "
              "without triclinic/general");
        frame.is_tilted = line.find("xy xz yz") != line.npos, frame.has_box = true;
        for (auto& side : frame.box) {
          lines_.need("three lines of box bounds");
          for (int k = 0; k < (frame.is_tilted ? 3 : 2); ++k)
            side[static_cast<std::size_t>(k)] = lines_.real("a bound of the box");
        }
      } else if (line == "ITEM: TIMESTEP" || line.starts_with("ITEM: NUMBER OF ENTRIES")) {
        lines_.fail(in_quotes(line), " found where 'ITEM: ATOMS' must follow");
      }  // else ITEM: UNITS, ITEM: TIME and their values
    }
    if (!has_atoms) lines_.fail("'ITEM: NUMBER OF ATOMS' is missing before this line");
    if (frame.atoms == 0) lines_.fail("time step ", frame.step, " has no atoms; choose another");
    frame.at = lines_;
    return frame;
  }

  ParticleTable table_of(const Frame& frame) {
    lines_ = frame.at;
    lines_.word(), lines_.word();  // ITEM: ATOMS
    DynArray<std::string_view> names;
    while (!lines_.words().empty()) names.push_back(lines_.word());
    const auto place = [&](std::string_view name) {
      return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    const std::size_t none = names.size();
    std::array<std::size_t, columns> where;
    where.fill(none);
    // All three of the first complete kind.
    const auto choose = [&](Column first,
                            std::initializer_list<std::array<std::string_view, 3>> kinds) {
      std::size_t kind = 0;
      for (const auto& three : kinds) {
        if (std::all_of(three.begin(), three.end(), [&](auto n) { return place(n) < none; })) {
          for (std::size_t k = 0; k < 3; ++k)
            where[static_cast<std::size_t>(first) + k] = place(three[k]);
          break;
        }
        ++kind;
      }
      return kind;
    };
    const auto kind =
        choose(X, {{"x", "y", "z"}, {"xu", "yu", "zu"}, {"xs", "ys", "zs"}, {"xsu", "ysu", "zsu"}});
    if (where[X] == none)
      lines_.fail(
          "the columns x y z, or xu yu zu, xs ys zs, xsu ysu zsu, are not all there; add them "
          "to the dump command");
    choose(Vx, {{"vx", "vy", "vz"}});
    choose(Wx, {{"omegax", "omegay", "omegaz"}, {"wx", "wy", "wz"}});
    where[Radius] = place("radius"), where[Diameter] = place("diameter");
    where[Density] = place("density"), where[Mass] = place("mass"), where[Type] = place("type");
    if (where[Radius] == none && where[Diameter] == none)
      lines_.fail("the column radius or diameter is missing; add it to the dump command");
    const bool scaled = kind >= 2;
    if (scaled && !frame.has_box)
      lines_.fail("positions are scaled by the box, but 'ITEM: BOX BOUNDS' is missing");

    ParticleTable table;
    DynArray<Column> kept(none, columns);
    for (int c = 0; c < columns; ++c)
      if (const auto at = where[static_cast<std::size_t>(c)]; at < none)
        kept[at] = static_cast<Column>(c);
    DynArray<std::string> labels;
    for (const auto name : names) labels.push_back(text("column ", in_quotes(name)));
    std::array<double, columns> row{};
    for (std::uint64_t k = 0; k < frame.atoms; ++k) {
      lines_.need("an atom");
      if (lines_.line().starts_with("ITEM:"))
        lines_.fail("only ", k, " of the ", frame.atoms, " atoms of time step ", frame.step,
                    " precede this line; the file is damaged");
      for (std::size_t n = 0; n < none; ++n) {
        const Column c = kept[n];
        if (c == columns) {
          if (lines_.word().empty()) lines_.fail("column ", in_quotes(names[n]), " is missing");
        } else if (c == Radius || c == Diameter || c == Density || c == Mass) {
          row[c] = positive(lines_, labels[n]);
        } else if (c == Type) {
          table.material.push_back(material_of_type(lines_));
        } else {
          row[c] = lines_.real(labels[n]);
        }
      }
      if (!lines_.words().empty())
        lines_.fail("has more values than 'ITEM: ATOMS' has columns, which are ", none);
      const Vec3d place_in_file{row[X], row[Y], row[Z]};
      table.position.push_back(scaled ? unscaled(frame, place_in_file) : place_in_file);
      const double r = where[Radius] < none ? row[Radius] : 0.5 * row[Diameter];
      table.radius.push_back(r);
      if (where[Density] < none)
        table.density.push_back(row[Density]);
      else if (where[Mass] < none)
        table.density.push_back(row[Mass] / (4.0 / 3 * std::numbers::pi * r * r * r));
      if (where[Vx] < none) table.velocity.push_back({row[Vx], row[Vy], row[Vz]});
      if (where[Wx] < none) table.angular_velocity.push_back({row[Wx], row[Wy], row[Wz]});
    }
    return table;
  }

  /// x = low + xs a + ys b + zs c; for a tilted box the file has the bounds of its bounding box.
  static Vec3d unscaled(const Frame& frame, const Vec3d& s) {
    const auto& b = frame.box;
    const double xy = b[0][2], xz = b[1][2], yz = b[2][2];  // [m] 0 if it is not tilted
    const double x_low = b[0][0] - std::min({0.0, xy, xz, xy + xz});
    const double x_high = b[0][1] - std::max({0.0, xy, xz, xy + xz});
    const double y_low = b[1][0] - std::min(0.0, yz), y_high = b[1][1] - std::max(0.0, yz);
    return {x_low + s.x * (x_high - x_low) + s.y * xy + s.z * xz,
            y_low + s.y * (y_high - y_low) + s.z * yz, b[2][0] + s.z * (b[2][1] - b[2][0])};
  }

  TextLines lines_;
};

/// A data file of LAMMPS or LIGGGHTS, atom_style sphere: sections Atoms and Velocities; other
/// sections and image flags are skipped.
/// Format: LAMMPS documentation, page read_data.
/// Tests:  tests/fill/particle_formats.cpp
class LammpsData {
 public:
  LammpsData(const std::string& path, std::string_view content)
      : lines_(text("LAMMPS data file '", path, "'"), content) {}

  ParticleTable read() {
    lines_.skip();  // a title
    bool more = lines_.next();
    for (; more && !begins_section(); more = lines_.next())
      if (auto words = lines_.line(); words.ends_with(" atoms") || words.ends_with("\tatoms"))
        atoms_ = lines_.count("number of atoms");
      else
        for (std::size_t d = 0; d < 3; ++d)
          if (words.ends_with(std::array{"xlo xhi", "ylo yhi", "zlo zhi"}[d]))
            box_[d][0] = lines_.real("low"), box_[d][1] = lines_.real("high");
    while (more) {
      if (lines_.line() == "Atoms")
        more = read_atoms();
      else if (lines_.line() == "Velocities")
        more = read_velocities();
      else
        while ((more = lines_.next()) && !begins_section()) {
        }
    }
    if (table_.size() == 0)
      throw FileError(text(lines_.file(), " has no section 'Atoms' with atoms in it"));
    return std::move(table_);
  }

 private:
  /// Lines of values begin with a number.
  bool begins_section() const {
    const char c = lines_.line().front();
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  }
  void end_of_line() {
    if (!lines_.words().empty())
      lines_.fail("has ", in_quotes(lines_.words()), " after its values");
  }

  bool read_atoms() {
    const std::string style(lines_.remark());
    if (!style.empty() && style != "sphere")
      lines_.fail("the atoms are of style ", in_quotes(style),
                  "; silt reads atom_style sphere (id type diameter density x y z)");
    while (lines_.next()) {
      if (begins_section()) return check_atoms(true);
      const auto id = lines_.count("id");
      table_.material.push_back(material_of_type(lines_));
      table_.radius.push_back(0.5 * positive(lines_, "diameter"));
      table_.density.push_back(positive(lines_, "density"));
      const double x = lines_.real("x"), y = lines_.real("y"), z = lines_.real("z");
      table_.position.push_back({x, y, z});
      if (style.empty()) require_in_box({x, y, z});
      if (!lines_.words().empty())
        for (int k = 0; k < 3; ++k) lines_.real("an image flag");
      end_of_line();
      is_double_ |= !place_.emplace(id, table_.size() - 1).second;
    }
    return check_atoms(false);
  }
  /// Columns of another style, whose file does not name it, are taken for diameters and places.
  void require_in_box(const Vec3d& place) const {
    const double x[3] = {place.x, place.y, place.z};
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [low, high] = box_[d];
      if (x[d] < low - (high - low) || x[d] > high + (high - low))
        lines_.fail("the atom at ", place, " lies far outside of the header's box: if the columns ",
                    "are not id type diameter density x y z, write the file as atom_style sphere; "
                    "if they are, write 'Atoms # sphere'");
    }
  }
  bool check_atoms(bool more) const {
    if (table_.size() != atoms_)
      throw FileError(text(lines_.file(), ", line ", lines_.number(),
                           ": section 'Atoms' ends after ", table_.size(),
                           " atoms, but the header announces ", atoms_,
                           " in its line 'N atoms'; correct one of them"));
    return more;
  }

  bool read_velocities() {
    if (table_.size() == 0) lines_.fail("'Velocities' is before 'Atoms'; move it after");
    if (is_double_) lines_.fail("ids of atoms are not unique; velocities cannot be assigned");
    table_.velocity.assign(table_.size(), {0, 0, 0});
    table_.angular_velocity.assign(table_.size(), {0, 0, 0});
    while (lines_.next()) {
      if (begins_section()) return true;
      const auto id = lines_.count("id");
      const auto found = place_.find(id);
      if (found == place_.end()) lines_.fail("id ", id, " is not in the section 'Atoms'");
      const double vx = lines_.real("vx"), vy = lines_.real("vy"), vz = lines_.real("vz");
      const double wx = lines_.real("wx"), wy = lines_.real("wy"), wz = lines_.real("wz");
      end_of_line();
      table_.velocity[found->second] = {vx, vy, vz};
      table_.angular_velocity[found->second] = {wx, wy, wz};
    }
    return false;
  }

  TextLines lines_;
  std::uint64_t atoms_ = 0;
  std::unordered_map<std::uint64_t, std::size_t> place_;  // of ids
  bool is_double_ = false;
  std::array<std::array<double, 2>, 3> box_{{{-none_, none_}, {-none_, none_}, {-none_, none_}}};  // [m]
  static constexpr double none_ = std::numeric_limits<double>::infinity();
  ParticleTable table_;
};

}  // namespace silt::inline SILT_TARGET::detail
