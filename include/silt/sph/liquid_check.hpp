// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <string>

#include <silt/core/box.hpp>
#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/sph/row.hpp>

namespace silt::inline SILT_TARGET::detail {

/// Checks of the state of an SphCore's liquid.
/// @{

/// Error message: where, what, and what to change.
template <class Core>
std::string sph_what_is_wrong(const Core& core, const SphRow& r) {
  const Vec3d x = r.position();
  const double c = core.liquid.sound_speed, speed = norm(r.velocity());
  const std::string what = sentence("the liquid's step ", core.steps, ", t = ", core.time,
                                    " s: the liquid at ", x, " m"),
                    is = sentence(" density ", r.density, " kg/m3 and velocity ", r.velocity(),
                                  " m/s");
  if (is_finite(x) && core.solids.walls.walls() > 0)
    if (const auto wall = core.solids.walls.nearest(x); wall.distance < -0.1 * core.setup.spacing)
      return sentence(what, " has gone through wall ", core.solids.walls.called(wall.wall), " by ",
                      -wall.distance, " m, with", is,
                      "; use a smaller spacing, a larger alpha of the viscosity (0.1), or a slower "
                      "wall");
  if (is_finite(x))
    if (const auto body = core.body_at(x); body && *body < core.body_ids.size())
      return sentence(what, " has gone into body ", core.body_ids[*body], " at ",
                      core.solids.bodies.bodies[*body].centre, " m, with", is,
                      "; use a smaller spacing, a larger alpha of the viscosity (0.1), or a slower "
                      "body");
  const std::string beyond = sentence(what, " has", is, ", beyond ", core.least_density, " to ",
                                      core.most_density, " of ", core.liquid.density, " kg/m3; ");
  if (speed > 0.2 * c)
    return sentence(beyond, "that is ", speed / c, " of Liquid.sound_speed = ", c,
                    " m/s, and speeds may be a tenth of it; if the scene is that fast, use a "
                    "larger Liquid.sound_speed, ",
                    10 * speed, " m/s, else a larger alpha of the viscosity (0.1)");
  return sentence(beyond,
                  "use a smaller spacing, a larger alpha of the viscosity (0.1) or a smaller "
                  "SphSetup.courant; for an isolated drop, whose density no neighbour "
                  "supports, a lower Sph::least_density");
}
/// Stops the run if a liquid particle violates its bounds.
template <class Core>
void sph_check(const Core& core, const SphRow& r) {
  const double share = r.density / core.liquid.density;
  if (is_finite(r.position()) && is_finite(r.velocity()) && share >= core.least_density &&
      share <= core.most_density)
    return;
  throw SimulationError(sph_what_is_wrong(core, r), core.steps, {}, r.position());
}
/// Warnings of Sph::warnings().
template <class Core>
[[gnu::cold]] DynArray<std::string> sph_warnings(const Core& core) {
  constexpr double share = 0.05;  // [-] splashes lose less
  DynArray<std::string> out;
  const std::size_t ever = core.next_number - core.displaced;
  const auto all = static_cast<double>(ever), left = static_cast<double>(core.left);
  const Box& region = core.setup.region;
  if (left > share * all)
    out.push_back(
        sentence("the liquid: ", core.left, " of ", ever, " particles (", 100 * left / all,
                 " %) have left SphSetup.region, from ", region.min, " to ", region.max,
                 " m, and are lost; close the walls (their normals point to the liquid) or enlarge "
                 "the region; where liquid should leave, put an outlet (Sph::add_outlet)"));
  const double g = norm(core.gravity);
  if (g > 9.7 && g < 9.9 && core.liquid.density < 50)  // in SI, at Earth's gravity
    out.push_back(sentence("the liquid: Liquid.density = ", core.liquid.density,
                           " kg/m3 is that of a gas; water has 1000: a density in g/cm3 is a "
                           "thousandth of that in kg/m3"));
  if (core.disc.mass > 0)
    out.push_back(sentence(
        "the liquid: in 2D a sphere displaces what a disc does that is 1 m long, but has the mass "
        "of a sphere: one of radius ",
        core.disc.radius, " m has ", core.disc.mass, " kg, a disc of its density ",
        core.disc.of_disc, " kg; use Polyhedron or MultiSphere bodies 1 m long, or a density of ",
        "3/(4 radius [m]) times that of the disc"));
  // Four a direction, the thinnest layer that the kernel resolves.
  const int few = core.setup.dimensions == 2 ? 16 : 64;
  if (all > 0 && all < few)
    out.push_back(sentence("the liquid: it has ", core.next_number, " particles at a spacing of ",
                           core.setup.spacing, " m, and its flow is not resolved; a drop needs ",
                           few, ", four across: use a smaller SphSetup.spacing"));
  if (core.setup.dimensions == 2 && core.setup.smoothing_used() < 1.1)
    out.push_back(sentence("the liquid: SphSetup.smoothing = ", core.setup.smoothing,
                           " leaves too few neighbours in 2D; take 1.1 or more, or leave it out"));
  const double sound = core.setup.courant * core.setup.h() / core.liquid.sound_speed;
  if (const double viscous = core.viscous_step(); viscous < 0.1 * sound)
    out.push_back(sentence("the liquid: its viscosity allows steps of ", viscous, " s, ",
                           std::round(sound / viscous), " times shorter than sound does, ",
                           std::round(1 / viscous),
                           " for each second; lower the largest "
                           "viscosity, or take a larger SphSetup.spacing"));
  return out;
}
/// Whether a point is outside the region.
template <class Core>
bool sph_is_out(const Core& core, const Vec3d& x) {
  // Particles pressed slightly into walls at its sides are not outside.
  const Box b = core.setup.region.grown(core.setup.spacing);
  return x.x < b.min.x || x.x > b.max.x || x.z < b.min.z || x.z > b.max.z ||
         (core.setup.dimensions == 3 && (x.y < b.min.y || x.y > b.max.y));
}
/// @}

}  // namespace silt::detail
