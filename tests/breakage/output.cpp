// silt - BSD-3-Clause, see LICENSE
// Files of breakage: units in the headers, where classes end, when dust came, fields on surfaces.
//   classes that end beyond the largest grain; fields of another body, or of none
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/shape/laguerre_cells.hpp>
#include <silt/shape/polyhedron.hpp>

#include <silt/io/observers.hpp>

#include "breakage/scene.hpp"
#include "breakage/stones.hpp"
#include "near.hpp"

namespace breakage_output_test {

using namespace breakage_scene;  // NOLINT: of this test alone
namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / "silt_breakage_output";
  Folder() { fs::remove_all(path), fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const char* name) const { return (path / name).string(); }
};
struct Table {
  std::string header;
  std::vector<std::vector<double>> rows;
};
Table read(const std::string& path) {
  std::ifstream in(path);
  Table all;
  std::getline(in, all.header);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    auto& row = all.rows.emplace_back();
    for (std::string word; std::getline(words, word, ',');) row.push_back(std::stod(word));
  }
  return all;
}

TEST_CASE("breakage: tables have units; classes end with the largest grain; dust by its time") {
  const Folder folder;
  auto sim = shower(120);
  sim.time_step = 1.5e-7;
  sim.run(6e-4, silt::breakage_table(folder / "breakage.csv", silt::every(1e-4)));
  const Table breakage = read(folder / "breakage.csv");
  CHECK(breakage.header ==
        "time [s],particles [-],broken at walls [-],broken in pairs [-],broken as asked [-],"
        "present [kg],left [kg],dust [kg]");
  REQUIRE(breakage.rows.size() == 7);
  CHECK(breakage.rows.back()[1] == static_cast<double>(sim.size()));
  CHECK(breakage.rows.back()[7] == sim.dust().mass());

  const silt::SizeTable present = silt::sizes_present(sim);
  silt::write_sizes(folder / "sizes.csv", present);
  const Table sizes = read(folder / "sizes.csv");
  CHECK(sizes.header == "from [m],to [m],mass [kg],number [-],finer [-]");
  double mass = 0;
  for (std::size_t k = 0; k < sizes.rows.size(); ++k) {
    mass += sizes.rows[k][2];
    if (k > 0) CHECK(sizes.rows[k][0] == sizes.rows[k - 1][1]);
    CHECK(sizes.rows[k][4] == near(mass / present.mass()).epsilon(1e-12));
  }
  CHECK(sizes.rows.back()[1] == present.largest());
  CHECK(sizes.rows.back()[1] < silt::SizeTable::edge(present.classes()));

  silt::write_size_times(folder / "times.csv", sim.dust());
  const Table times = read(folder / "times.csv");
  CHECK(times.header == "time from [s],time to [s],from [m],to [m],mass [kg]");
  double all = 0, first = 0;  // [kg]
  for (const auto& row : times.rows) {
    CHECK(row[4] > 0);
    all += row[4], first += row[0] == 0 ? row[4] : 0;
  }
  CHECK(all == near(sim.dust().mass()).epsilon(1e-12));
  CHECK(first == near(all).epsilon(1e-12));  // 0.6 ms are within the first ms
  // Two more milliseconds, in which one breaks.
  sim.run(1e-3), sim.break_particle(sim.id(0)), sim.run(1e-6);
  silt::write_size_times(folder / "times.csv", sim.dust());
  double later = 0, until = 0;
  for (const auto& row : read(folder / "times.csv").rows)
    if (row[0] > 0) later += row[4], until = row[1];
  CHECK(later > 0);
  CHECK(until == near(2e-3).epsilon(1e-12));
}

/// The numbers of a field of a file of raw appended data, as VTK's readers find them.
template <class Number>
std::vector<Number> field(const std::string& file, const std::string& name) {
  const auto at = file.find("Name=\"" + name + "\"");
  if (at == std::string::npos) return {};
  const auto offset = std::stoul(file.substr(file.find("offset=\"", at) + 8));
  const char* data = file.data() + file.find('_', file.find("<AppendedData")) + 1 + offset;
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, data, sizeof bytes);
  std::vector<Number> all(bytes / sizeof(Number));
  std::memcpy(all.data(), data + sizeof bytes, bytes);
  return all;
}

TEST_CASE("breakage: surfaces have strength, generation and material of their body") {
  const Folder folder;
  silt::Particles<silt::Polyhedron> stones;
  const auto form = stones.add_form(stone());
  for (int k = 0; k < 3; ++k)
    stones.add({.form = form, .position = {0.01 * k, 0, 0}, .density = 2165});
  silt::Simulation sim{std::move(stones), silt::Contacts<silt::HertzMindlin>{salt},
                       policy({.dust_below = 4e-4})};
  sim.time_step = 5e-8;
  sim.break_particle(1), sim.run(1e-7);
  CHECK(sim.size() > 3);
  silt::write_surfaces(folder / "s.vtp", sim);
  std::ifstream in(folder / "s.vtp", std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  const std::string file = content.str();
  const auto id = field<std::uint64_t>(file, "id");
  const auto generation = field<double>(file, "generation"),
             strength = field<double>(file, "strength");
  CHECK(field<std::uint32_t>(file, "material").size() == id.size());
  REQUIRE(generation.size() == id.size());
  REQUIRE(strength.size() == id.size());
  std::size_t fragments = 0;
  for (std::size_t p = 0; p < id.size(); ++p) {
    const auto& of = sim.field<Policy>(sim.find(id[p]));
    fragments += generation[p] == 1;
    if (generation[p] == of.generation && strength[p] == of.strength) continue;
    FAIL("point ", p, " of body ", id[p], " has generation ", generation[p]);
  }
  CHECK(fragments > 20);
  CHECK(fragments < id.size());
}

}  // namespace breakage_output_test
