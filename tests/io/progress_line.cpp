// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <silt/io/progress_line.hpp>

namespace progress_line_test {

using silt::progress_line;

TEST_CASE("progress_line: place, speed, overlap and remaining time, in one line") {
  // 29.2 % took 51.6 s, so the remaining 70.8 % take 125.3 s.
  CHECK(progress_line(0.35, 1.2, 1'207'000'000, 51.6, 100'000, 0.0041) ==
        "t = 0.350 of 1.200 s (29 %)  100000 particles  23.4 M particle-steps/s  "
        "largest overlap 0.41 % of radius  2 min 05 s left");
}

TEST_CASE("progress_line: at time 0 nothing is guessed") {
  CHECK(progress_line(0, 1.2, 0, 0, 5, 0) ==
        "t = 0.000 of 1.200 s (0 %)  5 particles  largest overlap 0.00 % of radius  starting");
}

TEST_CASE("progress_line: at the end, and one step beyond, it says how long it took") {
  for (const double time : {1.2, 1.2001})
    CHECK(progress_line(time, 1.2, 1'000'000, 3723, 5, 0).find("(100 %)") != std::string::npos);
  CHECK(progress_line(1.2, 1.2, 1'000'000, 3723, 5, 0).ends_with("done in 1 h 02 min"));
  CHECK(progress_line(0, 0, 0, 0, 5, 0).ends_with("done in 0 s"));
}

TEST_CASE("progress_line: 100 % is shown at the end only") {
  CHECK(progress_line(0.99999, 1, 1, 1, 1, 0).find("(99 %)") != std::string::npos);
  CHECK(progress_line(0.55, 1, 1, 1, 1, 0).find("(55 %)") != std::string::npos);
}

TEST_CASE("progress_line: a continued run is timed from its restart") {
  // From 0.6 s to 0.7 s took 10 s, so 0.3 s more take 30 s.
  CHECK(progress_line(0.7, 1, 1000, 10, 1, 0, 0.6).ends_with("  30 s left"));
  CHECK(progress_line(0.6, 1, 0, 0, 1, 0, 0.6).ends_with("starting"));
}

TEST_CASE("progress_line: speeds and times have the unit that suits them") {
  const auto speed = [](std::uint64_t steps) { return progress_line(1, 2, steps, 1, 1, 0); };
  CHECK(speed(950).find("  950 particle-steps/s") != std::string::npos);
  CHECK(speed(999'700).find("  1.00 M particle-steps/s") != std::string::npos);
  CHECK(speed(9'996).find("  10.0 k particle-steps/s") != std::string::npos);
  CHECK(speed(2'500'000'000).find("  2.50 G particle-steps/s") != std::string::npos);
  const auto left = [](double seconds) { return progress_line(1, 2, 1, seconds, 1, 0); };
  CHECK(left(59.4).ends_with("  59 s left"));
  CHECK(left(59.6).ends_with("  1 min 00 s left"));
  CHECK(left(3599.7).ends_with("  1 h 00 min left"));
  CHECK(left(86400 * 4 + 7200).ends_with("  4 d 02 h left"));
}

TEST_CASE("progress_line: short runs show enough digits of the time") {
  CHECK(progress_line(0.0123, 0.02, 1, 1, 1, 0).starts_with("t = 0.01230 of 0.02000 s (61 %)"));
  CHECK(progress_line(50, 3600, 1, 1, 1, 0).starts_with("t = 50 of 3600 s (1 %)"));
}

TEST_CASE("progress_line: how well the books of a fluid close") {
  struct {
    double volume = 2.22e-16, continuity = 1.4e-9, momentum = 0, clipped = 0.015;
  } most;
  CHECK(silt::closure_line(most) ==
        "fluid, largest error of any step: solid volume 2.2e-16, momentum 0 of the "
        "exchange, continuity 1.4e-09 of a cell; clipped 0.015 of the solid volume");
}

TEST_CASE("progress_line: a liquid's particles are counted beside the others") {
  CHECK(progress_line(0.1, 1, 1000, 10, 3, 0, 0, 5000).find("3 particles, 5000 of liquid  ") !=
        std::string::npos);
}

TEST_CASE("closure_line: of a liquid of particles nothing is said of cells") {
  struct {
    double volume = 1e-16, momentum = 2e-16, continuity = 0, clipped = 0;
  } books;
  CHECK(silt::closure_line(books).find(", continuity 0 of a cell; clipped") != std::string::npos);
  CHECK(silt::closure_line(books, false).find("exchange; clipped 0 of the solid volume") !=
        std::string::npos);
}

}  // namespace progress_line_test
