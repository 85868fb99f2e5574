// silt - BSD-3-Clause, see LICENSE
//
// A fluidised bed: grains of 1 mm on a floor that gas passes, in a thin slice that is periodic
// across. The gas is stepped through the minimum fluidisation velocity, up and down, which gives
// the pressure drop over the velocity; then it is blown at twice that and more, until bubbles rise.
// The minimum fluidisation velocity is measured where the bed's pressure drop, as it falls with the
// velocity, leaves the bed's weight, and compared with Ergun's equation: at the bed's voidage, and
// summed over the bed's layers, in the voidage and the flow that cells and kernel make of them.
// Ellipsoids have the drag and the lift of how they lie in the flow, and are compared with that law
// for the grains as they lie in the bed.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <silt/boundary/domain.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/coupling/drag/oriented.hpp>
#include <silt/coupling/formulas.hpp>
#include <silt/shape/super_ellipsoid.hpp>
#include <silt/silt.hpp>

#include "support/example.hpp"

namespace {

using Law = silt::HertzMindlin;
using silt::Vec3d;

struct Scene {
  std::size_t particles = 10000;
  double diameter = 1e-3;     // [m] of the sphere of a grain's volume
  double density = 2500;      // [kg/m3]
  double cell = 2e-3;         // [m]
  int across = 20, deep = 3;  // [cells] of the slice
  int high = 60;              // [cells] of the box, above the floor
  double modulus = 1e6;       // [Pa] soft, for a long time step
  double bubbling = 2.0;      // [-] times the minimum fluidisation velocity
  double settling = 0.15;     // [s]
  double relaxing = 0.05;     // [s] after a step of the gas's velocity,
  double averaging = 0.05;    // [s] and then means are taken
  double blowing = 1.0;       // [s] the bubbling bed; its first quarter is not measured
  double step = 0.1;          // [m/s] of the gas's velocity
  double at_rest = 5e-3;      // [m/s] mean speed of the grains in a bed that is not fluidised
  std::string shape = "sphere";
  silt::FluidProperties gas{.density = 1.2, .viscosity = 1.8e-5};

  double width() const { return across * cell; }                        // [m]
  double depth() const { return deep * cell; }                          // [m]
  double area() const { return width() * depth(); }                     // [m2]
  double volume() const { return silt::Sphere::volume(diameter / 2); }  // [m3] of a grain
  /// Of all grains, less buoyancy, over the area [Pa]: what the gas bears when it bears them all.
  double weight() const {
    return static_cast<double>(particles) * volume() * (density - gas.density) * 9.81 / area();
  }
  template <class DragLaw>  // [m/s] of minimum fluidisation
  double velocity_by(const DragLaw& law, double voidage) const {
    return silt::minimum_fluidisation_velocity(law, voidage, diameter, density, gas.density,
                                               gas.viscosity);
  }
  Law::Material material() const {
    return {.youngs_modulus = modulus, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
  }
};

/// Spheres: Ergun's equation in beds, Wen and Yu's where grains are few. Bodies: the law of Hoelzer
/// and Sommerfeld by their silhouettes, with Di Felice's voidage function.
template <class Shape>
auto make_fluid(silt::FlowSolver flow) {
  if constexpr (silt::BodyShape<Shape>)
    return silt::CoupledFlow{silt::OrientedDrag<>{}, silt::Kernel{}, std::move(flow),
                             silt::InclinedLift<>{}};
  else
    return silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, std::move(flow)};
}

/// The mean drag of bodies that lie as some hundred of a bed do, in a flow upwards.
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
auto law_of(const Sim& sim) {
  if constexpr (Sim::has_bodies) {
    AsTheyLie law;
    const std::size_t every = std::max<std::size_t>(sim.rows() / 4000, 1);
    for (std::size_t k = 0; k < sim.rows(); k += every) {
      const Vec3d up = rotate(conjugate(sim.orientation(k)), {0, 0, 1});
      law.grains.push_back({{}, silt::shape_in_flow(sim.forms()[sim.form(k)].shape, up)});
    }
    return law;
  } else {
    return silt::Ergun{};
  }
}

/// How far silt::Kernel reaches up from a grain [m], mean over the grains as they lie.
template <class Sim>
double reach_of(const Sim& sim, const Scene& s) {
  if constexpr (Sim::has_bodies) {
    double sum = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      const auto& grain = sim.forms()[sim.form(k)].shape;
      const Vec3d up = rotate(conjugate(sim.orientation(k)), {0, 0, 1});
      const double r = std::cbrt(grain.a * grain.b * grain.c);  // forms are of any size
      const Vec3d extent{grain.a / r * up.x, grain.b / r * up.y, grain.c / r * up.z};
      const double least = std::min({grain.a, grain.b, grain.c}) / r;
      sum += std::max(3 * s.diameter, 1.5 * s.cell / least) * norm(extent);
    }
    return sum / static_cast<double>(sim.rows());
  } else {
    return std::max(3 * s.diameter, 1.5 * s.cell);
  }
}

