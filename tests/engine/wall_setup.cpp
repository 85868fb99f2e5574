// silt - BSD-3-Clause, see LICENSE
// Walls by name, motions that are changed on the way, surface velocities, and mean loads.
#include <filesystem>
#include <fstream>

#include <boundary/support.hpp>
#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/scene_warnings.hpp>
#include <silt/io/wall_series.hpp>
#include <silt/simulation.hpp>

namespace wall_setup_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::Plane;

auto scene(silt::Particles<Sphere> particles, const HertzMindlin::Material& material = rubber) {
  silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{material},
                       silt::EnergyLedger{}};
  sim.threads = 1;
  sim.gravity = {0, 0, -9.81};
  return sim;
}
using Sim = decltype(scene({}));

silt::Particles<Sphere> one(const Vec3d& position, double radius = 0.01, const Vec3d& v = {}) {
  silt::Particles<Sphere> p;
  p.add({.position = position, .radius = radius, .density = 2500, .velocity = v});
  return p;
}
const Plane floor_plane{{0, 0, 0}, {0, 0, 1}};

/// Overlap [m] of a sphere that rests on a plane under its weight [N].
double rest(double weight, double radius) {
  const double E = rubber.youngs_modulus / (2 * (1 - rubber.poisson_ratio * rubber.poisson_ratio));
  return std::pow(weight / (4.0 / 3 * E * std::sqrt(radius)), 2.0 / 3);
}
std::string temporary(const char* name) {
  return (std::filesystem::temp_directory_path() / name).string();
}

}  // namespace

TEST_CASE("walls: a name finds its wall, and stands in messages") {
  auto sim = scene(one({0, 0, 0.02}));
  const std::size_t k = sim.add_wall(floor_plane, rubber, {.name = "floor"});
  sim.add_wall(Plane{{0, 0, 1}, {0, 0, -1}}, rubber);
  CHECK(sim.find_wall("floor") == k);
  CHECK(&sim.wall("floor") == &sim.wall(0));
  CHECK(sim.wall_name(0) == "wall 0 'floor'");
  CHECK(sim.wall_name(1) == "wall 1");
  sim.name_wall(1, "lid");
  CHECK(sim.find_wall("lid") == 1);
  sim.name_wall("lid", "lid");  // its own

  const auto refused = [&](auto&& action, std::initializer_list<std::string> words) {
    CHECK(has_words(refusal<InputError>(action), words));
  };
  refused([&] { sim.wall("door"); }, {"wall 'door' is not there", "'floor', 'lid'"});
  refused([&] { sim.wall(7); }, {"wall(7): there are 2 walls"});
  refused([&] { sim.set_motion("door", {}); }, {"wall 'door' is not there"});
  refused([&] { sim.name_wall(0, "lid"); }, {"wall 1 has the name 'lid' already"});
  refused([&] { sim.add_wall(floor_plane, rubber, {.name = "lid"}); }, {"unique"});
  refused([&] { sim.name_wall(0, ""); }, {"name is empty"});
  refused([&] { sim.name_wall(0, "a'b"); }, {"printable characters"});
  refused([&] { sim.name_wall(0, "a\nb"); }, {"printable characters"});
  CHECK(sim.walls() == 2);

  // Guard: a sphere deep in the floor.
  auto deep = scene(one({0, 0, 0.004}));
  deep.add_wall(floor_plane, rubber, {.name = "floor"});
  CHECK(has_words(refusal<silt::SimulationError>([&] { deep.run(0.01); }),
                  {"overlaps wall 0 'floor' by 0.6"}));
  // Guard: too fast a wall.
  auto fast = scene(one({0, 0, 0.02}));
  fast.add_wall(Plane{{0, 0, -5}, {0, 0, 1}}, rubber,
                {.name = "piston", .motion = [](double t) {
                   return silt::Pose{{}, {0, 0, t < 0.01 ? 0 : 100 * (t - 0.01)}};
                 }});
  CHECK(has_words(refusal<silt::SimulationError>([&] { fast.run(0.05); }), {"wall 0 'piston'"}));
  // Warnings: an outlet behind a floor.
  silt::Particles<Sphere> many;
  for (int i = 0; i < 20; ++i)
    many.add({.position = {0.05 * i, 0, 0.02}, .radius = 0.01, .density = 2500});
  auto behind = scene(many);
  behind.add_wall(silt::box({-1, -1, 0}, {2, 1, 1}), rubber, {.name = "tank"});
  behind.add_outlet({{0, 0, -1}, {1, 1, -0.5}});
  const auto warnings = silt::scene_warnings(behind);
  REQUIRE(warnings.size() == 1);
  CHECK(has_words(warnings[0], {"is behind wall 0 'tank'"}));
}

