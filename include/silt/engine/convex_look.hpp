// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>

#include <silt/engine/convex_walls.hpp>
#include <silt/shape/narrow/solid_pairs.hpp>

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
    return body_at_contact(e.particles.motion[row], rows, row);
  };
  const auto least = [&](std::size_t row) { return rows.pose[row].least_radius; };
  e.lists.pairs.for_each([&](std::size_t k) {
    std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
    if (!(e.lists.pairs.history(C::memory_radius, k) > 0)) return;
    if (rows.kind_of(i) > rows.kind_of(j)) std::swap(i, j);
    Vec3d between = e.particles.position[j].centre() - e.particles.position[i].centre();
    if constexpr (Domain::periodic) between = domain.shortest(between);
    const auto kept = [&](std::size_t h) { return e.lists.pairs.history(C::memory_from + h, k); };
    NormalMemory<double> memory{
        {kept(0), kept(1), kept(2)}, kept(3), e.lists.pairs.history(C::memory_radius, k)};
    SolidContact contact;
    rows.visit(i, {0, 0, 0}, [&](const auto& a) {
      rows.visit(j, between, [&](const auto& b) { contact = touch_solids(a, b, memory); });
    });
    if (!(contact.overlap > 0)) return;
    const double g2 = contact.gradient * contact.gradient;
    visit(SeenContact{
        i, j, 0, contact.normal, contact.overlap, contact.R_eff,
        contact.overlap / std::min(least(i), least(j)),
        g2 * at(i).inverse_mass(contact.point, contact.normal, contact.couple),
        g2 * at(j).inverse_mass(contact.point - between, contact.normal, contact.couple)});
  });
  for (const WallCandidate& c : e.lists.walls.candidates()) {
    const Wall& wall = e.walls[c.wall];
    if (c.surface >= wall.surfaces.size() || e.particles.motion[c.particle].inv_m == 0) continue;
    const Vec3d centre = e.particles.position[c.particle].centre();
    SolidContact found[most_wall_contacts];
    const int count = contacts_with_wall(rows, c.particle, centre, wall, wall.surfaces[c.surface],
                                         e.lists.walls.facets(c), found);
    for (int k = 0; k < count; ++k)
      visit(SeenContact{
          c.particle, no_particle, c.wall, found[k].normal, found[k].overlap, found[k].R_eff,
          found[k].overlap / least(c.particle),
          found[k].gradient * found[k].gradient *
              at(c.particle)
                  .inverse_mass(found[k].point - centre, found[k].normal, found[k].couple),
          0});
  }
}

}  // namespace silt::detail
