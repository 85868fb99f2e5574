// silt - BSD-3-Clause, see LICENSE
// Also holds the tests of silt/files/atomic_file.hpp, which checkpoints are the main user of.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include <silt/files/checkpoint_file.hpp>

namespace checkpoint_file_test {

namespace {

namespace fs = std::filesystem;

/// A folder of this test's own, removed with all in it.
struct Folder {
  std::string path = (fs::temp_directory_path() / "silt_checkpoint_XXXXXX").string();
  Folder() { REQUIRE(::mkdtemp(path.data()) != nullptr); }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

void write_bytes(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// The sentence of the FileError (or else the empty string) that `action` throws.
template <class Action>
std::string refusal(Action&& action) {
  try {
    action();
  } catch (const silt::FileError& error) {
    return error.what();
  }
  return {};
}

bool has_words(const std::string& sentence, std::initializer_list<std::string> words) {
  for (const auto& word : words)
    if (sentence.find(word) == std::string::npos) {
      MESSAGE("'" << word << "' is missing in: " << sentence);
      return false;
    }
  return true;
}

/// Runs `action` in a child process; its exit status, or -1 if it was killed.
template <class Action>
int in_child(Action&& action) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(action());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

const std::vector<double> doubles{1.5, -0.0, 1e-310, std::numeric_limits<double>::infinity()};
const std::vector<std::uint8_t> bytes{1, 2, 255};

std::string small_checkpoint(const Folder& folder) {
  const std::string path = folder / "small.silt";
  silt::CheckpointWriter writer("Sphere Hertz");
  writer.add("position", doubles);
  writer.add("kind", bytes);
  writer.add_text("note", "a");
  writer.commit(path);
  return silt::detail::read_file(path);
}

template <class T>
void put(std::string& content, std::size_t at, T value) {
  std::memcpy(content.data() + at, &value, sizeof value);
}

/// Gives changed content a checksum that matches, as a forger would.
std::string with_checksum(std::string content) {
  silt::detail::Crc64 crc;
  crc.add(content.data(), content.size() - 8);
  put(content, content.size() - 8, crc.value());
  return content;
}

}  // namespace

TEST_CASE("atomic_file: nothing is seen before commit, all of it after") {
  const Folder folder;
  const std::string path = folder / "a.txt", big(3'000'000, 'x');
  write_bytes(path, "old");
  {
    silt::AtomicFile file(path);
    file.write("new ");
    file.write(big);  // longer than the buffer
    file.write(" end");
    CHECK(silt::detail::read_file(path) == "old");
    file.commit();
    CHECK(silt::detail::read_file(path) == "new " + big + " end");
    CHECK_THROWS_WITH_AS(file.write("x"), doctest::Contains("after commit"), silt::InputError);
    CHECK_THROWS_WITH_AS(file.commit(), doctest::Contains("a.txt"), silt::InputError);
  }
  { silt::AtomicFile(path).write("never committed"); }
  CHECK(silt::detail::read_file(path).size() == big.size() + 8);
  CHECK_FALSE(fs::exists(path + ".partial"));
}

TEST_CASE("atomic_file: a full disk is a FileError with path and reason; the old file stays") {
  if (!fs::exists("/dev/full")) return;
  const Folder folder;
  const std::string path = folder / "a.txt";
  write_bytes(path, "old");
  for (const silt::Flush flush : {silt::Flush::ToDisk, silt::Flush::Never})
    for (const std::size_t size :
         {std::size_t{10}, std::size_t{1'000'000}}) {  // in commit, in write
      fs::create_symlink("/dev/full", path + ".partial");
      const auto sentence = refusal([&] {
        silt::AtomicFile file(path, flush);
        file.write(std::string(size, 'x'));
        file.commit();
      });
      CHECK(has_words(sentence, {path, "cannot be written", "No space left on device"}));
      CHECK(silt::detail::read_file(path) == "old");
      CHECK_FALSE(fs::is_symlink(path + ".partial"));
    }
}

TEST_CASE("atomic_file: a write that fails at any byte leaves the old file and no partial one") {
  const Folder folder;
  const std::string path = folder / "a.txt", content(600'000, 'x');
  write_bytes(path, "old");
  for (const rlim_t limit : {0, 1, 262'144, 262'145, 599'999}) {
    const auto flush = limit % 2 ? silt::Flush::Never : silt::Flush::ToDisk;
    const int status = in_child([&] {
      ::signal(SIGXFSZ, SIG_IGN);
      const rlimit limits{limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &limits);
      const auto sentence = refusal([&] {
        silt::AtomicFile file(path, flush);
        file.write(std::string_view(content).substr(0, 100));
        file.write(std::string_view(content).substr(100));
        file.commit();
      });
      const bool named = has_words(sentence, {path, "File too large"});
      return named && !fs::exists(path + ".partial") ? 0 : 1;
    });
    CHECK(status == 0);
    CHECK(silt::detail::read_file(path) == "old");
  }
}

TEST_CASE("atomic_file: a folder that is missing or in the way is named") {
  const Folder folder;
  const auto missing = refusal([&] { silt::AtomicFile file(folder / "no/a.txt"); });
  CHECK(has_words(missing, {folder / "no/a.txt'", "No such file or directory"}));
  fs::create_directories(folder / "taken/inner");
  const auto in_the_way = refusal([&] { silt::AtomicFile(folder / "taken").commit(); });
  CHECK(has_words(in_the_way, {folder / "taken'", "cannot be put in place", "irectory"}));
  CHECK_FALSE(fs::exists(folder / "taken.partial"));
  CHECK(has_words(refusal([&] { silt::detail::read_file(folder.path); }), {"Is a directory"}));
}

// As the superuser, a name such as /dev/null was replaced by a file, for all programs.
TEST_CASE("atomic_file: a pipe or a device is refused, and stays what it is") {
  const Folder folder;
  const std::string pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(has_words(refusal([&] { silt::AtomicFile(pipe).commit(); }), {pipe + "'", "name a file"}));
  CHECK(fs::is_fifo(pipe));
  CHECK_FALSE(fs::exists(pipe + ".partial"));
}

TEST_CASE("make_folder: makes parents, accepts what is there, names a file in the way") {
  const Folder folder;
  silt::make_folder(folder / "a//b/c/");
  silt::make_folder(folder / "a/b/c");
  CHECK(fs::is_directory(folder / "a/b/c"));
  write_bytes(folder / "a/file", "");
  const auto in_the_way = refusal([&] { silt::make_folder(folder / "a/file/deep"); });
  CHECK(has_words(in_the_way, {folder / "a/file/deep'", folder / "a/file' is a file"}));
  CHECK(refusal([&] { silt::make_folder(folder / "a/file"); }).find("is a file") !=
        std::string::npos);
  CHECK(has_words(refusal([] { silt::make_folder("/proc/silt/x"); }), {"'/proc/silt':", "cannot"}));
  CHECK_THROWS_AS(silt::make_folder(""), silt::InputError);
}

TEST_CASE("checkpoint: every kind of field reads back bit for bit") {
  const Folder folder;
  const std::string path = folder / "all.silt";
  const std::vector<float> floats{0.1f, -3e38f};
  const std::vector<std::uint16_t> shorts{65535};
  const std::vector<std::uint32_t> words{1, 2, 3};
  const std::array<std::uint64_t, 2> longs{0, ~std::uint64_t{0}};
  const std::vector<std::int64_t> counts{std::numeric_limits<std::int64_t>::min()};
  std::vector<double> many(300'000);  // several blocks of the reader
  for (std::size_t k = 0; k < many.size(); ++k) many[k] = 1.0 / static_cast<double>(k + 1);
  silt::CheckpointWriter writer("signature");
  writer.add("double", doubles);
  writer.add("uint8", bytes);
  writer.add("float", floats);
  writer.add("uint16", shorts);
  writer.add("uint32", words);
  writer.add("uint64", longs);
  writer.add("int64", counts);
  writer.add("nothing", std::span<const double>{});
  writer.add("many", many);
  writer.add_text("json", std::string("{\"a\": 1}\0\n", 10));
  writer.commit(path);

  const silt::CheckpointReader reader(path);
  CHECK(reader.signature() == "signature");
  CHECK_NOTHROW(reader.require_signature("signature"));
  const auto same_bits = [](double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; };
  const auto back = reader.get<double>("double");
  CHECK(std::equal(back.begin(), back.end(), doubles.begin(), doubles.end(), same_bits));
  CHECK(reader.get<std::uint8_t>("uint8", 3) == bytes);
  CHECK(reader.get<float>("float") == floats);
  CHECK(reader.get<std::uint16_t>("uint16") == shorts);
  CHECK(reader.get<std::uint32_t>("uint32") == words);
  CHECK(reader.get<std::uint64_t>("uint64") == std::vector<std::uint64_t>{0, ~std::uint64_t{0}});
  CHECK(reader.get<std::int64_t>("int64") == counts);
  CHECK(reader.get<double>("nothing", 0).empty());
  CHECK(reader.get<double>("many") == many);
  CHECK(reader.text("json") == std::string("{\"a\": 1}\0\n", 10));
  CHECK(reader.has("many"));
  CHECK_FALSE(reader.has("few"));
}

TEST_CASE("checkpoint: the same content makes the same bytes") {
  const Folder folder;
  const auto first = small_checkpoint(folder);
  CHECK(first == small_checkpoint(folder));
  CHECK(first.size() % 8 == 0);
}

TEST_CASE("crc64: the check value of CRC-64/XZ, whole and in pieces of any length") {
  // Catalogue of parametrised CRC algorithms, CRC-64/XZ: check = 0x995dc9bbdf1939fa.
  silt::detail::Crc64 check;
  check.add("123456789", 9);
  CHECK(check.value() == 0x995dc9bbdf1939fau);
  std::string content(200, '\0');
  for (std::size_t k = 0; k < content.size(); ++k) content[k] = static_cast<char>(k * 37);
  silt::detail::Crc64 whole;
  whole.add(content.data(), content.size());
  for (std::size_t cut = 0; cut <= content.size(); ++cut) {
    silt::detail::Crc64 parts;
    parts.add(content.data(), cut);
    parts.add(content.data() + cut, content.size() - cut);
    CHECK(parts.value() == whole.value());
  }
}

TEST_CASE("checkpoint: writer refuses empty and repeated names") {
  silt::CheckpointWriter writer("s");
  writer.add("x", doubles);
  CHECK_THROWS_WITH_AS(writer.add("x", bytes), doctest::Contains("two fields named 'x'"),
                       silt::InputError);
  CHECK_THROWS_WITH_AS(writer.add_text("", "t"), doctest::Contains("name is empty"),
                       silt::InputError);
}

TEST_CASE("checkpoint: a missing field, another type, count or signature each has its sentence") {
  const Folder folder;
  small_checkpoint(folder);
  const std::string path = folder / "small.silt";
  const silt::CheckpointReader reader(path);
  CHECK(has_words(refusal([&] { reader.get<double>("velocity"); }),
                  {path, "no field 'velocity'", "'position', 'kind', 'note'"}));
  CHECK(has_words(refusal([&] { reader.get<float>("position"); }),
                  {path, "'position' as float64", "float32 is needed"}));
  CHECK(has_words(refusal([&] { reader.text("kind"); }), {"'kind' as uint8", "text is needed"}));
  CHECK(has_words(refusal([&] { reader.get<double>("position", 5); }),
                  {path, "4 values", "'position'", "5 are needed"}));
  CHECK(
      has_words(refusal([&] { reader.require_signature("Sphere Linear"); }),
                {path, "'Sphere Hertz'", "'Sphere Linear'", "character 8", "'Hertz'", "'Linear'"}));
  CHECK(has_words(refusal([&] { reader.require_signature("Sphere"); }), {"nothing more"}));
}

TEST_CASE("checkpoint: missing, empty, foreign, newer, swapped and damaged files have sentences") {
  const Folder folder;
  const std::string path = folder / "x.silt", good = small_checkpoint(folder);
  const auto sentence_for = [&](const std::string& content) {
    write_bytes(path, content);
    return refusal([&] { silt::CheckpointReader reader(path); });
  };
  CHECK(has_words(refusal([&] { silt::CheckpointReader reader(path); }),
                  {path, "No such file or directory"}));
  CHECK(has_words(sentence_for(""), {path, "is empty"}));
  CHECK(has_words(sentence_for("hello"), {path, "not a checkpoint of silt"}));
  CHECK(has_words(sentence_for(std::string(5000, 'z')), {path, "not a checkpoint of silt"}));
  CHECK(has_words(sentence_for(good.substr(0, 20)), {path, "truncated", "20 bytes"}));
  CHECK(has_words(sentence_for(good.substr(0, good.size() - 1)),
                  {path, "truncated", silt::text(good.size() - 1, " of ", good.size())}));
  CHECK(has_words(sentence_for(good + "x"), {path, "damaged", "was written with"}));
  auto changed = good;
  put(changed, 8, std::uint32_t{0x04030201});
  CHECK(has_words(sentence_for(with_checksum(changed)), {path, "other byte order"}));
  changed = good;
  put(changed, 12, std::uint32_t{3});
  CHECK(has_words(sentence_for(with_checksum(changed)),
                  {path, "version 3", "reads version 2", "newer"}));
  put(changed, 12, std::uint32_t{1});
  CHECK(has_words(sentence_for(with_checksum(changed)),
                  {path, "version 1", "the version of silt that wrote it"}));
  changed = good;
  changed[good.size() - 30] ^= 1;
  CHECK(has_words(sentence_for(changed), {path, "damaged", "checksum"}));
  CHECK(sentence_for(with_checksum(good)).empty());  // these tests' own tools change nothing else
}

TEST_CASE("checkpoint: every single flipped bit and every truncation is refused") {
  const Folder folder;
  const std::string path = folder / "x.silt", good = small_checkpoint(folder);
  std::size_t accepted = 0;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto content = good;
    content[bit / 8] = static_cast<char>(content[bit / 8] ^ (1 << (bit % 8)));
    write_bytes(path, content);
    accepted += refusal([&] { silt::CheckpointReader reader(path); }).empty();
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    write_bytes(path, good.substr(0, size));
    accepted += refusal([&] { silt::CheckpointReader reader(path); }).empty();
  }
  CHECK(accepted == 0);
}

TEST_CASE("checkpoint: hostile numbers under a matching checksum are refused, or read in bounds") {
  const Folder folder;
  const std::string path = folder / "x.silt", good = small_checkpoint(folder);
  // Each 8 bytes from the table's size on become large; a count or size of that kind must not be
  // believed; 2^61 + 4 doubles are as many bytes as 4 in 64 bits. What is still accepted (changed
  // values or names) must be readable.
  std::size_t refused = 0;
  for (std::size_t at = 16; at + 16 <= good.size(); ++at) {
    for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{1} << 40, ~std::uint64_t{0},
                                       (std::uint64_t{1} << 61) + 4}) {
      auto content = good;
      put(content, at, number);
      write_bytes(path, with_checksum(content));
      const auto sentence = refusal([&] {
        const silt::CheckpointReader reader(path);
        for (const char* name : {"position", "kind"})
          if (reader.has(name)) refusal([&] { reader.get<double>(name); });
      });
      refused += !sentence.empty();
      if (!sentence.empty()) CHECK(has_words(sentence, {path}));
    }
  }
  CHECK(refused > 100);
}

TEST_CASE("checkpoint: a writer killed at 20 random moments always leaves a complete state") {
  const Folder folder;
  const std::string path = folder / "run.silt";
  const auto write_state = [&](std::uint64_t state) {
    const std::vector<std::uint64_t> values(100'000, state);
    silt::CheckpointWriter writer("loop");
    writer.add("first", values);
    writer.add("second", values);
    writer.commit(path);
  };
  write_state(0);
  const auto states_written = [&] {
    return silt::CheckpointReader(path).get<std::uint64_t>("first", 100'000)[0];
  };
  std::mt19937 random(7);
  std::uint64_t last = 0;
  for (int kill = 0; kill < 20; ++kill) {
    const pid_t child = ::fork();
    if (child == 0)
      for (std::uint64_t state = last + 1;; ++state) write_state(state);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 40'000));
    // On a busy machine the first child may need longer to write anything.
    for (int wait = 0; kill == 0 && wait < 10'000 && states_written() == 0; ++wait)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const silt::CheckpointReader reader(path);
    const auto first = reader.get<std::uint64_t>("first", 100'000);
    CHECK(first == std::vector<std::uint64_t>(100'000, first[0]));
    CHECK(reader.get<std::uint64_t>("second") == first);
    CHECK(first[0] >= last);
    last = first[0];
  }
  CHECK(last > 0);  // the children did write
}

}  // namespace checkpoint_file_test
