// silt - BSD-3-Clause, see LICENSE
#include "stability/table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>

namespace stability {

namespace {

constexpr int name_width = 60, sentence_width = 88;

const char* word(Verdict v) {
  switch (v) {
    case Verdict::Stable:
      return "stable";
    case Verdict::Stopped:
      return "stopped";
    case Verdict::Alarm:
      return "ALARM";
    default:
      return "WRONG";
  }
}

/// Distance of a measure from its bound: 1 at the bound.
double nearness(const Measure& m) {
  if (!std::isfinite(m.error)) return INFINITY;
  return m.bound > 0 ? m.error / m.bound : (m.error > 0 ? INFINITY : 0);
}

/// The text with its numbers to three digits.
std::string rounded(const std::string& text) {
  std::string out;
  for (std::size_t k = 0; k < text.size();) {
    const bool is_number = (text[k] >= '0' && text[k] <= '9') &&
                           (k == 0 || std::strchr(" (-", text[k - 1]) != nullptr);
    if (!is_number) {
      out += text[k++];
      continue;
    }
    char* end = nullptr;
    const double value = std::strtod(text.c_str() + k, &end);
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.3g", value);
    out += digits;
    k = static_cast<std::size_t>(end - text.c_str());
  }
  return out;
}

/// The part of a message that names the cause, without the step and its time, cut to the width.
std::string shortened(std::string sentence) {
  if (const auto head = sentence.find(" s: "); sentence.starts_with("step ") && head < 60)
    sentence = sentence.substr(head + 4);
  sentence = rounded(sentence);
  if (sentence.size() <= sentence_width) return sentence;
  const auto cut = sentence.rfind(' ', sentence_width - 4);
  return sentence.substr(0, cut) + " ...";
}

/// Whether a limit of the guard stopped a scene: overlap, rate, time step, displacement, or
/// positions on a mesh; density of a liquid. Any other error - NaN, a refused argument - is a
/// mistake in the scene or in silt, and not an acceptable end of an extreme scene.
bool is_a_limit(const std::string& sentence) {
  for (const char* words :
       {"guard.max_overlap", "are too stiff or too strongly damped", "is above the limit",
        "is above its limit", "is too long for the bonds", "more than guard.max_travel",
        "places at once, and silt computes", "of Liquid.sound_speed = ", "has gone through wall ",
        "times the speed of a wall", "use a smaller spacing, a larger alpha"})
    if (sentence.find(words) != std::string::npos) return true;
  return false;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace

void Table::scene(const std::string& name, const std::string& stable) {
  scene_ = name;
  std::printf("\n%s\n  stable: %s\n", name.c_str(), stable.c_str());
  std::fflush(stdout);
}

void Table::row(const std::string& name, Setting setting, const std::function<Measures()>& run) {
  add(name, setting, nullptr, run);
}

void Table::stops(const std::string& name, const std::string& words,
                  const std::function<Measures()>& run) {
  add(name, Setting::Extreme, &words, run);
}

void Table::add(const std::string& name, Setting setting, const std::string* words,
                const std::function<Measures()>& run) {
  Row row{scene_, name, Verdict::Stable, {"", 0, 0}, "", 0};
  const example::Stopwatch watch;
  try {
    bool first = true;
    for (const auto& m : run()) {
      if (first || nearness(m) > nearness(row.worst)) row.worst = m;
      first = false;
      if (!(m.error <= m.bound)) row.verdict = Verdict::Wrong;
    }
    if (words) row.worst = {"not stopped", 1, 0}, row.verdict = Verdict::Wrong;
  } catch (const silt::Error& e) {
    row.sentence = e.what();
    const bool expected = words ? row.sentence.find(*words) != std::string::npos
                                : setting == Setting::Extreme && is_a_limit(row.sentence);
    row.verdict = expected ? Verdict::Stopped : Verdict::Alarm;
  }
  row.seconds = watch.seconds();
  std::printf("  %-*s %-7s ", name_width, name.c_str(), word(row.verdict));
  if (row.sentence.empty())
    std::printf("%-24s %9.2e <= %.1e\n", row.worst.name.c_str(), row.worst.error, row.worst.bound);
  else
    std::printf("%s\n", shortened(row.sentence).c_str());
  std::fflush(stdout);
  rows_.push_back(row);
}

int Table::count(Verdict verdict) const {
  int n = 0;
  for (const auto& r : rows_) n += r.verdict == verdict;
  return n;
}

void Table::print_end() const {
  std::printf("\n%-82s %5s %7s %8s  %s\n", "scene", "rows", "stable", "stopped",
              "error over bound, largest of the stable");
  for (std::size_t from = 0, to = 0; from < rows_.size(); from = to) {
    int stable = 0, stopped = 0;
    double nearest = 0;
    std::string others;
    for (; to < rows_.size() && rows_[to].scene == rows_[from].scene; ++to) {
      const Row& r = rows_[to];
      stable += r.verdict == Verdict::Stable, stopped += r.verdict == Verdict::Stopped;
      if (r.verdict == Verdict::Stable) nearest = std::max(nearest, nearness(r.worst));
      if (r.verdict > Verdict::Stopped) others = std::string("  ") + word(r.verdict);
    }
    std::printf("%-82s %5zu %7d %8d  ", rows_[from].scene.c_str(), to - from, stable, stopped);
    if (stable > 0)
      std::printf("%.2g%s\n", nearest, others.c_str());
    else
      std::printf("-%s\n", others.c_str());
  }
  std::printf("%zu rows: %d stable, %d stopped by the guard with a sentence", rows_.size(),
              count(Verdict::Stable), count(Verdict::Stopped));
  std::printf(", %d tame ones stopped (ALARM), %d silently wrong (WRONG)\n", count(Verdict::Alarm),
              count(Verdict::Wrong));
}

void Table::write_csv(const std::string& path) const {
  std::string all = "scene,row,verdict,worst measure,error [-],bound [-],seconds,sentence\n";
  for (const auto& r : rows_) {
    all += quoted(r.scene) + ',' + quoted(r.name) + ',' + word(r.verdict) + ',';
    all += quoted(r.worst.name) + ',' + silt::text(r.worst.error, ',', r.worst.bound, ',');
    all += silt::text(r.seconds, ',') + quoted(r.sentence) + '\n';
  }
  silt::AtomicFile file(path);
  file.write(all);
  file.commit();
}

void Table::add_to(example::Summary& summary) const {
  summary.result("rows", static_cast<double>(rows_.size()));
  summary.result("stable", static_cast<double>(count(Verdict::Stable)));
  summary.result("stopped", static_cast<double>(count(Verdict::Stopped)));
  for (const auto& r : rows_) {
    const std::string name = r.scene + ": " + r.name;
    if (r.verdict == Verdict::Stopped) {
      summary.result(name, r.sentence);
      continue;
    }
    const double error = r.verdict == Verdict::Alarm ? INFINITY : r.worst.error;
    summary.check_at_most(name + ": " + r.worst.name, error, r.worst.bound);
  }
}

}  // namespace stability
