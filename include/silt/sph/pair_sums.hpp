// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include <silt/core/box.hpp>
#include <silt/core/lanes.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/probe_sums.hpp>
#include <silt/sph/row.hpp>
#include <silt/sph/seen.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Sums over the neighbours of a particle.
struct alignas(64) SphRates {
  Vec3d acceleration;  // [m/s2]
  double density;      // [kg/(m3 s)]
  Vec3d slope;         // [1/m] grad C, of shifting
  double divergence;   // [-] div r
};
static_assert(sizeof(SphRates) == 64);

struct SphConstants {
  double mass, h, normalisation;  // [kg], [m], a of the kernel
  double sound, density;          // [m/s], [kg/m3]
  Vec3d gravity;                  // [m/s2]
  double viscous = 0;             // [1/m2] D over the second moment of the kernel
};

/// [-] of h^2, added to r^2 in the terms of viscosity and diffusion: 0.01, or that of a viscosity.
template <class Viscosity>
constexpr double sph_softening() {
  if constexpr (requires { Viscosity::softening; })
    return Viscosity::softening;
  else
    return 0.01;
}

/// Whether a viscosity depends on the flow, so that each particle has its own.
template <class Viscosity>
inline constexpr bool sph_varies = requires {
  requires Viscosity::varies;
};
/// [m2/s] Viscosity of all pairs; 1 if each particle has its own.
template <class Viscosity>
double sph_kinematic([[maybe_unused]] const Viscosity& of) {
  if constexpr (sph_varies<Viscosity>)
    return 1;
  else
    return of.kinematic;
}
/// Viscosity of a pair that varies, from both; one of a liquid and a solid, which has 0, has the
/// liquid's.
template <bool liquid, class Real>
SILT_INLINE Real sph_viscosity_of_pair(const Real& a, const Real& b) {
  if constexpr (liquid)
    return Real(2) * a * b / (a + b);
  else
    return max(a, b);
}

/// Particles per pack, one per lane. Lists of larger packs contain more particles beyond the
/// support: 16 floats pay only where AVX-512 is executed at its full width.
template <class Scalar, class Arch>
constexpr std::size_t sph_width() {
  return std::min(Lanes<Arch, Scalar>::width, std::size_t{SILT_FULL_AVX512 ? 16 : 8});
}

/// Sums over pairs of an SPH liquid (see Sph), for a pack of particles at a time:
///
///   d rho_a/dt = rho_a sum V_b v_ab.grad W + D_a
///   d v_a/dt   = -sum m_b (P_a + P_b)/(rho_a rho_b) grad W + viscosity
///
/// Walls and bodies only push, but for those that hold liquid for a while (SolidHold): next to the
/// others P_a + P_b is at least 0. Otherwise a thin film would be drawn to a wall, as its density
/// is inaccurate. Where tension is omitted, the decrease of density by separation from the wall is
/// omitted too: it is summed apart (SphGrowth::parting), and lowers a density at most to rho_0
/// (sph_parting). Otherwise liquid would store the energy of a tension without work, and thin films
/// became unstable.
///
/// The density uses a slip velocity at no-slip walls: v_b without `sticking`, the part that only
/// viscosities use. With mirrored no-slip velocities the components along and normal to the wall
/// are not those of one divergence-free flow: where liquid leaves a wall its density decreased, and
/// particles passed through.
///
/// Each pair is computed from both of its ends, by antisymmetric terms: momentum is conserved to
/// rounding, and threads share no data.
///
/// `Scalar` = float: pairs in single precision, with rows prepared by shorten() (SphBrief).
/// Positions are integers, hence differences are exact; velocities, densities and pressures are in
/// units of c and rho_0. Sums of `chunk` pairs are floats, their sums doubles.
///
/// `own_masses`: liquid particles have less than a particle's mass, by their volumes.
template <class Kernel, class Viscosity, class Diffusion, class Shifting, class Scalar = double,
          bool own_masses = false, class Arch = DefaultArch>
class SphPairs {
 public:
  static constexpr bool mixed = std::is_same_v<Scalar, float>;
  static constexpr std::size_t W = sph_width<Scalar, Arch>();
  using Real = typename PackOf<W, Scalar>::type;
  /// Lanes of a pack of probes' sums, which are doubles.
  static constexpr std::size_t seen_width = std::min(W, Lanes<Arch>::width);
  using Seen = SphSeenBy<typename PackOf<seen_width>::type>;

