// silt - BSD-3-Clause, see LICENSE
// Forged checkpoints, their checksums right: refused with the simulation as it was, or a state that
// goes on for some steps or stops with a sentence.
#include <io/fuzz_support.hpp>

#include <engine/mixed_scene.hpp>

#include <silt/shape/laguerre_cells.hpp>

#include <breakage/scene.hpp>

#include <silt/bond/build.hpp>
#include <silt/bond/parallel_bond.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/fluid.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/shape/compound.hpp>
#include <silt/shape/multi_sphere.hpp>

namespace fuzz_checkpoint_test {

namespace {

using namespace engine_test;
using fuzz::Folder;

constexpr double step = 4e-6;  // [s] of mixed_scene

/// Bodies of several spheres in a flow, with a ledger, and forces with a memory.
auto bodies_in_flow(double height = 20e-3, double viscosity = 1e-2) {
  silt::Particles<silt::MultiSphere> stones;
  const auto rod =
      stones.add_form({.balls = {{{-0.5e-3, 0, 0}, 0.8e-3}, {{0.5e-3, 0, 0}, 0.8e-3}}});
  const auto ball = stones.add_form({.balls = {{{0, 0, 0}, 1e-3}}});
  stones.fill({.min = {1e-3, 1e-3, 2e-3}, .max = {9e-3, 9e-3, 9e-3}},
              {.radius = 1e-3, .density = 2500, .count = 12, .form = rod});
  stones.fill({.min = {1e-3, 1e-3, 10e-3}, .max = {9e-3, 9e-3, 14e-3}},
              {.radius = 0.8e-3, .density = 2500, .count = 8, .form = ball});
  silt::FlowSolver flow(silt::Grid({{0, 0, 0}, {10e-3, 10e-3, height}}, {4, 4, 8}),
                        {.density = 1000, .viscosity = viscosity});
  silt::CoupledFlow fluid{silt::Stokes{}, silt::Kernel{}, std::move(flow), silt::HistoryForce{4},
                          silt::VirtualMass{}};
  fluid.steps = 5;
  silt::Simulation sim{std::move(stones), silt::Contacts<silt::LinearSpring>{{.stiffness = 100}},
                       std::move(fluid), silt::EnergyLedger{}};
  sim.gravity = {0, 0, -9.81};
  sim.time_step = 2e-5;
  sim.threads = 1;
  sim.add_wall(silt::box({0, 0, 0}, {10e-3, 10e-3, 20e-3}), {.stiffness = 100});
  sim.add_outlet({{0, 0, 15e-3}, {5e-3, 10e-3, 20e-3}});
  return sim;
}

/// Convex bodies of two parts each at a mesh and a cylinder.
auto crosses() {
  silt::Particles<silt::Compound<silt::SuperEllipsoid>> stones;
  const silt::SuperEllipsoid rod{.a = 2e-3, .b = 0.6e-3, .c = 0.6e-3};
  const auto turn = silt::rotation_about({0, 0, 1}, 1.5707963);
  const auto cross = stones.add_form({.parts = {{rod}, {rod, {}, turn}}, .grid = 30});
  stones.fill(
      {.min = {1e-3, 1e-3, 3e-3}, .max = {15e-3, 15e-3, 14e-3}},
      {.radius = 2e-3, .density = 2500, .count = 10, .velocity = {0, 0, -0.5}, .form = cross});
  silt::Simulation sim{std::move(stones), silt::Contacts<HertzMindlin>{rubber}};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.add_wall(silt::Plane{{0, 0, 1e-3}, {0, 0, 1}}, rubber);
  sim.add_wall(silt::TriangleMesh(boundary_test::box_soup({4e-3, 4e-3, 0}, {12e-3, 12e-3, 3e-3})),
               rubber, silt::vibration({0, 0, 0.1e-3}, 50));
  sim.add_wall(silt::Cylinder{{8e-3, 8e-3, -1}, {8e-3, 8e-3, 1}, 9e-3, silt::Side::Inside}, rubber);
  return sim;
}

/// Stones that have broken on a plane, their fragments too; some are due to break.
auto broken_stones() {
  silt::Particles<silt::Polyhedron> stones;
  std::vector<Vec3d> corners;
  silt::Random random(9);
  for (int k = 0; k < 12; ++k) {
    const Vec3d p{random.normal(), random.normal(), random.normal()};
    corners.push_back((1e-3 / norm(p)) * p);
  }
  const auto form = stones.add_form(silt::Polyhedron::from_points(corners));
  for (int k = 0; k < 2; ++k)
    stones.add({.form = form,
                .position = {0.003 * k, 0, 0.0012},
                .density = 2165,
                .velocity = {0, 0, -12}});
  silt::Simulation sim{
      std::move(stones), silt::Contacts<silt::HertzMindlin>{breakage_scene::salt},
      silt::EnergyLedger{}, breakage_scene::policy({.dust_below = 5e-4, .most_fragments = 8})};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, breakage_scene::salt);
  sim.add_wall(silt::Plane{{0, 0, 0.01}, {0, 0, -1}}, breakage_scene::salt);
  sim.time_step = 5e-8, sim.threads = 1;
  sim.guard.max_overlap = 0.9;
  return sim;
}

/// What tells one state from another.
template <class Sim>
std::vector<double> seen(const Sim& sim) {
  std::vector<double> all{sim.time(),
                          sim.step_length(),
                          sim.peak_overlap(),
                          sim.largest_overlap(),
                          static_cast<double>(sim.step()),
                          static_cast<double>(sim.rows())};
  const auto add = [&](const Vec3d& v) { all.insert(all.end(), {v.x, v.y, v.z}); };
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    all.push_back(static_cast<double>(sim.id(k)));
    add(sim.position(k)), add(sim.velocity(k));
    if constexpr (std::remove_cvref_t<Sim>::of_bodies) {
      const auto q = sim.orientation(k);
      all.insert(all.end(), {q.w, q.x, q.y, q.z});
    }
  }
  for (std::size_t w = 0; w < sim.walls(); ++w)
    all.push_back(static_cast<double>(sim.wall(w).surfaces.size())), add(sim.wall(w).force),
        add(sim.wall(w).impulse), add(sim.wall(w).pose.translation);
  return all;
}

