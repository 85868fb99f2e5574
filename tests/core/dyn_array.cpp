// silt - BSD-3-Clause, see LICENSE
#include <cstdint>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <silt/core/dyn_array.hpp>

namespace dyn_array_test {

// An element that owns memory and counts itself: what is built twice, or never destroyed, is seen.
struct Counted {
  static inline int alive = 0;
  std::unique_ptr<int> value;

  Counted(int v = 0) : value(std::make_unique<int>(v)) { ++alive; }
  Counted(const Counted& o) : value(std::make_unique<int>(*o.value)) { ++alive; }
  Counted(Counted&& o) noexcept : value(std::move(o.value)) { ++alive; }
  Counted& operator=(const Counted& o) {
    value = std::make_unique<int>(*o.value);
    return *this;
  }
  Counted& operator=(Counted&&) noexcept = default;
  ~Counted() { --alive; }
  friend bool operator==(const Counted& a, const Counted& b) { return *a.value == *b.value; }
};

// The same random edits to a DynArray and to a std::vector, compared after each.
template <class T>
void edit_both(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  silt::DynArray<T> a;
  std::vector<T> b;
  for (int k = 0; k < 4000; ++k) {
    const T value(static_cast<int>(random() % 1000));
    const auto at = static_cast<std::ptrdiff_t>(below(b.size() + 1));
    switch (below(16)) {
      case 0: a.resize(below(60)), b.resize(a.size()); break;
      case 1: {
        const std::size_t n = below(60);
        a.resize(n, value), b.resize(n, value);
        break;
      }
      case 2: a.insert(a.begin() + at, value), b.insert(b.begin() + at, value); break;
      case 3: a.insert(a.begin() + at, 3, value), b.insert(b.begin() + at, 3, value); break;
      case 4: {
        const std::vector<T> more(below(5), value);
        a.insert(a.begin() + at, more.begin(), more.end());
        b.insert(b.begin() + at, more.begin(), more.end());
        break;
      }
      case 5:
        a.insert(a.begin() + at, {value, T(1)}), b.insert(b.begin() + at, {value, T(1)});
        break;
      case 6: {
        const auto to = at + static_cast<std::ptrdiff_t>(below(b.size() + 1 - static_cast<std::size_t>(at)));
        a.erase(a.begin() + at, a.begin() + to), b.erase(b.begin() + at, b.begin() + to);
        break;
      }
      case 7:
        if (!b.empty()) {
          const auto one = static_cast<std::ptrdiff_t>(below(b.size()));
          a.erase(a.begin() + one), b.erase(b.begin() + one);
        }
        break;
      case 8: a.assign(4, value), b.assign(4, value); break;
      case 9: {
        const silt::DynArray<T> c(a);
        a = c, a.push_back(value), b.push_back(value);
        break;
      }
      case 10: {
        silt::DynArray<T> c(std::move(a));
        CHECK(a.empty());
        c.emplace_back(7), b.emplace_back(7);
        a = std::move(c);
        CHECK(c.empty());
        break;
      }
      case 11:
        if (!b.empty()) a.pop_back(), b.pop_back();
        break;
      case 12: {
        const auto goes = [&](const T& x) { return x == value || x == T(7); };
        CHECK(erase_if(a, goes) == std::erase_if(b, goes));
        break;
      }
      case 13: a.reserve(below(90)); break;
      default:
        if (b.empty()) {
          a.push_back(value), b.push_back(value);
        } else {  // an element of the array itself, also while it grows
          const std::size_t one = below(b.size());
          a.push_back(a[one]), b.push_back(b[one]);
        }
    }
    REQUIRE(a.size() == b.size());
    REQUIRE(a.capacity() >= a.size());
    REQUIRE(std::equal(a.begin(), a.end(), b.begin()));
  }
  CHECK(std::vector<T>(a) == b);
  CHECK(silt::DynArray<T>(b) == a);
}

TEST_CASE("a DynArray holds what a std::vector holds after the same edits") {
  // Catches each edit that loses, repeats or misplaces an element.
  edit_both<int>(1);
  edit_both<Counted>(2);
}

TEST_CASE("elements of a DynArray are destroyed once") {
  // Catches elements left alive by a shrinking, a move or an edit, and those destroyed twice.
  Counted::alive = 0;
  {
    edit_both<Counted>(3);
    silt::DynArray<Counted> a{1, 2, 3}, b(5);
    a.insert(a.begin() + 1, b.begin(), b.end());
    b = a;
    a = std::move(b);
    CHECK(Counted::alive == 8);
  }
  CHECK(Counted::alive == 0);
}

TEST_CASE("what a DynArray cannot hold or does not have is said") {
  // Catches a product of bytes that wraps around (a tiny block for a huge array), and at() that
  // reads beyond the end.
  silt::DynArray<double> a(3, 1.5);
  CHECK_THROWS_AS(a.resize(SIZE_MAX / 4), std::length_error);
  CHECK(a.size() == 3);
  CHECK_THROWS_AS(a.at(3), std::out_of_range);
  CHECK(a.at(2) == 1.5);
}

struct alignas(128) Wide {
  double x = 0;
};

TEST_CASE("a DynArray gives its elements the alignment of their type") {
  silt::DynArray<Wide> a;
  for (int k = 0; k < 20; ++k) {
    a.emplace_back();
    CHECK(reinterpret_cast<std::uintptr_t>(a.data()) % 128 == 0);
  }
}

}  // namespace dyn_array_test