TEST_CASE("remove_wall: further changes are refused by name, and the name is free") {
  auto sim = scene(one({0, 0, 0.02}));
  sim.add_wall(floor_plane, rubber, {.name = "floor"});
  sim.add_wall(silt::box_mesh({-1, -1, 0.1}, {1, 1, 0.2}), rubber, {.name = "lid"});
  sim.run(0.001);
  sim.remove_wall("lid");
  const auto refused = [&](auto&& action) {
    CHECK(has_words(refusal<InputError>(action), {"wall 1 'lid' was removed", "add a new wall"}));
  };
  refused([&] { sim.remove_wall("lid"); });
  refused([&] { sim.set_motion(1, {}); });
  refused([&] { sim.set_motion(1, silt::translation({0, 0, 1})); });
  refused([&] {
    sim.set_drive("lid", silt::ServoForce{.direction = {0, 0, -1}, .force = 1, .max_speed = 0.1});
  });
  refused([&] { sim.set_surface_velocity("lid", {.velocity = {1, 0, 0}}); });
  refused([&] { sim.set_mesh("lid", silt::box_mesh({-1, -1, 0.1}, {1, 1, 0.2})); });
  refused([&] { sim.set_reference("lid", {0, 0, 0}); });
  refused([&] { sim.name_wall("lid", "cover"); });
  CHECK(sim.wall("lid").impulse.z == 0);  // may be read

  CHECK(sim.add_wall(Plane{{0, 0, 0.3}, {0, 0, -1}}, rubber, {.name = "lid"}) == 2);
  CHECK(sim.find_wall("lid") == 2);
  CHECK(sim.wall_name(1) == "wall 1 'lid'");
  sim.remove_wall("lid");
  CHECK(sim.find_wall("lid") == 2);  // the last one
  CHECK(has_words(refusal<InputError>(
                      [&] { sim.add_wall(silt::Surfaces(std::vector<silt::Surface>{}), rubber); }),
                  {"add_wall", "no surfaces"}));
  sim.run(0.01);

  // A checkpoint keeps it removed.
  const std::string path = temporary("removed_wall.silt");
  silt::save_checkpoint(sim, path);
  auto again = scene(one({0, 0, 0.02}));
  again.add_wall(floor_plane, rubber, {.name = "floor"});
  again.add_wall(silt::box_mesh({-1, -1, 0.1}, {1, 1, 0.2}), rubber, {.name = "lid"});
  again.add_wall(Plane{{0, 0, 0.3}, {0, 0, -1}}, rubber, {.name = "cover"});
  silt::load_checkpoint(again, path);
  CHECK(has_words(refusal<InputError>([&] { again.set_motion("cover", {}); }),
                  {"wall 2 'cover' was removed"}));
  CHECK(again.add_wall(floor_plane, rubber, {.name = "lid"}) == 3);
  std::filesystem::remove(path);
}

TEST_CASE("motions: one that is changed in a run begins where the wall is") {
  auto sim = scene(one({0, 0, 0.02}));
  sim.add_wall(silt::rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), rubber,
               {.name = "plate", .motion = silt::translation({0, 0, -0.02})});
  sim.time_step = 1e-5;
  sim.run(0.1);
  const silt::Pose before = sim.wall("plate").pose;
  CHECK(before.translation.z == doctest::Approx(-0.002));
  sim.set_motion("plate", silt::from(sim.time(), silt::vibration({0, 0, 0.001}, 10)));
  double largest = 0;
  Vec3d last = before.translation;
  sim.run(0.05, silt::at(silt::every(5e-6), [&](const Sim& s) {
            const Vec3d at = s.wall("plate").pose.translation;
            largest = std::max(largest, norm(at - last)), last = at;
          }));
  // No jump: a step at 2 pi f A, and half a period later it is where it was.
  CHECK(largest < 1.01 * 2 * boundary_test::pi * 10 * 0.001 * 1e-5);
  CHECK(norm(sim.wall("plate").pose.translation - before.translation) < 1e-6);
  // Turned about a line elsewhere; then stopped.
  sim.set_motion("plate", silt::rotation({0, 0.5, 0}, {1, 0, 0}, 0.1));
  sim.run(0.01);
  const silt::Pose turned = sim.wall("plate").pose;
  const Vec3d p{0.1, 0.2, 0};
  const auto turn = silt::rotation({0, 0.5, 0}, {1, 0, 0}, 0.1)(0.01);
  CHECK(norm(turned.to_space(p) - turn.to_space(p + last)) < 1e-12);
  sim.set_motion("plate", {});
  sim.run(0.01);
  CHECK(norm(sim.wall("plate").pose.to_space(p) - turned.to_space(p)) < 1e-15);
}

