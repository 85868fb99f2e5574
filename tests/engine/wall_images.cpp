// silt - BSD-3-Clause, see LICENSE
// Walls repeat with a PeriodicBox: a scene in the middle of the box and the same scene at its faces
// are one, and every contact with an image is found, of the wall wherever it has gone.
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <engine/support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/shape/mesh_body.hpp>
#include <silt/simulation.hpp>

namespace wall_images_test {

namespace {

using namespace engine_test;
using silt::PeriodicBox;
using silt::Surfaces;
using silt::WallSetup;

constexpr double length = 0.125, half = length / 2, r = 0.01;  // [m] a whole number of 2^-k
constexpr HertzMindlin::Material soft{
    .youngs_modulus = 1e6, .poisson_ratio = 0.25, .restitution = 0.8, .friction = 0.4};

PeriodicBox flat_box() { return {{{0, 0, 0}, {length, length, 1}}, {true, true, false}}; }

auto scene(silt::Particles<Sphere> particles, const PeriodicBox& box, int threads = 1) {
  silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{soft}, box,
                       silt::EnergyLedger{}};
  sim.threads = threads;
  return sim;
}
using Sim = decltype(scene({}, flat_box()));

silt::Particles<Sphere> one(const Vec3d& position, const Vec3d& velocity, const Vec3d& spin = {}) {
  silt::Particles<Sphere> p;
  p.add({.position = position,
         .radius = r,
         .density = 2500,
         .velocity = velocity,
         .angular_velocity = spin});
  return p;
}

/// A wall in the middle of the box, moved by `way` [m].
struct Case {
  std::string name;
  std::function<void(Sim&, const Vec3d& way)> add;
};

Vec3d middle(const Vec3d& way) { return Vec3d{half, half, 0} + way; }

std::vector<Case> cases() {
  const auto plate = [](const Vec3d& way) {
    return silt::rectangle(middle(way) - Vec3d{0.025, 0.025, 0}, {0.05, 0, 0}, {0, 0.05, 0});
  };
  std::vector<Case> all;
  const auto at_rest = [&](const char* name, auto surface) {
    all.push_back({name, [surface](Sim& sim, const Vec3d& way) {
                     sim.add_wall(surface(middle(way)), soft);
                   }});
  };
  all.push_back({"plate", [=](Sim& sim, const Vec3d& way) { sim.add_wall(plate(way), soft); }});
  at_rest("disc", [](const Vec3d& c) { return silt::disc(c, {0, 0, 1}, 0.025); });
  at_rest("capped cylinder", [](const Vec3d& c) {
    return silt::capped_cylinder(c - Vec3d{0.025, 0, 0.015}, c + Vec3d{0.025, 0, -0.015}, 0.015);
  });
  at_rest("shaft", [](const Vec3d& c) {
    return silt::Cylinder{c - Vec3d{0.025, 0.02, 0.015}, c + Vec3d{0.025, 0.02, -0.015}, 0.015,
                          silt::Side::Outside};
  });
  at_rest("hill", [](const Vec3d& c) {
    return silt::Cone{c - Vec3d{0, 0, 0.04}, c, 0.04, 0, silt::Side::Outside};
  });
  at_rest("gutter", [](const Vec3d& c) {  // repeats along its axis
    return silt::Cylinder{c + Vec3d{-0.025, 0, 0.03}, c + Vec3d{0.025, 0, 0.03}, 0.03,
                          silt::Side::Inside};
  });
  all.push_back({"belt", [=](Sim& sim, const Vec3d& way) {
                   sim.add_wall(plate(way), soft,
                                {.surface_velocity = {.velocity = {0.1, 0.05, 0},
                                                      .rate = {0, 0, 3},
                                                      .centre = middle(way)}});
                 }});
  all.push_back({"turning blade", [](Sim& sim, const Vec3d& way) {
                   const Vec3d c = middle(way);
                   sim.add_wall(
                       silt::box_mesh(c - Vec3d{0.03, 0.02, 0.004}, c + Vec3d{0.03, 0.02, 0}), soft,
                       {.motion = silt::rotation(c, {0.1, 0.3, 1}, 4)});
                 }});
  all.push_back({"sliding plate", [=](Sim& sim, const Vec3d& way) {
                   sim.add_wall(plate(way), soft, {.motion = silt::translation({0.4, 0.3, 0})});
                 }});
  all.push_back({"plate on a spring", [=](Sim& sim, const Vec3d& way) {
                   sim.add_wall(plate(way), soft,
                                {.drive = silt::Slide{.direction = {0, 0, 1},
                                                      .mass = 0.02,
                                                      .stiffness = 400,
                                                      .damping = 0.5}});
                 }});
  all.push_back({"flap", [=](Sim& sim, const Vec3d& way) {
                   sim.add_wall(plate(way), soft,
                                {.drive = silt::Hinge{.centre = middle(way),
                                                      .axis = {1, 1, 0},
                                                      .inertia = 2e-5,
                                                      .mass = 0.02,
                                                      .centre_of_mass = middle(way),
                                                      .stiffness = 0.05}});
                 }});
  return all;
}

constexpr double step = 2e-5;  // [s]

/// The largest difference of two scenes that are `way` [m] apart: of places, velocities and spins
/// [m, m/s, m/s], and of force and torque of wall 0 [N, N m], relative to the largest.
struct Difference {
  double motion = 0, load = 0, largest_load = 0;
};
Difference difference(const Sim& a, const Sim& b, const Vec3d& way) {
  Difference d;
  for (std::size_t k = 0; k < a.rows(); ++k) {
    const Vec3d apart = b.domain().shortest(b.position(k) - a.position(k) - way);
    d.motion = std::max({d.motion, norm(apart), norm(a.velocity(k) - b.velocity(k)),
                         r * norm(a.angular_velocity(k) - b.angular_velocity(k))});
  }
  const auto &wa = a.wall(0), &wb = b.wall(0);
  d.load = norm(wa.force - wb.force) + norm(wa.torque - wb.torque) / r;
  d.largest_load = norm(wa.force);
  return d;
}

}  // namespace

