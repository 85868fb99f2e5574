// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>

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

/// Collects named arrays and writes them as one file with a checksum.
///
///   silt::CheckpointWriter checkpoint{"Sphere HertzMindlin VerletList"};
///   checkpoint.add("position", positions);  // a view: keep the array until commit
///   checkpoint.commit("run.silt");          // atomic: the old file or the new one, never a mix
///
/// `signature` identifies the programs that can continue from the file: their policies and fields.
/// Errors: InputError for an empty or repeated name; FileError if the file cannot be written.
class CheckpointWriter {
 public:
  explicit CheckpointWriter(std::string signature) : signature_(std::move(signature)) {}

  /// An array of double, float or integers; it is not copied and must exist until `commit`.
  template <class Values>
  void add(std::string_view name, Values&& values) {
    const auto view = detail::lasting_view(std::forward<Values>(values));
    using Value = typename decltype(view)::value_type;
    add_field({std::string(name), detail::checkpoint_type<Value>(), view.size(), view.data(), {}});
  }
  void add_text(std::string_view name, std::string_view content) {
    add_field({std::string(name), detail::checkpoint_text, content.size(), nullptr,
               std::string(content)});
  }

  detail::CheckpointStamp commit(const std::string& path) const {
    AtomicFile file(path);
    detail::Crc64 crc;
    std::uint64_t all = sizeof(std::uint64_t);
    const auto write = [&](const void* data, std::size_t bytes) {
      constexpr char zeros[8] = {};
      crc.add(data, bytes);
      file.write(data, bytes);
      const std::size_t padding = detail::padded_to_8(bytes) - bytes;
      crc.add(zeros, padding);
      file.write(zeros, padding);
      all += bytes + padding;
    };
    const std::string head = start_and_table();
    write(head.data(), head.size());
    for (const auto& field : fields_) write(field.values(), field.bytes());
    const std::uint64_t sum = crc.value();
    file.write(&sum, sizeof sum);
    file.commit();
    return {all, sum};
  }

 private:
  struct Field {
    std::string name;
    detail::CheckpointType type;
    std::uint64_t count;
    const void* array;    // unless text
    std::string content;  // if text
    const void* values() const { return array != nullptr ? array : content.data(); }
    std::size_t bytes() const { return count * type.size; }
  };

  void add_field(Field field) {
    require(!field.name.empty(), "CheckpointWriter: a field's name is empty");
    for (const auto& other : fields_)
      require(other.name != field.name, "CheckpointWriter: there are two fields named ",
              in_quotes(field.name), "; give each its own name");
    fields_.push_back(std::move(field));
  }

  std::string start_and_table() const {
    std::string table;
    detail::append_bytes(table, std::uint64_t{signature_.size()});
    table += signature_;
    detail::append_bytes(table, std::uint64_t{fields_.size()});
    std::uint64_t payload = 0;
    for (const auto& field : fields_) {
      detail::append_bytes(table, static_cast<std::uint32_t>(field.name.size()));
      table += field.name;
      table += field.type.kind;
      table += static_cast<char>(field.type.size);
      detail::append_bytes(table, field.count);
      payload += detail::padded_to_8(field.bytes());
    }
    std::string start{detail::checkpoint_magic};
    detail::append_bytes(start, detail::byte_order_mark);
    detail::append_bytes(start, detail::checkpoint_version);
    const std::uint64_t table_end = detail::padded_to_8(detail::checkpoint_start + table.size());
    detail::append_bytes(start, table_end + payload + sizeof(std::uint64_t));
    detail::append_bytes(start, std::uint64_t{table.size()});
    return start + table;
  }

  std::string signature_;
  std::vector<Field> fields_;
};

/// Opens a checkpoint and checks all of it; the arrays are then read one by one.
/// Errors: FileError, one sentence with the path: cannot be read, empty, not a checkpoint, another
///         byte order, a newer version, truncated, damaged; later: another signature, a missing
///         field, another type or count. Sizes in the file are checked against its length before
///         memory is allocated.
class CheckpointReader {
 public:
  explicit CheckpointReader(const std::string& path) : file_(path, O_RDONLY, path) {
    const std::uint64_t table_bytes = check_start();
    check_sum();
    read_table(table_bytes);
  }

  const std::string& signature() const { return signature_; }
  detail::CheckpointStamp stamp() const {
    detail::CheckpointStamp s{size_, 0};
    file_.read_at(size_ - sizeof s.sum, &s.sum, sizeof s.sum);
    return s;
  }

