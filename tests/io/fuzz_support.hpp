// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <silt/core/random.hpp>
#include <silt/files/checkpoint_file.hpp>

/// Mutated and forged files, the same ones in every run, and what every reader must do with them:
/// refuse them with a silt::Error whose sentence is short and printable, or take them and be
/// meaningful; never another exception, never for long, never in much memory. Memory errors are for
/// the sanitizers to see (cmake -DSILT_SANITIZE=address,undefined).
///
/// Inputs for each reader: 1000, or what the environment variable SILT_FUZZ says.
namespace fuzz {

inline int inputs() {
  const char* const given = std::getenv("SILT_FUZZ");
  return given != nullptr ? std::max(1, std::atoi(given)) : 1000;
}

/// A folder of this test's own, in memory if there is such a place: some readers write, and wait
/// for the disk.
struct Folder {
  std::string path;
  Folder() {
    const bool memory = ::access("/dev/shm", W_OK) == 0;
    path = (memory ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path()) /
           "silt_fuzz_XXXXXX";
    REQUIRE(::mkdtemp(path.data()) != nullptr);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

inline void write_bytes(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

/// One to four changes: flipped bits, other bytes, cut, repeated, moved, joined with another file,
/// words that numbers and names are not.
inline std::string mutated(const std::vector<std::string>& seeds, silt::Random& random) {
  static const std::string words[] = {"nan",
                                      "-inf",
                                      "inf",
                                      "1e999",
                                      "-1e-999",
                                      "4e-320",
                                      "-1",
                                      "0",
                                      "18446744073709551616",
                                      "1e308",
                                      "\x1b[31mred\x1b[0m",
                                      "\xEF\xBB\xBF",
                                      "\xFF\xFE",
                                      "\r",
                                      "\n",
                                      "\r\n",
                                      "\t",
                                      " ",
                                      ",",
                                      ";",
                                      "#",
                                      "\"",
                                      "'",
                                      "<",
                                      "facet",
                                      "facet normal",
                                      "vertex",
                                      "endsolid",
                                      "solid",
                                      "0x10",
                                      "1,5",
                                      "+1",
                                      "--1",
                                      "1e",
                                      std::string(1, '\0'),
                                      std::string(300, 'x'),
                                      std::string(300, '\x07')};
  const auto& seed = seeds[random.index(seeds.size())];
  std::string bytes = seed;
  const auto place = [&] { return random.index(bytes.size() + 1); };
  for (auto changes = 1 + random.index(4); changes > 0; --changes) {
    const std::size_t at = place(),
                      length = random.index(1 + std::min<std::size_t>(40, bytes.size() - at + 1));
    switch (random.index(10)) {
      case 0:
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.index(8)));
        break;
      case 2:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random.index(256));
        break;
      case 3:
        bytes.resize(at);
        break;
      case 4:
        bytes.erase(at, length);
        break;
      case 5:
        bytes.insert(place(), bytes.substr(at, 10 * length));
        break;
      case 6: {
        const auto& other = seeds[random.index(seeds.size())];
        bytes = bytes.substr(0, at) + other.substr(random.index(other.size() + 1));
        break;
      }
      case 7: {  // over what looks like a number
        const auto from = bytes.find_first_of("0123456789", at);
        if (from == std::string::npos) break;
        const auto to = std::min(bytes.find_first_not_of("0123456789.e-", from), bytes.size());
        bytes.replace(from, to - from, words[random.index(std::size(words))]);
        break;
      }
      case 8:
        bytes.insert(at, words[random.index(std::size(words))]);
        break;
      default:
        if (random.index(50) == 0) bytes.insert(at, std::string(1 << 20, 'a'));
        break;
    }
  }
  return bytes;
}

/// Short, one line, nothing that a terminal obeys.
inline bool is_printable(std::string_view sentence) {
  return !sentence.empty() && sentence.size() < 1500 &&
         std::none_of(sentence.begin(), sentence.end(),
                      [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; });
}

/// Counts what a reader makes of its inputs, and holds it to the rules above.
class Judge {
 public:
  explicit Judge(std::string reader) : reader_(std::move(reader)), rss_(peak()) {}
  ~Judge() {
    CHECK_MESSAGE(peak() - rss_ < most_memory, reader_, ": ", (peak() - rss_) / 1024, " MB");
    MESSAGE(reader_, ": ", refused_, " refused, ", taken_, " taken, longest ", longest_, " s");
  }