  /// `extent` contains all particles.
  SphPairs(const SphConstants& c, const Viscosity& viscosity, const Diffusion& diffusion,
           const Box& extent = {}) {
    if constexpr (mixed) {
      const Vec3d e = extent.extent();
      length_ = (std::max({e.x, e.y, e.z}) + 16 * c.h) / SphBrief::most;
      middle_ = 0.5 * (extent.min + extent.max);
      speed_ = c.sound, density_ = rest_ = c.density, volume_ = c.mass / c.density;
    }
    const double h = c.h / length_, sound = c.sound / speed_;
    const double mass = c.mass / (density_ * volume_);
    own_rest_ = Scalar(rest_ / density_), over_mass_ = Scalar(1 / mass);
    weight_ = c.normalisation, h_ = c.h, over_h_ = Scalar(1 / h);
    small_ = Scalar(sph_softening<Viscosity>() * h * h);
    slope_ = volume_ * c.normalisation / (c.h * c.h);
    if constexpr (Viscosity::artificial) damping_ = Scalar(-2 * viscosity.alpha * mass * sound * h);
    if constexpr (Viscosity::laminar)
      drag_ = Scalar(-4 * sph_kinematic(viscosity) * c.viscous * length_ / speed_ * mass);
    if constexpr (Diffusion::diffuses) delta_ = 2 * diffusion.delta * c.h * c.sound * density_;
    const double still = -c.density / (c.sound * c.sound) * length_ / density_;
    const Vec3d& g = c.gravity;
    hydrostatic_ = {Scalar(still * g.x), Scalar(still * g.y), Scalar(still * g.z)};
  }

