// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/checkpoint_format.hpp>

namespace silt::inline SILT_TARGET {

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
  DynArray<T> get(std::string_view name) const {
    const Field& field = require_field(name, detail::checkpoint_type<T>());
    DynArray<T> values(field.count);
    file_.read_at(field.offset, values.data(), values.size() * sizeof(T));
    return values;
  }

  /// The same; refuses a field with another number of values than `count`.
  template <class T>
  DynArray<T> get(std::string_view name, std::size_t count) const {
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
    if (std::string_view(start, magic.size()) != magic) refuse("is not a checkpoint of silt");
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
    DynArray<char> block(std::size_t{1} << 20);
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
    DynArray<std::string_view> names;
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
  DynArray<Field> fields_;
};

}  // namespace silt
