// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include <silt/engine/contact/contact_kernel.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/engine/convex/contact_area.hpp>
#include <silt/engine/convex/joined_contacts.hpp>
#include <silt/shape/narrow/solid_pairs.hpp>

namespace silt::inline SILT_TARGET::detail {

/// The same as EndedContacts for polyhedra: energy that the ledger misses when they are removed
/// during contact, before the next force computation. Contacts are evaluated at the present
/// positions, their springs half a step earlier; the forces at the three points of a contact are
/// those of the last step. The convex rows must be up to date.
/// Tests: tests/breakage/polyhedra_energy.cpp.
template <class EngineType, class Domain>
class EndedSolidContacts {
  using C = typename EngineType::Contacts;
  using Law = typename C::Law;
  using Kernel = ContactKernel<C, double>;

 public:
  double normal = 0;                                 // [J] in normal springs
  ContactEnergy<double> work = no_energy<double>();  // [J] of the other forces

  /// For the contacts of these rows (sorted), except those with ghosts.
  EndedSolidContacts(const EngineType& e, const Domain& domain, std::span<const std::uint32_t> rows,
                     double dt)
      : e_(e), dt_(dt) {
    const auto is_gone = [rows](std::uint32_t row) {
      return std::binary_search(rows.begin(), rows.end(), row);
    };
    const auto& pairs = e.lists.pairs;
    pairs.for_each([&](std::size_t k) {
      const std::uint32_t i = pairs.first()[k], j = pairs.second()[k];
      if constexpr (EngineType::of_ranks)
        if (std::max(i, j) >= e.particles.owned()) return;
      if (is_gone(i) || is_gone(j)) add_known_pair(k, domain);
    });
    const auto all = e.lists.walls.candidates();
    for (std::size_t k = 0, next = 1; k < all.size(); k = next++) {
      if constexpr (std::remove_cvref_t<decltype(e.lists.walls)>::repeats)
        next = end_of_images(all, k);
      const auto& c = all[k];
      if (is_gone(c.particle) && c.surface < e.walls[c.wall].surfaces.size() &&
          (e.particles.motion[c.particle].inv_m > 0 || e.walls[c.wall].is_driven()))
        add_wall(all.subspan(k, next - k));
    }
  }

  /// Of one pair.
  struct OfPair {
    std::size_t number;
  };
  EndedSolidContacts(const EngineType& e, const Domain& domain, OfPair pair, double dt)
      : e_(e), dt_(dt) {
    add_known_pair(pair.number, domain);
  }

 private:
  bool is_there(std::uint32_t row) const { return !e_.particles.is_parked(row); }
  auto body_of(std::uint32_t row) const {
    return body_at_contact(e_.particles.motion[row], e_.mover.convex_rows, row);
  }
  std::size_t kind_of(std::uint32_t row, std::size_t other) const {
    if constexpr (C::several_materials)
      return e_.particles.material[row] * e_.coefficients.materials + other;
    else
      return other;
  }

  void add_known_pair(std::size_t k, const Domain& domain) {
    const auto& pairs = e_.lists.pairs;
    if (pairs.history(C::memory_radius, k) > 0 && is_there(pairs.first()[k]) &&
        is_there(pairs.second()[k]))
      add_pair(k, domain);
  }
  void add_pair(std::size_t k, [[maybe_unused]] const Domain& domain) {
    const auto& pairs = e_.lists.pairs;
    const auto& rows = e_.mover.convex_rows;
    const auto history = [&](std::size_t h) { return static_cast<double>(pairs.history(h, k)); };
    std::uint32_t i = pairs.first()[k], j = pairs.second()[k];
    if (rows.kind_of(i) > rows.kind_of(j)) std::swap(i, j);
    Vec3d between = e_.particles.position[j].centre() - e_.particles.position[i].centre();
    if constexpr (Domain::periodic) between = domain.shortest(between);
    NormalMemory<double> memory{
        {history(C::memory_from), history(C::memory_from + 1), history(C::memory_from + 2)},
        history(C::memory_from + 3),
        history(C::memory_radius)};
    SolidContact found;
    rows.visit(i, {0, 0, 0}, [&](const auto& a) {
      rows.visit(j, between, [&](const auto& b) { found = touch_solids(a, b, memory); });
    });
    if (!(found.overlap > 0)) return;
    const auto a = body_of(i), b = body_of(j);
    const Vec3d arm_i = found.point, arm_j = found.point - between;
    const double R = history(C::memory_radius);
    std::size_t of_j = 0;
    if constexpr (C::several_materials) of_j = e_.particles.material[j];
    add(found, a.velocity_at(arm_i) - b.velocity_at(arm_j), a.spin - b.spin,
        a.inverse_mass(arm_i, found.normal, found.couple) +
            b.inverse_mass(arm_j, found.normal, found.couple),
        R, {2 * R, 2 * R}, kind_of(i, of_j), history);
  }

