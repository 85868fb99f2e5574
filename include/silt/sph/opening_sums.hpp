// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/threads.hpp>
#include <silt/sph/liquid_check.hpp>
#include <silt/sph/openings.hpp>
#include <silt/sph/seen.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sums of a probe of an opening: also V W v r of each velocity component.
struct SphSeenFlow : SphSeen {
  Vec3d x_way{0, 0, 0}, y_way{0, 0, 0}, z_way{0, 0, 0};

  void add(const Vec3d& r, double w, const SphRow& of) {
    const double d = w * of.density;
    const Vec3d wr = w * r;
    weight += w, density += d, way += wr, density_way += d * r, velocity += w * of.velocity();
    xx += wr.x * r.x, xy += wr.x * r.y, xz += wr.x * r.z;
    yy += wr.y * r.y, yz += wr.y * r.z, zz += wr.z * r.z;
    x_way += of.vx * wr, y_way += of.vy * wr, z_way += of.vz * wr;
  }
  bool sees() const { return weight > 1e-6; }
  /// [m/s] of the liquid at `away` [m] from the probe, by a linear fit; the mean if there is too
  /// little liquid for gradients.
  Vec3d flow(double h, const Vec3d& away) const {
    const Vec3d mean = (1 / weight) * velocity;
    if (weight < 0.1) return mean;
    const Fit of = fit(h);
    if (!of.known()) return mean;
    const Vec3d off = away - of.centre;
    return mean + Vec3d{dot(of.slope(x_way, velocity.x), off),
                        dot(of.slope(y_way, velocity.y), off),
                        dot(of.slope(z_way, velocity.z), off)};
  }
};

/// Sums of the probes of openings over the liquid, without buffers.
template <class Core>
void sph_look(const Core& core, DynArray<SphSeenFlow>& out, const Team& team) {
  const auto& columns = core.columns;
  const auto probes = core.openings.probes();
  const double h = core.setup.h(), a = Core::Kernel::normalisation(core.setup.dimensions, h);
  out.assign(probes.size(), {});
  team.for_ranges(probes.size(), [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t slot = from; slot < to; ++slot) {
      const std::size_t k = probes[slot];
      if (core.openings.of(columns, probes[slot]).is_prescribed()) continue;
      const Vec3d at = columns.rows[k].position();
      for (const auto entry : core.lists.liquid(k / Core::Pairs::W)) {
        const std::size_t b = entry.row();
        if (columns.label[b] >= SphColumns::of_openings) continue;
        const SphRow& other = columns.rows[b];
        const Vec3d r = other.position() + core.lists.shift(entry.image()) - at;
        const double r2 = dot(r, r);
        if (r2 >= 4 * h * h) continue;
        out[slot].add(r, a * columns.volume[b] * Core::Kernel::weight(std::sqrt(r2) / h), other);
      }
    }
  });
}

/// Velocities and pressures of the buffers at the time of these rates.
template <class Core>
void sph_set_buffers(Core& core, const Team& team) {
  auto& columns = core.columns;
  const auto rows = core.openings.rows(), probes = core.openings.probes();
  for (std::size_t slot = 0; slot < rows.size(); ++slot) {
    const Vec3d x = columns.rows[rows[slot]].position();
    columns.rows[probes[slot]].place(core.openings.image(core.openings.of(columns, rows[slot]), x));
  }
  DynArray<SphSeenFlow> seen;
  sph_look(core, seen, team);
  // In sequence: functions of users need not be thread-safe.
  for (std::size_t slot = 0; slot < rows.size(); ++slot) {
    const std::size_t k = rows[slot];
    const SphOpening& one = core.openings.of(columns, rows[slot]);
    SphRow& r = columns.rows[k];
    const Vec3d x = r.position(), foot = x - core.openings.seen(one, x).front * one.normal;
    if (one.setup.velocity.given())
      r.move(one.velocity_at(foot, core.now, core.liquid));
    else if (seen[slot].sees())
      r.move(seen[slot].flow(core.setup.h(), foot - columns.rows[probes[slot]].position()));
    if (one.setup.pressure.given()) {
      r.density = core.liquid.density_at(one.pressure_at(x, core.now, core.liquid, core.gravity));
    } else {
      const Vec3d away = x - columns.rows[probes[slot]].position();
      r.density = seen[slot].at(away, core.liquid, core.gravity, core.setup.h(), false).density;
    }
    sph_check(core, r);
    r.pressure = core.liquid.pressure(r.density);
    columns.volume[k] = core.particle_mass() / r.density;
  }
}

/// Calls sums() as if there were no buffers.
template <class Core, class Sums>
void sph_without_buffers(Core& core, const Team& team, const Sums& sums) {
  auto& columns = core.columns;
  for (const std::uint32_t k : core.openings.rows()) columns.volume[k] = 0;
  core.shorten(core.pairs(), team), sums();
  for (const std::uint32_t k : core.openings.rows())
    columns.volume[k] = core.particle_mass() / columns.rows[k].density;
  core.shorten(core.pairs(), team);
}

}  // namespace silt::detail