constexpr int per_diameter = 10;  // bins of a Profile

/// Grains' volume over that of the bins, by the heights of their centres [-].
using Profile = std::vector<double>;

/// Pressure drop [Pa] of a bed at rest by the law, in one dimension: grains at their heights, each
/// in the voidage and the flow that the kernel, the cells and the floor, through which the gas
/// comes with its superficial velocity, make of all. What layers lack of evenness it does not know.
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
  const auto on_face = [&](int f) { return f == 0 ? 1 : 0.5 * (voidage(f - 1) + voidage(f)); };
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
  const auto fall = [&](int f) {  // [Pa] of the pressure, across a face
    return h * 0.5 * (at(resistance, f - 1) + at(resistance, f)) * U / std::pow(on_face(f), 2);
  };
  double drop = 0.5 * fall(1);  // from the floor, to which the pressure is extrapolated
  for (int f = 1; f < n; ++f) drop += fall(f);
  return drop;
}

/// Grains on a lattice above the floor.
template <class Shape>
silt::Particles<Shape> fill(const Scene& s) {
  silt::Particles<Shape> grains;
  double reach = s.diameter / 2;  // [m] bounding radius
  if constexpr (silt::BodyShape<Shape>) {
    grains.add_form(Shape{.a = 1.5, .b = 1, .c = 1});
    const auto& form = grains.forms()[0];
    reach = form.radius * s.diameter / 2 * std::cbrt(silt::Sphere::volume(1) / form.mass.volume);
  }
  silt::Random random(1);
  const double pitch = 2.05 * reach;
  const int nx = static_cast<int>(s.width() / pitch), ny = static_cast<int>(s.depth() / pitch);
  for (int n = 0; n < static_cast<int>(s.particles); ++n) {
    typename silt::Particles<Shape>::Particle p{};
    p.position = {(n % nx + 0.5) * s.width() / nx, (n / nx % ny + 0.5) * s.depth() / ny,
                  (n / (nx * ny) + 0.5) * pitch};
    p.radius = reach, p.density = s.density;
    p.velocity = {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0};
    if constexpr (silt::BodyShape<Shape>) p.orientation = silt::random_orientation(random);
    grains.add(p);
  }
  return grains;
}

template <class Shape>
auto make_simulation(const Scene& s) {
  const Vec3d corner{s.width(), s.depth(), s.high * s.cell};
  silt::FlowSolver flow(
      silt::Grid({{0, 0, 0}, corner}, {s.across, s.deep, s.high}, {true, true, false}), s.gas);
  flow.set_side(2, 0, silt::Inflow{});
  flow.set_side(2, 1, silt::Outflow{});
  silt::Simulation sim{fill<Shape>(s), silt::Contacts<Law>{s.material()},
                       silt::PeriodicBox{{{0, 0, 0}, corner}, {true, true, false}},
                       make_fluid<Shape>(std::move(flow))};
  if (silt::BodyShape<Shape>) sim.fluid().least_voidage = 0.2;  // they lie denser than spheres
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.material());
  return sim;
}

template <class Sim>
class Bed {
 public:
  struct Means {
    double pressure_drop, floor, momentum;  // [Pa] over the area: of the gas, on the floor, gained
    double height;                          // [m]
    double speed;                           // [m/s] of the grains
    Profile centres;                        // at the end
    /// What gas and floor bear, less the weight and what the bed gains, over the weight [-].
    double unbalanced(double weight) const {
      return (pressure_drop + floor - momentum) / weight - 1;
    }
  };