TEST_CASE("motions: a changed motion goes on with the same bits from a checkpoint") {
  const auto path = temporary("silt_changed_motion.silt");
  const auto motion = silt::from(0.02, silt::vibration({0.001, 0, 0.002}, 20, 0.3));
  const auto built = [&](silt::Motion first) {
    auto sim = scene(one({0, 0, 0.0105}));
    sim.add_wall(floor_plane, rubber, {.name = "floor", .motion = std::move(first)});
    return sim;
  };
  auto whole = built(silt::translation({0, 0, 0.01}));
  whole.run(0.02);
  whole.set_motion("floor", motion);
  whole.run(0.02);
  silt::save_checkpoint(whole, path);
  whole.run(0.05);
  auto restarted = built(motion);  // the motion that it has now
  silt::load_checkpoint(restarted, path);
  restarted.run(0.05);
  CHECK(bits(whole) == bits(restarted));
  CHECK(whole.wall(0).pose == restarted.wall(0).pose);
  // With the motion that it had at first it is another scene.
  auto other = built(silt::translation({0, 0, 0.01}));
  CHECK(has_words(refusal<InputError>([&] { silt::load_checkpoint(other, path); }),
                  {"wall 0 'floor' was at", "its motion in the scene"}));
  silt::load_checkpoint(other, path, {.motions = true});
  const auto pose = other.wall(0).pose;
  other.run(0.001);  // accepted, it goes on from where it is
  CHECK(norm(other.wall(0).pose.translation - pose.translation) < 2e-5);  // a step more
  std::filesystem::remove(path);
}

TEST_CASE("belts: a sphere is taken along with mu g, and then rolls with the belt") {
  // One that slides has the acceleration mu g, and its spin grows with 5/2 mu g/r, so that it rolls
  // from v = 2/7 of the belt's speed on.
  const double u = 0.5, mu = 0.5, g = 9.81, r = 0.01,
               weight = 2500 * 4.0 / 3 * boundary_test::pi * r * r * r * g;
  for (const bool is_mesh : {false, true}) {
    auto sim = scene(one({0, 0, r - rest(weight, r)}, r));
    const silt::SurfaceVelocity belt{.velocity = {u, 0, 0}};
    if (is_mesh)
      sim.add_wall(silt::rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), rubber,
                   {.name = "belt", .surface_velocity = belt});
    else
      sim.add_wall(floor_plane, rubber, {.name = "belt", .surface_velocity = belt});
    const double slides = 2.0 / 7 * u / (mu * g);  // [s]
    const double arm = r - rest(weight, r);        // [m] 1.2 % less than r
    sim.run(0.5 * slides);
    const double t = sim.time();
    // The tangential spring takes some steps to load: 1 %.
    CHECK(sim.velocity(0).x == doctest::Approx(mu * g * t).epsilon(0.01));
    CHECK(sim.angular_velocity(0).y ==
          doctest::Approx(-2.5 * mu * g * t * arm / (r * r)).epsilon(0.01));
    sim.run(2 * slides);
    CHECK(sim.velocity(0).x == doctest::Approx(2.0 / 7 * u).epsilon(0.01));
    // Rolling on the belt: the contact point has the belt's speed.
    CHECK(sim.velocity(0).x - r * sim.angular_velocity(0).y == doctest::Approx(u).epsilon(0.01));
    CHECK(sim.wall("belt").pose == silt::Pose{});
    const auto e = sim.energy();
    // What the belt brings in is m mu g u for the time of sliding, of which friction takes half.
    CHECK(e.walls == doctest::Approx(weight * mu * u * slides).epsilon(0.02));
    CHECK(std::abs(e.residual()) < 2e-3 * e.walls);
  }
}

