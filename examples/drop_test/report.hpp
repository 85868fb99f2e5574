// silt - BSD-3-Clause, see LICENSE
#pragma once

// What is left of the throws: tables, summary.json with its checks.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "drop_test/measure.hpp"
#include "support/example.hpp"

namespace drop_test {

/// Quantile of chi-square with n degrees of freedom at the probability with which a normal deviate
/// exceeds z. Source: E. B. Wilson, M. M. Hilferty, PNAS 17 (1931) 684; error below 1 % for n of 10
/// and more.
inline double chi_square(double n, double z) {
  const double w = 2 / (9 * n);
  return n * std::pow(std::max(1 - w + z * std::sqrt(w), 0.0), 3);
}

inline void write_shares(const std::string& file, const Scene& s, const std::vector<Throw>& all) {
  silt::CsvTable table(file, {"size [m]", "speed [m/s]", "grains", "broken", "share",
                              "selection function", "3 sigma", "dust of the broken"});
  for (const Throw& t : all)
    table.add_row({t.diameter, t.speed, static_cast<double>(t.grains),
                   static_cast<double>(t.broken), t.share(), t.expected, 3 * t.deviation(),
                   t.dust});
  // The law between the speeds, for the picture.
  silt::CsvTable law(file.substr(0, file.size() - 4) + "_law.csv",
                     {"size [m]", "speed [m/s]", "selection function"});
  for (const double d : s.diameters)
    for (double v = 0.3; v < 3.4; v *= 1.03)
      law.add_row({d, v * s.median_speed(d), s.selection(d, v * s.median_speed(d))});
}
inline void write_sizes(const std::string& file, const Sizes& sizes) {
  silt::CsvTable table(file, {"x [m]", "share finer", "breakage function", "standard error"});
  for (std::size_t k = 0; k < sizes.x.size(); ++k)
    table.add_row({sizes.x[k], sizes.seen[k], sizes.wanted[k], sizes.error[k]});
}
inline void write_fatigue(const std::string& file, const std::vector<Again>& all) {
  silt::CsvTable table(file, {"speed [m/s]", "impacts", "broken share", "by the law", "3 sigma"});
  for (const Again& a : all)
    for (std::size_t k = 0; k < a.broken.size(); ++k)
      table.add_row({a.speed, static_cast<double>(k + 1), a.share(k), a.expected[k],
                     3 * a.share_deviation(k)});
}

/// A normal deviate exceeds this, on one side, with a probability of 1e-4: each of these checks
/// fails by chance for one seed in ten thousand.
constexpr double rare = 3.719;

inline void check_shares(example::Summary& summary, const std::vector<Throw>& all) {
  double squares = 0, off = 0, variance = 0, worst = 0, load = 0;
  std::size_t beyond = 0;
  for (const Throw& t : all) {
    const auto n = static_cast<double>(t.grains);
    squares += t.off() * t.off(), worst = std::max(worst, std::abs(t.off()));
    beyond += std::abs(t.off()) > 3, load = std::max(load, t.load);
    off += n * (t.share() - t.expected), variance += n * t.expected * (1 - t.expected);
  }
  const auto n = static_cast<double>(all.size());
  summary.result("points", n);
  summary.result("points_beyond_3_sigma", static_cast<double>(beyond));
  summary.result("points_beyond_3_sigma_expected", 0.0027 * n);
  summary.result("largest_deviation_in_sigma", worst);
  summary.check_at_most("loads_off_hertz", load, 1e-12);
  summary.check_at_most("chi_square_of_shares", squares, chi_square(n, rare));
  summary.check_at_least("chi_square_of_shares", squares, chi_square(n, -rare));
  summary.check_within("all_broken_off_the_law_in_sigma", off / std::sqrt(variance), 0, rare,
                       "probability of 2e-4");
}

/// Fails for missing fatigue (no grain would break after the first impact), and for fatigue that
/// acts at each step of a contact (nearly all would break at the second).
inline void check_fatigue(example::Summary& summary, const std::vector<Again>& all) {
  for (const Again& a : all) {
    const std::string at = silt::text("at ", std::round(100 * a.speed) / 100, " m/s: ");
    const std::size_t last = a.broken.size() - 1;
    summary.result(at + "mean number of impacts of those that broke", a.mean);
    summary.result(at + "the same by the law", a.wanted);
    summary.check_within(at + "mean number of impacts off the law in sigma",
                         (a.mean - a.wanted) / a.deviation, 0, rare, "probability of 2e-4");
    summary.check_within(at + "share broken in the end off the law in sigma",
                         (a.share(last) - a.expected[last]) / a.share_deviation(last), 0, rare,
                         "probability of 2e-4");
  }
}

/// Allowed error of the random fragment sizes: 0.16 % of the mass (docs/breakage.md).
inline void check_sizes(example::Summary& summary, const Sizes& sizes) {
  double worst = 0, most = 0;
  for (std::size_t k = 0; k < sizes.x.size(); ++k) {
    const double off = std::abs(sizes.seen[k] - sizes.wanted[k]);
    most = std::max(most, off);
    worst = std::max(worst, off / (0.0016 + 4 * sizes.error[k]));
  }
  summary.result("largest_deviation_from_the_breakage_function", most);
  summary.check_at_most("sizes_off_the_breakage_function_over_0.16_percent_and_4_sigma", worst, 1);
}

inline void check_books(example::Summary& summary, const Books& books) {
  summary.check_at_most("mass_unexplained", books.mass, 1e-12);
  summary.check_at_most("momentum_unexplained", books.momentum, 1e-11);
  // Second order in the time step: forces of small fragments change much within one step. Observed:
  // 5e-5.
  summary.check_at_most("energy_unexplained", books.energy, 1e-3);
}

}  // namespace drop_test
