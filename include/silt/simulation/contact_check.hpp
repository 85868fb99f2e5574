// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/lists/box_images.hpp>
#include <silt/search/nbs.hpp>

namespace silt::inline SILT_TARGET {

/// An observer that checks in every step that the neighbour lists have missed no contact: another
/// search finds all touching particles, which must be in the list that the forces were computed
/// from. Use it to test a search of your own, or if you doubt silt's:
///
///   sim.run(1.0, silt::ContactCheck{});                                   every step
///   sim.run(1.0, silt::at(silt::every(1e-3), silt::ContactCheck{}));      at intervals
///
/// It costs about as much as a search without a list, and changes no result.
/// Errors: SimulationError that names two particles that touch and were not listed.
/// Tests:  tests/engine/contact_check.cpp.
template <NeighbourSearch Oracle = Nbs>
class ContactCheck {
 public:
  static constexpr bool reads_contacts = false;
  template <class Sim>
  void operator()(const Sim& sim) {
    const auto& e = sim.engine();
    rows_.clear(), places_.clear();
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k))
        rows_.push_back(e.particles.position[k]), places_.push_back(static_cast<std::uint32_t>(k));
    if constexpr (detail::deforms<typename Sim::Domain>) {
      for (auto& row : rows_) {
        const Vec3d p = sim.domain().wrapped(row.centre());
        row = {p.x, p.y, p.z, row.r};
      }
      detail::BoxImages().find(oracle_, rows_, e.particles.largest_radius, sim.domain(), Team(),
                               touching_);
    } else {
      oracle_.find({rows_, e.particles.largest_radius}, 0, sim.domain(), Team(), touching_);
    }
    listed_.clear();
    e.lists.pairs.for_each([&](std::size_t k) {
      listed_.push_back(key(e.lists.pairs.first()[k], e.lists.pairs.second()[k]));
    });
    std::sort(listed_.begin(), listed_.end());
    for (const auto& [p, q] : touching_) {
      const std::uint32_t a = places_[p], b = places_[q];
      const bool both_fixed = e.particles.motion[a].inv_m == 0 && e.particles.motion[b].inv_m == 0;
      if (both_fixed || std::binary_search(listed_.begin(), listed_.end(), key(a, b))) continue;
      throw SimulationError(
          detail::readable("step ", sim.step(), ", t = ", sim.time(), " s: particles ", sim.id(a),
                           " and ", sim.id(b), " touch near ", sim.position(a),
                           " m, but the neighbour search has not listed them; use another "
                           "search: this one loses contacts"),
          sim.step(), {sim.id(a), sim.id(b)}, sim.position(a));
    }
    contacts_ += touching_.size();
  }
  /// Number of contacts checked, over all steps.
  std::size_t contacts() const { return contacts_; }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }

  Oracle oracle_;
  DynArray<PositionRow> rows_;
  DynArray<std::uint32_t> places_;  // of rows_, among all particles
  std::vector<IndexPair> touching_;
  DynArray<std::uint64_t> listed_;
  std::size_t contacts_ = 0;
};

}  // namespace silt
