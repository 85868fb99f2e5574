// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <random>
#include <string>

#include <silt/core/random.hpp>
#include <silt/fill/particle_file.hpp>

namespace particle_file_test {

using silt::ParticleTable;
using silt::Vec3d;

namespace {

/// A folder of its own, removed at the end of the test.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("silt_particle_file_" + std::to_string(std::random_device{}()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string file(const std::string& name) const { return (path / name).string(); }
  std::string file(const std::string& name, const std::string& content) const {
    std::ofstream(path / name, std::ios::binary) << content;
    return file(name);
  }
};

/// Checks that reading `content` is refused with a sentence that holds the file's name and `words`.
void check_refused(const std::string& content, const std::string& words) {
  const Folder folder;
  const auto path = folder.file("beads.csv", content);
  std::string sentence = "nothing was refused";
  try {
    silt::read_particle_file(path);
  } catch (const silt::FileError& error) {
    sentence = error.what();
  }
  CAPTURE(sentence);
  CAPTURE(words);
  CHECK(sentence.find(path) != std::string::npos);
  CHECK(sentence.find(words) != std::string::npos);
}

ParticleTable random_table(std::size_t n, bool all_columns) {
  silt::Random random(8);
  const auto any = [&] { return random.normal() * std::pow(10.0, random.uniform(-12, 12)); };
  const auto vector = [&] {
    const double x = any(), y = any(), z = any();
    return Vec3d{x, y, z};
  };
  ParticleTable t;
  for (std::size_t i = 0; i < n; ++i) {
    t.position.push_back(vector());
    t.radius.push_back(std::abs(any()));
    if (!all_columns) continue;
    t.density.push_back(std::abs(any()));
    t.velocity.push_back(vector());
    t.angular_velocity.push_back(vector());
    t.material.push_back(static_cast<std::uint32_t>(random.bits()));
  }
  return t;
}

void check_equal(const ParticleTable& a, const ParticleTable& b) {
  CHECK(a.position == b.position);
  CHECK(a.radius == b.radius);
  CHECK(a.density == b.density);
  CHECK(a.velocity == b.velocity);
  CHECK(a.angular_velocity == b.angular_velocity);
  CHECK(a.material == b.material);
}

}  // namespace

TEST_CASE("particle_file: what is written is read back bit for bit") {
  const Folder folder;
  for (const bool all_columns : {true, false}) {
    auto table = random_table(1000, all_columns);
    table.position[0] = {std::numeric_limits<double>::max(), -0.0,
                         std::numeric_limits<double>::denorm_min()};
    table.radius[0] = std::numeric_limits<double>::min();
    const auto path = folder.file("beads.csv");
    silt::write_particle_file(path, table);
    check_equal(table, silt::read_particle_file(path));
  }
}

TEST_CASE("particle_file: columns may stand in any order, between commas, semicolons or blanks") {
  const Folder folder;
  const ParticleTable expected{
      {{1, 2, 3}, {-4, 5e-3, 6}}, {0.5, 0.25}, {2500, 7800}, {}, {}, {1, 0}};
  const char* const forms[] = {
      "x,y,z,radius,density,material\n1,2,3,0.5,2500,1\n-4,5e-3,6,.25,7800,0\n",
      "x [m],y [m],z[m],radius [m],density [kg/m3],material [-]\n1,2,3,0.5,2500,1\n"
      "-4,5e-3,6,.25,7800,0\n",
      "x [m] y [m] z [m] radius [m] density [kg/m3] material\n1 2 3 0.5 2500 1\n-4 5e-3 6 .25 7800 "
      "0",
      "z;diameter;x;material;y;density\n3;1;1;1;2;2500\n6;0.5;-4;0;0.005;7800",
      "\xEF\xBB\xBF# beads\r\n\r\n x y\tz  radius density material \r\n"
      "1 2 3 0.5 2500 1 # first\r\n#\r\n  -4 +0.005 6.0 2.5E-1 7.8e3 0  \r\n",
      "x, y, z, radius, density, material\n 1 , 2, 3, 0.5, 2500, 1\n-4, 5e-3, 6, 0.25, 7800, "
      "0\n\n"};
  for (const char* form : forms) {
    CAPTURE(form);
    check_equal(silt::read_particle_file(folder.file("beads.txt", form)), expected);
  }
}

TEST_CASE(
    "particle_file: velocities are read into their vectors, and columns left out stay empty") {
  const Folder folder;
  const auto table = silt::read_particle_file(
      folder.file("beads.txt", "wz wy wx vz vy vx radius z y x\n9 8 7 6 5 4 1 3 2 1\n"));
  check_equal(table, {{{1, 2, 3}}, {1}, {}, {{4, 5, 6}}, {{7, 8, 9}}, {}});
}

TEST_CASE("particle_file: numbers are read and written with a point whatever the locale") {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const Folder folder;
  const ParticleTable table{{{1234567.5, 0.25, -1e-9}}, {1.5}, {2500.75}, {}, {}, {1234567}};
  silt::write_particle_file(folder.file("beads.csv"), table);
  const auto read = silt::read_particle_file(folder.file("beads.csv"));
  std::locale::global(before);
  check_equal(read, table);
}

TEST_CASE("particle_file: a missing file and a folder are refused with the system's reason") {
  const Folder folder;
  CHECK_THROWS_WITH_AS(silt::read_particle_file(folder.file("none.csv")),
                       doctest::Contains("No such file"), silt::FileError);
  CHECK_THROWS_WITH_AS(silt::read_particle_file(folder.path.string()),
                       doctest::Contains("directory"), silt::FileError);
}

