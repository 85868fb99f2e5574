// silt - BSD-3-Clause, see LICENSE
// Names of materials and forms in what checkpoints and failed runs say; no file holds them.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <engine/support.hpp>

#include <silt/io/checkpoint.hpp>
#include <silt/io/failure.hpp>
#include <silt/shape/super_ellipsoid.hpp>

namespace io_names_test {

namespace {

using namespace engine_test;
using silt::InputError;
using silt::SuperEllipsoid;
namespace fs = std::filesystem;

const std::string path = (fs::temp_directory_path() / "silt_names.silt").string();

std::string content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Scene {
  bool named = true;
  double c = 2e-3, friction = 0.2;
  std::size_t from_inlet = 0, form_from_inlet = 1;
  bool floor_of_steel = true;
  double height = 2.5e-3;
};
/// Material 1 'steel' and form 1 'pill'; the inlet brings one of them, the floor is of one.
auto built(const Scene& scene) {
  auto gum = rubber, steel = rubber;
  gum.friction = scene.friction, steel.youngs_modulus = 1e7;
  silt::Contacts<HertzMindlin, silt::SeveralMaterials> contacts{{gum, steel}};
  contacts.set_pair(gum, steel, {.restitution = 0.6, .friction = 0.3});
  silt::Particles<SuperEllipsoid> p;
  p.add_form({.a = 1e-3, .b = 1e-3, .c = 1e-3});
  const auto pill = p.add_form({.a = 2e-3, .b = 1e-3, .c = scene.c}, scene.named ? "pill" : "");
  if (scene.named) contacts.add(steel, "steel"), contacts.add(gum, "gum");
  p.add({.form = pill, .position = {0, 0, scene.height}, .density = 2500});
  silt::Simulation sim{std::move(p), std::move(contacts)};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, scene.floor_of_steel ? steel : gum,
               {.name = scene.named ? "floor" : ""});
  sim.add_inlet({{0, 0, 0.05}, {0.01, 0.01, 0.06}}, {.radius = 1e-3,
                                                     .density = 2500,
                                                     .rate = 10,
                                                     .material = scene.from_inlet,
                                                     .form = scene.form_from_inlet});
  return sim;
}

}  // namespace

TEST_CASE("names of materials and forms: what differs from a checkpoint is said with them") {
  auto sim = built({});
  sim.run(1e-4);
  save_checkpoint(sim, path);
  const auto refused = [](const Scene& scene, std::initializer_list<std::string> words) {
    auto changed = built(scene);
    CHECK(has_words(refusal<InputError>([&] { load_checkpoint(changed, path); }), words));
  };
  refused({.c = 1.5e-3}, {"form 1 'pill': semi-axis c [m] is 0.002 in the file and 0.0015 in"});
  refused({.friction = 0.25},
          {"materials 0 'gum' and 0 'gum': the law's coefficient", "0.25 in the scene"});
  refused({.floor_of_steel = false},
          {"wall 0 'floor': material is 1 in the file and 0 'gum' in the scene"});
  refused({.from_inlet = 1, .form_from_inlet = 0},
          {"inlet 0: material is 0 in the file and 1 'steel' in the scene; inlet 0: form is 1 in "
           "the file and 0 in the scene"});
}

TEST_CASE("names of materials and forms: checkpoints have the same bytes without, and load") {
  auto named = built({}), plain = built({.named = false});
  named.run(1e-4), plain.run(1e-4);
  save_checkpoint(named, path);
  const std::string bytes = content(path);
  save_checkpoint(plain, path);
  CHECK(content(path) == bytes);
  auto again = built({});
  load_checkpoint(again, path);
  CHECK(again.material_name(1) == "material 1 'steel'");
  CHECK(again.form_name(1) == "form 1 'pill'");
}

TEST_CASE("names of materials and forms: on_failure says what numbers in its files mean") {
  const std::string folder = (fs::temp_directory_path() / "silt_names_failed").string();
  const auto said = [&](bool named) {
    auto sim = built({.named = named, .height = 1e-3});
    CHECK(
        has_words(refusal<silt::SimulationError>([&] { sim.run(1e-3, silt::on_failure(folder)); }),
                  {named ? "overlaps wall 0 'floor' by " : "overlaps wall 0 by "}));
    const std::string all = content(folder + "/failure.txt");
    const auto end = all.find('\n', all.find("particles named:"));
    REQUIRE(end != all.npos);
    return all.substr(end + 1);
  };
  CHECK(said(true) == "wall 0 'floor'\nmaterial 0 'gum'\nmaterial 1 'steel'\nform 1 'pill'\n");
  CHECK(said(false) == "");
  fs::remove_all(folder), fs::remove(path);
}

}  // namespace io_names_test
