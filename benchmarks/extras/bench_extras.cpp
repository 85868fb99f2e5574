// silt - BSD-3-Clause, see LICENSE
// Cost of additions to a scene: a settled bed with and without each of them, with alternating steps
// on one thread. Additions that only observe must leave the motion bitwise unchanged.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <silt/files/atomic_file.hpp>
#include <silt/silt.hpp>

#include "support/example.hpp"

#include "../bed.hpp"

namespace {

using silt::Vec3d;
using Spheres = silt::Particles<silt::Sphere>;

constexpr double radius = 2.15e-3;  // [m] the beds' mean

struct Rounds {
  int count;        // of turns
  double steps;     // of each turn
  std::string out;  // folder
};

/// Time of a turn with the addition over that without, and whether the motions were equal.
struct Cost {
  double median, low, high;  // [-]
  std::size_t apart;         // particles that are at another place
  double farthest;           // [m] how far
};

/// Alternates turns of two simulations of the same bed; `more` is given to the runs of the second.
template <class Plain, class Richer, class... More>
Cost compare(Plain& plain, Richer& richer, const Rounds& rounds, More&... more) {
  const auto turn = [&](auto& sim, auto&... observers) {
    const example::Stopwatch clock;
    sim.run(rounds.steps * bench::time_step, observers...);
    return clock.seconds();
  };
  turn(plain), turn(richer, more...);  // to warm up
  std::vector<double> ratios;
  for (int k = 0; k < rounds.count; ++k) {
    double first = k % 2 ? 0 : turn(plain);
    const double second = turn(richer, more...);
    if (k % 2) first = turn(plain);
    ratios.push_back(second / first);
  }
  std::sort(ratios.begin(), ratios.end());
  Cost cost{ratios[ratios.size() / 2], ratios[ratios.size() / 4], ratios[ratios.size() * 3 / 4], 0,
            0};
  for (std::size_t k = 0; k < plain.rows(); ++k) {
    const std::size_t at = richer.find(k);
    const double way =
        at == richer.rows() ? HUGE_VAL : norm(plain.position(plain.find(k)) - richer.position(at));
    cost.apart += way != 0, cost.farthest = std::max(cost.farthest, way);
  }
  return cost;
}

/// A settled bed of n spheres, and the table's rows.
class Report {
 public:
  Report(example::Summary& summary, std::size_t n, Rounds rounds)
      : summary_(summary), rounds_(std::move(rounds)), n_(n) {
    auto sim = bench::bed(bench::lattice(n), silt::default_threads(), silt::Double{});
    sim.run(20000 * bench::time_step);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      spheres_.add({.position = sim.position(k),
                    .radius = sim.radius(k),
                    .density = 2500,
                    .velocity = sim.velocity(k)});
  }
  void rows() {
    contacts();
    events();
    heat();
    pairs();
    wear();
    images();
    bonds();
    breakage();
  }

 private:
  void contacts();
  void events();
  void heat();
  void pairs();
  void wear();
  void images();
  void bonds();
  void breakage();

