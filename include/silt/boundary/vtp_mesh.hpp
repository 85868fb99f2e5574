// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <silt/boundary/polygons.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/files/number_types.hpp>
#include <silt/files/text_lines.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Polygons of a VTK PolyData file (.vtp) in XML: points and polygons of all pieces, as text or as
/// appended raw bytes. Fields, vertices and lines are skipped.
/// Format: VTK documentation, XML File Formats, and the wiki page VTK XML Formats.
/// Tests:  tests/boundary/mesh_file.cpp
class VtpFile {
 public:
  VtpFile(const std::string& path, std::string_view content)
      : file_(text("VTP file '", path, "'")), content_(content) {}

  Polygons parse() {
    out_.file = file_;
    find_appended();
    bool has_root = false;
    std::string_view section;
    while (next_tag()) {
      if (name_ == "VTKFile")
        check_root(), has_root = true;
      else if (name_ == "Piece")
        begin_piece();
      else if (name_ == "/Piece")
        end_piece();
      else if (name_ == "Points" || name_ == "Polys")
        section = name_;
      else if (name_ == "/Points" || name_ == "/Polys")
        section = {};
      else if (name_ == "DataArray" && !section.empty())
        keep_array(section);
    }
    if (!has_root)
      throw FileError(text(file_, " has no element VTKFile; it is not a VTK XML file"));
    return std::move(out_);
  }

 private:
  /// Position and type of the values of an array.
  struct Array {
    std::string_view name;
    NumberType type;
    bool appended;
    std::size_t begin;  // of its text, or of its length among the bytes
    std::size_t line;   // of its element
  };

  /// Raw bytes may contain anything: elements are searched only before them.
  void find_appended() {
    xml_ = content_;
    const auto at = content_.find("<AppendedData");
    if (at == content_.npos) return;
    const auto end = content_.find('>', at);
    const auto mark = end == content_.npos ? end : content_.find('_', end);
    if (mark == content_.npos)
      throw FileError(text(file_,
                           ": AppendedData has no mark '_' before its bytes; the file is cut "
                           "short"));
    xml_ = content_.substr(0, at);
    bytes_ = content_.substr(mark + 1);
    const auto head = content_.substr(at, end - at);
    raw_ = head.find("\"raw\"") != head.npos || head.find("'raw'") != head.npos;
  }

  bool next_tag() {
    for (;;) {
      at_ = xml_.find('<', at_);
      if (at_ == xml_.npos) return false;
      tag_ = at_;
      if (xml_.substr(at_).starts_with("<!--")) {
        at_ = std::min(xml_.find("-->", at_), xml_.size());
        continue;
      }
      const auto end = xml_.find('>', at_);
      if (end == xml_.npos) fail("the element has no end '>'; the file is cut short");
      attributes_ = xml_.substr(at_ + 1, end - at_ - 1);
      at_ = end + 1;
      if (attributes_.ends_with('/')) attributes_.remove_suffix(1);
      const auto stop = std::min(attributes_.find_first_of(" \t\r\n"), attributes_.size());
      name_ = attributes_.substr(0, stop);
      attributes_.remove_prefix(stop);
      return true;
    }
  }

  /// Value of an attribute of the present element, if any.
  std::optional<std::string_view> attribute(std::string_view key) const {
    for (std::size_t at = 0; (at = attributes_.find(key, at)) != attributes_.npos; ++at) {
      const auto equals = at + key.size();
      if (at == 0 ||
          std::string_view(" \t\r\n").find(attributes_[at - 1]) == std::string_view::npos)
        continue;
      if (equals + 1 >= attributes_.size() || attributes_[equals] != '=') continue;
      const char quote = attributes_[equals + 1];
      if (quote != '"' && quote != '\'') continue;
      const auto end = attributes_.find(quote, equals + 2);
      if (end == attributes_.npos) fail("attribute ", key, " has no closing quote");
      return attributes_.substr(equals + 2, end - equals - 2);
    }
    return {};
  }
  std::uint64_t whole(std::string_view key) const {
    const auto word = attribute(key);
    std::uint64_t n = 0;
    if (!word) fail("the element ", name_, " has no attribute ", key);
    const auto [stop, error] = std::from_chars(word->data(), word->data() + word->size(), n);
    if (word->empty() || error != std::errc() || stop != word->data() + word->size())
      fail(key, " = ", in_quotes(*word), " is not a whole number from 0");
    return n;
  }

  void check_root() {
    if (attribute("type") != "PolyData")
      fail("type = ", in_quotes(attribute("type").value_or("")),
           " of VTKFile is not a surface; save the surface as PolyData (.vtp), e.g. in ParaView");
    if (attribute("compressor"))
      fail("the arrays are compressed; save the file without compression");
    if (const auto order = attribute("byte_order"); order && *order != "LittleEndian")
      fail("byte_order = ", in_quotes(*order), " is not read; save as LittleEndian or as ascii");
    const auto header = attribute("header_type").value_or("UInt32");
    if (header != "UInt32" && header != "UInt64")
      fail("header_type = ", in_quotes(header), " must be UInt32 or UInt64");
    header_ = header == "UInt64" ? NumberType::UInt64 : NumberType::UInt32;
  }

  void begin_piece() {
    points_ = whole("NumberOfPoints");
    polygons_ = whole("NumberOfPolys");
    if (attribute("NumberOfStrips") && whole("NumberOfStrips") > 0)
      fail(
          "the piece has triangle strips, which are not read; ParaView's filter Triangulate makes "
          "triangles of them");
    places_.reset(), corners_.reset(), ends_.reset();
  }

