// silt - BSD-3-Clause, see LICENSE
// Restarts of simulations whose polyhedra have broken: the forms of the cells come from the file.
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include <silt/io/checkpoint.hpp>

#include "breakage/scene.hpp"
#include "breakage/stones.hpp"
#include "io/fuzz_support.hpp"
#include "refusal.hpp"

namespace breakage_polyhedra_restart_test {

using namespace breakage_scene;  // NOLINT: of this test alone
using silt_test::has, silt_test::refusal;
using Stones = silt::Particles<silt::Polyhedron>;

/// Stones of two sizes that fall onto a plate, and others that follow.
auto scene(int threads, std::uint64_t form_seed = 9) {
  Stones stones;
  const auto form = stones.add_form(stone(form_seed), "stone");
  for (int k = 0; k < 12; ++k)
    stones.add({.form = form,
                .position = {0.0032 * (k % 3), 0.0032 * (k / 3 % 2), 0.0013 + 0.003 * (k / 6)},
                .orientation = silt::rotation_about(silt::normalised(Vec3d{1, 2, 3}), 0.3 * k),
                .radius = k % 2 == 0 ? 0 : 1.1e-3,
                .density = 2165,
                .velocity = {0, 0, -16}});
  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{salt},
                       silt::EnergyLedger{}, policy({.dust_below = 3e-4})};
  sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
  sim.gravity = {0, 0, -9.81}, sim.time_step = 5e-8, sim.threads = threads;
  sim.guard.max_overlap = 0.9;  // fragments are pressed in
  return sim;
}
template <class Sim>
std::vector<double> bits(const Sim& sim) {
  // Of the books what does not depend on which steps were observed.
  const auto e = sim.energy();
  std::vector<double> all{sim.time(),        static_cast<double>(sim.broken()),
                          sim.dust().mass(), e.parting,
                          e.breaking,        static_cast<double>(sim.forms().size())};
  const auto add = [&](const Vec3d& v) { all.insert(all.end(), {v.x, v.y, v.z}); };
  for (std::size_t k = 0; k < sim.rows(); ++k) {
    if (!sim.is_present(k)) continue;
    add(sim.position(k)), add(sim.velocity(k)), add(sim.angular_velocity(k));
    const auto q = sim.orientation(k);
    const auto& form = sim.forms()[sim.form(k)];
    all.insert(all.end(), {q.w, q.x, q.y, q.z, static_cast<double>(sim.id(k)), sim.mass(k),
                           static_cast<double>(sim.form(k)), form.mass.volume, form.lever.x,
                           sim.template field<Policy>(k).strength});
  }
  return all;
}
/// A file of the test's own.
struct Place {
  std::filesystem::path folder;
  std::string file;
  explicit Place(const char* name)
      : folder(std::filesystem::temp_directory_path() / name),
        file((folder / "run.silt").string()) {
    std::filesystem::create_directories(folder);
  }
  ~Place() { std::filesystem::remove_all(folder); }
};

TEST_CASE("breakage: polyhedra that have broken go on from a checkpoint to the last bit") {
  const Place at("silt_breakage_polyhedra");
  auto first = scene(1);
  // Saved while a fragment is due to break before the next step.
  bool fresh = false, saved = false;
  double time = 0;
  std::size_t due = 0, again = 0;
  first.run(3e-4,
            silt::at<silt::ActionKind::Saves>(silt::every(5e-8),
                                              [&](const auto& s) {
                                                fresh =
                                                    !saved && s.breaks_due() > 0 && s.broken() >= 4;
                                                if (!fresh) return;
                                                silt::save_checkpoint(s, at.file);
                                                due = s.breaks_due(), time = s.time();
                                              }),
            silt::on_break([&](const silt::BreakEvent& b) {
              saved = saved || (fresh && b.generation >= 1);
              again += saved && b.generation >= 1;
            }));
  CHECK(saved);
  CHECK(again > 3);  // fragments of fragments, after the file
  const auto wanted = bits(first);
  for (const int threads : {1, 2, 3}) {
    auto second = scene(threads);
    if (threads == 3) second.run(1e-4);  // with cells of its own, which it forgets
    CHECK((threads < 3 || second.broken() > 0));
    silt::load_checkpoint(second, at.file);
    CHECK(second.time() == time);
    CHECK(second.breaks_due() == due);
    CHECK(second.broken() >= 4);
    second.run(first.time() - time);
    CHECK(second.step() == first.step());
    CHECK(bits(second) == wanted);
  }
  // Of the forms, those that were added are compared.
  auto other = scene(1, 10);
  has(refusal([&] { silt::load_checkpoint(other, at.file); }), "form 0 'stone': ");
}

