// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <silt/core/lanes.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/seen.hpp>

namespace silt::inline SILT_TARGET::detail {

/// What the probes of packs of W see of an SPH liquid, in double.
template <class Kernel, std::size_t W, class Arch>
struct SphProbes {
  double normalisation, h;  // [1/m2] or [1/m3], [m] of the kernel

  void look(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
            const ClusterLists& lists, std::span<SphSeen> out) const {
    for (std::size_t l = 0; l < W; l += probes)
      look(rows.data() + pack * W + l, rows, volume, lists, lists.liquid(pack), out.data() + l);
  }

 private:
  static constexpr std::size_t probes = std::min(W, Lanes<Arch>::width);
  using Probes = typename PackOf<probes>::type;
  void look(const SphRow* own, std::span<const SphRow> rows, std::span<const double> volume,
            const ClusterLists& lists, std::span<const ClusterLists::Entry> entries,
            SphSeen* out) const {
    alignas(64) double place[3][probes];
    for (std::size_t l = 0; l < probes; ++l)
      place[0][l] = own[l].x, place[1][l] = own[l].y, place[2][l] = own[l].z;
    const auto here = load3<Probes>(place[0], place[1], place[2]);
    const Probes zero(0);
    Probes n = zero, rho = zero, xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
    Vec3<Probes> way{zero, zero, zero}, rho_way = way, flow = way;
    for (const auto entry : entries) {
      const SphRow& b = rows[entry.row()];
      Vec3d at{b.x, b.y, b.z};
      if (entry.image() != ClusterLists::here) at += lists.shift(entry.image());
      const Probes dx = Probes(at.x) - here.x, dy = Probes(at.y) - here.y,
                   dz = Probes(at.z) - here.z;
      const Probes r2 = dx * dx + dy * dy + dz * dz;
      const Probes w =
          Probes(volume[entry.row()] * normalisation) * Kernel::weight(sqrt(r2) * Probes(1 / h));
      const Probes wx = w * dx, wy = w * dy, wz = w * dz, d(b.density);
      n += w, way.x += wx, way.y += wy, way.z += wz;
      rho = multiply_add(w, d, rho), rho_way.x = multiply_add(wx, d, rho_way.x);
      rho_way.y = multiply_add(wy, d, rho_way.y), rho_way.z = multiply_add(wz, d, rho_way.z);
      xx = multiply_add(wx, dx, xx), xy = multiply_add(wx, dy, xy), xz = multiply_add(wx, dz, xz);
      yy = multiply_add(wy, dy, yy), yz = multiply_add(wy, dz, yz), zz = multiply_add(wz, dz, zz);
      flow.x = multiply_add(w, Probes(b.vx), flow.x),
      flow.y = multiply_add(w, Probes(b.vy), flow.y);
      flow.z = multiply_add(w, Probes(b.vz), flow.z);
    }
    alignas(64) double of[17][probes];
    const Probes all[17] = {n,  rho, way.x, way.y, way.z, rho_way.x, rho_way.y, rho_way.z, xx,
                            xy, xz,  yy,    yz,    zz,    flow.x,    flow.y,    flow.z};
    for (int c = 0; c < 17; ++c) store(of[c], all[c]);
    for (std::size_t l = 0; l < probes; ++l)
      out[l] = {of[0][l],
                of[1][l],
                {of[2][l], of[3][l], of[4][l]},
                {of[5][l], of[6][l], of[7][l]},
                {of[14][l], of[15][l], of[16][l]},
                of[8][l],
                of[9][l],
                of[10][l],
                of[11][l],
                of[12][l],
                of[13][l]};
  }
};

}  // namespace silt::detail
