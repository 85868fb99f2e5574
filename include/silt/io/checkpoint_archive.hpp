// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/files/checkpoint_file.hpp>

/// Archives of a checkpoint. One function visits the state of a component, and CheckpointSaver or
/// CheckpointLoader saves or loads it. See io/checkpoint_parts.hpp.

namespace silt::inline SILT_TARGET::detail {

/// Values that a number of a checkpoint may have.
struct NumberRule {
  bool (*holds)(double);
  const char* words;
};
inline constexpr NumberRule finite_number{[](double x) { return std::isfinite(x); },
                                          "must be finite"};
inline constexpr NumberRule known_number{[](double x) { return !std::isnan(x); },
                                         "must be a number"};
inline constexpr NumberRule not_negative_number{[](double x) { return std::isfinite(x) && x >= 0; },
                                                "must be finite and not negative"};
inline constexpr NumberRule positive_number{[](double x) { return std::isfinite(x) && x > 0; },
                                            "must be finite and greater than 0"};
inline constexpr NumberRule flag_number{[](double x) { return x == 0 || x == 1; },
                                        "must be 0 or 1"};
/// Integers that a double represents exactly, and that do not overflow when they are incremented.
inline constexpr NumberRule count_number{
    [](double x) { return x >= 0 && x <= 0x1p53 && x == std::floor(x); },
    "must be a whole number from 0 to 2^53"};
inline constexpr NumberRule count_or_never{
    [](double x) { return x >= -1 && x <= 0x1p53 && x == std::floor(x); },
    "must be a whole number from -1 to 2^53"};
inline constexpr NumberRule place_number{
    [](double x) { return x >= 0 && x < 4294967296.0 && x == std::floor(x); },
    "must be a whole number below 2^32"};

/// Writes what it visits. Columns are not copied: they must exist until the writer's commit.
class CheckpointSaver {
 public:
  static constexpr bool loads = false;
  explicit CheckpointSaver(CheckpointWriter& out) : out_(out) {}

  template <class T>
  void number(const std::string& name, const T& value, const NumberRule&) {
    if constexpr (std::is_floating_point_v<T>)
      out_.add(name, reals_.emplace_back(1, value));
    else
      out_.add(name, integers_.emplace_back(1, static_cast<std::int64_t>(value)));
  }
  template <class T>
  void column(const std::string& name, const DynArray<T>& values, std::size_t,
              const NumberRule& = finite_number) {
    out_.add(name, values);
  }
  /// A column that is copied and need not outlive the call.
  template <class T>
  void copied(const std::string& name, DynArray<T> values) {
    if constexpr (std::is_same_v<T, double>)
      out_.add(name, reals_.emplace_back(std::move(values)));
    else if constexpr (std::is_same_v<T, std::int64_t>)
      out_.add(name, integers_.emplace_back(std::move(values)));
    else
      out_.add(name, words_.emplace_back(std::move(values)));
  }
  /// The first `count` rows, which consist of doubles or of integers of the same size.
  template <class Rows>
  void rows(const std::string& name, const Rows& rows, std::size_t count) {
    using Row = typename Rows::value_type;
    static_assert(sizeof(Row) % sizeof(double) == 0 && std::is_trivially_copyable_v<Row>);
    out_.add(name, std::span<const double>(reinterpret_cast<const double*>(rows.data()),
                                           count * sizeof(Row) / sizeof(double)));
  }

 private:
  CheckpointWriter& out_;
  std::deque<DynArray<double>> reals_;
  std::deque<DynArray<std::int64_t>> integers_;
  std::deque<DynArray<std::uint32_t>> words_;
};

/// Reads what it visits from a file, and refuses numbers that violate their rule.
class CheckpointLoader {
 public:
  static constexpr bool loads = true;
  static constexpr std::size_t any_count = std::numeric_limits<std::size_t>::max();
  explicit CheckpointLoader(const CheckpointReader& in, const std::string& path)
      : in_(in), path_(path) {}

  template <class... Parts>
  [[noreturn, gnu::cold]] void refuse(const Parts&... parts) const {
    throw FileError(text("checkpoint '", path_, "' is damaged: ", parts...));
  }
  template <class... Parts>
  void need(bool condition, const Parts&... parts) const {
    if (!condition) [[unlikely]]
      refuse(parts...);
  }
  void check(const std::string& name, std::span<const double> values,
             const NumberRule& rule) const {
    for (std::size_t k = 0; k < values.size(); ++k)
      need(rule.holds(values[k]), name, "[", k, "] = ", values[k], " ", rule.words);
  }

  template <class T>
  void number(const std::string& name, T& value, const NumberRule& rule) const {
    if constexpr (std::is_floating_point_v<T>) {
      in_.read(name, &value, 1);
      need(rule.holds(value), name, " = ", value, " ", rule.words);
    } else {
      std::int64_t whole = 0;
      in_.read(name, &whole, 1);
      need(rule.holds(static_cast<double>(whole)) &&
               static_cast<double>(static_cast<T>(whole)) == static_cast<double>(whole),
           name, " = ", whole, " ", rule.words);
      value = static_cast<T>(whole);
    }
  }
  /// Exactly `count` values, or as many as the file has.
  template <class T>
  void column(const std::string& name, DynArray<T>& values, std::size_t count,
              [[maybe_unused]] const NumberRule& rule = finite_number) const {
    values = count == any_count ? in_.get<T>(name) : in_.get<T>(name, count);
    if constexpr (std::is_floating_point_v<T>) check(name, values, rule);
  }
  template <class T>
  DynArray<T> column(const std::string& name, std::size_t count = any_count) const {
    DynArray<T> values;
    column(name, values, count);
    return values;
  }
  template <class Rows>
  void rows(const std::string& name, Rows& rows, std::size_t count) const {
    using Row = typename Rows::value_type;
    static_assert(sizeof(Row) % sizeof(double) == 0 && std::is_trivially_copyable_v<Row>);
    constexpr std::size_t numbers = sizeof(Row) / sizeof(double);
    if (count == any_count) {
      const std::uint64_t found = in_.count<double>(name);
      need(found % numbers == 0, "its field '", name, "' has ", found,
           " values, not a multiple of ", numbers);
      count = found / numbers;
    }
    // Checked before memory is allocated.
    need(in_.count<double>(name) == count * numbers, "its field '", name, "' has ",
         in_.count<double>(name), " values, but ", count * numbers, " are needed");
    rows.resize(count);
    in_.read(name, reinterpret_cast<double*>(rows.data()), count * numbers);
  }
  std::string words(const std::string& name) const { return in_.text(name); }
  bool has(const std::string& name) const { return in_.has(name); }

 private:
  const CheckpointReader& in_;
  const std::string& path_;
};

}  // namespace silt::detail