TEST_CASE("belts: a block reaches the belt's speed with mu g") {
  // A sphere that cannot turn, as its spin is taken away in each step, slides as a block does.
  const double u = 0.3, mu = 0.5, g = 9.81, r = 0.01;
  auto sim = scene(one({0, 0, r - rest(2500 * 4.0 / 3 * boundary_test::pi * r * r * r * g, r)}, r));
  sim.add_wall(floor_plane, rubber, {.name = "belt"});
  sim.run(0.01);                                                // at rest: a plane as any other
  sim.set_surface_velocity("belt", {.velocity = {u, 0, 0.7}});  // its part along the normal is none
  const double from = sim.time(), takes = u / (mu * g);
  const auto hold = [](Sim& s) { s.set_angular_velocity(s.id(0), {0, 0, 0}); };
  sim.run(0.5 * takes, silt::at(silt::every(1e-7), hold));
  CHECK(sim.velocity(0).x == doctest::Approx(mu * g * (sim.time() - from)).epsilon(0.01));
  sim.run(takes, silt::at(silt::every(1e-7), hold));
  CHECK(sim.velocity(0).x == doctest::Approx(u).epsilon(0.01));
  CHECK(std::abs(sim.velocity(0).z) < 1e-4);
  sim.set_surface_velocity("belt", {});
  sim.run(0.5 * takes, silt::at(silt::every(1e-7), hold));
  CHECK(sim.velocity(0).x == doctest::Approx(u / 2).epsilon(0.03));
  CHECK(has_words(refusal<InputError>([&] {
                    sim.set_surface_velocity("belt", {.velocity = {boundary_test::infinity, 0, 0}});
                  }),
                  {"SurfaceVelocity", "finite"}));
}

TEST_CASE("belts: a turning disc takes a sphere along the tangent at its place") {
  const double r = 0.01, w = 10;
  auto sim =
      scene(one({0.1, 0, r - rest(2500 * 4.0 / 3 * boundary_test::pi * r * r * r * 9.81, r)}, r));
  sim.add_wall(silt::disc({0, 0, 0}, {0, 0, 1}, 0.3), rubber,
               {.name = "table", .surface_velocity = {.rate = {0, 0, w}}});
  sim.run(0.01);
  CHECK(sim.velocity(0).y == doctest::Approx(0.5 * 9.81 * 0.01).epsilon(0.02));
  CHECK(std::abs(sim.velocity(0).x) < 0.02 * sim.velocity(0).y);
}

// A ball that rolls on a turntable moves on a circle at 2/7 of its rate, at a constant speed.
// Catches surface velocities taken at the step for particle velocities of half a step ago: the
// speed fell by (2 W/7)^2 dt/2 per time, 5e-5 here.
TEST_CASE("belts: a ball that rolls on a turntable keeps its speed, as on a wall that turns") {
  constexpr double R = 5e-3, W = 10, from = 0.1, v = 0.05, g = 9.81, takes = 0.5;
  const HertzMindlin::Material hard{
      .youngs_modulus = 1e8, .poisson_ratio = 0.25, .restitution = 0.3, .friction = 0.8};
  const double E = hard.youngs_modulus / 2 / (1 - 0.0625);
  const double d =
      std::pow(2500 * silt::sphere_volume(R) * g / (4.0 / 3 * E * std::sqrt(R)), 2.0 / 3);
  const Vec3d place{from, 0, R - d}, rolling{W * from / (R - d), v / (R - d), W};
  const auto speed = [&](auto particles, bool belt, bool mesh, auto... policies) {
    silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{hard}, policies...};
    sim.threads = 1, sim.gravity = {0, 0, -g}, sim.time_step = 2.6e-5;
    const auto disc = [&]() -> silt::Surfaces {
      if (mesh) return silt::rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
      return floor_plane;
    };
    silt::WallSetup setup;
    if (belt)
      setup.surface_velocity = {.rate = {0, 0, W}};
    else
      setup.motion = silt::rotation({0, 0, 0}, {0, 0, 1}, W);
    sim.add_wall(disc(), hard, setup);
    sim.run(takes);
    return norm(sim.velocity(0)) / v - 1;
  };
  silt::Particles<Sphere> ball;
  ball.add({.position = place,
            .radius = R,
            .density = 2500,
            .velocity = {v, 0, 0},
            .angular_velocity = rolling});
  silt::Particles<silt::SuperEllipsoid> body;
  body.add({.form = body.add_form({.a = R, .b = R, .c = R}),
            .position = place,
            .density = 2500,
            .velocity = {v, 0, 0},
            .angular_velocity = rolling});
  CHECK(std::abs(speed(ball, false, false)) < 2e-6);
  CHECK(std::abs(speed(ball, true, false)) < 2e-6);
  CHECK(std::abs(speed(ball, true, true)) < 2e-6);
  CHECK(std::abs(speed(ball, true, false, silt::Mixed{})) < 2e-6);
  CHECK(std::abs(speed(ball, true, false, silt::SymplecticEuler{})) < 2e-6);
  CHECK(std::abs(speed(body, true, false)) < 2e-6);
  CHECK(std::abs(speed(body, false, false)) < 2e-6);
  CHECK(std::abs(speed(body, false, true)) < 2e-6);
}

