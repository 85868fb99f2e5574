// silt - BSD-3-Clause, see LICENSE
#include <silt/boundary/stl.hpp>

#include <clocale>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "support.hpp"

namespace stl_test {

using namespace boundary_test;
using silt::FileError;
using silt::InputError;
using silt::StlFormat;

namespace {

/// A folder that is gone with the test.
struct Folder {
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "silt_stl_XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string file(const std::string& name) const { return (path / name).string(); }
  std::string with(const std::string& name, const std::string& bytes) const {
    std::ofstream(file(name), std::ios::binary) << bytes;
    return file(name);
  }
  std::filesystem::path path;
};

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

const std::string facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1.5 0\n endloop\n"
    "endfacet\n";
const std::array<Vec3d, 3> facet_corners{Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1.5, 0}};

}  // namespace

TEST_CASE("stl: ASCII round trip keeps every digit") {
  const Folder folder;
  std::mt19937_64 random(1);
  Soup soup;
  for (int n = 0; n < 50; ++n) {
    const double size = std::pow(10, uniform(random, -12, 12));
    soup.push_back({random_point(random, -size, size), random_point(random, -size, size),
                    random_point(random, -size, size)});
  }
  silt::write_stl(folder.file("a.stl"), soup, StlFormat::Ascii);
  CHECK(content(folder.file("a.stl")).starts_with("solid"));
  CHECK(silt::read_stl(folder.file("a.stl")) == soup);
}

TEST_CASE("stl: binary round trip equals rounding to float; sizes and bytes are as specified") {
  const Folder folder;
  std::mt19937_64 random(2);
  Soup soup;
  for (int n = 0; n < 50; ++n)
    soup.push_back(
        {random_point(random, -1, 1), random_point(random, -1, 1), random_point(random, -1, 1)});
  silt::write_stl(folder.file("b.stl"), soup);
  const auto bytes = content(folder.file("b.stl"));
  CHECK(bytes.size() == 84 + 50 * 50);
  CHECK(!bytes.starts_with("solid"));
  CHECK(bytes.substr(80, 4) == std::string("\x32\0\0\0", 4));
  const auto back = silt::read_stl(folder.file("b.stl"));
  REQUIRE(back.size() == soup.size());
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = soup[t][k];
      CHECK(back[t][k] ==
            Vec3d{rounded_to_float(p.x), rounded_to_float(p.y), rounded_to_float(p.z)});
    }
  // Known bytes: 1.0f = 00 00 80 3f, after the normal (0, 0, 1) and the first corner.
  silt::write_stl(folder.file("one.stl"), {facet_corners});
  const auto one = content(folder.file("one.stl"));
  CHECK(one.substr(84 + 8, 4) == std::string("\0\0\x80\x3f", 4));
  CHECK(one.substr(84 + 24, 4) == std::string("\0\0\x80\x3f", 4));
}

TEST_CASE("stl: a binary file whose header begins with 'solid' is read as binary") {
  const Folder folder;
  silt::write_stl(folder.file("b.stl"), {facet_corners});
  auto bytes = content(folder.file("b.stl"));
  bytes.replace(0, 12, "solid  facet");
  CHECK(silt::read_stl(folder.with("s.stl", bytes)) == Soup{facet_corners});
  refuses<FileError>([&] { silt::read_stl(folder.with("t.stl", bytes.substr(0, 120))); },
                     "announces 1 triangles, that is 134 bytes, but has 120 bytes");
}

TEST_CASE(
    "stl: ASCII in capitals, with plus signs, several solids, CR LF and odd normals is read") {
  const Folder folder;
  const std::string text =
      "SOLID top facet\r\n  FACET NORMAL nan nan nan\r\nOUTER LOOP\r\nVERTEX +0 0.0 0e0\r\n"
      "VERTEX 1E+0 0 -0\r\nvertex 0 15e-1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID top facet\r\n"
      "solid\n" +
      facet + "endsolid";
  const auto soup = silt::read_stl(folder.with("a.stl", text));
  CHECK(soup == Soup{facet_corners, facet_corners});
}

