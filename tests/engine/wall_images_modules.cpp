// silt - BSD-3-Clause, see LICENSE
// Walls that repeat with a PeriodicBox: wear goes to the facet of the wall itself, heat through an
// image is heat of the wall, a drum of a mesh goes on over the faces; a checkpoint with images that
// cannot be is refused.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <engine/support.hpp>
#include <io/fuzz_support.hpp>

#include <silt/boundary/finite_walls.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/engine/lists/wall_images.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/measure/wall_wear.hpp>
#include <silt/module/heat/conduction.hpp>
#include <silt/module/wear.hpp>
#include <silt/simulation.hpp>

#include "near.hpp"

namespace wall_images_modules_test {

namespace {

using namespace engine_test;
using silt::PeriodicBox;
using Triangle = std::array<Vec3d, 3>;

constexpr double pi = 3.14159265358979323846, g = 9.81;
constexpr double length = 0.125, half = length / 2;  // [m] of the box

PeriodicBox flat_box() { return {{{0, 0, 0}, {length, length, 1}}, {true, true, false}}; }

namespace wear {

using Sliding = silt::Wear<silt::Archard>;
using Cutting = silt::Wear<silt::Finnie>;
constexpr double R = 1e-3, density = 2500, stiffness = 1e3;
const double mass = 4.0 / 3 * pi * R * R * R * density;  // [kg]
const silt::LinearSpringFriction::Material smooth{.stiffness = stiffness},
    rough{.stiffness = stiffness, .restitution = 0.5, .friction = 0.5};
const silt::Archard steel{.coefficient = 1e-4, .hardness = 2e9};
const silt::Finnie ductile{
    .flow_stress = 1e9, .share_cutting = 0.5, .depth_ratio = 2, .force_ratio = 2};

auto scene(const silt::Particles<Sphere>::Particle& one,
           const silt::LinearSpringFriction::Material& material) {
  silt::Particles<Sphere> p;
  p.add(one);
  silt::Simulation sim{std::move(p), silt::Contacts<silt::LinearSpringFriction>{material},
                       flat_box(), Sliding{steel}, Cutting{ductile}};
  sim.gravity = {0, 0, -g};
  sim.time_step = 1e-5;
  return sim;
}

/// A floor as large as the box, half a length off it, of two strips along y that meet in x = 0.
silt::TriangleMesh strips() {
  std::vector<Triangle> all;
  for (const double x : {-half, 0.0}) {
    const Vec3d a{x, -half, 0}, b{x + half, -half, 0}, c{x + half, half, 0}, d{x, half, 0};
    all.push_back({a, b, c}), all.push_back({a, c, d});
  }
  return silt::TriangleMesh(all);
}

}  // namespace wear

}  // namespace

// Catches the facet looked for beside the particle instead of at the image, which is one at the
// edge of the mesh, and a contact that counts for both images where they meet.
TEST_CASE(
    "wall_images_modules: a sphere that slides over images of a floor wears k F s/H, each strip "
    "of it in proportion to the way on it") {
  using namespace wear;
  auto sim = scene({.position = {0.35 * length, 0.8 * length, R - mass * g / stiffness},
                    .radius = R,
                    .density = density,
                    .velocity = {0.5, 0, 0}},
                   smooth);
  sim.add_wall(strips(), smooth);
  sim.run(0.75 * length / 0.5);
  const double per_way = 1e-4 * mass * g / 2e9;  // [m2]
  const auto worn = silt::worn_volumes<Sliding>(sim, 0);
  // 0.15 on the strip of x > 0, half a length on the other, whose image it is, 0.1 on the first.
  CHECK(worn[0] + worn[1] + worn[2] + worn[3] == near(per_way * 0.5 * sim.time()).epsilon(1e-9));
  // A step is 5e-6 m of ways of 0.03 m and more.
  CHECK(worn[0] + worn[1] == near(per_way * 0.5 * length).epsilon(5e-4));
  CHECK(worn[2] + worn[3] == near(per_way * 0.25 * length).epsilon(5e-4));
  CHECK(silt::worn_volume<Cutting>(sim, 0) == 0);
}

// Catches velocities of the wall beside the particle (those of a blade that turns are others at an
// image), and angles of impacts that follow from them.
TEST_CASE(
    "wall_images_modules: a blade that turns at the corner of the box is worn as the same one in "
    "its middle, facet by facet") {
  using namespace wear;
  const auto worn = [](const Vec3d& way) {
    const Vec3d c = Vec3d{half, half, 0} + way;
    const Vec3d start = Vec3d{half - 0.012, half - 0.006, 0.013} + way;
    auto sim = scene({.position = flat_box().wrapped(start),
                      .radius = 0.01,
                      .density = density,
                      .velocity = {0.25, 0.1, -0.3}},
                     rough);
    sim.add_wall(silt::box_mesh(c - Vec3d{0.03, 0.02, 0.004}, c + Vec3d{0.03, 0.02, 0}), rough,
                 {.motion = silt::rotation(c, {0.1, 0.3, 1}, 4)});
    sim.run(0.16);
    auto all = silt::worn_volumes<Sliding>(sim, 0);
    const auto cut = silt::worn_volumes<Cutting>(sim, 0);
    all.insert(all.end(), cut.begin(), cut.end());
    return all;
  };
  const auto in_the_middle = worn({0, 0, 0}), at_the_corner = worn({half, half, 0});
  double largest = 0, off = 0;
  std::size_t facets = 0;
  for (std::size_t k = 0; k < in_the_middle.size(); ++k) {
    largest = std::max(largest, in_the_middle[k]), facets += in_the_middle[k] > 0;
    off = std::max(off, std::abs(in_the_middle[k] - at_the_corner[k]));
  }
  CHECK(facets >= 3);  // two of sliding, one of impacts at least
  CHECK(off < 1e-7 * largest);
}

namespace {

namespace heat {

constexpr double R = 1e-3, d = 0.02e-3, density = 2500;  // [m], [m], [kg/m3]
// So soft that nothing moves while heat flows.
constexpr HertzMindlin::Material still{
    .youngs_modulus = 1e-14, .poisson_ratio = 0.3, .restitution = 0.9, .friction = 0.3};
const double C = 4.0 / 3 * pi * R * R * R * density * 840;  // [J/K]

/// Grains that lie d deep in a wall of this mesh at z = 0, and the temperatures [K] that they come
/// to in 100 steps of 1e-4 s.
struct Warmed {
  std::vector<double> temperature;
  double given;  // [J] by the wall
};
Warmed warmed(const std::vector<std::array<double, 2>>& places, silt::TriangleMesh mesh,
              const silt::WallHeat& wall) {
  silt::Particles<Sphere> p;
  for (const auto& [x, y] : places)
    p.add({.position = {x, y, R - d}, .radius = R, .density = density});
  silt::Simulation sim{
      std::move(p), silt::Contacts<HertzMindlin>{still}, flat_box(),
      silt::HeatConduction{
          .conductivity = 1.1, .heat_capacity = 840, .walls = {wall}, .flux_every = 1}};
  sim.add_wall(std::move(mesh), still);
  sim.time_step = 1e-4;
  sim.run(0.01);
  Warmed all{{}, sim.given_by_wall<silt::Temperature>(0).sum};
  for (std::size_t k = 0; k < places.size(); ++k)
    all.temperature.push_back(sim.field<silt::Temperature>(sim.find(k)));
  return all;
}
/// Euler's steps to a wall at 400 K.
double of_closed_form() {
  const double H = 2 * 1.1 * std::sqrt(R * d);  // [W/K]
  return 400 - (400 - 293.15) * std::pow(1 - H / C * 1e-4, 100);
}

}  // namespace heat

}  // namespace

// Catches contacts at images without heat, heat that no wall gives, and power shared among those at
// the wall itself alone.
TEST_CASE(
    "wall_images_modules: a wall that is held warm, or is given 2 W, warms grains at its images") {
  using namespace heat;
  // It spans x from 0.7 lengths to the face, as an image, and from the other face to 0.2 lengths.
  const auto plate = [] {
    return silt::rectangle({-0.3 * length, 0, 0}, {0.5 * length, 0, 0}, {0, length, 0});
  };
  const std::vector<std::array<double, 2>> places{
      {0.85 * length, 0.4 * length}, {0.1 * length, 0.4 * length}, {0.5 * length, 0.4 * length}};
  const auto held = warmed(places, plate(), silt::held_at(400));
  CHECK(held.temperature[0] == near(of_closed_form()).epsilon(1e-11));
  CHECK(held.temperature[1] == near(of_closed_form()).epsilon(1e-11));
  CHECK(held.temperature[2] == 293.15);  // where no plate is
  CHECK(held.given == near(2 * C * (of_closed_form() - 293.15)).epsilon(1e-9));
  const auto heated = warmed(places, plate(), silt::heated_by(2));
  CHECK(heated.temperature[0] == near(293.15 + 0.01 / C).epsilon(1e-11));
  CHECK(heated.temperature[1] == near(293.15 + 0.01 / C).epsilon(1e-11));
  CHECK(heated.given == near(2 * 0.01).epsilon(1e-9));
}

// Catches the heat of two contacts where two images join under a grain, and of four at the corner.
TEST_CASE(
    "wall_images_modules: a grain on the seam between images of a warm floor has one contact") {
  using namespace heat;
  const auto floor = [] { return silt::rectangle({0, 0, 0}, {length, 0, 0}, {0, length, 0}); };
  for (const std::array<double, 2> at :
       {std::array{0.0, 0.4 * length}, std::array{0.0, 0.0}, std::array{1e-6, length - 1e-6}}) {
    CAPTURE(at[0]);
    const auto held = warmed({at}, floor(), silt::held_at(400));
    CHECK(held.temperature[0] == near(of_closed_form()).epsilon(1e-9));
  }
}

namespace {

namespace drum {

constexpr HertzMindlin::Material soft{
    .youngs_modulus = 1e6, .poisson_ratio = 0.25, .restitution = 0.5, .friction = 0.5};
constexpr double radius = 0.05, height = 0.5;  // [m] of the drum; its axis over z = 0

/// A tube of plane sides around an axis along x, open at its ends. Sixteen make one smooth surface
/// of contacts, eight have creases in which a grain touches twice.
silt::TriangleMesh tube(int sides, double from, double to) {
  std::vector<Triangle> all;
  const auto corner = [sides](double x, int k) {
    const double angle = 2 * pi * (k % sides) / sides;
    return Vec3d{x, half + radius * std::cos(angle), height + radius * std::sin(angle)};
  };
  for (int k = 0; k < sides; ++k) {
    all.push_back({corner(from, k), corner(to, k), corner(to, k + 1)});
    all.push_back({corner(from, k), corner(to, k + 1), corner(from, k + 1)});
  }
  return silt::TriangleMesh(all);
}
PeriodicBox along_x() { return {{{0, -1, 0}, {length, 1, 1}}, {true, false, false}}; }
auto scene(silt::Particles<Sphere> particles, silt::TriangleMesh mesh, int threads = 1) {
  silt::Simulation sim{std::move(particles), silt::Contacts<HertzMindlin>{soft}, along_x()};
  sim.gravity = {0.5, 0, -g};  // its axis is tilted: grains go through the faces
  sim.time_step = 2e-5;
  sim.threads = threads;
  sim.add_wall(std::move(mesh), soft,
               {.name = "drum", .motion = silt::rotation({0, half, height}, {1, 0, 0}, 6)});
  return sim;
}
silt::Particles<Sphere> grains(std::size_t count) {
  silt::Particles<Sphere> p;
  p.fill({{0, half - 0.03, height - 0.03}, {length, half + 0.03, height + 0.03}},
         {.radius = silt::uniform(0.004, 0.006),
          .density = 2500,
          .count = count,
          .arrangement = silt::Arrangement::Random});
  return p;
}

}  // namespace drum

}  // namespace

// Catches an image that turns about its own axis, edges at the faces that hold a grain up, and a
// spring that is lost as a grain passes from one image to the next.
TEST_CASE(
    "wall_images_modules: a drum of a mesh that ends at a face, or crosses one, carries a grain as "
    "a drum without end") {
  const auto run = [](const silt::TriangleMesh& mesh) {
    silt::Particles<Sphere> p;
    p.add({.position = {0.7 * length, half, drum::height - 0.043},
           .radius = 0.005,
           .density = 2500,
           .velocity = {0.3, 0, 0}});
    auto sim = drum::scene(std::move(p), mesh);
    std::vector<Vec3d> all;
    for (int piece = 0; piece < 200; ++piece) {
      sim.run(100 * 2e-5);
      const Vec3d at = sim.position(0);
      all.push_back({0, at.y, at.z}), all.push_back(sim.velocity(0));
      all.push_back(0.005 * sim.angular_velocity(0)), all.push_back(sim.wall(0).force);
    }
    return all;
  };
  for (const int sides : {8, 16}) {
    const auto endless = run(drum::tube(sides, -1, 2));
    for (const double from : {0.0, -0.4 * length, 3.25 * length}) {
      CAPTURE(sides);
      CAPTURE(from);
      const auto of_images = run(drum::tube(sides, from, from + length));
      double most = 0, fastest = 0;
      for (std::size_t k = 0; k < endless.size(); ++k) {
        most = std::max(most, norm(of_images[k] - endless[k]));
        fastest = std::max(fastest, std::abs(endless[k].x));
      }
      CHECK(most < 1e-9);
      CHECK(fastest > 0.3);  // it went through the faces
    }
  }
}

// Catches contacts twice or not at all at the faces, in a bed whose grains lie on many facets at
// once.
TEST_CASE(
    "wall_images_modules: a bed in such a drum touches what brute force finds at one without end") {
  for (const int sides : {8, 16}) {
    CAPTURE(sides);
    auto sim = drum::scene(drum::grains(120), drum::tube(sides, -0.4 * length, 0.6 * length));
    const auto endless = drum::tube(sides, -1, 2);
    std::vector<std::uint32_t> facets(endless.triangles().size());
    for (std::uint32_t t = 0; t < facets.size(); ++t) facets[t] = t;
    std::size_t contacts = 0, wrong = 0;
    double off = 0;
    sim.run(0.4, silt::at(silt::every(0.004), [&](const auto& now) {
              std::size_t count = 0;
              double overlap = 0;  // [m]
              Vec3d normal{0, 0, 0};
              now.for_each_contact([&](const silt::ContactSeen& c) {
                if (c.wall == silt::no_wall) return;
                ++count, overlap += c.overlap, normal += c.normal;
              });
              const auto& pose = now.wall(0).pose;
              for (std::size_t k = 0; k < now.rows(); ++k) {
                silt::SurfacePoint points[silt::TriangleMesh::max_contacts];
                const int n =
                    endless.contacts(pose.to_body(now.position(k)), now.radius(k), facets, points);
                for (int c = 0; c < n; ++c) {
                  --count, ++contacts, overlap -= now.radius(k) - points[c].distance;
                  normal -= pose.rotate(points[c].normal);
                }
              }
              wrong += count != 0;
              off = std::max(off, std::abs(overlap) + 0.005 * norm(normal));
            }));
    CHECK(contacts > 2000);
    CHECK(wrong == 0);
    CHECK(off < 1e-12);
  }
}

TEST_CASE("wall_images_modules: threads do not change a bit of a bed in such a drum") {
  auto one = drum::scene(drum::grains(120), drum::tube(16, 0, length), 1),
       three = drum::scene(drum::grains(120), drum::tube(16, 0, length), 3);
  one.run(0.2), three.run(0.2);
  CHECK(bits(one) == bits(three));
}

// Catches images taken as they come: particles would be looked at a million lengths away, or twice.
TEST_CASE(
    "wall_images_modules: a checkpoint with an image that cannot be is refused, as the simulation "
    "was") {
  using silt::detail::wall_image;
  const fuzz::Folder folder;
  const std::string path = folder / "c";
  const auto make = [] {
    auto sim = drum::scene(drum::grains(60), drum::tube(16, -0.4 * length, 0.6 * length));
    sim.add_wall(silt::Plane{{0, 0, drum::height - 0.0495}, {0, 0, 1}}, drum::soft);
    return sim;
  };
  auto writer = make();
  writer.run(0.1);
  silt::save_checkpoint(writer, path);
  const auto good = fuzz::Parts::of(silt::detail::read_file(path));
  /// The sentence that refuses the checkpoint with this image in place of one that is not 0, or of
  /// a candidate at wall 1.
  const auto refused = [&](const std::string& list, std::int64_t image, bool at_plane = false) {
    auto forged = good;
    fuzz::Parts::Field *candidates = nullptr, *images = nullptr;
    for (auto& f : forged.fields) {
      if (f.name == "walls." + list) candidates = &f;
      if (f.name == "walls." + list + "_images") images = &f;
    }
    REQUIRE(candidates != nullptr);
    REQUIRE(images != nullptr);
    bool found = false;
    for (std::size_t k = 0; k < images->count() && !found; ++k) {
      const bool plane = fuzz::value_at<std::uint32_t>(*candidates, 7 * k + 1) == 1;
      found = at_plane ? plane : fuzz::value_at<std::int64_t>(*images, k) != 0;
      if (found) fuzz::set_value(*images, k, image);
    }
    REQUIRE(found);
    fuzz::write_bytes(path, forged.file());
    auto sim = make();
    const auto before = bits(sim);
    const auto sentence = refusal<silt::FileError>([&] { silt::load_checkpoint(sim, path); });
    CHECK(bits(sim) == before);
    return sentence;
  };
  constexpr auto least = std::numeric_limits<std::int64_t>::min();
  for (const std::int64_t image :
       {least, std::numeric_limits<std::int64_t>::max(), std::int64_t{1} << 62,
        -(std::int64_t{1} << 62), wall_image({0, 1, 0}), wall_image({-1, 0, 2})})
    for (const char* list : {"outer", "inner"})
      CHECK(has_words(refused(list, image),
                      {path, std::string("walls.") + list + "_images[", std::to_string(image),
                       "not an image of a wall in this box"}));
  CHECK(has_words(refused("outer", wall_image({1, 0, 0}), true), {"planes do not repeat"}));
  CHECK(has_words(refused("inner", wall_image({5, 0, 0})), {"is not in the outer list"}));

  // In a box that does not repeat there are none.
  const auto in_the_open = [] {
    silt::Simulation sim{drum::grains(20), silt::Contacts<HertzMindlin>{drum::soft}};
    sim.gravity = {0, 0, -g}, sim.time_step = 2e-5;
    sim.add_wall(drum::tube(16, -1, 2), drum::soft);
    return sim;
  };
  auto open = in_the_open();
  open.run(0.1);
  silt::save_checkpoint(open, path);
  auto forged = fuzz::Parts::of(silt::detail::read_file(path));
  std::size_t candidates = 0;
  for (const auto& f : forged.fields)
    if (f.name == "walls.outer") candidates = f.count() / 7;
  REQUIRE(candidates > 0);
  for (auto f : good.fields)
    if (f.name == "walls.outer_images") {
      f.bytes.assign(8 * candidates, '\0');
      fuzz::set_value(f, 0, std::int64_t{1});
      forged.fields.push_back(f);
    }
  fuzz::write_bytes(path, forged.file());
  auto other = in_the_open();
  CHECK(has_words(refusal<silt::FileError>([&] { silt::load_checkpoint(other, path); }),
                  {"walls.outer_images[0] = 1", "not an image of a wall in this box"}));
}

}  // namespace wall_images_modules_test
