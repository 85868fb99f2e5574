// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

#include <silt/core/dyn_array.hpp>
#include <silt/core/threads.hpp>
#include <silt/core/vec3.hpp>
#include <silt/coupling/particles_in_fluid.hpp>
#include <silt/sph/body_points.hpp>
#include <silt/sph/driven_walls.hpp>
#include <silt/sph/seen.hpp>
#include <silt/sph/setup.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Interaction of an SphCore's walls and bodies with the liquid.
/// @{

/// Velocity of a wall's particle at `away` from its mirror image, where the liquid has the velocity
/// `seen`: the mean on the surface between them is that of the wall (no-slip), or along it (slip).
/// `seen` is a mean over liquid that is farther from the wall than the image; along a no-slip wall
/// the velocity there is `nearer` times as different from the wall's, if it is linear. Bodies take
/// 1: within the kernel of a sphere of a few spacings it is not, and its drag came out 6 % less.
inline Vec3d sph_velocity_at_wall(const Vec3d& seen, const Vec3d& wall, const Vec3d& away,
                                  double nearer, Slip slip) {
  const Vec3d slips = seen - wall;
  const double part = dot(slips, away) / dot(away, away);
  if (!(part * part >= 0)) return slip == Slip::None ? wall - slips : seen;
  const Vec3d across = part * away;
  return slip == Slip::None ? wall - across - nearer * (slips - across) : seen - 2 * across;
}

/// What the wall particles of a pack of mirror images have from the liquid, a value per lane.
template <class Pairs>
struct SphImages {
  static constexpr std::size_t W = Pairs::W;
  alignas(64) double x[W] = {}, y[W] = {}, z[W] = {};  // [m] from an image to its particle
  alignas(64) double density[W], u[W], v[W], w[W], share[W], nearer[W], over[W];

