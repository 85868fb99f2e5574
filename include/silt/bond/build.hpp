// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/storage.hpp>
#include <silt/core/threads.hpp>
#include <silt/fill/packing.hpp>
#include <silt/fill/particles.hpp>
#include <silt/search/concept.hpp>
#include <silt/search/hashed_grid.hpp>
#include <silt/shape/sphere.hpp>

/// Builders of bonded spheres: fibres, sheets, agglomerates and bonds of neighbours; and their
/// fragments.

namespace silt::inline SILT_TARGET {

/// Common properties of bonded spheres; an agglomerate draws its own radii.
struct BondedGrain {
  double radius = 0;         // [m]
  double density = 0;        // [kg/m3]
  std::size_t material = 0;  // [-] index in the table of the contacts
  Vec3d velocity{0, 0, 0};   // [m/s]

  Particles<Sphere>::Particle at(const Vec3d& position) const {
    return {.position = position,
            .radius = radius,
            .density = density,
            .velocity = velocity,
            .material = material};
  }
};

/// Spheres and their bonds, by positions in the list.
struct BondedSpheres {
  DynArray<Particles<Sphere>::Particle> spheres;
  DynArray<std::pair<std::size_t, std::size_t>> bonds;
};

/// `count` equal spheres from the centre `from` to the centre `to` [m], each bonded to the next.
/// InputError for fewer than two spheres, from = to, or a spacing so small that spheres two apart
/// overlap; these are not bonded and would be in contact.
inline BondedSpheres fibre(const Vec3d& from, const Vec3d& to, std::size_t count,
                           const BondedGrain& like) {
  require(count >= 2, "fibre: count = ", count, " [-] must be at least 2");
  const double length = norm(to - from);
  require(std::isfinite(length) && length > 0, "fibre: from ", from, " m to ", to,
          " m there is no distance");
  const double apart = length / static_cast<double>(count - 1);
  require(count == 2 || apart >= like.radius * (1 - 1e-9), "fibre: ", count, " spheres of radius ",
          like.radius, " m from ", from, " m to ", to, " m are ", apart,
          " m apart, and those two apart overlap; give fewer, or a smaller radius: at least one "
          "radius from centre to centre");
  BondedSpheres all;
  for (std::size_t k = 0; k < count; ++k) {
    all.spheres.push_back(
        like.at(from + (static_cast<double>(k) / static_cast<double>(count - 1)) * (to - from)));
    if (k > 0) all.bonds.push_back({k - 1, k});
  }
  return all;
}

/// Sheet of `m` x `n` spheres at corner + i/(m-1) u + j/(n-1) v [m]. Each is bonded to its four
/// neighbours; with `braced` also along both diagonals, which resist shear.
inline BondedSpheres sheet(const Vec3d& corner, const Vec3d& u, const Vec3d& v, std::size_t m,
                           std::size_t n, const BondedGrain& like, bool braced = false) {
  require(m >= 2 && n >= 2, "sheet: ", m, " x ", n, " spheres: at least 2 x 2 are needed");
  require(norm(cross(u, v)) > 0, "sheet: its sides ", u, " m and ", v, " m span no area");
  BondedSpheres all;
  const auto at = [n](std::size_t i, std::size_t j) { return i * n + j; };
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      all.spheres.push_back(like.at(corner +
                                    (static_cast<double>(i) / static_cast<double>(m - 1)) * u +
                                    (static_cast<double>(j) / static_cast<double>(n - 1)) * v));
      if (i > 0) all.bonds.push_back({at(i - 1, j), at(i, j)});
      if (j > 0) all.bonds.push_back({at(i, j - 1), at(i, j)});
      if (!braced || i == 0 || j == 0) continue;
      all.bonds.push_back({at(i - 1, j - 1), at(i, j)});
      all.bonds.push_back({at(i - 1, j), at(i, j - 1)});
    }
  return all;
}

