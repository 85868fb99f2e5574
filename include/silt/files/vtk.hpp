// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/files/atomic_file.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

static_assert(
    std::endian::native == std::endian::little,
    "silt/io: VTK files are written in the machine's byte order and say that it is little "
    "endian; a big-endian port has to swap bytes here");

/// One appended array of a VTK file: a view of values stored elsewhere.
struct VtkArray {
  std::string name;
  std::string_view type;  // VTK's word
  std::size_t components, tuples, bytes;
  const void* values;
};

/// Number and type of the components of a field's elements.
template <class T>
struct VtkElement {
  using Number = T;
  static constexpr std::size_t components = 1;
};
template <class Real>
struct VtkElement<Vec3<Real>> {
  using Number = Real;
  static constexpr std::size_t components = 3;
};
template <class T, std::size_t N>
struct VtkElement<std::array<T, N>> {
  using Number = T;
  static constexpr std::size_t components = N;
};

template <class T>
constexpr std::string_view vtk_type() {
  if constexpr (std::is_same_v<T, double>)
    return "Float64";
  else if constexpr (std::is_same_v<T, float>)
    return "Float32";
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return "Int32";
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return "UInt32";
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return "UInt64";
  else
    static_assert(sizeof(T) == 0,
                  "the type of a VTK field is double, float, int32_t, uint32_t or uint64_t");
}

template <class T>
VtkArray vtk_array(std::string_view name, std::span<const T> values) {
  using Number = typename VtkElement<T>::Number;
  constexpr auto components = VtkElement<T>::components;
  static_assert(sizeof(T) == components * sizeof(Number));
  return {std::string(name), vtk_type<Number>(),  components,
          values.size(),     values.size_bytes(), values.data()};
}

/// A string that may be placed between quotes in XML unchanged.
inline bool is_plain(std::string_view word) {
  for (const char c : word)
    if (std::string_view("\"'<>&").find(c) != std::string_view::npos ||
        static_cast<unsigned char>(c) < ' ')
      return false;
  return !word.empty();
}
inline void require_plain(std::string_view what, std::string_view word) {
  require(!word.empty(), what, " is empty");
  require(is_plain(word), what, " ", in_quotes(word),
          " must not contain quotes, <, >, & or control characters");
}

/// XML element of a VTK file with arrays.
struct VtkSection {
  std::string_view tag;
  std::span<const VtkArray> arrays;
};

