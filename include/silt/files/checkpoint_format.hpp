// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

static_assert(std::endian::native == std::endian::little,
              "silt/io: checkpoints are written in the machine's byte order, which must be little "
              "endian; a big-endian port has to swap bytes here");

/// CRC-64/XZ, sixteen bytes at a time. Detects every error burst of up to 64 bits, thus every
/// single flipped bit, and any other damage with a probability of 1 - 2^-64.
class Crc64 {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* from = static_cast<const unsigned char*>(data);
    std::uint64_t crc = crc_;
    for (; bytes >= 16; bytes -= 16, from += 16) {
      std::uint64_t words[2];
      std::memcpy(words, from, 16);
      words[0] ^= crc;
      crc = 0;
      for (int k = 0; k < 16; ++k) crc ^= tables[15 - k][(words[k / 8] >> (8 * (k % 8))) & 0xff];
    }
    for (; bytes > 0; --bytes, ++from) crc = tables[0][(crc ^ *from) & 0xff] ^ (crc >> 8);
    crc_ = crc;
  }
  std::uint64_t value() const { return ~crc_; }

 private:
  using Tables = std::array<std::array<std::uint64_t, 256>, 16>;
  static constexpr Tables make_tables() {
    Tables t{};
    for (unsigned byte = 0; byte < 256; ++byte) {
      std::uint64_t crc = byte;
      for (int bit = 0; bit < 8; ++bit)
        crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xC96C5795D7870F42u : 0u);  // ECMA-182, reflected
      t[0][byte] = crc;
    }
    for (unsigned k = 1; k < 16; ++k)
      for (unsigned byte = 0; byte < 256; ++byte)
        t[k][byte] = t[0][t[k - 1][byte] & 0xff] ^ (t[k - 1][byte] >> 8);
    return t;
  }
  static const Tables tables;

  std::uint64_t crc_ = ~std::uint64_t{0};
};
inline constexpr Crc64::Tables Crc64::tables = Crc64::make_tables();

/// Type of a field's values.
struct CheckpointType {
  char kind;          // 'f' floating point, 'u' unsigned, 'i' signed, 't' text
  std::uint8_t size;  // [bytes]
  bool operator==(const CheckpointType&) const = default;
};
inline constexpr CheckpointType checkpoint_text{'t', 1};

template <class T>
constexpr CheckpointType checkpoint_type() {
  static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8 && !std::is_same_v<T, bool> &&
                    !std::is_same_v<T, char>,
                "a checkpoint holds arrays of double, float and integers of fixed size (and text: "
                "add_text)");
  return {std::is_floating_point_v<T> ? 'f' : std::is_unsigned_v<T> ? 'u' : 'i', sizeof(T)};
}

inline std::string type_name(CheckpointType type) {
  if (type.kind == 't') return "text";
  return text(type.kind == 'f' ? "float" : type.kind == 'u' ? "uint" : "int", type.size * 8);
}

inline constexpr std::uint64_t padded_to_8(std::uint64_t bytes) { return (bytes + 7) / 8 * 8; }

// The file: 8 bytes magic | u32 byte-order mark | u32 version | u64 bytes of the whole file | u64
// bytes of the table | the table, padded to 8 | each field's values, padded to 8 | u64 CRC-64 of
// all preceding bytes. The table: u64 length and characters of the signature, u64 number of fields,
// and for each its u32 name length, name, kind, size, u64 count.
inline constexpr std::string_view checkpoint_magic = "\x89SILTCP\n";
inline constexpr std::uint32_t byte_order_mark = 0x01020304;
inline constexpr std::uint32_t checkpoint_version = 2;  // 2: ids of 64 bits
inline constexpr std::size_t checkpoint_start = 32;     // [bytes] before the table
inline constexpr std::size_t checkpoint_most_table = std::size_t{1} << 20;  // [bytes]

/// Identifies a file: its length, and the checksum at its end.
struct CheckpointStamp {
  std::uint64_t bytes = 0, sum = 0;
  bool operator==(const CheckpointStamp&) const = default;
};

template <class T>
void append_bytes(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

}  // namespace detail

}  // namespace silt