  void put_way(std::size_t lane, const Vec3d& way) {
    x[lane] = way.x, y[lane] = way.y, z[lane] = way.z;
  }
  Vec3d way(std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
  Vec3d velocity(std::size_t lane) const { return {u[lane], v[lane], w[lane]}; }

  template <class Seen>
  void find(std::span<const Seen> seen, const Liquid& liquid, const Vec3d& gravity, double h,
            bool bodies) {
    using Real = decltype(Seen::weight);
    for (std::size_t part = 0; part < seen.size(); ++part) {
      const std::size_t l = part * Pairs::seen_width;
      const auto image =
          seen[part].at(load3<Real>(x + l, y + l, z + l), liquid, gravity, h, bodies);
      store(density + l, image.density), store(share + l, image.share);
      store(nearer + l, image.nearer), store(over + l, image.over);
      store(u + l, image.velocity.x), store(v + l, image.velocity.y);
      store(w + l, image.velocity.z);
    }
  }
};

/// Gives the wall particle in row `at` a velocity, by that of the liquid at its mirror image in
/// `row`, from which it is `away`.
template <class Core>
void sph_move_wall(Core& core, std::size_t at, std::size_t row, const Vec3d& seen,
                   const Vec3d& away, const SphImage& image, Slip slip) {
  auto& columns = core.columns;
  const Vec3d of_solid = core.solids.velocity(columns.label[row], row);
  const auto at_wall = [&](Slip how) {
    return of_solid +
           image.share * (sph_velocity_at_wall(seen, of_solid, away, image.nearer, how) - of_solid);
  };
  columns.rows[at].move(at_wall(slip));
  if (slip == Slip::None) columns.sticking[at] = columns.rows[at].velocity() - at_wall(Slip::Free);
}

/// use(pack, rows of the wall particles that belong to its probes; none: no such) for each pack of
/// mirror images with walls near liquid. These rows lie scattered; they are fetched while use()
/// makes its sums.
template <class Core, class Use>
void sph_for_images(Core& core, bool sticks, const Team& team, const Use& use) {
  using Lists = typename Core::Lists;
  constexpr std::size_t W = Core::Pairs::W;
  auto& columns = core.columns;
  const std::size_t first = core.lists.first_pack(Lists::Probe), n = core.lists.packs() - first;
  const auto find_walls = [&](std::size_t pack, std::array<std::uint32_t, W>& walls) {
    bool any = false;
    for (std::size_t l = 0; l < W; ++l) {
      std::uint32_t& at = walls[l];
      at = core.solids.of_row(pack * W + l).wall_row;
      if (at == Lists::none) continue;  // or a grain
      if (!core.lists.sees_liquid(at / W)) {
        at = Lists::none;
        continue;
      }
      any = true;
      __builtin_prefetch(&columns.rows[at], 1), __builtin_prefetch(&columns.volume[at], 1);
      if (sticks) __builtin_prefetch(&columns.sticking[at], 1);
    }
    return any;
  };
  team.for_ranges(n, Lists::packs_a_range, [&](std::size_t, std::size_t from, std::size_t to) {
    std::array<std::uint32_t, W> walls;
    for (std::size_t p = first + from; p < first + to; ++p)
      if (find_walls(p, walls)) use(p, walls);
  });
}

/// Density and velocity of wall particles, from the liquid at their mirror images.
template <class Core>
void sph_mirror(Core& core, const typename Core::Pairs& pairs, const Team& team) {
  using Pairs = typename Core::Pairs;
  using Lists = typename Core::Lists;
  constexpr std::size_t W = Pairs::W;
  auto& columns = core.columns;
  const auto& solids = core.solids;
  const Slip slip = core.slip();
  const std::size_t first = core.lists.first_pack(Lists::Probe) * W;
  if (slip == Slip::None) columns.sticking.resize(columns.size(), Vec3d{0, 0, 0});
  columns.holds.resize(columns.size());
  if constexpr (Core::Time::leaps) make_room(columns.images, columns.size() - first);
  sph_for_images(core, slip == Slip::None, team, [&](std::size_t p, const auto& walls) {
    std::array<typename Pairs::Seen, W / Pairs::seen_width> seen{};
    if (core.lists.sees_liquid(p))
      pairs.look(p, columns.rows, columns.volume, core.lists, seen, columns.brief);
    SphImages<Pairs> images;
    for (std::size_t l = 0; l < W; ++l)
      if (const std::uint32_t at = walls[l]; at != Lists::none)
        images.put_way(l, core.lists.repeats.shortest(columns.rows[at].position() -
                                                      columns.rows[p * W + l].position()));
    images.find(std::span<const typename Pairs::Seen>(seen), core.liquid, core.weight(),
                core.setup.h(), !solids.bodies.empty());
    for (std::size_t l = 0; l < W; ++l) {
      const std::uint32_t at = walls[l];
      if (at == Lists::none) continue;
      const std::size_t row = p * W + l;
      auto& wall = columns.rows[at];
      wall.density = images.density[l], wall.pressure = core.liquid.pressure(wall.density);
      const double nearer = solids.is_wall(columns.label[row]) ? images.nearer[l] : 1;
      const SphImage image{images.over[l], images.share[l], nearer};
      sph_move_wall(core, at, row, images.velocity(l), images.way(l), image, slip);
      if constexpr (Core::Time::leaps) columns.images[row - first] = image;
      columns.volume[at] = solids.of_row(row).share * core.particle_mass() / wall.density;
      columns.holds[at] =
          solids.holding.sees_bulk(images.over[l]) && solids.holding.holds(columns.label[row]);
    }
  });
}

/// Their velocities anew, after those of the liquid have changed at the same positions.
template <class Core>
void sph_mirror_velocities(Core& core, const typename Core::Pairs& pairs, const Team& team) {
  using Lists = typename Core::Lists;
  constexpr std::size_t W = Core::Pairs::W;
  auto& columns = core.columns;
  const Slip slip = core.slip();
  const std::size_t first = core.lists.first_pack(Lists::Probe) * W;
  sph_for_images(core, slip == Slip::None, team, [&](std::size_t p, const auto& walls) {
    std::array<Vec3d, W> seen{};
    if (core.lists.sees_liquid(p))
      pairs.look_at_velocity(p, columns.rows, columns.volume, core.lists, seen, columns.brief);
    for (std::size_t l = 0; l < W; ++l) {
      const std::uint32_t at = walls[l];
      if (at == Lists::none) continue;
      const std::size_t row = p * W + l;
      const SphImage& image = columns.images[row - first];
      const Vec3d away =
          core.lists.repeats.shortest(columns.rows[at].position() - columns.rows[row].position());
      sph_move_wall(core, at, row, image.over * seen[l], away, image, slip);
    }
  });
}

/// Sums over the liquid for particles of walls and bodies, for packs with is_asked(pack).
template <class Core, class IsAsked>
void sph_solid_rates(Core& core, const Team& team, const IsAsked& is_asked) {
  using Lists = typename Core::Lists;
  const auto pairs = core.pairs();
  auto& of = core.columns;
  const std::size_t first = core.lists.first_pack(Lists::Wall),
                    n = core.lists.first_pack(Lists::Probe) - first;
  team.for_ranges(n, Lists::packs_a_range, [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t p = first + from; p < first + to; ++p) {
      if (!is_asked(p)) continue;
      pairs.of_wall(p, of.rows, of.volume, core.lists, of.rates, of.growth, of.brief,
                    of.beside());
      if constexpr (Core::turbulent)
        core.sps().accelerate(p, Core::Pairs::W, of.rows, of.volume, of.stress, core.lists,
                              of.rates, false);
    }
  });
}