// Catches work of a turntable that does not match its friction: the residual was 8e-5 of the work.
TEST_CASE("belts: a turntable that takes a ball along does the work that the ledger finds") {
  auto sim = scene(one({0.1, 0, 0.00999}));
  sim.time_step = 2e-5;
  sim.add_wall(floor_plane, rubber, {.surface_velocity = {.rate = {0, 0, 10}}});
  sim.run(0.5);
  const auto e = sim.energy();
  CHECK(e.friction > 0.3 * e.walls);
  CHECK(std::abs(e.residual()) < 1e-6 * e.walls);
}

TEST_CASE("belts: twisting friction takes a ball along up to the rate of the surface") {
  // T = 3 pi/16 mu_w a F_n, I dw/dt = T; a = sqrt(R d).
  constexpr double R = 0.01, rate = 20, mu_w = 0.4, g = 9.81;
  const double mass = 2500 * silt::sphere_volume(R), I = 0.4 * mass * R * R;
  const double d = rest(mass * g, R),
               T = 3 * boundary_test::pi / 16 * mu_w * std::sqrt(R * d) * mass * g;
  silt::Simulation sim{
      one({0, 0, R - d}), silt::EnergyLedger{},
      silt::Contacts<HertzMindlin, silt::Twisting>{rubber, {.twisting_friction = mu_w}}};
  sim.threads = 1, sim.gravity = {0, 0, -g};
  sim.add_wall(floor_plane, rubber, {.name = "belt", .surface_velocity = {.rate = {0, 0, rate}}});
  const double all = rate * I / T;  // [s] to come to the surface's rate
  sim.run(0.4 * all);
  // Within the time in which the spring is loaded, and the last part of it relaxes.
  CHECK(sim.angular_velocity(0).z == doctest::Approx(0.4 * rate).epsilon(0.02));
  CHECK(sim.wall("belt").torque.z == doctest::Approx(-T).epsilon(0.02));
  sim.run(1.2 * all);
  CHECK(sim.angular_velocity(0).z == doctest::Approx(rate).epsilon(0.01));
  const auto e = sim.energy();
  CHECK(e.walls == doctest::Approx(I * rate * rate).epsilon(0.02));  // torque times rate
  CHECK(e.rolling_resistance == doctest::Approx(0.5 * I * rate * rate).epsilon(0.02));
  CHECK(std::abs(e.residual()) < 1e-3 * e.walls);
}

TEST_CASE("belts: a drum whose surface moves at a rate does as one that turns, with rolling") {
  const auto run = [](bool belt) {
    using Rolling = silt::Both<silt::RollingEpsd, silt::Twisting>;
    silt::Simulation sim{one({0.002, 0.003, -0.0395}),
                         silt::Contacts<HertzMindlin, Rolling>{
                             rubber, {{.rolling_friction = 0.2}, {.twisting_friction = 0.4}}}};
    sim.threads = 1, sim.gravity = {0, 0, -9.81}, sim.time_step = 2e-5;
    const silt::Cylinder drum{{0, -1, 0}, {0, 1, 0}, 0.05, silt::Side::Inside};
    if (belt)
      sim.add_wall(drum, rubber, {.surface_velocity = {.rate = {0, 3, 0}}});
    else
      sim.add_wall(drum, rubber, {.motion = silt::rotation({0, 0, 0}, {0, 1, 0}, 3)});
    sim.run(0.15);
    return std::pair{sim.position(0), sim.angular_velocity(0)};
  };
  const auto [x, w] = run(true);
  const auto [y, v] = run(false);
  CHECK(norm(x - y) < 1e-8 * norm(y - Vec3d{0.002, 0.003, -0.0395}));
  CHECK(norm(w - v) < 1e-8 * norm(v));
}

