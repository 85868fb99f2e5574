// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <silt/files/vtk.hpp>

namespace vtk_test {

namespace {

namespace fs = std::filesystem;

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_vtk_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

void write_text(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

// Prints what VTK's own reader finds: counts, then every array as name, VTK type, components and
// values; numbers as Python's repr, which reads back exactly.
constexpr const char* vtk_dump = R"(
import sys
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkCommonCore import vtkObject, vtkIdList
reader = vtkXMLPolyDataReader()
errors = []
reader.AddObserver('ErrorEvent', lambda *_: errors.append(1))
reader.SetFileName(sys.argv[1])
reader.Update()
data = reader.GetOutput()
print('errors', len(errors))
print('points', data.GetNumberOfPoints(), 'verts', data.GetNumberOfVerts(),
      'polys', data.GetNumberOfPolys())
def dump(array, name):
    print(name.replace(' ', '_'), array.GetDataTypeAsString().replace(' ', '_'),
          array.GetNumberOfComponents(), array.GetNumberOfTuples())
    for i in range(array.GetNumberOfTuples()):
        print(*(repr(float(x)) for x in array.GetTuple(i)))
if data.GetPoints():
    dump(data.GetPoints().GetData(), 'Points')
for k in range(data.GetPointData().GetNumberOfArrays()):
    dump(data.GetPointData().GetArray(k), data.GetPointData().GetArrayName(k))
for c in range(data.GetNumberOfCells()):
    ids = vtkIdList()
    data.GetCellPoints(c, ids)
    print('cell', *(ids.GetId(k) for k in range(ids.GetNumberOfIds())))
)";

/// What VTK reads from the file; empty, with a message, where this machine has no VTK.
std::string as_vtk_reads(const Folder& folder, const std::string& path) {
  if (std::system("/usr/bin/python3 -c 'import vtkmodules.vtkIOXML' 2>/dev/null") != 0) {
    MESSAGE("skipped: /usr/bin/python3 has no VTK (Debian: apt-get install python3-vtk9)");
    return {};
  }
  write_text(folder / "dump.py", vtk_dump);
  const std::string command =
      silt::text("/usr/bin/python3 ", folder / "dump.py", " ", path, " > ", folder / "dump.txt");
  REQUIRE(std::system(command.c_str()) == 0);
  return silt::detail::read_file(folder / "dump.txt");
}

/// Reads words and numbers one after the other.
struct Words {
  std::istringstream stream;
  std::string word() {
    std::string w;
    stream >> w;
    return w;
  }
  double number() { return std::strtod(word().c_str(), nullptr); }
  std::string line() {
    std::string l;
    std::getline(stream >> std::ws, l);
    return l;
  }
};

const std::vector<silt::Vec3d> positions{{1.0 / 3, -2e-300, 3}, {0, 0.1, -0.0}, {7, 8, 9e9}};

}  // namespace

TEST_CASE("vtk: VTK's own reader finds every number of a point file") {
  const Folder folder;
  const std::string path = folder / "points.vtp";
  const std::vector<double> radius{0.1, 1e-3, 2.0 / 3};
  const std::vector<float> heat{0.1f, -2.5e-30f, 3};
  const std::vector<std::uint32_t> kind{0, 7, 4'000'000'000};
  const std::vector<int> layer{-5, 0, 5};
  const std::vector<std::array<float, 3>> spin{{1, 2, 3}, {-4, 0.5f, 6}, {7, 8, 9.25f}};
  silt::VtkFields fields;
  fields.add("radius [m]", radius).add("heat", heat).add("kind", kind).add("layer", layer);
  fields.add("velocity", positions).add("spin", spin);
  silt::write_vtp_points(path, positions, fields);

  const auto dump = as_vtk_reads(folder, path);
  if (dump.empty()) return;
  Words read{std::istringstream(dump)};
  CHECK(read.line() == "errors 0");
  CHECK(read.line() == "points 3 verts 3 polys 0");
  const auto same_vectors = [&](const auto& expected) {
    for (const auto& v : expected) {
      const auto& [x, y, z] = v;
      CHECK(read.number() == static_cast<double>(x));
      CHECK(read.number() == static_cast<double>(y));
      CHECK(read.number() == static_cast<double>(z));
    }
  };
  const auto same_numbers = [&](const auto& expected) {
    for (const auto v : expected) CHECK(read.number() == static_cast<double>(v));
  };
  CHECK(read.line() == "Points double 3 3");
  same_vectors(positions);
  CHECK(read.line() == "radius_[m] double 1 3");
  same_numbers(radius);
  CHECK(read.line() == "heat float 1 3");
  same_numbers(heat);
  CHECK(read.line() == "kind unsigned_int 1 3");
  same_numbers(kind);
  CHECK(read.line() == "layer int 1 3");
  same_numbers(layer);
  CHECK(read.line() == "velocity double 3 3");
  same_vectors(positions);
  CHECK(read.line() == "spin float 3 3");
  same_vectors(spin);
  for (int i = 0; i < 3; ++i) CHECK(read.line() == silt::text("cell ", i));
  CHECK(read.word().empty());
}

TEST_CASE("vtk: VTK's own reader finds the triangles of a surface") {
  const Folder folder;
  const std::string path = folder / "walls.vtp";
  const std::vector<silt::Vec3d> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.25}};
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {3, 0, 2}};
  const std::vector<float> wear{0, 1, 2, 3};
  silt::write_vtp_triangles(path, corners, triangles, silt::VtkFields().add("wear", wear));
  const auto dump = as_vtk_reads(folder, path);
  if (dump.empty()) return;
  CHECK(dump ==
        "errors 0\npoints 4 verts 0 polys 2\nPoints double 3 4\n0.0 0.0 0.0\n1.0 0.0 0.0\n"
        "1.0 1.0 0.0\n0.0 1.0 0.25\nwear float 1 4\n0.0\n1.0\n2.0\n3.0\ncell 0 1 2\ncell 3 0 2\n");
}

