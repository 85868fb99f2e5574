// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <charconv>
#include <initializer_list>
#include <string>
#include <string_view>

#include <silt/core/error_types.hpp>
#include <silt/core/vec3.hpp>

namespace silt::inline SILT_TARGET {

// Message functions and other rarely used code are [[gnu::cold]]: compiled for size and placed
// apart, they reduce the compile time of every program.

namespace detail {

/// Appends the shortest form that reads back exactly.
inline void append(std::string& out, double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  out.append(buffer, end);
}

/// Appends six significant digits, without trailing zeros.
[[gnu::cold]] inline void append_rounded(std::string& out, double value) {
  char buffer[32];
  out.append(
      buffer,
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 6).ptr);
}

/// Appends the shortest form that reads back exactly, or six digits of a number that needs more
/// than nine: such numbers are computed. One that six digits only just miss keeps all of them:
/// 0.30000000000000004 must not be reported as 0.3.
[[gnu::cold]] inline void append_readable(std::string& out, double value) {
  char exact[32], six[32];
  const auto end = std::to_chars(exact, exact + sizeof exact, value).ptr;
  int digits = 0;
  for (const char* c = exact; c != end && *c != 'e'; ++c)
    digits += (*c > '0' || (digits > 0 && *c == '0')) && *c <= '9';
  if (digits > 9) {
    const auto end_of_six =
        std::to_chars(six, six + sizeof six, value, std::chars_format::general, 6).ptr;
    double rounded = value;
    std::from_chars(six, end_of_six, rounded);
    const double apart = rounded > value ? rounded - value : value - rounded;
    if (apart > 1e-9 * (value > 0 ? value : -value)) return void(out.append(six, end_of_six));
  }
  out.append(exact, end);
}

/// How numbers are written: exactly, as by append_readable, or with six digits.
enum class Digits : unsigned char { All, Readable, Six };

/// One word or number of a message; strings and vectors are referred to and must outlive it.
/// Neither this class nor the functions that take it are templates, and it is two words long: there
/// are many messages, and each would add compile time to every program that includes silt.
class Part {
 public:
  Part() : Part("") {}
  Part(const char* words) : kind_(Kind::Literal), words_(words) {}   // NOLINT
  Part(const std::string& words) : Part(std::string_view(words)) {}  // NOLINT
  Part(std::string_view words)                                       // NOLINT
      : kind_(Kind::Words), length_(static_cast<unsigned>(words.size())), words_(words.data()) {}
  Part(char letter) : kind_(Kind::Letter), letter_(letter) {}          // NOLINT
  Part(double number) : kind_(Kind::Number), number_(number) {}        // NOLINT
  Part(const Vec3d& v) : kind_(Kind::Vector), vector_(&v) {}           // NOLINT
  Part(int n) : Part(static_cast<long long>(n)) {}                     // NOLINT
  Part(long n) : Part(static_cast<long long>(n)) {}                    // NOLINT
  Part(long long n) : kind_(Kind::Integer), integer_(n) {}             // NOLINT
  Part(unsigned n) : Part(static_cast<unsigned long long>(n)) {}       // NOLINT
  Part(unsigned long n) : Part(static_cast<unsigned long long>(n)) {}  // NOLINT
  Part(unsigned long long n) : kind_(Kind::Count), count_(n) {}        // NOLINT

  [[gnu::cold]] void append_to(std::string& out, Digits digits) const {
    const auto number = [&](double x) {
      digits == Digits::Six        ? append_rounded(out, x)
      : digits == Digits::Readable ? append_readable(out, x)
                                   : append(out, x);
    };
    switch (kind_) {
      case Kind::Literal:
        out += words_;
        break;
      case Kind::Words:
        out.append(words_, length_);
        break;
      case Kind::Letter:
        out += letter_;
        break;
      case Kind::Number:
        number(number_);
        break;
      case Kind::Integer:
        out += std::to_string(integer_);
        break;
      case Kind::Count:
        out += std::to_string(count_);
        break;
      case Kind::Vector:
        out += '(', number(vector_->x), out += ", ", number(vector_->y), out += ", ";
        number(vector_->z), out += ')';
    }
  }

 private:
  enum class Kind : unsigned char { Literal, Words, Letter, Number, Integer, Count, Vector };
  Kind kind_;
  unsigned length_ = 0;  // of words
  union {
    const char* words_;
    char letter_;
    double number_;
    long long integer_;
    unsigned long long count_;
    const Vec3d* vector_;
  };
};

[[gnu::cold]] inline std::string join(std::initializer_list<Part> parts,
                                      Digits digits = Digits::All) {
  std::string out;
  for (const auto& part : parts) part.append_to(out, digits);
  return out;
}

}  // namespace detail

