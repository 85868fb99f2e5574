// silt - BSD-3-Clause, see LICENSE
// No contact is ever missed: at every step of flowing scenes, all pairs and walls that touch at
// that instant (looked for without any list) must stand in the lists that the forces were computed
// from.
#include <numeric>
#include <set>

#include <boundary/support.hpp>
#include <engine/support.hpp>

#include <silt/contact/linear_spring.hpp>
#include <silt/search/brute_force.hpp>

namespace list_upkeep_test {

namespace {

using namespace engine_test;

/// Called at every step. Positions, poses and lists are those of the forces just computed.
struct Watch {
  std::size_t touching_pairs = 0, touching_walls = 0;  // [-] seen, summed over the steps
  std::size_t missed_pairs = 0, missed_walls = 0, doubled_pairs = 0;
  std::set<std::int64_t> searches, prunings;  // steps at which they happened

  template <class Sim>
  void operator()(const Sim& sim) {
    look_at_pairs(sim), look_at_walls(sim);
    searches.insert(sim.engine().lists.upkeep.searched_at);
    prunings.insert(sim.engine().lists.upkeep.pruned_at);
  }

 private:
  template <class Sim>
  void look_at_pairs(const Sim& sim) {
    const auto& e = sim.engine();
    using Pair = std::array<std::uint32_t, 2>;
    std::vector<Pair> listed;
    e.lists.pairs.for_each([&](std::size_t k) {
      const std::uint32_t a = e.lists.pairs.first()[k], b = e.lists.pairs.second()[k];
      listed.push_back({std::min(a, b), std::max(a, b)});
    });
    std::sort(listed.begin(), listed.end());
    doubled_pairs += std::adjacent_find(listed.begin(), listed.end()) != listed.end();
    std::vector<silt::PositionRow> rows;
    std::vector<std::uint32_t> places;
    for (std::uint32_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k)) rows.push_back(e.particles.position[k]), places.push_back(k);
    std::vector<silt::IndexPair> touching;
    silt::BruteForce{}.find({rows, e.particles.largest_radius}, 0, sim.domain(), silt::Team(),
                            touching);
    touching_pairs += touching.size();
    for (auto& [a, b] : touching) a = places[a], b = places[b];
    for (const auto& [a, b] : touching)
      missed_pairs +=
          !std::binary_search(listed.begin(), listed.end(), Pair{std::min(a, b), std::max(a, b)});
  }

  template <class Sim>
  void look_at_walls(const Sim& sim) {
    const auto& e = sim.engine();
    // particle, wall, surface, triangle (0 for primitives)
    std::vector<std::array<std::size_t, 4>> listed;
    for (const auto& c : e.lists.walls.candidates()) {
      if (c.facet_count == 0) listed.push_back({c.particle, c.wall, c.surface, 0});
      for (const auto t : e.lists.walls.facets(c))
        listed.push_back({c.particle, c.wall, c.surface, t});
    }
    std::sort(listed.begin(), listed.end());
    for (std::size_t w = 0; w < e.walls.size(); ++w)
      for (std::size_t s = 0; s < e.walls[w].surfaces.size(); ++s)
        for (std::size_t p = 0; p < e.particles.size(); ++p)
          silt::detail::visit_surface(e.walls[w].surfaces[s], [&](const auto& surface) {
            const auto& row = e.particles.position[p];
            for (const auto t : touched(surface, e.walls[w].pose.to_body(row.centre()), row.r)) {
              ++touching_walls;
              missed_walls +=
                  !std::binary_search(listed.begin(), listed.end(), std::array{p, w, s, t});
            }
          });
  }

