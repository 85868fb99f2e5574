// silt - BSD-3-Clause, see LICENSE
//
// Drop test: single grains of three sizes hit a steel plate at a series of speeds. The fraction
// that breaks is compared with the selection function, the fragment sizes with the breakage
// function. Then the same grains hit the plate repeatedly at speeds that most of them survive at
// first: fatigue.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "drop_test/scene.hpp"
#include "support/example.hpp"

namespace {

using drop_test::Scene;
using silt::Vec3d;

/// Grains side by side above the plate, far apart, each at the height `gap` [m] and moving down;
/// their ids are 0, 1, ... No gravity: all hit the plate at the same speed.
auto make_simulation(const Scene& s, double diameter, double speed, double gap,
                     std::uint64_t seed) {
  silt::Contacts<drop_test::Law, silt::SeveralMaterials> contacts{{s.salt(), s.steel()}};
  contacts.set_pair(s.salt(), s.steel(), {.restitution = s.restitution, .friction = 0.4});
  silt::Particles<silt::Sphere> grains;
  const auto row = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(s.grains))));
  for (std::size_t k = 0; k < s.grains; ++k)
    grains.add({.position = {3 * diameter * static_cast<double>(k % row),
                             3 * diameter * static_cast<double>(k / row), diameter / 2 + gap},
                .radius = diameter / 2,
                .density = Scene::density,
                .velocity = {0, 0, -speed}});
  silt::Simulation sim{
      std::move(grains), contacts,
      silt::Breakage{
          s.strength(),
          s.equivalence(),
          s.sizes(),
          s.fatigue(),
          {.dust_below = Scene::dust * diameter, .most_fragments = Scene::most, .seed = seed}},
      silt::EnergyLedger{}};
  sim.gravity = {0, 0, 0};
  // Small fragments between the plate and a large one have larger overlaps than alone.
  sim.guard.max_overlap = 0.6;
  sim.time_step = s.touching(Scene::dust * diameter, speed) / 40;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, s.steel(), {.name = "plate"});
  return sim;
}

/// Conservation errors: the worst of all runs.
struct Books {
  double mass = 0, momentum = 0, energy = 0;  // [-] unexplained, over all that there was

  /// `start`: momentum along z of all grains; `dust`: momentum carried away by dust [kg m/s].
  template <class Sim>
  void add(const Sim& sim, double start, double dust) {
    const auto balance = sim.mass_balance();
    mass = std::max(mass, std::abs(balance.residual()) / balance.fed);
    const auto& plate = sim.wall("plate");
    double held = dust;
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) held += sim.mass(k) * sim.velocity(k).z;
    // The velocities are those of the present: the last force has acted for half of its step.
    const double taken = plate.impulse.z - 0.5 * sim.step_length() * plate.force.z;
    momentum = std::max(momentum, std::abs((held + taken) / start - 1));
    const auto e = sim.energy();
    energy = std::max(energy, std::abs(e.residual()) / e.initial);
  }
};

/// All grains of one size at one speed.
struct Throw {
  double diameter, speed;  // [m], [m/s]
  std::size_t grains;
  double expected;  // [-] selection function
  std::size_t broken = 0;
  double dust = 0;  // [-] share of the broken grains' mass
  double load = 0;  // [-] largest deviation from Hertz' closed form

  double share() const { return static_cast<double>(broken) / static_cast<double>(grains); }
  double deviation() const {  // [-] standard, of the share
    return std::sqrt(expected * (1 - expected) / static_cast<double>(grains));
  }
  double off() const { return (share() - expected) / deviation(); }
};

/// Mass fraction finer than each size, of all fragments and their dust: observed, and by the
/// breakage function of each grain that broke.
struct Sizes {
  std::vector<double> x;                    // [m]
  std::vector<double> seen, wanted, error;  // [-]; standard error of `seen`
};

/// Sizes at which they are compared: down to the dust limit four per factor of 2, below it the
/// edges of the dust table.
std::vector<double> sizes_to_see(double diameter) {
  std::vector<double> x;
  const double least = Scene::dust * diameter;
  for (std::size_t k = 1; silt::SizeTable::edge(k) < 0.999 * least; ++k)
    x.push_back(silt::SizeTable::edge(k));
  for (double at = least; at < 1.001 * diameter; at *= std::exp2(0.25)) x.push_back(at);
  return x;
}

