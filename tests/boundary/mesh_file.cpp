// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/mesh_file.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include <silt/boundary/finite_walls.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/files/vtk.hpp>

#include "support.hpp"

namespace mesh_file_test {

using namespace boundary_test;
using silt::FileError;
using silt::InputError;
using silt::MeshFormat;
using silt::read_mesh;
using silt::TriangleMesh;

namespace {

/// A folder that is gone with the test.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("silt_mesh_file_" + std::to_string(std::random_device{}()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string file(const std::string& name) const { return (path / name).string(); }
  std::string with(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return file(name);
  }
};

/// Checks that reading `content` is refused with a sentence that holds the file's name and `words`.
void refused(const std::string& name, const std::string& content, const std::string& words) {
  const Folder folder;
  const auto path = folder.with(name, content);
  refuses<FileError>([&] { (void)read_mesh(path); }, words);
  refuses<FileError>([&] { (void)read_mesh(path); }, path);
}

/// The quadrilateral (0,0,0) (2,0,0) (2,1,0) (0,1,0) as a fan, and the triangle over its first
/// edge.
const Soup roof{{Vec3d{0, 0, 0}, Vec3d{2, 0, 0}, Vec3d{2, 1, 0}},
                {Vec3d{0, 0, 0}, Vec3d{2, 0, 0} + Vec3d{0, 1, 0}, Vec3d{0, 1, 0}},
                {Vec3d{0, 0, 0}, Vec3d{1, 0, 0.5}, Vec3d{2, 0, 0}}};

const std::string roof_obj =
    "# a roof\nmtllib roof.mtl\no roof\nv 0 0 0\nv +2 0 0 1.0\nvt 0 0\nvn 0 0 1\nv 2 1 0\nv 0 1 "
    "0\nusemtl red\nf 1/1/1 2/1/1 3//1 4\nv 1 0 5e-1\nf -5 -1 \\\n -4\n";

const std::string ply_head =
    "ply\nformat ascii 1.0\ncomment a roof\nelement vertex 5\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 2\nproperty list uchar int "
    "vertex_indices\nelement edge 1\nproperty list uchar float weights\nend_header\n";
const std::string ply_body =
    "0 0 0 255\n2 0 0 255\n2 1 0 0\n0 1 0 0\n1 0 0.5 9\n4 0 1 2 3\n3 0 4 1\n2 0.5 0.5\n";

std::string bytes(double x) {
  const auto f = static_cast<float>(x);
  return {reinterpret_cast<const char*>(&f), sizeof f};
}
std::string bytes(std::int32_t n) { return {reinterpret_cast<const char*>(&n), sizeof n}; }

std::string binary_ply() {
  std::string out = ply_head;
  out.replace(out.find("ascii"), 5, "binary_little_endian");
  for (const Vec3d& p :
       {Vec3d{0, 0, 0}, Vec3d{2, 0, 0}, Vec3d{2, 1, 0}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0.5}})
    out += bytes(p.x) + bytes(p.y) + bytes(p.z) + '\xff';
  out += '\4' + bytes(0) + bytes(1) + bytes(2) + bytes(3);
  out += '\3' + bytes(0) + bytes(4) + bytes(1);
  return out + '\2' + bytes(0.5) + bytes(0.5);
}

const std::string roof_vtp =
    "<?xml version=\"1.0\"?>\n<VTKFile type='PolyData' version=\"0.1\">\n<!-- <Piece> -->\n"
    "<PolyData>\n<Piece NumberOfPoints=\"5\" NumberOfVerts=\"0\" NumberOfPolys=\"2\">\n"
    "<PointData><DataArray type=\"Float32\" Name=\"heat\" format=\"ascii\">1 2 3 4 5</DataArray>\n"
    "</PointData>\n<Points>\n<DataArray type=\"Float32\" NumberOfComponents=\"3\" "
    "format=\"ascii\">\n0 0 0 2 0 0\n2 1 0 0 1 0 1 0 0.5\n</DataArray>\n</Points>\n<Polys>\n"
    "<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 0 4 1</DataArray>\n"
    "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">4 7</DataArray>\n</Polys>\n"
    "</Piece>\n</PolyData>\n</VTKFile>\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("mesh_file: OBJ, PLY of both kinds and VTP give the triangles of the same roof") {
  const Folder folder;
  CHECK(read_mesh(folder.with("roof.obj", roof_obj)) == roof);
  CHECK(read_mesh(folder.with("roof.OBJ", replaced(roof_obj, "\\\n", "\\\r\n"))) == roof);
  CHECK(read_mesh(folder.with("roof.ply", ply_head + ply_body)) == roof);
  CHECK(read_mesh(folder.with("binary.ply", binary_ply())) == roof);
  CHECK(read_mesh(folder.with("roof.vtp", roof_vtp)) == roof);
}