TEST_CASE("vtk: files without points are valid") {
  const Folder folder;
  const std::vector<double> none;
  silt::write_vtp_points(folder / "a.vtp", {}, silt::VtkFields().add("radius", none));
  silt::write_vtp_triangles(folder / "b.vtp", {}, {});
  for (const char* name : {"a.vtp", "b.vtp"}) {
    const auto dump = as_vtk_reads(folder, folder / name);
    if (dump.empty()) return;
    CHECK(dump.starts_with("errors 0\npoints 0 verts 0 polys 0\n"));
  }
}

TEST_CASE("vtk: the layout of a file is as documented, byte for byte") {
  // Holds where no VTK is installed too: two points and one field, 8-byte lengths before the
  // arrays.
  const Folder folder;
  const std::vector<silt::Vec3d> two{{1, 2, 3}, {4, 5, 6}};
  const std::vector<float> heat{0.5f, 1.5f};
  silt::write_vtp_points(folder / "a.vtp", two, silt::VtkFields().add("heat", heat));
  const auto content = silt::detail::read_file(folder / "a.vtp");
  const auto mark = content.find("<AppendedData encoding=\"raw\">\n_") + 31;
  const auto array_at = [&](std::size_t offset, std::size_t bytes) {
    std::uint64_t length = 0;
    std::copy_n(content.data() + mark + offset, 8, reinterpret_cast<char*>(&length));
    CHECK(length == bytes);
    return content.substr(mark + offset + 8, bytes);
  };
  for (const char* offset :
       {"\"heat\" NumberOfComponents=\"1\" format=\"appended\" offset=\"0\"",
        "\"Points\" NumberOfComponents=\"3\" format=\"appended\" offset=\"16\"",
        "\"connectivity\" NumberOfComponents=\"1\" format=\"appended\" offset=\"72\"",
        "\"offsets\" NumberOfComponents=\"1\" format=\"appended\" offset=\"88\""})
    CHECK(content.find(offset) != std::string::npos);
  CHECK(array_at(0, 8) == std::string(reinterpret_cast<const char*>(heat.data()), 8));
  CHECK(array_at(16, 48) == std::string(reinterpret_cast<const char*>(two.data()), 48));
  CHECK(array_at(72, 8) == std::string("\0\0\0\0\1\0\0\0", 8));
  CHECK(array_at(88, 8) == std::string("\1\0\0\0\2\0\0\0", 8));
}

