// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include <silt/core/lanes.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/seen.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sums of probes over the liquid, `width` probes at a time, one per lane: those of SphSeen, or of
/// SphLevel.
/// `Scalar` = float: with rows prepared by SphPairs::shorten(); sums of `chunk` are floats, all
/// others doubles, `doubles` of them in a pack.
template <class Kernel, class Scalar, std::size_t width, std::size_t doubles>
struct SphProbes {
  using Seen = SphSeenBy<typename PackOf<doubles>::type>;
  using Real = typename PackOf<width, Scalar>::type;
  static constexpr bool mixed = std::is_same_v<Scalar, float>;
  using Whole = std::conditional_t<mixed, std::int32_t, double>;
  using Place = std::conditional_t<mixed, typename PackOf<width, Whole>::type, Real>;
  using Row = std::conditional_t<mixed, SphBrief, SphRow>;
  static constexpr std::size_t chunk = 128, sums = 17, level_sums = 8;

  /// Units of the rows, and weight of their volumes; densities of rows exclude `rest` [kg/m3], and
  /// pressures are in `density speed^2`.
  struct Units {
    double length, speed, rest, density, weight, h;
  };

  template <class Volume>
  static void look(const Row* own, std::span<const Row> rows, const Volume& volume,
                   const ClusterLists& lists, std::span<const ClusterLists::Entry> entries,
                   const Units& in, Seen* out) {
    const Here here(own);
    alignas(64) double all[sums][width] = {};
    for_parts(entries, [&](const auto& part) { add(here, rows, volume, lists, part, in, all); });
    put(all, in, out);
  }
  /// V W v.
  template <class Volume>
  static void look_at_velocity(const Row* own, std::span<const Row> rows, const Volume& volume,
                               const ClusterLists& lists,
                               std::span<const ClusterLists::Entry> entries, const Units& in,
                               Vec3d* out) {
    const Here here(own);
    alignas(64) double all[3][width] = {};
    for_parts(entries,
              [&](const auto& part) { add_velocity(here, rows, volume, lists, part, in, all); });
    const double u = in.weight * in.speed;
    for (std::size_t l = 0; l < width; ++l) out[l] = {u * all[0][l], u * all[1][l], u * all[2][l]};
  }
  /// V K'(q)/q r, V W, V W r and V W P, with r from the other to the own.
  template <class Volume>
  static void look_at_level(const Row* own, std::span<const Row> rows, const Volume& volume,
                            const ClusterLists& lists, std::span<const ClusterLists::Entry> entries,
                            const Units& in, SphLevel* out) {
    const Here here(own);
    alignas(64) double all[level_sums][width] = {};
    for_parts(entries,
              [&](const auto& part) { add_level(here, rows, volume, lists, part, in, all); });
    const double w = in.weight, x = w * in.length, slope = x / (in.h * in.h);
    for (std::size_t l = 0; l < width; ++l)
      out[l] = {{-slope * all[0][l], -slope * all[1][l], -slope * all[2][l]},
                {-x * all[3][l], -x * all[4][l], -x * all[5][l]},
                w * all[6][l],
                w * in.density * in.speed * in.speed * all[7][l]};
  }