  /// read() returns whether what it has read is meaningful. Returns whether it was refused.
  template <class Read>
  bool operator()(std::uint64_t input, const Read& read) {
    const auto start = std::chrono::steady_clock::now();
    bool refused = false;
    try {
      const bool meaningful = read();
      CHECK_MESSAGE(meaningful, reader_, " took input ", input, ", which means nothing");
      ++taken_;
    } catch (const silt::Error& error) {
      CHECK_MESSAGE(is_printable(error.what()), reader_, ", input ", input, ": ",
                    std::string(error.what()).substr(0, 300));
      ++refused_, refused = true;
    } catch (const std::exception& error) {
      FAIL_CHECK(reader_, ", input ", input, ": a foreign exception: ", std::string(error.what()));
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    longest_ = std::max(longest_, took.count());
    // Two hundred times what it takes, for busy machines and sanitizers.
    CHECK_MESSAGE(took.count() < 20, reader_, ", input ", input, " took ", took.count(), " s");
    return refused;
  }
  int refused() const { return refused_; }
  int taken() const { return taken_; }

 private:
#if defined(__SANITIZE_ADDRESS__)
  static constexpr long most_memory = 2048 * 1024;  // [kB] what was freed is kept for a while
#else
  static constexpr long most_memory = 512 * 1024;  // [kB]
#endif
  static long peak() {  // [kB]
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  }
  std::string reader_;
  long rss_;
  int refused_ = 0, taken_ = 0;
  double longest_ = 0;  // [s]
};

/// A checkpoint taken apart, to be put together again otherwise, with a right checksum.
struct Parts {
  struct Field {
    std::string name;
    char kind;
    std::uint8_t size;
    std::string bytes;
    std::size_t count() const { return bytes.size() / size; }
  };
  std::string signature;
  std::vector<Field> fields;

  static Parts of(const std::string& file) {
    Parts p;
    std::size_t at = 32;
    const auto take = [&]<class T>(T value) {
      std::memcpy(&value, file.data() + at, sizeof value);
      at += sizeof value;
      return value;
    };
    const auto text = [&](std::size_t n) {
      at += n;
      return file.substr(at - n, n);
    };
    p.signature = text(take(std::uint64_t{}));
    std::vector<std::uint64_t> counts;
    for (auto n = take(std::uint64_t{}); n > 0; --n) {
      Field f;
      f.name = text(take(std::uint32_t{}));
      f.kind = take(char{}), f.size = take(std::uint8_t{});
      counts.push_back(take(std::uint64_t{}));
      p.fields.push_back(f);
    }
    at = silt::detail::padded_to_8(at);
    for (std::size_t k = 0; k < counts.size(); ++k) {
      p.fields[k].bytes = text(counts[k] * p.fields[k].size);
      at = silt::detail::padded_to_8(at);
    }
    return p;
  }