  /// For mixed precision: prepares the rows for the functions below.
  void shorten(std::span<const SphRow> rows, std::span<const double> volume,
               std::span<SphBrief> out) const {
    const double place = 1 / length_, speed = 1 / speed_, density = 1 / density_,
                 pressure = 1 / (density_ * speed_ * speed_), room = 1 / volume_;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const SphRow& r = rows[k];
      const Vec3d at = place * (r.position() - middle_);
      const auto whole = [](double x) { return static_cast<std::int32_t>(std::nearbyint(x)); };
      const double V = room * volume[k];
      SphBrief& b = out[k];
      if (r.is_there())
        b.x = whole(at.x), b.y = whole(at.y), b.z = whole(at.z);
      else
        b.x = b.y = b.z = SphBrief::most;
      b.vx = Scalar(speed * r.vx), b.vy = Scalar(speed * r.vy), b.vz = Scalar(speed * r.vz);
      b.density = Scalar(density * (r.density - rest_)), b.pressure = Scalar(pressure * r.pressure);
      b.volume = Scalar(V);
    }
  }

  /// Only the velocities.
  void shorten_velocities(std::span<const SphRow> rows, std::span<SphBrief> out) const {
    const double speed = 1 / speed_;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const SphRow& r = rows[k];
      SphBrief& b = out[k];
      b.vx = Scalar(speed * r.vx), b.vy = Scalar(speed * r.vy), b.vz = Scalar(speed * r.vz);
    }
  }

  /// Computes the rates of a pack; returns the largest |h v.r/(r^2 + (0.1 h)^2)| [m/s].
  double of_liquid(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
                   const ClusterLists& lists, std::span<SphRates> out, std::span<SphGrowth> growth,
                   std::span<const SphBrief> brief = {}, const SphBeside& beside = {}) const {
    Own own = own_of(pack, rows, brief);
    take_viscosity(pack, beside, own);
    Totals totals;
    add<true>(own, rows, volume, brief, beside.of_liquid(), lists, lists.liquid(pack), totals);
    add<false>(own, rows, volume, brief, beside, lists, lists.walls(pack), totals);
    put_growth(rows.data() + pack * W, totals, growth.data() + pack * W);
    return put(rows.data() + pack * W, totals, out.data() + pack * W);
  }
  /// Only `growth`, of the pack.
  void growth_of_liquid(std::size_t pack, std::span<const SphRow> rows,
                        std::span<const double> volume, const ClusterLists& lists,
                        std::span<SphGrowth> out, std::span<const SphBrief> brief = {},
                        const SphBeside& beside = {}) const {
    const Own own = own_of(pack, rows, brief);
    Totals totals;
    add<true, true>(own, rows, volume, brief, {}, lists, lists.liquid(pack), totals);
    add<false, true>(own, rows, volume, brief, beside, lists, lists.walls(pack), totals);
    put_growth(rows.data() + pack * W, totals, out.data());
  }
  void growth_of_wall(std::size_t pack, std::span<const SphRow> rows,
                      std::span<const double> volume, const ClusterLists& lists,
                      std::span<SphGrowth> out, std::span<const SphBrief> brief = {}) const {
    const Own own = own_of(pack, rows, brief);
    Totals totals;
    add<false, true>(own, rows, volume, brief, {}, lists, lists.liquid(pack), totals);
    put_growth(rows.data() + pack * W, totals, out.data());
  }
  /// The same for particles of walls, which interact only with the liquid.
  double of_wall(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
                 const ClusterLists& lists, std::span<SphRates> out, std::span<SphGrowth> growth,
                 std::span<const SphBrief> brief = {}, const SphBeside& beside = {}) const {
    Own own = own_of(pack, rows, brief);
    take_viscosity(pack, beside, own);
    alignas(64) Scalar least[W];
    for (std::size_t l = 0; l < W; ++l) least[l] = least_sum(beside.may_pull(pack * W + l));
    own.least = load<Real>(least);
    Totals totals;
    add<false>(own, rows, volume, brief, beside.of_liquid(), lists, lists.liquid(pack), totals);
    put_growth(rows.data() + pack * W, totals, growth.data() + pack * W);
    return put(rows.data() + pack * W, totals, out.data() + pack * W);
  }

  /// Sums of the particles of a pack over the liquid around them (probe_sums.hpp).
  void look(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
            const ClusterLists& lists, std::span<Seen> out,
            std::span<const SphBrief> brief = {}) const {
    use_probes(pack, rows, volume, brief, [&]<class Look>(Look, std::size_t lane, auto... with) {
      Look::look(with..., lists, lists.liquid(pack), units(), out.data() + lane / seen_width);
    });
  }
  /// V W v [m/s] of the liquid around them.
  void look_at_velocity(std::size_t pack, std::span<const SphRow> rows,
                        std::span<const double> volume, const ClusterLists& lists,
                        std::span<Vec3d> out, std::span<const SphBrief> brief = {}) const {
    use_probes(pack, rows, volume, brief, [&]<class Look>(Look, std::size_t lane, auto... with) {
      Look::look_at_velocity(with..., lists, lists.liquid(pack), units(), out.data() + lane);
    });
  }
  void look_at_level(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
                     const ClusterLists& lists, std::span<SphLevel> out,
                     std::span<const SphBrief> brief = {}) const {
    use_probes(pack, rows, volume, brief, [&]<class Look>(Look, std::size_t lane, auto... with) {
      Look::look_at_level(with..., lists, lists.liquid(pack), units(), out.data() + lane);
    });
  }

 private:
  static constexpr std::size_t chunk = 128, sums = 10;
  using Probes = SphProbes<Kernel, Scalar, mixed ? W : seen_width, seen_width>;
  using ProbeUnits = typename Probes::Units;
  ProbeUnits units() const {
    if constexpr (mixed)
      return {length_, speed_, rest_, density_, volume_ * weight_, h_};
    else
      return {1, 1, 0, 1, weight_, h_};
  }
  /// use(probes, lane, own rows, all rows, volume of a row), for lanes from `lane` on.
  template <class Use>
  void use_probes(std::size_t pack, std::span<const SphRow> rows, std::span<const double> volume,
                  [[maybe_unused]] std::span<const SphBrief> brief, const Use& use) const {
    if constexpr (mixed) {
      SphBrief own[W];
      shorten(rows.subspan(pack * W, W), volume.subspan(pack * W, W), own);
      use(Probes{}, 0, static_cast<const SphBrief*>(own), brief,
          [brief](std::size_t row) { return brief[row].volume; });
    } else {
      for (std::size_t l = 0; l < W; l += seen_width)
        use(Probes{}, l, rows.data() + pack * W + l, rows,
            [volume](std::size_t row) { return volume[row]; });
    }
  }
  using Place = std::conditional_t<
      mixed, typename PackOf<W, std::conditional_t<mixed, std::int32_t, double>>::type, Real>;

  struct Own {
    Vec3<Place> x;
    Vec3<Real> v;
    Real density, twice, pressure, damping, drag;  // twice: with the other's density, their sum
    Real least = Real(0);                          // of P_a + P_b at walls
    Real viscosity = Real(0);                      // [m2/s] of one that varies
  };
  static void take_viscosity([[maybe_unused]] std::size_t pack,
                             [[maybe_unused]] const SphBeside& beside, [[maybe_unused]] Own& own) {
    if constexpr (sph_varies<Viscosity>) {
      alignas(64) Scalar of[W];
      for (std::size_t l = 0; l < W; ++l) of[l] = Scalar(beside.viscosity[pack * W + l]);
      own.viscosity = load<Real>(of);
    }
  }
  Own own_of(std::size_t pack, std::span<const SphRow> rows,
             std::span<const SphBrief> brief) const {
    using Whole = std::conditional_t<mixed, std::int32_t, double>;
    alignas(64) Whole at[3][W];
    alignas(64) Scalar of[5][W];
    const auto take = [&](const auto* r) {
      for (std::size_t l = 0; l < W; ++l) {
        at[0][l] = r[l].x, at[1][l] = r[l].y, at[2][l] = r[l].z;
        of[0][l] = r[l].vx, of[1][l] = r[l].vy, of[2][l] = r[l].vz;
        of[3][l] = r[l].density, of[4][l] = r[l].pressure;
      }
    };
    if constexpr (mixed)
      take(brief.data() + pack * W);
    else
      take(rows.data() + pack * W);
    const Real density = load<Real>(of[3]), rest(own_rest_);
    return {{load_place(at[0]), load_place(at[1]), load_place(at[2])},
            load3<Real>(of[0], of[1], of[2]),
            density,
            density + rest + rest,
            load<Real>(of[4]),
            Real(damping_) * (density + rest),
            Real(drag_) * (density + rest)};
  }
  template <class Whole>
  static Place load_place(const Whole* from) {
    if constexpr (W == 1)
      return *from;
    else
      return Place::load_aligned(from);
  }
  template <class Whole>
  static SILT_INLINE Real apart(const Place& a, Whole b) {
    if constexpr (!mixed)
      return a - Real(b);
    else if constexpr (W == 1)
      return static_cast<float>(a - b);
    else
      return xsimd::to_float(a - Place(b));
  }
  struct Sums {
    Vec3<Real> push{Real(0), Real(0), Real(0)}, slope{Real(0), Real(0), Real(0)};
    Real spread = Real(0), parting = Real(0), diffusion = Real(0), divergence = Real(0),
         fastest = Real(0);
  };
  static constexpr std::size_t spread = 3, parting = 9;  // their places in Totals
  struct alignas(64) Totals {
    double of[sums][W] = {};
    double fastest = 0;
    void add_growth(const Sums& s) {
      alignas(64) Scalar values[W], apart[W];
      store(values, s.spread), store(apart, s.parting);
      for (std::size_t l = 0; l < W; ++l)
        of[spread][l] += double{values[l]}, of[parting][l] += double{apart[l]};
    }
    void add(const Sums& s) {
      const Real all[sums] = {s.push.x,  s.push.y,  s.push.z,  s.spread,     s.diffusion,
                              s.slope.x, s.slope.y, s.slope.z, s.divergence, s.parting};
      alignas(64) Scalar values[W];
      for (std::size_t k = 0; k < sums; ++k) {
        store(values, all[k]);
        for (std::size_t l = 0; l < W; ++l) of[k][l] += double{values[l]};
      }
      store(values, s.fastest);
      for (std::size_t l = 0; l < W; ++l) fastest = std::max(fastest, double{values[l]});
    }
  };

  template <bool liquid, bool growth = false>
  SILT_INLINE void add(const Own& a, std::span<const SphRow> rows, std::span<const double> volume,
                       std::span<const SphBrief> brief, const SphBeside& beside,
                       const ClusterLists& lists, std::span<const ClusterLists::Entry> entries,
                       Totals& totals) const {
    if constexpr (mixed) {
      for (std::size_t k = 0; k < entries.size(); k += chunk)
        add_some<liquid, growth>(
            a, brief, beside, lists, entries.subspan(k, std::min(chunk, entries.size() - k)),
            [&](std::size_t row) { return brief[row].volume; }, totals);
    } else if (!entries.empty()) {
      add_some<liquid, growth>(
          a, rows, beside, lists, entries, [&](std::size_t row) { return volume[row]; }, totals);
    }
  }
  template <bool liquid, bool growth, class Other, class Volume>
  SILT_INLINE void add_some(const Own& a, std::span<const Other> others, const SphBeside& beside,
                            const ClusterLists& lists, std::span<const ClusterLists::Entry> entries,
                            const Volume& volume, Totals& totals) const {
    Sums part;
    Other moved[2];
    const Other* b = placed(others, lists, entries[0], moved[0]);
    Way next;
    find_way(a, *b, next);  // one pair ahead: everything else depends on its root
    for (std::size_t k = 0, n = entries.size(); k < n; ++k) {
      const Way now{next.x, next.y, next.z, next.square, next.f};
      const Other* const one = b;
      b = placed(others, lists, entries[std::min(k + 1, n - 1)], moved[(k + 1) % 2]);
      find_way(a, *b, next);
      const std::size_t row = entries[k].row();
      Surface with;
      if constexpr (!liquid) {
        if (!beside.sticking.empty()) {
          const Vec3d v = (1 / speed_) * beside.sticking[row];
          with.stuck = {Scalar(v.x), Scalar(v.y), Scalar(v.z)};
        }
        with.holds = beside.may_pull(row);
      }
      if constexpr (sph_varies<Viscosity> && !growth)
        with.viscosity = Scalar(beside.viscosity[row]);
      if constexpr (growth)
        spread_of<liquid>(a, now, *one, volume(row), with, part);
      else
        pair<liquid>(a, now, *one, volume(row), with, part);
    }
    if constexpr (growth)
      totals.add_growth(part);
    else
      totals.add(part);
  }
  SILT_INLINE const SphRow* placed(std::span<const SphRow> rows, const ClusterLists& lists,
                                   const ClusterLists::Entry& entry, SphRow& moved) const {
    const SphRow* const row = &rows[entry.row()];
    if (entry.image() == ClusterLists::here) return row;
    moved = *row, moved.place(row->position() + lists.shift(entry.image()));
    return &moved;
  }
  SILT_INLINE const SphBrief* placed(std::span<const SphBrief> brief, const ClusterLists& lists,
                                     const ClusterLists::Entry& entry, SphBrief& moved) const {
    const SphBrief* const row = &brief[entry.row()];
    if (entry.image() == ClusterLists::here) return row;
    const Vec3d way = (1 / length_) * lists.shift(entry.image());
    const auto whole = [](double x) { return static_cast<std::int32_t>(std::nearbyint(x)); };
    moved = *row;
    moved.x += whole(way.x), moved.y += whole(way.y), moved.z += whole(way.z);
    return &moved;
  }
  struct Surface {
    Vec3<Scalar> stuck{0, 0, 0};
    bool holds = false;
    Scalar viscosity = 0;
  };
  /// Least P_a + P_b at a solid that holds liquid, or not.
  static constexpr Scalar least_sum(bool holds) { return holds ? Scalar(-1e30) : Scalar(0); }
  /// From one particle to those of a pack; grad W = slope_ f r.
  struct Way {
    Real x, y, z, square, f;
  };
  /// Field by field: compilers copy a structure of packs in pieces of another size, and such loads
  /// wait for all stores.
  template <class Other>
  SILT_INLINE void find_way(const Own& a, const Other& b, Way& to) const {
    const Real x = apart(a.x.x, b.x), y = apart(a.x.y, b.y), z = apart(a.x.z, b.z);
    const Real square = x * x + y * y + z * z;
    to.x = x, to.y = y, to.z = z, to.square = square;
    to.f = Kernel::slope(Real(sqrt(square) * Real(over_h_)));
  }
  /// Adds V f v.r of a pair.
  template <bool liquid, class Other>
  SILT_INLINE void spread_of(const Own& a, const Way& way, const Other& b, const Scalar& volume,
                             const Surface& with, Sums& sum) const {
    const Real ux = a.v.x - Real(b.vx), uy = a.v.y - Real(b.vy), uz = a.v.z - Real(b.vz);
    const Real along = ux * way.x + uy * way.y + uz * way.z;
    add_spread<liquid>(way, Real(volume) * way.f, along, with, sum);
  }
  template <bool liquid>
  static SILT_INLINE void add_spread(const Way& way, const Real& Vf, const Real& along,
                                     [[maybe_unused]] const Surface& with, Sums& sum) {
    if constexpr (liquid) {
      sum.spread = multiply_add(Vf, along, sum.spread);
    } else {
      const Real slip = along + way.x * Real(with.stuck.x) + way.y * Real(with.stuck.y) +
                        way.z * Real(with.stuck.z);
      const Real apart = Real(with.holds ? Scalar(0) : Scalar(1)) * max(slip, Real(0));
      sum.spread = multiply_add(Vf, slip - apart, sum.spread);
      sum.parting = multiply_add(Vf, apart, sum.parting);
    }
  }
  template <bool liquid, class Other>
  SILT_INLINE void pair(const Own& a, const Way& way, const Other& b, const Scalar& volume,
                        [[maybe_unused]] const Surface& with, Sums& sum) const {
    const auto& [dx, dy, dz, r2, f] = way;
    const Real Vf = Real(volume) * f;
    // m f/m: a solid particle may have less than a particle's volume.
    [[maybe_unused]] Real mf = f;
    if constexpr (!liquid || own_masses)
      mf = Real((b.density + own_rest_) * volume * over_mass_) * f;
    const Real ux = a.v.x - Real(b.vx), uy = a.v.y - Real(b.vy), uz = a.v.z - Real(b.vz);
    const Real along = ux * dx + uy * dy + uz * dz;
    const Real wide = r2 + Real(small_), both_rho = a.twice + Real(b.density);
    const Real over = Real(1) / (wide * both_rho);
    Real both = a.pressure + Real(b.pressure);
    add_spread<liquid>(way, Vf, along, with, sum);
    if constexpr (!liquid) both = max(both, min(a.least, Real(least_sum(with.holds))));
    // Acceleration over -slope_/rho_a
    Real k = both * Vf;
    const Real approach = along * over;
    if constexpr (Viscosity::artificial)
      k = multiply_add(a.damping, mf * min(approach, Real(0)), k);
    if constexpr (Viscosity::laminar) {
      Real drag = a.drag;
      if constexpr (sph_varies<Viscosity>)
        drag = drag * sph_viscosity_of_pair<liquid>(a.viscosity, Real(with.viscosity));
      k = multiply_add(drag, mf * approach * wide, k);
    }
    sum.push.x = multiply_add(k, dx, sum.push.x);
    sum.push.y = multiply_add(k, dy, sum.push.y);
    sum.push.z = multiply_add(k, dz, sum.push.z);
    sum.fastest = max(sum.fastest, abs(approach * both_rho));
    if constexpr (Diffusion::diffuses && liquid) {
      Real difference = a.density - Real(b.density);
      if constexpr (Diffusion::hydrostatic)
        difference +=
            dx * Real(hydrostatic_.x) + dy * Real(hydrostatic_.y) + dz * Real(hydrostatic_.z);
      sum.diffusion = multiply_add(difference * r2 * both_rho, over * Vf, sum.diffusion);
    }
    if constexpr (Shifting::shifts) {
      sum.slope.x = multiply_add(Vf, dx, sum.slope.x);
      sum.slope.y = multiply_add(Vf, dy, sum.slope.y);
      sum.slope.z = multiply_add(Vf, dz, sum.slope.z);
      sum.divergence = multiply_add(Vf, r2, sum.divergence);
    }
  }

  void put_growth(const SphRow* rows, const Totals& t, SphGrowth* out) const {
    for (std::size_t l = 0; l < W; ++l) {
      const double unit = slope_ * length_ * speed_ * rows[l].density;
      out[l] = {unit * t.of[spread][l], unit * t.of[parting][l]};
    }
  }
  double put(const SphRow* rows, const Totals& t, SphRates* out) const {
    for (std::size_t l = 0; l < W; ++l) {
      const double rho = rows[l].density,
                   push = -slope_ * length_ * speed_ * speed_ * density_ / rho,
                   slope = slope_ * length_;
      out[l] = {{push * t.of[0][l], push * t.of[1][l], push * t.of[2][l]},
                slope * speed_ * rho * t.of[spread][l] + slope_ * delta_ * t.of[4][l],
                {slope * t.of[5][l], slope * t.of[6][l], slope * t.of[7][l]},
                -slope * length_ * t.of[8][l]};
    }
    return t.fastest * h_ * speed_ / length_;
  }

  // Units of the sums: [m], [m/s], [kg/m3], [m3]; rest_ [kg/m3]: reference of densities.
  double length_ = 1, speed_ = 1, density_ = 1, volume_ = 1, rest_ = 0;
  Vec3d middle_{0, 0, 0};
  double h_ = 0, weight_ = 0, slope_ = 0, delta_ = 0;
  Scalar over_h_ = 0, small_ = 0, damping_ = 0, drag_ = 0;
  Scalar own_rest_ = 0, over_mass_ = 0;  // rest_ and inverse mass, in units
  Vec3<Scalar> hydrostatic_{0, 0, 0};
};

}  // namespace silt::detail