template <class Sim>
Sizes see_sizes(const Scene& s, const Sim& sim, double diameter,
                const std::vector<silt::BreakEvent>& events) {
  Sizes out{.x = sizes_to_see(diameter), .seen = {}, .wanted = {}, .error = {}};
  const auto n = static_cast<double>(events.size());
  const auto sizes = s.sizes();
  const double least = 0.999 * Scene::dust * diameter;  // [m]
  for (const double x : out.x) {
    double sum = 0, squares = 0, wanted = 0;
    for (const silt::BreakEvent& b : events) {
      const silt::Broken parent{b.diameter, b.mass, b.strength, b.load, b.speed};
      double finer = x < least ? sim.dust().finer(x) * b.dust : b.dust;
      for (std::size_t f = 0; f < b.fragments; ++f) {
        const std::size_t k = sim.find(b.first + f);
        if (2 * sim.radius(k) < x) finer += sim.mass(k);
      }
      sum += finer / b.mass, squares += finer / b.mass * finer / b.mass;
      wanted += sizes.finer(x, parent);
    }
    out.seen.push_back(sum / n), out.wanted.push_back(wanted / n);
    out.error.push_back(std::sqrt(std::max(squares / n - sum / n * sum / n, 0.0) / n));
  }
  return out;
}

/// One throw. Evaluated when the grains have left the plate; the fragments are still in flight and
/// do not break further.
Throw throw_once(const Scene& s, double diameter, double speed, std::uint64_t seed, Books& books,
                 const std::string& picture, Sizes* sizes, int threads) {
  Throw out{diameter, speed, s.grains, s.selection(diameter, speed)};
  const double gap = 0.05 * diameter;
  auto sim = make_simulation(s, diameter, speed, gap, seed);
  sim.threads = threads;
  std::vector<silt::BreakEvent> events;
  double lost = 0, dust = 0, mass = 0;  // [kg m/s], [kg]
  sim.run((gap + 0.5 * diameter) / speed, silt::on_break([&](const silt::BreakEvent& b) {
            events.push_back(b);
            dust += b.dust, lost += b.dust * b.velocity.z, mass += b.mass;
          }));
  for (const silt::BreakEvent& b : events) {
    out.broken += b.id < s.grains;
    out.load = std::max(out.load, std::abs(b.load / s.load(diameter, speed) - 1));
  }
  if (mass > 0) out.dust = dust / mass;
  books.add(sim, -speed * s.mass(diameter) * static_cast<double>(s.grains), lost);
  if (!picture.empty()) silt::write_particles(picture, sim);
  if (sizes != nullptr) *sizes = see_sizes(s, sim, diameter, events);
  return out;
}

/// Repeated throws of the same grains at one speed.
struct Again {
  double speed;  // [m/s]
  std::size_t grains;
  std::vector<std::size_t> broken;             // after 1, 2, ... impacts
  std::vector<double> expected;                // [-] share
  double mean = 0, wanted = 0, deviation = 0;  // impacts until they break, of those that broke

  double share(std::size_t k) const {
    return static_cast<double>(broken[k]) / static_cast<double>(grains);
  }
  double share_deviation(std::size_t k) const {
    return std::sqrt(expected[k] * (1 - expected[k]) / static_cast<double>(grains));
  }
  /// Mean number of impacts, its expectation, and the standard error.
  void evaluate() {
    double of_seen = 0, of_law = 0, squares = 0, before = 0;
    std::size_t seen_before = 0;
    for (std::size_t k = 0; k < broken.size(); ++k) {
      const auto n = static_cast<double>(k + 1);
      of_seen += n * static_cast<double>(broken[k] - seen_before);
      of_law += n * (expected[k] - before), squares += n * n * (expected[k] - before);
      seen_before = broken[k], before = expected[k];
    }
    mean = of_seen / static_cast<double>(seen_before), wanted = of_law / before;
    deviation = std::sqrt((squares / before - wanted * wanted) / static_cast<double>(seen_before));
  }
};

/// After each impact the fragments are removed and the unbroken grains thrown back from their
/// positions: each impact starts as far from the plate as the one before.
Again throw_again(const Scene& s, double diameter, double speed, std::uint64_t seed, Books& books,
                  int threads) {
  Again out{speed, s.grains, {}, drop_test::broken_after(s, diameter, speed, s.again)};
  const double gap = 0.02 * diameter;
  auto sim = make_simulation(s, diameter, speed, gap, seed);
  sim.threads = threads;
  const double round =
      gap / speed * (1 + 1 / s.restitution) + 1.2 * s.touching(diameter, speed);  // [s]
  std::size_t broken = 0;
  const auto count = silt::on_break([&](const silt::BreakEvent& b) { broken += b.id < s.grains; });
  for (std::size_t n = 0; n < s.again; ++n) {
    sim.run(round, count);
    out.broken.push_back(broken);
    for (std::size_t k = 0; k < sim.rows(); ++k) {
      if (!sim.is_present(k)) continue;
      if (sim.id(k) < s.grains)
        sim.set_velocity(sim.id(k), {0, 0, -speed});
      else
        sim.remove(sim.id(k));
    }
  }
  const auto balance = sim.mass_balance();
  books.mass = std::max(books.mass, std::abs(balance.residual()) / balance.fed);
  out.evaluate();
  return out;
}

