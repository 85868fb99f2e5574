// silt - BSD-3-Clause, see LICENSE
#pragma once

// Part of CoupledFlow used only by a Simulation: FluidCoupling.

#include <silt/core/dyn_array.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/odd_fluid.hpp>

namespace silt::inline SILT_TARGET {

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::prepare(const FluidScene& scene) const {
  detail::check_steps("CoupledFlow", steps, most_steps);
  const Grid& g = flow_.grid();
  const Vec3d low = g.box().min, extent = g.box().extent(), corner = scene.box.min,
              repeats = scene.box.extent();
  const double from[3] = {low.x, low.y, low.z}, length[3] = {extent.x, extent.y, extent.z};
  const double begins[3] = {corner.x, corner.y, corner.z};
  const double after[3] = {repeats.x, repeats.y, repeats.z};
  for (int d = 0; d < 3; ++d)
    require(!scene.periodic[static_cast<std::size_t>(d)] ||
                (g.periodic(d) && std::abs(length[d] - after[d]) < 1e-9 * length[d] &&
                 std::abs(from[d] - begins[d]) < 1e-9 * length[d]),
            "the PeriodicBox repeats in ", "xyz"[d], " from ", begins[d], " m on, after ", after[d],
            " m, but the flow's grid from ", from[d], " m on has ", length[d], " m and is ",
            g.periodic(d) ? "" : "not ", "periodic there; give both the same");
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
int BasicCoupledFlow<Flow, Drag, Mode, Forces...>::steps_wanted(const FluidPace& pace,
                                                                const Team& team) const {
  if (steps) return *steps;
  if (clock.steps == 0) return 1;
  double longest = longest_step(pace.speed, team);
  if constexpr (!follows) longest = detail::longest_held_step(held_answer(), clock, longest, pace);
  return detail::steps_in(longest, pace, most_steps);
}

/// Longest fluid step [s] for particles of that speed [m/s]; see `steps`.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
double BasicCoupledFlow<Flow, Drag, Mode, Forces...>::longest_step(double speed,
                                                                   const Team& team) const {
  const Vec3d h = flow_.grid().h();
  const double stable = flow_.stable_step(team), least = std::min({h.x, h.y, h.z});
  return speed > 0 ? std::min(stable, 0.2 * least / speed) : stable;
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
Vec3d BasicCoupledFlow<Flow, Drag, Mode, Forces...>::at_the_side(const Vec3d& centre,
                                                                 double radius) const {
  const Grid& g = flow_.grid();
  const auto inside = [&](double x, double low, double high, int d) {
    if (g.periodic(d) || x < low - radius || x > high + radius) return x;
    const double margin = 1e-9 * (high - low);
    return std::clamp(x, low + margin, high - margin);
  };
  const Vec3d &a = g.box().min, &b = g.box().max;
  return {inside(centre.x, a.x, b.x, 0), inside(centre.y, a.y, b.y, 1),
          inside(centre.z, a.z, b.z, 2)};
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
bool BasicCoupledFlow<Flow, Drag, Mode, Forces...>::reaches(const Vec3d& x) const {
  const Grid& g = flow_.grid();
  const Vec3d &a = g.box().min, &b = g.box().max;
  const auto within = [&](double v, double low, double high, int d) {
    return g.periodic(d) || (v >= low && v <= high);
  };
  return within(x.x, a.x, b.x, 0) && within(x.y, a.y, b.y, 1) && within(x.z, a.z, b.z, 2);
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
template <class Visit>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::for_each_state(const Visit& visit) {
  flow_.for_each_state(visit);
  Vec3d& lost = exchange_.lost;
  std::array<double, 8> all{clock.time,      static_cast<double>(clock.steps),
                            clock.last_step, diameter.value_or(0),
                            lost.x,          lost.y,
                            lost.z,          held_answer().in_contact};
  visit("fluid.clock", std::span<double>(all));
  clock = {all[0], static_cast<std::int64_t>(all[1]), all[2]};
  if (all[3] > 0) diameter = all[3];
  lost = {all[4], all[5], all[6]}, exchange_.restore_held(all[7]), following_ = false;
  visit("fluid.left", left_);
  exchange_.for_each_state(visit);
}

/// Counts particles whose centres are in walls of the flow: mostly a boundary from the wrong side.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::look_for_walls(const CoupledParticles& of) {
  if constexpr (requires { flow_.wall_distance(Vec3d{}); })
    if (flow_.open_cells() != nullptr)
      for (const Vec3d& x : of.shape.position)
        if (const double d = flow_.wall_distance(x); reaches(x) && d < 0) {
          if (in_walls_.count++ == 0) in_walls_.all = of.shape.position.size();
          if (d < in_walls_.distance) in_walls_.distance = d, in_walls_.place = x;
        }
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
DynArray<std::string> BasicCoupledFlow<Flow, Drag, Mode, Forces...>::warnings() const {
  DynArray<std::string> out;
  // With another gravity than the earth's, units may be reduced.
  if (const double g = norm(gravity); g > 9.7 && g < 9.9) {
    out = detail::odd_fluid(flow_.fluid());
    const Vec3d e = flow_.grid().box().extent();
    const auto& n = flow_.grid().cells();
    detail::odd_flow(flow_.fluid(), fastest({}).velocity,
                     std::min({e.x / n[0], e.y / n[1], e.z / n[2]}), diameter.value_or(0), out);
    if constexpr (has_heat)
      if (flow_.has_heat()) detail::odd_heat(flow_.heat(), out);
  }
  if (const auto& in = in_walls_; in.count > 0)
    out.push_back(text(in.count, " of ", in.all, " particles start with their centres in walls of ",
                       "the flow, the deepest at ", in.place, " m, ", -in.distance,
                       " m behind the surface, where no fluid flows; check the Side given to "
                       "boundary_of, or move the particles"));
  for (const int percent : {50, 25, 10, 5})
    if (100 * closure_.clipped > percent) {
      out.push_back(
          text("more than ", percent,
               " % of the particles' volume found no place in the "
               "cells of the flow in one step, as these kept ",
               100 * least_voidage,
               " % of fluid (CoupledFlow.least_voidage): the fluid "
               "sees less solid volume than there is; use wider weights or larger cells, or "
               "particles that the flow's grid can hold"));
      break;
    }
  return out;
}

/// Checks restored values, part by part; they are known to be finite.
template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::check_state(
    const std::string& name, std::span<const double> values) const {
  const auto not_negative = [&](std::size_t k) {
    require(values[k] >= 0, name, "[", k, "] = ", values[k], " must be finite and not negative");
  };
  if (name == "fluid.clock")
    for (const std::size_t k : {3, 7}) not_negative(k);
  if (name == "fluid.left") {
    require(values.size() % of_left == 0, name, " has ", values.size(), " numbers, which must be ",
            of_left, " a particle");
    for (std::size_t k = 0; k < values.size(); k += of_left) {
      for (const std::size_t n : {3, 4})
        require(values[k + n] > 0, name, "[", k + n, "] = ", values[k + n], " must be above 0");
      require(values[k + 9] >= 0 && values[k + 9] < 4294967296.0 &&
                  values[k + 9] == std::floor(values[k + 9]),
              name, "[", k + 9, "] = ", values[k + 9], " must be the number of a form");
    }
  }
  if (name == "fluid.last" && values.size() == 4) {
    for (const std::size_t k : {0, 2, 3})
      require(values[k] == 0 || values[k] == 1, name, "[", k, "] = ", values[k], " must be 0 or 1");
    not_negative(1);
  }
  if (name == "fluid.eddy" || name.starts_with("fluid.k_epsilon"))
    for (std::size_t k = 0; k < values.size(); ++k) not_negative(k);
  // Ghosts are extrapolated; the last field is the carried one, which may exceed 1.
  if (!name.starts_with("fluid.voidage") || name == "fluid.voidage4") return;
  const Grid& g = flow_.grid();
  for (int k = 0; k < g.nz(); ++k)
    for (int j = 0; j < g.ny(); ++j)
      for (int i = 0; i < g.nx(); ++i) {
        const double eps = values[g.index(i, j, k)];
        require(eps > 0 && eps <= 1 + 1e-9, name, " of cell (", i, ", ", j, ", ", k, ") is ", eps,
                " and must be above 0 and at most 1");
      }
}

template <FlowOnGrid Flow, class Drag, class Mode, class... Forces>
template <class Describer>
void BasicCoupledFlow<Flow, Drag, Mode, Forces...>::describe(const Describer& is) const {
  const Grid& g = flow_.grid();
  const auto grid = is.of("grid ");
  grid("from", g.box().min), grid("to", g.box().max);
  is("density [kg/m3]", flow_.fluid().density), is("viscosity [Pa s]", flow_.fluid().viscosity);
  is("momentum model", static_cast<int>(flow_.options().model));
  for (int d = 0; d < 3; ++d) {
    const auto along = is.of(text("xyz"[d], ": "));
    along("cells", g.cells()[static_cast<std::size_t>(d)]);
    along("periodic", g.periodic(d) ? "yes" : "no");
    for (const int end : {0, 1})
      along(end == 0 ? "lower side" : "upper side",
            flow_.holds_pressure(d, end) ? "open" : "closed");
  }
  if constexpr (has_heat)
    if (flow_.has_heat()) is("heat capacity of the fluid [J/(kg K)]", flow_.heat().heat_capacity);
  if constexpr (requires { flow_.turbulence_model(); })
    is("turbulence model", flow_.turbulence_model());
  is("walls within the box", flow_.open_cells() != nullptr ? "yes" : "no");
  if (const auto* open = flow_.open_cells()) {
    double sum = 0;
    for (int k = 0; k < g.nz(); ++k)
      for (int j = 0; j < g.ny(); ++j)
        for (int i = 0; i < g.nx(); ++i) sum += (1 + i + 1.7 * j + 2.3 * k) * (*open)(i, j, k);
    is("checksum of the open cells", sum);
  }
}

}  // namespace silt
