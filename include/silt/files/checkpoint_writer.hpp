// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/files/checkpoint_format.hpp>

namespace silt::inline SILT_TARGET {

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
  DynArray<Field> fields_;
};

}  // namespace silt