  template <class... Policies>
  auto bed(Policies... policies) const {
    auto sim = bench::bed(spheres_, bench::width_for(n_), 1, policies...);
    sim.run(4000 * bench::time_step);  // springs form anew; contacts older than 2000 steps may rest
    return sim;
  }
  template <class... Policies>
  auto warm_bed(Policies... policies) const {
    auto sim = bed(policies...);
    silt::Random random(3);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sim.template field<silt::Temperature>(sim.find(k)) = random.uniform(300, 400);
    return sim;
  }
  /// Charges of 1e-12 C of both signs: forces of about 1e-9 N, compared with weights of 1e-3 N.
  template <class... Policies>
  auto charged_bed(Policies... policies) const {
    auto sim = bed(policies...);
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sim.template field<silt::ElectricCharge>(sim.find(k)) = k % 2 ? 1e-12 : -1e-12;
    return sim;
  }
  std::string key(const std::string& name) const {
    std::string all = silt::text(n_, "_", name);
    std::replace(all.begin(), all.end(), ' ', '_');
    return all;
  }
  void row(const std::string& name, const Cost& cost) {
    std::printf("%8zu  %-45s %6.3f  (%.3f to %.3f)\n", n_, name.c_str(), cost.median, cost.low,
                cost.high);
    std::fflush(stdout);
    summary_.result(key(name), cost.median);
    summary_.result(key(name) + "_lower_quartile", cost.low);
    summary_.result(key(name) + "_upper_quartile", cost.high);
  }
  /// The row of an addition that must not affect the motion.
  void row_of_watcher(const std::string& name, const Cost& cost) {
    row(name, cost);
    summary_.check_at_most(key(name) + "_particles_that_moved_otherwise",
                           static_cast<double>(cost.apart), 0);
  }
  /// That of a ledger: its energies stand in the laws, where g++ fuses other multiplications and
  /// additions than without (AVX2), so places differ by rounding.
  void row_of_ledger(const std::string& name, const Cost& cost) {
    row(name, cost);
    summary_.check_at_most(key(name) + "_farthest_way_of_a_particle_over_radius",
                           cost.farthest / radius, 1e-6);
  }
  /// The heat of all particles is constant: exchanges cancel.
  template <class Sim>
  void check_heat(const std::string& name, Sim& sim, const std::pair<double, double>& before) {
    const auto [sum, spread] = temperatures(sim);
    summary_.check_within(key(name) + "_heat_after_over_before", sum / before.first, 1, 1e-12,
                          "sums of 10 000 fluxes a particle, each to rounding");
    // 1.5e-7 less in 800 steps, as softened grains conduct through small real contact circles; 0 if
    // nothing flows.
    summary_.check_at_most(key(name) + "_spread_of_temperatures_after_over_before",
                           spread / before.second, 1 - 5e-8);
  }
  /// Sum of mass times temperature [kg K], and the standard deviation of the temperatures [K].
  template <class Sim>
  std::pair<double, double> temperatures(Sim& sim) const {
    double heat = 0, sum = 0, squares = 0;
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      const double T = sim.template field<silt::Temperature>(k);
      heat += sim.mass(k) * T, sum += T, squares += T * T;
    }
    const double mean = sum / static_cast<double>(n_);
    return {heat, std::sqrt(std::max(0.0, squares / static_cast<double>(n_) - mean * mean))};
  }

  example::Summary& summary_;
  Rounds rounds_;
  std::size_t n_;
  Spheres spheres_;
};

void Report::contacts() {
  const auto schedule = silt::every(100 * bench::time_step);
  {
    auto plain = bed(), richer = bed();
    double sum = 0;  // [N]
    auto reads = silt::at(schedule, [&](const auto& sim) {
      sim.for_each_contact([&](const silt::ContactSeen& c) { sum += c.normal_force; });
    });
    row_of_watcher("contacts read every 100 steps", compare(plain, richer, rounds_, reads));
    summary_.check_at_least(key("sum of forces read"), sum, 1e-9);
  }
  auto plain = bed(), richer = bed();
  const std::string folder = rounds_.out + "/contacts";
  auto writes = silt::contact_series(folder, schedule);
  row_of_watcher("contacts to VTK every 100 steps", compare(plain, richer, rounds_, writes));
  std::filesystem::remove_all(folder);
}

void Report::events() {
  auto plain = bed();
  {
    auto richer = bed(silt::ContactEvents{});
    double lost = 0;
    auto ends = silt::on_contact_end([&](const silt::ContactEvent& c) { lost += c.lost_energy; });
    row_of_watcher("contact events", compare(plain, richer, rounds_, ends));
    summary_.check_at_least(key("energy lost in contacts that ended"), lost, 1e-15);
  }
  auto again = bed();
  auto booked = bed(silt::EnergyLedger{});
  row_of_ledger("energy ledger", compare(again, booked, rounds_));
}

