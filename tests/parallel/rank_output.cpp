// silt - BSD-3-Clause, see LICENSE
// What observers write on many ranks: the files of one process, and pieces with one index.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <mutex>
#include <sstream>

#include <silt/io/contact_series.hpp>
#include <silt/io/observers.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/io/wall_series.hpp>
#include <silt/measure/stress.hpp>

#include "rank_scenes.hpp"
#include "refusal.hpp"

namespace parallel_rank_output_test {

namespace {

namespace fs = std::filesystem;
using namespace silt_test;
using silt_test::refusal;

bool holds(const std::string& all, const std::string& part) { return all.find(part) != all.npos; }
std::string content(const std::string& path) { return silt::detail::read_file(path); }
std::vector<std::string> files_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}
/// The numbers of a table, without its header.
std::vector<double> numbers(const std::string& path) {
  std::string all = content(path);
  all.erase(0, all.find('\n') + 1);
  std::replace(all.begin(), all.end(), ',', ' ');
  std::istringstream in(all);
  std::vector<double> values;
  for (double x; in >> x;) values.push_back(x);
  return values;
}
/// Equal but for rounding, which the order of sums over ranks changes.
void check_alike(const std::string& a, const std::string& b) {
  CAPTURE(a);
  const auto x = numbers(a), y = numbers(b);
  REQUIRE(x.size() == y.size());
  REQUIRE(!x.empty());
  double largest = 0, off = 0;
  for (std::size_t k = 0; k < x.size(); ++k)
    largest = std::max(largest, std::abs(x[k])), off = std::max(off, std::abs(x[k] - y[k]));
  CHECK(off <= 1e-11 * largest);
}
std::size_t points_of(const std::string& piece) {
  const std::string all = content(piece), word = "NumberOfPoints=\"";
  return std::stoul(all.substr(all.find(word) + word.size()));
}
std::size_t count_of(const std::string& all, const std::string& word) {
  std::size_t n = 0;
  for (auto at = all.find(word); at != all.npos; at = all.find(word, at + 1)) ++n;
  return n;
}

template <class Sim>
void write_all(Sim& sim, const std::string& folder) {
  sim.run(0.012, silt::vtk_series(folder, silt::every(0.004)),
          silt::csv_series(folder, silt::every(0.006)),
          silt::contact_series(folder, silt::every(0.006)),
          silt::contact_csv(folder, silt::every(0.006)),
          silt::wall_series(folder + "/floor.csv", 0, silt::every(0.002)),
          silt::table(folder + "/table.csv", {"t", "kinetic", "touching", "x", "speed", "stress"},
                      silt::every(0.002), [](const auto& s) {
                        const silt::Box box{{0, 0, 0}, {0.055, 0.027, 0.01}};
                        const auto contacts = static_cast<double>(s.touching_pairs());
                        const double stress =
                            s.has_contacts() ? silt::stress(s, box).pressure() : 0;
                        return std::vector<double>{s.time(),          s.kinetic_energy(),
                                                   contacts,          s.centre_of_mass().x,
                                                   s.largest_speed(), stress};
                      }));
}

TEST_CASE("rank output: tables are those of one process, pieces have one index") {
  const Folder one;
  with_bed({}, [&](auto& sim) { write_all(sim, one.path); });
  for (const int n : {1, 3}) {
    CAPTURE(n);
    const Folder many;
    silt::run_on_ranks(n, [&](const silt::ThreadComm& comm) {
      with_bed(
          {}, [&](auto& sim) { write_all(sim, many.path); }, bed_slabs(comm));
    });
    for (const char* name :
         {"table.csv", "floor.csv", "particles_000001200.csv", "contacts_000001200.csv"})
      check_alike(one / name, many / name);
    if (n == 1) {
      CHECK(files_in(one.path) == files_in(many.path));
      continue;
    }
    // Each frame has its index, which names a piece a rank; together they have all particles.
    const std::string series = content(many / "particles.pvd");
    CHECK(count_of(series, "<DataSet") == 4);
    CHECK(holds(series, "particles_000001200.pvtp"));
    const std::string index = content(many / "particles_000001200.pvtp");
    CHECK(count_of(index, "<Piece") == 3);
    CHECK(holds(index, "Name=\"angular_velocity\" NumberOfComponents=\"3\""));
    std::size_t particles = 0, contacts = 0;
    for (const char* piece : {"_r0", "_r1", "_r2"}) {
      const std::string file = std::string("particles_000001200") + piece + ".vtp";
      CHECK(holds(index, "Source=\"" + file + "\""));
      particles += points_of(many / file);
      contacts += points_of(many / (std::string("contacts_000001200") + piece + ".vtp")) / 2;
    }
    CHECK(particles == 54);
    const std::string lines = content(one / "contacts_000001200.csv");
    CHECK(contacts == count_of(lines, "\n") - 1);
    CHECK(contacts > 10);
    CHECK(content(one / "walls.pvd") == content(many / "walls.pvd"));
    for (const auto& name : files_in(many.path)) CHECK(!holds(name, "partial"));
  }
}

TEST_CASE("rank output: a rank without particles writes a piece with all arrays") {
  const Folder many;
  silt::run_on_ranks(8, [&](const silt::ThreadComm& comm) {
    with_bed(
        {.particles = 1},
        [&](auto& sim) {
          sim.run(0.001, silt::vtk_series(many.path, silt::every(0.001)));
          if (sim.rank() == 7) CHECK(sim.rows() == 0);
          CHECK(sim.size() == 9);
          CHECK(sim.ranks() == 8);
        },
        bed_slabs(comm));
  });
  const std::string empty = content(many / "particles_000000100_r7.vtp");
  CHECK(points_of(many / "particles_000000100_r7.vtp") == 0);
  for (const char* name : {"radius", "velocity", "id", "material", "angular_velocity"})
    CHECK(holds(empty, std::string("Name=\"") + name + "\""));
}

TEST_CASE(
    "rank output: sums are equal on all ranks; what a rank throws in an observer, all throw") {
  std::mutex mutex;
  std::vector<std::array<double, 3>> seen;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    with_bed(
        {},
        [&](auto& sim) {
          sim.run(0.002);
          const double rows = sim.sum_over_ranks(static_cast<double>(sim.rows()));
          CHECK(rows == 54);
          CHECK(sim.largest_over_ranks(sim.rank()) == 2);
          const std::array own{sim.kinetic_energy(), sim.total_mass(), sim.mean_velocity().z};
          const std::lock_guard lock(mutex);
          seen.push_back(own);
        },
        bed_slabs(comm));
  });
  REQUIRE(seen.size() == 3);
  CHECK(seen[0] == seen[1]);
  CHECK(seen[0] == seen[2]);
  // Before, behind and between sums, in an observer and at its start.
  for (const int when : {0, 1, 2}) {
    int told = 0;
    silt::run_on_ranks(
        3,
        [&](const silt::ThreadComm& comm) {
          with_bed(
              {},
              [&](auto& sim) {
                auto fails = silt::at(silt::every(0.001), [&](const auto& s) {
                  if (when == 0 && comm.rank() == 1) throw silt::FileError("the disk is full");
                  s.kinetic_energy();
                  if (when == 1 && comm.rank() == 1) throw silt::FileError("the disk is full");
                  s.total_mass();
                  if (when == 2 && comm.rank() == 1) throw silt::FileError("the disk is full");
                });
                const std::string words = refusal([&] { sim.run(0.002, fails); });
                CHECK(holds(words, "rank 1 of 3: the disk is full"));
                // All can go on together.
                CHECK(sim.sum_over_ranks(1) == 3);
                const std::lock_guard lock(mutex);
                ++told;
              },
              bed_slabs(comm));
        },
        10);
    CHECK(told == 3);
  }
}

