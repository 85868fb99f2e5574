// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <silt/boundary/polygons.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/number_types.hpp>
#include <silt/files/text_lines.hpp>

namespace silt::inline SILT_TARGET::detail {

/// PLY file, text or little-endian binary: element vertex with x, y, z, and element face with a
/// list vertex_indices or vertex_index. Everything else is skipped. Format: G. Turk, The PLY
/// Polygon File Format (1994); its type names (char to double) and the later ones (int8 to float64)
/// are accepted.
/// Tests:  tests/boundary/mesh_file.cpp
class PlyFile {
 public:
  PlyFile(const std::string& path, std::string_view content)
      : content_(content), lines_(text("PLY file '", path, "'"), content, 0) {}

  Polygons parse() {
    read_header();
    out_.file = lines_.file();
    at_ = content_.size() - lines_.rest().size();
    for (const Element& e : elements_) {
      const bool vertices = e.name == "vertex", faces = e.name == "face";
      element_ = &e;
      label_ = text("a value of element '", e.name, "'");
      for (row_ = 0; row_ < e.count; ++row_) {
        if (!binary_ && !lines_.next())
          lines_.need(text("element '", e.name, "' ", row_ + 1, " of ", e.count));
        if (vertices) out_.points.push_back({});
        for (const Property& p : e.properties) read_property(p, vertices, faces);
        if (!binary_ && !lines_.words().empty())
          lines_.fail("more values than element '", e.name, "' has properties in the header");
      }
    }
    return std::move(out_);
  }

 private:
  struct Property {
    std::string name;
    NumberType type, length;  // `length`: of the entry count of a list
    bool is_list, is_corners;
    int axis;  // 0, 1, 2: x, y, z of a vertex; -1: another
  };
  struct Element {
    std::string name;
    std::uint64_t count;
    DynArray<Property> properties;
  };

  void read_header() {
    lines_.need("'ply'");
    if (lines_.line() != "ply") lines_.fail("expected 'ply', found ", in_quotes(lines_.line()));
    bool has_format = false;
    for (;;) {
      lines_.need("'end_header'");
      const auto key = lines_.word();
      if (key == "end_header") break;
      if (key == "comment" || key == "obj_info") continue;
      if (key == "format")
        read_format(), has_format = true;
      else if (key == "element")
        read_element();
      else if (key == "property")
        read_property_line();
      else
        lines_.fail("expected 'format', 'element', 'property' or 'end_header', found ",
                    in_quotes(key));
    }
    if (!has_format) lines_.fail("the header has no line 'format ascii 1.0' or the like");
    need_vertices_and_faces();
  }

  void read_format() {
    const auto format = lines_.word();
    if (format == "binary_big_endian")
      lines_.fail("format binary_big_endian is not read; save as binary_little_endian or ascii");
    if (format != "ascii" && format != "binary_little_endian")
      lines_.fail("format ", in_quotes(format),
                  " is unknown; save as binary_little_endian or ascii");
    binary_ = format != "ascii";
  }

  void read_element() {
    Element e;
    e.name = lines_.word();
    e.count = lines_.count("number of elements");
    for (const Element& other : elements_)
      if (other.name == e.name) lines_.fail("element ", in_quotes(e.name), " is named twice");
    // Each element takes at least one byte, which bounds the announced count.
    if (e.count > lines_.rest().size())
      lines_.fail("announces ", e.count, " elements ", in_quotes(e.name), ", but only ",
                  lines_.rest().size(), " bytes follow; the file is cut short or damaged");
    elements_.push_back(std::move(e));
  }

