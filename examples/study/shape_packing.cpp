// silt - BSD-3-Clause, see LICENSE
//
// Grains fall into a box without side walls and come to rest: solid fraction, coordination number,
// and cost. All models start from the same positions, orientations and velocities.

#include <algorithm>

#include "study/shape_crowd.hpp"
#include "study/shape_study.hpp"

namespace studies::shape {

namespace {

constexpr double width = 3.2 * pitch;  // [m] of the period
constexpr double duration = 0.25;      // [s]

/// Fraction of the volume of a sphere that lies below z.
double share_below(double centre, double z) {
  const double h = std::clamp((z - centre) / radius + 1, 0.0, 2.0);
  return h * h * (3 - h) / 4;
}

}  // namespace

Bed settled_bed(const Model& model, std::size_t count, std::uint64_t seed) {
  const silt::PeriodicBox period{silt::Box{{0, 0, 0}, {width, width, 1}}, {true, true, false}};
  auto crowd = make_crowd(model, {.period = period}, lattice({0, 0, 0}, {3, 3, 1000}, count, seed));
  crowd->add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  const auto clock = silt::processor_time();
  const double start = clock.now();
  crowd->run(duration);
  Bed bed;
  bed.cost = (clock.now() - start) / (duration * static_cast<double>(count));
  // The centre of a bed of uniform density and height H is at H/2; layers of one diameter at its
  // floor and of one and a half at its top are left out.
  double middle = 0, inside = 0;
  for (std::size_t k = 0; k < count; ++k)
    middle += crowd->grain(k).position.z / static_cast<double>(count);
  const double low = 2 * radius, high = 2 * middle - 3 * radius;
  for (std::size_t k = 0; k < count; ++k) {
    const double z = crowd->grain(k).position.z;
    inside += volume * (share_below(z, high) - share_below(z, low));
  }
  bed.solid_fraction = inside / (width * width * (high - low));
  bed.height = 2 * middle;
  bed.partners = crowd->partners();
  bed.step = crowd->step_length();
  bed.unrest =
      std::sqrt(2 * crowd->kinetic_energy() / (static_cast<double>(count) * crowd->mass()));
  bed.overlap = crowd->peak_overlap();
  return bed;
}

void settle(const Cases& cases, const Setting& setting, example::Summary& summary) {
  const std::size_t count = bed_size(setting);
  const std::vector<std::uint64_t> others =
      setting.quick ? std::vector<std::uint64_t>{2} : std::vector<std::uint64_t>{2, 3, 4};
  for (const auto& [t, models] : cases) {
    silt::Study study(silt::text("A bed of ", count, " ", t.name, "s"));
    // The exact shape from other starts: the reference for the models, and the scatter between
    // beds.
    Spread fraction, partners;
    for (const auto seed : others) {
      const Bed b = settled_bed(exact_for(t), count, seed);
      fraction.values.push_back(b.solid_fraction), partners.values.push_back(b.partners);
    }
    study.reference("super-ellipsoids, other starts", [&](silt::StudyRun& run) {
      run.time([] {});
      run.value("solid fraction", fraction.mean());
      run.value("partners", partners.mean());
    });
    double unrest = 0;
    for (const auto& model : models) {
      if (model.step_share < 0.9) continue;  // minutes: see the docs
      study.variant(model.name, [&, model](silt::StudyRun& run) {
        Bed b{};
        run.time([&] { b = settled_bed(model, count, 1); });
        run.value("solid fraction", b.solid_fraction);
        run.value("partners", b.partners);
        run.note("cost a grain and s", 1e3 * b.cost, "ms");
        run.note("step", 1e6 * b.step, "us");
        run.note("speeds left", 1e3 * b.unrest, "mm/s");
        unrest = std::max(unrest, b.unrest);
      });
    }
    study.accept("error of solid fraction", 0.03);  // what beds from other starts differ by
    auto once = setting;
    once.repeats = 1;
    run_and_report(study, once, "bed_" + t.name);
    summary.result("solid_fraction_" + t.name, fraction.mean());
    if (others.size() > 1) {
      std::printf(
          "Super-ellipsoids from other starts: solid fraction %.4f +- %.4f, partners %.2f +- "
          "%.2f\n\n",
          fraction.mean(), fraction.half_range(), partners.mean(), partners.half_range());
      summary.result("solid_fraction_half_range_" + t.name, fraction.half_range());
    }
    for (const auto& r : study.results().rows)
      for (const auto& n : r.notes)
        if (n.name == "solid fraction" || n.name == "cost a grain and s")
          summary.result(silt::text("bed_", t.name, ": ", r.name, ": ", n.name), n.value);
    // A fall of 0.1 m ends at 1.5 m/s: 1/1000 of the energy is left.
    summary.check_at_most(silt::text("bed_", t.name, ": speeds left [m/s]"), unrest, 0.05);
    // Observed: beds from other starts differ by 2 %.
    for (const auto& r : study.results().rows)
      if (r.name == "60 faces" && !r.failed())
        summary.check_at_most(silt::text("bed_", t.name, ": 60 faces, error of solid fraction"),
                              r.error("error of solid fraction")->value, 0.06);
  }
}

}  // namespace studies::shape