TEST_CASE("mesh_file: the content decides before the name, and the caller before both") {
  const Folder folder;
  CHECK(read_mesh(folder.with("a", ply_head + ply_body)) == roof);
  CHECK(read_mesh(folder.with("b.txt", roof_vtp)) == roof);
  CHECK(read_mesh(folder.with("c.dat", roof_obj), 1, MeshFormat::Obj) == roof);
  silt::write_stl(folder.file("d.obj"), roof);
  CHECK(read_mesh(folder.file("d.obj")) == roof);
  silt::write_stl(folder.file("e"), roof, silt::StlFormat::Ascii);
  CHECK(read_mesh(folder.file("e")) == roof);
  refuses<FileError>([&] { (void)read_mesh(folder.with("f.dat", roof_obj)); },
                     "is not a mesh format known by its content or its name");
  refuses<FileError>([&] { (void)read_mesh(folder.file("none.obj")); }, "No such file");
}

TEST_CASE("mesh_file: scale multiplies corners; one that is not positive is refused") {
  const Folder folder;
  const auto path = folder.with("roof.obj", roof_obj);
  CHECK(read_mesh(path, 1e-3)[2][1] == Vec3d{1e-3, 0, 0.5e-3});
  for (const double bad : {0.0, -1.0, not_a_number, infinity})
    refuses<InputError>([&] { (void)read_mesh(path, bad); }, "read_mesh: scale = ");
}

TEST_CASE("mesh_file: a mesh written as STL is read back, binary to float and text to all digits") {
  const Folder folder;
  const TriangleMesh ball = silt::sphere_mesh({0.1, 0.2, 0.3}, 0.07);
  silt::write_stl(folder.file("a.stl"), ball, silt::StlFormat::Ascii);
  CHECK(read_mesh(folder.file("a.stl")) == silt::corners_of(ball));
  silt::write_stl(folder.file("b.stl"), ball);
  const TriangleMesh back(read_mesh(folder.file("b.stl")));
  REQUIRE(back.is_closed());
  // Corners are rounded by 6e-8 of 0.4 m, a volume by three such of 0.07 m.
  CHECK(back.volume() == doctest::Approx(ball.volume()).epsilon(1e-6));
}

TEST_CASE("mesh_file: what silt writes for ParaView is read back bit for bit") {
  const Folder folder;
  const TriangleMesh ball = silt::sphere_mesh({0, 0, 0}, 0.07);
  const std::vector<double> heat(ball.vertices().size(), 300);
  silt::VtkFields fields;
  fields.add("temperature [K]", heat);
  silt::write_vtp_triangles(folder.file("ball.vtp"), ball.vertices(), ball.triangles(), fields);
  CHECK(read_mesh(folder.file("ball.vtp")) == silt::corners_of(ball));
}

TEST_CASE("mesh_file: all pieces of a VTP file are read, and those without polygons skipped") {
  const Folder folder;
  const auto begin = roof_vtp.find("<Piece N"), end = roof_vtp.find("</Piece>") + 8;
  const auto piece = roof_vtp.substr(begin, end - begin);
  const std::string none = "<Piece NumberOfPoints=\"0\" NumberOfPolys=\"0\"></Piece>\n";
  auto twice = roof;
  twice.insert(twice.end(), roof.begin(), roof.end());
  CHECK(read_mesh(folder.with("a.vtp", replaced(roof_vtp, piece, piece + none + piece))) == twice);
}

TEST_CASE("mesh_file: mesh_wall makes a wall of each kind of file") {
  const Folder folder;
  const auto wall = silt::mesh_wall(folder.with("roof.ply", binary_ply()), 1e-3);
  REQUIRE(wall.parts.size() == 1);
  const auto& mesh = *std::get<std::shared_ptr<const TriangleMesh>>(wall.parts[0]);
  CHECK(mesh.triangles().size() == 3);
  CHECK(mesh.area() == doctest::Approx(2.5e-6).epsilon(1e-12));  // [m2] 2 + 0.5 in mm2
}