  /// The triangles of a mesh that a sphere touches; {0} or nothing for a primitive.
  template <class Surface>
  static std::vector<std::size_t> touched(const Surface& surface, const Vec3d& centre, double r) {
    std::vector<std::size_t> found;
    if constexpr (requires { surface.distance_to(0, centre); }) {
      for (std::uint32_t t = 0; t < surface.triangles().size(); ++t)
        if (surface.distance_to(t, centre) < r) found.push_back(t);
    } else {
      silt::SurfacePoint points[Surface::max_contacts];
      if (surface.contacts(centre, r, points) > 0) found.push_back(0);
    }
    return found;
  }
};

silt::VerletList<> fixed_skin(double skin) { return {.skin = skin}; }

/// Spheres in the upper half of a box of 16 mm, which is 20 diameters of the smallest wide.
silt::Particles<Sphere> falling(double speed, std::size_t count = 150) {
  silt::Particles<Sphere> p;
  p.fill({{1e-3, 1e-3, 7e-3}, {15e-3, 15e-3, 15e-3}}, {.radius = silt::uniform(0.4e-3, 0.9e-3),
                                                       .density = 2500,
                                                       .count = count,
                                                       .arrangement = silt::Arrangement::Random});
  silt::Random random(11);
  for (std::size_t k = 0; k < p.size(); ++k)
    p[k].velocity = {random.uniform(-speed, speed), random.uniform(-speed, speed),
                     random.uniform(-speed, speed)};
  return p;
}

auto open_scene(double speed, const silt::VerletList<>& search,
                const HertzMindlin::Material& material = rubber) {
  silt::Simulation sim{falling(speed), silt::Contacts<HertzMindlin>{material}, search};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  return sim;
}

HertzMindlin::Material stiffer(double times) {
  auto material = rubber;
  material.youngs_modulus *= times;
  return material;
}

/// A paddle from a closed mesh of 12 triangles, in the lower half of the box.
silt::TriangleMesh paddle() {
  return silt::TriangleMesh(boundary_test::box_soup({3e-3, 7.6e-3, 1e-3}, {13e-3, 8.4e-3, 6e-3}));
}

Vec3d direction(silt::Random& random) {
  return normalised(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), 1});
}

void check(const Watch& watch) {
  CHECK(watch.missed_pairs == 0);
  CHECK(watch.missed_walls == 0);
  CHECK(watch.doubled_pairs == 0);
  CHECK(watch.touching_pairs > 300);  // otherwise the scene would show nothing
}

}  // namespace

TEST_CASE("list_upkeep: no contact is missed while spheres fall into a box, whatever the skin") {
  for (const auto& search :
       {silt::VerletList<>{}, fixed_skin(0.3e-3), fixed_skin(3e-5), fixed_skin(3e-3)}) {
    auto sim = open_scene(0.3, search);
    sim.add_wall(silt::box({0, 0, 0}, {16e-3, 16e-3, 16e-3}), rubber);
    Watch watch;
    sim.run(0.02, watch);
    CAPTURE(search.skin.value_or(0));
    check(watch);
    CHECK(watch.touching_walls > 100);
    CHECK(watch.prunings.size() >= watch.searches.size());
    if (search.skin != 3e-3) CHECK(watch.searches.size() > 3);
  }
}

TEST_CASE("list_upkeep: no contact of fast spheres is missed, skins shorter than a step included") {
  for (const auto& search : {silt::VerletList<>{}, fixed_skin(0.2e-3), fixed_skin(1e-6)}) {
    const auto hard = stiffer(100);
    auto sim = open_scene(5, search, hard);
    sim.add_wall(silt::box({0, 0, 0}, {16e-3, 16e-3, 16e-3}), hard);
    Watch watch;
    sim.run(4e-3, watch);
    CAPTURE(search.skin.value_or(0));
    check(watch);
    CHECK(watch.touching_walls > 100);
    // 5 m/s times a step of 1e-6 s is longer than the shortest skin: a search a step.
    if (search.skin == 1e-6)
      CHECK(watch.searches.size() + 1 >= static_cast<std::size_t>(sim.step()));
  }
}