/// Joins words and numbers (shortest form that reads back exactly) into one string.
template <class... Parts>
[[gnu::cold]] std::string text(const Parts&... parts) {
  return detail::join({parts...});
}

namespace detail {

/// As text(), with numbers of six digits, for messages about computed values. Messages about input,
/// by require(), keep up to nine: 1.0000001 must not be reported as 1.
template <class... Parts>
[[gnu::cold]] std::string sentence(const Parts&... parts) {
  return join({parts...}, Digits::Six);
}

/// As text(), with numbers of up to nine digits, for messages in the middle of a run.
template <class... Parts>
[[gnu::cold]] std::string readable(const Parts&... parts) {
  return join({parts...}, Digits::Readable);
}

/// Length [bytes] of the first character of `words` if it is printable; 0 for a control character
/// or invalid UTF-8.
[[gnu::cold]] inline std::size_t printable_length(std::string_view words) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(words[k]); };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7f;
  const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || words.size() < length) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  if (byte(0) == 0xc2 && byte(1) < 0xa0) return 0;  // control characters of Latin-1
  // Invisible ones: zero width, writing direction, byte-order mark.
  if (byte(0) == 0xe2 && byte(1) == 0x80 && (byte(2) <= 0x8f || byte(2) >= 0xa8)) return 0;
  if (byte(0) == 0xe2 && byte(1) == 0x81 && byte(2) >= 0xa0) return 0;
  if (byte(0) == 0xef && byte(1) == 0xbb && byte(2) == 0xbf) return 0;
  return length;
}

}  // namespace detail

/// Text of a file or a user for a message: in quotes, at most the first `most` characters, with
/// unprintable ones as \n or \x1b, which terminals do not interpret.
[[gnu::cold]] inline std::string in_quotes(std::string_view words, std::size_t most = 60) {
  std::string out = "'";
  const std::size_t whole = words.size();
  for (std::size_t shown = 0; !words.empty(); ++shown) {
    if (shown == most) return out + text("'... (", whole, " bytes)");
    const std::size_t length = detail::printable_length(words);
    const auto c = static_cast<unsigned char>(words[0]);
    if (length > 0)
      out += words.substr(0, length);
    else if (c == '\n' || c == '\t' || c == '\r')
      out += c == '\n' ? "\\n" : c == '\t' ? "\\t" : "\\r";
    else
      out += "\\x", out += "0123456789abcdef"[c >> 4], out += "0123456789abcdef"[c & 15];
    words.remove_prefix(length > 0 ? length : 1);
  }
  return out + "'";
}

namespace detail {
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse(std::initializer_list<Part> parts) {
  throw InputError(join(parts, Digits::Readable));
}
}  // namespace detail

/// Throws InputError with the joined parts unless `condition` holds.
template <class... Parts>
void require(bool condition, const Parts&... parts) {
  if (!condition) [[unlikely]]
    detail::refuse({parts...});
}

namespace detail {
/// Element k of `all`; `name` is used in the message.
template <class All>
const auto& at(std::string_view name, const All& all, std::size_t k) {
  require(k < all.size(), name, '(', k, "): there ", all.size() == 1 ? "is " : "are ", all.size(),
          ' ', name, all.size() == 1 ? "" : "s", ", counted from 0");
  return all[k];
}
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_row(std::size_t k, std::size_t rows) {
  throw InputError(text("there is no particle at place ", k, ": Simulation::rows() is ", rows,
                        ", and find() gives that for a particle that has left"));
}
}  // namespace detail

/// Throws InputError unless `value` is finite and in [low, high]: name, value, unit, range.
inline void require_in(std::string_view name, double value, std::string_view unit, double low,
                       double high) {
  require(value >= low && value <= high, name, " = ", value, " [", unit, "] must be in [", low,
          ", ", high, "]");
}

/// Throws InputError unless `value` is finite and > 0: name, value, unit.
inline void require_positive(std::string_view name, double value, std::string_view unit) {
  require(std::isfinite(value) && value > 0, name, " = ", value, " [", unit,
          "] must be finite and greater than 0");
}

/// Throws InputError unless `value` is finite and >= 0: name, value, unit.
inline void require_not_negative(std::string_view name, double value, std::string_view unit) {
  require(std::isfinite(value) && value >= 0, name, " = ", value, " [", unit,
          "] must be finite and not negative");
}

}  // namespace silt

/// Internal invariant in a hot path: checked only in debug builds.
#if defined(NDEBUG) && !defined(SILT_CHECKED)
#define SILT_ASSERT(condition) ((void)0)
#else
#include <cassert>
#define SILT_ASSERT(condition) assert(condition)
#endif
