// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/files/atomic_file.hpp>

/// Reads and writes STL files, the unconnected triangles that CAD programs export. Format: 3D
/// Systems, StereoLithography Interface Specification (1988), sections 6.5 (ASCII, here in any
/// letter case, several solids per file) and 6.6 (binary, little-endian floats).
/// Units:  STL has none; silt expects metres, `scale` converts (1e-3 for a file in mm).
/// Errors: FileError with file, line or triangle, what was found and what is expected.
/// Tests:  tests/boundary/stl.cpp

namespace silt::inline SILT_TARGET {

/// Format of write_stl(): binary or text.
enum class StlFormat { Binary, Ascii };

namespace detail {

inline constexpr std::size_t stl_header_bytes = 84, stl_triangle_bytes = 50;

template <class... Parts>
[[noreturn]] void stl_error(const Parts&... parts) {
  throw FileError(text(parts...));
}

/// Four bytes, little-endian, on any machine.
inline std::uint32_t get_u32(const char* bytes) {
  std::uint32_t value = 0;
  for (int k = 3; k >= 0; --k) value = value << 8 | static_cast<unsigned char>(bytes[k]);
  return value;
}
inline void put_u32(std::string& out, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) out += static_cast<char>(value >> 8 * k & 0xff);
}

inline DynArray<std::array<Vec3d, 3>> parse_binary_stl(std::string_view bytes) {
  DynArray<std::array<Vec3d, 3>> triangles(get_u32(bytes.data() + 80));
  const char* at = bytes.data() + stl_header_bytes;
  const auto coordinate = [&at] {
    const auto value = static_cast<double>(std::bit_cast<float>(get_u32(at)));
    at += 4;
    return value;
  };
  for (auto& triangle : triangles) {
    at += 12;  // the normal follows from the corners
    for (auto& corner : triangle)
      corner.x = coordinate(), corner.y = coordinate(), corner.z = coordinate();
    at += 2;  // "attribute byte count"
  }
  return triangles;
}

/// Tokens and lines of an ASCII STL file.
class AsciiStl {
 public:
  AsciiStl(const std::string& path, std::string_view characters) : path_(path), rest_(characters) {}

  DynArray<std::array<Vec3d, 3>> parse() {
    DynArray<std::array<Vec3d, 3>> triangles;
    expect(next(), "solid");
    do {
      skip_name();
      auto word = next();
      for (; is(word, "facet"); word = next()) triangles.push_back(facet());
      if (!is(word, "endsolid")) fail("expected 'facet' or 'endsolid', found ", shown(word));
      skip_name();
    } while (another_solid());
    return triangles;
  }

 private:
  std::array<Vec3d, 3> facet() {
    expect(next(), "normal");
    for (int k = 0; k < 3; ++k) next();  // follows from the corners; often 0 or nan
    expect(next(), "outer");
    expect(next(), "loop");
    std::array<Vec3d, 3> corners;
    for (auto& corner : corners) {
      expect(next(), "vertex");
      corner.x = number(), corner.y = number(), corner.z = number();
    }
    expect(next(), "endloop");
    expect(next(), "endfacet");
    return corners;
  }

  bool another_solid() {
    const auto word = next();
    if (!word.empty()) expect(word, "solid");
    return !word.empty();
  }

  double number() {
    const auto word = next();
    const auto digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::result_out_of_range)
      fail("the number ", shown(word), " is too large or too small");
    if (error != std::errc{} || end != digits.data() + digits.size())
      fail("expected a number, found ", shown(word));
    return value;
  }

  std::string_view next() {
    while (!rest_.empty() && is_space(rest_.front())) {
      line_ += rest_.front() == '\n' || (rest_.front() == '\r' && !rest_.starts_with("\r\n"));
      rest_.remove_prefix(1);
    }
    std::size_t n = 0;
    while (n < rest_.size() && !is_space(rest_[n])) ++n;
    const auto word = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return word;
  }
  /// Name of a solid: the rest of the line, unless a facet begins on it.
  void skip_name() {
    const std::size_t end = std::min(rest_.find_first_of("\n\r"), rest_.size());
    AsciiStl line(path_, rest_.substr(0, end));
    for (std::string_view before = line.rest_; !before.empty(); before = line.rest_)
      if (is(line.next(), "facet")) {
        const auto at = static_cast<std::size_t>(before.data() - rest_.data());
        if (is(AsciiStl(line).next(), "normal")) return rest_.remove_prefix(at);
      }
    rest_.remove_prefix(end);
  }

