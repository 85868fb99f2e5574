// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>

#include <silt/files/csv_table.hpp>

namespace csv_table_test {

namespace {

namespace fs = std::filesystem;

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_csv_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

const std::vector<std::string> columns{"time [s]", "energy [J]"};

void write_text(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

std::string content_of(const std::string& path) { return silt::detail::read_file(path); }

}  // namespace

TEST_CASE("csv_table: numbers are the shortest that read back exactly") {
  const Folder folder;
  const std::string path = folder / "a.csv";
  silt::CsvTable table(path, columns);
  CHECK(content_of(path) == "time [s],energy [J]\n");
  const double third = 1.0 / 3, tiny = std::numeric_limits<double>::denorm_min();
  table.add_row({0.1, third});
  table.add_row(std::vector<double>{tiny, -2e300});
  table.add_row({0, std::numeric_limits<double>::quiet_NaN()});
  const auto content = content_of(path);
  CHECK(content == "time [s],energy [J]\n0.1,0.3333333333333333\n5e-324,-2e+300\n0,nan\n");
  const auto at = content.find(",0.33") + 1;
  double back = 0;
  std::from_chars(content.data() + at, content.data() + content.size(), back);
  CHECK(back == third);
}

TEST_CASE("csv_table: a killed run keeps every row that was added") {
  const Folder folder;
  const std::string path = folder / "a.csv";
  const pid_t child = ::fork();
  if (child == 0) {
    silt::CsvTable table(path, columns);
    for (int k = 0; k < 1000; ++k) table.add_row({k * 0.5, 1});
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  const auto content = content_of(path);
  CHECK(std::count(content.begin(), content.end(), '\n') == 1001);
  CHECK(content.ends_with("499.5,1\n"));
}

TEST_CASE("csv_table: resume keeps rows up to the limit, goes on, and drops an incomplete row") {
  const Folder folder;
  const std::string path = folder / "a.csv";
  write_text(path, "time [s],energy [J]\n0,1\n0.5,2\n1,3\n1.5,4\n2,");
  {
    auto table = silt::CsvTable::resume(path, columns, 1);
    CHECK(content_of(path) == "time [s],energy [J]\n0,1\n0.5,2\n1,3\n");
    table.add_row({1.5, 5});
  }
  CHECK(content_of(path) == "time [s],energy [J]\n0,1\n0.5,2\n1,3\n1.5,5\n");
  silt::CsvTable::resume(folder / "new.csv", columns, 1).add_row({2, 2});
  CHECK(content_of(folder / "new.csv") == "time [s],energy [J]\n2,2\n");
}

TEST_CASE("csv_table: resume refuses other columns and damaged rows, and leaves the file alone") {
  const Folder folder;
  const std::string path = folder / "a.csv";
  const auto refused = [&](const std::string& content, const std::string& words) {
    write_text(path, content);
    CHECK_THROWS_WITH_AS(silt::CsvTable::resume(path, columns, 1), doctest::Contains(words.c_str()),
                         silt::FileError);
    CHECK_THROWS_WITH_AS(silt::CsvTable::resume(path, columns, 1), doctest::Contains(path.c_str()),
                         silt::FileError);
    CHECK(content_of(path) == content);
  };
  refused("time [s],power [W]\n0,1\n", "first line is 'time [s],power [W]', but the columns are");
  refused("", "first line is ''");
  refused("time [s],energy [J]\n0,1\n0.5\n1,1\n", "line 3 is not 2 numbers");
  refused("time [s],energy [J]\n0,1,2\n", "line 2 is not 2 numbers");
  refused("time [s],energy [J]\n0,1\n\n", "line 3 is not 2 numbers");
  refused("time [s],energy [J]\n0,x\n", "'0,x'");
  // Times tell which rows to keep: all of them must be ones.
  refused("time [s],energy [J]\n0,1\nnan,2\n", "line 3 begins with nan, which is not a time");
  refused("time [s],energy [J]\n-inf,1\n", "line 2 begins with -inf, which is not a time");
  refused("time [s],energy [J]\n0,1\ninf,2\n", "line 3 begins with inf, which is not a time");
  refused("time [s],energy [J]\n0,1\n0.5,2\n0.25,3\n",
          "line 4 begins with 0.25, less than the 0.5 of the line above");
  // What a sentence shows of a file is short and plain.
  refused("time [s],energy [J]\n0," + std::string(1 << 20, 'a') + "\n",
          "'0," + std::string(58, 'a') + "'... (1048578 bytes)");
  refused("time [s],energy [J]\n0,\x1b[31m\n", "'0,\\x1b[31m'");
  refused("\x1b]0;x\x07\n", "first line is '\\x1b]0;x\\x07'");
}

TEST_CASE("csv_table: a byte-order mark, as some editors put it, is dropped") {
  const Folder folder;
  write_text(folder / "a.csv", "\xEF\xBB\xBFtime [s],energy [J]\n0,1\n1,nan\n");
  silt::CsvTable::resume(folder / "a.csv", columns, 1);
  CHECK(content_of(folder / "a.csv") == "time [s],energy [J]\n0,1\n1,nan\n");
}

TEST_CASE("csv_table: unusable columns and rows of another length are refused") {
  const Folder folder;
  const std::string path = folder / "a.csv";
  const auto refused = [&](const std::vector<std::string>& names, const char* words) {
    CHECK_THROWS_WITH_AS(silt::CsvTable(path, names), doctest::Contains(words), silt::InputError);
  };
  refused({}, "no columns");
  refused({"a", ""}, "column 1 is empty");
  refused({"a,b"}, "'a,b'");
  refused({"a\nb"}, "'a\\nb' must not contain commas, quotes or control characters");
  refused({"\x1b[1ma"}, "'\\x1b[1ma'");
  refused({"a", "b", "a"}, "two columns named 'a'");
  CHECK_FALSE(fs::exists(path));
  silt::CsvTable table(path, columns);
  CHECK_THROWS_WITH_AS(table.add_row({1, 2, 3}),
                       doctest::Contains("a row of 3 numbers, but the table has 2 columns"),
                       silt::InputError);
  CHECK(content_of(path) == "time [s],energy [J]\n");
  // Its folder is made, unless something else has its name.
  silt::CsvTable(folder / "new/one/a.csv", columns).add_row({1, 2});
  CHECK(content_of(folder / "new/one/a.csv") == "time [s],energy [J]\n1,2\n");
  CHECK_THROWS_WITH_AS(silt::CsvTable(path + "/b.csv", columns), doctest::Contains(path.c_str()),
                       silt::FileError);
}

TEST_CASE("csv_table: a row that does not fit is a FileError with the reason, and leaves no half") {
  const Folder folder;
  const std::string path = folder / "a.csv";
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limits{40, 40};  // [bytes] the header, three rows and a bit
    ::setrlimit(RLIMIT_FSIZE, &limits);
    silt::CsvTable table(path, columns);
    int rows = 0;
    try {
      for (; rows < 10; ++rows) table.add_row({0.5, 1});
    } catch (const silt::FileError& error) {
      const std::string_view sentence = error.what();
      const bool named = sentence.find(path) != std::string_view::npos &&
                         sentence.find("File too large") != std::string_view::npos;
      ::_exit(named ? rows : 100);
    }
    ::_exit(101);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(WEXITSTATUS(status) == 3);  // 20 bytes of header, 6 a row: 3 fit into 40
  CHECK(content_of(path) == "time [s],energy [J]\n0.5,1\n0.5,1\n0.5,1\n");
}

}  // namespace csv_table_test
