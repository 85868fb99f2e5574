// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/engine/convex/convex_walls.hpp>
#include <silt/engine/state/body.hpp>
#include <silt/shape/narrow/solid_pairs.hpp>

namespace silt::inline SILT_TARGET::detail {

/// A contact of two convex bodies, given by their rows, or of one with a wall (j = no_place).
struct SeenContact {
  std::uint32_t i, j;
  std::uint16_t wall;
  Vec3d normal;                           // [-] from the partner to i
  double overlap, R_eff;                  // [m]
  double share;                           // [-] overlap over the smaller inscribed radius
  double inverse_mass_i, inverse_mass_j;  // [1/kg] effective, for a force along the normal
};

/// Convex parts at the positions where forces acted, `back` [s] ago; same interface as ConvexRows.
template <class EngineType>
class RowsBefore {
  using Rows = std::remove_cvref_t<decltype(std::declval<EngineType>().mover.convex_rows)>;
  const Rows& now_;

 public:
  using Kinds = typename Rows::Kinds;
  static constexpr bool has_levers = Rows::has_levers;
  AlignedVector<PoseRow> pose;
  AlignedVector<LeverRow> lever;
  DynArray<Vec3d> centre;  // [m]
  Exponents exponents;

  RowsBefore(const EngineType& e, double back)
      : now_(e.mover.convex_rows),
        pose(now_.pose),
        lever(now_.lever),
        centre(e.particles.size()),
        exponents(now_.exponents) {
    for (std::size_t r = 0; r < centre.size(); ++r) {
      centre[r] = e.particles.position[r].centre();
      if (back == 0 || e.particles.is_parked(r)) continue;
      const PartRow& part = e.particles.part[r];
      Body b = e.mover.bodies[part.body];
      EngineType::RotationType::drift(b.orientation, b.momentum, b.inertia, -back);
      const auto& form = e.mover.forms[b.form];
      const Vec3d arm = rotate(b.orientation, b.scale * form.parts[part.local].centre);
      centre[r] = b.centre - back * b.velocity + arm + part.image;
      pose[r].q = b.orientation * form.solids[part.local].axes;
      if constexpr (has_levers) lever[r].q = b.orientation, lever[r].offset = arm;
    }
  }
  const auto& form_row(std::size_t row) const { return now_.form_row(row); }
  std::size_t kind_of(std::size_t row) const { return now_.kind_of(row); }
  template <class Visit>
  void visit(std::size_t row, const Vec3d& at, const Visit& visit) const {
    now_.visit_turned(row, at, pose[row].q, visit);
  }
};

/// Calls visit(SeenContact) for every contact of the bodies at the positions of `back` [s] ago;
/// lists and histories are not changed. One lane at a time: for the guard and its messages.
template <class EngineType, class Domain, class Visit>
void for_each_convex_contact(const EngineType& e, const Domain& domain, double back,
                             const Visit& visit) {
  using C = typename EngineType::Contacts;
  const RowsBefore<EngineType> rows(e, back);
  const auto at = [&](std::size_t row) {
    return body_at_contact(e.particles.motion[row], rows, row);
  };
  const auto least = [&](std::size_t row) { return rows.pose[row].least_radius; };
  e.lists.pairs.for_each([&](std::size_t k) {
    std::uint32_t i = e.lists.pairs.first()[k], j = e.lists.pairs.second()[k];
    if (!(e.lists.pairs.history(C::memory_radius, k) > 0)) return;
    if (rows.kind_of(i) > rows.kind_of(j)) std::swap(i, j);
    Vec3d between = rows.centre[j] - rows.centre[i];
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
  const auto all = e.lists.walls.candidates();
  for (std::size_t first = 0, next = 1; first < all.size(); first = next++) {
    const WallCandidate& c = all[first];
    const Wall& wall = e.walls[c.wall];
    if constexpr (std::remove_cvref_t<decltype(e.lists.walls)>::repeats)
      next = end_of_images(all, first);
    if (c.surface >= wall.surfaces.size()) continue;
    if (e.particles.motion[c.particle].inv_m == 0 && !wall.is_driven()) continue;
    const Vec3d& centre = rows.centre[c.particle];
    for_each_joined(
        rows, centre, wall, e.lists.walls, all.subspan(first, next - first),
        [&](const SolidContact& found, const WallCandidate&) {
          visit(SeenContact{
              c.particle, no_place, c.wall, found.normal, found.overlap, found.R_eff,
              found.overlap / least(c.particle),
              found.gradient * found.gradient *
                  at(c.particle).inverse_mass(found.point - centre, found.normal, found.couple),
              0});
        });
  }
}

}  // namespace silt::detail