// Speeds of bodies choose the step here. They were measured after a body had turned in some steps
// and before it in others, and after an edit the largest was forgotten by a restart.
TEST_CASE("breakage: steps that follow spinning stones depend on no observer, edit or restart") {
  const Place at("silt_breakage_polyhedra_steps");
  const auto make = [] {
    Stones stones;
    const auto form = stones.add_form(stone(9), "stone");
    for (int k = 0; k < 12; ++k)
      stones.add(
          {.form = form,
           .position = {0.0032 * (k % 3), 0.0032 * (k / 3 % 2), 0.0013 + 0.003 * (k / 6)},
           .orientation = silt::rotation_about(silt::normalised(Vec3d{1, 2, 3}), 0.3 * k + 1),
           .density = 2165,
           .velocity = {0, 0, -6},
           .angular_velocity = {4000, -7000, 2000}});
    silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{salt},
                         policy({.dust_below = 3e-4, .step = silt::BreakStep::SmallestLiving})};
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, salt);
    sim.gravity = {0, 0, -4e4};  // so that speeds grow, and steps follow them
    sim.threads = 1, sim.guard.max_overlap = 5;
    return sim;
  };
  using Sim = decltype(make());
  const auto state = [](const Sim& sim) {
    std::vector<double> all{sim.time(), sim.step_length(), static_cast<double>(sim.broken())};
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (sim.is_present(k))
        for (const Vec3d& v : {sim.position(k), sim.velocity(k), sim.angular_velocity(k)})
          all.insert(all.end(), {v.x, v.y, v.z});
    return all;
  };
  const auto edit = [](Sim& sim) {  // a stone comes
    if (sim.time() < 1e-4) return;
    Stones one;
    one.add({.form = one.add_form(stone(9), "stone"),
             .position = {0.004, 0.002, 0.012},
             .radius = 1e-3,
             .density = 2165,
             .velocity = {0, 0, -20}});
    sim.add(one);
  };
  auto alone = make(), looked = make(), saved = make();
  const auto edits = [&] { return silt::at(silt::every(5e-5), edit); };
  double looks = 0;
  alone.run(4e-4, edits());
  looked.run(4e-4, edits(),
             silt::at(silt::every_steps(7), [&](const Sim& s) { looks += s.time(); }));
  CHECK(alone.broken() > 4);
  CHECK(looks > 0);
  CHECK(state(looked) == state(alone));
  saved.run(4e-4, edits(),
            silt::at<silt::ActionKind::Saves>(silt::every(1.6e-4), [&](const Sim& s) {
              if (s.time() > 3e-4) silt::save_checkpoint(s, at.file);
            }));
  CHECK(state(saved) == state(alone));
  auto restarted = make();
  silt::load_checkpoint(restarted, at.file);
  CHECK(restarted.broken() > 0);
  restarted.run(4e-4 - restarted.time(), edits());
  CHECK(state(restarted) == state(alone));
}

TEST_CASE("breakage: a form that was added after others broke, at a restart") {
  const Place at("silt_breakage_polyhedra_added");
  Stones cube;
  cube.add_form(stone(4), "late");
  cube.add({.form = 0, .position = {0.02, 0, 0.0013}, .density = 2165, .velocity = {0, 0, -16}});
  auto first = scene(1);
  first.run(1e-4);
  REQUIRE(first.broken() > 0);
  const auto numbers = first.add(cube);
  CHECK(numbers.front() == 1);  // behind "stone"; those of cells have made room
  first.run(2e-5);
  silt::save_checkpoint(first, at.file);
  first.run(1e-4);
  auto second = scene(1);
  has(refusal([&] { silt::load_checkpoint(second, at.file); }), "forms is 2 in the file and 1");
  second.add(cube);
  silt::load_checkpoint(second, at.file);
  CHECK(second.form_name(1) == "form 1 'late'");
  second.run(1e-4);
  CHECK(bits(second) == bits(first));
}

/// Leaves a particle as it is that breaks without an impact.
struct Whole {
  double finer(double x, const silt::Broken& b) const { return x < 0.99 * largest(b) ? 0 : 1; }
  double largest(const silt::Broken& b) const { return (b.speed > 0 ? 1 : 1.2) * b.diameter; }
  void check() const {}
};

TEST_CASE("breakage: a fragment that is all of a body in another size than its form's") {
  const Place at("silt_breakage_polyhedra_whole");
  const auto make = [] {
    Stones stones;
    stones.add_form(stone(9));
    for (int k = 0; k < 6; ++k)
      stones.add({.form = 0, .position = {0.01 * k, 0, 0}, .radius = 1e-3 / (3 + k), .density = 1});
    silt::Simulation sim{
        std::move(stones), silt::Contacts<silt::HertzMindlin>{salt}, silt::EnergyLedger{},
        silt::Breakage{strong, silt::HertzEquivalence{}, Whole{}, {.dust_below = 1e-4}}};
    sim.time_step = 5e-8;
    return sim;
  };
  auto first = make(), second = make();
  for (silt::ParticleId id = 0; id < 6; ++id) first.break_particle(id);
  int whole = 0;
  first.run(1e-7, silt::on_break([&](const silt::BreakEvent& b) {
              whole += b.fragments == 1 && b.dust == 0;
            }));
  CHECK(whole >= 1);
  silt::save_checkpoint(first, at.file);
  silt::load_checkpoint(second, at.file);
  REQUIRE(second.forms().size() == first.forms().size());
  for (std::size_t f = 1; f < first.forms().size(); ++f) {
    const auto &a = first.forms()[f], &b = second.forms()[f];
    CHECK(a.shape == b.shape);
    CHECK(a.mass == b.mass);
    CHECK(a.lever == b.lever);
    CHECK(a.shape.core_volume() == b.shape.core_volume());
    CHECK(a.shape.edge_turning() == b.shape.edge_turning());
    for (std::size_t k = 0; k < a.shape.faces().size(); ++k)
      CHECK(a.shape.faces()[k].normal == b.shape.faces()[k].normal);
  }
}

