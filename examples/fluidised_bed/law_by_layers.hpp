// silt - BSD-3-Clause, see LICENSE
#pragma once

// What the drag law says of the bed: its pressure drop at the bed's voidage, and by layers, in the
// voidage and the flow that the cells and the kernel of the simulation make of the grains. With it
// the minimum fluidisation velocity, as measured and by the law.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <silt/eigen.hpp>

#include "fluidised_bed/measure.hpp"

namespace fluidised {

/// Mean drag of bodies with the orientations of about a hundred of a bed, in an upward flow.
struct AsTheyLie {
  std::vector<silt::NonSpherical<silt::HoelzerSommerfeld>> grains;

  template <class Real>
  Real normalised(const Real& eps, const Real& Re) const {
    Real sum(0);
    for (const auto& grain : grains) sum = sum + grain.normalised(eps, Re);
    return sum / Real(static_cast<float>(grains.size()));
  }
};
/// The law that the bed should follow.
template <class Sim>
auto law_of(const Sim& sim, const Scene& s) {
  if constexpr (Sim::of_bodies) {
    AsTheyLie law;
    const std::size_t every = std::max<std::size_t>(sim.rows() / 4000, 1);
    for (std::size_t k = 0; k < sim.rows(); k += every) {
      const Vec3d up = rotate(conjugate(sim.orientation(k)), {0, 0, 1});
      law.grains.push_back({{}, silt::shape_in_flow(sim.forms()[sim.form(k)].shape, up)});
    }
    return law;
  } else {
    return s.drag == "gidaspow" ? BedDrag{BedDrag::Law::Ergun} : s.drag_law();
  }
}

/// Upward reach of silt::Kernel from a grain [m], averaged over the grains.
template <class Sim>
double reach_of(const Sim& sim, const Scene& s) {
  if constexpr (Sim::of_bodies) {
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      const auto& grain = sim.forms()[sim.form(k)].shape;
      const Vec3d up = rotate(conjugate(sim.orientation(k)), {0, 0, 1});
      const double r = std::cbrt(grain.a * grain.b * grain.c);  // forms are of any size
      const Vec3d extent{grain.a / r * up.x, grain.b / r * up.y, grain.c / r * up.z};
      const double least = std::min({grain.a, grain.b, grain.c}) / r;
      sum += std::max(s.kernel * s.diameter, 1.5 * s.cell / least) * norm(extent);
    }
    return sum / static_cast<double>(sim.rows());
  } else {
    return std::max(s.kernel * s.diameter, 1.5 * s.cell);
  }
}

/// Pressure drop [Pa] of a bed at rest by the law, in one dimension: grains at their heights, each
/// with the void fraction and velocity that kernel and cells produce. Variations within a layer,
/// also at walls, are not included.
///   R: of the kernel [m]
template <class Shape, class DragLaw>
double drop_by_layers(const DragLaw& law, const Scene& s, double R, const Profile& centres,
                      double U) {
  const double h = s.cell, bin = s.diameter / per_diameter;
  const int n = s.high;
  const auto at = [](auto& row, int i) -> auto& { return row[static_cast<std::size_t>(i)]; };
  const auto quartic = [](double x) {  // its integral
    const double t = std::clamp(x, -1.0, 1.0);
    return t - 2 * t * t * t / 3 + t * t * t * t * t / 5;
  };
  std::vector<std::vector<double>> shares;  // of each bin in the cells, folded at the floor
  for (std::size_t k = 0; k < centres.size(); ++k) {
    auto& w = shares.emplace_back(static_cast<std::size_t>(n));
    const double z = (static_cast<double>(k) + 0.5) * bin;
    double sum = 0;
    for (int c = -static_cast<int>(R / h) - 1; c < n; ++c) {
      double share;
      if constexpr (silt::BodyShape<Shape>) {  // at the cells' centres, all columns of cells
        const double x = ((c + 0.5) * h - z) / R;
        share = std::pow(std::max(1 - x * x, 0.0), 3);
      } else {
        share = quartic(((c + 1) * h - z) / R) - quartic((c * h - z) / R);
      }
      at(w, c < 0 ? -1 - c : c) += share, sum += share;
    }
    for (double& share : w) share /= sum;
  }
  const auto spread = [&](const auto& value) {  // of grains of a bin, over the volume of a cell
    std::vector<double> cells(static_cast<std::size_t>(n));
    for (std::size_t k = 0; k < centres.size(); ++k)
      for (int c = 0; c < n; ++c)
        at(cells, c) += shares[k][static_cast<std::size_t>(c)] * value(k) * centres[k] * bin / h;
    return cells;
  };
  const auto solids = spread([](std::size_t) { return 1.0; });
  const auto voidage = [&](int c) { return 1 - (c < n ? at(solids, c) : 0); };
  const auto on_face = [&](int f) { return 0.5 * (voidage(std::max(f - 1, 0)) + voidage(f)); };
  const auto resistance = spread([&](std::size_t k) {  // [kg/(m3 s)] of a grain's volume
    double e = 0, slip = 0;
    for (int c = 0; c < n; ++c) {
      const double w = shares[k][static_cast<std::size_t>(c)];
      e += w * voidage(c), slip += w * 0.5 * U * (1 / on_face(c) + 1 / on_face(c + 1));
    }
    const double Re = silt::slip_reynolds(e, s.gas.density, slip, s.diameter, s.gas.viscosity);
    return centres[k] > 0
               ? 18 * s.gas.viscosity / (s.diameter * s.diameter) * e * law.normalised(e, Re)
               : 0;
  });
  double drop = 0;
  for (int f = 0; f < n; ++f) {  // across faces; on the floor half of one
    const double below = f > 0 ? at(resistance, f - 1) : 0;
    drop += h * 0.5 * (below + at(resistance, f)) * U / std::pow(on_face(f), 2);
  }
  return drop;
}