template <class Core>
void sph_solid_rates(Core& core, const Team& team) {
  sph_solid_rates(core, team, [](std::size_t) { return true; });
}

/// Loads of the liquid on driven walls, after their rates.
template <class Core>
void sph_driven_loads(const Core& core, std::span<LiquidOnWall> loads) {
  const auto& walls = core.solids.walls;
  const SphSetup& setup = core.setup;
  const double c = core.liquid.sound_speed, area = setup.volume() / setup.spacing;
  const double damping = core.liquid.density * c * area;  // [N s/m] of a particle
  for (std::size_t k = 0; k < walls.size(); ++k) {
    const std::size_t w = walls.wall_of(k);
    if (!walls.is_driven(w)) continue;
    const Vec3d f = core.solids.force_on(k, core.columns, core.particle_mass());
    if (dot(f, f) == 0) continue;  // dry
    LiquidOnWall& load = loads[w];
    Vec3d arm = core.solids.place(k) - walls.driven(w).centre_at(core.now);
    if (core.solids.plane) arm.y = 0;
    load.force += f, load.torque += cross(arm, f);
    if (!(walls.depth(k) < setup.spacing)) continue;
    const Vec3d out = core.solids.ghost(k) - core.solids.place(k);
    if (!(norm(out) > 0)) continue;
    const Vec3d n = normalised(out), t = cross(arm, n);
    const double along = way_of_drive(walls.wall(w).drive, arm, n);
    load.damping += damping * along * along;
    load.stiffness += damping * c / setup.h() * along * along;
    load.along += damping * Vec3d{n.x * n.x, n.y * n.y, n.z * n.z};
    load.around += damping * Vec3d{t.x * t.x, t.y * t.y, t.z * t.z};
  }
  for (const auto& push : core.gaps.pushes()) {
    if (!walls.is_driven(push.wall)) continue;
    Vec3d arm =
        core.solids.place(walls.size() + push.point) - walls.driven(push.wall).centre_at(core.now);
    if (core.solids.plane) arm.y = 0;
    loads[push.wall].force -= push.force, loads[push.wall].torque -= cross(arm, push.force);
  }
}

