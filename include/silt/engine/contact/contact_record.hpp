// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include <silt/core/vec3.hpp>
#include <silt/engine/lists/wall_images.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What is kept of the contacts of a step: nothing; how they lie and what their forces are; or also
/// the parts of these and what the law remembers, which take half of the memory and time.
enum class ContactsKept { Nothing, Forces, All };

/// A contact as the contact stage found it in a step that is recorded: rows instead of ids, after
/// the law. Without initial values, so that room for a block costs nothing.
struct RecordedForce {
  Vec3d normal;                 // [-] from the partner to the first
  Vec3d force;                  // [N] on the first
  double overlap;               // [m]
  std::uint32_t first, second;  // rows; at a wall which image of it
  std::uint32_t order;          // place in the list of pairs, or slot at walls
  std::uint16_t wall, surface;

  // An image is three numbers of ten bits: those of farther ones are not kept.
  static constexpr std::uint32_t wall_bit = 1u << 31, far_image = wall_bit;
  static constexpr std::int64_t most = 511;  // [-] lengths of the box
  bool at_wall() const { return second & wall_bit; }
  /// What stands in `second` at an image of a wall.
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
  double cohesion;  // [N] attraction, as a part of the normal force
};
struct RecordedContact : RecordedForce, RecordedParts {};
/// What more is known where forces come with couples, or have arms of their own (convex parts).
struct RecordedTurn {
  Vec3d arm{0, 0, 0};                          // [m] from the centre of the first row
  Vec3d couple_i{0, 0, 0}, couple_j{0, 0, 0};  // [N m] besides the moment of the force
};

/// The contacts of the last recorded step. Stages hand in what they found, block by block and from
/// several threads; who reads puts it in order.
class ContactRecord {
 public:
  static constexpr std::int64_t none = -1;

  /// Before the contacts of a step; where the stages find the record, null: nobody asks.
  ContactRecord* begin(ContactsKept kept, std::int64_t step) {
    if (step_ != none) contacts.clear(), parts.clear(), turns.clear(), numbers.clear();
    const bool wanted = kept != ContactsKept::Nothing;
    step_ = wanted ? step : none, whole_ = kept == ContactsKept::All;
    return wanted ? this : nullptr;
  }
  void forget() { step_ = none; }
  bool is_of(std::int64_t step) const { return step_ == step; }
  /// With parts and history.
  bool is_whole() const { return whole_; }

  /// `its`, `more`: parts and a turn for each of `found`, or nothing; `history`: the same count of
  /// numbers each.
  void add(std::span<const RecordedForce> found, std::span<const RecordedParts> its,
           std::span<const RecordedTurn> more, std::span<const double> history) {
    const std::lock_guard lock(*mutex_);
    contacts.insert(contacts.end(), found.begin(), found.end());
    parts.insert(parts.end(), its.begin(), its.end());
    turns.insert(turns.end(), more.begin(), more.end());
    numbers.insert(numbers.end(), history.begin(), history.end());
  }

  std::vector<RecordedForce> contacts;
  std::vector<RecordedParts> parts;  // of each, or empty
  std::vector<RecordedTurn> turns;   // of each, or empty
  std::vector<double> numbers;       // what law and rolling model remember of each

 private:
  std::int64_t step_ = none;
  bool whole_ = false;
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();  // so that it can move
};

}  // namespace silt::detail
