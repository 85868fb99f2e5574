// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include <silt/engine/contact/contact_kernel.hpp>
#include <silt/engine/contact/offset.hpp>
#include <silt/engine/contact/wall_loads.hpp>
#include <silt/engine/lists/wall_look.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Energy that the ledger misses when spheres are removed during contact: the energy in the normal
/// springs half a step after the last force computation, and the second half of the work of all
/// other forces of that step. With it the energy balance closes to second order in the step, as for
/// contacts that end by separation. Tangential springs need no correction: their energy at the end
/// counts as friction.
/// Tests: tests/breakage/runs.cpp, tests/engine/removed_springs.cpp.
template <class EngineType, class Domain>
class EndedContacts {
  using C = typename EngineType::Contacts;
  using Law = typename C::Law;
  using Kernel = ContactKernel<C, double>;

 public:
  double normal = 0;                                 // [J] in normal springs
  ContactEnergy<double> work = no_energy<double>();  // [J] of the other forces

  /// For the contacts of these rows (sorted), except those with ghosts; `since` [s]: time since the
  /// last forces acted, at the present positions.
  EndedContacts(const EngineType& e, const Domain& domain, std::span<const std::uint32_t> rows,
                double since, double dt)
      : e_(e), since_(since), dt_(dt) {
    const auto is_gone = [rows](std::uint32_t row) {
      return std::binary_search(rows.begin(), rows.end(), row);
    };
    const auto& pairs = e.lists.pairs;
    pairs.for_each([&](std::size_t k) {
      if constexpr (EngineType::of_ranks)
        if (std::max(pairs.first()[k], pairs.second()[k]) >= e.particles.owned()) return;
      if (is_gone(pairs.first()[k]) || is_gone(pairs.second()[k])) add_pair(k, domain);
    });
    for_each_wall_contact(e, since, [&](const auto& c, const SurfacePoint& point) {
      if (is_gone(c.particle)) add_wall(c, point);
    });
  }

  /// Of one pair.
  struct OfPair {
    std::size_t number;
  };
  EndedContacts(const EngineType& e, const Domain& domain, OfPair pair, double since, double dt)
      : e_(e), since_(since), dt_(dt) {
    add_pair(pair.number, domain);
  }
  /// Of all contacts with one wall.
  struct OfWall {
    std::size_t number;
  };
  EndedContacts(const EngineType& e, const Domain&, OfWall wall, double since, double dt)
      : e_(e), since_(since), dt_(dt) {
    for_each_wall_contact(e, since, [&](const auto& c, const SurfacePoint& point) {
      if (c.wall == wall.number) add_wall(c, point);
    });
  }

