// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include <silt/fill/particles.hpp>

namespace particle_formats_test {

using silt::FileError;
using silt::InputError;
using silt::ParticleFile;
using silt::ParticleFormat;
using silt::ParticleTable;
using silt::Vec3d;

namespace {

/// A folder of its own, removed at the end of the test.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("silt_particle_formats_" + std::to_string(std::random_device{}()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string file(const std::string& content) const {
    std::ofstream(path / "beads", std::ios::binary) << content;
    return (path / "beads").string();
  }
};

ParticleTable read(const std::string& content, const ParticleFile& how = {}) {
  const Folder folder;
  return silt::read_particles(folder.file(content), how);
}

/// Checks that reading `content` is refused with a sentence that holds the file's name and `words`.
template <class Error = FileError>
void refused(const std::string& content, const std::string& words, const ParticleFile& how = {}) {
  const Folder folder;
  const auto path = folder.file(content);
  std::string sentence = "nothing was refused";
  try {
    (void)silt::read_particles(path, how);
  } catch (const Error& error) {
    sentence = error.what();
  }
  CAPTURE(sentence);
  CHECK(sentence.find(words) != std::string::npos);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string frame(int step, const std::string& columns, const std::string& atoms, int count = 2) {
  return "ITEM: TIMESTEP\n" + std::to_string(step) + "\nITEM: NUMBER OF ATOMS\n" +
         std::to_string(count) + "\nITEM: BOX BOUNDS pp pp ff\n-1 3\n0 10\n2 4\nITEM: ATOMS " +
         columns + "\n" + atoms;
}

const std::string dump = frame(0, "id type x y z radius", "1 1 0 0 0 0.5\n2 2 0 0 1 0.25\n") +
                         frame(100, "id type x y z radius", "1 1 0 0 0.1 0.5\n2 2 0 0 2 0.25\n");

const std::string data =
    "LIGGGHTS data file, 2 atoms\n\n 2 atoms\n3 atom types\n-1 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo "
    "zhi\n"
    "\nMasses\n\n1 1.0\n\nAtoms # sphere\n\n7 3 0.5 2500 1 2 3 0 0 -1\n2 1 1.0 7800 4 5 6 # big\n\n"
    "Velocities\n\n2 1 2 3 4 5 6\n7 0 0 -1 0 0 9\n";

}  // namespace

TEST_CASE("particle_formats: the last frame of a dump is read, or that of a time step") {
  const auto last = read(dump);
  CHECK(last.position == std::vector<Vec3d>{{0, 0, 0.1}, {0, 0, 2}});
  CHECK(last.radius == std::vector<double>{0.5, 0.25});
  CHECK(last.material == std::vector<std::uint32_t>{0, 1});
  CHECK(last.density.empty());
  CHECK(read(dump, {.timestep = 0}).position[1] == Vec3d{0, 0, 1});
  CHECK(read(dump, {.types = false}).material.empty());
}

TEST_CASE("particle_formats: columns of a dump are taken by name; those unknown are skipped") {
  const auto t =
      read(frame(5, "element zu yu xu vz vy vx omegaz omegay omegax diameter mass c_1[2]",
                 "Fe 3 2 1 6 5 4 9 8 7 2 12.566370614359172 nan\n", 1));
  CHECK(t.position == std::vector<Vec3d>{{1, 2, 3}});
  CHECK(t.radius == std::vector<double>{1});
  CHECK(t.velocity == std::vector<Vec3d>{{4, 5, 6}});
  CHECK(t.angular_velocity == std::vector<Vec3d>{{7, 8, 9}});
  CHECK(std::abs(t.density.at(0) - 3) < 1e-14);  // 4 pi kg in 4/3 pi m3
  CHECK(read(frame(5, "x y z wx wy wz density radius", "1 2 3 7 8 9 2500 1\n", 1)).density ==
        std::vector<double>{2500});
}