TEST_CASE("list_upkeep: no contact with moving walls is missed") {
  const Vec3d centre{8e-3, 8e-3, 8e-3};
  for (const auto& search : {silt::VerletList<>{}, fixed_skin(0.3e-3), fixed_skin(2e-6)}) {
    auto sim = open_scene(0.2, search);
    // Sides at rest, a floor that shakes, a lid that comes down, a paddle that stirs and a drum
    // that wobbles about an axis of its own.
    sim.add_wall(silt::box({0, 0, -4e-3}, {16e-3, 16e-3, 30e-3}), rubber);
    sim.add_wall(silt::Plane{{0, 0, 0.5e-3}, {0, 0, 1}}, rubber,
                 silt::vibration({0, 0, 0.5e-3}, 120));
    sim.add_wall(silt::Plane{{0, 0, 17e-3}, {0, 0, -1}}, rubber, silt::translation({0, 0, -0.2}));
    sim.add_wall(paddle(), rubber, silt::rotation(centre, {0, 0, 1}, 60));
    sim.add_wall(silt::Cylinder{centre - Vec3d{0, 0, 0.02}, centre + Vec3d{0, 0, 0.02}, 10e-3,
                                silt::Side::Inside},
                 rubber, silt::rotation(centre + Vec3d{0.5e-3, 0, 0}, {0.1, 0.2, 1}, 40));
    Watch watch;
    sim.run(0.02, watch);
    CAPTURE(search.skin.value_or(0));
    check(watch);
    CHECK(watch.touching_walls > 1000);
  }
}

TEST_CASE(
    "list_upkeep: no first touch is missed where the bounds are sharp: head on, and by walls") {
  // Nothing but the two that meet moves, so that nothing else renews the lists; gaps from within
  // the inner skin to beyond the outer one.
  const Vec3d up{0, 0, 1}, centre{8e-3, 8e-3, 3.5e-3};
  for (const auto& search : {silt::VerletList<>{}, fixed_skin(0.2e-3)})
    for (int k = 1; k <= 40; ++k) {
      const double gap = 1e-5 * k * (1 + 0.01 * k);  // [m]
      const auto still = [&](std::initializer_list<silt::Particles<Sphere>::Particle> spheres) {
        silt::Particles<Sphere> p;
        for (const auto& s : spheres) p.add(s);
        silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, search};
        sim.time_step = 4e-6;
        sim.threads = 1;
        return sim;
      };
      const auto meets = [&](auto sim) {
        Watch watch;
        sim.run(1.5e-3, watch);
        CAPTURE(gap);
        CHECK(watch.touching_pairs + watch.touching_walls > 0);
        CHECK(watch.missed_pairs == 0);
        CHECK(watch.missed_walls == 0);
      };
      const auto by_wall = [&](const silt::Surfaces& surfaces, const silt::Motion& motion,
                               const Vec3d& place) {
        auto sim = still({{.position = place, .radius = 1e-3, .density = 2500}});
        sim.add_wall(surfaces, rubber, motion);
        meets(std::move(sim));
      };
      meets(still({{.position = {-1e-3 - gap / 2, 0, 0},
                    .radius = 1e-3,
                    .density = 2500,
                    .velocity = {0.5, 0, 0}},
                   {.position = {1e-3 + gap / 2, 0, 0},
                    .radius = 1e-3,
                    .density = 2500,
                    .velocity = {-0.5, 0, 0}}}));
      by_wall(silt::Plane{{0, 0, 0}, up}, silt::translation(up), {0, 0, 1e-3 + gap});
      by_wall(silt::Plane{{0, 0, 0}, up}, silt::vibration(up * 1e-3, 200), {0, 0, 1e-3 + gap});
      by_wall(paddle(), silt::rotation(centre, up, 200), centre + Vec3d{4e-3, 1.4e-3 + gap, 0});
      by_wall(silt::Cylinder{centre - up, centre + up, 9e-3, silt::Side::Inside},
              silt::rotation(centre + Vec3d{0, 20e-3, 0}, up, 50),
              centre + Vec3d{-8e-3 + gap, 0, 0});
    }
}