void write_shares(const std::string& file, const Scene& s, const std::vector<Throw>& all) {
  silt::CsvTable table(file, {"size [m]", "speed [m/s]", "grains", "broken", "share",
                              "selection function", "3 sigma", "dust of the broken"});
  for (const Throw& t : all)
    table.add_row({t.diameter, t.speed, static_cast<double>(t.grains),
                   static_cast<double>(t.broken), t.share(), t.expected, 3 * t.deviation(),
                   t.dust});
  // The law between the speeds, for the picture.
  silt::CsvTable law(file.substr(0, file.size() - 4) + "_law.csv",
                     {"size [m]", "speed [m/s]", "selection function"});
  for (const double d : s.diameters)
    for (double v = 0.3; v < 3.4; v *= 1.03)
      law.add_row({d, v * s.median_speed(d), s.selection(d, v * s.median_speed(d))});
}
void write_sizes(const std::string& file, const Sizes& sizes) {
  silt::CsvTable table(file, {"x [m]", "share finer", "breakage function", "standard error"});
  for (std::size_t k = 0; k < sizes.x.size(); ++k)
    table.add_row({sizes.x[k], sizes.seen[k], sizes.wanted[k], sizes.error[k]});
}
void write_fatigue(const std::string& file, const std::vector<Again>& all) {
  silt::CsvTable table(file, {"speed [m/s]", "impacts", "broken share", "by the law", "3 sigma"});
  for (const Again& a : all)
    for (std::size_t k = 0; k < a.broken.size(); ++k)
      table.add_row({a.speed, static_cast<double>(k + 1), a.share(k), a.expected[k],
                     3 * a.share_deviation(k)});
}

/// A normal deviate exceeds this, on one side, with a probability of 1e-4: each of these checks
/// fails by chance for one seed in ten thousand.
constexpr double rare = 3.719;

void check_shares(example::Summary& summary, const std::vector<Throw>& all) {
  double squares = 0, off = 0, variance = 0, worst = 0, load = 0;
  std::size_t beyond = 0;
  for (const Throw& t : all) {
    const auto n = static_cast<double>(t.grains);
    squares += t.off() * t.off(), worst = std::max(worst, std::abs(t.off()));
    beyond += std::abs(t.off()) > 3, load = std::max(load, t.load);
    off += n * (t.share() - t.expected), variance += n * t.expected * (1 - t.expected);
  }
  const auto n = static_cast<double>(all.size());
  summary.result("points", n);
  summary.result("points_beyond_3_sigma", static_cast<double>(beyond));
  summary.result("points_beyond_3_sigma_expected", 0.0027 * n);
  summary.result("largest_deviation_in_sigma", worst);
  summary.check_at_most("loads_off_hertz", load, 1e-12);
  summary.check_at_most("chi_square_of_shares", squares, drop_test::chi_square(n, rare));
  summary.check_at_least("chi_square_of_shares", squares, drop_test::chi_square(n, -rare));
  summary.check_within("all_broken_off_the_law_in_sigma", off / std::sqrt(variance), 0, rare,
                       "probability of 2e-4");
}

/// Fails for missing fatigue (no grain would break after the first impact), and for fatigue that
/// acts at each step of a contact (nearly all would break at the second).
void check_fatigue(example::Summary& summary, const std::vector<Again>& all) {
  for (const Again& a : all) {
    const std::string at = silt::text("at ", std::round(100 * a.speed) / 100, " m/s: ");
    const std::size_t last = a.broken.size() - 1;
    summary.result(at + "mean number of impacts of those that broke", a.mean);
    summary.result(at + "the same by the law", a.wanted);
    summary.check_within(at + "mean number of impacts off the law in sigma",
                         (a.mean - a.wanted) / a.deviation, 0, rare, "probability of 2e-4");
    summary.check_within(at + "share broken in the end off the law in sigma",
                         (a.share(last) - a.expected[last]) / a.share_deviation(last), 0, rare,
                         "probability of 2e-4");
  }
}

/// Allowed error of the random fragment sizes: 0.16 % of the mass (docs/breakage.md).
void check_sizes(example::Summary& summary, const Sizes& sizes) {
  double worst = 0, most = 0;
  for (std::size_t k = 0; k < sizes.x.size(); ++k) {
    const double off = std::abs(sizes.seen[k] - sizes.wanted[k]);
    most = std::max(most, off);
    worst = std::max(worst, off / (0.0016 + 4 * sizes.error[k]));
  }
  summary.result("largest_deviation_from_the_breakage_function", most);
  summary.check_at_most("sizes_off_the_breakage_function_over_0.16_percent_and_4_sigma", worst, 1);
}

