// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <silt/boundary/wall.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/module/concept.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The facet of a mesh that a contact at `point` [m] with this normal touches: the nearest one seen
/// from slightly above, the lowest number among equals; no_facet if there is none.
inline std::size_t facet_at(const Wall& wall, const TriangleMesh& mesh,
                            std::span<const std::uint32_t> facets, const Vec3d& point,
                            const Vec3d& normal, double above) {
  const Vec3d eye = wall.pose.to_body(point + above * normal);
  std::size_t best = std::numeric_limits<std::size_t>::max();
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : facets)
    if (const double distance = mesh.distance_to(t, eye); distance < least - mesh.round_off())
      least = distance, best = t;
  return best;
}

/// Mass [kg] that wears a wall in contact k: that of the particle or, if it is fixed
/// (`inverse_mass` = 0), of the contact.
template <class Block>
double mass_that_wears(double inverse_mass, const Block& kinematics, std::size_t k) {
  return inverse_mass > 0 ? 1 / inverse_mass : static_cast<double>(kinematics.m_eff[k]);
}

/// The normal of a contact, which in mixed precision is one of floats.
template <class Real>
Vec3d normal_of_wear(const Vec3<Real>& n) {
  return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
}

/// Wear of mesh walls by modules in a step; empty unless a module wears walls.
template <class Fluxes, bool Wears = Fluxes::wears>
class WallWear {
 public:
  template <std::size_t Block>
  struct Rubs {};
  void start(std::size_t) {}
  void finish(std::span<Wall>) {}
};

/// Recorded block by block, each by one thread, and summed in the order of blocks; the sums do not
/// depend on the number of threads.
template <class Fluxes>
class WallWear<Fluxes, true> {
 public:
  /// Data of the contacts of a block saved before the law overwrites it.
  template <std::size_t Block>
  struct Rubs {
    Vec3d velocity[Block];           // [m/s] of the particle's surface relative to the wall's
    const WallCandidate* of[Block];  // null: not a mesh
    bool begins[Block];
    bool next_begins = false;  // for the contact described next

    void put(std::size_t k, const WallCandidate& c, const Wall& wall, const Vec3d& v) {
      of[k] = is_mesh(wall.surfaces[c.surface]) ? &c : nullptr;
      velocity[k] = v, begins[k] = next_begins;
    }
  };
  void start(std::size_t blocks) {
    notes_.resize(blocks);
    for (auto& notes : notes_) notes.clear();
  }
  /// A contact and the force [N] on the particle of `mass` [kg] and `radius` [m], for `duration`
  /// [s] since the last step.
  struct Rub {
    Vec3d point, normal, force, velocity;
    double mass, radius, duration;
    bool begins;
  };
  void add(std::size_t block, const Fluxes& fluxes, const WallCandidate& c, const Wall& wall,
           std::span<const std::uint32_t> facets, const Rub& rub) {
    const double pressed = dot(rub.force, rub.normal), away = dot(rub.velocity, rub.normal);
    if (!(pressed > 0)) return;
    const auto& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(wall.surfaces[c.surface]);
    const std::size_t facet =
        facet_at(wall, mesh, facets, rub.point, rub.normal, 1e-3 * rub.radius);
    if (facet >= mesh.triangles().size()) return;
    const WallRub seen{pressed,
                       norm(rub.force - pressed * rub.normal),
                       norm(rub.velocity - away * rub.normal),
                       -away,
                       rub.mass,
                       rub.duration,
                       rub.begins};
    const std::size_t place = (facets_before(wall, c.surface) + facet) * Fluxes::wearing;
    fluxes.worn_by(seen, c.wall, [&](std::size_t module, double volume) {
      if (volume != 0) notes_[block].push_back({c.wall, place + module, volume});
    });
  }
  void finish(std::span<Wall> walls) {
    for (const auto& notes : notes_)
      for (const Note& note : notes) {
        auto& worn = walls[note.wall].worn;
        if (worn.empty()) worn.assign(facets_of(walls[note.wall]) * Fluxes::wearing, 0);
        worn[note.place] += note.volume;
      }
  }

 private:
  struct Note {
    std::size_t wall, place;
    double volume;  // [m3]
  };
  DynArray<DynArray<Note>> notes_;  // per block
};

}  // namespace silt::detail