TEST_CASE("vtk: field names, lengths and triangles are checked, and nothing is written") {
  const Folder folder;
  const std::string path = folder / "a.vtp";
  const std::vector<double> two{1, 2};
  silt::VtkFields fields;
  fields.add("radius", two);
  CHECK_THROWS_WITH_AS(fields.add("radius", two), doctest::Contains("two fields named 'radius'"),
                       silt::InputError);
  CHECK_THROWS_WITH_AS(fields.add("", two), doctest::Contains("name is empty"), silt::InputError);
  for (const char* name : {"a\"b", "a<b", "a&b", "a\nb"})
    CHECK_THROWS_WITH_AS(fields.add(name, two), doctest::Contains("must not contain"),
                         silt::InputError);
  CHECK_THROWS_WITH_AS(silt::write_vtp_points(path, positions, fields),
                       doctest::Contains("field 'radius' has 2 entries, but there are 3 points"),
                       silt::InputError);
  const std::vector<std::array<std::uint32_t, 3>> triangles{{0, 1, 2}, {0, 1, 3}};
  CHECK_THROWS_WITH_AS(silt::write_vtp_triangles(path, positions, triangles),
                       doctest::Contains("triangle 1 names point 3, but there are only 3 points"),
                       silt::InputError);
  CHECK_FALSE(fs::exists(path));
  CHECK_THROWS_WITH_AS(silt::write_vtp_points(folder / "no/a.vtp", positions),
                       doctest::Contains("No such file or directory"), silt::FileError);
}

TEST_CASE("vtk: a series is complete after every frame") {
  const Folder folder;
  const std::string out = folder / "deep/out";
  silt::VtkSeries series(out, "grains");
  const std::string empty = silt::detail::read_file(out + "/grains.pvd");
  CHECK(empty ==
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
        "byte_order=\"LittleEndian\">\n<Collection>\n</Collection>\n</VTKFile>\n");
  series.add(0, "grains_0.vtp");
  series.add(0.1, "grains_1.vtp");
  const auto content = silt::detail::read_file(series.path());
  CHECK(content.find("<DataSet timestep=\"0.1\" group=\"\" part=\"0\" file=\"grains_1.vtp\"/>\n"
                     "</Collection>\n</VTKFile>\n") != std::string::npos);
  CHECK(content.find("grains_0.vtp") < content.find("grains_1.vtp"));
  CHECK(series.frames() == 2);
}

TEST_CASE("vtk: a resumed series drops later frames and goes on as if never stopped") {
  const Folder folder;
  {
    silt::VtkSeries series(folder.path, "grains");
    for (int k = 0; k < 5; ++k) series.add(0.1 * k, silt::text("grains_", k, ".vtp"));
  }
  const auto whole = silt::detail::read_file(folder / "grains.pvd");
  auto series = silt::VtkSeries::resume(folder.path, "grains", 0.1 * 2);
  CHECK(series.frames() == 3);
  CHECK(silt::detail::read_file(folder / "grains.pvd").find("grains_3") == std::string::npos);
  for (int k = 2; k < 5; ++k) series.add(0.1 * k, silt::text("grains_", k, ".vtp"));
  CHECK(silt::detail::read_file(folder / "grains.pvd") == whole);
  CHECK(silt::VtkSeries::resume(folder.path, "new", 1).frames() == 0);
}