TEST_CASE("wall_images: a grain that bounces, slides and falls off a wall does the same, to 1e-9, "
          "where the wall lies at the corner of a periodic box") {
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    // Half of the box off: the wall is seen in four parts. The other ways put it into other boxes.
    for (Vec3d way : {Vec3d{half, half, 0}, Vec3d{-half, 5 * length, 0}}) {
      if (c.name == "gutter") way.y = 0;  // it does not repeat across its axis
      const Vec3d start = Vec3d{half - 0.012, half - 0.006, 0.013}, velocity{0.25, 0.1, -0.3},
                  spin{3, -10, 20};
      Sim a = scene(one(start, velocity, spin), flat_box());
      Sim b = scene(one(a.domain().wrapped(start + way), velocity, spin), flat_box());
      for (auto* const sim : {&a, &b}) {
        sim->gravity = {0, 0, -9.81};
        sim->time_step = step;
      }
      c.add(a, {0, 0, 0}), c.add(b, way);
      b.set_reference(0, a.wall(0).reference + way);
      double motion = 0, load = 0, largest = 0;
      std::size_t touching = 0;
      for (int piece = 0; piece < 400; ++piece) {
        a.run(20 * step), b.run(20 * step);
        const Difference d = difference(a, b, way);
        motion = std::max(motion, d.motion), load = std::max(load, d.load);
        largest = std::max(largest, d.largest_load);
        touching += d.largest_load > 0;
      }
      CHECK(touching > 10);  // it has touched the wall for a while
      // Places are rounded to 1e-17 m; a few bounces amplify that by 1e3 or less.
      CHECK(motion < 1e-9);
      CHECK(load < 1e-7 * largest);
    }
  }
}

