// silt - BSD-3-Clause, see LICENSE
//
// Coarse-grained fields: kernels, the integral of mass, shear in closed form, the balance of
// momentum in a bed, means over time, files; and the files of contacts.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/support.hpp"
#include "near.hpp"

#include <silt/io/coarse_grained.hpp>
#include <silt/io/contact_series.hpp>

namespace coarse_fields_test {

using namespace engine_test;
using silt::CoarseFields;
using silt::CoarseGrid;
using silt::GaussianKernel;
using silt::HeavisideKernel;
using silt::LucyKernel;
using silt::Particles;

auto scene(Particles<Sphere> p) {
  return silt::Simulation{std::move(p), silt::Contacts<HertzMindlin>{rubber}};
}

template <class Kernel>
void check_kernel(const Kernel& kernel) {
  // 4 pi int r^2 phi dr = 1 by the rule of trapezoids, 1e-3 where it jumps; along a line against a
  // sum, whose 2000 points give 1e-3.
  const double reach = kernel.reach();
  const int n = 20000;
  double all = 0;
  for (int k = 0; k < n; ++k) {
    const double r = (k + 0.5) * reach / n;
    all += 4 * M_PI * r * r * kernel.value(r * r) * reach / n;
  }
  CHECK(all == near(1).epsilon(1e-6));
  const double across2 = 0.09 * reach * reach, from = -0.5 * reach, to = 0.8 * reach;
  double line = 0;
  for (int k = 0; k < 2000; ++k) {
    const double t = from + (k + 0.5) * (to - from) / 2000;
    line += kernel.value(across2 + t * t) * (to - from) / 2000;
  }
  CHECK(kernel.along(across2, from, to) == near(line).epsilon(1e-5));
}

TEST_CASE("coarse-graining kernels: integral 1, and along a line") {
  check_kernel(GaussianKernel{2e-3});
  check_kernel(LucyKernel{3e-3});
  check_kernel(HeavisideKernel{3e-3});
}

template <class Kernel>
double integral_of_density(const Kernel& kernel, double& momentum) {
  Particles<Sphere> p;
  p.fill({{8e-3, 8e-3, 8e-3}, {12e-3, 12e-3, 12e-3}},
         {.radius = silt::uniform(0.3e-3, 0.5e-3), .density = 2500, .count = 40});
  for (auto k = 0u; k < p.size(); ++k) p[k].velocity = {0.1 * k, 0, 0};
  auto sim = scene(std::move(p));
  sim.run(0);
  CoarseFields fields(CoarseGrid{{{0, 0, 0}, {20e-3, 20e-3, 20e-3}}, {40, 40, 40}}, kernel);
  fields.add(sim);
  double mass = 0, sum = 0, p_sum = 0, p_all = 0, apart = 0;
  for (std::size_t k = 0; k < sim.rows(); ++k)
    mass += sim.mass(k), p_all += sim.mass(k) * sim.velocity(k).x;
  for (std::size_t c = 0; c < fields.grid().size(); ++c) {
    const auto v = fields.at(c);
    sum += v.density * 0.125e-9, p_sum += v.density * v.velocity.x * 0.125e-9;
    apart = std::max(apart, std::abs(v.density - 2500 * v.solid_fraction));
  }
  CHECK(apart < 1e-9 * 2500);
  momentum = p_sum / p_all;
  return sum / mass;
}

TEST_CASE("coarse-grained density and momentum: their integrals are those of the particles") {
  // A sum over cells of 0.5 mm. Gaussian of 1.5 mm: the cut-off at exp(-9/2) jumps by 1 % of the
  // peak on a shell, which the cells see to some 1e-3; Lucy's ends smoothly; means over a ball of
  // 3 mm have 900 cells in them, of whose number a few are on the edge.
  double momentum;
  CHECK(integral_of_density(GaussianKernel{1.5e-3}, momentum) == near(1).epsilon(2e-3));
  CHECK(momentum == near(1).epsilon(2e-3));
  CHECK(integral_of_density(LucyKernel{4e-3}, momentum) == near(1).epsilon(1e-4));
  CHECK(momentum == near(1).epsilon(1e-4));
  CHECK(integral_of_density(HeavisideKernel{3e-3}, momentum) == near(1).epsilon(2e-2));
}

TEST_CASE("coarse-grained shear: velocity and temperature in closed form") {
  // A lattice that fills the kernel's reach, v = G z: the mean velocity is G z, and what counts as
  // fluctuation is G^2 <z^2>, of the Gaussian that ends at 3 w a little less than w^2.
  Particles<Sphere> p;
  const double a = 1e-3, G = 40, w = 2e-3;
  for (int k = 0; k < 16 * 16 * 16; ++k) {
    const silt::Vec3d x{a * (k % 16), a * (k / 16 % 16), a * (k / 256)};
    p.add({.position = x, .radius = 0.4e-3, .density = 2500, .velocity = {G * x.z, 0, 0}});
  }
  auto sim = scene(std::move(p));
  sim.run(0);
  const CoarseGrid grid{{{7e-3, 7e-3, 6e-3}, {8e-3, 8e-3, 9e-3}}, {1, 1, 3}};
  CoarseFields fields(grid, GaussianKernel{w});
  fields.add(sim);
  const double tail = std::sqrt(2 / M_PI) * 3 * std::exp(-4.5), inside = std::erf(3 / std::sqrt(2));
  const double share = (inside - 4 * tail) / (inside - tail);  // <z^2>/w^2
  for (int k = 0; k < 3; ++k) {
    const auto v = fields.at(0, 0, k);
    CHECK(v.velocity.x == near(G * grid.centre(0, 0, k).z).epsilon(2e-3));
    CHECK(v.density == near(2500 * Sphere::volume(0.4e-3) / (a * a * a)).epsilon(5e-3));
    CHECK(v.temperature == near(G * G * w * w * share / 3).epsilon(1e-2));
    CHECK(v.kinetic_stress.xx == near(3 * v.density * v.temperature).epsilon(1e-12));
    CHECK(v.contact_stress.trace() == 0);
  }
}

/// A bed at rest in a box of 20 x 20 mm.
auto bed() {
  Particles<Sphere> p;
  p.fill({{0, 0, 0}, {20e-3, 20e-3, 60e-3}},
         {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = 1500});
  auto sim = scene(std::move(p));
  sim.gravity = {0, 0, -9.81};
  sim.guard.max_overlap = 0.6;
  sim.add_wall(silt::box({0, 0, 0}, {20e-3, 20e-3, 1}), rubber);
  return sim;
}

template <class Kernel>
double worst_balance(const auto& sim, const Kernel& kernel, double h) {
  double worst = 0;
  for (const silt::Vec3d& at : {silt::Vec3d{10e-3, 10e-3, 8e-3}, silt::Vec3d{9e-3, 11e-3, 10e-3}}) {
    const silt::Vec3d half{1.5 * h, 1.5 * h, 1.5 * h};
    CoarseFields f(CoarseGrid{{at - half, at + half}, {3, 3, 3}}, kernel);
    f.add(sim);
    const double push = ((f.at(2, 1, 1).contact_stress.zx - f.at(0, 1, 1).contact_stress.zx) +
                         (f.at(1, 2, 1).contact_stress.zy - f.at(1, 0, 1).contact_stress.zy) +
                         (f.at(1, 1, 2).contact_stress.zz - f.at(1, 1, 0).contact_stress.zz)) /
                        (2 * h);
    const double weight = f.at(1, 1, 1).density * 9.81;
    worst = std::max(worst, std::abs(push / weight + 1));
  }
  return worst;
}

TEST_CASE("coarse-grained stress: its divergence carries the weight of a bed") {
  auto sim = bed();
  sim.run(0.5);
  // Where the kernel reaches no wall. Differences over h of a kernel of size c err by some (h/c)^2;
  // the Gaussian's edge, 1 % of its peak, jumps between their points. The wrong branch, to the
  // contact point, would leave half of it out.
  CHECK(worst_balance(sim, LucyKernel{6e-3}, 0.3e-3) < 0.02);
  CHECK(worst_balance(sim, GaussianKernel{2e-3}, 0.3e-3) < 0.25);
  // The mean over a layer is that of stress(): a Heaviside step in one direction.
  CoarseFields f(CoarseGrid{{{0, 0, 4e-3}, {20e-3, 20e-3, 12e-3}}, {10, 10, 4}}, LucyKernel{4e-3});
  f.add(sim);
  double zz = 0;
  for (int i = 3; i < 7; ++i)
    for (int j = 3; j < 7; ++j)
      for (int k = 0; k < 4; ++k) zz += f.at(i, j, k).contact_stress.zz / 64;
  CHECK(
      zz ==
      near(silt::stress(sim, {{6e-3, 6e-3, 4e-3}, {14e-3, 14e-3, 12e-3}}).contact.zz).epsilon(0.2));
}

TEST_CASE("coarse_grained: means over time, a series, and files that others read") {
  const std::string folder = std::filesystem::temp_directory_path() / "silt_coarse_test";
  std::filesystem::remove_all(folder);
  Particles<Sphere> p;
  p.add({.position = {0, 0, 0}, .radius = 1e-3, .density = 2500, .velocity = {1, 0, 0}});
  auto sim = scene(std::move(p));
  sim.add_wall(silt::Plane{{-5e-3, 0, 0}, {1, 0, 0}}, rubber);
  sim.time_step = 1e-6;
  const CoarseGrid grid{{{-1e-3, -1e-3, -1e-3}, {1e-3, 1e-3, 1e-3}}, {1, 1, 2}};
  // To and fro: no mean velocity, and all of it is fluctuation.
  auto cg = silt::coarse_grained(grid, GaussianKernel{10e-3}, silt::every(1e-6));
  sim.run(0, cg);
  sim.set_velocity(0, {-1, 0, 0});
  sim.run(1e-6, cg);
  REQUIRE(cg.fields().samples() == 2);
  const auto v = cg.fields().at(0, 0, 1);
  CHECK(std::abs(v.velocity.x) < 1e-3);
  CHECK(v.temperature == near(1.0 / 3).epsilon(1e-3));

  auto series = silt::coarse_grained(grid, LucyKernel{10e-3}, silt::every(1e-5),
                                     {.folder = folder, .samples = 5});
  sim.run(2e-4, series);
  std::stringstream pvd;
  pvd << std::ifstream(folder + "/coarse.pvd").rdbuf();
  std::size_t frames = 0;
  for (std::size_t at = 0; (at = pvd.str().find("timestep", at)) != std::string::npos; ++at)
    ++frames;
  CHECK(frames == 4);
  cg.fields().write_vti(folder + "/mean.vti");
  std::stringstream vti;
  vti << std::ifstream(folder + "/mean.vti").rdbuf();
  CHECK(vti.str().find("WholeExtent=\"0 1 0 1 0 2\"") != std::string::npos);
  CHECK(vti.str().find("Name=\"granular_temperature\"") != std::string::npos);
  cg.fields().write_csv(folder + "/mean.csv");
  std::ifstream csv(folder + "/mean.csv");
  std::string line;
  int rows = 0;
  while (std::getline(csv, line)) ++rows;
  CHECK(rows == 3);
  std::filesystem::remove_all(folder);

  const auto words = [&](auto&& make) { return refusal<silt::InputError>(make); };
  CHECK(has_words(words([&] { CoarseFields(grid, GaussianKernel{0}); }),
                  {"GaussianKernel.width", "greater than 0"}));
  CHECK(has_words(words([&] {
                    CoarseFields(CoarseGrid{{{0, 0, 0}, {1, 0, 1}}, {1, 1, 1}}, GaussianKernel{1});
                  }),
                  {"CoarseGrid.box", "must have a volume"}));
  CHECK(has_words(words([&] {
                    CoarseFields(CoarseGrid{{{0, 0, 0}, {1, 1, 1}}, {1, 0, 1}}, GaussianKernel{1});
                  }),
                  {"CoarseGrid.cells = 0", "at least 1"}));
  CHECK(has_words(
      words([&] { silt::coarse_grained(grid, GaussianKernel{1}, silt::every(1), {.samples = 0}); }),
      {"CoarseOutput.samples = 0", "at least 1"}));
}

// Catches what a file before has left in arrays that are used again: a bed that settles has more
// contacts, and one that flies apart fewer.
TEST_CASE("contact_series: each file is, byte by byte, what write_contacts says of its step") {
  const std::string folder = std::filesystem::temp_directory_path() / "silt_contact_files_test";
  std::filesystem::remove_all(folder);
  auto sim = bed();
  std::size_t files = 0, other = 0;
  std::vector<std::size_t> sizes;
  const auto schedule = silt::every(2e-3);
  auto series = silt::contact_series(folder, schedule);
  auto compared = silt::at(schedule, [&](const auto& now) {
    const auto frame = folder + '/' + silt::detail::file_of_step("contacts", now.step(), ".vtp");
    if (!silt::detail::file_exists(frame)) return;  // a run's first instant, of no recorded step
    silt::write_contacts(folder + "/alone.vtp", now);
    const auto content = silt::detail::read_file(folder + "/alone.vtp");
    ++files, sizes.push_back(content.size());
    other += content != silt::detail::read_file(frame);
  });
  sim.run(0.05, series, compared);
  sim.gravity = {0, 0, 100};  // [m/s2]
  sim.run(0.02, series, compared);
  CHECK(files > 30);
  CHECK(other == 0);
  CHECK(*std::max_element(sizes.begin(), sizes.end()) > sizes.front());
  CHECK(*std::max_element(sizes.begin(), sizes.end()) > sizes.back());
  std::filesystem::remove_all(folder);
}

namespace {

/// Reads as contact_series does, in every fifth step.
struct ForcesAlone {
  static constexpr bool only_reads = true, reads_contacts = true, reads_forces_alone = true;
  std::size_t steps = 0, whole = 0, refused = 0, contacts = 0;
  double springs = 0;  // [N]
  template <class Sim>
  bool is_due(const Sim& sim) const {
    return sim.step() % 5 == 0 && !sim.awaits_contacts();
  }
  template <class Sim>
  void operator()(const Sim& sim) {
    ++steps, whole += sim.has_contacts();
    refused +=
        !refusal<silt::InputError>([&] { sim.for_each_contact([](const auto&) {}); }).empty();
    sim.visit_contacts(
        [&](const silt::ContactSeen& c) {
          ++contacts, springs += sim.has_contacts() ? 0 : norm(c.spring);
          springs += sim.has_contacts() ? 0 : static_cast<double>(c.history.size());
        },
        "this test");
  }
};

}  // namespace

// Catches springs of 0 shown to who asks for them.
TEST_CASE(
    "contact_series: a step of which it alone wants contacts has their forces, and is refused to "
    "who wants all of them") {
  auto sim = bed();
  sim.run(0.03);
  ForcesAlone reader;
  sim.run(1e-3, reader);
  CHECK(reader.steps > 5);
  CHECK(reader.contacts > 1000);
  CHECK(reader.springs == 0);
  CHECK(reader.whole <=
        2);  // the first and the last step of this run are asked for by for_each_contact
  CHECK(reader.refused == reader.steps - reader.whole);
}

TEST_CASE(
    "contact_series and contact_csv: a file each time, lines whose forces are the contacts'") {
  const std::string folder = std::filesystem::temp_directory_path() / "silt_contact_series_test";
  std::filesystem::remove_all(folder);
  auto sim = bed();
  sim.run(0.05);
  // In a second run the step that is there was not recorded: the first frame is a step later.
  sim.run(2e-3, silt::contact_series(folder, silt::every(1e-3)),
          silt::contact_csv(folder, silt::every(1e-3)));
  std::vector<std::string> tables, lines;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") tables.push_back(entry.path());
    if (entry.path().extension() == ".vtp") lines.push_back(entry.path());
  }
  std::sort(tables.begin(), tables.end()), std::sort(lines.begin(), lines.end());
  CHECK(tables.size() >= 2);
  CHECK(lines.size() == tables.size());
  CHECK(std::filesystem::exists(folder + "/contacts.pvd"));
  std::size_t count = 0;
  double down = 0;
  sim.for_each_contact([&](const silt::ContactSeen& c) {
    ++count;
    if (c.wall == 0) down += c.force.z;
  });
  REQUIRE(count > 1000);
  silt::write_contact_csv(folder + "/now.csv", sim);
  silt::write_contacts(folder + "/now.vtp", sim);
  std::ifstream now(folder + "/now.csv");
  std::string line;
  std::getline(now, line);
  CHECK(line.starts_with("a,b,wall,surface,facet,x [m]"));
  std::size_t rows = 0;
  double sum = 0;
  while (std::getline(now, line)) {
    ++rows;
    std::stringstream row(line);
    std::vector<std::string> words;
    for (std::string word; std::getline(row, word, ',');) words.push_back(word);
    REQUIRE(words.size() == 16);
    if (words[2] == "0") sum += std::stod(words[15]);
  }
  CHECK(rows == count);
  CHECK(sum == near(down).epsilon(1e-12));
  std::stringstream vtp;
  vtp << std::ifstream(folder + "/now.vtp").rdbuf();
  CHECK(vtp.str().find(silt::text("NumberOfLines=\"", count, '"')) != std::string::npos);
  CHECK(vtp.str().find(silt::text("NumberOfPoints=\"", 2 * count, '"')) != std::string::npos);
  std::filesystem::remove_all(folder);
  const std::array<std::array<float, 3>, 3> odd{};
  CHECK(has_words(refusal<silt::InputError>([&] { silt::write_vtp_lines("odd.vtp", odd); }),
                  {"odd.vtp", "3 points are not ends of lines"}));
}

}  // namespace coarse_fields_test