/// Velocity U at which p = a U + b U^2, fitted to points (least squares), equals `level`.
inline double crossing(const std::vector<std::array<double, 2>>& points, double level) {
  Eigen::MatrixXd u(static_cast<Eigen::Index>(points.size()), 2);
  Eigen::VectorXd p(u.rows());
  for (Eigen::Index k = 0; k < u.rows(); ++k) {
    const auto& [speed, drop] = points[static_cast<std::size_t>(k)];
    u.row(k) << speed, speed * speed;
    p[k] = drop;
  }
  const Eigen::VectorXd value = silt::fit_linear(u, p).value;
  const double a = value[0], b = value[1];
  return 2 * level / (a + std::sqrt(a * a + 4 * b * level));
}

/// Minimum fluidisation, where the pressure drop of the bed at rest, as the gas falls, reaches the
/// bed's weight; and the law's pressure drops at all velocities.
struct Fluidisation {
  double measured = 0, by_voidage = 0, by_layers = 0;  // [m/s]
  double height = 0,
         voidage = 0;  // [m], [-] of the loose bed, in the fastest gas that leaves it at rest
  double error = 0;    // [-] of the law by layers, the largest at rest
  std::vector<std::array<double, 2>>
      drops;  // [Pa] by voidage, by layers; no numbers where the bed has long left
};

template <class Shape, class Sim>
Fluidisation find_fluidisation(const Scene& s, const Sim& sim, const Bed<Sim>& bed,
                               const Curve& curve) {
  Fluidisation f;
  // At the highest velocity that leaves the bed at rest: the bed still compacts as the velocity
  // falls.
  const Means& loose = curve.falling[curve.packed - 1];
  f.height = loose.height, f.voidage = bed.voidage(f.height);
  const auto law = law_of(sim, s);
  const double reach = reach_of(sim, s);
  std::vector<std::array<double, 2>> seen, by_voidage, by_layers;  // [m/s], [Pa] of the bed at rest
  for (std::size_t k = 0; k < curve.velocities.size(); ++k) {
    const double U = curve.velocities[k];
    const bool at_rest = k < curve.packed;
    const Means& then = at_rest ? curve.falling[k] : loose;
    double drop =
        then.height * silt::bed_pressure_gradient(law, bed.voidage(then.height), s.diameter,
                                                  s.gas.density, s.gas.viscosity, U);
    double layered = drop_by_layers<Shape>(law, s, reach, then.centres, U);
    if (at_rest) {
      seen.push_back({U, then.pressure_drop});
      by_voidage.push_back({U, drop}), by_layers.push_back({U, layered});
      f.error = std::max(f.error, std::abs(then.pressure_drop / layered - 1));
    }
    if (layered > 1.1 * s.weight()) drop = layered = std::nan("");
    f.drops.push_back({drop, layered});
  }
  // As measured: the bed's void fraction differs between velocities; there is no single value.
  f.measured = crossing(seen, s.weight());
  f.by_voidage = crossing(by_voidage, s.weight());
  f.by_layers = crossing(by_layers, s.weight());
  return f;
}

}  // namespace fluidised
