// silt - BSD-3-Clause, see LICENSE
//
// The stability suite: stiff and extreme scenes, each with its criterion of stability, run up to
// the limit and beyond. Every row must end stable, within its bounds, or be stopped by a message of
// the guard; none may continue with wrong results.

#include <cstdio>
#include <cstdlib>

#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>

#include "stability/table.hpp"
#include "support/example.hpp"

namespace {

void write_time_steps(const std::vector<stability::StepPoint>& points, const std::string& path) {
  std::string all = "law,step over limit [-],error [-],bound [-],stopped\n";
  for (const auto& p : points)
    all += silt::text('"', p.law, "\",", p.share, ',', p.error, ',', p.most, ',',
                      p.stopped ? "1\n" : "0\n");
  silt::AtomicFile file(path);
  file.write(all);
  file.commit();
}

/// False if there is no Python with matplotlib.
bool draw_time_steps(const std::string& out) {
  std::fflush(stdout);
  const std::string from = out + "/time_steps.csv", to = out + "/time_steps.png";
  const std::string command =
      "/usr/bin/python3 '" SILT_STABILITY_SCRIPT "' '" + from + "' '" + to + "'";
  return std::system(command.c_str()) == 0;
}

int run(const example::Options& options) {
  const example::Stopwatch watch;
  silt::make_folder(options.out);
  stability::Table table(options.quick);
  write_time_steps(stability::time_steps(table), options.out + "/time_steps.csv");
  stability::impacts(table);
  stability::several(table);
  stability::packed(table);
  stability::walls(table);
  stability::moving_walls(table);
  stability::rough(table);
  stability::bodies(table);
  stability::spins(table);
  stability::sticky(table);
  stability::light(table);
  stability::bonds(table);
  stability::breakage(table);
  stability::sph(table);
  stability::no_numbers(table);
  table.print_end();
  table.write_csv(options.out + "/stability.csv");

  example::Summary summary;
  summary.input("quick", options.quick);
  table.add_to(summary);
  summary.result("wall_time_s", watch.seconds());
  summary.write(options.out + "/summary.json");
  const bool drawn = draw_time_steps(options.out);
  std::printf("%.0f s; look at: %s/%sstability.csv (whole sentences), summary.json\n",
              watch.seconds(), options.out.c_str(), drawn ? "time_steps.png, " : "");
  if (!drawn) std::printf("(no picture: it needs Python 3 with matplotlib)\n");
  return table.holds() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  example::Command command(
      "Stability suite: stiff and extreme scenes, each row ends stable or is stopped by the guard");
  command.leave_out("--restart"), command.leave_out("--threads");
  return command.run(argc, argv, [&] { return run(command.options); });
}