/// Fields of a file by their names.
fuzz::Parts::Field& field(fuzz::Parts& parts, const std::string& name) {
  for (auto& f : parts.fields)
    if (f.name == name) return f;
  FAIL("no field ", name);
  return parts.fields.front();
}

TEST_CASE("breakage: forged cells are refused with a sentence, and nothing has changed") {
  const Place at("silt_breakage_polyhedra_forged");
  auto writer = scene(1);
  writer.run(1e-4);
  silt::save_checkpoint(writer, at.file);
  auto parts = fuzz::Parts::of(silt::detail::read_file(at.file));
  auto victim = scene(1);
  victim.run(8e-5);
  const auto before = bits(victim);
  const auto refused = [&](const char* words, const auto& forge) {
    auto other = parts;
    forge(other);
    fuzz::write_bytes(at.file, other.file());
    has(refusal([&] { silt::load_checkpoint(victim, at.file); }), words);
    CHECK(bits(victim) == before);
  };
  using fuzz::set_value, fuzz::value_at;
  const auto loop = [&](std::size_t k) {
    return value_at<std::uint32_t>(field(parts, "breakage.loops"), k);
  };
  const auto set_loop = [](auto& p, std::size_t k, std::uint32_t v) {
    set_value(field(p, "breakage.loops"), k, v);
  };
  refused("breakage.cells has ", [](auto& p) { field(p, "breakage.cells").bytes.resize(4); });
  refused("breakage.corners has ",
          [](auto& p) { set_value(field(p, "breakage.cells"), 0, std::uint32_t{0xffffffff}); });
  refused("breakage.face_sizes has ",
          [](auto& p) { set_value(field(p, "breakage.cells"), 1, std::uint32_t{0xffffffff}); });
  refused("breakage.loops has ", [](auto& p) {
    set_value(field(p, "breakage.face_sizes"), 0, std::uint32_t{0xffffffff});
  });
  refused("entries, but the cells have", [](auto& p) {
    auto& loops = field(p, "breakage.loops").bytes;
    loops += loops.substr(0, 12);
  });
  refused("cell 0 is not a convex body: Polyhedron: face 0 has 0 corners",
          [](auto& p) { set_value(field(p, "breakage.face_sizes"), 0, std::uint32_t{0}); });
  refused("cell 0 is not a convex body: Polyhedron: face 0 has corner 4294967295 of ",
          [&](auto& p) { set_loop(p, 1, 0xffffffff); });
  refused("face 0 has a corner twice", [&](auto& p) { set_loop(p, 1, loop(0)); });
  const auto first_face = value_at<std::uint32_t>(field(parts, "breakage.face_sizes"), 0);
  refused("the same way round", [&](auto& p) {  // a face turned over
    for (std::uint32_t k = 0; k < first_face; ++k) set_loop(p, k, loop(first_face - 1 - k));
  });
  refused("[m]; corners must be finite",
          [](auto& p) { set_value(field(p, "breakage.corners"), 1, std::nan("")); });
  refused("is not a convex body: Polyhedron: ", [](auto& p) {  // a corner far away
    set_value(field(p, "breakage.corners"), 0, 1.0);
  });
  refused("is not a convex body: Polyhedron: ", [](auto& p) {  // all in one place
    auto& corners = field(p, "breakage.corners");
    for (std::size_t k = 3; k < corners.count(); ++k)
      set_value(corners, k, value_at<double>(corners, k % 3));
  });
  refused("body ", [](auto& p) {  // a convex body, but not that which the fragment is
    auto& corners = field(p, "breakage.corners");
    for (std::size_t k = 0; k < corners.count(); ++k)
      set_value(corners, k, 1.5 * value_at<double>(corners, k));
  });
  refused("body ", [](auto& p) {  // no cells: bodies have forms that are not there
    for (const char* name :
         {"breakage.cells", "breakage.corners", "breakage.face_sizes", "breakage.loops"})
      field(p, name).bytes.clear();
  });
  fuzz::write_bytes(at.file, parts.file());
  silt::load_checkpoint(victim, at.file);  // as it was
  CHECK(bits(victim) == bits(writer));
}

}  // namespace breakage_polyhedra_restart_test
