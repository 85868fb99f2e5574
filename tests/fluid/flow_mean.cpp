// silt - BSD-3-Clause, see LICENSE

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

#include <silt/fluid/flow_mean.hpp>

#include "near.hpp"

namespace flow_mean_test {

using silt::FlowMean;
using silt::FlowSolver;
using silt::Grid;

namespace {

constexpr double pi = std::numbers::pi;
const Grid grid({{0, 0, 0}, {0.04, 0.03, 0.02}}, {4, 3, 2});

/// A state of a signal with a period of 1 s.
void set(FlowSolver& flow, double t) {
  const double swing = std::sin(2 * pi * t);
  flow.velocity(0).fill(1 + 0.5 * swing), flow.velocity(1).fill(-2 + std::cos(2 * pi * t));
  flow.velocity(2).fill(3);
  flow.pressure().fill(100 + 40 * swing), flow.voidage().fill(0.6 + 0.1 * swing);
}

}  // namespace

TEST_CASE("means over whole periods are those of the signal, to rounding") {
  for (const int states : {4, 7, 100}) {
    FlowSolver flow(grid, {1.2, 1.8e-5});
    FlowMean mean;
    for (int n = 0; n < 3 * states; ++n) {
      set(flow, (n + 0.3) / states);
      mean.add(flow, 1.0 / states);
    }
    CAPTURE(states);
    CHECK(mean.time() == near(3));
    const auto u = mean.velocity(2, 1, 1), rms = mean.velocity_rms(2, 1, 1);
    CHECK(u.x == near(1).epsilon(1e-14));
    CHECK(u.y == near(-2).epsilon(1e-14));
    CHECK(u.z == near(3).epsilon(1e-14));
    CHECK(rms.x == near(0.5 / std::sqrt(2)).epsilon(1e-13));
    CHECK(rms.y == near(1 / std::sqrt(2)).epsilon(1e-13));
    CHECK(rms.z < 1e-7);
    CHECK(mean.pressure(0, 0, 0) == near(100).epsilon(1e-14));
    CHECK(mean.pressure_rms(0, 0, 0) == near(40 / std::sqrt(2)).epsilon(1e-13));
    CHECK(mean.voidage(3, 2, 1) == near(0.6).epsilon(1e-14));
    // Voidage and velocity swing together: <eps u> = <eps><u> + 0.1 0.5/2.
    CHECK(mean.superficial(1, 1, 1).x == near(0.6 + 0.025).epsilon(1e-14));
  }
}

TEST_CASE("states count by the time for which they stand") {
  FlowSolver flow(grid, {1.2, 1.8e-5});
  FlowMean mean;
  CHECK_THROWS_AS(mean.pressure(0, 0, 0), silt::InputError);
  flow.pressure().fill(10), mean.add(flow, 3);
  flow.pressure().fill(1e9), mean.add(flow, 0);
  flow.pressure().fill(50), mean.add(flow, 1);
  CHECK(mean.pressure(1, 1, 1) == near(20));
  CHECK(mean.pressure_rms(1, 1, 1) == near(std::sqrt(0.75 * 100 + 0.25 * 900)));
  CHECK_THROWS_AS(mean.add(flow, -1), silt::InputError);
  FlowSolver other(Grid({{0, 0, 0}, {1, 1, 1}}, {2, 2, 2}), {1.2, 1.8e-5});
  CHECK_THROWS_AS(mean.add(other, 1), silt::InputError);
}

TEST_CASE("a mean is written for ParaView and as a plane, with and without the fluid's weight") {
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "silt_mean_XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  FlowSolver flow(grid, {1000, 1e-3});
  FlowMean mean;
  set(flow, 0.1), mean.add(flow, 1);
  const auto content = [](const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  mean.write(folder + "/without.vti");
  mean.write(folder + "/with.vti", silt::FluidWeight{{0, 0, -10}, {0, 0, 0.02}});
  for (const char* name : {"mean_velocity", "rms_velocity", "mean_superficial_velocity",
                           "mean_pressure", "rms_pressure", "mean_voidage", "open"}) {
    CHECK(content(folder + "/without.vti").find(std::string("Name=\"") + name + '"') !=
          std::string::npos);
  }
  const std::string words = "Name=\"mean_pressure_with_weight\"",
                    whole = content(folder + "/with.vti");
  CHECK(content(folder + "/without.vti").find(words) == std::string::npos);
  REQUIRE(whole.find(words) != std::string::npos);
  // It is the last array: of the last cell, 5 mm below the surface, 50 Pa more.
  double last;
  const auto end = whole.rfind("\n</AppendedData>");
  REQUIRE(end != std::string::npos);
  std::memcpy(&last, whole.data() + end - sizeof last, sizeof last);
  CHECK(last == near(mean.pressure(3, 2, 1) + 50));

  mean.write_plane(folder + "/plane.csv", 1, 0.016);
  std::ifstream plane(folder + "/plane.csv");
  std::string head, row;
  std::getline(plane, head);
  CHECK(head.find("x [m],z [m],mean velocity x [m/s]") == 0);
  CHECK(head.find("mean pressure without weight [Pa]") != std::string::npos);
  int rows = 0;
  while (std::getline(plane, row)) ++rows;
  CHECK(rows == 4 * 2);
  CHECK_THROWS_AS(mean.write_plane(folder + "/plane.csv", 3, 0), silt::InputError);
  CHECK_THROWS_AS(mean.write("/nowhere/at/all.vti"), silt::FileError);
  fs::remove_all(folder);
}

}  // namespace flow_mean_test