void Report::heat() {
  const silt::HeatConduction conduction{
      .conductivity = 1.1, .heat_capacity = 840, .youngs_modulus = 63e9, .poisson_ratio = 0.25};
  {
    auto plain = bed();
    auto richer = warm_bed(conduction);
    const auto before = temperatures(richer);
    row_of_watcher("heat conduction", compare(plain, richer, rounds_));
    check_heat("heat conduction", richer, before);
  }
  {
    auto plain = bed();
    auto often = conduction;
    often.flux_every = 1;
    auto richer = warm_bed(often);
    const auto before = temperatures(richer);
    row_of_watcher("heat conduction asked in each step", compare(plain, richer, rounds_));
    check_heat("heat conduction asked in each step", richer, before);
  }
  auto plain = bed();
  auto richer = warm_bed(silt::EnergyLedger{}, silt::FrictionHeat{conduction});
  row_of_ledger("heat of friction too with its ledger", compare(plain, richer, rounds_));
}

void Report::pairs() {
  {
    auto plain = bed();
    auto richer = warm_bed(silt::MutualRadiation{silt::HeatConduction{.conductivity = 1.1,
                                                                      .heat_capacity = 840,
                                                                      .youngs_modulus = 63e9,
                                                                      .poisson_ratio = 0.25},
                                                 {.emissivity = 0.9, .gap = 1.4 * radius}});
    row_of_watcher("heat conduction and radiation to 1.4 radii", compare(plain, richer, rounds_));
  }
  for (const double reach : {3.0, 6.0}) {
    auto plain = bed();
    auto richer = charged_bed(silt::Charge{.cutoff = reach * radius});
    row(silt::text("charge with a cut-off of ", reach, " radii"), compare(plain, richer, rounds_));
  }
}

void Report::wear() {
  const double w = bench::width_for(n_);
  const auto on_mesh = [&](auto... policies) {
    auto sim = bench::bed(spheres_, w, 1, policies...);
    sim.guard.through_meshes = true;  // as a limit of the overlap was asked for that none reaches
    sim.remove_wall(4);               // the floor
    sim.add_wall(silt::TriangleMesh({{Vec3d{0, 0, 0}, Vec3d{w, 0, 0}, Vec3d{w, w, 0}},
                                     {Vec3d{0, 0, 0}, Vec3d{w, w, 0}, Vec3d{0, w, 0}}}),
                 bench::material, {.name = "floor"});
    sim.run(2000 * bench::time_step);
    return sim;
  };
  auto plain = on_mesh();
  auto richer = on_mesh(silt::Wear<silt::Archard>{{.coefficient = 1e-4, .hardness = 2e9}});
  row_of_watcher("wear of a floor that is a mesh", compare(plain, richer, rounds_));
}

/// A floor that ends at the faces of a periodic box, where spheres touch its images, beside a floor
/// that reaches beyond all of them.
void Report::images() {
  const double w = bench::width_for(n_);
  const auto on_floor = [&](double more) {
    auto sim =
        bench::bed(spheres_, w, 1, silt::PeriodicBox{{{0, 0, -1}, {w, w, 1}}, {true, true, false}});
    sim.guard.through_meshes = true;  // as for wear
    for (std::size_t wall = 0; wall < 5; ++wall) sim.remove_wall(wall);
    sim.add_wall(silt::rectangle({-more, -more, 0}, {w + 2 * more, 0, 0}, {0, w + 2 * more, 0}),
                 bench::material, {.name = "floor"});
    sim.run(2000 * bench::time_step);
    return sim;
  };
  auto plain = on_floor(w), richer = on_floor(0);
  row("images of a floor that ends at periodic faces", compare(plain, richer, rounds_));
}

/// Every contact of the bed is replaced by a bond; and a bed with the policy but without bonds.
void Report::bonds() {
  const silt::Bonds glue{silt::ParallelBond{.youngs_modulus = 1e5}};  // for the beds' step
  {
    auto plain = bed();
    auto richer = bed(glue);
    row_of_watcher("bonds where there are none", compare(plain, richer, rounds_));
  }
  auto plain = bed();
  auto richer = bed(glue);
  const std::size_t contacts = richer.touching_pairs(), made = silt::bond_near(richer, 0);
  row("bonds in place of all contacts", compare(plain, richer, rounds_));
  summary_.check_within(key("bonds over contacts"),
                        static_cast<double>(made) / static_cast<double>(contacts), 1, 1e-3,
                        "contacts that begin or end at rounding");
  summary_.check_at_least(key("bonds that hold"), static_cast<double>(richer.bonds()),
                          static_cast<double>(made));
}