TEST_CASE("particle_formats: scaled positions are those in the box, upright or tilted") {
  const auto upright = read(frame(0, "xs ys zs radius", "0.25 0.5 1 1\n0 1 0 1\n"));
  CHECK(upright.position == std::vector<Vec3d>{{0, 5, 4}, {-1, 10, 2}});
  // Edges (2,0,0), (-1,4,0), (0.5,1,8) from the origin: x from min(0,-1,0.5,-0.5) to
  // 2 + max(0,-1,0.5,-0.5), y from 0 to 4 + 1.
  const std::string tilted =
      replaced(replaced(frame(0, "xsu ysu zsu radius", "1 0 0 1\n0.5 0.5 0.25 1\n"), "BOUNDS",
                        "BOUNDS xy xz yz"),
               "-1 3\n0 10\n2 4\n", "-1 2.5 -1\n0 5 0.5\n0 8 1\n");
  CHECK(read(tilted).position == std::vector<Vec3d>{{2, 0, 0}, {0.625, 2.25, 2}});
}

TEST_CASE("particle_formats: a dump with units and time, and a frame of none before, is read") {
  // As LAMMPS writes them (dump_modify units yes time yes): the units once, the time in each frame.
  const std::string header = "ITEM: UNITS\nsi\nITEM: TIME\n0\n";
  CHECK(read(header + dump).position == read(dump).position);
  CHECK(read(header + dump + "ITEM: TIME\n0.5\n" + dump).size() == 2);
  const auto units = replaced(dump, "ITEM: TIMESTEP\n0\n", "ITEM: UNITS\nsi\n");
  refused(units, "line 3: expected 'ITEM: TIMESTEP', found 'ITEM: NUMBER OF ATOMS'");
  refused("ITEM: UNITS\nsi\n", "'ITEM: TIMESTEP' must follow");
  const auto time = replaced(dump, "ITEM: NUMBER", "ITEM: TIME\n0.5\nITEM: NUMBER");
  CHECK(read(time).size() == 2);
}

TEST_CASE("particle_formats: a data file gives atoms and their velocities by id") {
  const auto t = read(data);
  CHECK(t.position == std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}});
  CHECK(t.radius == std::vector<double>{0.25, 0.5});
  CHECK(t.density == std::vector<double>{2500, 7800});
  CHECK(t.material == std::vector<std::uint32_t>{2, 0});
  CHECK(t.velocity == std::vector<Vec3d>{{0, 0, -1}, {1, 2, 3}});
  CHECK(t.angular_velocity == std::vector<Vec3d>{{0, 0, 9}, {4, 5, 6}});
  CHECK(read(data.substr(0, data.find("Velocities"))).velocity.empty());
}

TEST_CASE("particle_formats: spheres of Yade, with and without materials") {
  const auto plain = read("#format x_y_z_r\n1\t2\t3\t0.5\n-1e-3\t0\t0\t0.25\n");
  CHECK(plain.position == std::vector<Vec3d>{{1, 2, 3}, {-1e-3, 0, 0}});
  CHECK(plain.radius == std::vector<double>{0.5, 0.25});
  CHECK(plain.material.empty());
  CHECK(read("# x y z r\n1 2 3 0.5\n").radius == std::vector<double>{0.5});
  CHECK(read("#format x_y_z_r_matId\n# beads\n1 2 3 0.5 4\n").material ==
        std::vector<std::uint32_t>{4});
  CHECK(read("#format x_y_z_r_attrs\n#x y z r b.id\n1 2 3 0.5 4\n").material.empty());
  CHECK(read("1 2 3 0.5\n", {.format = ParticleFormat::Yade}).size() == 1);
}

TEST_CASE("particle_formats: tables are still tables, whatever their comments say") {
  CHECK(read("x y z radius\n1 2 3 0.5\n").size() == 1);
  CHECK(read("# x y z r\nx y z radius\n1 2 3 0.5\n").size() == 1);
  CHECK(read("# 2 atoms\n# ITEM: beads\nx,y,z,radius\n1,2,3,0.5\n").size() == 1);
  refused("", "is empty");
}