/// `type`: VTK's name of the data set; `about` and `piece`: attributes of its element and of its
/// only piece. Does not wait for the disk (Flush::Never), like all VTK files.
inline void write_vtk_file(const std::string& path, std::string_view type, std::string_view about,
                           std::string_view piece, std::span<const VtkSection> sections) {
  AtomicFile file(path, Flush::Never);
  file.write(text("<?xml version=\"1.0\"?>\n<VTKFile type=\"", type,
                  "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<", type,
                  about, ">\n<Piece ", piece, ">\n"));
  std::uint64_t offset = 0;  // [bytes] of an array after the mark '_'
  for (const auto& section : sections) {
    file.write(text('<', section.tag, ">\n"));
    for (const auto& array : section.arrays) {
      file.write(text("<DataArray type=\"", array.type, "\" Name=\"", array.name,
                      "\" NumberOfComponents=\"", array.components,
                      "\" format=\"appended\" offset=\"", offset, "\"/>\n"));
      offset += sizeof(std::uint64_t) + array.bytes;
    }
    file.write(text("</", section.tag, ">\n"));
  }
  file.write(text("</Piece>\n</", type, ">\n<AppendedData encoding=\"raw\">\n_"));
  for (const auto& section : sections)
    for (const auto& array : section.arrays) {
      const std::uint64_t bytes = array.bytes;
      file.write(&bytes, sizeof bytes);
      file.write(array.values, array.bytes);
    }
  file.write("\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}
inline void write_vtp(const std::string& path, std::size_t points, std::size_t verts,
                      std::size_t polygons, std::span<const VtkSection> sections,
                      std::size_t lines = 0) {
  write_vtk_file(
      path, "PolyData", "",
      text("NumberOfPoints=\"", points, "\" NumberOfVerts=\"", verts, "\" NumberOfLines=\"", lines,
           "\" NumberOfStrips=\"0\" NumberOfPolys=\"", polygons, '"'),
      sections);
}

/// stride, 2 stride, ... : the end of each cell's list of points. Extends or shortens `ends`,
/// keeping the valid part.
inline void set_vtk_cell_ends(const std::string& path, std::size_t cells, std::int32_t stride,
                              DynArray<std::int32_t>& ends) {
  constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  require(cells <= most / static_cast<std::size_t>(stride), "VTK file '", path, "': ", cells,
          " cells are too many for its 32-bit numbers; write them as several files");
  std::size_t k = std::min(cells, ends.size());
  ends.resize(cells);
  for (; k < cells; ++k) ends[k] = static_cast<std::int32_t>(k + 1) * stride;
}
inline DynArray<std::int32_t> vtk_cell_ends(const std::string& path, std::size_t cells,
                                            std::int32_t stride) {
  DynArray<std::int32_t> ends;
  set_vtk_cell_ends(path, cells, stride, ends);
  return ends;
}

/// Lines with two points each; kept from file to file.
struct VtkLines {
  DynArray<std::int32_t> points, ends;
  void set(const std::string& path, std::size_t lines) {
    set_vtk_cell_ends(path, lines, 2, ends);
    std::size_t k = std::min(2 * lines, points.size());
    points.resize(2 * lines);
    for (; k < points.size(); ++k) points[k] = static_cast<std::int32_t>(k);
  }
};

}  // namespace detail

/// Named values at the points of a VTK file. The arrays are not copied: they must exist until the
/// file is written.
///
///   silt::VtkFields fields;
///   fields.add("radius [m]", radii).add("velocity [m/s]", velocities);
class VtkFields {
 public:
  /// An array of double, float, int32_t, uint32_t or uint64_t, or of Vec3 or std::array of these.
  template <class Values>
  VtkFields& add(std::string_view name, Values&& values) {
    detail::require_plain("VtkFields: a field's name", name);
    for (const auto& other : arrays_)
      require(other.name != name, "VtkFields: there are two fields named ", in_quotes(name),
              "; give each its own name");
    arrays_.push_back(detail::vtk_array(name, detail::lasting_view(std::forward<Values>(values))));
    return *this;
  }

  std::span<const detail::VtkArray> arrays() const { return arrays_; }
  /// The arrays; InputError unless each has one entry per point.
  std::span<const detail::VtkArray> arrays_for(const std::string& path, std::size_t points,
                                               std::string_view of = "points") const {
    for (const auto& array : arrays_)
      require(array.tuples == points, "VTK file '", path, "': field ", in_quotes(array.name),
              " has ", array.tuples, " entries, but there are ", points, ' ', of);
    return arrays_;
  }

 private:
  DynArray<detail::VtkArray> arrays_;
};

/// Writes `positions` [m] as points with a vertex each, for ParaView: `path` should end in .vtp.
/// Errors: InputError for a field of another length; FileError if the file cannot be written.
inline void write_vtp_points(const std::string& path, std::span<const Vec3d> positions,
                             const VtkFields& fields = {}) {
  const std::size_t n = positions.size();
  const auto point_fields = fields.arrays_for(path, n);
  const auto ends = detail::vtk_cell_ends(path, n, 1);
  DynArray<std::int32_t> own_point(n);
  for (std::size_t i = 0; i < n; ++i) own_point[i] = ends[i] - 1;
  const std::array points{detail::vtk_array("Points", positions)};
  const std::array verts{
      detail::vtk_array("connectivity", std::span<const std::int32_t>(own_point)),
      detail::vtk_array("offsets", std::span<const std::int32_t>(ends))};
  const detail::VtkSection sections[] = {
      {"PointData", point_fields}, {"Points", points}, {"Verts", verts}};
  detail::write_vtp(path, n, n, 0, sections);
}

/// Data of an index besides fields: the association of the fields, and the type of points.
struct VtkPieces {
  std::string_view fields_of = "PPointData";  // or PCellData
  std::string_view points = "Float64";
};
/// Writes the index of files that are pieces of one data set, for ParaView: `path` should end in
/// .pvtp, `files` are relative to its folder, and `fields` those that each has.
/// Errors: InputError for an unsuitable name; FileError if the file cannot be written.
inline void write_vtp_index(const std::string& path, std::span<const std::string> files,
                            const VtkFields& fields, const VtkPieces& layout = {}) {
  AtomicFile file(path, Flush::Never);
  file.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PPolyData GhostLevel=\"0\">\n");
  file.write(text('<', layout.fields_of, ">\n"));
  for (const auto& array : fields.arrays())
    file.write(text("<PDataArray type=\"", array.type, "\" Name=\"", array.name,
                    "\" NumberOfComponents=\"", array.components, "\"/>\n"));
  file.write(text("</", layout.fields_of, ">\n<PPoints>\n<PDataArray type=\"", layout.points,
                  "\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n"));
  for (const std::string& piece : files) {
    detail::require_plain("write_vtp_index: the name of a piece", piece);
    file.write(text("<Piece Source=\"", piece, "\"/>\n"));
  }
  file.write("</PPolyData>\n</VTKFile>\n");
  file.commit();
}