  Bed(const Scene& s, Sim& sim) : s_(s), sim_(sim) {}

  /// Brings the gas to the superficial velocity U [m/s] in 10 ms, then waits for the rest of
  /// `span` [s].
  template <class... Observers>
  void blow(double U, double span, Observers&&... observers) {
    const double from = U_;
    for (int k = 1; k <= 10; ++k) {
      U_ = from + (U - from) * k / 10;
      sim_.fluid().flow().set_side(2, 0, silt::Inflow{{0, 0, U_}});
      sim_.run(1e-3, observers...);
    }
    if (span > 0.01) sim_.run(span - 0.01, observers...);
  }
  template <class... Observers>
  Means measure(double span, Observers&&... observers) {
    Means sum{};
    double n = 0;
    const double before = momentum(), start = sim_.time();
    const double given = sim_.wall(0).impulse.z;  // [N s] to the floor, also by short impacts
    sim_.run(span,
             silt::at(silt::every(2e-4),
                      [&](const auto&) {
                        sum.pressure_drop += pressure_drop();
                        sum.height += height(), sum.speed += speed();
                        n += 1;
                      }),
             observers...);
    const double per_area = 1 / ((sim_.time() - start) * s_.area());
    sum.floor = -(sim_.wall(0).impulse.z - given) * per_area;
    const double gained = (momentum() - before) * per_area;
    return {sum.pressure_drop / n, sum.floor, gained, sum.height / n, sum.speed / n, centres()};
  }

  /// Of the gas between the floor, to which it is extrapolated, and its outlet [Pa].
  double pressure_drop() const {
    const auto& p = sim_.fluid().flow().pressure();
    double sum = 0;
    for (int j = 0; j < s_.deep; ++j)
      for (int i = 0; i < s_.across; ++i) sum += 1.5 * p(i, j, 0) - 0.5 * p(i, j, 1);
    return sum / (s_.across * s_.deep);
  }
  /// Twice that of the grains' centre of mass above the floor [m].
  double height() const {
    double sum = 0;
    for (std::size_t k = 0; k < sim_.rows(); ++k) sum += sim_.position(k).z;
    return 2 * sum / static_cast<double>(sim_.rows());
  }
  Profile centres() const {
    const double h = s_.diameter / per_diameter, grain = s_.volume() / (s_.area() * h);
    Profile all;
    for (std::size_t k = 0; k < sim_.rows(); ++k) {
      const double z = std::max(sim_.position(k).z / h - 0.5, 0.0);
      const auto low = static_cast<std::size_t>(z);
      if (low + 1 >= all.size()) all.resize(low + 2);
      const double upper = z - static_cast<double>(low);
      all[low] += (1 - upper) * grain, all[low + 1] += upper * grain;
    }
    return all;
  }
  double speed() const {  // [m/s] mean of the grains
    double sum = 0;
    for (std::size_t k = 0; k < sim_.rows(); ++k) sum += norm(sim_.velocity(k));
    return sum / static_cast<double>(sim_.rows());
  }
  double voidage(double height) const {
    return 1 - static_cast<double>(s_.particles) * s_.volume() / (s_.area() * height);
  }
  /// The voidage of cells, mean over the depth, as a table.
  void write_voidage(const std::string& path) const {
    const auto& eps = sim_.fluid().flow().voidage();
    silt::CsvTable table(path, {"x [m]", "z [m]", "voidage [-]"});
    for (int k = 0; k < s_.high; ++k)
      for (int i = 0; i < s_.across; ++i) {
        double mean = 0;
        for (int j = 0; j < s_.deep; ++j) mean += eps(i, j, k) / s_.deep;
        table.add_row({(i + 0.5) * s_.cell, (k + 0.5) * s_.cell, mean});
      }
  }

 private:
  double momentum() const {  // [kg m/s] upwards
    double sum = 0;
    for (std::size_t k = 0; k < sim_.rows(); ++k) sum += sim_.mass(k) * sim_.velocity(k).z;
    return sum;
  }

  const Scene& s_;
  Sim& sim_;
  double U_ = 0;  // [m/s]
};

