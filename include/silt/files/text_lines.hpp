// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <silt/core/error.hpp>

namespace silt::inline SILT_TARGET::detail {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

inline std::string_view trimmed(std::string_view s) {
  while (!s.empty() && is_blank(s.front())) s.remove_prefix(1);
  while (!s.empty() && is_blank(s.back())) s.remove_suffix(1);
  return s;
}

/// Takes the first word off `rest`; empty if none is left.
inline std::string_view next_word(std::string_view& rest) {
  rest = trimmed(rest);
  std::size_t end = 0;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const auto word = rest.substr(0, end);
  rest = trimmed(rest.substr(end));
  return word;
}

/// Reads a finite number, for any locale; returns the reason why `word` is not one, or empty.
inline std::string_view why_no_number(std::string_view word, double& x) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data() + (plus ? 1 : 0), end, x);
  if (error == std::errc::result_out_of_range) return "is outside the range of double numbers";
  if (error != std::errc() || stop != end) return "is not a number";
  return std::isfinite(x) ? "" : "is not finite";
}

/// Lines of a text file, without blank lines and comments, word by word. Knows its position, which
/// every refusal reports as file and line.
class TextLines {
 public:
  /// `file`: prefix of messages, as in "OBJ file 'a.obj'". `comment`: its first character; 0: none.
  TextLines(std::string file, std::string_view content, char comment = '#')
      : file_(std::move(file)), rest_(content), comment_(comment) {}

  bool next() {
    while (!rest_.empty()) {
      const auto end = std::min(rest_.find('\n'), rest_.size());
      const auto whole = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      ++number_;
      const auto cut = comment_ == 0 ? whole.size() : std::min(whole.find(comment_), whole.size());
      line_ = words_ = trimmed(whole.substr(0, cut));
      remark_ = trimmed(whole.substr(std::min(cut + 1, whole.size())));
      if (!line_.empty()) return true;
    }
    line_ = words_ = remark_ = {};
    return false;
  }
  /// Skips the next line, whatever it contains.
  void skip() {
    rest_.remove_prefix(std::min(rest_.size(), std::min(rest_.find('\n'), rest_.size()) + 1));
    ++number_;
  }
  /// next(), or a refusal that says what is missing.
  void need(std::string_view what) {
    if (!next())
      throw FileError(text(file_, " ends after line ", number_, ", where ", what,
                           " must follow; it is cut short or not of this format"));
  }

  std::string_view line() const { return line_; }
  std::string_view remark() const { return remark_; }  // after the comment sign
  std::size_t number() const { return number_; }       // of the line, from 1
  std::string_view rest() const { return rest_; }      // of the file
  const std::string& file() const { return file_; }

  std::string_view word() { return next_word(words_); }
  std::string_view words() const { return words_; }  // remaining words of this line
  double real(std::string_view what) {
    const auto w = word();
    double x = 0;
    if (w.empty()) fail(what, " is missing");
    if (const auto why = why_no_number(w, x); !why.empty())
      fail(what, ": ", in_quotes(w), ' ', why);
    return x;
  }
  std::uint64_t count(std::string_view what) {
    const auto w = word();
    std::uint64_t n = 0;
    const auto [stop, error] = std::from_chars(w.data(), w.data() + w.size(), n);
    if (w.empty() || error != std::errc() || stop != w.data() + w.size())
      fail(what, ": ", in_quotes(w), " is not a whole number from 0");
    return n;
  }

  template <class... Parts>
  [[noreturn]] [[gnu::cold]] void fail(const Parts&... parts) const {
    throw FileError(text(file_, ", line ", number_, ": ", parts...));
  }

 private:
  std::string file_;
  std::string_view rest_, line_{}, words_{}, remark_{};
  char comment_;
  std::size_t number_ = 0;
};

}  // namespace silt::inline SILT_TARGET::detail
