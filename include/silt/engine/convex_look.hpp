// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/engine/convex_walls.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A contact of convex bodies, by their rows; or of one with a wall, j then being no_particle.
struct SeenContact {
  std::uint32_t i, j;
  std::uint16_t wall;
  Vec3d normal;                           // [-] from the partner to i
  double overlap, R_eff;                  // [m]
  double share;                           // [-] overlap over the smaller least radius
  double inverse_mass_i, inverse_mass_j;  // [1/kg] that a push along the normal meets
};

/// Calls visit(SeenContact) for every contact of the bodies as they now lie; lists and memories
/// stay as they are. One lane at a time: for the guard and its messages.
template <class EngineType, class Domain, class Visit>
void for_each_convex_contact(const EngineType& e, const Domain& domain, const Visit& visit) {
  using C = typename EngineType::Contacts;
  const auto& rows = e.mover.convex_rows;
  const auto at = [&](std::size_t row) {
    return body_at_contact(e.particles.motion[row], rows.pose[row]);
  };
  e.lists.pairs.for_each([&](std::size_t k) {
    const std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
    if (!(e.lists.pairs.history(C::memory_radius, k) > 0)) return;
    Vec3d between = e.particles.position[j].centre() - e.particles.position[i].centre();
    if constexpr (Domain::periodic) between = domain.shortest(between);
    const auto a = at(i), b = at(j);
    const PosedPair pair{rows.form_at(i), rows.form_at(j), a.axes, b.axes, between};
    const auto kept = [&](std::size_t h) { return e.lists.pairs.history(C::memory_from + h, k); };
    NormalMemory<double> memory{{kept(0), kept(1), kept(2)}, kept(3), kept(4)};
    const auto contact = touch(pair, memory);
    if (!contact.touches) return;
    visit(SeenContact{
        i, j, 0, contact.normal, contact.overlap, contact.R_eff,
        contact.overlap / std::min(rows.pose[i].least_radius, rows.pose[j].least_radius),
        a.inverse_mass(contact.point, contact.normal),
        b.inverse_mass(contact.point - between, contact.normal)});
  });
  for (const WallCandidate& c : e.lists.walls.candidates()) {
    const Wall& wall = e.walls[c.wall];
    const auto* const plane = std::get_if<Plane>(&wall.surfaces[c.surface]);
    double radius = e.lists.walls.history(C::memory_radius, c.slot);
    if (plane == nullptr || e.particles.motion[c.particle].inv_m == 0) continue;
    const auto [contact, place] = body_at_plane(
        rows, c.particle, e.particles.position[c.particle].centre(), wall, *plane, radius);
    if (!contact.touches) continue;
    visit(SeenContact{c.particle, no_particle, c.wall, contact.normal, contact.overlap,
                      contact.R_eff, contact.overlap / rows.pose[c.particle].least_radius,
                      at(c.particle).inverse_mass(contact.point, contact.normal), 0});
  }
}

}  // namespace silt::detail
