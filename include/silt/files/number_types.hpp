// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET::detail {

static_assert(
    std::endian::native == std::endian::little,
    "silt/files: binary PLY and VTP files are read in the machine's byte order, which must "
    "be little endian; a big-endian port has to swap bytes here");

/// Types of numbers in binary files of other programs, known at run time.
enum class NumberType {
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};
inline constexpr std::size_t number_types = 10;

inline constexpr bool is_real(NumberType t) { return t >= NumberType::Float32; }
inline constexpr std::size_t size_of(NumberType t) {
  constexpr std::size_t bytes[number_types] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return bytes[static_cast<std::size_t>(t)];
}

template <class T>
double number_of_type(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}
/// The number that starts at these bytes, little-endian. Integers are exact up to 2^53.
inline double number_at(const char* bytes, NumberType type) {
  switch (type) {
    case NumberType::Int8:
      return number_of_type<std::int8_t>(bytes);
    case NumberType::UInt8:
      return number_of_type<std::uint8_t>(bytes);
    case NumberType::Int16:
      return number_of_type<std::int16_t>(bytes);
    case NumberType::UInt16:
      return number_of_type<std::uint16_t>(bytes);
    case NumberType::Int32:
      return number_of_type<std::int32_t>(bytes);
    case NumberType::UInt32:
      return number_of_type<std::uint32_t>(bytes);
    case NumberType::Int64:
      return number_of_type<std::int64_t>(bytes);
    case NumberType::UInt64:
      return number_of_type<std::uint64_t>(bytes);
    case NumberType::Float32:
      return number_of_type<float>(bytes);
    case NumberType::Float64:
      break;
  }
  return number_of_type<double>(bytes);
}

}  // namespace silt::inline SILT_TARGET::detail