TEST_CASE("list_upkeep: no contact is missed while spheres enter, leave and a lid is taken away") {
  for (const auto& search : {silt::VerletList<>{}, fixed_skin(0.2e-3)}) {
    const auto firm = stiffer(10);
    auto sim = open_scene(1, search, firm);
    sim.add_wall(silt::box({0, 0, -20e-3}, {16e-3, 16e-3, 40e-3}), firm);
    const auto lid = sim.add_wall(silt::Plane{{0, 0, 5e-3}, {0, 0, 1}}, firm);
    const auto outlet = sim.add_outlet({{0, 0, -30e-3}, {16e-3, 16e-3, 4e-3}});
    const auto inlet = sim.add_inlet(Box{{2e-3, 2e-3, 20e-3}, {14e-3, 14e-3, 24e-3}},
                                     {.radius = silt::uniform(0.3e-3, 1e-3),
                                      .density = 2500,
                                      .rate = 8000,
                                      .velocity = {0, 0, -1}});
    Watch watch;
    sim.run(5e-3, watch);
    sim.remove_wall(lid);
    silt::Particles<Sphere> late;
    late.add(
        {.position = {8e-3, 8e-3, 30e-3}, .radius = 2e-3, .density = 2500, .velocity = {0, 0, -3}});
    sim.add(late);
    sim.run(0.01, watch);
    check(watch);
    CHECK(sim.outlet(outlet).count > 20);
    CHECK(sim.inlet(inlet).placed > 80);
    CHECK(sim.size() == 151 + sim.inlet(inlet).placed - sim.outlet(outlet).count);
  }
}

TEST_CASE("list_upkeep: no contact is missed across the faces of a repeating box") {
  for (const auto& search : {silt::VerletList<>{}, fixed_skin(0.2e-3), fixed_skin(1e-6)}) {
    // The box fits the spheres tightly: nearly all contacts at its faces cross them.
    silt::Simulation sim{
        falling(1), silt::Contacts<silt::LinearSpring>{{.stiffness = 2000}}, search,
        silt::PeriodicBox{{{1e-3, 1e-3, 7e-3}, {15e-3, 15e-3, 15e-3}}, {true, true, true}}};
    sim.time_step = 2e-6;
    sim.threads = 1;
    Watch watch;
    sim.run(5e-3, watch);
    check(watch);
    CHECK(watch.searches.size() > 3);
  }
}

// Catches a newcomer's pair that is in no list, or in two; reaches of older particles that forget
// what they have moved since the search; a search for each newcomer.
TEST_CASE(
    "list_upkeep: single newcomers join the lists without a search, and no contact is missed") {
  const auto rain = [](auto sim, std::size_t least_walls) {
    sim.time_step = 2e-6, sim.threads = 1;
    sim.guard.max_overlap = 10, sim.guard.through_meshes = true;  // they come right into others
    Watch watch;
    silt::Random random(5);
    std::size_t births = 0;
    sim.run(6e-3, watch, [&](auto& s) {
      if (s.step() % 3 != 0 || s.step() < 30) return;
      silt::Particles<Sphere> one;
      // At some particle's side, from touching to just out of reach, slow or fast.
      const auto k = static_cast<std::size_t>(random.uniform(0, static_cast<double>(s.rows())));
      const double r = random.uniform(0.2e-3, 0.4e-3), speed = births % 5 == 0 ? 1 : 0.1;
      const Vec3d way = direction(random);
      one.add({.position = s.position(k) + (s.radius(k) + r * random.uniform(0.98, 1.5)) * way,
               .radius = r,
               .density = 2500,
               .velocity = speed * way});
      s.add(one), ++births;
    });
    check(watch);
    CHECK(watch.touching_walls >= least_walls);
    CHECK(births > 900);
    CHECK(watch.searches.size() < births / 4);
  };
  std::vector searches{silt::VerletList<>{}};
#ifdef SILT_LONG_TESTS
  searches.push_back(fixed_skin(0.4e-3));
#endif
  for (const auto& search : searches) {
    const silt::Contacts<silt::LinearSpring> soft{{.stiffness = 2}};
    rain(silt::Simulation{falling(0.2, 240), soft, search,
                          silt::PeriodicBox{{{1e-3, 1e-3, 7e-3}, {15e-3, 15e-3, 15e-3}},
                                            {true, true, true}}},
         0);
    silt::Simulation sim{falling(0.2, 240), soft, search};
    const silt::LinearSpring::Material wall{.stiffness = 2};
    sim.add_wall(silt::box({0, 0, 0}, {16e-3, 16e-3, 20e-3}), wall);
    sim.add_wall(paddle(), wall, silt::rotation({8e-3, 8e-3, 8e-3}, {0, 0, 1}, 60));
    rain(std::move(sim), 1000);
  }
}