TEST_CASE("stl: a facet on the line of its solid's name is read; so are lines that end in CR") {
  const Folder folder;
  std::string one_line = "solid a b " + facet + facet + "endsolid a b\n";
  CHECK(silt::read_stl(folder.with("a.stl", one_line)) == Soup{facet_corners, facet_corners});
  std::string all_one_line = one_line;
  for (char& c : all_one_line)
    if (c == '\n') c = ' ';
  CHECK(silt::read_stl(folder.with("b.stl", all_one_line)) == Soup{facet_corners, facet_corners});
  for (char& c : one_line)
    if (c == '\n') c = '\r';
  CHECK(silt::read_stl(folder.with("c.stl", one_line)) == Soup{facet_corners, facet_corners});
  // What follows the last name on its line is not lost unseen either.
  const auto lost = folder.with("d.stl", "solid a\n" + facet + "endsolid a " + facet);
  refuses<FileError>([&] { silt::read_stl(lost); }, "line 9: expected 'solid', found 'facet'");
}

TEST_CASE("stl: a byte-order mark is skipped; what a sentence shows of a file is short and plain") {
  const Folder folder;
  const auto path = folder.with("a.stl", "\xEF\xBB\xBFsolid a\n" + facet + "endsolid a\n");
  CHECK(silt::read_stl(path) == Soup{facet_corners});
  const std::string word = "\x1b[31m" + std::string(1 << 20, 'x');
  refuses<FileError>([&] { silt::read_stl(folder.with("b.stl", "solid a\n" + word + "\n")); },
                     "line 2: expected 'facet' or 'endsolid', found '\\x1b[31m" +
                         std::string(55, 'x') + "'... (1048581 bytes)");
}

TEST_CASE("stl: scale multiplies the corners") {
  const Folder folder;
  const auto path = folder.with("a.stl", "solid mm\n" + facet + "endsolid mm\n");
  const auto soup = silt::read_stl(path, 1e-3);
  CHECK(soup[0][2] == Vec3d{0, 1.5 * 1e-3, 0});
  for (const double scale : {0.0, -1.0, not_a_number, infinity})
    refuses<InputError>([&] { silt::read_stl(path, scale); }, "read_stl: scale = ");
}

TEST_CASE("stl: numbers do not depend on the C locale") {
  const Folder folder;
  const auto path = folder.with("a.stl", "solid a\n" + facet + "endsolid a\n");
  // Where no locale with a decimal comma is installed, this checks no more than a round trip.
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"})
    if (std::setlocale(LC_ALL, name)) break;
  CHECK(silt::read_stl(path)[0][2].y == 1.5);
  silt::write_stl(folder.file("b.stl"), {facet_corners}, StlFormat::Ascii);
  std::setlocale(LC_ALL, "C");
  CHECK(content(folder.file("b.stl")).find("vertex 0 1.5 0") != std::string::npos);
}

TEST_CASE("stl: files that hold nothing are refused, by name") {
  const Folder folder;
  refuses<FileError>([&] { silt::read_stl(folder.file("none.stl")); },
                     "none.stl' cannot be opened for reading: No such file");
  refuses<FileError>([&] { silt::read_stl(folder.path.string()); },
                     "cannot be read: Is a directory");
  refuses<FileError>([&] { silt::read_stl(folder.with("e.stl", "")); }, "e.stl is empty");
  refuses<FileError>([&] { silt::read_stl(folder.with("z.stl", "solid z\nendsolid z\n")); },
                     "z.stl has no triangles");
  refuses<FileError>([&] { silt::read_stl(folder.with("z.stl", std::string(84, '\0'))); },
                     "z.stl has no triangles");
}

TEST_CASE("stl: truncated and foreign binary files are refused with the bytes expected and found") {
  const Folder folder;
  silt::write_stl(folder.file("b.stl"), Soup(3, facet_corners));
  const auto bytes = content(folder.file("b.stl"));
  refuses<FileError>(
      [&] { silt::read_stl(folder.with("t.stl", bytes.substr(0, 200))); },
      "announces 3 triangles, that is 234 bytes, but has 200 bytes; it is truncated");
  refuses<FileError>([&] { silt::read_stl(folder.with("l.stl", bytes + "more")); },
                     "that is 234 bytes, but has 238 bytes; it is not an STL file");
  refuses<FileError>([&] { silt::read_stl(folder.with("h.stl", std::string("a\0b", 3))); },
                     "is not text and has 3 bytes");
}

