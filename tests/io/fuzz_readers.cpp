// silt - BSD-3-Clause, see LICENSE
// Every reader of files but that of checkpoints' states (fuzz_checkpoint.cpp), with mutated files.
#include <charconv>

#include <io/fuzz_support.hpp>

#include <silt/boundary/mesh_file.hpp>
#include <silt/boundary/stl.hpp>
#include <silt/files/csv_table.hpp>
#include <silt/files/vtk.hpp>
#include <silt/fill/particle_file.hpp>
#include <silt/fill/particle_formats.hpp>
#include <silt/shape/multi_sphere.hpp>

namespace fuzz_readers_test {

namespace {

using fuzz::Folder;
using fuzz::Judge;
using fuzz::write_bytes;
using silt::Vec3d;

/// Gives `inputs()` mutations of the seeds to read(path).
template <class Read>
void all_inputs(const std::string& reader, const std::vector<std::string>& seeds, const Read& read,
                const std::string& name = "input") {
  const Folder folder;
  const std::string path = folder / name;
  Judge judge(reader);
  const int inputs = fuzz::inputs();
  for (int k = 0; k < inputs; ++k) {
    silt::Random random(static_cast<std::uint64_t>(k) + 1);
    write_bytes(path, fuzz::mutated(seeds, random));
    judge(static_cast<std::uint64_t>(k), [&] { return read(path); });
  }
  CHECK(judge.refused() > inputs / 5);  // the mutations do break files
  CHECK(judge.taken() > 0);             // and not all of them
}

std::vector<std::array<Vec3d, 3>> soup() {
  return {{{{0, 0, 0}, {1, 0, 0.125}, {0, 1, 0}}}, {{{0, 0, 0}, {-1e-3, 2, 0}, {0, 1, 5e5}}}};
}

bool is_finite(const std::vector<Vec3d>& all) {
  return std::all_of(all.begin(), all.end(), [](const Vec3d& v) { return silt::is_finite(v); });
}

}  // namespace

TEST_CASE("fuzz: STL files, binary and text") {
  const std::string ascii = silt::detail::ascii_stl(soup());
  std::string two = ascii + ascii;
  all_inputs(
      "read_stl", {silt::detail::binary_stl(soup()), ascii, two, "SOLID a facet normal 0 0 1\r\n"},
      [](const std::string& path) {
        const auto triangles = silt::read_stl(path);
        return !triangles.empty() &&
               std::all_of(triangles.begin(), triangles.end(), [](const auto& t) {
                 return silt::is_finite(t[0]) && silt::is_finite(t[1]) && silt::is_finite(t[2]);
               });
      });
}

TEST_CASE("fuzz: particle files") {
  all_inputs("read_particle_file",
             {"x,y,z,radius,density,vx,vy,vz,material\n0,1,-2e-3,0.5,2500,1,2,3,0\n"
              "4,5,6,1e-3,7800,0,0,-1.5,3\n",
              "# beads\nx y z diameter wx wy wz\n1 2 3 0.5 0 0 1 # one\n+4 5 6 .25 7 8 9\n",
              "\xEF\xBB\xBFradius;x;y;z\n1;2;3;4\n"},
             [](const std::string& path) {
               const auto t = silt::read_particle_file(path);
               const auto fits = [&](const auto& column) {
                 return column.empty() || column.size() == t.size();
               };
               const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
               return t.size() > 0 && t.radius.size() == t.size() && fits(t.density) &&
                      fits(t.velocity) && fits(t.angular_velocity) && fits(t.material) &&
                      is_finite(t.position) && is_finite(t.velocity) &&
                      is_finite(t.angular_velocity) &&
                      std::all_of(t.radius.begin(), t.radius.end(), positive) &&
                      std::all_of(t.density.begin(), t.density.end(), positive);
             });
}

TEST_CASE("fuzz: mesh files, OBJ, PLY and VTP") {
  const Folder folder;
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::array<std::uint32_t, 3>> faces{{0, 1, 2}, {0, 1, 3}};
  silt::write_vtp_triangles(folder / "seed.vtp", points, faces);
  const std::string head =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const auto good = [](const std::string& path) {
    const auto triangles = silt::read_mesh(path);
    return !triangles.empty() && std::all_of(triangles.begin(), triangles.end(), [](const auto& t) {
      return silt::is_finite(t[0]) && silt::is_finite(t[1]) && silt::is_finite(t[2]);
    });
  };
  all_inputs(
      "read_mesh (VTP)",
      {silt::detail::read_file(folder / "seed.vtp"),
       "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\">"
       "<Points><DataArray type=\"Float32\" format=\"ascii\">0 0 0 1 0 0 0 1 0</DataArray>"
       "</Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2</DataArray>"
       "<DataArray type=\"Int32\" Name=\"offsets\">3</DataArray></Polys></Piece></PolyData>"
       "</VTKFile>"},
      good, "input.vtp");
  all_inputs("read_mesh (PLY)",
             {"ply\nformat ascii 1.0\n" + head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
              "ply\nformat binary_little_endian 1.0\n" + head + std::string(36, '\0') + '\3' +
                  std::string(12, '\0')},
             good, "input.ply");
  all_inputs("read_mesh (OBJ)",
             {"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nf 1/1 2//1 3/1/1 4\nf -1 -2 \\\n -3\n"}, good,
             "input.obj");
}

TEST_CASE("fuzz: particle files of other codes") {
  const auto good = [](const std::string& path) {
    const auto t = silt::read_particles(path);
    const auto fits = [&](const auto& column) {
      return column.empty() || column.size() == t.size();
    };
    return t.size() > 0 && t.radius.size() == t.size() && fits(t.density) && fits(t.velocity) &&
           fits(t.angular_velocity) && fits(t.material) && is_finite(t.position);
  };
  all_inputs("read_particles (LAMMPS)",
             {"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS xy xz yz pp pp pp\n"
              "0 1 0\n0 1 0.5\n0 1 0\nITEM: ATOMS id type xs ys zs radius vx vy vz\n"
              "1 1 0 0.5 1 0.25 1 2 3\n",
              "title\n2 atoms\n0 1 xlo xhi\n\nAtoms # sphere\n\n1 1 0.5 2500 0 0 0\n"
              "2 1 0.5 2500 0 0 1 0 0 0\n\nVelocities\n\n1 1 2 3 4 5 6\n"},
             good);
  all_inputs("read_particles (Yade)",
             {"#format x_y_z_r\n0\t0\t0\t1\n1 2 3 0.5\n", "#format x_y_z_r_matId\n1 2 3 .5 1\n"},
             good);
}

TEST_CASE("fuzz: multi-spheres") {
  all_inputs(
      "read_multi_sphere",
      {"# a rod\n-1 0 0 1\n\n1 0 0 1.5  # the thick end\n", "0 0 0 1e-3\n1e-3 2e-3 0 2e-3\n"},
      [](const std::string& path) {
        const auto form = silt::read_multi_sphere(path, 1e-3);
        form.check();
        return !form.balls.empty();
      });
}

TEST_CASE("fuzz: tables that are resumed") {
  constexpr double limit = 2;  // [s]
  all_inputs(
      "CsvTable::resume",
      {"time [s],energy [J]\n0,1\n0.5,-2e-3\n1,nan\n1.5,4\n2,5\n2.5,6\n", "time [s],energy [J]\n"},
      [](const std::string& path) {
        silt::CsvTable::resume(path, {"time [s]", "energy [J]"}, limit).add_row({limit, 7});
        std::string content = silt::detail::read_file(path);
        std::string_view rest = content;
        if (!rest.starts_with("time [s],energy [J]\n") || !rest.ends_with("\n2,7\n")) return false;
        rest.remove_prefix(rest.find('\n') + 1);
        double before = -HUGE_VAL;
        for (; !rest.empty(); rest.remove_prefix(rest.find('\n') + 1)) {
          double time = std::nan("");
          std::from_chars(rest.data(), rest.data() + rest.size(), time);
          if (!std::isfinite(time) || time < before || time > limit) return false;
          before = time;
        }
        return true;
      });
}

TEST_CASE("fuzz: time series that are resumed") {
  const Folder folder;
  silt::VtkSeries series(folder.path, "seed");
  for (const double time : {0.0, 0.5, 1.25}) series.add(time, "frame.vtp");
  all_inputs(
      "VtkSeries::resume", {silt::detail::read_file(series.path())},
      [](const std::string& path) {
        const std::string where = path.substr(0, path.rfind('/'));
        auto resumed = silt::VtkSeries::resume(where, "input", 1);
        resumed.add(1, "last.vtp");  // refused unless all before are earlier
        const auto content = silt::detail::read_file(path);
        return resumed.frames() >= 1 && content.ends_with("</Collection>\n</VTKFile>\n");
      },
      "input.pvd");
}

TEST_CASE("fuzz: the fields of a checkpoint, with and without a right checksum") {
  const Folder folder;
  silt::CheckpointWriter writer("Sphere Hertz");
  const std::vector<double> doubles(20, 1.5);
  const std::vector<std::uint8_t> bytes{1, 2, 255};
  writer.add("position", doubles), writer.add("kind", bytes), writer.add_text("note", "a");
  writer.commit(folder / "seed");
  const auto seed = silt::detail::read_file(folder / "seed");
  all_inputs("CheckpointReader", {seed}, [&](const std::string& path) {
    // Half of them as a forger would make them.
    auto content = silt::detail::read_file(path);
    if (content.size() > 40 && content.size() % 2 == 0) {
      silt::detail::Crc64 crc;
      crc.add(content.data(), content.size() - 8);
      const auto sum = crc.value();
      std::memcpy(content.data() + content.size() - 8, &sum, 8);
      write_bytes(path, content);
    }
    const silt::CheckpointReader reader(path);
    reader.require_signature("Sphere Hertz");
    return reader.get<double>("position", 20).size() == 20 &&
           reader.get<std::uint8_t>("kind").size() <= content.size() &&
           reader.text("note").size() <= content.size();
  });
}

TEST_CASE("readers: a file of 4 TB that has no content is refused at once, in little memory") {
  const Folder folder;
  const auto refuses = [&](const char* name, std::string_view begin, const auto& read) {
    const std::string path = folder / name;
    write_bytes(path, std::string(begin));
    if (::truncate(path.c_str(), off_t{4} << 40) != 0) {
      MESSAGE("no such files here: ", std::strerror(errno));
      return;
    }
    Judge judge(name);
    const auto start = std::chrono::steady_clock::now();
    CHECK(judge(0, [&] { return read(path), false; }));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    CHECK(took.count() < 2);
    std::filesystem::remove(path);
  };
  const auto stl = [](const std::string& path) { (void)silt::read_stl(path); };
  refuses("text.stl", "solid a\n", stl);
  refuses("zeros.stl", "", stl);
  refuses("p.csv", "x,y,z,radius\n",
          [](const auto& path) { (void)silt::read_particle_file(path); });
  refuses("m.txt", "0 0 0 1\n", [](const auto& path) { (void)silt::read_multi_sphere(path); });
  refuses("t.csv", "time\n",
          [](const auto& path) { (void)silt::CsvTable::resume(path, {"time"}, 1); });
  refuses("series.pvd", "<?xml", [](const auto& path) {
    (void)silt::VtkSeries::resume(path.substr(0, path.rfind('/')), "series", 1);
  });
  silt::CheckpointWriter("s").commit(folder / "good");
  auto head = silt::detail::read_file(folder / "good").substr(0, 40);
  const std::uint64_t whole = std::uint64_t{4} << 40;
  std::memcpy(head.data() + 16, &whole, 8);
  const auto checkpoint = [](const auto& path) { (void)silt::CheckpointReader(path); };
  refuses("c.silt", head, checkpoint);
  std::memcpy(head.data() + 24, &whole, 8);  // the table would be as long
  refuses("table.silt", head, checkpoint);
}

TEST_CASE("readers: a sparse file that fits into memory is refused from its first blocks") {
  const Folder folder;
  for (const char* name : {"a.stl", "a.csv"}) {
    const std::string path = folder / name;
    write_bytes(path, "solid a\n");
    REQUIRE(::truncate(path.c_str(), off_t{3} << 29) == 0);  // 1.6 GB
    Judge judge(name);                                       // 512 MB at most
    CHECK(judge(0, [&] {
      if (name[2] == 's') (void)silt::read_stl(path);
      if (name[2] == 'c') (void)silt::read_particle_file(path);
      return false;
    }));
  }
}

}  // namespace fuzz_readers_test