TEST_CASE("particle_formats: scales turn cgs into SI; the file's own units stay without") {
  const auto t = read(data, {.scale = 1e-2, .mass_scale = 1e-3});
  CHECK(t.position[0] == Vec3d{1 * 1e-2, 2 * 1e-2, 3 * 1e-2});
  CHECK(t.radius[0] == 0.25 * 1e-2);
  CHECK(t.velocity[0] == Vec3d{0, 0, -1e-2});
  CHECK(t.angular_velocity[0] == Vec3d{0, 0, 9});
  CHECK(std::abs(t.density[0] / 2.5e6 - 1) < 1e-14);  // g/cm3 are 1000 kg/m3
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    refused<InputError>(data, "ParticleFile.scale = ", {.scale = bad});
    refused<InputError>(data, "ParticleFile.mass_scale = ", {.mass_scale = bad});
  }
  refused<InputError>(data, "ParticleFile.timestep = 3 applies to dumps only", {.timestep = 3});
}

TEST_CASE("particle_formats: Particles::read takes what the file lacks from the caller") {
  const Folder folder;
  silt::Particles<silt::Sphere> grains;
  grains.read(folder.file(dump), {.density = 2500, .timestep = 0});
  grains.read(folder.file("# x y z r\n1 2 3 0.5\n"), {.density = 1000, .material = 3});
  grains.read(folder.file("x y z radius\n1 2 3 0.5\n"), 7800, 1);
  REQUIRE(grains.size() == 4);
  CHECK(grains[1].density == 2500);
  CHECK(grains[1].material == 1);
  CHECK(grains[2].material == 3);
  CHECK(grains[3].density == 7800);
  CHECK(grains[3].material == 1);
  CHECK_THROWS_WITH_AS(grains.read(folder.file(dump), {}),
                       doctest::Contains("has no column density"), InputError);
  CHECK(grains.size() == 4);
}

TEST_CASE("particle_formats: a bad dump is refused with line and reason") {
  const auto bad = [](const std::string& from, const std::string& to, const std::string& words) {
    refused(replaced(dump, from, to), words);
  };
  bad("100\n", "ten\n", "line 13: time step: 'ten' is not a whole number from 0");
  bad("ITEM: NUMBER OF ATOMS\n2\n", "", "line 7: 'ITEM: NUMBER OF ATOMS' is missing");
  bad("ATOMS\n2\n", "ATOMS\n0\n", "line 9: time step 0 has no atoms; choose another");
  bad("ITEM: NUMBER OF ATOMS", "ITEM: NUMBER OF ENTRIES",
      "line 3: 'ITEM: NUMBER OF ENTRIES' found where");
  bad("BOUNDS pp pp ff", "BOUNDS abc origin pp pp ff", "line 5: the box is general triclinic");
  bad("-1 3\n", "-1\n", "line 6: a bound of the box is missing");
  refused(dump, "has no frame of time step 50; it has 2, of the steps 0 to 100", {.timestep = 50});
  refused(dump.substr(0, dump.size() - 15),
          "ends after line 21, where atom 2 of 2 of time step 100");
  refused(dump.substr(0, 40), "ends after line");
  refused("", "expected 'ITEM: TIMESTEP', found ''", {.format = ParticleFormat::LammpsDump});
  const auto last = [](const std::string& columns, const std::string& atoms,
                       const std::string& words) { refused(frame(7, columns, atoms), words); };
  last("id x y radius", "1 0 0 1\n2 0 0 1\n", "line 9: the columns x y z, or xu yu zu, xs ys zs");
  last("id x y z", "1 0 0 0\n2 0 0 0\n",
       "line 9: the column radius or diameter is missing; add it");
  last("x y z radius", "0 0 0 1\n0 0 0 0\n",
       "line 11: column 'radius': '0' must be greater than 0");
  last("x y z radius mass", "0 0 0 1 1\n0 0 0 1 -1\n", "line 11: column 'mass': '-1' must be");
  last("x y z radius", "0 0 0 1\n0 O 0 1\n", "line 11: column 'y': 'O' is not a number");
  last("x y z radius", "0 0 nan 1\n0 0 0 1\n", "line 10: column 'z': 'nan' is not finite");
  last("x y z radius", "0 0 0\n0 0 0 1\n", "line 10: column 'radius' is missing");
  last("x y z radius q", "0 0 0 1\n0 0 0 1 1\n", "line 10: column 'q' is missing");
  last("x y z radius", "0 0 0 1 5\n0 0 0 1\n",
       "line 10: has more values than 'ITEM: ATOMS' has columns");
  last("type x y z radius", "0 0 0 0 1\n1 0 0 0 1\n",
       "line 10: type: 0 must be a whole number from 1");
  last("x y z radius", "0 0 0 1\nITEM: TIMESTEP\n",
       "line 11: only 1 of the 2 atoms of time step 7");
  refused(replaced(frame(7, "xs ys zs radius", "0 0 0 1\n0 0 0 1\n"),
                   "ITEM: BOX BOUNDS pp pp ff\n-1 3\n0 10\n2 4\n", ""),
          "positions are scaled by the box, but 'ITEM: BOX BOUNDS' is missing");
}