/// Writes a surface: each of `triangles` refers to three of the `points` [m].
/// Errors: InputError for a field of another length or a triangle with an invalid point number;
/// FileError if the file cannot be written.
inline void write_vtp_triangles(const std::string& path, std::span<const Vec3d> points,
                                std::span<const std::array<std::uint32_t, 3>> triangles,
                                const VtkFields& fields = {}) {
  const auto point_fields = fields.arrays_for(path, points.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const auto p : triangles[t])
      require(p < points.size(), "VTK file '", path, "': triangle ", t, " names point ", p,
              ", but there are only ", points.size(), " points, counted from 0");
  const auto ends = detail::vtk_cell_ends(path, triangles.size(), 3);
  auto corners = detail::vtk_array("connectivity", triangles);
  corners.components = 1;
  const std::array places{detail::vtk_array("Points", points)};
  const std::array polygons{corners,
                            detail::vtk_array("offsets", std::span<const std::int32_t>(ends))};
  const detail::VtkSection sections[] = {
      {"PointData", point_fields}, {"Points", places}, {"Polys", polygons}};
  detail::write_vtp(path, points.size(), 0, triangles.size(), sections);
}

namespace detail {

inline void write_vtp_lines(const std::string& path, std::span<const std::array<float, 3>> points,
                            const VtkFields& fields, VtkLines& cells) {
  const std::size_t lines = points.size() / 2;
  require(points.size() % 2 == 0, "VTK file '", path, "': ", points.size(),
          " points are not ends of lines, which have two each");
  const auto line_fields = fields.arrays_for(path, lines, "lines");
  cells.set(path, lines);
  const std::array places{vtk_array("Points", points)};
  const std::array numbers{vtk_array("connectivity", std::span<const std::int32_t>(cells.points)),
                           vtk_array("offsets", std::span<const std::int32_t>(cells.ends))};
  const VtkSection sections[] = {{"CellData", line_fields}, {"Points", places}, {"Lines", numbers}};
  write_vtp(path, points.size(), 0, 0, sections, lines);
}

}  // namespace detail

/// Writes lines: points 2 k and 2 k + 1 [m] are the ends of line k; fields have one value per line.
/// Coordinates are written as float, 6e-8 of the largest.
/// Errors: InputError for an odd number of points or a field of another length; FileError if the
/// file cannot be written.
inline void write_vtp_lines(const std::string& path, std::span<const std::array<float, 3>> points,
                            const VtkFields& fields = {}) {
  detail::VtkLines lines;
  detail::write_vtp_lines(path, points, fields, lines);
}

/// Writes fields of the cells of a box with nx x ny x nz equal cells, x fastest, for
/// ParaView: `path` should end in .vti.
/// Errors: InputError for a field of another length; FileError if the file cannot be written.
inline void write_vti(const std::string& path, const Box& box, const std::array<int, 3>& cells,
                      const VtkFields& fields) {
  const auto count = static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) *
                     static_cast<std::size_t>(cells[2]);
  const Vec3d e = box.extent(), &o = box.min;
  const detail::VtkSection sections[] = {{"CellData", fields.arrays_for(path, count, "cells")}};
  const std::string extent = text("\"0 ", cells[0], " 0 ", cells[1], " 0 ", cells[2], '"');
  detail::write_vtk_file(
      path, "ImageData",
      text(" WholeExtent=", extent, " Origin=\"", o.x, ' ', o.y, ' ', o.z, "\" Spacing=\"",
           e.x / cells[0], ' ', e.y / cells[1], ' ', e.z / cells[2], '"'),
      text("Extent=", extent), sections);
}