 private:
  void add_pair(std::size_t k, [[maybe_unused]] const Domain& domain) {
    const auto& pairs = e_.lists.pairs;
    const std::uint32_t a = pairs.first()[k], b = pairs.second()[k];
    const PositionRow &p = e_.particles.position[a], &q = e_.particles.position[b];
    Vec3d d = place_before(e_, a, since_) - place_before(e_, b, since_);
    if constexpr (Domain::periodic) d = domain.shortest(d);
    const auto &m = e_.particles.motion[a], &n = e_.particles.motion[b];
    const double distance = norm(d), reach = p.r + q.r, inv_m = m.inv_m + n.inv_m;
    Kinematics<double> kin{};
    kin.normal = (1 / distance) * d, kin.overlap = reach - distance;
    kin.velocity = m.velocity() - n.velocity();
    kin.R_eff = p.r * q.r / reach, kin.inverse_m_eff = inv_m, kin.m_eff = 1 / inv_m;
    Vec3d turn{0, 0, 0};
    if constexpr (C::rotates) {
      kin.spin = m.spin_velocity() + n.spin_velocity(), kin.arm = distance / reach;
      turn = m.inv_r * m.spin_velocity() - n.inv_r * n.spin_velocity();
    }
    std::size_t kind = 0;
    if constexpr (C::several_materials)
      kind = e_.particles.material[a] * e_.coefficients.materials + e_.particles.material[b];
    add(kin, {p.r, q.r}, turn, kind,
        [&](std::size_t h) { return static_cast<double>(pairs.history(h, k)); });
  }
  template <class Candidate>
  void add_wall(const Candidate& c, const SurfacePoint& point) {
    const Wall& wall = e_.walls[c.wall];
    const auto& all = e_.lists.walls;
    const auto& m = e_.particles.motion[c.particle];
    if (m.inv_m == 0 && !wall.is_driven()) return;
    const double r = e_.particles.position[c.particle].r;
    // The contact's own slot: the only one, or the one that had nearly this normal.
    const std::size_t slots =
        std::remove_cvref_t<decltype(all)>::slots_of(wall.surfaces[c.surface]);
    std::size_t slot = c.slot;
    for (std::size_t s = 0; slots > 1 && s < slots; ++s)
      if (all.slot(c.slot + s).touching && dot(all.slot(c.slot + s).normal, point.normal) > 0.8)
        slot = c.slot + s;
    const Vec3d contact = place_before(e_, c.particle, since_) - point.distance * point.normal;
    Kinematics<double> kin{};
    kin.normal = point.normal, kin.overlap = r - point.distance;
    const Vec3d on_wall = all.seen(c, contact);
    kin.velocity = m.velocity() - velocity_at_contact(wall, on_wall, point.normal, dt_);
    kin.R_eff = r, kin.inverse_m_eff = m.inv_m;
    if (m.inv_m == 0)
      kin.inverse_m_eff = inverse_mass_at_fixed(wall.drive, wall.state, on_wall, point.normal, r);
    kin.m_eff = 1 / kin.inverse_m_eff;
    Vec3d turn{0, 0, 0};
    if constexpr (C::rotates) {
      kin.spin = m.spin_velocity(), kin.arm = point.distance * m.inv_r;
      turn = m.inv_r * m.spin_velocity() - spin_of_surface(wall, dt_);
    }
    std::size_t kind = wall.material;
    if constexpr (C::several_materials)
      kind += e_.particles.material[c.particle] * e_.coefficients.materials;
    add(kin, {r, 0}, turn, kind,
        [&](std::size_t h) { return static_cast<double>(all.history(h, slot)); });
  }
  /// `history(h)`: component h of the contact history.
  template <class History>
  void add(Kinematics<double> kin, const Radii<double>& radii, const Vec3d& turn, std::size_t kind,
           const History& history) {
    const double v = dot(kin.velocity, kin.normal), half = 0.5 * dt_;
    if constexpr (keeps_offset<C>)
      kin.overlap -= std::clamp(history(C::offset_from), 0.0, std::max(kin.overlap, 0.0));
    if (!(kin.overlap > 0)) return;  // or a partner has left
    work.dashpot += half * history(C::kept_from) * v;
    if constexpr (is_frictional<Law>) {
      Vec3d slip = kin.velocity - v * kin.normal;
      if constexpr (C::rotates) slip -= kin.arm * cross(kin.spin, kin.normal);
      work.shear += half * dot(slip, at(history, C::kept_from + 1));
    }
    if constexpr (C::has_rolling)
      work.couple += half * dot(turn, at(history, C::kept_from + C::kept_couple));
    const auto h = history_of<Law>(history);
    kin.overlap = std::max(kin.overlap - half * v, 0.0);
    kin.velocity = kin.spin = {0, 0, 0};
    normal +=
        stored_by<Law, double>(Kernel::contact(kin, radii, dt_, 0.5), e_.coefficients.law[kind], h)
            .normal;
  }
  template <class History>
  static Vec3d at(const History& history, std::size_t h) {
    return {history(h), history(h + 1), history(h + 2)};
  }

  const EngineType& e_;
  double since_, dt_;  // [s]
};

}  // namespace silt::detail
