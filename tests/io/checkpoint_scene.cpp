// silt - BSD-3-Clause, see LICENSE
// A checkpoint is only taken by the scene that wrote it: what differs is named.
#include <filesystem>
#include <functional>

#include <engine/support.hpp>

#include <silt/io/checkpoint.hpp>
#include <silt/shape/super_ellipsoid.hpp>

namespace checkpoint_scene_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::load_checkpoint;
using silt::save_checkpoint;

const std::string path =
    (std::filesystem::temp_directory_path() / "silt_checkpoint_scene.silt").string();

constexpr HertzMindlin::Material slippery{
    .youngs_modulus = 4e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.2};

/// What scenes differ in.
struct Scene {
  silt::SuperEllipsoid form{.a = 2e-3, .b = 1.5e-3, .c = 2e-3};
  double youngs_modulus = 4e6, friction = 0.2, wall_friction = 0.5, pair_friction = 0.3;
  silt::Surfaces wall = silt::Plane{{0, 0, 0}, {0, 0, 1}};
  silt::Motion motion = silt::vibration({0, 0, 0.2e-3}, 50);
  silt::Box outlet{{0.1, 0, -1}, {0.2, 1, 1}};
  std::function<void(silt::InletFlow&)> change_flow = [](auto&) {};
  silt::Box inlet{{0, 0, 0.02}, {0.02, 0.02, 0.03}};
};

auto built(const Scene& scene) {
  silt::Particles<silt::SuperEllipsoid> p;
  p.add_form({.a = 1e-3, .b = 1e-3, .c = 1e-3});
  const auto form = p.add_form(scene.form);
  for (int k = 0; k < 6; ++k)
    p.add({.form = form,
           .position = {5e-3 * k, 1e-3 * k, 2.2e-3},
           .radius = 2e-3,
           .density = 2500,
           .velocity = {0.01 * k, 0, -0.2}});
  auto grain = slippery, base = rubber;
  grain.youngs_modulus = scene.youngs_modulus;
  grain.friction = scene.friction, base.friction = scene.wall_friction;
  silt::Contacts<HertzMindlin, silt::SeveralMaterials> contacts({grain, base});
  contacts.set_pair(grain, base, {.restitution = 0.6, .friction = scene.pair_friction});
  silt::Simulation sim{std::move(p), std::move(contacts)};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.add_wall(scene.wall, base, scene.motion);
  sim.add_outlet(scene.outlet);
  silt::InletFlow flow{.radius = 1e-3, .density = 2500, .rate = 500, .velocity = {0, 0, -0.1}};
  scene.change_flow(flow);
  sim.add_inlet(scene.inlet, flow);
  return sim;
}

/// Every number that the run goes on from.
template <class Sim>
std::vector<double> seen(const Sim& sim) {
  std::vector<double> all{sim.time()};
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d x = sim.position(k), v = sim.velocity(k);
    const auto q = sim.orientation(k);
    all.insert(all.end(), {x.x, x.y, x.z, v.x, v.y, v.z, q.w, q.x, q.y, q.z});
  }
  return all;
}

}  // namespace

TEST_CASE("checkpoint: of an ellipsoid of c = 2 mm it is refused by a scene of c = 1.2 mm") {
  auto sim = built({});
  sim.run(2e-3);
  save_checkpoint(sim, path);
  auto flat = built({.form = {.a = 2e-3, .b = 1.5e-3, .c = 1.2e-3}});
  flat.run(1e-3);
  const auto before = seen(flat);
  CHECK(has_words(refusal<InputError>([&] { load_checkpoint(flat, path); }),
                  {path, "form 1: semi-axis c [m] is 0.002 in the file and 0.0012 in the scene",
                   "build the scene that wrote it"}));
  CHECK(seen(flat) == before);
}

