// silt - BSD-3-Clause, see LICENSE
//
// Angles of repose: after removal of the wall of a column, and in a rotating drum.

#include <cmath>
#include <cstdio>
#include <numbers>

#include <silt/files/csv_table.hpp>

#include "study/shape_crowd.hpp"
#include "study/shape_study.hpp"
#include "support/bed_profile.hpp"

namespace studies::shape {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

// The column: between a wall at x = 0 and a gate, periodic in y.
constexpr int across = 4, along = 3;              // cells of the lattice
constexpr double column_width = across * pitch;   // [m]
constexpr double settling = 0.3, collapse = 0.5;  // [s]

// The drum, about the y axis.
constexpr double drum_radius = 0.03, drum_length = 3 * pitch;  // [m]
constexpr double rpm = 40, drum_filling = 0.12;                // [1/min], [s] a batch
constexpr double turn = 60 / rpm;                              // [s]

/// Free sites of the drum's lattice.
std::vector<Grain> drum_batch(std::size_t count, std::uint64_t seed, double lowest) {
  const int cells = static_cast<int>(2 * drum_radius / pitch);
  const double half = 0.5 * cells * pitch;
  std::vector<Grain> grains;
  for (const auto& g : lattice({-half, 0, -half}, {cells, 3, cells}, 100000, seed))
    if (std::hypot(g.position.x, g.position.z) < drum_radius - 0.5 * pitch &&
        g.position.z > lowest && grains.size() < count)
      grains.push_back(g);
  return grains;
}

}  // namespace

Heap heap_of(const Model& model, std::size_t count, std::uint64_t seed,
             const std::string& picture) {
  const silt::PeriodicBox period{silt::Box{{0, 0, 0}, {1, along * pitch, 1}}, {false, true, false}};
  auto crowd =
      make_crowd(model, {.period = period}, lattice({0, 0, 0}, {across, along, 1000}, count, seed));
  crowd->add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}});
  crowd->add_wall(silt::Plane{{0, 0, 0}, {1, 0, 0}});
  crowd->add_wall(silt::Plane{{column_width, 0, 0}, {-1, 0, 0}});
  const auto clock = silt::processor_time();
  const double start = clock.now();
  crowd->run(settling);
  crowd->remove_wall(2);
  crowd->run(collapse);
  Heap heap;
  heap.cost = (clock.now() - start) / (crowd->time() * static_cast<double>(count));
  double x = 0, z = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const auto at = crowd->grain(k).position;
    x += at.x, z += at.z;
    heap.reach = std::max(heap.reach, at.x);
  }
  heap.angle = std::atan(z / x) * degrees;
  heap.unrest =
      std::sqrt(2 * crowd->kinetic_energy() / (static_cast<double>(count) * crowd->mass()));
  if (!picture.empty()) crowd->write(picture);
  return heap;
}

Drum drum_of(const Model& model, std::size_t count, std::uint64_t seed, double turns,
             const std::string& picture) {
  const silt::PeriodicBox period{
      silt::Box{{-drum_radius, 0, -drum_radius}, {drum_radius, drum_length, drum_radius}},
      {false, true, false}};
  const std::size_t first = std::min<std::size_t>(count, 150);
  auto crowd = make_crowd(model, {.period = period}, drum_batch(first, seed, -1));
  const double rate = 2 * std::numbers::pi / turn, begin = 2 * drum_filling;
  crowd->add_wall(
      silt::Cylinder{
          {0, -drum_length, 0}, {0, 2 * drum_length, 0}, drum_radius, silt::Side::Inside},
      [=, about = silt::rotation({0, 0, 0}, {0, 1, 0}, rate)](double time) {
        return about(std::max(time - begin, 0.0));
      });
  const auto clock = silt::processor_time();
  const double start = clock.now();
  crowd->run(drum_filling);
  if (count > first) crowd->add(drum_batch(count - first, seed + 1000, 0));
  crowd->run(begin - crowd->time());
  crowd->run(0.35 * turn);
  example::Occupancy bed(drum_radius, drum_length);
  const int samples = static_cast<int>(40 * turns);
  for (int n = 0; n < samples; ++n) {
    crowd->run(turns * turn / samples);
    bed.next_sample();
    for (std::size_t k = 0; k < crowd->size(); ++k) {
      const auto at = crowd->grain(k).position;
      bed.add_grain(at.x, at.z, volume);
    }
  }
  Drum drum;
  drum.angle = bed.angle();
  drum.grains = crowd->size();
  drum.cost = (clock.now() - start) / (crowd->time() * static_cast<double>(crowd->size()));
  if (!picture.empty()) crowd->write(picture);
  return drum;
}