TEST_CASE("belts: one that is started goes on with the same bits from a checkpoint") {
  const auto path = temporary("silt_belt.silt");
  const auto built = [&](bool is_started) {
    auto sim = scene(one({0, 0, 0.01}));
    sim.add_wall(floor_plane, rubber, {.name = "belt"});
    if (is_started) sim.set_surface_velocity("belt", {.velocity = {0.2, 0.1, 0}});
    return sim;
  };
  auto whole = built(false);
  whole.run(0.02);
  whole.set_surface_velocity("belt", {.velocity = {0.2, 0.1, 0}});
  silt::save_checkpoint(whole, path);  // lists know of a plane at rest
  whole.run(0.02);
  auto restarted = built(true);
  silt::load_checkpoint(restarted, path);
  restarted.run(0.02);
  CHECK(bits(whole) == bits(restarted));
  CHECK(whole.velocity(0).x > 0.01);
  auto other = built(false);
  CHECK(has_words(refusal<InputError>([&] { silt::load_checkpoint(other, path); }),
                  {"wall 0 'belt': moves is 'yes' in the file and 'no' in the scene"}));
  std::filesystem::remove(path);
}

TEST_CASE("set_mesh: vertices that move take a sphere along as a wall that moves does") {
  // The same plate, moved as a whole, and vertex by vertex in each step.
  const Vec3d v{0.3, -0.1, 0.2};
  const auto plate = [&](double t) {
    return silt::rectangle(Vec3d{-1, -1, 0} + t * v, {2, 0, 0}, {0, 2, 0});
  };
  const auto built = [&](silt::Motion motion) {
    auto sim = scene(one({0, 0, 0.0105}, 0.01, {0, 0, -0.2}));
    sim.add_wall(plate(0), rubber, {.name = "plate", .motion = std::move(motion)});
    sim.time_step = 2e-5;
    return sim;
  };
  auto moved = built(silt::translation(v));
  moved.run(0.1);
  auto deformed = built({});
  deformed.run(0);
  // The first step has no velocity yet; nothing touches in it.
  const auto next = [&](Sim& s) { s.set_mesh("plate", plate(s.time() + 2e-5)); };
  deformed.run(0.1, silt::at(silt::every(1e-5), next));
  CHECK(norm(moved.position(0) - deformed.position(0)) < 1e-9);
  CHECK(norm(moved.velocity(0) - deformed.velocity(0)) < 1e-7);
  CHECK(norm(moved.angular_velocity(0) - deformed.angular_velocity(0)) < 1e-5);
  CHECK(moved.velocity(0).x > 0.05);  // friction took it along
  CHECK(deformed.energy().walls == doctest::Approx(moved.energy().walls).epsilon(1e-3));
  CHECK(has_words(refusal<InputError>([&] { moved.set_mesh("plate", plate(0), 1); }),
                  {"surface 1 of wall 0 'plate' is no mesh"}));
}