TEST_CASE(
    "mesh_file: a concave polygon is refused, a bent one and one with a flat corner are not") {
  refused("a.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 3 1 0\nf 1 2 3 4\nf 2 3 4 1\n",
          "line 5: the face is a concave polygon of 4 corners; let the program that wrote it");
  const Folder folder;
  CHECK(read_mesh(folder.with("b.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nf 1 2 3 4\n")).size() ==
        2);
  CHECK(read_mesh(folder.with("c.obj", "v 0 0 0\nv 2 0 0\nv 2 2 1\nv 0 2 0\nf 1 2 3 4\n")).size() ==
        2);
}

TEST_CASE("mesh_file: a bad OBJ file is refused with line and reason") {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  refused("a.obj", points, "has no faces; a surface needs triangles or polygons");
  refused("a.obj", "", "has no faces");
  refused("a.obj", points + "f 1 2 4\n",
          "line 4: the face's corner '4' names a point that does not "
          "exist; 3 precede this line");
  refused("a.obj", points + "f -4 2 3\n", "line 4: the face's corner '-4' names a point");
  refused("a.obj", points + "f 1 2 0\n", "'0' names no point; they count from 1, or back from -1");
  refused("a.obj", points + "f 1 2 x/1\n", "line 4: the face's corner 'x/1' names no point");
  refused("a.obj", points + "\nf 1 2\n", "line 5: the face has 2 corners; a face needs at least 3");
  refused("a.obj", "v 0 0\n" + points + "f 1 2 3\n", "line 1: z is missing");
  refused("a.obj", "v 0 0 1,5\n" + points, "line 1: z: '1,5' is not a number");
  refused("a.obj", "v 0 nan 0\n" + points, "line 1: y: 'nan' is not finite");
  refused("a.obj", points + "surf 0 1 0 1 1 2 3\n",
          "line 4: 'surf' is not a statement of a polygon mesh");
  refused("a.obj", std::string("v 0 0 0\0", 8), "is not text: it has zero bytes");
  const Folder folder;
  const auto large = folder.with("b.obj", "v 0 0 0\nv 10 0 0\nv 0 1 0\nf 1 2 3\n");
  refuses<FileError>([&] { (void)read_mesh(large, 1e308); }, "line 4: the face has the corner");
}

TEST_CASE("mesh_file: a bad PLY file is refused with line or element, and reason") {
  const auto bad = [](const std::string& from, const std::string& to, const std::string& words) {
    refused("a.ply", replaced(ply_head + ply_body, from, to), words);
  };
  bad("ply\n", "plx\n", "line 1: expected 'ply', found 'plx'");
  bad("ascii", "binary_big_endian", "line 2: format binary_big_endian is not read; save as");
  bad("ascii", "text", "line 2: format 'text' is unknown");
  bad("format ascii 1.0\n", "", "the header has no line 'format ascii 1.0'");
  bad("comment", "remark", "line 3: expected 'format', 'element', 'property' or 'end_header'");
  bad("vertex 5", "vertex five", "line 4: number of elements: 'five' is not a whole number");
  bad("vertex 5", "vertex 5000000000", "line 4: announces 5000000000 elements 'vertex', but only");
  bad("element vertex 5", "element point 5", "no element 'vertex' with the properties x, y and z");
  bad("element vertex 5\n", "", "line 4: a property precedes the first element");
  bad("float x", "half x", "line 5: type 'half' is unknown; PLY has char");
  bad("float y", "float x", "line 6: property 'x' of element 'vertex' is named twice");
  bad("element face", "element vertex", "line 9: element 'vertex' is named twice");
  bad("uchar int vertex", "float int vertex", "line 10: the length of a list must be an integer");
  bad("int vertex_indices", "float vertex_indices",
      "line 10: numbers of vertices must be integers");
  bad("vertex_indices", "neighbours", "a point cloud is not a surface");
  bad("end_header\n", "", "expected 'format', 'element', 'property' or 'end_header', found '0'");
  bad("2 1 0 0\n", "2 1 0\n", "line 16: a value of element 'vertex' is missing");
  bad("2 1 0 0\n", "2 1 0 0 7\n", "line 16: more values than element 'vertex' has properties");
  bad("2 1 0 0\n", "2 l 0 0\n", "line 16: a value of element 'vertex': 'l' is not a number");
  bad("3 0 4 1", "3 0 4 5",
      "line 20: the face names point 6, but there are only 5, counted from 1");
  bad("3 0 4 1", "3 0 4 -1", "line 20: vertex_indices has -1; numbers of vertices count from 0");
  bad("3 0 4 1", "2 0 4", "line 20: the face has 2 corners");
  bad("3 0 4 1", "-3 0 4 1", "line 20: a list has -3 entries; the file is damaged");
  bad("3 0 4 1\n2 0.5 0.5\n", "", "ends after line 19, where element 'face' 2 of 2 must follow");
  bad("0 0 0 255", "0 1e999 0 255", "line 14: a value of element 'vertex': '1e999' is outside");
  refused("b.ply", "ply\nformat ascii 1.0\n", "ends after line 2, where 'end_header' must follow");
  const auto whole = binary_ply();
  refused("b.ply", whole.substr(0, whole.size() - 12),
          "element 'face' 2 of 2: the file ends after");
  auto wild = whole;
  std::memcpy(&wild[wild.find("end_header") + 11 + 4], "\0\0\x80\x7f", 4);  // +inf
  refused("b.ply", wild, "face 1 of 2 has the corner (0, inf, 0)");
}