  void read_property_line() {
    if (elements_.empty()) lines_.fail("a property precedes the first element");
    Element& e = elements_.back();
    Property p{};
    auto type = lines_.word();
    p.is_list = type == "list";
    if (p.is_list) {
      p.length = type_of(lines_.word());
      type = lines_.word();
      if (is_real(p.length)) lines_.fail("the length of a list must be an integer");
    }
    p.type = type_of(type);
    p.name = lines_.word();
    p.axis =
        e.name == "vertex" && !p.is_list && p.name.size() == 1 && p.name >= "x" && p.name <= "z"
            ? p.name[0] - 'x'
            : -1;
    p.is_corners =
        e.name == "face" && p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
    if (p.is_corners && is_real(p.type)) lines_.fail("numbers of vertices must be integers");
    for (const Property& other : e.properties)
      if (other.name == p.name)
        lines_.fail("property ", in_quotes(p.name), " of element ", in_quotes(e.name),
                    " is named twice");
    e.properties.push_back(std::move(p));
  }

  NumberType type_of(std::string_view word) const {
    constexpr std::array<std::string_view, number_types> names{
        "int8",   "uint8", "int16",  "uint16",  "int32",
        "uint32", "int64", "uint64", "float32", "float64"};
    constexpr std::array<std::string_view, number_types> old{
        "char", "uchar", "short", "ushort", "int", "uint", "", "", "float", "double"};
    for (std::size_t k = 0; k < names.size(); ++k)
      if (word == names[k] || (!word.empty() && word == old[k])) return static_cast<NumberType>(k);
    lines_.fail("type ", in_quotes(word),
                " is unknown; PLY has char, uchar, short, ushort, int, "
                "uint, float and double");
  }

  void need_vertices_and_faces() const {
    int axes = 0, corners = 0;
    for (const Element& e : elements_)
      for (const Property& p : e.properties) axes += p.axis >= 0, corners += p.is_corners;
    if (axes != 3) lines_.fail("the header has no element 'vertex' with the properties x, y and z");
    if (corners != 1)
      lines_.fail(
          "the header has no element 'face' with one list vertex_indices or vertex_index; "
          "a point cloud is not a surface");
  }

  void read_property(const Property& p, bool vertices, bool faces) {
    std::uint64_t entries = 1;
    if (p.is_list) {
      const double length = value(p.length);
      // Each entry takes at least one byte.
      if (!(length >= 0 && length <= static_cast<double>(content_.size())) ||
          length != std::floor(length))
        fail("a list has ", length, " entries; the file is damaged");
      entries = static_cast<std::uint64_t>(length);
    }
    for (std::uint64_t k = 0; k < entries; ++k) {
      const double x = value(p.type);
      if (vertices && p.axis >= 0) {
        Vec3d& point = out_.points.back();
        (p.axis == 0 ? point.x : p.axis == 1 ? point.y : point.z) = x;
      }
      if (!p.is_corners) continue;
      if (!(x >= 0 && x < 9e15) || x != std::floor(x))
        fail("vertex_indices has ", x, "; numbers of vertices count from 0");
      out_.corners.push_back(static_cast<std::size_t>(x));
    }
    if (faces && p.is_corners) {
      out_.ends.push_back(out_.corners.size());
      if (!binary_) out_.lines.push_back(lines_.number());
    }
  }

  double value(NumberType type) {
    if (!binary_) return lines_.real(label_);
    const std::size_t bytes = size_of(type);
    if (content_.size() - at_ < bytes)
      fail("the file ends after ", content_.size(), " bytes; it is cut short");
    at_ += bytes;
    return number_at(content_.data() + at_ - bytes, type);
  }

  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    if (!binary_) lines_.fail(parts...);
    throw FileError(text(lines_.file(), ", element '", element_->name, "' ", row_ + 1, " of ",
                         element_->count, ": ", parts...));
  }

  std::string_view content_;
  TextLines lines_;
  bool binary_ = false;
  DynArray<Element> elements_;
  const Element* element_ = nullptr;
  std::string label_;  // of its values
  std::uint64_t row_ = 0;
  std::size_t at_ = 0;  // [bytes] of the next value
  Polygons out_;
};

}  // namespace silt::inline SILT_TARGET::detail