namespace detail {
/// Pairs of overlapping spheres, given by centres and radii.
template <class Domain>
std::vector<IndexPair> overlapping(const AlignedVector<PositionRow>& spheres,
                                   const Domain& domain) {
  double largest = 0;
  for (const PositionRow& s : spheres) largest = std::max(largest, s.r);
  std::vector<IndexPair> found;
  HashedGrid{}.find(SphereSet{{spheres.data(), spheres.size()}, largest}, 0.0, domain, Team(1),
                    found);
  return found;
}
}  // namespace detail

/// Agglomerate: spheres packed into a region (a Box, a CylinderRegion, a closed TriangleMesh by
/// MeshRegion; silt/fill/packing.hpp). Each is bonded to all others within a surface distance of
/// `gap` [m]. `like` gives all properties except radii. InputError if no sphere fits, `gap` is
/// negative or NaN, or none of several spheres gets a bond. Neighbours of a packed lattice are 0.03
/// to 0.1 radii apart: with a gap of 0.3 radii it is one piece (pieces_of).
template <Region R>
BondedSpheres agglomerate(const R& region, const FillRequest& request, double gap,
                          const BondedGrain& like) {
  require_not_negative("agglomerate: gap", gap, "m");
  const FillResult packed = pack(region, request);
  require(!packed.spheres.empty(), "agglomerate: ", packed.why_not_more);
  BondedSpheres all;
  AlignedVector<PositionRow> grown;
  for (const auto& [position, radius] : packed.spheres) {
    all.spheres.push_back(like.at(position)), all.spheres.back().radius = radius;
    grown.push_back({position.x, position.y, position.z, std::max(radius + 0.5 * gap, 0.0)});
  }
  for (const auto [a, b] : detail::overlapping(grown, OpenDomain{}))
    all.bonds.push_back(std::minmax<std::size_t>(a, b));
  require(!all.bonds.empty() || all.spheres.size() == 1, "agglomerate: none of ",
          all.spheres.size(), " spheres is within gap = ", gap,
          " m of another, and nothing is bonded; give a larger gap, 0.3 radii for a lattice");
  std::sort(all.bonds.begin(), all.bonds.end());
  return all;
}