 private:
  struct Here {
    Place at[3];
    explicit Here(const Row* own) {
      alignas(64) Whole place[3][width];
      for (std::size_t l = 0; l < width; ++l)
        place[0][l] = own[l].x, place[1][l] = own[l].y, place[2][l] = own[l].z;
      for (int d = 0; d < 3; ++d) at[d] = load_place(place[d]);
    }
  };
  /// [length] From the own to the other.
  struct Way {
    Real x, y, z, square;
  };
  static SILT_INLINE Way way_to(const Here& here, const Row& b, const ClusterLists::Entry& entry,
                                const ClusterLists& lists, const Units& in) {
    Whole bx = b.x, by = b.y, bz = b.z;
    if (entry.image() != ClusterLists::here) {
      const Vec3d way = (1 / in.length) * lists.shift(entry.image());
      bx += whole(way.x), by += whole(way.y), bz += whole(way.z);
    }
    const Real x = apart(bx, here.at[0]), y = apart(by, here.at[1]), z = apart(bz, here.at[2]);
    return {x, y, z, x * x + y * y + z * z};
  }
  /// Sums of floats are short.
  template <class Use>
  static void for_parts(std::span<const ClusterLists::Entry> entries, const Use& use) {
    const std::size_t part = mixed ? chunk : std::max(entries.size(), std::size_t{1});
    for (std::size_t k = 0; k < entries.size(); k += part)
      use(entries.subspan(k, std::min(part, entries.size() - k)));
  }
  template <std::size_t n>
  static SILT_INLINE void add_to(double (&all)[n][width], const Real (&parts)[n]) {
    alignas(64) Scalar values[width];
    for (std::size_t c = 0; c < n; ++c) {
      store(values, parts[c]);
      for (std::size_t l = 0; l < width; ++l) all[c][l] += double{values[l]};
    }
  }
  static Place load_place(const Whole* from) {
    if constexpr (width == 1)
      return *from;
    else
      return Place::load_aligned(from);
  }
  static SILT_INLINE Real apart(Whole b, const Place& a) {
    if constexpr (!mixed)
      return Real(b) - a;
    else if constexpr (width == 1)
      return static_cast<float>(b - a);
    else
      return xsimd::to_float(Place(b) - a);
  }
  template <class Volume>
  static SILT_INLINE void add(const Here& here, std::span<const Row> rows, const Volume& volume,
                              const ClusterLists& lists,
                              std::span<const ClusterLists::Entry> entries, const Units& in,
                              double (&all)[sums][width]) {
    const Real zero(0), over_h(Scalar(in.length / in.h));
    Real n = zero, rho = zero, xx = zero, xy = zero, xz = zero, yy = zero, yz = zero, zz = zero;
    Real x = zero, y = zero, z = zero, rx = zero, ry = zero, rz = zero, u = zero, v = zero,
         w = zero;
    for (const auto entry : entries) {
      const Row& b = rows[entry.row()];
      const auto [dx, dy, dz, r2] = way_to(here, b, entry, lists, in);
      const Real of = Real(volume(entry.row())) * Kernel::weight(Real(sqrt(r2) * over_h));
      const Real wx = of * dx, wy = of * dy, wz = of * dz, d(b.density);
      n += of, x += wx, y += wy, z += wz;
      rho = multiply_add(of, d, rho), rx = multiply_add(wx, d, rx);
      ry = multiply_add(wy, d, ry), rz = multiply_add(wz, d, rz);
      xx = multiply_add(wx, dx, xx), xy = multiply_add(wx, dy, xy), xz = multiply_add(wx, dz, xz);
      yy = multiply_add(wy, dy, yy), yz = multiply_add(wy, dz, yz), zz = multiply_add(wz, dz, zz);
      u = multiply_add(of, Real(b.vx), u), v = multiply_add(of, Real(b.vy), v);
      w = multiply_add(of, Real(b.vz), w);
    }
    const Real parts[sums] = {n, rho, x, y, z, rx, ry, rz, xx, xy, xz, yy, yz, zz, u, v, w};
    add_to(all, parts);
  }
  template <class Volume>
  static SILT_INLINE void add_velocity(const Here& here, std::span<const Row> rows,
                                       const Volume& volume, const ClusterLists& lists,
                                       std::span<const ClusterLists::Entry> entries,
                                       const Units& in, double (&all)[3][width]) {
    const Real over_h(Scalar(in.length / in.h));
    Real u(0), v(0), w(0);
    for (const auto entry : entries) {
      const Row& b = rows[entry.row()];
      const auto [dx, dy, dz, r2] = way_to(here, b, entry, lists, in);
      const Real of = Real(volume(entry.row())) * Kernel::weight(Real(sqrt(r2) * over_h));
      u = multiply_add(of, Real(b.vx), u), v = multiply_add(of, Real(b.vy), v);
      w = multiply_add(of, Real(b.vz), w);
    }
    const Real parts[3] = {u, v, w};
    add_to(all, parts);
  }
  template <class Volume>
  static SILT_INLINE void add_level(const Here& here, std::span<const Row> rows,
                                    const Volume& volume, const ClusterLists& lists,
                                    std::span<const ClusterLists::Entry> entries, const Units& in,
                                    double (&all)[level_sums][width]) {
    const Real zero(0), over_h(Scalar(in.length / in.h));
    Real sx = zero, sy = zero, sz = zero, x = zero, y = zero, z = zero, n = zero, p = zero;
    for (const auto entry : entries) {
      const Row& b = rows[entry.row()];
      const auto [dx, dy, dz, r2] = way_to(here, b, entry, lists, in);
      const Real q = sqrt(r2) * over_h, V(volume(entry.row()));
      const Real f = V * Kernel::slope(q), of = V * Kernel::weight(q);
      sx = multiply_add(f, dx, sx), sy = multiply_add(f, dy, sy), sz = multiply_add(f, dz, sz);
      x = multiply_add(of, dx, x), y = multiply_add(of, dy, y), z = multiply_add(of, dz, z);
      n += of, p = multiply_add(of, Real(b.pressure), p);
    }
    const Real parts[level_sums] = {sx, sy, sz, x, y, z, n, p};
    add_to(all, parts);
  }
  static Whole whole(double x) {
    if constexpr (mixed)
      return static_cast<Whole>(std::nearbyint(x));
    else
      return x;
  }
  static void put(const double (&of)[sums][width], const Units& in, Seen* out) {
    using Pack = typename PackOf<doubles>::type;
    const Pack w(in.weight), x(in.weight * in.length), xx(in.weight * in.length * in.length),
        d(in.weight * in.density), dx(in.weight * in.density * in.length), u(in.weight * in.speed),
        rest(in.rest);
    for (std::size_t l = 0; l < width; l += doubles) {
      const auto sum = [&](std::size_t c) { return load<Pack>(&of[c][l]); };
      const auto three = [&](const Pack& unit, std::size_t c) {
        return Vec3<Pack>{unit * sum(c), unit * sum(c + 1), unit * sum(c + 2)};
      };
      Seen& s = out[l / doubles];
      s.weight = w * sum(0), s.way = three(x, 2), s.velocity = three(u, 14);
      s.density = d * sum(1) + rest * s.weight;
      s.density_way = three(dx, 5) + rest * s.way;
      s.xx = xx * sum(8), s.xy = xx * sum(9), s.xz = xx * sum(10);
      s.yy = xx * sum(11), s.yz = xx * sum(12), s.zz = xx * sum(13);
    }
  }
};

}  // namespace silt::detail
