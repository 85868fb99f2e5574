// silt - BSD-3-Clause, see LICENSE
// Probes, pressure taps, profiles and means of the flow in a Simulation, and inflows in time there.
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/ergun.hpp>
#include <silt/coupling/formulas.hpp>
#include <silt/io/flow_observers.hpp>
#include <silt/search/nbs.hpp>
#include <silt/shape/sphere.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace flow_observers_test {

using silt::every;
using silt::FlowSolver;
using silt::Grid;
using silt::Inflow;
using silt::Particles;
using silt::Sphere;
using silt::Vec3d;

namespace {

namespace fs = std::filesystem;
constexpr double pi = std::numbers::pi;
constexpr silt::FluidProperties air{1.2, 1.8e-5};
constexpr silt::HertzMindlin::Material glass{
    .youngs_modulus = 1e6, .poisson_ratio = 0.3, .restitution = 0.8, .friction = 0.3};

struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_flow_observers_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

/// Columns of a table by their names.
std::map<std::string, std::vector<double>> columns(const std::string& path) {
  std::ifstream in(path);
  std::string line, word;
  REQUIRE(std::getline(in, line));
  std::vector<std::string> names;
  for (std::istringstream s(line); std::getline(s, word, ',');) names.push_back(word);
  std::map<std::string, std::vector<double>> all;
  while (std::getline(in, line)) {
    std::size_t k = 0;
    for (std::istringstream s(line); std::getline(s, word, ',');)
      all[names.at(k++)].push_back(std::stod(word));
    REQUIRE(k == names.size());
  }
  return all;
}
const std::vector<double>& at(const std::map<std::string, std::vector<double>>& all,
                              const std::string& name) {
  CAPTURE(name);
  REQUIRE(all.count(name) == 1);
  return all.at(name);
}

auto simulation(Particles<Sphere> grains, FlowSolver flow) {
  return silt::Simulation{std::move(grains), silt::Contacts<silt::HertzMindlin>{glass},
                          silt::CoupledFlow{silt::Ergun{}, silt::Kernel{}, std::move(flow)}};
}
using Sim = decltype(simulation({}, std::declval<FlowSolver>()));

constexpr double d = 1e-3, a = 1.02 * d, U = 0.4;
constexpr int across = 8, layers = 16;
constexpr double width = across * a, height = 3 * layers * a;

/// Grains at rest in the middle third of a column that gas rises through.
Sim bed() {
  FlowSolver flow(Grid({{0, 0, 0}, {width, width, height}}, {4, 4, 24}, {true, true, false}), air);
  flow.set_side(2, 0, Inflow{{0, 0, U}});
  flow.set_side(2, 1, silt::Outflow{});
  Particles<Sphere> grains;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        grains.add({.position = {(i + 0.5) * a, (j + 0.5) * a, (layers + k + 0.5) * a},
                    .radius = 0.5 * d,
                    .density = 2500,
                    .fixed = true});
  Sim sim = simulation(std::move(grains), flow);
  sim.time_step = 2e-5;
  sim.gravity = {0, 0, -9.81};
  return sim;
}
/// A column without friction whose inflow swings with a period of 20 ms about 0.3 m/s; with grains
/// that fall in it, or none.
constexpr double mean_speed = 0.3, swing = 0.2, period = 0.02;
double speed_at(double t) { return mean_speed + swing * std::sin(2 * pi * t / period); }
Sim swinging(bool with_grains) {
  FlowSolver flow(Grid({{0, 0, 0}, {0.01, 0.01, 0.03}}, {4, 4, 12}), air, {.tolerance = 1e-10});
  for (const int e : {0, 1})
    for (const int end : {0, 1}) flow.set_side(e, end, silt::FreeSlip{});
  flow.set_side(2, 0, Inflow{.velocity_in_time = [](const Vec3d&, double t) {
                  return Vec3d{0, 0, speed_at(t)};
                }});
  flow.set_side(2, 1, silt::Outflow{});
  Particles<Sphere> grains;
  for (int n = 0; n < (with_grains ? 30 : 0); ++n)
    grains.add(
        {.position = {0.002 + 0.002 * (n % 3), 0.002 + 0.002 * (n / 3 % 3), 0.01 + 0.002 * (n / 9)},
         .radius = 0.5e-3,
         .density = 300});
  Sim sim = simulation(std::move(grains), flow);
  sim.time_step = with_grains ? 1e-5 : 1e-4, sim.fluid().steps = with_grains ? 10 : 1;
  sim.gravity = {0, 0, -9.81};
  return sim;
}
template <class Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const silt::InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace

TEST_CASE("pressure taps in a packed bed read Ergun's pressure drop") {
  // Catches a drop of another sign or per layer, taps that are a cell off, and weight counted
  // twice.
  Folder out;
  Sim sim = bed();
  const double low = 1.3 * height / 3, high = 1.7 * height / 3;
  const std::vector<silt::PressureTap> taps{{"low", {0, 0, low}, 2}, {"high", {0, 0, high}, 2}},
      points{{"low", {0.3 * width, 0.6 * width, low}}, {"high", {0.3 * width, 0.6 * width, high}}};
  const silt::FlowOutput with_weight{.weight_from = Vec3d{0, 0, height}};
  sim.run(0.02, silt::pressure_taps(out / "taps.csv", taps, every(0.02)),
          silt::pressure_taps(out / "points.csv", points, every(0.02)),
          silt::pressure_taps(out / "whole.csv", taps, every(0.02), with_weight));
  const double eps = 1 - pi / 6 * d * d * d / (a * a * a);
  const double ergun =
      silt::ergun_pressure_gradient(eps, d, air.density, air.viscosity, U) * (high - low);
  const char* const drop = "drop from low to high [Pa]";
  const auto rings = columns(out / "taps.csv");
  CHECK(at(rings, "time [s]").size() == 2);
  // Where the kernel sees neither end of the bed its voidage is the lattice's to 0.5 %, and Ergun's
  // drop goes with about eps^-3.
  CHECK(at(rings, drop).back() == near(ergun).epsilon(0.02));
  CHECK(at(rings, "low pressure without weight [Pa]").back() -
            at(rings, "high pressure without weight [Pa]").back() ==
        near(at(rings, drop).back()).epsilon(1e-12));
  CHECK(at(columns(out / "points.csv"), drop).back() == near(ergun).epsilon(0.03));
  // With its weight the gas below presses by rho g (high - low) more.
  const auto whole = columns(out / "whole.csv");
  CHECK(at(whole, drop).back() - at(rings, drop).back() ==
        near(air.density * 9.81 * (high - low)).epsilon(1e-9));
  CHECK(at(whole, "high pressure with weight [Pa]").back() -
            at(rings, "high pressure without weight [Pa]").back() ==
        near(air.density * 9.81 * (height - high)).epsilon(1e-9));
}

TEST_CASE("a profile through the bed: a file a time, voidage and a falling pressure") {
  Folder out;
  Sim sim = bed();
  sim.run(0.01, silt::flow_profile(out / "", "axis", {width / 2, width / 2, 0},
                                   {width / 2, width / 2, height}, 49, every(0.01)));
  const auto start = columns(out / "axis_000000000.csv"), end = columns(out / "axis_000000500.csv");
  CHECK(at(start, "distance [m]").size() == 49);
  const auto& p = at(end, "pressure without weight [Pa]");
  CHECK(at(end, "distance [m]")[24] == near(height / 2));
  CHECK(at(end, "z [m]")[24] == near(height / 2));
  for (std::size_t k = 18; k < 32; ++k) CHECK(p[k] < p[k - 1]);
  CHECK(at(end, "voidage [-]")[24] == near(1 - pi / 6 / std::pow(1.02, 3)).epsilon(0.02));
  CHECK(at(end, "voidage [-]")[2] == near(1));
  CHECK(at(end, "velocity z [m/s]")[2] == near(U).epsilon(1e-6));
}

TEST_CASE(
    "an inflow in time: probes read it at the flow's time, the mean is that of whole periods") {
  Folder out;
  Sim sim = swinging(false);
  auto mean = silt::flow_average(out / "mean", every(1e-3), {.from = 0.02, .plane_across = 0});
  sim.fluid().weight_from = Vec3d{0, 0, 0.03};
  sim.run(0.08, mean,
          silt::flow_probes(out / "probes.csv", {{"axis", {0.005, 0.005, 0.02}}}, every(1e-3)),
          silt::vtk_series(out / "vtk", every(0.08)));
  const auto probes = columns(out / "probes.csv");
  const auto &t = at(probes, "time of the flow [s]"), &w = at(probes, "axis velocity z [m/s]");
  CHECK(w.size() == 81);
  // The plug follows to the pressure's tolerance. A flow that takes the inflow of the particles'
  // time, half a step off, would be wrong by 1 % of the swing.
  for (std::size_t k = 0; k < w.size(); ++k) CHECK(std::abs(w[k] - speed_at(t[k])) < 1e-7);
  // 20 states a period, three periods: to rounding of the flow.
  CHECK(mean.mean().time() == near(0.06));
  CHECK(mean.mean().velocity(1, 2, 6).z == near(mean_speed).epsilon(1e-7));
  CHECK(mean.mean().velocity_rms(1, 2, 6).z == near(swing / std::sqrt(2)).epsilon(1e-6));
  CHECK(columns(out / "mean/mean_flow.csv").at("y [m]").size() == 4 * 12);
  CHECK(fs::exists(out / "mean/mean_flow.vti"));
  std::ifstream vti(out / "vtk/flow_000000800.vti", std::ios::binary);
  const std::string words(std::istreambuf_iterator<char>(vti), {});
  CHECK(words.find("Name=\"pressure_with_weight\"") != std::string::npos);
  CHECK(words.find("Name=\"pressure\"") != std::string::npos);
}

TEST_CASE("with an inflow in time a restart, and any number of threads, give the same bits") {
  Folder out;
  const auto bits = [](const Sim& sim) {
    std::vector<double> all;
    for (std::size_t k = 0; k < sim.rows(); ++k) all.push_back(sim.position(sim.find(k)).z);
    for (int e = 0; e < 3; ++e)
      for (const double u : sim.fluid().flow().velocity(e).values()) all.push_back(u);
    for (const double p : sim.fluid().flow().pressure().values()) all.push_back(p);
    return all;
  };
  const auto table = [&](const char* name) {
    return silt::flow_probes(out / name, {{"axis", {0.005, 0.005, 0.02}}}, every(1e-3));
  };
  Sim whole = swinging(true);
  whole.threads = 3;
  whole.run(0.04, table("whole.csv"));
  Sim first = swinging(true);
  first.threads = 1;
  first.run(0.02, table("parts.csv"));
  silt::save_checkpoint(first, out / "half.silt");
  Sim second = swinging(true);
  silt::load_checkpoint(second, out / "half.silt");
  second.run(0.02, table("parts.csv"));
  CHECK(bits(second) == bits(whole));
  CHECK(columns(out / "parts.csv") == columns(out / "whole.csv"));
}

TEST_CASE("a restart may have another inflow: the flow follows it") {
  Folder out;
  Sim first = swinging(false);
  first.run(0.01);
  silt::save_checkpoint(first, out / "swinging.silt");
  Sim steady = swinging(false);
  steady.fluid().flow().set_side(2, 0, Inflow{.velocity = {0, 0, 0.1}});
  silt::load_checkpoint(steady, out / "swinging.silt");
  steady.run(0.01);
  CHECK(steady.fluid().flow().velocity(2)(2, 2, 6) == near(0.1).epsilon(1e-6));
  // It was "has no field 'fluid.eddy'".
  Sim turbulent = swinging(false);
  turbulent.fluid().flow().set_turbulence(silt::KEpsilon{.width = 0.01, .intensity = 0.05});
  CHECK_THROWS_WITH_AS(
      silt::load_checkpoint(turbulent, out / "swinging.silt"),
      doctest::Contains("turbulence model is 'none' in the file and 'k-epsilon' in the scene"),
      silt::InputError);
}

TEST_CASE("what cannot be measured is refused before the first step") {
  Folder out;
  Sim sim = swinging(false);
  const auto run = [&](auto observer) { return refusal([&] { sim.run(0.01, observer); }); };
  const auto found = [](const std::string& said, const char* words) {
    CAPTURE(said);
    CHECK(said.find(words) != std::string::npos);
  };
  found(run(silt::flow_probes(out / "p.csv", {{"top", {0.005, 0.005, 0.031}}}, every(1e-3))),
        "flow_probes: at 'top', (0.005, 0.005, 0.031) m, there is no fluid");
  found(run(silt::pressure_taps(out / "p.csv", {{"top", {0.005, 0.005, 0.031}}}, every(1e-3))),
        "pressure_taps: at 'top'");
  found(run(silt::pressure_taps(out / "p.csv", {{"ring", {0, 0, 0.031}, 2}}, every(1e-3))),
        "outside the flow's box");
  found(run(silt::flow_profile(out.path, "line", {1, 0, 0}, {2, 0, 0}, 5, every(1e-3))),
        "no fluid on the line");
  found(run(silt::flow_average(out.path, every(1e-3), {.from = 1})), "not before the run's end");
  found(run(silt::flow_average(out.path, every(1e-3), {.plane_across = 3})), "is not 0, 1 or 2");
  found(
      run(silt::flow_probes(
          out / "p.csv", {{"a", {0.005, 0.005, 0.01}}, {"a", {0.005, 0.005, 0.02}}}, every(1e-3))),
      "two columns named");
  found(refusal([&] { silt::flow_probes(out / "p.csv", {}, every(1e-3)); }), "there are no points");
  found(refusal([&] { silt::pressure_taps(out / "p.csv", {}, every(1e-3)); }), "there are no taps");
  found(refusal([&] {
          silt::flow_profile(out.path, "l", {0, 0, 0}, {1, 0, 0}, 1, every(1));
        }),
        "at least 2");
  found(refusal([&] {
          silt::flow_profile(out.path, "l", {0, 0, 0}, {0, 0, 0}, 2, every(1));
        }),
        "have a length");
}

}  // namespace flow_observers_test
