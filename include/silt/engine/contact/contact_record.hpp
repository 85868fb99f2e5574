// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/vec3.hpp>
#include <silt/engine/lists/wall_images.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What is recorded of the contacts of a step: nothing; geometry and forces; or also the parts of
/// the forces and the history of the law, which take half of the memory and time.
enum class ContactsKept { Nothing, Forces, All };

/// A contact as the contact stage found it in a recorded step, after the law, with rows instead of
/// ids. Members have no initial values, so that reserving room for a block costs nothing.
struct RecordedForce {
  Vec3d normal;                 // [-] from the partner to the first particle
  Vec3d force;                  // [N] on the first
  double overlap;               // [m]
  std::uint32_t first, second;  // rows; at a wall, second is the image
  std::uint32_t order;          // place in the list of pairs, or slot at walls
  std::uint16_t wall, surface;

  // An image is packed as three numbers of ten bits; images farther away are not recorded.
  static constexpr std::uint32_t wall_bit = 1u << 31, far_image = wall_bit;
  static constexpr std::int64_t most = 511;  // [-] lengths of the box
  bool at_wall() const { return second & wall_bit; }
  /// The value of `second` for an image of a wall.
  static std::uint32_t at_image(WallImage image) {
    std::uint32_t code = 0;
    for (const std::int64_t n : lengths_of(image)) {
      if (n < -most || n > most) return far_image;
      code = code << 10 | static_cast<std::uint32_t>(n + most + 1);
    }
    return wall_bit | code;
  }
  std::optional<WallImage> image() const {
    if (second == far_image) return std::nullopt;
    const auto n = [this](int shift) { return (second >> shift & 1023) - (most + 1); };
    return wall_image({n(20), n(10), n(0)});
  }
};
struct RecordedParts {
  Vec3d spring;     // [N] of the tangential spring on the first
  double cohesion;  // [N] attractive part of the normal force
};
struct RecordedContact : RecordedForce, RecordedParts {};
/// Further data of contacts whose forces come with couples or act at explicit lever arms (convex
/// parts).
struct RecordedTurn {
  Vec3d arm{0, 0, 0};                          // [m] from the centre of the first row
  Vec3d couple_i{0, 0, 0}, couple_j{0, 0, 0};  // [N m] in addition to the moment of the force
};

/// The contacts of the last recorded step. Stages add theirs block by block from several threads;
/// the reader sorts them.
class ContactRecord {
 public:
  static constexpr std::int64_t none = -1;

  /// Called before the contacts of a step. Returns the record for the stages, or null if none was
  /// requested.
  ContactRecord* begin(ContactsKept kept, std::int64_t step) {
    if (step_ != none) contacts.clear(), parts.clear(), turns.clear(), numbers.clear();
    const bool wanted = kept != ContactsKept::Nothing;
    step_ = wanted ? step : none, whole_ = kept == ContactsKept::All;
    return wanted ? this : nullptr;
  }
  void forget() { step_ = none; }
  /// Must be called after `more` rows were inserted in front of row `first`.
  void make_way(std::size_t first, std::size_t more) {
    const auto move = [&](std::uint32_t& row) {
      if (row >= first) row += static_cast<std::uint32_t>(more);
    };
    for (RecordedForce& c : contacts) {
      move(c.first);
      if (!c.at_wall()) move(c.second);
    }
  }
  bool is_of(std::int64_t step) const { return step_ == step; }
  /// Includes force parts and history.
  bool is_whole() const { return whole_; }

  /// `its`, `more`: force parts and couples for each of `found`, or empty; `history`: the same
  /// number of values for each.
  void add(std::span<const RecordedForce> found, std::span<const RecordedParts> its,
           std::span<const RecordedTurn> more, std::span<const double> history) {
    const std::lock_guard lock(*mutex_);
    contacts.insert(contacts.end(), found.begin(), found.end());
    parts.insert(parts.end(), its.begin(), its.end());
    turns.insert(turns.end(), more.begin(), more.end());
    numbers.insert(numbers.end(), history.begin(), history.end());
  }

  DynArray<RecordedForce> contacts;
  DynArray<RecordedParts> parts;  // per contact, or empty
  DynArray<RecordedTurn> turns;   // per contact, or empty
  DynArray<double> numbers;       // history of law and rolling model of each contact

 private:
  std::int64_t step_ = none;
  bool whole_ = false;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();  // makes it movable
};

}  // namespace silt::detail