TEST_CASE("wall_images: a floor of a mesh that ends at the faces is one floor: a grain that rolls "
          "and slides over them moves as on a wide one, and its friction goes on") {
  // Exactly as long as the box, and longer by less than what a grain reaches, so that it overlaps
  // its own image.
  for (const double more : {0.0, 0.003}) {
    CAPTURE(more);
    const auto run = [&](bool mesh) {
      Sim sim = scene(one({0.9 * length, 0.95 * length, r}, {0.5, 0.3, 0}, {0, 0, 5}), flat_box());
      sim.gravity = {0, 0, -9.81}, sim.time_step = step;
      if (mesh)
        sim.add_wall(silt::rectangle({-more, -more, 0}, {length + 2 * more, 0, 0},
                                     {0, length + 2 * more, 0}),
                     soft);
      else
        // It covers the box, so that it has no seams.
        sim.add_wall(silt::rectangle({-1, -1.5, 0}, {3, 0, 0}, {0, 3, 0}), soft);
      std::vector<Vec3d> all;
      for (int piece = 0; piece < 200; ++piece) {
        sim.run(50 * step);
        const Vec3d p = sim.position(0);
        all.push_back(sim.velocity(0)), all.push_back(r * sim.angular_velocity(0));
        all.push_back({0, 0, p.z}), all.push_back(sim.wall(0).force);
      }
      return all;
    };
    const auto on_mesh = run(true), on_wide = run(false);
    double most = 0;
    for (std::size_t k = 0; k < on_mesh.size(); ++k)
      most = std::max(most, norm(on_mesh[k] - on_wide[k]));
    CHECK(most < 1e-9);
  }
}

namespace {

/// Grains in a box that repeats in x and y, above a floor, and a blade that turns while it is carried along x.
Sim stirred(int threads) {
  silt::Particles<Sphere> p;
  p.fill({{0.002, 0.002, 0.04}, {length - 0.002, length - 0.002, 0.11}},
         {.radius = silt::uniform(0.004, 0.006),
          .density = 2500,
          .count = 150,
          .arrangement = silt::Arrangement::Random});
  Sim sim = scene(std::move(p), flat_box(), threads);
  sim.gravity = {0, 0, -9.81}, sim.time_step = step;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, soft);
  const Vec3d centre{half, half, 0.02};
  sim.add_wall(silt::box_mesh(centre - Vec3d{0.03, 0.002, 0.015}, centre + Vec3d{0.03, 0.002, 0.015}),
               soft,
               {.name = "blade",
                .motion = silt::combined(silt::rotation(centre, {0, 0, 1}, 10),
                                         silt::translation({0.6, 0, 0}))});
  return sim;
}

/// Contacts of all grains with the blade, looked for in all images that it comes to: how many, and the
/// sum of their overlaps [m] and of their normals.
struct Seen {
  std::size_t count = 0;
  double overlap = 0;
  Vec3d normal{0, 0, 0};
};
Seen by_brute_force(const Sim& sim) {
  const auto& wall = sim.wall(1);
  const auto& mesh = *std::get<std::shared_ptr<const silt::TriangleMesh>>(wall.surfaces[0]);
  std::vector<std::uint32_t> all(mesh.triangles().size());
  for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
  Seen seen;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    for (int x = -1; x <= 3; ++x)
      for (int y = -1; y <= 1; ++y) {
        const Vec3d place = sim.position(k) + length * Vec3d{1. * x, 1. * y, 0};
        silt::SurfacePoint points[silt::TriangleMesh::max_contacts];
        const int n = mesh.contacts(wall.pose.to_body(place), sim.radius(k), all, points);
        for (int c = 0; c < n; ++c) {
          ++seen.count, seen.overlap += sim.radius(k) - points[c].distance;
          seen.normal += wall.pose.rotate(points[c].normal);
        }
      }
  return seen;
}

}  // namespace

TEST_CASE("wall_images: a blade that turns and is carried through a periodic bed for two lengths of the "
          "box meets what brute force over its images finds, each contact once and beside its grain") {
  Sim sim = stirred(1);
  std::size_t contacts = 0, wrong = 0, away = 0;
  double off = 0;
  sim.run(0.42, silt::at(silt::every(0.002), [&](const Sim& now) {
            Seen seen;
            now.for_each_contact([&](const silt::ContactSeen& c) {
              if (c.wall != 1) return;
              ++seen.count, seen.overlap += c.overlap, seen.normal += c.normal;
              away += norm(c.point - now.position(c.place_a)) > now.radius(c.place_a);
            });
            const Seen wanted = by_brute_force(now);
            contacts += wanted.count, wrong += seen.count != wanted.count;
            off = std::max(off, std::abs(seen.overlap - wanted.overlap) +
                                    r * norm(seen.normal - wanted.normal));
          }));
  CHECK(sim.wall(1).pose.to_space({half, half, 0.02}).x > 2 * length);
  CHECK(contacts > 300);
  CHECK(wrong == 0);
  CHECK(off < 1e-12);
  CHECK(away == 0);
}