// Catches growth that is not charged to the inner reach, the outer reach, or to what was used of
// the inner one before.
TEST_CASE("list_upkeep: spheres grow and shrink without a search, and no contact is missed") {
  const auto swell = [](auto sim, std::size_t least_walls) {
    sim.time_step = 2e-6, sim.threads = 1;
    sim.guard.max_overlap = 10, sim.guard.through_meshes = true;
    Watch watch;
    silt::Random random(7);
    std::size_t changes = 0;
    sim.run(6e-3, watch, [&](auto& s) {
      if (s.step() < 30) return;
      for (int c = 0; c < 3; ++c, ++changes) {
        const auto k = static_cast<std::size_t>(random.uniform(0, static_cast<double>(s.rows())));
        const double r = s.radius(k) * (1 + random.uniform(-0.03, 0.03));
        s.set_radius(s.id(k), std::clamp(r, 0.15e-3, 0.8e-3));
      }
    });
    check(watch);
    CHECK(watch.touching_walls >= least_walls);
    CHECK(changes > 8000);
    CHECK(watch.searches.size() < changes / 20);
  };
  for (const auto& search : {silt::VerletList<>{}, fixed_skin(0.4e-3)}) {
    const silt::Contacts<silt::LinearSpring> soft{{.stiffness = 2}};
    swell(silt::Simulation{falling(0.2, 240), soft, search,
                           silt::PeriodicBox{{{1e-3, 1e-3, 7e-3}, {15e-3, 15e-3, 15e-3}},
                                             {true, true, true}}},
          0);
    silt::Simulation sim{falling(0.2, 240), soft, search};
    const silt::LinearSpring::Material wall{.stiffness = 2};
    sim.add_wall(silt::box({0, 0, 0}, {16e-3, 16e-3, 20e-3}), wall);
    sim.add_wall(paddle(), wall, silt::rotation({8e-3, 8e-3, 8e-3}, {0, 0, 1}, 60));
    swell(std::move(sim), 1000);
  }
}