namespace detail {
/// For each sphere the first sphere of its connected piece.
inline DynArray<std::size_t> first_of_pieces(const BondedSpheres& all) {
  DynArray<std::size_t> root(all.spheres.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto top = [&root](std::size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (const auto& [a, b] : all.bonds) {
    const std::size_t p = top(a), q = top(b);
    root[std::max(p, q)] = std::min(p, q);
  }
  for (std::size_t k = 0; k < root.size(); ++k) root[k] = top(k);
  return root;
}
/// InputError for a bond of a sphere that does not exist, or with itself.
inline void check_bonds(const BondedSpheres& all) {
  for (std::size_t k = 0; k < all.bonds.size(); ++k) {
    const auto& [a, b] = all.bonds[k];
    require(a < all.spheres.size() && b < all.spheres.size() && a != b, "BondedSpheres: bond ", k,
            " is between the spheres ", a, " and ", b, " (counted from 0), but there are ",
            all.spheres.size(), "; give two places of its list of spheres");
  }
}
/// InputError for two bonds of the same spheres, or spheres at one place: what a simulation would
/// refuse after it has got the spheres.
template <class Sim>
void check_new_bonds(const Sim& sim, const BondedSpheres& all) {
  check_bonds(all);
  DynArray<std::pair<std::size_t, std::size_t>> seen;
  for (const auto& [a, b] : all.bonds) {
    Vec3d d = all.spheres[a].position - all.spheres[b].position;
    if constexpr (Sim::Domain::periodic) d = sim.domain().shortest(d);
    require(norm(d) > 0, "BondedSpheres: spheres ", a, " and ", b,
            " (counted from 0) are at one place and cannot be bonded");
    seen.push_back(std::minmax(a, b));
  }
  std::sort(seen.begin(), seen.end());
  const auto twice = std::adjacent_find(seen.begin(), seen.end());
  if (twice != seen.end())
    throw InputError(text("BondedSpheres: spheres ", twice->first, " and ", twice->second,
                          " (counted from 0) are bonded twice; leave out one of the bonds"));
}
}  // namespace detail

/// Number of connected pieces before anything breaks. Loose packings often have several.
inline std::size_t pieces_of(const BondedSpheres& all) {
  detail::check_bonds(all);
  const auto root = detail::first_of_pieces(all);
  std::size_t count = 0;
  for (std::size_t k = 0; k < root.size(); ++k) count += root[k] == k;
  return count;
}
/// The piece with the most spheres; of equal ones the first.
inline BondedSpheres largest_piece(const BondedSpheres& all) {
  detail::check_bonds(all);
  const auto root = detail::first_of_pieces(all);
  DynArray<std::size_t> count(root.size(), 0), place(root.size(), 0);
  for (const std::size_t r : root) ++count[r];
  const auto most =
      static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  BondedSpheres piece;
  for (std::size_t k = 0; k < root.size(); ++k)
    if (root[k] == most) place[k] = piece.spheres.size(), piece.spheres.push_back(all.spheres[k]);
  for (const auto& [a, b] : all.bonds)
    if (root[a] == most) piece.bonds.push_back({place[a], place[b]});
  return piece;
}

/// The same spheres and bonds at another place: rotated about the origin (rotation_about(axis,
/// angle)), then moved by `shift` [m], with `velocity` [m/s]. InputError if `turn` is not a unit
/// quaternion.
inline BondedSpheres placed(BondedSpheres all, const Vec3d& shift, const Quaternion& turn = {},
                            const Vec3d& velocity = {0, 0, 0}) {
  require(std::abs(turn.w * turn.w + dot(turn.vector(), turn.vector()) - 1) < 1e-6,
          "placed: turn = (", turn.w, "; ", turn.vector(),
          ") is not a unit quaternion; rotation_about(axis, angle) returns one");
  for (auto& p : all.spheres) p.position = rotate(turn, p.position) + shift, p.velocity = velocity;
  return all;
}

/// Adds spheres with their bonds, except bonds of two fixed spheres. Returns the id of the first;
/// those of the others follow. InputError, with nothing added, for a bond of a sphere that does not
/// exist, a pair that is bonded twice, or two bonded spheres at one place.
template <class Sim>
ParticleId add_bonded(Sim& sim, const BondedSpheres& all) {
  static_assert(Sim::has_bonds, "give the simulation silt::Bonds{model} among its policies");
  detail::check_new_bonds(sim, all);
  Particles<Sphere> more;
  for (const auto& p : all.spheres) more.add(p);
  const ParticleId first = sim.coming_id();
  sim.add(more);
  DynArray<std::pair<ParticleId, ParticleId>> pairs;
  for (const auto& [a, b] : all.bonds)
    if (!all.spheres[a].fixed || !all.spheres[b].fixed) pairs.push_back({first + a, first + b});
  sim.bond_all(pairs);
  return first;
}

namespace detail {
struct SphereSeen {
  ParticleId id;
  Vec3d position;       // [m]
  double radius, mass;  // [m], [kg]
  bool fixed;
};
/// All spheres of the simulation, of all ranks (collective).
template <class Sim>
DynArray<SphereSeen> all_spheres(const Sim& sim) {
  DynArray<SphereSeen> all;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k))
      all.push_back(
          {sim.id(k), sim.position(k), sim.radius(k), sim.mass(k), !std::isfinite(sim.mass(k))});
  if constexpr (Sim::has_ranks) {
    sim.engine().ranks.meet("all spheres");
    all = gather(sim.engine().ranks.comm(), std::span<const SphereSeen>(all)).values;
  }
  return all;
}
/// Whether each of these pairs is bonded on any rank (collective).
template <class Sim, class Pair>
DynArray<bool> bonded_of_ranks(const Sim& sim, const DynArray<Pair>& pairs) {
  DynArray<double> is(pairs.size(), 0);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    is[k] = sim.engine().particles.bonds.holds(pairs[k].i, pairs[k].j) ? 1 : 0;
  if constexpr (Sim::has_ranks) {
    sim.engine().ranks.meet("pairs that are bonded");
    sim.engine().ranks.max_of(std::span<double>(is));
  }
  DynArray<bool> bonded;
  for (const double one : is) bonded.push_back(one > 0);
  return bonded;
}
}  // namespace detail