namespace {

std::vector<std::uint64_t> seeds(std::size_t count) {
  std::vector<std::uint64_t> all;
  for (std::size_t k = 0; k < count; ++k) all.push_back(k + 1);
  return all;
}

std::size_t heap_size(const Setting& setting) { return setting.quick ? 60 : 150; }

struct Angles {
  Spread heap, drum, cost;
};
Angles measure(const Model& model, std::size_t heaps, std::size_t drums, const Setting& setting,
               const std::string& picture = "") {
  Angles a;
  for (const auto seed : seeds(heaps)) {
    const Heap h = heap_of(model, heap_size(setting), seed, seed == 1 ? picture : "");
    a.heap.values.push_back(h.angle), a.cost.values.push_back(1e3 * h.cost);
  }
  for (const auto seed : seeds(drums))
    a.drum.values.push_back(
        drum_of(model, setting.quick ? 60 : 147, seed, setting.quick ? 0.4 : 0.75).angle);
  return a;
}

/// Mean and half of the range; NaN if nothing was measured.
std::pair<double, double> of_any(const Spread& s) {
  if (s.values.empty()) return {std::nan(""), std::nan("")};
  return {s.mean(), s.half_range()};
}

}  // namespace

Cubes repose(const Cases& cases, const Setting& setting, example::Summary& summary) {
  Cubes cubes;
  const std::size_t some = setting.quick ? 1 : 3;
  for (const auto& c : cases) {
    Rows rows({"heap [deg]", "+- [deg]", "drum [deg]", "+- [deg]", "cost a grain and s [ms]"});
    const bool cube = c.target.name == "cube";
    const auto add = [&](const Model& m, std::size_t heaps, std::size_t drums) {
      const std::string file =
          m.name == "6 faces" ? setting.out + "/heap_cubes.vtp" : std::string();
      const Angles a = measure(m, heaps, drums, setting, file);
      rows.add(m.name, {a.heap.mean(), a.heap.half_range(), of_any(a.drum).first,
                        of_any(a.drum).second, a.cost.mean()});
      summary.result(silt::text("heap_", c.target.name, ": ", m.name), a.heap.mean());
      if (!a.drum.values.empty())
        summary.result(silt::text("drum_", c.target.name, ": ", m.name), a.drum.mean());
      return a;
    };
    if (!setting.quick) add(c.model("20 spheres"), some, cube ? 1 : 0);
    add(c.model("super-ellipsoid"), some, setting.quick ? 0 : 1);
    if (!setting.quick) add(c.model("60 faces"), 1, 0);
    if (cube) {
      const Angles a = add(c.model("6 faces"), some, 1);
      cubes = {a.heap, a.drum};
    }
    rows.report(silt::text("Angles of repose: ", c.target.name, "s"),
                silt::text(setting.out, "/angles_", c.target.name, ".csv"));
  }
  // A heap next to a wall is no steeper than the sliding angle of its faces, atan 0.5 = 27 degrees,
  // plus the effect of interlocking; a drum's surface is steeper than a collapsed heap.
  summary.check_at_least("cubes: angle of the heap", cubes.heap.mean(), 10);
  summary.check_at_least("cubes: drum over heap", cubes.drum.mean() / cubes.heap.mean(), 1);
  return cubes;
}

namespace {

/// First position at which a curve through points (x, y) reaches `wanted`; NaN if nowhere.
double first_reach(const std::vector<double>& x, const std::vector<double>& y, double wanted) {
  for (std::size_t k = 1; k < x.size(); ++k)
    if (y[k - 1] < wanted && y[k] >= wanted)
      return x[k - 1] + (wanted - y[k - 1]) / (y[k] - y[k - 1]) * (x[k] - x[k - 1]);
  return std::nan("");
}

}  // namespace

