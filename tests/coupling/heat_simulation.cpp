// silt - BSD-3-Clause, see LICENSE
// Grains of a Simulation that exchange heat with the gas of its CoupledFlow: books of both,
// restart, threads, output; and refusals.
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

#include <doctest/doctest.h>

#include <silt/contact/linear_spring.hpp>
#include <silt/coupling/averaging/kernel.hpp>
#include <silt/coupling/coupled_flow.hpp>
#include <silt/coupling/drag/laws.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/flow_observers.hpp>
#include <silt/module/heat/fluid_convection.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace heat_simulation_test {

using silt::Vec3d;

namespace {

const silt::LinearSpring::Material soft{.stiffness = 200, .restitution = 0.8};
constexpr double L = 0.012;  // [m]

/// Warm grains fall in a closed box of cold gas, and touch each other.
auto scene(bool with_heat = true) {
  silt::FlowSolver air(silt::Grid({{0, 0, 0}, {L, L, L}}, {4, 4, 4}), {1.2, 1.8e-5});
  if (with_heat) air.set_heat({.heat_capacity = 1005, .conductivity = 0.026});
  silt::Particles<silt::Sphere> grains;
  for (int n = 0; n < 60; ++n)
    grains.add({.position = {0.0025 + 0.0022 * (n % 4), 0.0025 + 0.0022 * (n / 4 % 4),
                             0.002 + 0.0021 * (n / 16)},
                .radius = 1e-3 - 2e-6 * n,
                .density = 20,
                .velocity = {0.1 * (n % 3 - 1), 0.05 * (n % 5 - 2), 0}});
  silt::Simulation sim{std::move(grains), silt::Contacts<silt::LinearSpring>{soft},
                       silt::CoupledFlow{silt::Gidaspow{}, silt::Kernel{}, air},
                       silt::Heat{silt::HeatConduction{.conductivity = 1, .heat_capacity = 800},
                                  silt::FluidConvection<silt::Gunn>{}}};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {L, L, L}), soft);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sim.template field<silt::Temperature>(k) = 330 + static_cast<double>(sim.id(k));
  return sim;
}
template <class Sim>
double heat_of(const Sim& sim) {
  double sum = sim.fluid().flow().heat_book().stored;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    sum += sim.mass(k) * 800 * sim.template field<silt::Temperature>(k);
  return sum;
}
template <class Sim>
std::vector<double> temperatures(const Sim& sim) {
  std::vector<double> all;
  for (std::size_t id = 0; id < 60; ++id)
    all.push_back(sim.template field<silt::Temperature>(sim.find(id)));
  const auto values = sim.fluid().flow().temperature().values();
  all.insert(all.end(), values.begin(), values.end());
  return all;
}
std::string first_line(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace

// Catches heat that only one of the two gets, in the first, shorter fluid step too, and what
// contacts conduct besides.
TEST_CASE("heat in a simulation: grains and gas in a closed box keep their heat") {
  auto sim = scene();
  sim.run(1e-4);
  const double first = heat_of(sim) - sim.fluid().flow().heat_book().counted_anew;
  sim.run(0.05);
  const auto book = sim.fluid().flow().heat_book();
  CHECK(heat_of(sim) - book.counted_anew == near(first).epsilon(1e-12));
  CHECK(book.from_particles > 1e-3 * first);
  CHECK(sim.fluid().closure().heat < 1e-13);
}

// Catches state that is missing in the checkpoint, and results that depend on the threads.
TEST_CASE("heat in a simulation: a restart goes on with the same bits, on three threads too") {
  const std::string folder = "/tmp/silt_heat_" + std::to_string(::getpid());
  std::filesystem::create_directories(folder);
  auto whole = scene(), first = scene();
  first.threads = 3;
  const silt::FlowOutput hot{.temperature = true};
  const std::vector<silt::FlowProbe> middle{{"middle", {0.5 * L, 0.5 * L, 0.5 * L}}};
  whole.run(0.02);
  first.run(0.01, silt::flow_probes(folder + "/probe.csv", middle, silt::every(2e-3), hot),
            silt::flow_profile(folder, "axis", {0.5 * L, 0.5 * L, 0}, {0.5 * L, 0.5 * L, L}, 5,
                               silt::every(5e-3)));
  silt::save_checkpoint(first, folder + "/state.silt");
  auto second = scene();
  silt::load_checkpoint(second, folder + "/state.silt");
  second.run(0.01);
  CHECK(temperatures(second) == temperatures(whole));
  CHECK(first_line(folder + "/probe.csv").ends_with(",middle temperature [K]"));
  CHECK(first_line(folder + "/axis_000000000.csv").ends_with(",temperature [K]"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("heat in a simulation: a flow without a temperature is refused") {
  auto sim = scene(false);
  std::string all;
  try {
    sim.run(1e-3);
  } catch (const silt::InputError& e) {
    all = e.what();
  }
  CHECK_MESSAGE(all.find("give it one by FlowSolver::set_heat()") != std::string::npos, all);
}

}  // namespace heat_simulation_test