  std::string file() const {
    std::string table;
    const auto put = [&](std::string& out, auto value) { silt::detail::append_bytes(out, value); };
    put(table, std::uint64_t{signature.size()}), table += signature;
    put(table, std::uint64_t{fields.size()});
    for (const auto& f : fields) {
      put(table, static_cast<std::uint32_t>(f.name.size())), table += f.name;
      table += f.kind, put(table, f.size), put(table, std::uint64_t{f.count()});
    }
    const auto pad = [](std::string& out) { out.resize(silt::detail::padded_to_8(out.size())); };
    std::string body(silt::detail::padded_to_8(32 + table.size()) - 32, '\0');
    body.replace(0, table.size(), table);
    for (const auto& f : fields) body += f.bytes, pad(body);
    std::string out{silt::detail::checkpoint_magic};
    put(out, silt::detail::byte_order_mark), put(out, silt::detail::checkpoint_version);
    put(out, std::uint64_t{32 + body.size() + 8}), put(out, std::uint64_t{table.size()});
    out += body;
    silt::detail::Crc64 crc;
    crc.add(out.data(), out.size());
    put(out, crc.value());
    return out;
  }
};

template <class T>
T value_at(const Parts::Field& f, std::size_t k) {
  T value;
  std::memcpy(&value, f.bytes.data() + k * sizeof value, sizeof value);
  return value;
}
template <class T>
void set_value(Parts::Field& f, std::size_t k, T value) {
  std::memcpy(f.bytes.data() + k * sizeof value, &value, sizeof value);
}

/// Changes one value of a field, its length, or its order.
inline void forge(Parts::Field& f, silt::Random& random) {
  const std::size_t n = f.count();
  const auto element = [&](std::size_t k) { return f.bytes.substr(k * f.size, f.size); };
  const auto how = random.index(12);
  if (n == 0 || how == 0) {  // longer
    f.bytes +=
        n == 0 ? std::string(f.size * (1 + random.index(8)), '\0') : element(random.index(n));
  } else if (how == 1) {  // shorter
    f.bytes.resize(random.index(n) * f.size);
  } else if (how == 2) {  // one value at the place of another
    f.bytes.replace(random.index(n) * f.size, f.size, element(random.index(n)));
  } else if (how == 3) {
    const auto at = random.index(f.bytes.size());
    f.bytes[at] = static_cast<char>(f.bytes[at] ^ (1 << random.index(8)));
  } else if (f.kind == 't') {
    f.bytes = mutated({f.bytes}, random);
  } else if (f.kind == 'f') {
    const std::size_t k = random.index(n);
    const double was = value_at<double>(f, k);
    const double others[] = {
        std::nan(""), HUGE_VAL, -HUGE_VAL,        -1,     0,    1,
        -0.0,         1e300,    -1e300,           4e-320, 1e18, 9007199254740993.0,
        2 * was,      -was,     was * (1 + 1e-9), 0.5,    3,    4294967295.0,
        1e-12};
    set_value(f, k, others[random.index(std::size(others))]);
  } else {
    const std::size_t k = random.index(n);
    std::uint64_t was = 0;
    std::memcpy(&was, f.bytes.data() + k * f.size, f.size);
    const std::uint64_t others[] = {0,
                                    1,
                                    2,
                                    was + 1,
                                    was - 1,
                                    ~std::uint64_t{0},
                                    ~std::uint64_t{1},
                                    std::uint64_t{1} << (8 * f.size - 1),
                                    n,
                                    1000,
                                    65535,
                                    65536,
                                    0xffffffffu,
                                    0x7fffffffu,
                                    std::uint64_t{1} << 53,
                                    random.index(64)};
    const std::uint64_t other = others[random.index(std::size(others))];
    std::memcpy(f.bytes.data() + k * f.size, &other, f.size);
  }
}

/// One forged field, or fields swapped, missing, renamed, given twice.
inline std::string forged(const Parts& good, silt::Random& random) {
  Parts p = good;
  auto any = [&]() -> Parts::Field& { return p.fields[random.index(p.fields.size())]; };
  switch (random.index(20)) {
    case 0:
      std::swap(any().bytes, any().bytes);
      for (auto& f : p.fields)
        if (f.bytes.size() % f.size != 0) f.bytes.resize(f.bytes.size() / f.size * f.size);
      break;
    case 1:
      p.fields.erase(p.fields.begin() + static_cast<std::ptrdiff_t>(random.index(p.fields.size())));
      break;
    case 2:
      any().name = mutated({any().name, std::string(5000, 'n')}, random);
      break;
    case 3:
      p.fields.push_back(any());
      break;
    case 4:
      p.signature = mutated({p.signature}, random);
      break;
    case 5:
      forge(any(), random);
      [[fallthrough]];
    default:
      forge(any(), random);
  }
  return p.file();
}

}  // namespace fuzz