TEST_CASE("set_mesh: a sphere on a membrane that bulges and is then cut misses no contact") {
  const auto membrane = [](double height, int cells) {
    std::vector<std::array<Vec3d, 3>> soup;
    const auto at = [&](int i, int j) {
      const double x = 0.1 * i / cells - 0.05, y = 0.1 * j / cells - 0.05;
      return Vec3d{x, y, height * std::cos(30 * x) * std::cos(30 * y)};
    };
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        soup.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        soup.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    return silt::TriangleMesh(soup);
  };
  silt::Particles<Sphere> p;
  for (int k = 0; k < 16; ++k)
    p.add({.position = {0.02 * (k % 4) - 0.03, 0.02 * (k / 4) - 0.03, 0.011},
           .radius = 0.008,
           .density = 2500});
  auto sim = scene(std::move(p));
  sim.add_wall(membrane(0, 8), rubber, {.name = "membrane"});
  sim.add_wall(silt::box({-0.045, -0.045, -1}, {0.045, 0.045, 1}), rubber);
  sim.time_step = 2e-5;
  std::size_t touching = 0, missed = 0;
  const auto path = temporary("silt_set_mesh.silt");
  const auto look = [&](const Sim& s) {
    const auto& mesh = *std::get<std::shared_ptr<const silt::TriangleMesh>>(s.wall(0).surfaces[0]);
    std::vector<std::array<std::size_t, 2>> listed;
    for (const auto& c : s.engine().lists.walls.candidates())
      if (c.wall == 0)
        for (const auto t : s.engine().lists.walls.facets(c)) listed.push_back({c.particle, t});
    std::sort(listed.begin(), listed.end());
    for (std::size_t k = 0; k < s.rows(); ++k)
      for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t)
        if (mesh.distance_to(t, s.position(k)) < s.radius(k))
          ++touching, missed += !std::binary_search(listed.begin(), listed.end(),
                                                    std::array{k, std::size_t{t}});
  };
  const auto wobble = [&](Sim& s) {
    look(s);
    if (s.step() % 3 == 0) s.set_mesh("membrane", membrane(0.003 * std::sin(20 * s.time()), 8));
  };
  sim.run(0.1, silt::at(silt::every(1e-5), wobble));
  CHECK(touching > 10000);
  CHECK(missed == 0);
  // A finer one: other triangles in the same place; memory of contacts stays, lists are made anew.
  sim.set_mesh("membrane", membrane(0.003 * std::sin(20 * sim.time()), 16));
  silt::save_checkpoint(sim, path);
  auto restarted = scene(one({0, 0, 0}));
  restarted.add_wall(membrane(0.003 * std::sin(20 * sim.time()), 16), rubber, {.name = "membrane"});
  restarted.add_wall(silt::box({-0.045, -0.045, -1}, {0.045, 0.045, 1}), rubber);
  silt::load_checkpoint(restarted, path);
  sim.run(0.02, silt::at(silt::every(1e-5), look));
  restarted.run(0.02);
  CHECK(missed == 0);
  CHECK(bits(sim) == bits(restarted));
  std::filesystem::remove(path);
}

TEST_CASE("finite walls: a sphere that rolls over an edge keeps its energy") {
  auto material = rubber;
  material.restitution = 1;
  const double r = 0.01, mass = 2500 * 4.0 / 3 * boundary_test::pi * r * r * r;
  auto sim = scene(one({-0.02, 0.003, r - 2e-5}, r, {0.12, 0, 0}), material);
  sim.set_angular_velocity(sim.id(0), {0, 12, 0});
  sim.add_wall(silt::open_box({-0.1, -0.1, -0.05}, {0, 0.1, 0}, {}), material, {.name = "table"});
  sim.run(0.25);
  CHECK(sim.position(0).x > 0.005);  // it has gone over the edge, and falls
  CHECK(sim.position(0).z < 0);
  const auto e = sim.energy();
  CHECK(std::abs(e.residual()) < 1e-3 * mass * 9.81 * r);
}

TEST_CASE("walls: mean load, impulse and angular impulse, also as a table") {
  const double r = 0.01, weight = 2500 * 4.0 / 3 * boundary_test::pi * r * r * r * 9.81;
  auto sim = scene(one({0.3, 0, 0.02}, r));
  sim.add_wall(floor_plane, rubber, {.name = "floor"});
  const auto path = temporary("silt_wall_series.csv");
  silt::MeanLoad load(sim, "floor");
  sim.run(1, silt::wall_series(path, "floor", silt::every(0.1)));
  // It has fallen, and bounced until it is at rest: all of the weight's impulse went to the floor.
  const auto mean = load.read(sim);
  CHECK(mean.duration == doctest::Approx(1).epsilon(1e-3));
  CHECK(mean.force.z == doctest::Approx(-weight).epsilon(2e-3));
  CHECK(mean.torque.y == doctest::Approx(0.3 * weight).epsilon(2e-3));
  const auto& wall = sim.wall("floor");
  CHECK(wall.impulse.z == doctest::Approx(-weight).epsilon(2e-3));
  CHECK(wall.angular_impulse.y == doctest::Approx(0.3 * weight).epsilon(2e-3));
  CHECK(load.read(sim).duration == 0);
  // About another point: nothing is left of it.
  sim.set_reference("floor", {0.3, 0, 0});
  CHECK(norm(sim.wall("floor").angular_impulse) < 1e-6 * weight);
  std::ifstream in(path);
  std::string line;
  std::size_t rows = 0;
  double sum = 0;
  std::getline(in, line);
  CHECK(line.find("force z [N]") != line.npos);
  for (; std::getline(in, line); ++rows) {
    std::stringstream cells(line);
    std::string cell;
    for (int k = 0; k < 4; ++k) std::getline(cells, cell, ',');
    sum += rows == 0 ? 0 : 0.1 * std::stod(cell);
  }
  CHECK(rows == 11);
  CHECK(sum == doctest::Approx(-weight).epsilon(2e-3));
  std::filesystem::remove(path);
  CHECK(has_words(
      refusal<InputError>([&] { sim.run(0.1, silt::wall_series(path, "lid", silt::every(0.1))); }),
      {"wall 'lid' is not there"}));
}

