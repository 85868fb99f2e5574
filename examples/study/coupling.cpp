// silt - BSD-3-Clause, see LICENSE
//
// Range of cell sizes for each coupling mode: gas flow through a bed at rest, spheres at random
// positions, void fraction 0.55, periodic in all directions. The reference is the kernel in cells
// of a quarter of a diameter: compared are the drag of the bed at the same flow, which is also its
// pressure drop, the drag of each grain, and the void fraction at the grains.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <silt/fluid.hpp>

#include "study/studies.hpp"

namespace coupling_study {

namespace {

constexpr double d = 1e-3, solids = 0.45, speed = 0.5;  // [m], [-], [m/s] superficial
constexpr int across = 8;                               // [d] of the box

struct Bed {
  std::vector<silt::Vec3d> position;
  std::vector<double> radius, volume, mass;
  int height;  // [d]
};

/// Spheres after elastic collisions, until nothing is left of the initial lattice.
Bed random_bed(int height) {
  const double side = across * d, top = height * d, V = std::numbers::pi / 6 * d * d * d;
  const auto count = static_cast<std::size_t>(std::lround(solids * side * side * top / V));
  const int n = static_cast<int>(std::floor(side / (1.001 * d)));
  const int layers = static_cast<int>(count) / (n * n) + 1;
  silt::Particles<silt::Sphere> spheres;
  silt::Random random(3);
  const auto any = [&] { return random.uniform(-1, 1); };
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = static_cast<int>(k);
    spheres.add({.position = {(at % n + 0.5) * side / n, (at / n % n + 0.5) * side / n,
                              (at / (n * n) + 0.5) * top / layers},
                 .radius = 0.5 * d,
                 .density = 2500,
                 .velocity = {any(), any(), any()}});
  }
  using Law = silt::LinearSpring;
  silt::Simulation sim{std::move(spheres), silt::Contacts<Law>{Law::Material{2000, 1.0}},
                       silt::PeriodicBox{{{0, 0, 0}, {side, side, top}}, {true, true, true}}};
  sim.threads = 1;
  sim.guard.max_overlap = 1;
  sim.run(0.02);  // some 40 collisions each
  Bed bed{{}, {}, {}, {}, height};
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    bed.position.push_back(sim.domain().wrapped(sim.position(k)));
    bed.radius.push_back(0.5 * d), bed.volume.push_back(V), bed.mass.push_back(INFINITY);
  }
  return bed;
}

/// Gas driven through the bed by a force that is adjusted to the desired velocity, in cells of h
/// diameters; then 20 steps are timed. All sides are periodic: the driving force equals the bed's
/// drag.
template <class Mode>
silt::Study::Variant through(const Bed& bed, const Mode& mode, double h) {
  return [=](silt::StudyRun& run) {
    const int n = static_cast<int>(std::lround(across / h)),
              nz = static_cast<int>(std::lround(bed.height / h));
    silt::FlowSolver solver(silt::Grid({{0, 0, 0}, {across * d, across * d, bed.height * d}},
                                       {n, n, nz}, {true, true, true}),
                            {.density = 1.2, .viscosity = 1.8e-5});
    silt::CoupledFlow coupled{silt::Ergun{}, mode, std::move(solver)};
    silt::FlowSolver& flow = coupled.flow();
    flow.velocity(2).fill(speed / (1 - solids));
    const std::vector<silt::Vec3d> rest(bed.position.size(), {0, 0, 0});
    std::vector<silt::Vec3d> force(bed.position.size());
    const silt::CoupledParticles grains{{bed.position, bed.radius}, rest, bed.volume, bed.mass};
    // Drag stops the gas within 1 ms; between grains it is up to about four times faster.
    const double dt = std::min(1e-3, 0.5 * h * d / (4 * speed / (1 - solids)));
    const double area = across * across * d * d, box = area * bed.height * d;
    double gradient = 3000;  // [N/m3]
    double clipped = 0;
    const auto step = [&] {
      flow.force(2).fill(gradient);
      clipped = coupled.advance(grains, dt, force).clipped;
      // Towards the desired velocity, within some steps.
      gradient *= std::clamp(speed * area / flow.flow_rate(2, 0), 0.8, 1.25);
    };
    const int steps = std::max(25, static_cast<int>(std::lround(10e-3 / dt)));
    for (int s = 0; s < steps; ++s) step();
    run.time([&] {
      for (int s = 0; s < 20; ++s) step();
    });
    run.value("drag", gradient * box * 1e3, "mN");
    std::vector<double> each;
    for (const auto& f : force) each.push_back(f.z);
    run.value("drag of each", each);
    run.value("void fraction", coupled.voidage_at_particles());
    run.note("speed off", 100 * std::abs(flow.flow_rate(2, 0) / (speed * area) - 1), "%");
    run.note("clipped", 100 * clipped / (solids * box), "%");
  };
}

