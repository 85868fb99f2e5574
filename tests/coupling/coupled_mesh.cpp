// silt - BSD-3-Clause, see LICENSE

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <silt/fluid.hpp>

#include "near.hpp"

namespace coupled_mesh_test {

using silt::CoupledMesh;
using silt::HertzMindlin;
using silt::Particles;
using silt::PointWeights;
using silt::Simulation;
using silt::Sphere;
using silt::Vec3d;

namespace {

const HertzMindlin::Material glass{2e5, 0.3, 0.8, 0.3};
constexpr double width = 0.01;  // [m]

/// Layers of a column, the upper twice as high as the lower.
struct Layers {
  std::size_t cells() const { return 2; }
  double volume(std::size_t c) const { return width * width * (c == 0 ? 0.01 : 0.02); }
  std::size_t locate(const Vec3d& x) const {
    return x.z < 0 || x.z > 0.03 ? silt::no_cell : x.z < 0.01 ? 0 : 1;
  }
};
/// Fluid of those layers, each moved by what its particles do to it alone.
struct Blobs {
  silt::FluidProperties properties;
  std::vector<double> u[3]{{0, 0}, {0, 0}, {0, 0}}, none{};
  const silt::FluidProperties& fluid() const { return properties; }
  std::span<const double> velocity(int d) const { return u[d]; }
  std::span<const double> slope(int) const { return none; }
  void step(const silt::CellLoads& of, double dt) {
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t c = 0; c < 2; ++c) {
        const double m = of.voidage[c] * properties.density / dt;
        u[d][c] = (m * u[d][c] + of.push[d][c]) / (m + of.drag[c]);
      }
  }
  double stable_step(double) const { return 1e-3; }
  template <class Visit>
  void for_each_state(const Visit& visit) {
    for (auto& one : u) visit("blobs.velocity" + std::to_string(&one - u), one);
  }
};
static_assert(silt::MeshFlow<Blobs> && silt::CellMesh<Layers>);

auto scene(double density, const silt::FluidProperties& fluid) {
  Particles<Sphere> all;
  all.fill({{0, 0, 0}, {width, width, 0.03}},
           {.radius = 5e-4, .density = density, .count = 300, .velocity = {0.3, 0, -0.2}});
  Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass},
                 CoupledMesh{PointWeights{Layers{}}, Blobs{fluid}, silt::Gidaspow{}}};
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 0.03}), glass);
  return sim;
}

}  // namespace

TEST_CASE("CoupledMesh: momentum of particles and fluid is kept, and solids fill their cells") {
  // Catches drag that only one of both feels, volumes of cells taken as equal, and a cell's voidage
  // over another's volume.
  Particles<Sphere> all;
  for (int k = 0; k < 5; ++k)
    all.add({.position = {0.005, 0.005, 0.003 + 0.005 * k},
             .radius = 5e-4,
             .density = 2500,
             .velocity = {0.1 * k, 0.2, 0}});
  Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass},
                 CoupledMesh{PointWeights{Layers{}}, Blobs{{1000, 1e-3}}, silt::Gidaspow{}}};
  const auto momentum = [&] {
    Vec3d sum{0, 0, 0};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      sum += sim.mass(k) * sim.velocity(k) + sim.due_from_fluid(k);
    for (std::size_t c = 0; c < 2; ++c)
      for (int d = 0; d < 3; ++d) {
        const double of = sim.fluid().voidage()[c] * 1000 * Layers{}.volume(c) *
                          sim.fluid().flow().velocity(d)[c];
        (d == 0 ? sum.x : d == 1 ? sum.y : sum.z) += of;
      }
    return sum;
  };
  Vec3d before{0, 0, 0};
  for (std::size_t k = 0; k < sim.rows(); ++k) before += sim.mass(k) * sim.velocity(k);
  sim.time_step = 2e-5;
  double seen = 0;
  sim.run(0.01, silt::at(silt::every(1e-3), [&](const auto&) {
            seen = std::max(seen, norm(momentum() - before) / norm(before));
          }));
  CHECK(seen < 1e-10);
  CHECK(sim.fluid().closure().momentum < 1e-13);
  CHECK(sim.fluid().closure().volume < 1e-14);
  CHECK(sim.fluid().flow().velocity(1)[0] > 0);
  const double V = sim.mass(0) / 2500;
  CHECK(near_relative(1 - sim.fluid().voidage()[0], 2 * V / Layers{}.volume(0), 1e-9));
}

