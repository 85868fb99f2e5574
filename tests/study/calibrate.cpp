// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/study/calibrate.hpp>

#include "near.hpp"
#include "refusal.hpp"

namespace calibrate_test {

namespace {

using namespace silt;
using silt_test::has, silt_test::refusal;
using Values = std::vector<double>;

std::string content(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

/// A folder of this test alone, gone at its end.
struct Folder {
  std::filesystem::path path;
  explicit Folder(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             text("silt_test_calibrate_", name, "_", ::getpid())) {
    std::filesystem::remove_all(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::vector<CalibrationParameter> two() {
  return {{.name = "restitution [-]", .least = 0.3, .most = 0.9},
          {.name = "friction [-]", .least = 0.1, .most = 0.8}};
}
/// What `scene` gives without noise at restitution 0.6 and friction 0.35.
std::vector<CalibrationTarget> angles() {
  return {{.name = "angle [deg]", .measured = 20 + 30 * std::sqrt(0.35) + 5 * 0.36, .error = 0.5},
          {.name = "height [mm]", .measured = 10 * 0.6 - 4 * 0.35, .error = 0.1}};
}
Values scene(const Values& p, std::uint64_t seed) {
  Random noise(seed);
  return {20 + 30 * std::sqrt(p[1]) + 5 * p[0] * p[0] + 0.1 * noise.normal(),
          10 * p[0] - 4 * p[1] + 0.02 * noise.normal()};
}
std::string refused(const CalibrationOptions& options, std::vector<CalibrationParameter> parameters,
                    std::vector<CalibrationTarget> targets) {
  return refusal([&] { Calibration(options, parameters, targets); });
}

/// The columns of calibration.csv that do not depend on the clock.
std::string without_times(const std::string& csv) {
  std::istringstream lines(csv);
  std::string out, line;
  while (std::getline(lines, line)) {
    const auto failure = line.rfind(','), time = line.rfind(',', failure - 1);
    out += line.substr(0, time) + line.substr(failure) + '\n';
  }
  return out;
}

}  // namespace

TEST_CASE("calibrate: finds the parameters of a smooth scene, and says how sure it is") {
  std::size_t watched = 0;
  Calibration cal{
      {.budget = 50, .watch = [&](const CalibrationRun&) { ++watched; }}, two(), angles()};
  const auto& r = cal.run(scene);
  CHECK(std::abs(r.parameters[0].recommended - 0.6) < 0.02);
  CHECK(std::abs(r.parameters[1].recommended - 0.35) < 0.02);
  CHECK(r.chi2 < 0.5);
  CHECK(watched == r.runs.size());
  CHECK(r.runs.size() <= 50);
  CHECK(r.runs.back().kind == "confirmation");
  CHECK(r.runs.back().parameters == r.recommended());
  CHECK(r.targets[0].confirmed == r.runs.back().outputs[0]);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto& p = r.parameters[k];
    CHECK(p.low < p.recommended);
    CHECK(p.recommended < p.high);
  }
  // Closed forms of both outputs, linearised: (J' W J)^-1. Intervals are 2 * 1.96 deviations,
  // within 25 %: by curvature, and 1200 correlated points.
  const double j00 = 6 / 0.5, j01 = 15 / std::sqrt(0.35) / 0.5, j10 = 10 / 0.1, j11 = -4 / 0.1;
  const double det = j00 * j11 - j01 * j10;
  const double s0 = std::sqrt(j11 * j11 + j01 * j01) / std::abs(det);
  const double s1 = std::sqrt(j10 * j10 + j00 * j00) / std::abs(det);
  CHECK(near_relative(r.parameters[0].high - r.parameters[0].low, 3.92 * s0, 0.25));
  CHECK(near_relative(r.parameters[1].high - r.parameters[1].low, 3.92 * s1, 0.25));
  CHECK(r.targets[0].total[1] > 0.9);  // the angle is by friction, the height by restitution
  CHECK(r.targets[1].total[0] > 0.75);
  for (const auto& run : r.runs)
    for (std::size_t k = 0; k < 2; ++k) {
      CHECK(run.parameters[k] >= two()[k].least);
      CHECK(run.parameters[k] <= two()[k].most);
    }
  const std::string table = cal.table();
  for (const char* words :
       {"restitution [-]", "recommended", "95 % from", "angle [deg]", "S friction", "Stopped"})
    CHECK(has(table, words));
}

TEST_CASE("calibrate: the same seed gives the same runs, another one others") {
  const auto runs = [](std::uint64_t seed) {
    Calibration cal{{.budget = 16, .seed = seed}, two(), angles()};
    Values all;
    for (const auto& run : cal.run(scene).runs)
      all.insert(all.end(), run.outputs.begin(), run.outputs.end());
    return all;
  };
  const auto one = runs(1);
  CHECK(one == runs(1));
  CHECK(one != runs(2));
}

TEST_CASE("calibrate: a logarithmic parameter is spread by its logarithm") {
  Calibration cal{{.design = 20, .budget = 40},
                  {{.name = "E [Pa]", .least = 1e5, .most = 1e9, .logarithmic = true}},
                  {{.name = "time [s]", .measured = 1, .error = 0.05}}};
  const auto& r =
      cal.run([](const Values& p, std::uint64_t) { return Values{std::pow(p[0] / 1e7, -0.2)}; });
  std::size_t below = 0;
  for (std::size_t k = 0; k < 20; ++k) below += r.runs[k].parameters[0] < 1e7;
  CHECK(below == 10);  // a Latin hypercube of 20: half of them below the middle
  CHECK(near_relative(r.parameters[0].recommended, 1e7, 0.1));
  CHECK(r.parameters[0].low < 1e7);
  CHECK(r.parameters[0].high > 1e7);
  CHECK(r.parameters[0].high < 3e7);
}

TEST_CASE("calibrate: repeats have seeds of their own and give the noise") {
  std::vector<std::uint64_t> seeds;
  Calibration cal{{.budget = 60, .repeats = 3}, two(), angles()};
  const auto& r = cal.run([&](const Values& p, std::uint64_t seed) {
    seeds.push_back(seed);
    return scene(p, seed);
  });
  std::sort(seeds.begin(), seeds.end());
  CHECK(std::adjacent_find(seeds.begin(), seeds.end()) == seeds.end());
  CHECK(r.runs[0].parameters == r.runs[2].parameters);
  CHECK(r.runs[0].outputs != r.runs[2].outputs);
  CHECK(r.runs.size() % 3 == 0);
  // At least 20 degrees of freedom: the deviation is known to 16 %; 4 of it would be 0.64.
  CHECK(near_relative(r.targets[0].noise, 0.1, 0.6));
  CHECK(near_relative(r.targets[1].noise, 0.02, 0.6));
}

TEST_CASE("calibrate: runs that fail are kept, told, and their region is left alone") {
  std::size_t failed = 0, proposals = 0, there = 0;
  Folder folder("failures");
  // Fails where restitution is above 0.65: the best values lie beside that.
  const auto brittle = [&](const Values& p, std::uint64_t seed) {
    if (p[0] > 0.65 && ++failed % 2 == 0) return Values{std::nan(""), 1};
    if (p[0] > 0.65) throw std::runtime_error("overlap, \"0.7\"\nof the radius");
    return scene(p, seed);
  };
  Calibration cal{{.folder = folder.path, .budget = 40}, two(), angles()};
  const auto& r = cal.run(brittle);
  for (const auto& run : r.runs)
    if (run.kind == "proposal") ++proposals, there += run.parameters[0] > 0.65;
  CHECK(failed > 0);
  CHECK(r.failures() == failed);
  CHECK(proposals > 3);
  CHECK(there <= 3);
  CHECK(std::abs(r.parameters[0].recommended - 0.6) < 0.03);
  CHECK(has(cal.table(), "runs failed; the first: overlap, \"0.7\" of the radius"));
  // They are read again as they were.
  const auto before = r.runs;
  std::size_t again = 0;
  const auto& second = cal.run([&](const Values& p, std::uint64_t seed) {
    ++again;
    return scene(p, seed);
  });
  CHECK(again == 0);
  CHECK(second.earlier == before.size());
  REQUIRE(second.runs.size() == before.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    CHECK(second.runs[k].failure == before[k].failure);
    CHECK(second.runs[k].outputs == before[k].outputs);
    CHECK(second.runs[k].parameters == before[k].parameters);
  }
  const std::string csv = content(folder.path / "calibration.csv");
  CHECK(has(csv, "\"overlap, \"\"0.7\"\" of the radius\""));
  CHECK(has(csv, "angle [deg] = nan is not finite"));
}

TEST_CASE("calibrate: killed by SIGKILL at any moment and begun again, it makes the same runs") {
  Folder whole("whole"), killed("killed");
  const CalibrationOptions options{.budget = 34, .repeats = 2};
  const auto slow = [](const Values& p, std::uint64_t seed) {
    ::usleep(3000);
    return scene(p, seed);
  };
  const auto work = [&](const std::filesystem::path& path) {
    auto mine = options;
    mine.folder = path;
    Calibration cal{mine, two(), angles()};
    return cal.run(slow).recommended();
  };
  const auto expected = work(whole.path);
  Random random(4);
  int kills = 0;
  for (bool ended = false; !ended; ++kills) {
    REQUIRE(kills < 200);
    const pid_t child = ::fork();
    if (child == 0) {
      work(killed.path);
      ::_exit(0);
    }
    // Within the first 15 kills somewhere in a few runs; then it may end.
    if (kills < 15) {
      ::usleep(static_cast<useconds_t>(random.uniform(1000, 25000)));
      ::kill(child, SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ended = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    // A part of a row, as a kill in the middle of writing would leave it.
    if (!ended && kills % 4 == 0 && std::filesystem::exists(killed.path / "calibration.csv"))
      std::ofstream(killed.path / "calibration.csv", std::ios::app) << "7,3,0,prop";
  }
  CHECK(kills > 5);
  const std::string a = without_times(content(whole.path / "calibration.csv"));
  CHECK(std::count(a.begin(), a.end(), '\n') > 20);
  CHECK(a == without_times(content(killed.path / "calibration.csv")));
  CHECK(work(killed.path) == expected);
}

TEST_CASE("calibrate: goes on with a larger budget; a finished one makes no more runs") {
  Folder folder("budget");
  std::size_t runs = 0;
  const auto with = [&](std::size_t budget) {
    Calibration cal{
        {.folder = folder.path, .budget = budget, .least_gain = 0, .patience = 0}, two(), angles()};
    runs = 0;
    const auto& r = cal.run([&](const Values& p, std::uint64_t seed) {
      ++runs;
      return scene(p, seed);
    });
    CHECK(has(r.why, text("Stopped at the budget of ", budget, " runs").c_str()));
    return r.runs.size();
  };
  CHECK(with(14) == 14);
  CHECK(runs == 14);
  CHECK(with(14) == 14);
  CHECK(runs == 0);
  CHECK(with(20) == 20);
  CHECK(runs == 6);
}

TEST_CASE("calibrate: a folder of other settings is refused, with what differs") {
  Folder folder("other");
  const auto options = [&] { return CalibrationOptions{.folder = folder.path, .budget = 12}; };
  Calibration{options(), two(), angles()}.run(scene);
  const auto again = [&](const CalibrationOptions& o, auto parameters, auto targets) {
    return refusal([&] { Calibration{o, parameters, targets}.run(scene); });
  };
  auto parameters = two();
  parameters[1].most = 0.7;
  CHECK(
      has(again(options(), parameters, angles()),
          "another calibration, with 'parameter friction [-], from 0.1 to 0.8' where this one has "
          "'parameter friction [-], from 0.1 to 0.7'; choose another folder"));
  auto targets = angles();
  targets[0].error = 2;
  CHECK(has(again(options(), two(), targets), "error 0.5' where this one has"));
  targets.pop_back();
  CHECK(has(again(options(), two(), targets), "another calibration"));
  auto seed = options();
  seed.seed = 5;
  CHECK(has(again(seed, two(), angles()), "seed 1' where this one has"));
  // Files that are damaged.
  const auto csv = folder.path / "calibration.csv";
  const std::string good = content(csv);
  const auto damaged = [&](const std::string& with) {
    std::ofstream(csv) << with;
    return again(options(), two(), angles());
  };
  CHECK(has(damaged("a,b\n1,2\n"), "does not begin with the columns of this calibration"));
  CHECK(has(damaged(good + "12,what\n"), "is not a run of this calibration; remove it"));
  const auto second = good.find('\n', good.find('\n') + 1);
  CHECK(has(damaged(good.substr(0, second + 1) + "1,7,0,design,0.5,0.5,1,1,1,1,\n"),
            "row 1 is of point 7, repeat 0 in place of point 1, repeat 0"));
  std::ofstream(csv) << good;
  std::filesystem::remove(folder.path / "settings.txt");
  CHECK(has(again(options(), two(), angles()), "has a calibration.csv but no settings.txt"));
}

TEST_CASE("calibrate: two programs in one folder are refused") {
  Folder folder("two");
  Calibration cal{{.folder = folder.path, .budget = 12}, two(), angles()};
  std::string sentence;
  cal.run([&](const Values& p, std::uint64_t seed) {
    if (sentence.empty())
      sentence = refusal([&] {
        Calibration{{.folder = folder.path, .budget = 12}, two(), angles()}.run(scene);
      });
    return scene(p, seed);
  });
  CHECK(has(sentence, "another program calibrates in"));
}

TEST_CASE("calibrate: what makes no sense is refused in one sentence") {
  const auto with = [](auto change) {
    CalibrationOptions options;
    auto parameters = two();
    auto targets = angles();
    change(options, parameters, targets);
    return refused(options, parameters, targets);
  };
  CHECK(has(with([](auto&, auto& p, auto&) { p.clear(); }), "there are no parameters to find"));
  CHECK(has(with([](auto&, auto&, auto& t) { t.clear(); }), "there are no targets to reach"));
  CHECK(has(with([](auto&, auto& p, auto&) { p[0].least = 0.9; }),
            "parameter 'restitution [-]' has bounds 0.9 and 0.9; the first must be smaller"));
  CHECK(
      has(with([](auto&, auto& p, auto&) { p[0].most = std::nan(""); }), "has bounds 0.3 and nan"));
  CHECK(has(with([](auto&, auto& p, auto&) { p[0].least = 0, p[0].logarithmic = true; }),
            "is logarithmic, hence its bound least = 0 must be above 0"));
  CHECK(has(with([](auto&, auto& p, auto&) { p[1].name = "restitution [-]"; }),
            "two parameters or targets are named 'restitution [-]'"));
  CHECK(has(with([](auto&, auto& p, auto&) { p[1].name = ""; }), "needs a name"));
  CHECK(
      has(with([](auto&, auto&, auto& t) { t[0].error = 0; }), "target 'angle [deg]': error = 0"));
  CHECK(has(with([](auto&, auto&, auto& t) { t[0].measured = std::nan(""); }),
            "measured = nan must be finite"));
  CHECK(has(with([](auto& o, auto&, auto&) { o.repeats = 0; }),
            "repeats = 0 [-] must be at least 1"));
  CHECK(has(with([](auto& o, auto&, auto&) { o.design = 4; }),
            "design = 4 [-] must be at least 5 for 2 parameters"));
  CHECK(has(with([](auto& o, auto&, auto&) { o.budget = 10; }),
            "budget = 10 [-] is less than the 11 runs of the design and the confirmation"));
  CHECK(has(with([](auto& o, auto&, auto&) { o.credible = 1; }), "credible = 1 [-] must be in"));
  CHECK(has(with([](auto& o, auto&, auto&) { o.least_gain = -1; }),
            "least_gain = -1 [-] must be finite and not"));
  Calibration cal{{}, two(), angles()};
  CHECK(has(refusal([&] { cal.run(nullptr); }), "there is no scene"));
  CHECK(has(refusal([&] { cal.write(); }), "nothing to write before run()"));
  CHECK(has(refusal([&] { cal.run([](const Values&, std::uint64_t) {
                            return Values{1, 2, 3};
                          }); }),
            "the scene returned 3 values for 2 targets; it must return one for each"));
  const auto throws = [](const Values&, std::uint64_t) -> Values {
    throw std::runtime_error("no gate");
  };
  CHECK(has(refusal([&] { cal.run(throws); }),
            "all 10 runs of the design failed; the first: no gate"));
  Calibration small{{.budget = 14}, two(), angles()};
  std::size_t n = 0;
  const auto seldom = [&](const Values& p, std::uint64_t seed) {
    if (n++ % 10 != 0) throw std::runtime_error("no gate");
    return scene(p, seed);
  };
  CHECK(has(refusal([&] { small.run(seldom); }), "only 2 of 14 points have runs that succeed"));
  small.run(scene);
  CHECK(has(refusal([&] { small.write(); }), "CalibrationOptions.folder is empty"));
}

TEST_CASE("calibrate: notes tell what the values are worth") {
  // Two parameters of which the outputs know the sum alone, and a target that cannot be reached.
  const auto sum = [](const Values& p, std::uint64_t) { return Values{p[0] + p[1]}; };
  const std::vector<CalibrationParameter> ab{{.name = "a", .least = 0, .most = 1},
                                             {.name = "b", .least = 0, .most = 1}};
  Calibration cal{{.budget = 20}, ab, {{.name = "sum", .measured = 1, .error = 0.02}}};
  cal.run(sum);
  CHECK(has(cal.table(), "a is not determined by these targets"));
  CHECK(has(cal.table(), "a and b are known together only (correlation -"));
  Calibration far{{.budget = 20}, ab, {{.name = "sum", .measured = 3, .error = 0.02}}};
  far.run(sum);
  CHECK(has(far.table(), "no values within the bounds reproduce the measurements"));
  CHECK(has(far.table(), "a is recommended at its bound 1"));
}

TEST_CASE("calibrate: leaves a table, JSON, points of the posterior and, with Python, a picture") {
  Folder folder("files");
  Calibration cal{{.folder = folder.path, .budget = 14}, two(), angles()};
  const auto& r = cal.run(scene);
  const std::string words = cal.write();
  CHECK(has(words, "table.txt, calibration.csv, calibration.json, posterior.csv"));
  CHECK(content(folder.path / "table.txt") == cal.table());
  CHECK(has(content(folder.path / "calibration.json"), "\"recommended\": "));
  const std::string posterior = content(folder.path / "posterior.csv");
  CHECK(static_cast<std::size_t>(std::count(posterior.begin(), posterior.end(), '\n')) ==
        r.samples.size() + 1);
  // Of two parameters, and of one with outputs that meet the target to all digits.
  Calibration one{{.folder = folder.path / "one", .budget = 12},
                  {{.name = "E [Pa]", .least = 1e5, .most = 1e9, .logarithmic = true}},
                  {{.name = "time [s]", .measured = 1, .error = 0.05}}};
  one.run([](const Values& p, std::uint64_t) { return Values{std::pow(p[0] / 1e7, -0.2)}; });
  const std::string of_one = one.write();
  // Compiled with a relative path and run elsewhere, a program does not find its script.
  if (!std::filesystem::exists(silt::detail::calibration_script())) return;
  bool python = false;
  for (const char* name : {"python3", "/usr/bin/python3"})
    python = python ||
             std::system(text(name, " -c 'import numpy, matplotlib' 2>/dev/null").c_str()) == 0;
  if (!python) return;
  CHECK(has(words, ": calibration.png, table.txt"));
  CHECK(has(of_one, ": calibration.png, table.txt"));
  CHECK(std::filesystem::file_size(folder.path / "calibration.png") > 10000);
}

}  // namespace calibrate_test
