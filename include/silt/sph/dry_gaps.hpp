// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/position_row.hpp>
#include <silt/core/quaternion.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/body_points.hpp>
#include <silt/sph/cluster_lists.hpp>
#include <silt/sph/seen.hpp>
#include <silt/sph/surface_slope.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Pressure in gaps between bodies and walls that are too narrow for a particle. Without it a body
/// on a floor is pressed down by the liquid above: even a cork would stay down, because its lower
/// side is dry. Floors and bodies are taken as rough: liquid fills the gap with the hydrostatic
/// pressure of its surroundings:
///
///   f_k = -2 V_k (p_w B_k + p_k s_k (M_k - B_k)),  M_k = -sum_own V grad W - sum_liquid V grad W
///
/// M_k is the missing part of the kernel gradient at the particle k of a body, compared with liquid
/// on all sides; the latter is the opposite of the sum over the body. B_k is the part of it that
/// the wall takes, that of a half-space, but no more than is missing: no particle of the body meets
/// those of the wall. The rest is a gap without liquid. It counts fully (s_k = 1) where 0.3 of the
/// gradient is missing, and not at all where a tenth is, as around any body in a liquid. Without
/// B_k at the lowest particles of a block's sides, which are in liquid, the block lacked 13 % of
/// its buoyancy.
///
/// p_w is the pressure at the wall in front of k, p_k that at the surface of the body: the mean
/// over the liquid within the kernel's reach of the body's surface along that wall, closer than 2 h
/// to the wall, extrapolated by rho g, and not below 0. The wall gets -f_k at the same point.
///
/// Sound is left out of p_k - rho g.x by a low pass with the time that sound takes to the surface
/// and back twice, 4 (h + p/(rho g))/c. A gap that opens takes no volume from the liquid, so that
/// sound would drive a body that leaves its floor: blocks of 1.1 and 2 times water's density hopped
/// on the floor for ever, at the column's resonance, with 1 cm/s.
///
/// Source: silt's own.
/// Valid:  gaps between bodies and walls; not between bodies. No suction: p_k >= 0.
/// Tests:  tests/sph/body_on_floor.cpp.
template <class Kernel>
class DryGaps {
 public:
  struct Push {
    std::size_t point;  // index in BodyPoints; gets `force`
    std::size_t wall;   // gets the opposite
    Vec3d force{0, 0, 0};
  };
  std::span<const Push> pushes() const { return pushes_; }
  /// For a state: time, number of points, three numbers per point, then five per body and wall. The
  /// sums over a body's own particles are not found anew: a state that was just loaded does not
  /// know the forms of its bodies.
  DynArray<double> state(const BodyPoints& points) const {
    const bool summed = summed_ == points.version();
    DynArray<double> all{then_, summed ? static_cast<double>(own_.size()) : 0};
    if (summed)
      for (const Vec3d& m : own_) all.insert(all.end(), {m.x, m.y, m.z});
    for (const Level& l : levels_)
      all.insert(all.end(), {static_cast<double>(l.id >> 32), static_cast<double>(l.id & low_bits),
                             static_cast<double>(l.body), static_cast<double>(l.wall), l.pressure});
    return all;
  }
  void restore(std::span<const double> of, const BodyPoints& points) {
    const auto whole = [](double x) { return static_cast<std::uint64_t>(x); };
    const bool summed = of.size() > 1 && of[1] != 0;
    const std::size_t from = summed ? 2 + 3 * points.size() : 2;
    require(of.size() >= from && (of.size() - from) % 5 == 0 &&
                (!summed || of[1] == static_cast<double>(points.size())),
            "Sph: a state has ", of.size(), " numbers of gaps for ", points.size(), " points");
    then_ = of[0], levels_.clear(), own_.clear();
    for (std::size_t k = 2; k < from; k += 3) own_.push_back({of[k], of[k + 1], of[k + 2]});
    summed_ = summed ? points.version() : 0;
    for (std::size_t k = from; k < of.size(); k += 5)
      levels_.push_back(
          {whole(of[k]) << 32 | whole(of[k + 1]), whole(of[k + 2]), whole(of[k + 3]), of[k + 4]});
  }
  /// The present bodies by their ids, in ascending order: bodies may have come or gone.
  void find_bodies(std::span<const ParticleId> ids) {
    DynArray<Level> kept;
    for (Level l : levels_) {
      const auto at = std::lower_bound(ids.begin(), ids.end(), l.id);
      if (at == ids.end() || *at != l.id) continue;
      l.body = static_cast<std::size_t>(at - ids.begin());
      kept.push_back(l);
    }
    levels_.swap(kept);
  }