TEST_CASE("rank output: a file that rank 0 cannot write is told on all ranks") {
  const Folder many;
  { std::ofstream(many / "file") << "in the way"; }
  silt::run_on_ranks(
      2,
      [&](const silt::ThreadComm& comm) {
        with_bed(
            {},
            [&](auto& sim) {
              const std::string words = refusal(
                  [&] { sim.run(0.002, silt::vtk_series(many / "file", silt::every(0.001))); });
              CHECK(holds(words, "rank 0 of 2"));
              CHECK(holds(words, "is a file"));
              CHECK_NOTHROW(sim.run(0.001));
            },
            bed_slabs(comm));
      },
      10);
}

TEST_CASE("rank output: progress and warnings come from rank 0 alone") {
  std::FILE* const out = std::tmpfile();
  std::vector<std::string> warnings;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    with_bed(
        {.floor = -1e3},
        [&](auto& sim) {
          sim.gravity = {0, 0, 9810};
          sim.run(0.0002, silt::progress({.out = out}),
                  silt::on_warnings([&](const std::string& w) { warnings.push_back(w); }));
        },
        bed_slabs(comm));
  });
  std::rewind(out);
  std::string text(4096, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), out));
  std::fclose(out);
  CHECK(warnings.size() == count_of(text, "warning: "));
  CHECK(count_of(text, "mm/s2; give it in m/s2") == 1);
  CHECK(count_of(text, "\n") == warnings.size() + 1);  // ... and one line of progress
}

TEST_CASE("rank output: contacts that overlap at the start are counted once over all ranks") {
  std::vector<std::string> warnings;
  silt::run_on_ranks(3, [&](const silt::ThreadComm& comm) {
    with_bed(
        {},
        [&](auto& sim) {
          silt::Particles<silt::Sphere> row;  // above the bed, over all slabs; numbers from 54 on
          for (int k = 0; k < 6; ++k)
            row.add({.position = {0.005 + 0.009 * k + (k == 5 ? -1e-5 : 0), 0.0135, 0.05},
                     .radius = 0.005,
                     .density = 2500});
          sim.add(row);
          sim.run(1e-5, silt::on_warnings([&](const std::string& w) { warnings.push_back(w); }));
        },
        bed_slabs(comm));
  });
  REQUIRE(warnings.size() == 1);
  CHECK(holds(warnings[0], "5 contacts overlap by more than 5 %"));
  CHECK(holds(warnings[0], "at most by 20.2 % (particles 58 and 59)"));
}

}  // namespace

}  // namespace parallel_rank_output_test