/// Where p = a U + b U^2 through points (least squares) reaches `level`.
double crossing(const std::vector<std::array<double, 2>>& points, double level) {
  double uu = 0, uuu = 0, u4 = 0, up = 0, uup = 0;
  for (const auto& [u, p] : points)
    uu += u * u, uuu += u * u * u, u4 += u * u * u * u, up += u * p, uup += u * u * p;
  const double det = uu * u4 - uuu * uuu;
  const double a = (up * u4 - uup * uuu) / det, b = (uu * uup - uuu * up) / det;
  return 2 * level / (a + std::sqrt(a * a + 4 * b * level));
}

template <class Sim>
void write_picture(const std::string& path, const Sim& sim) {
  if constexpr (Sim::has_surfaces)
    silt::write_surfaces(path, sim);
  else
    silt::write_particles(path, sim);
}

template <class Shape>
int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch watch;
  auto sim = make_simulation<Shape>(s);
  sim.threads = options.threads;
  silt::make_folder(options.out);
  Bed bed(s, sim);

  std::printf("settling\n");
  sim.run(s.settling, silt::progress());
  const double filled = bed.height();
  const double guess = s.velocity_by(silt::Ergun{}, bed.voidage(filled));

  std::printf("gas up and down\n");
  using Means = typename decltype(bed)::Means;
  std::vector<double> velocities;
  while (velocities.empty() || velocities.back() < 1.3 * guess)
    velocities.push_back(s.step * static_cast<double>(velocities.size() + 1));
  std::vector<Means> rising, falling(velocities.size());
  double unbalanced = 0;
  const auto measure = [&](double U) {
    bed.blow(U, s.relaxing);
    const Means m = bed.measure(s.averaging);
    unbalanced = std::max(unbalanced, std::abs(m.unbalanced(s.weight())));
    std::printf("  %.3f m/s: %.1f Pa, height %.2f mm\n", U, m.pressure_drop, 1e3 * m.height);
    return m;
  };
  for (const double U : velocities) rising.push_back(measure(U));
  falling.back() = rising.back();
  for (std::size_t k = velocities.size() - 1; k-- > 0;) falling[k] = measure(velocities[k]);

  std::vector<std::array<double, 2>> packed;
  for (std::size_t k = 0; k < velocities.size(); ++k)
    if (falling[k].speed < s.at_rest) packed.push_back({velocities[k], falling[k].pressure_drop});
  silt::require(packed.size() >= 2, "only ", packed.size(),
                " velocities leave the bed at rest; take a smaller --step");
  // The bed still compacts as the gas falls: it is that of the fastest gas which leaves it at rest.
  const double loose = falling[packed.size() - 1].height, voidage = bed.voidage(loose);
  const auto law = law_of(sim);
  const std::string law_name = decltype(sim)::has_bodies ? "Drag law" : "Ergun";
  const double measured = crossing(packed, s.weight()), by_law = s.velocity_by(law, voidage);
  silt::CsvTable curve(options.out + "/pressure_drop.csv",
                       {"velocity [m/s]", "gas rising [Pa]", "gas falling [Pa]",
                        law_name + " at the bed's voidage [Pa]", law_name + " by layers [Pa]",
                        "height rising [m]", "height falling [m]"});
  double error = 0;                              // [-] of the bed at rest
  std::vector<std::array<double, 2>> by_layers;  // as `packed`
  const double reach = reach_of(sim, s);
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    const double U = velocities[k];
    const bool at_rest = k < packed.size();
    const Means& bed_then = falling[at_rest ? k : packed.size() - 1];
    double drop =
        bed_then.height * silt::bed_pressure_gradient(law, bed.voidage(bed_then.height), s.diameter,
                                                      s.gas.density, s.gas.viscosity, U);
    double layered = drop_by_layers<Shape>(law, s, reach, bed_then.centres, U);
    if (at_rest) {
      by_layers.push_back({U, layered});
      error = std::max(error, std::abs(falling[k].pressure_drop / layered - 1));
    }
    if (layered > 1.1 * s.weight()) drop = layered = std::nan("");  // the bed has long left
    curve.add_row({U, rising[k].pressure_drop, falling[k].pressure_drop, drop, layered,
                   rising[k].height, falling[k].height});
  }
  const double expected = crossing(by_layers, s.weight());

  std::printf("bubbling at %.2f m/s\n", s.bubbling * measured);
  auto series = silt::vtk_series(options.out + "/vtk", silt::every(0.02));
  std::vector<std::string> pictures, maps, titles;
  const auto snapshot = [&](const std::string& title) {
    const std::string name = options.out + "/bed_" + std::to_string(pictures.size());
    write_picture(name + ".vtp", sim), bed.write_voidage(name + ".csv");
    pictures.push_back(name + ".vtp"), maps.push_back(name + ".csv"), titles.push_back(title);
  };
  snapshot("at rest");
  const double begun = sim.time();
  bed.blow(s.bubbling * measured, 0.25 * s.blowing, series);
  Means bubbling{};
  for (int k = 0; k < 3; ++k) {
    const auto m = bed.measure(0.25 * s.blowing, series);
    bubbling.pressure_drop += m.pressure_drop / 3, bubbling.floor += m.floor / 3;
    bubbling.momentum += m.momentum / 3, bubbling.height += m.height / 3;
    char title[40];
    std::snprintf(title, sizeof title, "%.2f s", sim.time() - begun);
    snapshot(title);
  }

  example::Summary summary;
  summary.input("particles", static_cast<double>(s.particles));
  summary.input("shape", s.shape);
  summary.input("diameter_m", s.diameter);
  summary.input("density_kg_m3", s.density);
  summary.input("gas_density_kg_m3", s.gas.density);
  summary.input("gas_viscosity_pa_s", s.gas.viscosity);
  summary.input("width_m", s.width());
  summary.input("depth_m", s.depth());
  summary.input("cell_m", s.cell);
  summary.input("youngs_modulus_pa", s.material().youngs_modulus);
  summary.input("restitution", s.material().restitution);
  summary.input("friction", s.material().friction);
  summary.input("threads", static_cast<double>(options.threads));
  summary.result("weight_over_area_pa", s.weight());
  summary.result("voidage_as_filled", bed.voidage(filled));
  summary.result("voidage_of_the_loose_bed", voidage);
  summary.result("minimum_fluidisation_m_s", measured);
  summary.result("drag_law_at_this_voidage_m_s", by_law);
  summary.result("drag_law_by_layers_m_s", expected);
  summary.result("ergun_at_this_voidage_m_s", s.velocity_by(silt::Ergun{}, voidage));
  summary.result("ergun_at_voidage_0.4_m_s", s.velocity_by(silt::Ergun{}, 0.4));
  summary.result("bubbling_velocity_m_s", s.bubbling * measured);
  summary.result("bubbling_pressure_drop_pa", bubbling.pressure_drop);
  summary.result("bubbling_height_over_height_at_rest", bubbling.height / loose);
  summary.result("time_step_s", sim.step_length());
  summary.result("fluid_steps", static_cast<double>(sim.fluid().fluid_steps()));
  summary.result("steps", static_cast<double>(sim.step()));
  summary.result("wall_time_s", watch.seconds());
  const silt::FluidClosure& closure = sim.fluid().closure();
  // Sums of so many numbers, each rounded.
  const double rounding = std::numeric_limits<double>::epsilon() * static_cast<double>(s.particles);
  summary.check_at_most("volume_of_solids_off", closure.volume, rounding);
  summary.check_at_most("momentum_of_exchange_off", closure.momentum, rounding);
  summary.check_at_most("continuity_off", closure.continuity,
                        sim.fluid().flow().options().tolerance);
  // What gas and floor bear is weight and gain of momentum. The gas's part is read every 0.2 ms, and
  // extrapolated to the floor over half a cell, in which the bed bears less: 1.3 % of it.
  summary.check_at_most("balance_of_forces_over_weight",
                        std::max(unbalanced, std::abs(bubbling.unbalanced(s.weight()))), 0.02);
  // 0.01: layers are not even, and bodies' kernels are taken as one.
  summary.check_at_most("pressure_drop_at_rest_over_law_by_layers_less_1", error, 0.01);
  summary.check_within("minimum_fluidisation_m_s", measured, expected, 0.01 * expected,
                       law_name + " by the bed's layers, as the kernel blurs them");
  // The rest is borne by the floor when parts of the bed fall back on it; a stroke of the bed takes
  // some 0.2 s, and a mean over less than three of them is none.
  if (0.75 * s.blowing >= 0.6)
    summary.check_within("bubbling_pressure_drop_over_weight", bubbling.pressure_drop / s.weight(),
                         1, 0.08, "mean over a few strokes of the bed");
  summary.check_at_least("bubbling_height_over_height_at_rest", bubbling.height / loose, 1.1);
  summary.check_at_most("largest_overlap", sim.peak_overlap(), sim.guard.max_overlap);
  summary.write(options.out + "/summary.json");

  std::vector<std::string> grains{"spheres"}, gas{"cells"};
  grains.insert(grains.end(), pictures.begin(), pictures.end());
  const std::string bounds = silt::text("0,", s.width(), ",0,", s.high * s.cell);
  const std::string fast = silt::text("0,", std::round(5 * s.bubbling * measured) / 10);
  grains.insert(grains.end(), {"--colour", "velocity", "--range", fast, "--bounds", bounds});
  gas.insert(gas.end(), maps.begin(), maps.end());
  gas.insert(gas.end(), {"--value", "voidage", "--range", "0.35,1"});
  for (auto* picture : {&grains, &gas}) {
    picture->push_back("--title");
    picture->insert(picture->end(), titles.begin(), titles.end());
    picture->insert(picture->end(),
                    {"--out", options.out + (picture == &gas ? "/voidage.png" : "/bed.png")});
  }
  const bool drawn =
      example::draw(
          {"curves", options.out + "/pressure_drop.csv", "--x", "velocity", "--y",
           law_name + " at the bed's voidage," + law_name + " by layers,gas rising,gas falling",
           "--y-label", "pressure drop [Pa]", "--reference",
           silt::text("weight of the bed over its area:0,", s.weight()), "--title",
           silt::text("minimum fluidisation at ", std::round(1e3 * measured) / 1e3, " m/s"),
           "--out", options.out + "/pressure_drop.png"}) &&
      example::draw(grains) && example::draw(gas);
  std::printf(
      "\nMinimum fluidisation at %.3f m/s; by %s %.3f m/s of the bed's layers as the kernel blurs "
      "them, %.3f m/s at its voidage of %.3f; Ergun's at 0.4 %.3f m/s.\nAt %.2f m/s: %.3f of the "
      "weight borne by the gas, height %.2f "
      "times that "
      "at rest.\n",
      measured, decltype(sim)::has_bodies ? "the drag law" : "Ergun", expected, by_law, voidage,
      s.velocity_by(silt::Ergun{}, 0.4), s.bubbling * measured, bubbling.pressure_drop / s.weight(),
      bubbling.height / loose);
  summary.print_checks();
  const auto named = [&](const char* file) { return options.out + "/" + file; };
  std::printf("Look at: %s%s (ParaView), %s, %s; %.0f s\n",
              drawn ? (named("pressure_drop.png") + ", " + named("bed.png") + ", " +
                       named("voidage.png") + ", ")
                          .c_str()
                    : "",
              named("vtk").c_str(), named("pressure_drop.csv").c_str(),
              named("summary.json").c_str(), watch.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("A fluidised bed: pressure drop over gas velocity, then bubbles");
  Scene scene;
  command.leave_out("--restart");
  command.add("--particles", scene.particles, 1000, 100000, "How many");
  command.add("--shape", scene.shape, {"sphere", "ellipsoid"},
              "Spheres, or ellipsoids of their volume, half as long again as thick");
  command.add("--bubbling", scene.bubbling, 1.2, 5,
              "Gas velocity of the bubbling bed, in minimum fluidisation velocities");
  command.add("--step", scene.step, 0.02, 0.25, "Step of the gas velocity [m/s]");
  command.add("--blowing", scene.blowing, 0.1, 20, "How long the bed bubbles [s]");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--particles")) scene.particles = 1000;
      if (!command.given("--blowing")) scene.blowing = 0.3;
      if (!command.given("--step")) scene.step = scene.shape == "sphere" ? 0.15 : 0.1;
      scene.across = 4, scene.relaxing = 0.06, scene.averaging = 0.08;
      scene.high = 40;
    } else {
      scene.across = static_cast<int>(
          std::round(20 * std::sqrt(static_cast<double>(scene.particles) / 10000)));
      scene.high = 3 * scene.across;
    }
    return scene.shape == "sphere" ? simulate<silt::Sphere>(scene, command.options)
                                   : simulate<silt::SuperEllipsoid>(scene, command.options);
  });
}