TEST_CASE("particle_file: an empty file and a file without particles are refused") {
  check_refused("", "is empty; it needs a line that names its columns");
  check_refused("\n  \n# only a comment\n", "is empty");
  check_refused("x y z radius\n# none\n", "has a header but no particles");
}

TEST_CASE("particle_file: a bad header is refused with line and column") {
  check_refused("# beads\n\nx y z size\n0 0 0 1\n", "line 3: 'size' is not a column name");
  check_refused("0 0 0 1\n",
                "line 1: '0' is not a column name; the first line that is not a comment");
  check_refused("# x y z radius\n0 0 0 1\n", "; a header that begins with '#' is a comment");
  check_refused("x,y,z,,radius\n", "line 1: '' is not a column name");
  check_refused("x y radius\n0 0 1\n", "line 1: the column 'z' is missing");
  check_refused("x y z\n0 0 0\n", "line 1: the column 'radius' or 'diameter' is missing");
  check_refused("x y z radius vx vz\n", "line 1: the column 'vy' is missing");
  check_refused("x y z radius wz\n", "line 1: the column 'wx' is missing");
  check_refused("x [mm],y,z,radius\n",
                "line 1: column 'x' has the unit '[mm]', but numbers are read in [m]");
  check_refused("x y z diameter [um]\n", "column 'diameter' has the unit '[um]'");
  check_refused("[m] x y z radius\n", "line 1: '' is not a column name");
  check_refused("x y z radius y\n", "line 1: column 'y' is named twice");
  check_refused("x y z radius diameter\n", "either 'radius' or 'diameter', not both");
}

TEST_CASE(
    "particle_file: a bad value is refused with line, column and the text that stands there") {
  const std::string header = "x,y,z,radius,density,material\n0,0,0,1,1,0\n# comment\n";
  check_refused(header + "0,0,0,1,1\n", "line 4: has 5 values, but the header names 6 columns");
  check_refused(header + "0,0,0,1,1,0,\n", "line 4: has 7 values, but the header names 6 columns");
  check_refused(header + "0,zero,0,1,1,0\n", "line 4: column 'y': 'zero' is not a number");
  check_refused(header + "0,,0,1,1,0\n", "line 4: column 'y': '' is not a number");
  check_refused(header + "0,0,0x1,1,1,0\n", "line 4: column 'z': '0x1' is not a number");
  check_refused(header + "0,0 1,0,1,1,0\n", "line 4: column 'y': '0 1' is not a number");
  check_refused(header + "+-1,0,0,1,1,0\n", "line 4: column 'x': '+-1' is not a number");
  check_refused(header + "nan,0,0,1,1,0\n", "line 4: column 'x': 'nan' is not finite");
  check_refused(header + "0,0,-inf,1,1,0\n", "line 4: column 'z': '-inf' is not finite");
  check_refused(header + "0,0,1e999,1,1,0\n", "column 'z': '1e999' is outside the range");
  check_refused(header + "0,0,0,0,1,0\n", "line 4: column 'radius': '0' must be greater than 0");
  check_refused(header + "0,0,0,-1e-3,1,0\n", "column 'radius': '-1e-3' must be greater than 0");
  check_refused(header + "0,0,0,1,0,0\n", "column 'density': '0' must be greater than 0");
  check_refused(header + "0,0,0,1,1,0.5\n", "column 'material': '0.5' must be a whole number");
  check_refused(header + "0,0,0,1,1,-1\n", "column 'material': '-1' must be a whole number");
  check_refused("x y z diameter\n0 0 0 -2\n", "line 2: column 'diameter': '-2'");
  check_refused(header + std::string(1 << 20, '7') + "x,0,0,1,1,0\n",
                "7'... (1048577 bytes) is outside the range");
  check_refused(header + "\x1b[2J,0,0,1,1,0\n", "column 'x': '\\x1b[2J' is not a number");
  check_refused(std::string("\xFF\xFEx\0", 4), "is text in UTF-16; save it as UTF-8");
  check_refused(std::string("x,y\0", 4), "is not text: it has zero bytes");
}

TEST_CASE("particle_file: a table that could not be read back is refused and leaves the old file") {
  const Folder folder;
  const auto path = folder.file("beads.csv");
  const auto good = random_table(3, true);
  silt::write_particle_file(path, good);
  const auto says = [&](auto change, const char* words) {
    auto table = good;
    change(table);
    CHECK_THROWS_WITH_AS(silt::write_particle_file(path, table), doctest::Contains(words),
                         silt::InputError);
    check_equal(silt::read_particle_file(path), good);
  };
  says([](ParticleTable& t) { t = {}; }, "ParticleTable has no particles");
  says([](ParticleTable& t) { t.radius.pop_back(); },
       "ParticleTable.radius has 2 entries for 3 positions");
  says([](ParticleTable& t) { t.velocity.pop_back(); }, "ParticleTable.velocity has 2 entries");
  says([](ParticleTable& t) { t.material.push_back(0); }, "ParticleTable.material has 4 entries");
  says([](ParticleTable& t) { t.radius[1] = -1; }, "ParticleTable.radius[1] = -1 must be");
  says([](ParticleTable& t) { t.density[2] = 0; }, "ParticleTable.density[2] = 0 must be");
  says([](ParticleTable& t) { t.position[0].y = std::numeric_limits<double>::infinity(); },
       "ParticleTable.position[0] = (");
  CHECK_THROWS_AS(silt::write_particle_file(folder.file("none/beads.csv"), good), silt::FileError);
}

}  // namespace particle_file_test