/// Time series of VTK files: `<folder>/<name>.pvd`, which ParaView opens as one animation. The list
/// is replaced as a whole after each frame and is always valid.
/// Errors: InputError for unusable names or decreasing times; FileError if the list cannot be
///         written or, in `resume`, is not one of silt's.
class VtkSeries {
 public:
  /// A new, empty series; creates the folder, and empties a list of that name.
  VtkSeries(const std::string& folder, std::string_view name)
      : VtkSeries(folder, name, NotWritten{}) {
    write();
  }

  /// Continues a series after a restart at `time` [s]: later frames are removed from the list.
  /// Without a list, or with an empty file as after a power failure, it starts a new one.
  static VtkSeries resume(const std::string& folder, std::string_view name, double time) {
    VtkSeries series(folder, name, NotWritten{});
    if (detail::file_exists(series.path_)) series.read(time);
    series.write();
    return series;
  }

  const std::string& path() const { return path_; }
  std::size_t frames() const { return frames_.size(); }
  /// The file of the last frame; empty if there is none.
  std::string last_file() const {
    if (frames_.empty()) return {};
    const std::size_t begin = list_.find(before_file_, frames_.back().begin) + before_file_.size();
    return list_.substr(begin, list_.find('"', begin) - begin);
  }

  /// Adds the file `file` (relative to the folder) as the state at `time` [s]. A frame at the time
  /// of the last one replaces it.
  void add(double time, std::string_view file) {
    detail::require_plain("VtkSeries: the frame's file name", file);
    require(std::isfinite(time), "VtkSeries '", path_, "': time = ", time, " [s] must be finite");
    if (!frames_.empty()) {
      const Frame& last = frames_.back();
      require(time >= last.time, "VtkSeries '", path_, "': time = ", time,
              " [s] must not be before the last frame's, ", last.time, " [s]");
      if (time == last.time) list_.resize(last.begin), frames_.pop_back();
    }
    append(time, file);
    write();
  }

 private:
  struct Frame {
    double time;        // [s]
    std::size_t begin;  // of its line in the list
  };
  static constexpr std::string_view head_ =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  static constexpr std::string_view before_time_ = "<DataSet timestep=\"";
  static constexpr std::string_view before_file_ = "\" group=\"\" part=\"0\" file=\"";
  static constexpr std::string_view after_file_ = "\"/>\n";
  static constexpr std::string_view tail_ = "</Collection>\n</VTKFile>\n";

  struct NotWritten {};
  VtkSeries(const std::string& folder, std::string_view name, NotWritten)
      : path_(text(folder, '/', name, ".pvd")) {
    detail::require_plain("VtkSeries: the name", name);
    make_folder(folder);
  }

  void append(double time, std::string_view file) {
    frames_.push_back({time, list_.size()});
    list_ += text(before_time_, time, before_file_, file, after_file_);
  }
  void write() const {
    AtomicFile file(path_, Flush::Never);
    file.write(head_), file.write(list_), file.write(tail_);
    file.commit();
  }

  [[gnu::cold]] void read(double until) {
    const std::string content = detail::read_text(path_);
    if (content.empty()) return;
    std::string_view rest = content;
    const auto skip = [&](std::string_view word) {
      const bool there = rest.starts_with(word);
      if (there) rest.remove_prefix(word.size());
      return there;
    };
    const auto expect = [&](bool as_written) {
      if (!as_written)
        throw FileError(text("series '", path_, "' is not as silt writes it, from byte ",
                             content.size() - rest.size(),
                             " on; remove it, or give the run another folder or name"));
    };
    expect(skip(head_));
    double last = -std::numeric_limits<double>::infinity();  // [s] frames are in order of time
    while (skip(before_time_)) {
      double time = 0;  // [s]
      const auto number = std::from_chars(rest.data(), rest.data() + rest.size(), time);
      expect(number.ec == std::errc{} && std::isfinite(time) && time >= last);
      last = time;
      rest.remove_prefix(static_cast<std::size_t>(number.ptr - rest.data()));
      expect(skip(before_file_));
      const std::string_view file = rest.substr(0, rest.find('"'));
      rest.remove_prefix(file.size());
      expect(detail::is_plain(file) && skip(after_file_));
      if (time <= until) append(time, file);
    }
    expect(skip(tail_) && rest.empty());
  }

  std::string path_;
  DynArray<Frame> frames_;
  std::string list_;  // their lines
};

}  // namespace silt