  /// FileError, with both signatures and their first difference, unless the file's is `expected`.
  void require_signature(std::string_view expected) const {
    if (signature_ == expected) return;
    const auto parts =
        std::mismatch(signature_.begin(), signature_.end(), expected.begin(), expected.end());
    const auto at = static_cast<std::size_t>(parts.first - signature_.begin());
    // From the start of the policy, or other item between semicolons, in which they differ.
    const std::size_t part = at == 0 ? 0 : std::string_view(expected).rfind(';', at - 1) + 1;
    const auto from = [&](std::string_view whole) {
      std::size_t begin = std::min(whole.find_first_not_of(' ', part), at);
      if (at - begin > 80) begin = at - 40;
      return in_quotes(whole.substr(begin, whole.find(';', begin) - begin), 120);
    };
    const auto rest = [&](std::string_view whole) {
      return at < whole.size() ? in_quotes(whole.substr(at), 32) : std::string("nothing more");
    };
    const std::string lacks = only_in(signature_, expected), more = only_in(expected, signature_);
    const auto which = [&](const std::string& of, const char* who, const char* whom) {
      return of.empty() ? std::string()
                        : silt::text(who, " has ", of, ", which ", whom, " lacks; ");
    };
    const std::string policies =
        lacks.empty() && more.empty()
            ? silt::text("it was written by ", from(signature_), ", this program is ",
                         from(expected), "; ")
            : which(lacks, "the file", "this program") + which(more, "this program", "the file");
    refuse("belongs to another program: ", policies, "they first differ at character ", at + 1,
           ", where the file has ", rest(signature_), " and the program ", rest(expected));
  }

  bool has(std::string_view name) const { return find(name) != nullptr; }

  template <class T>
  std::vector<T> get(std::string_view name) const {
    const Field& field = require_field(name, detail::checkpoint_type<T>());
    std::vector<T> values(field.count);
    file_.read_at(field.offset, values.data(), values.size() * sizeof(T));
    return values;
  }

  /// The same; refuses a field with another number of values than `count`.
  template <class T>
  std::vector<T> get(std::string_view name, std::size_t count) const {
    const Field& field = require_field(name, detail::checkpoint_type<T>());
    if (field.count != count)
      refuse("has ", field.count, " values in its field '", name, "', but ", count, " are needed");
    return get<T>(name);
  }

  /// Number of values of a field; refuses a field of another type.
  template <class T>
  std::uint64_t count(std::string_view name) const {
    return require_field(name, detail::checkpoint_type<T>()).count;
  }
  /// Reads a field of exactly `count` values into existing memory.
  template <class T>
  void read(std::string_view name, T* to, std::size_t count) const {
    const Field& field = require_field(name, detail::checkpoint_type<T>());
    if (field.count != count)
      refuse("has ", field.count, " values in its field '", name, "', but ", count, " are needed");
    file_.read_at(field.offset, to, count * sizeof(T));
  }

  std::string text(std::string_view name) const {
    const Field& field = require_field(name, detail::checkpoint_text);
    std::string content(field.count, '\0');
    file_.read_at(field.offset, content.data(), content.size());
    return content;
  }

 private:
  /// Parts between semicolons of a kind, their first word, that are in `whole` but not in `other`,
  /// in quotes; empty: none.
  static std::string only_in(std::string_view whole, std::string_view other) {
    const auto next = [](std::string_view& rest) {
      const std::string_view part = rest.substr(0, rest.find(';'));
      rest.remove_prefix(std::min(part.size() + 1, rest.size()));
      return part.substr(std::min(part.find_first_not_of(' '), part.size()));
    };
    const auto kind = [](std::string_view part) { return part.substr(0, part.find(' ')); };
    std::string all;
    while (!whole.empty()) {
      const std::string_view part = next(whole);
      bool is_there = part.empty();
      for (std::string_view rest = other; !rest.empty() && !is_there;)
        is_there = kind(next(rest)) == kind(part);
      if (!is_there) all += (all.empty() ? "" : ", ") + in_quotes(part, 120);
    }
    return all;
  }

  struct Field {
    std::string name;
    detail::CheckpointType type;
    std::uint64_t count, offset;
  };

  template <class... Parts>
  [[noreturn]] void refuse(const Parts&... parts) const {
    throw FileError(silt::text("checkpoint '", file_.name(), "' ", parts...));
  }
  [[noreturn]] void refuse_table() const { refuse("is damaged: its table of fields is invalid"); }

