// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include <silt/study/study.hpp>

#include "near.hpp"

namespace study_test {

namespace {

using namespace silt;

/// A clock that stands still unless somebody works.
struct FakeClock {
  double seconds = 0;
  void work(double s) { seconds += s; }
  StudyOptions options(std::size_t repeats = 5, double least_time = 0) {
    return {.repeats = repeats, .least_time = least_time, .clock = {"fake time", [this] {
                                                                      return seconds;
                                                                    }}};
  }
};

/// A variant of fixed cost and error.
Study::Variant costs(FakeClock& clock, double cost, double error) {
  return [&clock, cost, error](StudyRun& run) {
    clock.work(1000);  // what is not timed costs nothing
    run.time([&] { clock.work(cost); });
    run.error("miss", error, "mm");
  };
}

/// The sentence of the InputError that running the study throws.
std::string refusal(Study& study, const StudyOptions& options) {
  try {
    study.run(options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
bool has(const std::string& sentence, const std::string& words) {
  INFO(sentence);
  const bool found = sentence.find(words) != std::string::npos;
  CHECK(found);
  return found;
}

std::string content(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

/// A folder of this test alone, gone at its end.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "silt_test_study";
  Folder() { std::filesystem::remove_all(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

}  // namespace

TEST_CASE("study: rounds go through all variants, forth and back by turns") {
  FakeClock clock;
  std::string order;
  Study study("order");
  for (const char* name : {"a", "b", "c"})
    study.variant(name, [&, name](StudyRun& run) {
      order += name;
      run.time([&] { clock.work(1); });
      run.error("miss", 1);
    });
  auto options = clock.options(3);
  std::string watched;
  options.watch = [&](std::size_t round, const std::string& variant) {
    watched += text(round, variant);
    CHECK(watched.size() == 2 * order.size() + 2);  // before it runs
  };
  study.run(options);
  CHECK(order == "abccbaabc");
  CHECK(watched == "0a0b0c1c1b1a2a2b2c");
}

TEST_CASE("study: a cost is the median of the rounds, the spread their range over it") {
  FakeClock clock;
  const double seconds[] = {3, 100, 2, 4, 1};
  int round = 0;
  Study study("median");
  study.variant("one", [&](StudyRun& run) {
    const double s = seconds[round++];
    run.time([&] { clock.work(s / 2); });
    run.time([&] { clock.work(s / 2); });  // timed parts add up
    run.error("miss", 1);
  });
  const auto& row = study.run(clock.options(5)).rows[0];
  CHECK(row.costs == std::vector<double>{3, 100, 2, 4, 1});
  CHECK(row.cost() == 3);
  CHECK(row.spread() == 33);
  CHECK(row.least_cost() == 1);
  CHECK(row.greatest_cost() == 100);
  round = 0;
  CHECK(study.run(clock.options(4)).rows[0].cost() == 3.5);  // between 3 and 4
}

TEST_CASE("study: a short run is repeated until a round has been timed for long enough") {
  FakeClock clock;
  Study study("short");
  study.variant("short", costs(clock, 0.25, 1));
  study.variant("long", costs(clock, 8, 1));
  auto options = clock.options(2, 1.0);
  const auto& results = study.run(options);
  CHECK(results.rows[0].runs == 8);
  CHECK(results.rows[1].runs == 2);
  CHECK(results.rows[0].cost() == 0.25);
  options.most_runs = 3;
  CHECK(study.run(options).rows[0].runs == 6);
}

TEST_CASE("study: errors are those of the first run; a function for them is called once") {
  FakeClock clock;
  int measured = 0, runs = 0;
  Study study("once");
  study.variant("one", [&](StudyRun& run) {
    run.time([&] { clock.work(1); });
    run.error("signed", -3.0 - runs++, "mm");
    run.error(
        "dear", [&] { return ++measured; }, "s");
  });
  const auto& row = study.run(clock.options(4)).rows[0];
  CHECK(measured == 1);
  CHECK(runs == 4);
  CHECK(row.error("signed")->value == 3);
  CHECK(row.error("dear")->value == 1);
  CHECK(row.error("dear")->unit == "s");
}

TEST_CASE("study: values are compared with those of the reference, numbers and profiles") {
  FakeClock clock;
  int reference_runs = 0;
  Study study("reference");
  const auto scene = [&](double height, std::vector<double> profile, int* runs) {
    return [&clock, height, profile, runs](StudyRun& run) {
      if (runs) ++*runs;
      run.time([&] { clock.work(1); });
      run.value("height", height, "m");
      run.value("profile", profile);
    };
  };
  study.reference("fine", scene(-2, {3, 4, 0}, &reference_runs));
  study.variant("coarse", scene(-2.5, {3, 4, 0.5}, nullptr));
  study.variant("exact", scene(-2, {3, 4, 0}, nullptr));
  const auto& results = study.run(clock.options());
  CHECK(reference_runs == 1);
  CHECK(results.rows[0].error("error of height")->value == 0.25);
  CHECK(results.rows[0].error("error of profile")->value == near(0.1).epsilon(1e-15));
  CHECK(results.rows[0].note("height")->value == -2.5);
  CHECK(results.rows[1].error("error of height")->value == 0);
  CHECK(results.reference->error("error of profile")->value == 0);
}

TEST_CASE("study: recommended is the cheapest that keeps all bounds") {
  FakeClock clock;
  Study study("bounds");
  const auto both = [&](double cost, double miss, double drift) {
    return [&clock, cost, miss, drift](StudyRun& run) {
      run.time([&] { clock.work(cost); });
      run.error("miss", miss, "mm");
      run.error("drift", drift, "%");
    };
  };
  study.variant("cheap", both(1, 0.1, 9));
  study.variant("good", both(2, 0.2, 0.9));
  study.variant("better", both(3, 0.01, 0.1));
  study.accept("miss", 0.2);
  study.accept("drift", 1);
  CHECK(study.run(clock.options()).recommended == 1);
  has(study.results().why,
      "good, the cheapest of which miss is at most 0.2 mm and drift is at most 1 %.");
  study.accept("drift", 0.01);
  CHECK_FALSE(study.run(clock.options()).recommended);
  has(study.results().why, "Nothing is recommended");
}

TEST_CASE("study: a control stands in the table and is neither recommended nor on the front") {
  FakeClock clock;
  Study study("control");
  study.variant("a", costs(clock, 2, 0.1));
  study.control("c", costs(clock, 1, 0.01));
  study.accept("miss", 0.5);
  CHECK(study.run(clock.options()).recommended == 0);
  CHECK(study.results().front("miss") == std::vector<std::size_t>{0});
  has(study.table(), "\nc  c          ");
  has(study.table(), ", c a control\n");
  const Folder folder;
  study.write(folder.path.string());
  has(content(folder.path / "table.csv"), ",control,\n");
  has(content(folder.path / "summary.json"), "\"name\": \"c\", \"control\": true");
  Study alone("alone");
  alone.control("c", costs(clock, 1, 1));
  has(refusal(alone, clock.options()), "there are no variants");
}

TEST_CASE("study: what costs the same within the spread is named") {
  FakeClock clock;
  int run_of_b = 0;
  Study study("near");
  study.variant("a", costs(clock, 1, 0.1));
  study.variant("b", [&](StudyRun& run) {
    const double s = run_of_b++ % 3 == 0 ? 1 : 1.1;
    run.time([&] { clock.work(s); });
    run.error("miss", 0.1, "mm");
  });
  study.variant("c", costs(clock, 1.05, 0.1));
  study.accept("miss", 0.5);
  CHECK(study.run(clock.options(3)).recommended == 0);
  has(study.results().why, "within the spread of the rounds: b.");
}

TEST_CASE("study: without bounds the knee of the front is recommended, if there is one") {
  FakeClock clock;
  Study bent("bent");
  bent.variant("a", costs(clock, 1, 1));
  bent.variant("b", costs(clock, 2, 0.01));
  bent.variant("c", costs(clock, 100, 0.009));
  bent.variant("d", costs(clock, 50, 2));
  CHECK(bent.run(clock.options()).recommended == 1);
  CHECK(bent.results().front("miss") == std::vector<std::size_t>{0, 1, 2});
  Study straight("straight");
  straight.variant("a", costs(clock, 1, 1));
  straight.variant("b", costs(clock, 10, 0.1));
  straight.variant("c", costs(clock, 100, 0.01));
  CHECK_FALSE(straight.run(clock.options()).recommended);
  has(straight.results().why, "has no knee; accept(\"miss\", limit)");
  Study clear("clear");
  clear.variant("a", costs(clock, 1, 1));
  clear.variant("b", costs(clock, 2, 2));
  CHECK(clear.run(clock.options()).recommended == 0);
}

TEST_CASE("study: a variant that fails stands in the table with its sentence, others go on") {
  FakeClock clock;
  Study study("failing");
  int later = 0;
  study.variant("broken", [](StudyRun&) {
    throw SimulationError("step 3: the time step is above its limit", 3, {}, {});
  });
  study.variant("sound", costs(clock, 1, 0.5));
  study.variant("not a number", costs(clock, 1, std::nan("")));
  study.variant("later", [&](StudyRun& run) {
    if (later++ == 2) throw InputError("full");
    costs(clock, 1, 0.5)(run);
  });
  const auto& results = study.run(clock.options(4));
  CHECK(results.rows[0].failure == "step 3: the time step is above its limit");
  CHECK(results.rows[1].runs == 4);
  CHECK(results.rows[2].failure == "its miss = nan [mm] is not finite");
  CHECK(results.rows[3].failure == "full");
  CHECK(results.recommended == 1);
  has(study.table(), "broken failed: step 3: the time step is above its limit\n");
  study.variant("no file", [](StudyRun&) { throw std::runtime_error("no file"); });
  CHECK(study.run(clock.options()).rows.back().failure == "no file");
  // A bug is not taken for a result.
  study.variant("bug", [](StudyRun&) { throw std::logic_error("bug"); });
  CHECK_THROWS_AS(study.run(clock.options()), std::logic_error);
}

TEST_CASE("study: when every variant fails there is a table, a summary and no recommendation") {
  Study study("hopeless");
  study.variant("a", [](StudyRun&) { throw InputError("too soft"); });
  CHECK_FALSE(study.run().recommended);
  has(study.results().why, "every variant failed");
  const Folder folder;
  has(study.write(folder.path.string()), "no picture");
  has(content(folder.path / "table.csv"), "a,,,,0,0,0,0,variant,too soft\n");
  CHECK_FALSE(std::filesystem::exists(folder.path / "pareto.png"));
}

TEST_CASE("study: what makes no sense is refused with a sentence") {
  FakeClock clock;
  const auto options = clock.options();
  Study empty("empty");
  has(refusal(empty, options), "study 'empty': there are no variants");
  CHECK_THROWS_AS(empty.write("/nowhere"), InputError);
  Study study("s");
  study.variant("a", costs(clock, 1, 1));
  CHECK_THROWS_AS(study.variant("a", costs(clock, 1, 1)), InputError);
  CHECK_THROWS_AS(study.variant("", costs(clock, 1, 1)), InputError);
  CHECK_THROWS_AS(study.variant("none", nullptr), InputError);
  CHECK_THROWS_AS(study.accept("miss", -1), InputError);
  CHECK_THROWS_AS(study.accept("miss", std::numeric_limits<double>::infinity()), InputError);
  has(refusal(study, clock.options(0)), "repeats = 0");
  auto none = options;
  none.most_runs = 0;
  has(refusal(study, none), "most_runs = 0");
  has(refusal(study, clock.options(1, std::nan(""))), "least_time");
  study.reference("fine", costs(clock, 1, 1));
  CHECK_THROWS_AS(study.reference("finer", costs(clock, 1, 1)), InputError);

  const auto one = [&](const std::string& words, const Study::Variant& function,
                       const Study::Variant& reference = nullptr) {
    Study s("one");
    s.variant("v", function);
    if (reference) s.reference("fine", reference);
    has(refusal(s, options), words);
  };
  const auto work = [&](StudyRun& run) { run.time([&] { clock.work(1); }); };
  one("measures no time", [&](StudyRun& run) { run.error("miss", 1); });
  one("takes less time than 'fake time' can measure", costs(clock, 0, 1));
  one("reports no error", work);
  one("two numbers named 'x'",
      [&](StudyRun& run) { work(run), run.error("x", 1), run.note("x", 1); });
  const auto height = [&](double h) {
    return [&, h](StudyRun& run) { work(run), run.value("height", h, "m"); };
  };
  one("has nothing to compare with", height(1));
  one("the reference 'fine' has no value 'height', which 'v' has", height(1), costs(clock, 1, 1));
  one("'height' of the reference is 0", height(1), height(0));
  one("'height' of the reference is not finite", height(1), height(std::nan("")));
  one("its reference 'fine' failed: no", height(1), [](StudyRun&) { throw InputError("no"); });
  const auto profile = [&](std::size_t n) {
    return [&, n](StudyRun& run) { work(run), run.value("profile", std::vector<double>(n, 1)); };
  };
  one("is 2 numbers in 'v' and 3 in the reference", profile(2), profile(3));

  Study unlike("unlike");
  unlike.variant("a", costs(clock, 1, 1));
  unlike.variant("b", [&](StudyRun& run) { work(run), run.error("other", 1); });
  has(refusal(unlike, options), "'b' gives other errors than 'a'");
  Study bound("bound");
  bound.variant("a", costs(clock, 1, 1));
  bound.accept("hit", 1);
  has(refusal(bound, options), "accept() names the error 'hit', but there is miss");
}

TEST_CASE("study: the table and the CSV hold the numbers, names with commas in quotes") {
  FakeClock clock;
  Study study("tables");
  study.variant("a, \"soft\"", costs(clock, 0.002, 0.125));
  study.variant("b", [&](StudyRun& run) {
    costs(clock, 0.004, 0.0625)(run);
    run.note("steps", 40);
  });
  study.accept("miss", 0.1);
  study.run(clock.options(1));
  CHECK(study.table() ==
        "tables\n"
        "   variant    cost [ms]  spread  miss [mm]  steps [-]\n"
        "+  a, \"soft\"          2       -      0.125          -\n"
        "*  b                  4       -     0.0625         40\n"
        "cost: fake time of one run, median of 1 round; spread: of the rounds, "
        "(largest - smallest)/median\n"
        "* recommended, + on the front of cost and miss\n"
        "Recommended: b, the cheapest of which miss is at most 0.1 mm.\n");
  const Folder folder;
  study.write(folder.path.string());
  const auto csv = content(folder.path / "table.csv");
  has(csv, "miss [mm],steps [-],on the front [-],recommended [-],kind,failure\n");
  has(csv, "\n\"a, \"\"soft\"\"\",");
  has(csv, ",1,1,0.125,,1,0,variant,\n");
  has(csv, ",1,1,0.0625,40,1,1,variant,\n");
  const auto json = content(folder.path / "summary.json");
  has(json, "\"name\": \"a, \\\"soft\\\"\"");
  has(json, "\"recommended\": \"b\"");
  has(json, "\"accepted\": {\"miss\": 0.1}");
  has(json, "\"fronts\": {\"miss\": [\"a, \\\"soft\\\"\", \"b\"]}");
  CHECK(content(folder.path / "table.txt") == study.table());
}

TEST_CASE("study: the picture is drawn, or its absence is told and the tables are there") {
  FakeClock clock;
  Study study("picture");
  study.variant("a", costs(clock, 1, 1));
  study.variant("b", costs(clock, 2, 0));
  study.run(clock.options());
  const Folder folder;
  const std::string told = study.write(folder.path.string());
  const bool drawn = std::filesystem::exists(folder.path / "pareto.png");
  CHECK(drawn == (told.find("pareto.png,") != std::string::npos));
  if (drawn) CHECK(content(folder.path / "pareto.png").substr(1, 3) == "PNG");
  // With no script there is no picture, and none of an earlier study stays.
  CHECK_FALSE(detail::draw_study(folder.path.string(), "/nowhere/pareto.py"));
  CHECK_FALSE(std::filesystem::exists(folder.path / "pareto.png"));
  CHECK_THROWS_AS(study.write((folder.path / "table.csv" / "below").string()), FileError);
}

TEST_CASE("study: the clocks go forward, and work costs processor time") {
  for (const auto& clock : {processor_time(), wall_time()}) {
    Study study(clock.name);
    study.variant("work", [](StudyRun& run) {
      run.time([] {
        volatile double sum = 0;
        for (int k = 0; k < 100000; ++k) sum = sum + std::sqrt(static_cast<double>(k));
      });
      run.error("miss", 1);
    });
    const auto& row = study.run({.repeats = 3, .least_time = 0.005, .clock = clock}).rows[0];
    CHECK(row.cost() > 1e-6);
    CHECK(row.cost() < 10);
    CHECK(row.cost() * static_cast<double>(row.runs) > 0.005);
  }
}

}  // namespace study_test