TEST_CASE("mesh_file: a bad VTP file is refused with line and reason") {
  const auto bad = [](const std::string& from, const std::string& to, const std::string& words) {
    refused("a.vtp", replaced(roof_vtp, from, to), words);
  };
  bad("'PolyData'", "\"UnstructuredGrid\"",
      "line 2: type = 'UnstructuredGrid' of VTKFile is not a");
  bad("version=\"0.1\"", "compressor=\"vtkZLibDataCompressor\"",
      "line 2: the arrays are compressed");
  bad("version=\"0.1\"", "byte_order=\"BigEndian\"",
      "line 2: byte_order = 'BigEndian' is not read");
  bad("version=\"0.1\"", "header_type=\"UInt16\"",
      "header_type = 'UInt16' must be UInt32 or UInt64");
  bad("'PolyData'", "'PolyData", "line 2: attribute type has no closing quote");
  bad("NumberOfPolys=\"2\"", "", "line 5: the element Piece has no attribute NumberOfPolys");
  bad("NumberOfPolys=\"2\"", "NumberOfPolys=\"-2\"", "NumberOfPolys = '-2' is not a whole number");
  bad("NumberOfPolys=\"2\"", "NumberOfPolys=\"3\"", "array 'offsets': 2 entries for 3 polygons");
  bad("NumberOfPoints=\"5\"", "NumberOfPoints=\"6\"",
      "array 'Points': 15 numbers are not three for each of 6 points");
  bad("NumberOfVerts=\"0\"", "NumberOfStrips=\"1\"", "line 5: the piece has triangle strips");
  bad("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"", "the points have '2' components");
  bad("0 1 2 3 0 4 1", "0 1 2 3 0 5 1", "'connectivity': names point 5, but there are only 5");
  bad("0 1 2 3 0 4 1", "0 1 2 3 0 4", "'offsets': has 7 after 4; offsets ascend to at most 6");
  bad(">4 7<", ">4 6<", "'offsets': ends at 6, but connectivity has 7 entries");
  bad(">4 7<", ">4 x<", "array 'offsets': 'x' is not a number");
  bad("\"offsets\"", "\"ends\"", "no arrays connectivity and offsets in the element Polys");
  bad("<Points>", "<Places>", "the piece has no Points");
  bad("Int32", "Word", "type = 'Word' of an array is unknown; VTK has Int8");
  bad("\"connectivity\" format=\"ascii\"", "\"connectivity\" format=\"binary\"",
      "format = 'binary' of array 'connectivity' is not read; save as ascii or appended");
  bad("\"connectivity\" format=\"ascii\"", "\"connectivity\" format=\"appended\" offset=\"0\"",
      "is appended, but there is no AppendedData with encoding=\"raw\"");
  bad(">\n</VTKFile>", "", "line 19: the element has no end '>'; the file is cut short");
  refused("a.vtp", "<?xml version=\"1.0\"?>\n<other/>\n", "has no element VTKFile");
  const Folder folder;
  silt::write_vtp_triangles(folder.file("b.vtp"), silt::sphere_mesh({0, 0, 0}, 1).vertices(),
                            silt::sphere_mesh({0, 0, 0}, 1).triangles());
  std::ifstream in(folder.file("b.vtp"), std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(in), {});
  refused("c.vtp", whole.substr(0, whole.size() - 200), "bytes by its header, in which only");
  refused("c.vtp", whole.substr(0, whole.find("raw\">") + 5), "AppendedData has no mark '_'");
  refused("c.vtp", whole.substr(0, whole.find("raw\">\n_") + 7), "begins at byte 0 of 0 that are");
}

}  // namespace mesh_file_test