/// An agglomerate that breaks on a plane, and a fibre that hangs on another one.
auto bonded() {
  constexpr double R = 1e-3;
  const silt::HertzMindlin::Material glass{
      .youngs_modulus = 1e7, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
  silt::Simulation sim{silt::Particles<silt::Sphere>{}, silt::Contacts<silt::HertzMindlin>{glass},
                       silt::Bonds{silt::ParallelBond{
                           .youngs_modulus = 1e7, .tensile_strength = 5e3, .shear_strength = 5e3}},
                       silt::EnergyLedger{}};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, glass);
  sim.add_wall(silt::Plane{{0, 0, 0.03}, {0, 0, -1}}, glass);
  silt::Particles<silt::Sphere> ball;
  for (int k = 0; k < 27; ++k)
    ball.add({.position = {1.9 * R * (k % 3), 1.9 * R * (k / 3 % 3), 1.9 * R * (k / 9) + 1.2 * R},
              .radius = R,
              .density = 2000,
              .velocity = {0.1, 0, -1}});
  sim.add(ball);
  bond_near(sim, 0.01 * R);
  add_bonded(sim,
             silt::fibre({0.02, 0, 0.029}, {0.02, 0, 0.021}, 5, {.radius = R, .density = 2000}));
  sim.bond_to_wall(27, 1, {0.02, 0, 0.03});
  sim.time_step = 1e-6, sim.threads = 1;
  return sim;
}

