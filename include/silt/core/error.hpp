// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <charconv>
#include <concepts>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <silt/core/vec3.hpp>

namespace silt {

/// Everything silt throws derives from this; `what()` is one sentence: what, where, what to change.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A value, file or combination that cannot be used. Nothing has been changed or written.
struct InputError : Error {
  using Error::Error;
};

/// A file or folder that cannot be read or written (missing, full disk, damaged content).
struct FileError : Error {
  using Error::Error;
};

/// The run itself went wrong: not a number, overlap or time step over its limit, a particle outside.
struct SimulationError : Error {
  SimulationError(const std::string& sentence, std::int64_t at_step, std::vector<std::uint32_t> ids,
                  Vec3d where)
      : Error(sentence), step(at_step), particles(std::move(ids)), position(where) {}
  std::int64_t step;
  std::vector<std::uint32_t> particles;
  Vec3d position;  // [m]
};

namespace detail {

inline void append(std::string& out, std::string_view text) { out += text; }
inline void append(std::string& out, char c) { out += c; }
inline void append(std::string& out, double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  out.append(buffer, end);
}
inline void append(std::string& out, std::integral auto value) { out += std::to_string(value); }
inline void append(std::string& out, const Vec3d& v) {
  out += '(';
  append(out, v.x), out += ", ", append(out, v.y), out += ", ", append(out, v.z);
  out += ')';
}

}  // namespace detail

/// Joins words and numbers (shortest form that reads back exactly) into one string.
template <class... Parts>
std::string text(const Parts&... parts) {
  std::string out;
  (detail::append(out, parts), ...);
  return out;
}

/// Throws InputError with the joined parts unless `condition` holds.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) throw InputError(text(parts...));
}

/// Throws InputError unless `value` is finite and in [low, high]: name, value, unit, range.
inline void require_in(std::string_view name, double value, std::string_view unit, double low,
                       double high) {
  require(value >= low && value <= high, name, " = ", value, " [", unit, "] must be in [", low, ", ",
          high, "]");
}

/// Throws InputError unless `value` is finite and > 0: name, value, unit.
inline void require_positive(std::string_view name, double value, std::string_view unit) {
  require(std::isfinite(value) && value > 0, name, " = ", value, " [", unit,
          "] must be finite and greater than 0");
}

/// Throws InputError unless `value` is finite and >= 0: name, value, unit.
inline void require_not_negative(std::string_view name, double value, std::string_view unit) {
  require(std::isfinite(value) && value >= 0, name, " = ", value, " [", unit,
          "] must be finite and not negative");
}

}  // namespace silt

/// Broken internal invariant in a hot path: checked in debug builds only.
#if defined(NDEBUG) && !defined(SILT_CHECKED)
#define SILT_ASSERT(condition) ((void)0)
#else
#include <cassert>
#define SILT_ASSERT(condition) assert(condition)
#endif