/// Bonds all spheres within a surface distance of `gap` [m] that are not bonded yet, except two
/// fixed ones; with `chosen(id, id)` only those for which it is true. Returns the number of bonds
/// made. InputError if `gap` is negative or NaN.
template <class Sim, class Chosen>
std::size_t bond_near(Sim& sim, double gap, const Chosen& chosen) {
  require_not_negative("bond_near: gap", gap, "m");
  const auto all = detail::all_spheres(sim);
  AlignedVector<PositionRow> grown;
  for (const auto& p : all) {
    const double r = std::max(p.radius + 0.5 * gap, 0.0);
    grown.push_back({p.position.x, p.position.y, p.position.z, r});
  }
  struct Pair {
    ParticleId i, j;
    bool moves;
    auto operator<=>(const Pair&) const = default;
  };
  DynArray<Pair> pairs;
  for (const auto [a, b] : detail::overlapping(grown, sim.domain())) {
    const auto [i, j] = std::minmax(all[a].id, all[b].id);
    if (chosen(i, j)) pairs.push_back({i, j, !all[a].fixed || !all[b].fixed});
  }
  std::sort(pairs.begin(), pairs.end());  // independent of the order of the search
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  DynArray<std::pair<ParticleId, ParticleId>> wanted;
  const auto bonded = detail::bonded_of_ranks(sim, pairs);
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (!bonded[k] && pairs[k].moves) wanted.push_back({pairs[k].i, pairs[k].j});
  sim.bond_all(wanted);
  return wanted.size();
}
template <class Sim>
std::size_t bond_near(Sim& sim, double gap) {
  return bond_near(sim, gap, [](ParticleId, ParticleId) { return true; });
}

/// Fragments connected by bonds: for each place of the simulation the number of its fragment, from
/// 0 in the order of the lowest ids; no_fragment for an empty place. A loose sphere is a fragment
/// of its own. On many ranks numbers, sizes and masses are those of all ranks (collective).
struct Fragments {
  static constexpr std::size_t no_fragment = std::numeric_limits<std::size_t>::max();
  DynArray<std::size_t> of;       // each place
  DynArray<std::size_t> spheres;  // [-] in each fragment
  DynArray<double> mass;          // [kg] of each, without fixed spheres
  /// Number of fragments of at least two spheres [-]; spheres bonded only to a wall do not count.
  std::size_t bonded() const {
    return static_cast<std::size_t>(
        std::count_if(spheres.begin(), spheres.end(), [](std::size_t n) { return n > 1; }));
  }
};
template <class Sim>
Fragments fragments(const Sim& sim) {
  // Of all ranks, by ids.
  auto spheres = detail::all_spheres(sim);
  std::sort(spheres.begin(), spheres.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  const auto place_of = [&](ParticleId id) {
    return static_cast<std::size_t>(
        std::lower_bound(spheres.begin(), spheres.end(), id,
                         [](const auto& p, ParticleId wanted) { return p.id < wanted; }) -
        spheres.begin());
  };
  DynArray<std::size_t> root(spheres.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto top = [&](std::size_t k) {
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  DynArray<std::array<ParticleId, 2>> bonds;
  sim.for_each_bond([&](const auto& bond) {
    if (bond.b != no_particle) bonds.push_back({bond.a, bond.b});
  });
  if constexpr (Sim::has_ranks)
    bonds =
        gather(sim.engine().ranks.comm(), std::span<const std::array<ParticleId, 2>>(bonds)).values;
  for (const auto& [a, b] : bonds) root[top(place_of(a))] = top(place_of(b));
  Fragments all;
  all.of.assign(sim.rows(), Fragments::no_fragment);
  DynArray<std::size_t> number(spheres.size(), Fragments::no_fragment);
  for (std::size_t p = 0; p < spheres.size(); ++p) {
    auto& mine = number[top(p)];
    if (mine == Fragments::no_fragment)
      mine = all.spheres.size(), all.spheres.push_back(0), all.mass.push_back(0);
    ++all.spheres[mine];
    if (!spheres[p].fixed) all.mass[mine] += spheres[p].mass;
  }
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) all.of[k] = number[top(place_of(sim.id(k)))];
  return all;
}

}  // namespace silt