TEST_CASE("CoupledMesh: sizes of a mixture feel the drag of the mean of their cell") {
  // In the lower cell spheres of 0.5 and 1 mm, in the upper one of 1 mm alone: what the fluid of a
  // cell gets in its first step. Catches a mean over all cells, and no mean (1.11 in the lower).
  const auto push = [](const auto& drag) {
    CoupledMesh fluid{PointWeights{Layers{}}, Blobs{{1.2, 1.8e-5}}, drag};
    std::vector<Vec3d> x, v, force;
    std::vector<double> r, V, m;
    const auto put = [&](double z, double radius) {
      x.push_back({0.005, 0.005, z}), r.push_back(radius);
      v.push_back({0.1, 0, 0}), V.push_back(4 * std::numbers::pi / 3 * std::pow(radius, 3));
      m.push_back(1e9 * V.back());
    };
    for (int k = 0; k < 8; ++k) put(0.005, 2.5e-4);
    put(0.005, 5e-4), put(0.02, 5e-4), force.resize(x.size());
    fluid.advance({{x, r}, v, V, m}, 1e-6, force);
    double low = 0;
    for (int k = 0; k < 9; ++k) low += force[k].x;
    return std::array{low, force[9].x};
  };
  const auto mixed = push(silt::Polydisperse{silt::Stokes{}}), plain = push(silt::Stokes{});
  // Stokes' drag per volume is 18 mu/d^2: of the mean 2/3 mm, against that of both sizes.
  CHECK(mixed[0] / plain[0] == near(0.5625 / 0.625).epsilon(1e-6));
  CHECK(mixed[1] / plain[1] == near(1).epsilon(1e-12));
}

TEST_CASE("CoupledMesh: particles too light for its explicit pressure are refused") {
  // Catches runs that swing: 300 kg/m3 in water, where solids take a third of the lower layer.
  Particles<Sphere> all;
  all.fill({{0, 0, 0}, {width, width, 0.01}}, {.radius = 5e-4, .density = 300, .count = 600});
  Simulation sim{std::move(all), silt::Contacts<HertzMindlin>{glass},
                 CoupledMesh{PointWeights{Layers{}}, Blobs{{1000, 1e-3}}, silt::Gidaspow{}}};
  sim.time_step = 2e-5;
  CHECK_THROWS_WITH_AS(sim.run(1e-3), doctest::Contains("so light"), silt::SimulationError);
}

TEST_CASE("CoupledMesh: a restart goes on with the same bits, and so do more threads") {
  // Catches a part of the fluid that a checkpoint forgets.
  const silt::FluidProperties air{1.2, 1.8e-5};
  auto whole = scene(1500, air), other = scene(1500, air), first = scene(1500, air),
       second = scene(1500, air);
  other.threads = 3;
  whole.run(0.01), whole.run(0.01), other.run(0.01), other.run(0.01);
  const std::string file = "coupled_mesh.silt";
  first.run(0.01);
  save_checkpoint(first, file);
  load_checkpoint(second, file);
  std::filesystem::remove(file);
  second.run(0.01);
  for (std::size_t k = 0; k < whole.rows(); ++k) {
    CHECK(norm(whole.position(k) - second.position(second.find(whole.id(k)))) == 0);
    CHECK(norm(whole.position(k) - other.position(other.find(whole.id(k)))) == 0);
  }
}

TEST_CASE("CoupledMesh: a fluid without viscosity is refused, for drag laws that need it") {
  // Catches drag that is not a number.
  CHECK_THROWS_WITH_AS((CoupledMesh{PointWeights{Layers{}}, Blobs{{1000, 0}}, silt::Gidaspow{}}),
                       doctest::Contains("FluidProperties.viscosity = 0 Pa s must be given and"),
                       silt::InputError);
}

TEST_CASE("CoupledMesh: settings that cannot be are refused") {
  auto sim = scene(1500, {1.2, 1.8e-5});
  sim.fluid().steps = 0;
  CHECK_THROWS_AS(sim.run(1e-3), silt::InputError);
  sim.fluid().steps.reset(), sim.fluid().most_steps = 0;
  CHECK_THROWS_AS(sim.run(1e-3), silt::InputError);
}

}  // namespace coupled_mesh_test