  /// Checks the part before the table; returns the table's size [bytes].
  std::uint64_t check_start() {
    size_ = file_.size();
    if (size_ == 0) refuse("is empty");
    detail::check_size(size_, file_.name());
    char start[detail::checkpoint_start] = {};
    const auto got = static_cast<std::size_t>(std::min<std::uint64_t>(size_, sizeof start));
    file_.read_at(0, start, got);
    const auto magic = detail::checkpoint_magic.substr(0, got);
    if (std::string_view(start, magic.size()) != magic) refuse("is no checkpoint of silt");
    if (got < sizeof start) refuse("is truncated: only ", size_, " bytes are left");
    std::uint32_t mark, version;
    std::uint64_t whole, table_bytes;
    std::memcpy(&mark, start + 8, 4), std::memcpy(&version, start + 12, 4);
    std::memcpy(&whole, start + 16, 8), std::memcpy(&table_bytes, start + 24, 8);
    if (mark == 0x04030201)
      refuse(
          "was written on a machine with the other byte order (big endian); it can only be "
          "continued on such a machine");
    if (mark != detail::byte_order_mark) refuse("is damaged: its byte-order mark is wrong");
    if (version > detail::checkpoint_version)
      refuse("has format version ", version, ", and this program reads version ",
             detail::checkpoint_version, ": it is from a newer silt, or damaged");
    if (version == 0) refuse("is damaged: its format version is 0");
    if (version < detail::checkpoint_version)
      refuse("has format version ", version, ", and this program reads version ",
             detail::checkpoint_version, ": continue with the version of silt that wrote it");
    if (size_ < whole) refuse("is truncated: ", size_, " of ", whole, " bytes are left");
    if (size_ > whole) refuse("is damaged: it has ", size_, " bytes, but was written with ", whole);
    return table_bytes;
  }

  void check_sum() const {
    detail::Crc64 crc;
    std::vector<char> block(std::size_t{1} << 20);
    const std::uint64_t end = size_ - sizeof(std::uint64_t);
    for (std::uint64_t at = 0; at < end; at += block.size()) {
      const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), end - at));
      file_.read_at(at, block.data(), bytes);
      crc.add(block.data(), bytes);
    }
    std::uint64_t stored;
    file_.read_at(end, &stored, sizeof stored);
    if (stored != crc.value())
      refuse("is damaged: its checksum does not match its ", size_, " bytes");
  }

  // A matching checksum does not guarantee valid numbers in the table: all are checked again.
  void read_table(std::uint64_t table_bytes) {
    const std::uint64_t end = size_ - sizeof(std::uint64_t);
    if (end < detail::checkpoint_start || table_bytes > end - detail::checkpoint_start ||
        table_bytes > detail::checkpoint_most_table)
      refuse_table();
    std::string table(table_bytes, '\0');
    file_.read_at(detail::checkpoint_start, table.data(), table.size());
    std::string_view rest = table;
    const auto take = [&](std::uint64_t bytes) {
      if (bytes > rest.size()) refuse_table();
      const auto taken = rest.substr(0, bytes);
      rest.remove_prefix(bytes);
      return taken;
    };
    const auto number = [&]<class T>(T value) {
      std::memcpy(&value, take(sizeof value).data(), sizeof value);
      return value;
    };
    signature_ = take(number(std::uint64_t{}));
    std::uint64_t offset = detail::padded_to_8(detail::checkpoint_start + table_bytes);
    for (auto fields = number(std::uint64_t{}); fields > 0; --fields) {
      Field field;
      field.name = take(number(std::uint32_t{}));
      field.type.kind = take(1)[0];
      field.type.size = static_cast<std::uint8_t>(take(1)[0]);
      field.count = number(std::uint64_t{});
      field.offset = offset;
      if (offset > end || field.type.size == 0 || field.count > (end - offset) / field.type.size)
        refuse_table();
      offset += detail::padded_to_8(field.count * field.type.size);
      fields_.push_back(std::move(field));
    }
    if (offset != end || !rest.empty()) refuse_table();
    std::vector<std::string_view> names;
    for (const auto& field : fields_) names.push_back(field.name);
    std::sort(names.begin(), names.end());
    const auto twice = std::adjacent_find(names.begin(), names.end());
    if (twice != names.end()) refuse("is damaged: it has two fields named ", in_quotes(*twice));
  }

  const Field* find(std::string_view name) const {
    for (const auto& field : fields_)
      if (field.name == name) return &field;
    return nullptr;
  }

  const Field& require_field(std::string_view name, detail::CheckpointType type) const {
    const Field* field = find(name);
    if (field == nullptr) {
      std::string names;
      constexpr std::size_t most = 10;
      for (std::size_t k = 0; k < std::min(fields_.size(), most); ++k)
        names += silt::text(names.empty() ? "" : ", ", in_quotes(fields_[k].name));
      if (fields_.size() > most) names += silt::text(" and ", fields_.size() - most, " more");
      refuse("has no field '", name, "'; it has ", names.empty() ? "none at all" : names);
    }
    if (field->type != type)
      refuse("has its field '", name, "' as ", detail::type_name(field->type), ", but ",
             detail::type_name(type), " is needed");
    return *field;
  }

  detail::File file_;
  std::uint64_t size_ = 0;  // [bytes]
  std::string signature_;
  std::vector<Field> fields_;
};

}  // namespace silt
