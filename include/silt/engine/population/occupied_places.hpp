// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>

#include <silt/boundary/deforming_box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/engine/lists/wall_candidate.hpp>
#include <silt/fill/packing.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Calls visit(p) with a point and its images one box length away in the periodic directions.
template <class Domain, class Visit>
void for_images(const Domain& domain, const Vec3d& p, const Visit& visit) {
  if constexpr (Domain::periodic) {
    const int nx = domain.repeats(0), ny = domain.repeats(1), nz = domain.repeats(2);
    for (int z = -nz; z <= nz; ++z)
      for (int y = -ny; y <= ny; ++y)
        for (int x = -nx; x <= nx; ++x)
          visit(p + Vec3d{x * domain.length(0), y * domain.length(1), z * domain.length(2)});
  } else {
    visit(p);
  }
}

/// What blocked the insertion of one sphere of an inlet.
struct Obstacles {
  std::size_t particles = 0;    // [-] trials blocked by particles
  DynArray<std::size_t> walls;  // [-] trials blocked by each wall
  Vec3d last{0, 0, 0};          // [m] the last place blocked by a particle

  void hit_wall(std::size_t w) {
    if (walls.size() <= w) walls.resize(w + 1, 0);
    ++walls[w];
  }
  std::size_t all() const { return std::accumulate(walls.begin(), walls.end(), particles); }
};

/// Where a sphere of an inlet cannot be placed: inside other particles, inside walls and their
/// images, or behind planes; `met` counts the obstacles.
template <class Domain>
struct OccupiedPlaces {
  const SphereGrid& spheres;
  const DynArray<Wall>& walls;
  const Domain& domain;
  Obstacles& met;

  bool is_free(const Vec3d& centre, double radius, double gap) const {
    if (!spheres.is_free(centre, radius, gap)) {
      ++met.particles, met.last = centre;
      return false;
    }
    const auto hit = std::find_if(walls.begin(), walls.end(), [&](const Wall& wall) {
      return std::any_of(wall.surfaces.begin(), wall.surfaces.end(),
                         [&](const Surface& s) { return is_at(wall, s, centre, radius + gap); });
    });
    if (hit == walls.end()) return true;
    met.hit_wall(static_cast<std::size_t>(hit - walls.begin()));
    return false;
  }

 private:
  bool is_at(const Wall& wall, const Surface& s, const Vec3d& centre, double reach) const {
    if constexpr (Domain::periodic && !deforms<Domain>) {
      bool found = false;
      const Box around = Box{centre, centre}.grown(reach);
      images_of(wall, s, domain, around).for_each([&](WallImage image) {
        const Vec3d seen = centre + way_of(image, period_of(domain));
        found = found || is_touched(s, in_wall(wall, seen), reach);
      });
      return found;
    } else {
      return is_touched(s, in_wall(wall, centre), reach);
    }
  }
  static bool is_touched(const Surface& s, const Vec3d& at, double reach) {
    return visit_surface(s, [&](const auto& surface) {
      if constexpr (requires { surface.nearest_point(at); }) {
        return std::abs(surface.nearest_point(at).distance) < reach;
      } else {
        SurfacePoint points[std::remove_cvref_t<decltype(surface)>::max_contacts];
        return surface.contacts(at, reach, points) > 0;
      }
    });
  }
};

/// "particles 3 and 8": those whose spheres are within `reach` [m] of a place; empty if none is.
template <class Engine, class Domain>
[[gnu::cold]] std::string who_is_at(const Engine& engine, const Domain& domain, const Vec3d& place,
                                    double reach) {
  constexpr std::size_t most = 3;
  DynArray<ParticleId> ids;
  const auto rows = engine.particles.rows();
  for (std::size_t r = 0; r < rows.size() && ids.size() < most; ++r) {
    if (!(rows[r].r > 0)) continue;
    bool near = false;
    for_images(domain, rows[r].centre(),
               [&](const Vec3d& image) { near = near || norm(image - place) < reach + rows[r].r; });
    const ParticleId id = engine.owner(engine.owner_of(r)).id();
    if (near && std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  }
  std::string words;
  for (std::size_t k = 0; k < ids.size(); ++k)
    words += text(k == 0                ? (ids.size() > 1 ? "particles " : "particle ")
                  : k + 1 == ids.size() ? " and "
                                        : ", ",
                  ids[k]);
  return words;
}

/// Why a sphere of radius `radius` [m] could not be placed, and what to change.
template <class Engine, class Domain>
[[gnu::cold]] std::string why_no_place(const Engine& engine, const Domain& domain,
                                       const Obstacles& met, std::size_t trials, double radius) {
  if (met.all() < trials)
    return text("hardly any point of the region has room for a sphere of radius ", radius,
                " m; enlarge the region, or take smaller particles");
  std::string words = text(trials, " random places in a row were occupied: ");
  auto add = [&, first = true](std::size_t count, const std::string& by) mutable {
    if (count == 0) return;
    words += text(std::exchange(first, false) ? "" : ", ", count, " by ", by);
  };
  std::string who = who_is_at(engine, domain, met.last, radius);
  add(met.particles, who.empty() ? "particles that the inlet placed before in this step"
                                 : text("particles (the last by ", who, ")"));
  for (std::size_t w = 0; w < met.walls.size(); ++w)
    add(met.walls[w], name_of_wall(engine.walls, w));
  return words + (met.particles == 0
                      ? "; the region lies in or behind the wall: move it"
                      : "; lower the rate, enlarge the region, or give a velocity that clears it");
}

}  // namespace silt::detail
