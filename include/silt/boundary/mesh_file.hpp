// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <silt/boundary/ply.hpp>
#include <silt/boundary/polygons.hpp>
#include <silt/boundary/stl.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/boundary/vtp_mesh.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/files/text_lines.hpp>

/// Reads surfaces from STL, OBJ, PLY and VTP files. Format: OBJ: Wavefront, Object Files, Advanced
/// Visualizer manual, appendix B1; only vertices and faces are used. PLY, VTP and STL: ply.hpp,
/// vtp_mesh.hpp, stl.hpp.
/// Units:  the files have none; silt expects metres, `scale` converts (1e-3 for a file in mm).
/// Errors: FileError with the file, the line (in binary files the element), what is wrong and what
///         to change.
/// Tests:  tests/boundary/mesh_file.cpp

namespace silt::inline SILT_TARGET {

enum class MeshFormat { ByContent, Stl, Obj, Ply, Vtp };

namespace detail {

/// Statements of OBJ that do not describe a surface: normals, texture, names, appearance, points,
/// lines.
inline bool is_skipped_in_obj(std::string_view key) {
  constexpr std::array<std::string_view, 19> all{
      "vt",       "vn",       "vp",     "g",          "o",        "s", "mg",
      "usemtl",   "mtllib",   "usemap", "maplib",     "l",        "p", "bevel",
      "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj"};
  return std::find(all.begin(), all.end(), key) != all.end();
}

inline Polygons parse_obj(const std::string& path, std::string_view content) {
  // A backslash at the end joins a line to the next; the following lines keep their numbers.
  std::string joined;
  std::size_t taken = 0;
  for (std::size_t at = 0; at < content.size(); ++at) {
    const auto rest = content.substr(at);
    const std::size_t join = rest.starts_with("\\\n") ? 2 : rest.starts_with("\\\r\n") ? 3 : 0;
    if (join > 0)
      joined += ' ', ++taken, at += join - 1;
    else if (content[at] == '\n')
      joined.append(1 + std::exchange(taken, 0), '\n');
    else
      joined += content[at];
  }
  TextLines lines(text("OBJ file '", path, "'"), joined);
  Polygons out;
  out.file = lines.file();
  const auto corner = [&](std::string_view word) {
    const auto number = word.substr(0, word.find('/'));  // point, before texture and normal
    std::int64_t k = 0;
    const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), k);
    if (error != std::errc() || stop != number.data() + number.size() || k == 0)
      lines.fail("the face's corner ", in_quotes(word),
                 " names no point; they count from 1, or back from -1");
    const auto there = static_cast<std::int64_t>(out.points.size());
    if (k < -there || k > there)
      lines.fail("the face's corner ", in_quotes(word), " names a point that does not exist; ",
                 there, " precede this line");
    return static_cast<std::size_t>(k > 0 ? k - 1 : there + k);
  };
  while (lines.next()) {
    const auto key = lines.word();
    if (key == "v") {
      const double x = lines.real("x"), y = lines.real("y"), z = lines.real("z");
      out.points.push_back({x, y, z});
    } else if (key == "f") {
      while (!lines.words().empty()) out.corners.push_back(corner(lines.word()));
      out.ends.push_back(out.corners.size());
      out.lines.push_back(lines.number());
    } else if (!is_skipped_in_obj(key)) {
      lines.fail(in_quotes(key),
                 " is not a statement of a polygon mesh; silt reads v and f, let the program "
                 "that wrote the file export polygons or triangles");
    }
  }
  return out;
}

/// Recognised by the first bytes of the file, else by its name.
inline MeshFormat mesh_format_of(const std::string& path) {
  const std::string head = read_from(path, [](const File& file, std::uint64_t bytes) {
    std::string start(std::min<std::uint64_t>(bytes, 1024), '\0');
    file.read_at(0, start.data(), start.size());
    // A binary STL file has the length that its count implies, whatever its header says.
    if (bytes >= stl_header_bytes &&
        bytes == stl_header_bytes + stl_triangle_bytes * std::uint64_t{get_u32(&start[80])})
      return std::string("solid");
    return start;
  });
  std::string_view start = head;
  if (start.starts_with(utf8_mark)) start.remove_prefix(utf8_mark.size());
  while (!start.empty() && (is_blank(start.front()) || start.front() == '\n'))
    start.remove_prefix(1);
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return MeshFormat::Ply;
  if (start.starts_with("<?xml") || start.starts_with("<VTKFile")) return MeshFormat::Vtp;
  const auto lower = [](std::string_view word) {
    std::string out(word);
    for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
  };
  if (lower(start.substr(0, 5)) == "solid") return MeshFormat::Stl;
  const std::string name = lower(path);
  if (name.ends_with(".stl")) return MeshFormat::Stl;
  if (name.ends_with(".obj")) return MeshFormat::Obj;
  if (name.ends_with(".ply")) return MeshFormat::Ply;
  if (name.ends_with(".vtp")) return MeshFormat::Vtp;
  throw FileError(text("file '", path,
                       "' is not a mesh format known by its content or its name; silt reads .stl, "
                       ".obj, .ply and .vtp; or pass the MeshFormat to read_mesh"));
}

}  // namespace detail

/// Triangles of a mesh file, corners times `scale` [m per unit of the file]. Polygons become
/// triangle fans. The format is given, or recognised by the content, else by the name.
inline DynArray<std::array<Vec3d, 3>> read_mesh(const std::string& path, double scale = 1,
                                                MeshFormat format = MeshFormat::ByContent) {
  require_positive("read_mesh: scale", scale, "m per file unit");
  if (format == MeshFormat::ByContent) format = detail::mesh_format_of(path);
  if (format == MeshFormat::Stl) return read_stl(path, scale);
  if (format == MeshFormat::Obj)
    return detail::fanned(detail::parse_obj(path, detail::read_text(path)), scale);
  return detail::read_from(path, [&](const detail::File& file, std::uint64_t bytes) {
    const auto content = detail::read_blocks(file, bytes, [](std::string_view) {});
    return detail::fanned(format == MeshFormat::Ply ? detail::PlyFile(path, content).parse()
                                                    : detail::VtpFile(path, content).parse(),
                          scale);
  });
}

/// Triangles of a mesh, as used by TriangleMesh, Polyhedron::from_mesh, write_stl and read_mesh.
inline DynArray<std::array<Vec3d, 3>> corners_of(const TriangleMesh& mesh) {
  DynArray<std::array<Vec3d, 3>> out;
  out.reserve(mesh.triangles().size());
  const auto& at = mesh.vertices();
  for (const auto& t : mesh.triangles()) out.push_back({at[t[0]], at[t[1]], at[t[2]]});
  return out;
}

/// Writes a mesh as an STL file, binary by default.
inline void write_stl(const std::string& path, const TriangleMesh& mesh,
                      StlFormat format = StlFormat::Binary) {
  write_stl(path, corners_of(mesh), format);
}

}  // namespace silt
