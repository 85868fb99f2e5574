// silt - BSD-3-Clause, see LICENSE
//
// Drop test: single grains of three sizes hit a steel plate at a series of speeds. The fraction
// that breaks is compared with the selection function, the fragment sizes with the breakage
// function. Then the same grains hit the plate repeatedly at speeds that most of them survive at
// first: fatigue.
//
// The set-up is scene.hpp; measure.hpp has what is measured, report.hpp tables and checks.

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "drop_test/measure.hpp"
#include "drop_test/report.hpp"
#include "drop_test/scene.hpp"
#include "support/example.hpp"

namespace drop_test {
namespace {

/// Grains of each size at each speed, once.
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
}  // namespace drop_test

int main(int argc, char** argv) {
  example::Command command("Grains thrown against a plate of steel: how many break, into what",
                           example::Kind::Cases, "out/drop_test");
  drop_test::Scene scene;
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
    return drop_test::simulate(scene, command.options);
  });
}
