// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/names.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

/// Intentional differences between a checkpoint and the scene into which it is loaded:
///
///   silt::load_checkpoint(sim, "settled.silt", {.materials = true});   // with another friction
///
/// The state is not converted. Springs of contacts keep their displacement, hence forces jump where
/// the stiffness changes; the ledger counts the energy of this jump in its residual. The time step
/// is checked against its limit again, and chosen again if it is longer than silt's own.
struct AcceptedChanges {
  bool materials = false;  // number and values, pair values, rolling resistance; Breakage
  bool motions = false;    // of walls
  bool inlets = false;     // all of them: they start as if added at the checkpoint's time
  bool outlets = false;    // all of them: they count from 0
  bool walls = false;      // new ones, after those of the file: as if added then by add_wall
};

namespace detail {

/// Description of a scene, item by item, as text in a checkpoint. Two descriptions can be compared.
///
///   form 0: semi-axis c [m] = 0.002
///
/// Numbers may differ by rounding, as between programs for different instruction sets.
class SceneDescription {
 public:
  /// The accepted change that allows an item to differ.
  enum class Aspect : char {
    Scene = 's',
    Material = 'm',
    Motion = 'w',
    Inlet = 'i',
    Outlet = 'o',
    NewWall = 'n'
  };

  /// A number that may differ by a relative 1e-9, far above rounding and below any intentional
  /// change; or by `slack` if it is a difference of larger numbers.
  void add(Aspect aspect, const std::string& name, double value, double slack = 0) {
    items_.push_back({aspect, name, text(value), value, std::max(slack, 1e-9 * std::abs(value))});
  }
  /// A number of a thing that may have a name. Messages include the name, the file does not.
  void add_numbered(Aspect aspect, const std::string& name, std::size_t k,
                    std::string_view called) {
    add(aspect, name, static_cast<double>(k));
    items_.back().called = after_number(called);
  }
  /// A number whose name is not self-explanatory. Messages include `meaning`, the file does not.
  void add_explained(Aspect aspect, const std::string& name, double value,
                     const std::string& meaning) {
    add(aspect, name, value);
    items_.back().meaning = text(" (", meaning, ")");
  }
  void add(Aspect aspect, const std::string& name, const Vec3d& v, std::string_view unit = "m") {
    const double slack = 1e-9 * norm(v);
    add(aspect, text(name, " x [", unit, "]"), v.x, slack);
    add(aspect, text(name, " y [", unit, "]"), v.y, slack);
    add(aspect, text(name, " z [", unit, "]"), v.z, slack);
  }
  void add(Aspect aspect, const std::string& name, const char* words) {
    items_.push_back({aspect, name, in_quotes(words, most_words), 0, -1});
  }
  void add(Aspect aspect, const std::string& name, const std::string& words) {
    add(aspect, name, words.c_str());
  }
  /// Many points as one number: a weighted sum with a different weight for each coordinate, which
  /// nearly every change alters. Rounding of n coordinates is below 1e-12 of the absolute sum.
  void add(Aspect aspect, const std::string& name, std::span<const Vec3d> points) {
    double sum = 0, size = 0;
    std::uint64_t state = 1;
    for (const Vec3d& p : points)
      for (const double x : {p.x, p.y, p.z}) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const double weighted = (1 + static_cast<double>(state >> 40) * 0x1p-24) * x;
        sum += weighted, size += std::abs(weighted);
      }
    items_.push_back({aspect, text(many_points, name, " [m]"), text(sum), sum, 1e-12 * size});
  }

  /// One line per item.
  std::string written() const {
    std::string out;
    for (const Item& item : items_)
      out += text(static_cast<char>(item.aspect), ' ', item.name, " = ", item.value, '\n');
    return out;
  }