/// `make` builds the scene, which is saved after `before` [s], and again in a state just begun;
/// `change` is what a program may do between two runs.
template <class Make, class Change>
void all_forgeries(const char* name, const Make& make, double before, const Change& change) {
  const Folder folder;
  const std::string path = folder / "c";
  std::vector<fuzz::Parts> seeds;
  auto writer = make();
  const auto save = [&] {
    save_checkpoint(writer, path);
    seeds.push_back(fuzz::Parts::of(silt::detail::read_file(path)));
    REQUIRE(seeds.back().file() == silt::detail::read_file(path));
  };
  save();
  writer.run(before);
  save();
  save_checkpoint(writer, folder / "good");
  change(writer);
  save();

  {
    auto sim = make();
    for (const auto& seed : seeds) {  // as they were saved they are taken
      fuzz::write_bytes(path, seed.file());
      CHECK_NOTHROW(load_checkpoint(sim, path));
      sim = make();
    }
  }
  auto victim = make();   // takes what it is given, and goes on with it
  auto careful = make();  // has run on its own; is offered only what was refused
  careful.run(before / 2);
  const auto at_first = seen(careful);
  fuzz::Judge judge(name);
  const int inputs = fuzz::inputs();
  for (int k = 0; k < inputs; ++k) {
    silt::Random random(static_cast<std::uint64_t>(k) + 1);
    fuzz::write_bytes(path, fuzz::forged(seeds[random.index(seeds.size())], random));
    bool loaded = false;
    judge(static_cast<std::uint64_t>(k), [&] {
      const auto start = seen(victim);
      try {
        load_checkpoint(victim, path);
      } catch (...) {
        CHECK(seen(victim) == start);
        throw;
      }
      loaded = true;
      victim.run(4 * *victim.time_step);
      return true;
    });
    if (loaded)
      victim = make(), load_checkpoint(victim, folder / "good");
    else if (k % 4 == 0)
      CHECK_THROWS_AS(load_checkpoint(careful, path), silt::Error);
  }
  CHECK(judge.refused() > inputs / 2);
  CHECK(judge.taken() > inputs / 20);
  CHECK(seen(careful) == at_first);
  auto untouched = make();
  untouched.run(before / 2);
  untouched.run(before / 2), careful.run(before / 2);
  CHECK(seen(careful) == seen(untouched));
}

}  // namespace

TEST_CASE("checkpoint: a fluid on another grid, of another viscosity, is named") {
  const Folder folder;
  save_checkpoint(bodies_in_flow(), folder / "c");
  auto taller = bodies_in_flow(22e-3);
  CHECK(has_words(refusal<silt::InputError>([&] { load_checkpoint(taller, folder / "c"); }),
                  {"fluid: grid to z [m] is 0.02 in the file and 0.022 in the scene"}));
  auto thicker = bodies_in_flow(20e-3, 2e-2);
  CHECK(has_words(refusal<silt::InputError>([&] { load_checkpoint(thicker, folder / "c"); }),
                  {"fluid: viscosity [Pa s] is 0.01 in the file and 0.02 in the scene"}));
}

TEST_CASE("fuzz: checkpoints of spheres, materials, a periodic box, walls that move, inlets") {
  all_forgeries(
      "checkpoint of spheres", [] { return mixed_scene(); }, 1000 * step,
      [](auto& sim) { sim.remove_wall(0); });
}

TEST_CASE("fuzz: checkpoints of bodies in a flow with a memory, and a ledger") {
  all_forgeries(
      "checkpoint of bodies in a flow", [] { return bodies_in_flow(); }, 100 * 2e-5,
      [](auto& sim) { sim.remove_wall(0); });
}

TEST_CASE("fuzz: checkpoints of convex bodies of several parts") {
  all_forgeries(
      "checkpoint of convex bodies", [] { return crosses(); }, 300 * 1e-5,
      [](auto& sim) { sim.remove_wall(2); });
}

TEST_CASE("fuzz: checkpoints of bonds, between spheres and to a wall") {
  all_forgeries(
      "checkpoint of bonds", [] { return bonded(); }, 300 * 1e-6,
      [](auto& sim) { sim.remove_wall(1); });
}

TEST_CASE("fuzz: checkpoints of polyhedra that have broken into cells") {
  all_forgeries(
      "checkpoint of cells", [] { return broken_stones(); }, 1600 * 5e-8, [](auto& sim) {
        CHECK(sim.forms().size() > 5);
        sim.remove_wall(1);
        sim.break_particle(sim.id(sim.rows() - 1));
      });
}

}  // namespace fuzz_checkpoint_test