void check_books(example::Summary& summary, const Books& books) {
  summary.check_at_most("mass_unexplained", books.mass, 1e-12);
  summary.check_at_most("momentum_unexplained", books.momentum, 1e-11);
  // Second order in the time step: forces of small fragments change much within one step. Observed:
  // 5e-5.
  summary.check_at_most("energy_unexplained", books.energy, 1e-3);
}

std::vector<Throw> throw_all(const Scene& s, const example::Options& options, Books& books,
                             Sizes& sizes) {
  std::vector<Throw> all;
  for (const double d : s.diameters) {
    std::printf("%zu grains of %g mm at each of %zu speeds\n", s.grains, 1e3 * d, s.speeds);
    for (std::size_t k = 0; k < s.speeds; ++k) {
      const double along = static_cast<double>(k) / static_cast<double>(s.speeds - 1);
      const double v = s.median_speed(d) * s.slowest * std::pow(s.fastest / s.slowest, along);
      const bool first = d == s.diameters.front(), middle = first && k == s.speeds / 2,
                 last = first && k + 1 == s.speeds;
      // Each throw has its own seed: the same grains at all speeds would not be independent.
      all.push_back(throw_once(s, d, v, 1000 * s.seed + all.size(), books,
                               middle ? options.out + "/after.vtp" : "", last ? &sizes : nullptr,
                               options.threads));
    }
  }
  return all;
}

int simulate(const Scene& s, const example::Options& options) {
  const example::Stopwatch whole;
  silt::make_folder(options.out);
  Books books;
  Sizes sizes;
  const auto shares = throw_all(s, options, books, sizes);
  std::vector<Again> again;
  const double d = s.diameters.front();
  for (const double speed : s.gentle) {
    const double v = speed * s.median_speed(d);
    std::printf("%zu grains of %g mm, up to %zu times at %.2f m/s\n", s.grains, 1e3 * d, s.again,
                v);
    again.push_back(
        throw_again(s, d, v, 1000 * s.seed + 500 + again.size(), books, options.threads));
  }
  example::Summary summary;
  summary.input("grains_of_a_size_and_speed", static_cast<double>(s.grains));
  summary.input("restitution", s.restitution);
  summary.input("seed", static_cast<double>(s.seed));
  for (const double size : s.diameters)
    summary.result(silt::text("median speed of ", 1e3 * size, " mm [m/s]"), s.median_speed(size));
  check_shares(summary, shares);
  check_sizes(summary, sizes);
  check_fatigue(summary, again);
  check_books(summary, books);
  summary.result("wall_time_s", whole.seconds());
  write_shares(options.out + "/drop_test.csv", s, shares);
  write_sizes(options.out + "/sizes.csv", sizes);
  write_fatigue(options.out + "/fatigue.csv", again);
  summary.write(options.out + "/summary.json");
  const bool drawn = example::run_script(
      SILT_DROP_TEST_SCRIPT, {options.out, silt::text(d), silt::text(shares[s.speeds / 2].speed)});
  std::printf("\n");
  for (const double size : s.diameters)
    std::printf("Half of the grains of %g mm break at %.2f m/s.\n", 1e3 * size,
                s.median_speed(size));
  for (const Again& a : again)
    std::printf(
        "At %.2f m/s %.1f %% break at once, %.1f %% within %zu impacts: after %.2f of them in "
        "the mean (law: %.2f).\n",
        a.speed, 100 * a.share(0), 100 * a.share(s.again - 1), s.again, a.mean, a.wanted);
  summary.print_checks();
  std::printf("Look at: %s%s/drop_test.csv, sizes.csv, fatigue.csv, summary.json; %.0f s\n",
              drawn ? (options.out + "/drop_test.png, sizes.png, ").c_str() : "",
              options.out.c_str(), whole.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command("Grains thrown against a plate of steel: how many break, into what",
                           example::Kind::Cases, "out/drop_test");
  Scene scene;
  command.add("--grains", scene.grains, 50, 1000000, "Number of grains of each size at each speed");
  command.add("--speeds", scene.speeds, 2, 100, "Number of speeds for each size");
  command.add("--again", scene.again, 2, 1000, "Largest number of impacts of the same grain");
  command.add("--restitution", scene.restitution, 0.05, 1,
              "Restitution of the grains on the plate [-]");
  command.add("--seed", scene.seed, 1, 1000000, "Seed of strengths and fragments");
  return command.run(argc, argv, [&] {
    if (command.options.quick) {
      if (!command.given("--grains")) scene.grains = 400;
      if (!command.given("--speeds")) scene.speeds = 6;
      if (!command.given("--again")) scene.again = 12;
    }
    return simulate(scene, command.options);
  });
}