  void keep_array(std::string_view section) {
    const auto name = attribute("Name").value_or(section);
    const auto format = attribute("format").value_or("ascii");
    if (format != "ascii" && format != "appended")
      fail("format = ", in_quotes(format), " of array ", in_quotes(name),
           " is not read; save as ascii or appended");
    const bool appended = format == "appended";
    if (appended && !raw_)
      fail(
          "array ", in_quotes(name),
          " is appended, but there is no AppendedData with encoding=\"raw\"; save as ascii or with "
          "raw encoding");
    const Array array{name, type_of(attribute("type").value_or("")), appended,
                      appended ? whole("offset") : at_, line()};
    if (section == "Points") {
      if (attribute("NumberOfComponents").value_or("3") != "3")
        fail("the points have ", in_quotes(*attribute("NumberOfComponents")),
             " components; they need 3");
      places_ = array;
    } else if (name == "connectivity") {
      corners_ = array;
    } else if (name == "offsets") {
      ends_ = array;
    }
  }

  NumberType type_of(std::string_view word) const {
    constexpr std::array<std::string_view, number_types> names{
        "Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
        "UInt32", "Int64", "UInt64", "Float32", "Float64"};
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end())
      fail("type = ", in_quotes(word),
           " of an array is unknown; VTK has Int8 to UInt64, Float32 and "
           "Float64");
    return static_cast<NumberType>(found - names.begin());
  }

  void end_piece() {
    if (polygons_ == 0) return;
    if (!places_) fail("the piece has no Points");
    if (!corners_ || !ends_)
      fail("the piece has no arrays connectivity and offsets in the element Polys");
    const auto places = values(*places_), corners = values(*corners_), ends = values(*ends_);
    const std::size_t before = out_.points.size(), named = out_.corners.size();
    if (places.size() % 3 != 0 || places.size() / 3 != points_)
      fail_at(*places_, places.size(), " numbers are not three for each of ", points_, " points");
    if (ends.size() != polygons_)
      fail_at(*ends_, ends.size(), " entries for ", polygons_, " polygons");
    for (std::size_t k = 0; k < places.size(); k += 3)
      out_.points.push_back({places[k], places[k + 1], places[k + 2]});
    for (const double c : corners) {
      if (!(c >= 0 && c < static_cast<double>(points_)) || c != std::floor(c))
        fail_at(*corners_, "names point ", c, ", but there are only ", points_, ", counted from 0");
      out_.corners.push_back(before + static_cast<std::size_t>(c));
    }
    double last = 0;
    for (const double e : ends) {
      if (!(e >= last && e <= static_cast<double>(corners.size())) || e != std::floor(e))
        fail_at(*ends_, "has ", e, " after ", last, "; offsets ascend to at most ", corners.size(),
                ", the length of connectivity");
      out_.ends.push_back(named + static_cast<std::size_t>(last = e));
    }
    if (last != static_cast<double>(corners.size()))
      fail_at(*ends_, "ends at ", last, ", but connectivity has ", corners.size(), " entries");
  }

  DynArray<double> values(const Array& a) const {
    DynArray<double> out;
    if (!a.appended) {
      auto rest = xml_.substr(a.begin, std::min(xml_.find('<', a.begin), xml_.size()) - a.begin);
      while (!rest.empty()) {
        const auto end = std::min(rest.find('\n'), rest.size());
        auto words = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        for (auto word = next_word(words); !word.empty(); word = next_word(words)) {
          double x = 0;
          if (const auto why = why_no_number(word, x); !why.empty())
            fail_at(a, in_quotes(word), ' ', why);
          out.push_back(x);
        }
      }
      return out;
    }
    const std::size_t head = size_of(header_), one = size_of(a.type);
    if (a.begin > bytes_.size() || bytes_.size() - a.begin < head)
      fail_at(a, "begins at byte ", a.begin, " of ", bytes_.size(),
              " that are appended; the file is cut short");
    std::uint64_t length = 0;
    std::memcpy(&length, bytes_.data() + a.begin, head);
    if (length > bytes_.size() - a.begin - head || length % one != 0)
      fail_at(a, "has ", length, " bytes by its header, in which only ",
              bytes_.size() - a.begin - head, " follow and a number has ", one,
              "; the file is cut short or damaged");
    out.reserve(length / one);
    for (std::size_t k = 0; k < length; k += one)
      out.push_back(number_at(bytes_.data() + a.begin + head + k, a.type));
    return out;
  }

  std::size_t line() const {
    const auto before = content_.substr(0, tag_);
    return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  }
  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    throw FileError(text(file_, ", line ", line(), ": ", parts...));
  }
  template <class... Parts>
  [[noreturn]] void fail_at(const Array& array, const Parts&... parts) const {
    throw FileError(
        text(file_, ", line ", array.line, ": array ", in_quotes(array.name), ": ", parts...));
  }

  std::string file_;
  std::string_view content_, xml_{}, bytes_{}, name_{}, attributes_{};
  bool raw_ = false;
  NumberType header_ = NumberType::UInt32;  // of the lengths before arrays
  std::size_t at_ = 0, tag_ = 0;
  std::uint64_t points_ = 0, polygons_ = 0;  // of the piece
  std::optional<Array> places_, corners_, ends_;
  Polygons out_;
};

}  // namespace silt::inline SILT_TARGET::detail