  /// Differences from the description in a file, and what to do, as a phrase: the first three
  /// items, and the number of further ones. Empty if there are none. `written` comes from a file
  /// and may be anything.
  std::string difference(std::string_view written, const AcceptedChanges& accepted) const {
    std::map<std::string_view, std::string_view> in_file;
    while (!written.empty()) {
      const auto line = written.substr(0, written.find('\n'));
      written.remove_prefix(std::min(line.size() + 1, written.size()));
      const auto equals = line.find(" = ");
      if (equals == line.npos || equals < 2) return text(in_quotes(line), " has no value");
      if (!is_accepted(static_cast<Aspect>(line[0]), accepted))
        in_file[line.substr(2, equals - 2)] = line.substr(equals + 3);
    }
    std::string phrase, one_sided;
    std::size_t count = 0;
    AcceptedChanges would_do;
    bool no_change_would_do = false;
    // If there is one more of something, its count is reported, not its items.
    for (const Item& item : items_) {
      if (is_accepted(item.aspect, accepted)) {
        in_file.erase(item.name);
        continue;
      }
      const auto found = in_file.find(item.name);
      if (found != in_file.end() && is_same(item, found->second)) {
        in_file.erase(found);
        continue;
      }
      no_change_would_do |= item.aspect == Aspect::Scene;
      would_do.materials |= item.aspect == Aspect::Material;
      would_do.motions |= item.aspect == Aspect::Motion;
      would_do.inlets |= item.aspect == Aspect::Inlet;
      would_do.outlets |= item.aspect == Aspect::Outlet;
      would_do.walls |= item.aspect == Aspect::NewWall;
      if (found == in_file.end()) {
        if (one_sided.empty())
          one_sided = text(item.name, " is ", shown(item), " only in the scene");
        continue;
      }
      if (count++ < 3) phrase += (count > 1 ? "; " : "") + difference(item, found->second);
      in_file.erase(found);
    }
    if (one_sided.empty() && !in_file.empty())
      one_sided = text(in_quotes(in_file.begin()->first), " is ", shown(in_file.begin()->second),
                       " only in the file");
    if (count > 3) phrase += text("; and ", count - 3, " more");
    if (count == 0) phrase = one_sided;
    if (phrase.empty()) return phrase;
    phrase += "; build the scene that wrote it";
    if (no_change_would_do) return phrase;
    for (const auto& [may, word] :
         {std::pair{would_do.materials, "materials"}, std::pair{would_do.motions, "motions"},
          std::pair{would_do.inlets, "inlets"}, std::pair{would_do.outlets, "outlets"},
          std::pair{would_do.walls, "walls"}})
      if (may)
        phrase +=
            text(", or accept other ", word, ": load_checkpoint(sim, path, {.", word, " = true})");
    return phrase;
  }

 private:
  static constexpr std::size_t most_words = 1000;
  static constexpr std::string_view many_points = "checksum of the ";
  struct Item {
    Aspect aspect;
    std::string name, value;
    double number, slack;   // slack < 0: words
    std::string called{};   // after the value in messages
    std::string meaning{};  // after the name in messages
  };

  static bool is_accepted(Aspect aspect, const AcceptedChanges& accepted) {
    return (aspect == Aspect::Material && accepted.materials) ||
           (aspect == Aspect::Motion && accepted.motions) ||
           (aspect == Aspect::Inlet && accepted.inlets) ||
           (aspect == Aspect::Outlet && accepted.outlets) ||
           (aspect == Aspect::NewWall && accepted.walls);
  }
  static bool is_same(const Item& item, std::string_view in_file) {
    if (item.value == in_file) return true;
    double value = 0;
    const auto [end, error] =
        std::from_chars(in_file.data(), in_file.data() + in_file.size(), value);
    return item.slack >= 0 && error == std::errc{} && end == in_file.data() + in_file.size() &&
           std::abs(value - item.number) <= item.slack;
  }
  static std::string difference(const Item& item, std::string_view in_file) {
    if (item.name.starts_with(many_points))  // a sum without meaning for a reader
      return text("the ", item.name.substr(many_points.size()),
                  " are others in the file than in the scene");
    return text(item.name, item.meaning, " is ", shown(in_file), " in the file and ", shown(item),
                " in the scene");
  }
  static std::string shown(const Item& item) { return shown(item.value) + item.called; }
  /// Words are already in quotes.
  static std::string shown(std::string_view value) {
    const std::string safe = in_quotes(value);
    return safe.size() == value.size() + 2 ? std::string(value) : safe;
  }

  DynArray<Item> items_;
};

}  // namespace detail
}  // namespace silt