TEST_CASE("stl: a text file with a zero byte, and text that is no STL, are refused") {
  const Folder folder;
  auto text = "solid a\n" + facet + "endsolid a\n";
  text[20] = '\0';
  refuses<FileError>([&] { silt::read_stl(folder.with("a.stl", text)); },
                     "is binary and announces");
  refuses<FileError>([&] { silt::read_stl(folder.with("b.stl", "binary STL, really\n" + facet)); },
                     "line 1: expected 'solid', found 'binary'");
}

TEST_CASE("stl: a syntax error in ASCII names the line, what was expected and what was found") {
  const Folder folder;
  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& words) {
    auto text = "solid a\n" + facet + facet + "endsolid a\n";
    const auto at = text.rfind(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    refuses<FileError>([&] { silt::read_stl(folder.with("a.stl", text)); }, words);
  };
  refused("vertex 1", "vertx 1", "a.stl, line 12: expected 'vertex', found 'vertx'");
  refused("1.5", "1,5", "line 13: expected a number, found '1,5'");
  refused("1.5", "abc", "line 13: expected a number, found 'abc'");
  refused("1.5", "1e999", "line 13: the number '1e999' is too large or too small");
  refused("1.5 0\n", "1.5\n", "line 14: expected a number, found 'endloop'");
  refused(" endloop", " vertex 0 0 0", "line 14: expected 'endloop', found 'vertex'");
  refused("endfacet", "", "line 16: expected 'endfacet', found 'endsolid'");
  refused("outer loop", "outer lop", "line 10: expected 'loop', found 'lop'");
  refused("facet normal", "fact normal", "line 9: expected 'facet' or 'endsolid', found 'fact'");
  refused("endsolid a\n", "", "line 16: expected 'facet' or 'endsolid', found the end of the file");
  refused("endsolid a\n", "endsolid a\nfacet", "line 17: expected 'solid', found 'facet'");
  refused(" endloop\nendfacet\nendsolid a\n", "", "found the end of the file");
}

TEST_CASE("stl: coordinates that are not finite are refused with the triangle's number") {
  const Folder folder;
  for (const std::string bad : {"nan", "inf", "-inf"}) {
    auto text = "solid a\n" + facet + facet + "endsolid a\n";
    text.replace(text.rfind("1.5"), 3, bad);
    refuses<FileError>([&] { silt::read_stl(folder.with("a.stl", text)); },
                       "triangle 2 of 2 has the corner (0, " + bad + ", 0)");
  }
  silt::write_stl(folder.file("b.stl"), Soup(3, facet_corners));
  auto bytes = content(folder.file("b.stl"));
  bytes.replace(84 + 50 + 12, 4, "\0\0\x80\x7f", 4);  // +inf in the second triangle
  refuses<FileError>([&] { silt::read_stl(folder.with("b.stl", bytes)); },
                     "triangle 2 of 3 has the corner (inf, 0, 0)");
  const auto large = folder.with("c.stl", "solid\n" + facet + "endsolid");
  refuses<FileError>([&] { silt::read_stl(large, 1.7e308); }, "times scale = 1.7e+308");
}

TEST_CASE("stl: writing refuses what cannot be read back and leaves the old file as it was") {
  const Folder folder;
  const auto path = folder.with("a.stl", "old");
  refuses<InputError>([&] { silt::write_stl(path, {}); }, "write_stl: 0 triangles for ");
  for (const double bad : {not_a_number, infinity, 1e39}) {
    Soup soup(2, facet_corners);
    soup[1][2].z = bad;
    refuses<InputError>([&] { silt::write_stl(path, soup); }, "triangle 2 of 2");
  }
  CHECK(content(path) == "old");
  refuses<FileError>([&] { silt::write_stl(folder.file("no/such/a.stl"), {facet_corners}); },
                     "cannot be opened for writing: No such file");
  std::filesystem::create_directory(folder.path / "taken");
  refuses<FileError>([&] { silt::write_stl(folder.file("taken"), {facet_corners}); },
                     "taken' cannot be put in place");
  CHECK(!std::filesystem::exists(folder.file("taken.part")));
  silt::write_stl(path, {facet_corners});
  CHECK(silt::read_stl(path) == Soup{facet_corners});
  CHECK(!std::filesystem::exists(path + ".part"));
}

}  // namespace stl_test