/// [s] Longest time for which loads on a body of radius R [m] and mass m [kg] may be constant. A
/// body that moves radiates sound, which damps it with the rate rho c A/m, A = 4/3 pi R^2 or in 2D
/// pi R. Over a longer time a light body would oscillate with growing amplitude.
template <class Core>
double sph_exchange_of(const Core& core, double R, double m) {
  const double pi = std::numbers::pi,
               area = core.setup.dimensions == 2 ? pi * R : 4 * pi / 3 * R * R;
  return 0.5 * m / (core.liquid.density * core.liquid.sound_speed * area);
}
template <class Core>
double sph_longest_exchange(const Core& core, const CoupledParticles& of) {
  double longest = INFINITY;
  for (const std::size_t p : core.resolved)
    longest = std::min(longest, sph_exchange_of(core, of.shape.radius[p], of.mass[p]));
  return longest;
}
/// Steps of dt [s] beyond four times that limit, where the oscillation grows; of bodies that were
/// known when dt was chosen.
template <class Core>
void refuse_light_bodies(const Core& core, const CoupledParticles& of, double dt) {
  if (!(dt > 4 * core.exchange)) return;
  for (std::size_t b = 0; b < core.resolved.size(); ++b) {
    const std::size_t p = core.resolved[b];
    const double longest = sph_exchange_of(core, of.shape.radius[p], of.mass[p]);
    if (dt > 4 * longest)
      throw Error(sentence(
          "particle ", core.body_ids[b], " at ", of.shape.position[p], " m with ", of.mass[p],
          " kg is too light compared with the liquid for steps of ", dt,
          " s; set Simulation::time_step to less than ", longest, " s, or give it a larger mass",
          core.disc.mass > 0 ? ": in 2D a sphere has the mass of a sphere, but displaces a disc "
                               "that is 1 m long"
                             : ""));
  }
}

/// Loads of the liquid on bodies: opposite to the forces on the liquid, pair by pair.
template <class Core>
void sph_body_loads(Core& core, const Team& team) {
  auto& solids = core.solids;
  BodyPoints& of = solids.bodies;
  for (auto& b : of.bodies) b.force = b.torque = {0, 0, 0};
  const bool driven = solids.walls.any_driven();
  if (of.empty() && !driven) return;
  const std::size_t first = solids.walls.size();
  if constexpr (Core::Walls::mirrored)
    sph_solid_rates(core, team, [&](std::size_t pack) {  // not needed for prescribed walls
      constexpr std::size_t W = Core::Pairs::W;
      for (std::size_t row = pack * W; row < (pack + 1) * W; ++row)
        if (const std::uint32_t k = core.columns.label[row];
            k != Core::Lists::none && (driven || k >= first))
          return true;
      return false;
    });
  core.gaps.find(core, team);
  core.in_step.assign(driven ? solids.walls.walls() : 0, {});
  if (driven) sph_driven_loads(core, core.in_step);
  const DynArray<std::size_t>& begin = of.begin();
  team.for_ranges(of.bodies.size(), 4, [&](std::size_t, std::size_t from, std::size_t to) {
    for (std::size_t b = from; b < to; ++b) {
      auto& body = of.bodies[b];
      for (std::size_t k = first + begin[b]; k < first + begin[b + 1]; ++k) {
        if (!solids.has_row(k)) continue;
        const Vec3d f = solids.force_on(k, core.columns, core.particle_mass());
        Vec3d arm = solids.place(k) - body.centre;
        if (solids.plane) arm.y = 0;
        body.force += f, body.torque += cross(arm, f);
      }
    }
  });
  for (const auto& push : core.gaps.pushes()) {
    auto& body = of.bodies[of.body_of(push.point)];
    Vec3d arm = of.place(push.point) - body.centre;
    if (solids.plane) arm.y = 0;
    body.force += push.force, body.torque += cross(arm, push.force);
  }
}
/// @}

}  // namespace silt::detail