// A wall sinks by less than it may since the pruning, a newcomer joins far away, and the wall comes
// back to beyond where it was. Catches wall contacts that are chosen anew at that moment as if the
// wall had not moved: it may go twice as far then before the next pruning.
TEST_CASE("list_upkeep: no touch is missed of a wall that was away when a particle came or left") {
  constexpr double speed = 0.5, dt = 1e-6;  // [m/s], [s]
  const auto run = [&](double depth, double height, auto&& edit) {
    silt::Particles<Sphere> p;
    p.add({.position = {0, 0, 1e-3 + height}, .radius = 1e-3, .density = 2500});
    for (const double x : {0.1, 0.2})
      p.add({.position = {x, 0, 1e-3 + height + 1e-5}, .radius = 1e-3, .density = 2500});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
    sim.time_step = dt;
    sim.threads = 1;
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, rubber, [=](double t) {
      const double back = depth / speed;  // [s]
      return silt::Pose{{}, {0, 0, t < back ? -speed * t : -depth + speed * (t - back)}};
    });
    sim.run(0);
    const auto& upkeep = sim.engine().lists.upkeep;
    const double q = upkeep.inner[0], Q = upkeep.inner_wall;
    Watch watch;
    if (depth < 1) {
      sim.run(depth / speed);
      edit(sim);
      sim.run((depth + height) / speed + 20 * dt, watch);
      CHECK(watch.touching_walls > 10);
      CHECK(watch.missed_walls == 0);
    }
    return std::pair{q, Q};
  };
  const auto nothing = [](auto&) {};
  const auto [q, Q] = run(1, 1e-3, nothing);
  REQUIRE(Q > 2 * q);
  const double depth = 0.9 * Q, height = 1.1 * (q + Q) - depth;
  run(depth, height, [](auto& sim) {
    silt::Particles<Sphere> one;
    one.add({.position = {5, 0, 5}, .radius = 1e-3, .density = 2500});
    sim.add(one);
  });
  run(depth, height, [](auto& sim) { sim.remove(1); });
}

// With a skin of 0.4 mm spheres and walls reach 0.2 mm in the outer list, 0.04 mm in the inner one.
// Each scene closes a gap that is just too wide for a list at the newcomer's birth, before its
// particles have used up their reaches. Catches a term of the proof (newcomers.hpp) left out: the
// way that the older particle, or the wall, had gone the other way; the newcomer's first drift.
TEST_CASE("list_upkeep: no first touch of a newcomer is missed where the bounds are sharp") {
  constexpr double r = 1e-3, v = 0.1, away = 1.5e-4, gap = 4.2e-4;  // [m], [m/s]
  using Spheres = silt::Particles<Sphere>;
  const auto scene = [&](const Vec3d& velocity) {
    Spheres p;
    p.add({.position = {0, 0, 0}, .radius = r, .density = 2500, .velocity = velocity});
    silt::Simulation sim{std::move(p), silt::Contacts<HertzMindlin>{rubber}, fixed_skin(4e-4)};
    sim.time_step = 2e-6;
    sim.threads = 1;
    return sim;
  };
  const auto born = [&](auto& sim, const Vec3d& place, const Vec3d& velocity) {
    Spheres one;
    one.add({.position = place, .radius = r, .density = 2500, .velocity = velocity});
    sim.add(one);
  };
  const auto meet = [&](auto& sim, double duration) {
    const auto searched = sim.engine().lists.upkeep.searched_at;
    Watch watch;
    sim.run(duration, watch);
    CHECK(watch.touching_pairs + watch.touching_walls > 0);
    CHECK(watch.missed_pairs == 0);
    CHECK(watch.missed_walls == 0);
    CHECK(sim.engine().lists.upkeep.searched_at == searched);  // else it would show nothing
  };
  const double closes = gap / (3 * v) + 5e-5;  // [s]
  {
    auto sim = scene({-2 * v, 0, 0});
    sim.run(away / (2 * v));
    sim.set_velocity(0, {2 * v, 0, 0});
    born(sim, sim.position(0) + Vec3d{2 * r + gap, 0, 0}, {-v, 0, 0});
    meet(sim, closes);
  }
  {
    auto sim = scene({0, 0, 0});
    const double back = away / (2 * v);  // [s]
    sim.add_wall(silt::Plane{{0, 0, -1}, {0, 0, 1}}, rubber, [=](double t) {
      return silt::Pose{{}, {0, 0, 2 * v * (t < back ? -t : t - 2 * back)}};
    });
    sim.run(back);
    born(sim, {0.1, 0, -1 - away + r + gap}, {0, 0, -v});
    meet(sim, closes);
  }
  {
    auto sim = scene({0, 0, 0});
    sim.run(1e-5);
    born(sim, {2 * r + 0.9e-4, 0, 0}, {-50, 0, 0});  // 0.1 mm a step
    meet(sim, 2e-6);
  }
}

}  // namespace list_upkeep_test
