// silt - BSD-3-Clause, see LICENSE
//
// Error against run time: `study NAME` runs one of the studies beside this file. Each ends in
// tables, a Pareto plot with the recommended setting, and checks against closed forms or published
// numbers.

#include <algorithm>
#include <cstdio>
#include <string>

#include "study/studies.hpp"

namespace {

std::string usage() {
  std::string out = "study NAME [options]: error against run time. NAME is one of\n";
  for (const auto& s : studies::all())
    out += "  " + s.name + std::string(s.name.size() < 14 ? 14 - s.name.size() : 1, ' ') + s.about +
           "\n";
  return out + "study NAME --help lists the options.\n";
}

int run(const studies::Entry& study, const studies::Setting& setting) {
  const example::Stopwatch clock;
  silt::make_folder(setting.out);
  example::Summary summary;
  summary.input("study", study.name);
  summary.input("quick", setting.quick);
  summary.input("repeats", static_cast<double>(setting.repeats));
  study.function(setting, summary);
  summary.result("wall_time_s", clock.seconds());
  summary.write(setting.out + "/summary.json");
  summary.print_checks();
  std::printf("%s/summary.json; %.0f s.\n", setting.out.c_str(), clock.seconds());
  return summary.all_hold() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  auto& all = studies::all();
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  const std::string name = argc > 1 ? argv[1] : "--help";
  if (name == "--help" || name == "-h") {
    std::printf("%s", usage().c_str());
    return argc > 1 ? 0 : 2;
  }
  const auto study =
      std::find_if(all.begin(), all.end(), [&](const studies::Entry& s) { return s.name == name; });
  if (study == all.end()) {
    std::fprintf(stderr, "there is no study '%s'; study --help lists them\n", name.c_str());
    return 2;
  }
  example::Command command(study->about, example::Kind::Study);
  command.options.out = "out/study/" + name;
  std::size_t repeats = 5;
  studies::Setting setting{};
  double microseconds = 1e6 * setting.latency, gigabytes = 1e-9 * setting.bandwidth;
  if (name != "decomposition") {
    command.add("--repeats", repeats, 1, 1000, "Number of rounds; the cost is their median");
  } else {  // one run, in which nothing is repeated
    repeats = 1;
    command.add("--particles", setting.particles, 1000, 10000000, "Number of particles (100 000)");
    command.add("--latency", microseconds, 0, 1e6, "Latency of a message between ranks [us]");
    command.add("--bandwidth", gigabytes, 1e-6, 1e6, "Bandwidth between ranks [GB/s]");
  }
  return command.run(argc - 1, argv + 1, [&] {
    if (command.options.quick && name != "decomposition" && !command.given("--repeats"))
      repeats = 2;
    setting.out = command.options.out, setting.quick = command.options.quick;
    setting.repeats = repeats;
    setting.latency = 1e-6 * microseconds, setting.bandwidth = 1e9 * gigabytes;
    return run(*study, setting);
  });
}
