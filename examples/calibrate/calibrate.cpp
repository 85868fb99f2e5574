// silt - BSD-3-Clause, see LICENSE
//
// Parameters of scenes from measurements: `calibrate NAME` runs one of the calibrations beside this
// file. Each ends in a table, a picture, and recommended values with intervals. An interrupted
// calibration continues when it is started again.
// begun again it goes on.

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "calibrate/cases.hpp"
#include "support/example.hpp"

namespace {

std::string usage() {
  std::string out =
      "calibrate NAME [options]: parameters of a scene from measurements. NAME is one of\n";
  for (const auto& c : calibrate::all())
    out += "  " + c.name + std::string(c.name.size() < 14 ? 14 - c.name.size() : 1, ' ') + c.about +
           "\n";
  return out + "calibrate NAME --help lists the options.\n";
}

struct Wishes {
  std::size_t budget = 0, repeats = 0, seed = 1;  // 0: as the case has it
};

int run(const calibrate::Entry& entry, const example::Options& options, const Wishes& wishes) {
  const example::Stopwatch clock;
  auto c = entry.make({options.quick, options.threads});
  if (wishes.budget > 0) c.options.budget = wishes.budget;
  if (wishes.repeats > 0) c.options.repeats = wishes.repeats;
  c.options.seed = wishes.seed;
  c.options.folder = options.out;
  const bool terminal = ::isatty(STDERR_FILENO);
  std::size_t runs = 0;
  if (terminal)
    c.options.watch = [&](const silt::CalibrationRun& run) {
      std::fprintf(stderr, "\r\033[Krun %zu, point %zu (%s): chi^2 %.3g, %.1f s", ++runs,
                   run.point + 1, run.kind.c_str(), run.chi2, run.seconds);
    };
  silt::Calibration cal(c.options, c.parameters, c.targets);
  const auto& result = cal.run(c.scene);
  if (terminal) std::fprintf(stderr, "\r\033[K");
  cal.report();

  example::Summary summary;
  summary.input("case", entry.name);
  summary.input("quick", options.quick);
  summary.input("budget", static_cast<double>(c.options.budget));
  summary.input("repeats", static_cast<double>(c.options.repeats));
  summary.input("seed", static_cast<double>(c.options.seed));
  for (const auto& p : result.parameters) {
    summary.result(p.name + " recommended", p.recommended);
    summary.result(p.name + " low", p.low);
    summary.result(p.name + " high", p.high);
  }
  summary.result("runs", static_cast<double>(result.runs.size()));
  summary.result("runs_that_failed", static_cast<double>(result.failures()));
  summary.result("chi2", result.chi2);
  summary.result("wall_time_s", clock.seconds());
  // Values that do not reproduce the measurements: chi^2 of as many targets exceeds this in 1 of
  // 1000.
  const double targets = static_cast<double>(c.targets.size()), w = 2 / (9 * targets);
  summary.check_at_most("chi2", result.chi2, targets * std::pow(1 - w + 3.09 * std::sqrt(w), 3));
  // Fails for a posterior that is too narrow or misses the truth, where that is known: within twice
  // the interval (about four deviations).
  for (std::size_t k = 0; k < c.planted.size(); ++k) {
    const auto& p = result.parameters[k];
    const auto& given = c.parameters[k];
    const double low = given.share(p.low), high = given.share(p.high);
    summary.check_within(p.name + " off planted, in half intervals",
                         (given.share(c.planted[k]) - 0.5 * (low + high)) / (0.5 * (high - low)), 0,
                         2, "an interval of 95 % is four deviations wide");
  }
  summary.write(options.out + "/summary.json");
  summary.print_checks();
  std::printf("%s/summary.json; %.0f s.\n", options.out.c_str(), clock.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  auto& all = calibrate::all();
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  const std::string name = argc > 1 ? argv[1] : "--help";
  if (name == "--help" || name == "-h") {
    std::printf("%s", usage().c_str());
    return argc > 1 ? 0 : 2;
  }
  const auto entry =
      std::find_if(all.begin(), all.end(), [&](const auto& c) { return c.name == name; });
  if (entry == all.end()) {
    std::fprintf(stderr, "there is no calibration '%s'; calibrate --help lists them\n",
                 name.c_str());
    return 2;
  }
  example::Command command(entry->about, example::Kind::Cases);
  Wishes wishes;
  command.add("--budget", wishes.budget, 1, 100000, "Largest number of runs of the scene");
  command.add("--repeats", wishes.repeats, 1, 1000, "Number of runs with the same parameters");
  command.add("--seed", wishes.seed, 1, 1000000, "Seed of the design and the scenes");
  command.options.out.clear();
  return command.run(argc - 1, argv + 1, [&] {
    if (!command.given("--out"))
      command.options.out = "out/calibrate/" + name + (command.options.quick ? "-quick" : "");
    return run(*entry, command.options, wishes);
  });
}