  /// Finds the forces for the present densities and lists.
  template <class Core>
  void find(const Core& core, const Team& team) {
    pushes_.clear();
    const BodyPoints& of = core.solids.bodies;
    if (of.empty() || core.solids.walls.walls() == 0) return;
    if (made_ != of.version() || listed_ != core.lists.version()) {
      if (summed_ != of.version()) find_own(of, core.setup);
      if (made_ == 0) half_space_ = SphHalfSpace<Kernel>(core.setup.dimensions);
      find_sites(core, team);
      made_ = of.version(), listed_ = core.lists.version();
    }
    look_at_walls(core, team);
    look_at_liquid(core, team);
    find_levels(core, team);
    std::array<DynArray<Push>, Team::most_ranges> parts;
    const std::size_t groups = groups_.size() - 1;
    team.for_ranges(groups, 4, [&](std::size_t range, std::size_t from, std::size_t to) {
      for (std::size_t b = from; b < to; ++b) push(core, b, parts[range]);
    });
    for (const auto& part : parts) pushes_.insert(pushes_.end(), part.begin(), part.end());
  }

 private:
  /// A point of a body that may come near a wall while the lists hold.
  struct Site {
    std::size_t point, wall = 0;
    double gap = 0;          // [m]
    Vec3d surface{0, 0, 0};  // [m]
    Vec3d normal{0, 0, 0};   // [-] of the wall, towards the body
    Vec3d slope{0, 0, 0};    // [1/m] sum of V grad W over the liquid
    double weight = 0;       // [-] of V W
    double level = 0;        // [Pa] of V W (P - rho g.x)
  };
  struct Seat {
    std::size_t row, site;
  };
  /// For each kind of body: its points are in the same order. They reach as deep as the liquid's
  /// kernels do; the sums need those below too. Without them blocks 8 spacings high lost up to
  /// 1.2 times their buoyancy.
  void find_own(const BodyPoints& of, const SphSetup& setup) {
    own_.assign(of.size(), {0, 0, 0}), summed_ = of.version();
    const double h = setup.h(), a = Kernel::normalisation(setup.dimensions, h) / (h * h),
                 V = setup.volume();
    struct Place {
      Vec3d at;
      double volume;
    };
    DynArray<Place> parts;
    std::map<std::pair<std::uint32_t, double>, std::size_t> known;
    for (std::size_t from = 0, to = 0; from < of.size(); from = to) {
      const auto& body = of.bodies[of.body_of(from)];
      while (to < of.size() && of.body_of(to) == of.body_of(from)) ++to;
      const auto [same, is_new] = known.try_emplace({body.form, body.radius}, from);
      if (!is_new) {
        std::copy_n(own_.begin() + same->second, to - from, own_.begin() + from);
        continue;
      }
      parts.clear();
      for (std::size_t k = from; k < to; ++k) parts.push_back({of.own_place(k), V * of.share(k)});
      of.for_each_under(of.body_of(from), setup, [&](const Vec3d& at, double share) {
        parts.push_back({at, V * share});
      });
      std::sort(parts.begin(), parts.end(),
                [](const Place& one, const Place& other) { return one.at.x < other.at.x; });
      for (std::size_t k = from; k < to; ++k) {
        const Vec3d x = of.own_place(k);
        auto part = std::lower_bound(parts.begin(), parts.end(), x.x - 2 * h,
                                     [](const Place& p, double least) { return p.at.x < least; });
        for (; part != parts.end() && part->at.x < x.x + 2 * h; ++part) {
          const Vec3d r = x - part->at;
          own_[k] += a * part->volume * Kernel::slope(norm(r) / h) * r;
        }
      }
    }
  }
  /// Whether liquid is near any of a body's points, by the lists.
  template <class Core>
  static bool is_wet(const Core& core, std::size_t from, std::size_t to) {
    for (std::size_t k = core.solids.walls.size() + from; k < core.solids.walls.size() + to; ++k)
      if (core.solids.has_row(k) &&
          core.lists.sees_liquid(core.solids.wall_row[k] / core.lists.width))
        return true;
    return false;
  }
  /// The points of wet bodies that may come within the kernel's reach of a wall before a particle
  /// has moved by more than its slack in the lists.
  template <class Core>
  void find_sites(const Core& core, const Team& team) {
    const BodyPoints& of = core.solids.bodies;
    const auto& walls = core.solids.walls;
    const double reach = 2 * core.setup.h(),
                 slack = walls.size() > 0 ? core.lists.slack(core.solids.wall_row[0]) : INFINITY;
    std::array<DynArray<Site>, Team::most_ranges> parts;
    team.for_ranges(of.bodies.size(), 4, [&](std::size_t range, std::size_t from, std::size_t to) {
      for (std::size_t b = from; b < to; ++b) {
        const std::size_t first = of.begin()[b], last = of.begin()[b + 1];
        if (!is_wet(core, first, last)) continue;
        // Twice: a restored run begins when part of it is used up.
        const double near = reach + 2 * (slack + slack_of(core, first, last));
        if (walls.distance(of.bodies[b].centre) > of.bodies[b].reach + near) continue;
        for (std::size_t k = first; k < last; ++k)
          if (walls.distance(surface(of, k)) < near) parts[range].push_back({k});
      }
    });
    sites_.clear(), seats_.clear(), groups_.assign(1, 0);
    for (const auto& part : parts) sites_.insert(sites_.end(), part.begin(), part.end());
    for (std::size_t n = 1; n <= sites_.size(); ++n)
      if (n == sites_.size() || of.body_of(sites_[n].point) != of.body_of(sites_[n - 1].point))
        groups_.push_back(n);
    for (std::size_t n = 0; n < sites_.size(); ++n)
      if (const std::size_t k = walls.size() + sites_[n].point; core.solids.has_row(k))
        seats_.push_back({core.solids.wall_row[k], n});
    std::sort(seats_.begin(), seats_.end(),
              [](const Seat& a, const Seat& b) { return a.row < b.row; });
    packs_.assign(1, 0);
    for (std::size_t n = 1; n <= seats_.size(); ++n)
      if (n == seats_.size() ||
          seats_[n].row / core.lists.width != seats_[n - 1].row / core.lists.width)
        packs_.push_back(n);
  }
  static Vec3d surface(const BodyPoints& of, std::size_t k) {
    return 0.5 * (of.place(k) + of.ghost(k));
  }
  /// [m] The largest of a body's points.
  template <class Core>
  static double slack_of(const Core& core, std::size_t from, std::size_t to) {
    const std::size_t walls = core.solids.walls.size();
    double most = 0;
    for (std::size_t k = walls + from; k < walls + to; ++k)
      if (core.solids.has_row(k)) most = std::max(most, core.lists.slack(core.solids.wall_row[k]));
    return most;
  }
  template <class Core>
  void look_at_walls(const Core& core, const Team& team) {
    team.for_ranges(sites_.size(), 32, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t n = from; n < to; ++n) {
        const Vec3d x = surface(core.solids.bodies, sites_[n].point);
        const auto wall = core.solids.walls.nearest(x);
        sites_[n] = {sites_[n].point, wall.wall, wall.distance, x, wall.normal};
      }
    });
  }
  /// Sums over the liquid, a pack of rows at a time.
  template <class Core>
  void look_at_liquid(const Core& core, const Team& team) {
    constexpr std::size_t W = Core::Pairs::W;
    const auto pairs = core.pairs();
    const auto& of = core.columns;
    const Vec3d rho_g = core.liquid.density * core.weight();
    const double reach = 2 * core.setup.h();
    constexpr std::size_t least = ClusterLists::packs_a_range;
    team.for_ranges(packs_.size() - 1, least, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t p = from; p < to; ++p) {
        const std::span seats(seats_.data() + packs_[p], packs_[p + 1] - packs_[p]);
        if (std::none_of(seats.begin(), seats.end(),
                         [&](const Seat& s) { return sites_[s.site].gap < reach; }))
          continue;
        std::array<SphLevel, W> levels;
        pairs.look_at_level(seats[0].row / W, of.rows, of.volume, core.lists, levels, of.brief);
        for (const Seat& seat : seats) {
          Site& s = sites_[seat.site];
          const SphLevel& level = levels[seat.row % W];
          s.slope = level.slope, s.weight = level.weight;
          const Vec3d place = core.solids.bodies.place(s.point);
          s.level = level.pressure - dot(rho_g, level.weight * place - level.way);
        }
      }
    });
  }
  /// Pressure minus rho g.x of the liquid around each body, wall by wall, at rest: sound is left
  /// out.
  template <class Core>
  void find_levels(const Core& core, const Team& team) {
    const double reach = 2 * core.setup.h(), least = 0.1;
    struct Around {
      double weight = 0, level = 0, surface = 0;
    };
    DynArray<std::map<std::size_t, Around>> around(groups_.size() - 1);
    const Vec3d rho_g = core.liquid.density * core.weight();
    team.for_ranges(around.size(), 4, [&](std::size_t, std::size_t from, std::size_t to) {
      for (std::size_t b = from; b < to; ++b)
        for (std::size_t n = groups_[b]; n < groups_[b + 1]; ++n) {
          const Site& site = sites_[n];
          if (!(site.gap < reach)) continue;
          Around& to_wall = around[b][site.wall];
          to_wall.weight += site.weight, to_wall.level += site.level;
          to_wall.surface += site.weight * dot(rho_g, site.surface);
        }
    });
    const double span = core.now - then_, c = core.liquid.sound_speed;
    DynArray<Level> before;
    before.swap(levels_), first_level_.clear();
    for (std::size_t b = 0; b < around.size(); ++b) {
      first_level_.push_back(levels_.size());
      const std::size_t body = core.solids.bodies.body_of(sites_[groups_[b]].point);
      // Unknown only to a reading of a state just loaded, which keeps no level.
      const ParticleId id = body < core.body_ids.size() ? core.body_ids[body] : ParticleId{};
      for (const auto& [wall, of] : around[b]) {
        if (!(of.weight > least)) continue;
        Level level{id, body, wall, of.level / of.weight};
        const auto old = std::lower_bound(before.begin(), before.end(), level);
        if (old != before.end() && !(level < *old)) {
          const double deep = std::max((of.level + of.surface) / of.weight, 0.0),
                       weight = norm(rho_g),
                       time = 4 * (core.setup.h() + (weight > 0 ? deep / weight : 0)) / c;
          level.pressure = old->pressure + (level.pressure - old->pressure) * span / (time + span);
        }
        levels_.push_back(level);
      }
    }
    first_level_.push_back(levels_.size()), then_ = core.now;
  }
  /// Forces on one body, wall by wall.
  template <class Core>
  void push(const Core& core, std::size_t group, DynArray<Push>& out) const {
    const double s = core.setup.spacing, V = core.setup.volume();
    const Vec3d rho_g = core.liquid.density * core.weight();
    const double h = core.setup.h(), reach = 2 * h;
    const std::span levels(levels_.data() + first_level_[group],
                           first_level_[group + 1] - first_level_[group]);
    for (std::size_t n = groups_[group]; n < groups_[group + 1]; ++n) {
      const Site& site = sites_[n];
      if (!(site.gap < reach)) continue;
      const auto level = std::find_if(levels.begin(), levels.end(),
                                      [&](const Level& l) { return l.wall == site.wall; });
      if (level == levels.end()) continue;
      const BodyPoints& of = core.solids.bodies;
      const double volume = V * of.share(site.point);
      const auto add = [&](const Vec3d& missing, const Vec3d& at) {
        const double p = level->pressure + dot(rho_g, at);
        if (p > 0) out.push_back({site.point, site.wall, -2 * volume * p * missing});
      };
      // What the wall takes, with the pressure at its surface.
      const Vec3d place = of.place(site.point);
      const double away = site.gap + dot(place - site.surface, site.normal);
      const Vec3d all = -1.0 * of.turned(site.point, own_[site.point]);
      // Beside an edge, and at a thin wall, there is less of it.
      const double missing = std::max(-dot(all - site.slope, site.normal), 0.0);
      const Vec3d behind = -std::min(half_space_(away / h) / h, missing) * site.normal;
      if (away < reach) add(behind, place - away * site.normal);
      // What is empty in between.
      const double whole = dot(all, all);
      if (!(whole * reach * reach > 4e-3)) continue;
      const double wet = dot(site.slope + behind, all) / whole,
                   share = std::clamp(5 * (0.9 - wet), 0.0, 1.0) *
                           std::clamp(2.5 - site.gap / s, 0.0, 1.0);
      if (share > 0) add(share * (all - site.slope - behind), site.surface);
    }
  }

  struct Level {
    ParticleId id;
    std::size_t body, wall;
    double pressure;  // [Pa] minus rho g.x
    bool operator<(const Level& o) const {
      return body < o.body || (body == o.body && wall < o.wall);
    }
  };
  static constexpr std::uint64_t low_bits = 0xffffffff;
  DynArray<Level> levels_;                            // body by body
  DynArray<std::size_t> first_level_{0};              // of each group of sites, and the end
  double then_ = 0;                                   // [s] of these
  std::uint64_t made_ = 0, summed_ = 0, listed_ = 0;  // versions of the points and of the lists
  DynArray<Vec3d> own_;  // [1/m] sum of V grad W over a body's own particles, in its frame
  SphHalfSpace<Kernel> half_space_;
  DynArray<Site> sites_;             // body by body
  DynArray<std::size_t> groups_{0};  // first site of each body, and the end
  DynArray<Seat> seats_;             // of those that have a row, in its order
  DynArray<std::size_t> packs_{0};   // first seat of each pack, and the end
  DynArray<Push> pushes_;
};

}  // namespace silt::detail