/// A simulation with an observer that does nothing, called as often as the other one is modified.
template <class Sim>
struct Looked : Sim {
  silt::Schedule schedule;
  void run(double duration) {
    Sim::run(duration, silt::at(schedule, [](auto&) {}));
  }
};

/// A bed that can break but does not; and one in which 1 % of the grains break in 1000 steps, one
/// by one, into up to 100 fragments each: its cost includes the steps of all fragments so far.
void Report::breakage() {
  const silt::Breakage policy{
      silt::LogLogisticStrength{.median = 1e9, .at_diameter = 2e-3, .exponent = 0, .spread = 3},
      silt::HertzEquivalence{},
      silt::GaudinSchuhmann{.exponent = 1, .coarsest = 0.8},
      {.dust_below = 0.7 * radius}};
  {
    auto plain = bed();
    auto richer = bed(policy);
    row_of_watcher("breakage where nothing breaks", compare(plain, richer, rounds_));
  }
  auto first = bed();
  const auto schedule = silt::every(1e5 / static_cast<double>(n_) * bench::time_step);
  Looked<decltype(first)> plain{std::move(first), schedule};
  auto richer = bed(policy);
  silt::Random random(7);
  auto breaks = silt::at(schedule, [&](auto& sim) {
    std::size_t k = random.index(sim.rows());
    while (!sim.is_present(k)) k = random.index(sim.rows());
    sim.break_particle(sim.id(k));
  });
  row("1 % of the grains break in 1000 steps", compare(plain, richer, rounds_, breaks));
  const double steps = (rounds_.count + 1) * rounds_.steps;
  summary_.check_within(key("grains that broke over asked"),
                        static_cast<double>(richer.broken()) / (1e-5 * steps * n_), 1, 0.1,
                        "the schedule begins anew with each turn");
  summary_.result(key("particles after breakage"), static_cast<double>(richer.size()));
}

int run(const example::Options& options, std::vector<std::size_t> sizes, std::size_t turns) {
  silt::make_folder(options.out);
  if (sizes.empty())
    sizes = options.quick ? std::vector<std::size_t>{1000} : std::vector<std::size_t>{5000, 50000};
  if (options.quick) turns = std::min<std::size_t>(turns, 3);
  example::Summary summary;
  std::string all;
  for (const std::size_t n : sizes) all += silt::text(all.empty() ? "" : " ", n);
  summary.input("spheres", all);
  summary.input("turns", static_cast<double>(turns));
  summary.input("quick", options.quick);
  std::printf(
      "%s, one thread; time of a step over that without the addition, median of %zu turns "
      "(quartiles)\n",
      example::processor().c_str(), turns);
  for (const std::size_t n : sizes) {
    // Twice the cost of reading the contacts, or more.
    const double steps = options.quick ? 200.0 : std::max(200.0, 5e6 / static_cast<double>(n));
    Report(summary, n, {static_cast<int>(turns), steps, options.out}).rows();
  }
  summary.write(options.out + "/summary.json");
  std::printf("\n");
  summary.print_checks();
  std::printf("Look at: %s/summary.json\n", options.out.c_str());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "What additions cost: contact data, events, heat, charge, wear, bonds, breakage",
      example::Kind::Study, "out/bench-extras");
  std::vector<std::size_t> sizes;
  std::size_t turns = 15;
  command.add("N", sizes, 1000, 10000000, "Spheres; default 5000 50000, with --quick 1000");
  command.add("--turns", turns, 1, 1000, "Turns with and without each addition");
  return command.run(argc, argv, [&] { return run(command.options, sizes, turns); });
}
