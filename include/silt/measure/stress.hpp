// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/tensor3.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {
namespace detail {

/// Share [-] of the segment from `from` to `to` that is in the box.
inline double share_inside(const Box& box, const Vec3d& from, const Vec3d& to) {
  double first = 0, last = 1;
  const auto cut = [&](double a, double b, double low, double high) {
    const double way = b - a;
    if (way == 0) {
      if (!(a >= low && a < high)) last = 0;  // on a side shared by two boxes: in one of them
      return;
    }
    const double at_low = (low - a) / way, at_high = (high - a) / way;
    first = std::max(first, std::min(at_low, at_high));
    last = std::min(last, std::max(at_low, at_high));
  };
  cut(from.x, to.x, box.min.x, box.max.x);
  cut(from.y, to.y, box.min.y, box.max.y);
  cut(from.z, to.z, box.min.z, box.max.z);
  return std::max(0.0, last - first);
}

/// Calls visit(shift [m]) for each periodic image that may be needed.
template <class Domain, class Visit>
void for_each_image([[maybe_unused]] const Domain& domain, const Visit& visit) {
  if constexpr (Domain::periodic) {
    const auto most = [&](int d) { return domain.repeats(d) ? 1 : 0; };
    for (int i = -most(0); i <= most(0); ++i)
      for (int j = -most(1); j <= most(1); ++j)
        for (int k = -most(2); k <= most(2); ++k)
          visit(Vec3d{i * domain.length(0), j * domain.length(1), k * domain.length(2)});
  } else {
    visit(Vec3d{0, 0, 0});
  }
}
/// InputError if a region reaches beyond a box that repeats, where it would have no particles.
template <class Domain>
void check_inside_period([[maybe_unused]] const Domain& domain,
                         [[maybe_unused]] const Box& region) {
  if constexpr (Domain::periodic) {
    const Box all = domain.box();
    const double low[3] = {all.min.x - region.min.x, all.min.y - region.min.y,
                           all.min.z - region.min.z},
                 high[3] = {region.max.x - all.max.x, region.max.y - all.max.y,
                            region.max.z - all.max.z};
    for (int d = 0; d < 3; ++d)
      require(!domain.repeats(d) || std::max(low[d], high[d]) <= 0.01 * domain.length(d),
              "stress: the region from ", region.min, " to ", region.max,
              " [m] reaches beyond the box that repeats, from ", all.min, " to ", all.max,
              " m; cut it there, or take sim.domain().box()");
  }
}
template <class Domain>
Vec3d in_domain([[maybe_unused]] const Domain& domain, const Vec3d& point) {
  if constexpr (Domain::periodic)
    return domain.wrapped(point);
  else
    return point;
}

template <class Sim>
void sum_over_ranks(const Sim& sim, Tensor3& t) {
  std::array<double, 9> all{t.xx, t.xy, t.xz, t.yx, t.yy, t.yz, t.zx, t.zy, t.zz};
  sim.sum_over_ranks(std::span<double>(all));
  t = {all[0], all[1], all[2], all[3], all[4], all[5], all[6], all[7], all[8]};
}

}  // namespace detail

/// Stress [Pa] in a region, compression positive.
struct Stress {
  Tensor3 contact;          // [Pa] from forces: sum of F_a l_b over the volume
  Tensor3 kinetic;          // [Pa] from the motion relative to `velocity`
  Vec3d velocity{0, 0, 0};  // [m/s] of all mass in the region
  double density = 0;       // [kg/m3]

  Tensor3 total() const { return contact + kinetic; }
  double pressure() const { return total().trace() / 3; }  // [Pa]
};

/// Mean stress in `region` by Love and Weber:
///
///   contact_ab = 1/V sum_c s_c F_a l_b,   kinetic_ab = 1/V sum_k m u_a u_b                    (1)
///
/// F: force on a from its partner; l: branch vector from the partner's centre to a's, or from the
/// point at a wall; s: share of the branch in the region; u: velocity relative to the mean of the
/// region, for particles with their centre in it. With these shares (1) is the volume mean of a
/// field whose divergence is the force on each particle, at its centre (Goldhirsch, Granular Matter
/// 12 (2010) 239, with a step in place of a smooth kernel; recalled). In a column at rest
/// contact_zz is the weight above per area, averaged over the height of the region. On many ranks
/// collective (RankAccess).
/// Errors: InputError for a region without volume, or beyond a box that repeats.
/// Tests:  tests/measure/measures.cpp (column, compressed box, colliding gas).
template <class Sim>
Stress stress(const Sim& sim, const Box& region) {
  const double volume = region.volume();
  require(std::isfinite(volume) && volume > 0, "stress: the region from ", region.min, " to ",
          region.max, " [m] must have a volume");
  Stress out;
  const auto& domain = sim.domain();
  detail::check_inside_period(domain, region);
  sim.for_each_contact([&](const ContactSeen& c) {
    const Vec3d to = detail::in_domain(domain, sim.position(c.place_a)), from = to - c.branch;
    double share = 0;
    detail::for_each_image(domain, [&](const Vec3d& shift) {
      share += detail::share_inside(region, from + shift, to + shift);
    });
    if (share > 0) out.contact += (share / volume) * dyad(c.force, c.branch);
  });
  double mass = 0;
  std::vector<std::pair<double, Vec3d>> moving;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k) || !std::isfinite(sim.mass(k))) continue;
    if (!region.contains(detail::in_domain(domain, sim.position(k)))) continue;
    const double m = sim.mass(k);
    moving.emplace_back(m, sim.velocity(k));
    mass += m, out.velocity += m * moving.back().second;
  }
  mass = sim.sum_over_ranks(mass), out.velocity = sim.sum_over_ranks(out.velocity);
  if (mass > 0) out.velocity *= 1 / mass;
  for (const auto& [m, v] : moving)
    out.kinetic += (m / volume) * dyad(v - out.velocity, v - out.velocity);
  for (Tensor3* part : {&out.contact, &out.kinetic}) detail::sum_over_ranks(sim, *part);
  out.density = mass / volume;
  return out;
}

/// Sum of all contacts of one particle.
struct ContactLoad {
  Vec3d force{0, 0, 0}, torque{0, 0, 0};  // [N], [N m] about its centre of mass
  std::size_t contacts = 0;
};
/// By place; includes fixed particles, e.g. for the force on an obstacle.
template <class Sim>
std::vector<ContactLoad> contact_loads(const Sim& sim) {
  detail::need_one_process<Sim>();
  std::vector<ContactLoad> all(sim.rows());
  sim.for_each_contact([&](const ContactSeen& c) {
    const auto add = [&](std::size_t k, const Vec3d& force, const Vec3d& torque) {
      all[k].force += force, all[k].torque += torque, ++all[k].contacts;
    };
    add(c.place_a, c.force, c.torque_a);
    if (c.wall == no_wall) add(c.place_b, -c.force, c.torque_b);
  });
  return all;
}

}  // namespace silt