// Catches an angle that forgets whole turns, that starts anew with a new motion or drive, or that
// has the wrong sign.
TEST_CASE(
    "wall_series: angle of walls that turn, whole turns and all, through new motions and drives") {
  for (const double interval : {0.01, 0.09}) {  // a tenth of a turn, nine tenths
    auto sim = scene(one({0.3, 0, 0.05}, 0.01));
    const double rate = 20 * boundary_test::pi;  // [rad/s] ten turns a second
    sim.time_step = 5e-5;
    const Vec3d axis{0, -0.6, 0.8};
    sim.add_wall(silt::rectangle({0, 0, 1}, {0.1, 0, 0}, {0, 0.1, 0}), rubber,
                 {.name = "blade", .motion = silt::rotation({0.2, 0.1, 0}, axis, rate)});
    const auto path = temporary("silt_wall_angle.csv");
    auto series = silt::wall_series(path, "blade", silt::every(interval));
    sim.run(0.45, series);
    sim.set_drive(
        "blade",
        silt::ServoTorque{.centre = {0.2, 0.1, 0}, .axis = axis, .torque = -1, .max_rate = rate});
    sim.run(0.18, series);  // touches nothing: back at its limit
    std::ifstream in(path);
    std::string line, last;
    while (std::getline(in, line)) last = line;
    std::stringstream cells(last);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    REQUIRE(row.size() == 20);
    const double angle = rate * (0.45 - (row[0] - 0.45));  // [rad]
    CHECK(row[17] == doctest::Approx(0).epsilon(1e-6));
    CHECK(row[18] == doctest::Approx(-0.6 * angle).epsilon(1e-3));
    CHECK(row[19] == doctest::Approx(0.8 * angle).epsilon(1e-3));
    std::filesystem::remove(path);
  }
}

// Catches a mean since the checkpoint or since the start of a run, and an angle that begins anew.
TEST_CASE("wall_series: a table continued in another run or from a checkpoint is that of one run") {
  const auto table = [](const std::string& path) {
    std::ifstream in(path);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const auto made = [] {
    auto sim = scene(one({0.3, 0, 0.0099}, 0.01));
    sim.time_step = 5e-5;
    sim.add_wall(floor_plane, rubber,
                 {.name = "floor", .motion = silt::rotation({0.3, 0, 0}, {0, 0, 1}, 40)});
    return sim;
  };
  const auto whole = temporary("silt_wall_whole.csv"), parts = temporary("silt_wall_parts.csv"),
             file = temporary("silt_wall_parts.silt");
  auto sim = made();
  sim.run(0.2, silt::wall_series(whole, "floor", silt::every(0.03)));
  {
    auto first = made();
    first.run(0.04, silt::wall_series(parts, "floor", silt::every(0.03)));
    first.run(0.1 - first.time(), silt::wall_series(parts, "floor", silt::every(0.03)));
    silt::save_checkpoint(first, file);
  }
  auto second = made();
  silt::load_checkpoint(second, file);
  second.run(0.2 - second.time(), silt::wall_series(parts, "floor", silt::every(0.03)));
  CHECK(table(parts) == table(whole));
  CHECK(sim.wall("floor").turned.z == doctest::Approx(8).epsilon(1e-3));
  for (const auto& path : {whole, parts, file}) std::filesystem::remove(path);
}

}  // namespace wall_setup_test