constexpr double sizes[] = {0.25, 0.5, 1, 2, 4, 8};  // [d]

struct Named {
  const char* name;
  silt::Study::Variant (*through)(const Bed&, double h);
};
template <class Mode, Mode mode>
silt::Study::Variant by(const Bed& bed, double h) {
  return through(bed, mode, h);
}
using Share = silt::Unresolved::Share;
const Named modes[] = {
    {"centre", by<silt::Unresolved, silt::Unresolved{.share = Share::Centre}>},
    {"satellites", by<silt::Unresolved, silt::Unresolved{.share = Share::Satellites}>},
    {"exact", by<silt::Unresolved, silt::Unresolved{.share = Share::Exact}>},
    {"two-grid", by<silt::TwoGrid, silt::TwoGrid{}>},
    {"kernel", by<silt::Kernel, silt::Kernel{}>},
    {"Gaussian", by<silt::Kernel, silt::Kernel{.form = silt::Kernel::Form::Gaussian}>},
    {"diffusion", by<silt::Diffusion, silt::Diffusion{}>}};

std::string name_of(const Named& mode, double h) { return silt::text(mode.name, ", ", h, " d"); }

/// One line per mode: the error of each grain's drag over the cell size.
void draw(const silt::Study& study, const std::string& out) {
  std::string table = "cells [diameters]", columns;
  for (const auto& mode : modes) {
    table += silt::text(",", mode.name, " [-]");
    columns += silt::text(columns.empty() ? "" : ",", mode.name);
  }
  const auto& rows = study.results().rows;
  bool any = false;
  for (const double h : sizes) {
    std::string line = silt::text("\n", h);
    bool complete = true;
    for (const auto& mode : modes) {
      const auto row = std::find_if(rows.begin(), rows.end(),
                                    [&](const auto& r) { return r.name == name_of(mode, h); });
      complete = complete && row != rows.end() && !row->failed();
      // The reference itself has no error and cannot be shown on a logarithmic axis.
      if (complete)
        line += silt::text(",", std::max(1e-4, row->error("error of drag of each")->value));
    }
    if (complete) table += line, any = true;
  }
  const std::string path = out + "/over_cells.csv";
  silt::detail::write_whole(path, table + "\n");
  if (any &&
      example::draw({"curves", path, "--x", "cells", "--y", columns, "--log", "xy", "--y-label",
                     "error of each grain's drag [-]", "--title",
                     "Drag on the grains of a bed at rest", "--out", out + "/over_cells.png"}))
    std::printf("Look at %s/over_cells.png.\n", out.c_str());
}

void run(const studies::Setting& setting, example::Summary& summary) {
  const Bed bed = random_bed(setting.quick ? 8 : 24);
  const double finest = setting.quick ? 0.5 : 0.25;
  summary.input("particles", static_cast<double>(bed.position.size()));
  silt::Study study(silt::text("Coupling: drag on a bed at rest over the size of cells, ",
                               bed.position.size(), " spheres"));
  study.reference(silt::text("kernel, ", finest, " d"), through(bed, silt::Kernel{}, finest));
  for (const auto& mode : modes)
    for (const double h : sizes) {
      if (setting.quick && (h < 1 || h > 4)) continue;
      study.variant(name_of(mode, h), mode.through(bed, h));
    }
  study.accept("error of drag", 0.03);
  study.accept("error of drag of each", 0.02);
  studies::run_and_report(study, setting, "bed");
  studies::add_recommendation(summary, "coupling", study);
  draw(study, setting.out);
  double worst = 0, centre = 0;
  for (const auto& row : study.results().rows)
    for (const auto& mode : modes)
      for (const double h : {0.5, 1.0, 2.0, 4.0})
        if (row.name == name_of(mode, h) && !row.failed()) {
          const double error = row.error("error of drag")->value;
          const std::string which = mode.name;
          if (which == "kernel" || which == "Gaussian" || which == "diffusion")
            worst = std::max(worst, error);
          if (which == "centre" && h <= 2)
            centre = std::max(centre, row.error("error of drag of each")->value);
        }
  summary.check_at_most("kernel_and_diffusion_error_0.5_to_4_d", worst, 0.03);
  summary.check_at_least("centre_error_of_each_in_cells_of_up_to_2_d", centre, 0.1);
}

const studies::Registered here{
    "coupling", "drag on a bed by every mode of coupling, cells from a quarter to 8 diameters",
    run};

}  // namespace

}  // namespace coupling_study