  /// Contacts with one surface and its images, each with the slot of its feature or of its normal.
  template <class Candidates>
  void add_wall(const Candidates& images) {
    const auto& c = images.front();
    const Wall& wall = e_.walls[c.wall];
    const auto& walls = e_.lists.walls;
    const std::size_t slots =
        images.size() * std::remove_cvref_t<decltype(walls)>::slots_of(wall.surfaces[c.surface]);
    const Vec3d centre = e_.particles.position[c.particle].centre();
    for_each_joined(
        e_.mover.convex_rows, centre, wall, walls, images,
        [&](const SolidContact& found, const auto& of) {
          if (!(found.overlap > 0)) return;
          std::size_t slot = slots;
          double nearest = 0.8;
          for (std::size_t s = 0; s < slots; ++s) {
            const auto& one = walls.slot(c.slot + s);
            if (!one.touching) continue;
            const double cosine =
                dot(one.normal, found.normal) + (one.feature == found.feature ? 2 : 0);
            if (cosine > nearest) nearest = cosine, slot = s;
          }
          if (slot == slots) return;  // this contact begins now
          const auto body = body_of(c.particle);
          const Vec3d arm = found.point - centre, on_wall = walls.seen(of, found.point);
          const Vec3d spin =
              wall.moves() ? mean_angular_velocity(wall.last_pose, wall.pose, dt_) : Vec3d{0, 0, 0};
          const double R = walls.history(C::memory_radius, c.slot + slot);
          const double inverse_mass =
              body.inv_m == 0
                  ? inverse_mass_at_fixed(wall.drive, wall.state, on_wall, found.normal, R)
                  : body.inverse_mass(arm, found.normal, found.couple);
          add(found, body.velocity_at(arm) - velocity_at_contact(wall, on_wall, found.normal, dt_),
              body.spin - spin, inverse_mass, R, {R, 0}, kind_of(c.particle, wall.material),
              [&](std::size_t h) { return static_cast<double>(walls.history(h, c.slot + slot)); });
        });
  }

  /// `velocity` [m/s] and `spin` [rad/s] of i relative to the partner; `history(h)`: component h of
  /// the contact history.
  template <class History>
  void add(const SolidContact& found, const Vec3d& velocity, const Vec3d& spin, double inverse_mass,
           double R_eff, const Radii<double>& radii, std::size_t kind, const History& history) {
    const double g = found.gradient, half = 0.5 * dt_;
    const Vec3d& n = found.normal;
    Kinematics<double> kin{};
    kin.normal = n, kin.overlap = found.overlap, kin.R_eff = R_eff;
    kin.velocity = g * (velocity + (found.couple * dot(spin, n)) * n);
    kin.inverse_m_eff = g * g * inverse_mass, kin.m_eff = 1 / kin.inverse_m_eff;
    if constexpr (keeps_offset<C>)
      kin.overlap -= std::clamp(history(C::offset_from), 0.0, kin.overlap);
    const auto at = [&](std::size_t h) {
      return Vec3d{history(h), history(h + 1), history(h + 2)};
    };
    constexpr std::size_t F = C::frame_from;
    const AreaFrame<double> frame{at(F), history(F + 3), history(F + 4), history(F + 5)};
    const auto arms = frame.arms(n);
    for (std::size_t point = 0; point < C::points; ++point) {
      const std::size_t kept = C::history_of(point) + C::kept_from;
      const Vec3d v = kin.velocity + cross(g * spin, arms[point]);
      work.dashpot += half * history(kept) * dot(v, n);
      if constexpr (is_frictional<Law>)
        work.shear += half * history(F + 6) / g * dot(v - dot(v, n) * n, at(kept + 1));
    }
    kin.overlap = std::max(kin.overlap + half * dot(kin.velocity, n), 0.0);
    kin.velocity = {0, 0, 0};
    typename HistoryOf<Law, double>::type h = history_of<Law>(history);
    normal +=
        stored_by<Law, double>(Kernel::contact(kin, radii, dt_, 0.5), e_.coefficients.law[kind], h)
            .normal;
  }

  const EngineType& e_;
  double dt_;  // [s]
};

}  // namespace silt::detail