TEST_CASE("particle_formats: a bad data file is refused with line and reason") {
  const auto bad = [](const std::string& from, const std::string& to, const std::string& words) {
    refused(replaced(data, from, to), words);
  };
  bad("# sphere", "# hybrid",
      "line 13: the atoms are of style 'hybrid'; silt reads atom_style sphere");
  // Columns in the order of another style: taken for a sphere at y = 2500 m.
  bad("Atoms # sphere\n\n7 3 0.5 2500 1 2 3", "Atoms\n\n7 3 1 2 0.5 2500 3",
      "line 15: the atom at (0.5, 2500, 3) lies far outside of the header's box");
  bad("0.5 2500", "0.0 2500", "line 15: diameter: '0.0' must be greater than 0");
  bad("0.5 2500", "0.5 -1", "line 15: density: '-1' must be greater than 0");
  bad("7 3 0.5", "7 A 0.5", "line 15: type: 'A' is not a whole number from 0");
  bad("4 5 6 #", "4 5 #", "line 16: z is missing");
  bad("4 5 6 #", "4 5 six #", "line 16: z: 'six' is not a number");
  bad("0 0 -1\n", "0 0\n", "line 15: an image flag is missing");
  bad("0 0 -1\n", "0 0 -1 8\n", "line 15: has '8' after its values");
  bad(" 2 atoms\n3", " 3 atoms\n3",
      "section 'Atoms' ends after 2 atoms, but the header announces 3");
  bad("Velocities\n\n2 1", "Velocities\n\n3 1", "line 20: id 3 is not in the section 'Atoms'");
  bad("2 1 2 3 4 5 6", "2 1 2 3 4 5", "line 20: wz is missing");
  bad("2 1 2 3 4 5 6", "2 1 2 3 4 5 6 7", "line 20: has '7' after its values");
  bad("2 1 1.0 7800", "7 1 1.0 7800", "line 18: ids of atoms are not unique");
  bad("Masses", "Velocities", "line 9: 'Velocities' is before 'Atoms'; move it after");
  bad("Atoms # sphere", "Ellipsoids", "line 18: 'Velocities' is before 'Atoms'");
  refused(data.substr(0, data.find("Atoms")), "has no section 'Atoms' with atoms in it");
}

TEST_CASE("particle_formats: a bad file of Yade is refused with line and reason") {
  const std::string head = "#format x_y_z_r\n0 0 0 1\n";
  refused(head + "0 0 0\n", "line 3: r is missing");
  refused(head + "0 0 0 0\n", "line 3: r: '0' must be greater than 0; silt has no point particles");
  refused(head + "0 a 0 1\n", "line 3: y: 'a' is not a number");
  refused("#format x_y_z_r_matId\n0 0 0 1 -1\n",
          "line 2: matId: '-1' is not a whole number from 0");
  refused("#format x_y_z_r_matId\n0 0 0 1 5000000000\n", "matId: 5000000000 is too large");
  refused("#format id_x_y_z_r_matId\n1 0 0 0 1 1\n",
          "format 'id_x_y_z_r_matId' is not read; export");
  refused("# none\n", "has no spheres", {.format = ParticleFormat::Yade});
}

}  // namespace particle_formats_test