TEST_CASE("wall_images: threads do not change a bit of it, nor does going on from a checkpoint") {
  Sim one_thread = stirred(1), three = stirred(3);
  const auto path = (std::filesystem::temp_directory_path() / "silt_wall_images.ckp").string();
  one_thread.run(0.15), three.run(0.15);
  CHECK(bits(one_thread) == bits(three));
  silt::save_checkpoint(one_thread, path);
  Sim loaded = stirred(1);
  silt::load_checkpoint(loaded, path);
  std::filesystem::remove(path);
  one_thread.run(0.1), loaded.run(0.1);
  CHECK(bits(one_thread) == bits(loaded));
  CHECK(one_thread.wall(1).impulse == loaded.wall(1).impulse);
}

TEST_CASE("wall_images: momentum of grains and of a free body that drifts out of a periodic box is kept "
          "to rounding") {
  silt::Particles<Sphere> p;
  const PeriodicBox box{{{0, 0, 0}, {length, length, length}}, {true, true, true}};
  p.fill({{0, 0, 0.04}, {length, length, length - 0.002}},
         {.radius = 0.006, .density = 2500, .count = 60, .arrangement = silt::Arrangement::Random});
  Sim sim = scene(std::move(p), box);
  sim.time_step = step;
  const auto mesh = silt::box_mesh({half, half, 0.005}, {half + 0.03, half + 0.02, 0.025});
  auto body = silt::free_body(mesh, 1500);
  body.velocity = {1.5, 0.9, 0.8}, body.angular_velocity = {5, 10, -20};
  sim.add_wall(mesh, soft, {.drive = body});
  const auto momentum = [&] {
    Vec3d sum = body.mass * sim.wall(0).state.velocity_now;
    for (std::size_t k = 0; k < sim.rows(); ++k) sum += sim.mass(k) * sim.velocity(k);
    return sum;
  };
  sim.run(step);
  const Vec3d before = momentum(), start = sim.wall(0).state.velocity_now;
  double lost = 0;
  for (int piece = 0; piece < 50; ++piece) {
    sim.run(0.01);
    lost = std::max(lost, norm(momentum() - before));
  }
  CHECK(norm(sim.wall(0).state.velocity_now - start) > 0.1);  // it was hit
  CHECK(norm(sim.wall(0).state.centre) > 2 * length);
  CHECK(lost < 1e-12 * norm(before));
}

TEST_CASE("wall_images: inlets leave room for images of walls, and a grain in one overlaps it at the start") {
  const auto shelf = [](Sim& sim) {  // its image is at x from 0.095 m to the face
    sim.time_step = step;
    sim.add_wall(silt::rectangle({-0.03, 0, 0.02}, {0.03, 0, 0}, {0, length, 0}), soft);
  };
  Sim sim = scene(one({half, half, 0.5}, {}), flat_box());
  shelf(sim);
  sim.add_inlet(Box{{0.09, 0.01, 0}, {0.12, 0.11, 0.04}},
                {.radius = 0.004, .density = 2500, .rate = 1e6, .total = 30, .interval = 1e-4});
  sim.run(10 * step);
  CHECK(sim.size() > 5);
  std::size_t in_image = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    const Vec3d p = sim.position(k);
    in_image += p.x > 0.095 && std::abs(p.z - 0.02) < 0.004 - 1e-6;
  }
  CHECK(in_image == 0);

  Sim deep = scene(one({0.11, half, 0.021}, {}), flat_box());
  shelf(deep);
  CHECK(has_words(refusal<silt::Error>([&] { deep.run(10 * step); }), {"overlap", "wall 0"}));
}

}  // namespace wall_images_test
