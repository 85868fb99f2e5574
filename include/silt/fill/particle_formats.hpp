// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <silt/files/text_lines.hpp>
#include <silt/fill/lammps_files.hpp>
#include <silt/fill/particle_file.hpp>

namespace silt::inline SILT_TARGET {

enum class ParticleFormat { ByContent, Table, LammpsDump, LammpsData, Yade };

/// Options of Particles::read. Lengths and velocities are multiplied by `scale`, densities by
/// mass_scale/scale^3; times are in seconds.
struct ParticleFile {
  double density = 0;                                 // [kg/m3] if the file has none
  std::size_t material = 0;                           // [-] if the file has none
  double scale = 1;                                   // [m] per length unit of the file
  double mass_scale = 1;                              // [kg] per mass unit of the file
  std::optional<std::uint64_t> timestep = {};         // of a dump; left out: its last frame
  bool types = true;                                  // type n is material n - 1; or `material`
  ParticleFormat format = ParticleFormat::ByContent;  // recognised, or given
};

namespace detail {

/// Spheres as written by Yade's export.text and export.textExt: x y z r, and optional attributes.
/// Format: documentation of Yade, module yade.export: x_y_z_r, x_y_z_r_matId, x_y_z_r_attrs.
inline ParticleTable read_yade(const std::string& path, std::string_view content) {
  TextLines lines(text("Yade file '", path, "'"), content);
  ParticleTable table;
  bool has_material = false;
  while (true) {
    const bool more = lines.next();
    if (!more) break;
    if (table.size() == 0) {
      // Content of the comments before the first sphere.
      auto before =
          content.substr(0, static_cast<std::size_t>(lines.line().data() - content.data()));
      if (const auto at = before.find("format "); at != before.npos) {
        before.remove_prefix(at + 7);
        const auto format = next_word(before = before.substr(0, before.find('\n')));
        has_material = format == "x_y_z_r_matId";
        if (format != "x_y_z_r" && format != "x_y_z_r_attrs" && !has_material)
          throw FileError(text(lines.file(), ", line 1: format ", in_quotes(format),
                               " is not read; export x_y_z_r, x_y_z_r_matId or x_y_z_r_attrs"));
      }
    }
    const double x = lines.real("x"), y = lines.real("y"), z = lines.real("z");
    table.position.push_back({x, y, z});
    table.radius.push_back(positive(lines, "r"));
    if (!has_material) continue;
    const auto material = lines.count("matId");
    if (material > 4294967295u) lines.fail("matId: ", material, " is too large");
    table.material.push_back(static_cast<std::uint32_t>(material));
  }
  if (table.size() == 0) throw FileError(text(lines.file(), " has no spheres"));
  return table;
}

/// By the first bytes of the file; otherwise a table with a header line.
inline ParticleFormat particle_format_of(std::string_view content) {
  TextLines all("", content, 0), values("", content);
  if (!all.next()) return ParticleFormat::Table;
  if (all.line().starts_with("ITEM:")) return ParticleFormat::LammpsDump;
  const auto is_value = [](std::string_view line) {
    double x = 0;
    return why_no_number(next_word(line), x).empty();
  };
  if (all.line().starts_with('#')) {
    auto words = all.line().substr(1);
    const auto first = next_word(words);
    const bool named = first == "format" || (first == "x" && words.starts_with("y z r"));
    if (named && values.next() && is_value(values.line())) return ParticleFormat::Yade;
  }
  // A header of LAMMPS: lines of numbers followed by words, one of them 'N atoms'.
  TextLines header("", content);
  header.skip();
  while (header.next() && is_value(header.line())) {
    header.word();
    if (header.words() == "atoms") return ParticleFormat::LammpsData;
  }
  return ParticleFormat::Table;
}

}  // namespace detail

/// The particles of a file in SI units: a table with a header line (particle_file.hpp), a dump or
/// a data file of LAMMPS or LIGGGHTS (lammps_files.hpp), or spheres exported by Yade.
/// Errors: InputError for scales that are not positive; FileError with file and line, what is wrong
///         and what to change.
/// Tests:  tests/fill/particle_formats.cpp
inline ParticleTable read_particles(const std::string& path, const ParticleFile& how = {}) {
  require_positive("ParticleFile.scale", how.scale, "m per file unit");
  require_positive("ParticleFile.mass_scale", how.mass_scale, "kg per file unit");
  const std::string content = detail::read_text(path);
  const auto format =
      how.format == ParticleFormat::ByContent ? detail::particle_format_of(content) : how.format;
  require(!how.timestep || format == ParticleFormat::LammpsDump,
          "ParticleFile.timestep = ", how.timestep.value_or(0), " applies to dumps only, but '",
          path, "' is not a dump; leave it out");
  ParticleTable t =
      format == ParticleFormat::LammpsDump   ? detail::LammpsDump(path, content).read(how.timestep)
      : format == ParticleFormat::LammpsData ? detail::LammpsData(path, content).read()
      : format == ParticleFormat::Yade       ? detail::read_yade(path, content)
                                             : detail::ParticleReader(path, content).read();
  if (!how.types) t.material.clear();
  if (how.scale == 1 && how.mass_scale == 1) return t;
  for (auto& x : t.position) x *= how.scale;
  for (auto& v : t.velocity) v *= how.scale;
  for (auto& r : t.radius) r *= how.scale;
  for (auto& d : t.density) d *= how.mass_scale / (how.scale * how.scale * how.scale);
  return t;
}

}  // namespace silt