  void expect(std::string_view word, std::string_view wanted) const {
    if (!is(word, wanted)) fail("expected '", wanted, "', found ", shown(word));
  }
  template <class... Parts>
  [[noreturn]] void fail(const Parts&... parts) const {
    stl_error("STL file ", path_, ", line ", line_, ": ", parts...);
  }

  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  static bool is(std::string_view word, std::string_view lower_case) {
    return std::equal(
        word.begin(), word.end(), lower_case.begin(), lower_case.end(),
        [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
  }
  static std::string shown(std::string_view word) {
    return word.empty() ? "the end of the file" : in_quotes(word);
  }

  const std::string& path_;
  std::string_view rest_;
  std::size_t line_ = 1;
};

/// Binary if the size agrees with the count in the header, whatever the header says; else text if
/// there is no zero byte, as every binary file has some.
inline DynArray<std::array<Vec3d, 3>> parse_stl(const std::string& path) {
  return read_from(path, [&](const File& file, std::uint64_t bytes) {
    if (bytes == 0) stl_error("STL file ", path, " is empty");
    const bool has_header = bytes >= stl_header_bytes;
    char header[stl_header_bytes] = {};
    if (has_header) file.read_at(0, header, sizeof header);
    const std::uint64_t count = get_u32(header + 80);
    const std::uint64_t expected = stl_header_bytes + stl_triangle_bytes * count;
    if (has_header && bytes == expected)
      return parse_binary_stl(read_blocks(file, bytes, [](std::string_view) {}));
    const std::string content = read_blocks(file, bytes, [&](std::string_view block) {
      if (block.find('\0') == std::string_view::npos) return;
      if (!has_header)
        stl_error("STL file ", path, " is not text and has ", bytes,
                  " bytes; a binary STL file begins with a header of 84 bytes");
      stl_error("STL file ", path, " is binary and announces ", count, " triangles, that is ",
                expected, " bytes, but has ", bytes, " bytes; it is ",
                bytes < expected ? "truncated or " : "", "not an STL file");
    });
    std::string_view characters = content;
    if (characters.starts_with(utf8_mark)) characters.remove_prefix(utf8_mark.size());
    return AsciiStl(path, characters).parse();
  });
}

inline bool fits_float(double value) {
  return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

inline Vec3d facet_normal(const std::array<Vec3d, 3>& triangle) {
  const Vec3d normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const double length = norm(normal);
  return length > 0 && std::isfinite(length) ? normal * (1 / length) : Vec3d{0, 0, 0};
}

inline void append_binary(std::string& out, const Vec3d& v) {
  for (const double value : {v.x, v.y, v.z})
    put_u32(out, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}
inline void append_ascii(std::string& out, const Vec3d& v) {
  out += text(' ', v.x, ' ', v.y, ' ', v.z, '\n');
}

inline std::string binary_stl(const DynArray<std::array<Vec3d, 3>>& triangles) {
  std::string out = "binary STL written by silt, in metres";  // must not begin with "solid"
  out.resize(80, ' ');
  put_u32(out, static_cast<std::uint32_t>(triangles.size()));
  for (const auto& triangle : triangles) {
    append_binary(out, facet_normal(triangle));
    for (const auto& corner : triangle) append_binary(out, corner);
    out.append(2, '\0');
  }
  return out;
}

inline std::string ascii_stl(const DynArray<std::array<Vec3d, 3>>& triangles) {
  std::string out = "solid silt\n";
  for (const auto& triangle : triangles) {
    append_ascii(out += "facet normal", facet_normal(triangle));
    out += "outer loop\n";
    for (const auto& corner : triangle) append_ascii(out += "vertex", corner);
    out += "endloop\nendfacet\n";
  }
  return out += "endsolid silt\n";
}

}  // namespace detail

/// Triangles of an ASCII or binary STL file, corners times `scale` [m per unit of the file].
inline DynArray<std::array<Vec3d, 3>> read_stl(const std::string& path, double scale = 1) {
  require_positive("read_stl: scale", scale, "m per file unit");
  auto triangles = detail::parse_stl(path);
  if (triangles.empty()) detail::stl_error("STL file ", path, " has no triangles");
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (auto& corner : triangles[t]) {
      const Vec3d in_file = corner;
      corner *= scale;
      if (!is_finite(corner))
        detail::stl_error("STL file ", path, ": triangle ", t + 1, " of ", triangles.size(),
                          " has the corner ", in_file, ", times scale = ", scale,
                          "; coordinates must be finite");
    }
  return triangles;
}

/// Writes triangles [m]. The file is replaced only when all is written. Binary files round to float
/// (7 digits), ASCII files keep every digit.
inline void write_stl(const std::string& path, const DynArray<std::array<Vec3d, 3>>& triangles,
                      StlFormat format = StlFormat::Binary) {
  require(!triangles.empty() && triangles.size() <= std::numeric_limits<std::uint32_t>::max(),
          "write_stl: ", triangles.size(), " triangles for ", path,
          "; an STL file holds at least 1 and at most 2^32 - 1");
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const auto& corner : triangles[t])
      require(detail::fits_float(corner.x) && detail::fits_float(corner.y) &&
                  detail::fits_float(corner.z),
              "write_stl: triangle ", t + 1, " of ", triangles.size(), " for ", path,
              " has the corner ", corner, " [m]; coordinates must be finite and below 3.4e38");
  AtomicFile file(path);
  file.write(format == StlFormat::Binary ? detail::binary_stl(triangles)
                                         : detail::ascii_stl(triangles));
  file.commit();
}

}  // namespace silt