TEST_CASE("vtk: a series refuses backward times, unusable names and foreign lists") {
  const Folder folder;
  silt::VtkSeries series(folder.path, "grains");
  series.add(0.2, "a.vtp");
  CHECK_THROWS_WITH_AS(series.add(0.1, "b.vtp"),
                       doctest::Contains("time = 0.1 [s] must not be before the last frame's, 0.2"),
                       silt::InputError);
  CHECK_THROWS_WITH_AS(series.add(NAN, "b.vtp"), doctest::Contains("finite"), silt::InputError);
  CHECK_THROWS_WITH_AS(series.add(1, "b\".vtp"), doctest::Contains("'b\".vtp'"), silt::InputError);
  CHECK_THROWS_WITH_AS(silt::VtkSeries(folder.path, ""), doctest::Contains("empty"),
                       silt::InputError);
  write_text(folder / "file", "");
  CHECK_THROWS_WITH_AS(silt::VtkSeries(folder / "file", "grains"), doctest::Contains("is a file"),
                       silt::FileError);
  const auto good = silt::detail::read_file(series.path());
  const auto timed = [&](const std::string& time) {  // a frame more, before the others
    auto other = good;
    const std::string frame =
        "<DataSet timestep=\"" + time + "\" group=\"\" part=\"0\" file=\"a\"/>\n";
    return other.insert(other.find("<DataSet"), frame);
  };
  for (const auto& foreign :
       {std::string("<xml/>"), good.substr(0, good.size() - 5), good + "x", std::string("\n"),
        timed("nan"), timed("-inf"), timed("inf"), timed("0.3")}) {
    write_text(series.path(), foreign);
    CHECK_THROWS_WITH_AS(silt::VtkSeries::resume(folder.path, "grains", 1),
                         doctest::Contains("grains.pvd' is not as silt writes it"),
                         silt::FileError);
    CHECK(silt::detail::read_file(series.path()) == foreign);
  }
}

// What a power failure leaves of a file that was not flushed to the disk is no reason to refuse a run
// that goes on.
TEST_CASE("vtk: a list that is an empty file begins anew") {
  const Folder folder;
  write_text(folder / "grains.pvd", "");
  auto series = silt::VtkSeries::resume(folder.path, "grains", 1);
  CHECK(series.frames() == 0);
  series.add(2, "a.vtp");
  CHECK(silt::VtkSeries::resume(folder.path, "grains", 3).frames() == 1);
}

TEST_CASE("vtk: a frame at the time of the last one takes its place") {
  const Folder folder;
  silt::VtkSeries series(folder.path, "grains"), other(folder.path, "others");
  series.add(0.1, "a.vtp"), series.add(0.2, "a_long_name.vtp"), series.add(0.2, "b.vtp");
  other.add(0.1, "a.vtp"), other.add(0.2, "b.vtp");
  CHECK(series.frames() == 2);
  CHECK(silt::detail::read_file(series.path()) == silt::detail::read_file(other.path()));
}

TEST_CASE("vtk: a full disk is a FileError that names the file, which is not there") {
  if (!fs::exists("/dev/full")) return;
  const Folder folder;
  const std::string path = folder / "lines.vtp";
  const std::vector<std::array<float, 3>> ends(100'000);
  for (const std::size_t count : {std::size_t{2}, ends.size()}) {  // in the buffer, and beyond it
    fs::create_symlink("/dev/full", path + ".partial");
    CHECK_THROWS_WITH_AS(silt::write_vtp_lines(path, std::span(ends).first(count)),
                         doctest::Contains("lines.vtp' cannot be written: No space left on device"),
                         silt::FileError);
    CHECK_FALSE(fs::exists(path));
    CHECK_FALSE(fs::is_symlink(path + ".partial"));
  }
}

}  // namespace vtk_test