TEST_CASE("checkpoint: whatever a scene has otherwise is named") {
  auto sim = built({});
  sim.run(2e-3);
  save_checkpoint(sim, path);
  {
    auto same = built({});
    load_checkpoint(same, path);
    CHECK(seen(same) == seen(sim));
  }
  const auto refused = [](const Scene& scene, std::initializer_list<std::string> words) {
    auto other = built(scene);
    const auto before = seen(other);
    CHECK(has_words(refusal<InputError>([&] { load_checkpoint(other, path); }), words));
    CHECK(seen(other) == before);
  };
  refused({.form = {.a = 2e-3, .b = 1.5e-3, .c = 2e-3, .s1 = 3}},
          {"form 1: exponent s1 is 2 in the file and 3 in the scene"});
  refused({.friction = 0.25},
          {"materials 0 and 0: the law's coefficient 5 of 5 (friction [-]) is 0.2 in the file and "
           "0.25",
           "accept other materials", ".materials = true"});
  refused({.pair_friction = 0.35},
          {"materials 0 and 1: the law's coefficient", "0.35 in the scene"});
  refused({.wall = silt::Plane{{0, 0, 1e-4}, {0, 0, 1}}},
          {"wall 0: point z [m] is 0 in the file and 1e-04 in the scene"});
  refused({.wall = silt::Plane{{0, 0, 0}, {0, 0.1, 1}}}, {"wall 0: normal y"});
  refused({.wall = silt::Cylinder{{0, 0, -1}, {0, 0, 1}, 1, silt::Side::Inside}},
          {"wall 0: is is 'a plane' in the file and 'a cylinder' in the scene"});
  refused({.wall = silt::box({-1, -1, -1}, {1, 1, 1})},
          {"wall 0: surfaces is 1 in the file and 6"});
  {
    auto walled = built({});
    walled.add_wall(silt::Plane{{0, 0, 1}, {0, 0, -1}}, walled.contacts().material(0));
    const auto words = refusal<InputError>([&] { load_checkpoint(walled, path); });
    CHECK(has_words(words, {"walls is 1 in the file and 2 in the scene",
                            "build the scene that wrote it", ".walls = true"}));
  }
  refused({.motion = {}},
          {"wall 0: moves is 'yes' in the file and 'no' in the scene", ".motions = true"});
  refused({.motion = silt::vibration({0, 0, 0.2e-3}, 60)},
          {"wall 0 was at", "its motion in the scene", ".motions = true"});
  refused({.outlet = {{0.1, 0, -1}, {0.3, 1, 1}}},
          {"outlet 0: to x [m] is 0.2 in the file", ".outlets = true"});
  refused({.inlet = {{0, 0, 0.02}, {0.02, 0.02, 0.04}}}, {"inlet 0: region", ".inlets = true"});
  const auto flow = [&](auto change, const std::string& words) {
    refused({.change_flow = change}, {"inlet 0: ", words});
  };
  flow([](auto& f) { f.rate = 400; }, "rate [1/s] is 500 in the file and 400 in the scene");
  flow([](auto& f) { f.density = 2600; }, "density");
  flow([](auto& f) { f.velocity = {0, 0, -0.2}; }, "velocity z");
  flow([](auto& f) { f.radius = 1.1e-3; }, "least radius");
  flow([](auto& f) { f.seed = 2; }, "seed");
  flow([](auto& f) { f.total = 100; }, "total");
  flow([](auto& f) { f.material = 1; }, "material");
  flow([](auto& f) { f.form = 1; }, "form");
}

TEST_CASE("checkpoint: rounding of another instruction set is no difference") {
  using Aspect = silt::detail::SceneDescription::Aspect;
  const auto of = [](double x, double y) {
    silt::detail::SceneDescription d;
    d.add(Aspect::Scene, "x", x);
    const std::vector<Vec3d> points{{x, 1, 2}, {y, 5, 1e-3}, {-3, 0, 4}};
    d.add(Aspect::Scene, "points", std::span<const Vec3d>(points));
    return d;
  };
  const auto one = of(0.1, 7), rounded = of(0.1 * (1 + 4e-16), 7 * (1 - 4e-16));
  CHECK(one.difference(rounded.written(), {}).empty());
  CHECK(has_words(one.difference(of(0.1 * (1 + 1e-8), 7).written(), {}), {"x is 0.1000000"}));
  CHECK(has_words(one.difference(of(0.1, 7.00001).written(), {}),
                  {"the points [m] are others in the file than in the scene"}));
}

TEST_CASE("checkpoint: other materials are taken where they are accepted, and act from then on") {
  auto settled = built({});
  settled.run(2e-3);
  save_checkpoint(settled, path);
  const auto continued = [](double friction) {
    auto sim = built({.pair_friction = friction});
    load_checkpoint(sim, path, {.materials = true});
    const auto start = seen(sim);
    sim.run(0.06);
    return std::pair{start, seen(sim)};
  };
  const auto [start, end] = continued(0.3);
  const auto [start_smooth, end_smooth] = continued(0.01);
  settled.run(0.06);
  CHECK(end == seen(settled));  // accepting changes nothing where there is none
  CHECK(start_smooth == start);
  CHECK(end_smooth != end);
}

TEST_CASE("checkpoint: with stiffer materials the time step is chosen anew, or held to its limit") {
  auto settled = built({});
  settled.run(2e-3);
  save_checkpoint(settled, path);
  const auto stiff = [](bool left_out) {
    auto sim = built({.youngs_modulus = 4e10});
    if (left_out) sim.time_step.reset();
    load_checkpoint(sim, path, {.materials = true});
    return sim;
  };
  auto chosen = stiff(true), given = stiff(false);
  chosen.run(1e-5);
  CHECK(chosen.step_length() < 0.5e-5);  // that of the file is 1e-5
  CHECK(has_words(refusal<silt::SimulationError>([&] { given.run(1e-3); }),
                  {"the time step 1e-05 s is above its limit"}));
}

TEST_CASE("checkpoint: other motions and inlets are taken where they are accepted") {
  auto sim = built({});
  sim.run(2e-3);
  save_checkpoint(sim, path);
  auto other = built({.motion = silt::vibration({0, 0, 0.1e-3}, 50), .change_flow = [](auto& f) {
                        f.rate = 5000, f.velocity = {0, 0, -1};
                      }});
  CHECK_THROWS_AS(load_checkpoint(other, path, {.motions = true}), InputError);
  CHECK_THROWS_AS(load_checkpoint(other, path, {.inlets = true}), InputError);
  CHECK_THROWS_AS(load_checkpoint(other, path, {.materials = true}), InputError);
  load_checkpoint(other, path, {.motions = true, .inlets = true});
  CHECK(other.inlet(0).placed == 0);  // they begin anew
  CHECK(other.inlet(0).start == sim.time());
  other.run(5e-3);  // every 2 ms, a diameter's time of flight: the last time after 4 ms
  CHECK(other.inlet(0).placed >= 20);
  CHECK(other.inlet(0).placed <= 22);
  CHECK(other.wall(0).pose == other.wall(0).motion(other.time()));
}

}  // namespace checkpoint_scene_test