void roll(const Cases& cases, const Cubes& cubes, const Setting& setting,
          example::Summary& summary) {
  const std::vector<double> coefficients =
      setting.quick ? std::vector<double>{0, 0.1, 0.4}
                    : std::vector<double>{0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5};
  const std::size_t heaps = setting.quick ? 1 : 5, drums = setting.quick ? 1 : 2;
  const std::string path = setting.out + "/rolling.csv";
  std::vector<double> heap, drum;
  {
    silt::CsvTable table(path, {"rolling friction [-]", "heap [degrees]", "drum [degrees]"});
    Rows rows({"heap [deg]", "+- [deg]", "drum [deg]", "+- [deg]"});
    for (const double mu : coefficients) {
      const Angles a = measure(sphere_with(mu), heaps, drums, setting);
      heap.push_back(a.heap.mean()), drum.push_back(a.drum.mean());
      rows.add(silt::text("mu_r = ", mu),
               {heap.back(), a.heap.half_range(), drum.back(), a.drum.half_range()});
      table.add_row({mu, heap.back(), drum.back()});
    }
    rows.add("cubes", {cubes.heap.mean(), cubes.heap.half_range(), cubes.drum.mean(),
                       cubes.drum.half_range()});
    rows.report("Spheres with rolling friction, and cubes", setting.out + "/rolling_angles.csv");
  }
  const double by_heap = first_reach(coefficients, heap, cubes.heap.mean());
  const double by_drum = first_reach(coefficients, drum, cubes.drum.mean());
  const auto words = [](double mu) {
    return std::isfinite(mu) ? silt::text("mu_r = ", std::round(1000 * mu) / 1000)
                             : std::string("none");
  };
  std::printf("As steep as cubes: heap at %s, drum at %s.\n\n", words(by_heap).c_str(),
              words(by_drum).c_str());
  summary.result("rolling_friction_by_heap", words(by_heap));
  summary.result("rolling_friction_by_drum", words(by_drum));

  // Other quantities in which a bed of such spheres matches one of cubes.
  Rows rows({"solid fraction [-]", "partners [-]", "cost a grain and s [ms]"});
  const std::size_t count = bed_size(setting);
  const auto add = [&](const std::string& name, const Model& m) {
    const Bed b = settled_bed(m, count, 1);
    rows.add(name, {b.solid_fraction, b.partners, 1e3 * b.cost});
    summary.result("rolling_bed: " + name + ": solid fraction", b.solid_fraction);
    return b;
  };
  const Bed of_cubes = add("cubes", cases.back().model("6 faces"));
  const Bed plain = add("spheres, mu_r = 0", sphere_with(0));
  if (std::isfinite(by_heap)) add("spheres, by heap", sphere_with(by_heap));
  if (std::isfinite(by_drum)) add("spheres, by drum", sphere_with(by_drum));
  rows.report("Beds", setting.out + "/rolling_beds.csv");
  summary.check_at_least("spheres: heap with most rolling friction over none",
                         heap.back() / heap.front(), 1.2);
  summary.check_at_least("bed of cubes: cost over that of spheres", of_cubes.cost / plain.cost, 1);
  const std::string cubes_seen = setting.out + "/heap_cubes.vtp";
  const std::string spheres_seen = setting.out + "/heap_spheres.vtp";
  const double shown = std::isfinite(by_heap) ? by_heap : coefficients.back();
  heap_of(sphere_with(shown), heap_size(setting), 1, spheres_seen);
  example::draw({"draw", cubes_seen, spheres_seen, "--view", "front", "--title", "cubes",
                 silt::text("spheres, mu_r = ", std::round(1000 * shown) / 1000), "--out",
                 setting.out + "/heaps.png"});
  if (example::draw({"curves", path, "--x", "rolling friction", "--y", "heap,drum", "--reference",
                     silt::text("cubes, heap:0,", cubes.heap.mean()), "--reference",
                     silt::text("cubes, drum:0,", cubes.drum.mean()), "--y-label",
                     "angle of repose [degrees]", "--title",
                     "Spheres with rolling friction instead of cubes", "--out",
                     setting.out + "/rolling.png"}))
    std::printf("Look at %s: rolling.png, heaps.png.\n", setting.out.c_str());
}

}  // namespace studies::shape
