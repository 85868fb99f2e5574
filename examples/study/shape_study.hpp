// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <silt/files/atomic_file.hpp>

#include "study/shape_crowd.hpp"
#include "study/studies.hpp"

/// The parts of `./run study shape`.
namespace studies::shape {

/// A shape and the models that represent it.
struct Case {
  Target target;
  std::vector<Model> models;

  const Model& model(const std::string& name) const {
    return *std::find_if(models.begin(), models.end(),
                         [&](const Model& m) { return m.name == name; });
  }
};

/// Repeated measurements of one quantity, from different starts.
struct Spread {
  std::vector<double> values;

  double mean() const {
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
  }
  double half_range() const {  // not a number of a single one
    if (values.size() < 2) return std::nan("");
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return 0.5 * (*most - *least);
  }
};

/// Rows of a name and numbers, as text and as a .csv file.
class Rows {
 public:
  explicit Rows(std::vector<std::string> columns) : columns_(std::move(columns)) {}
  void add(const std::string& name, std::vector<double> numbers) {
    rows_.push_back({name, std::move(numbers)});
  }
  void report(const std::string& title, const std::string& path) const {
    std::printf("%s\n%-18s", title.c_str(), "");
    std::string csv = "name";
    for (const auto& c : columns_) std::printf("  %s", c.c_str()), csv += "," + c;
    for (const auto& [name, numbers] : rows_) {
      std::printf("\n%-18s", name.c_str()), csv += "\n\"" + name + "\"";  // it may have a comma
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        const int width = static_cast<int>(columns_[k].size());
        if (std::isnan(numbers[k]))  // not measured
          std::printf("  %*s", width, "-"), csv += ",";
        else
          std::printf("  %*.4g", width, numbers[k]), csv += silt::text(",", numbers[k]);
      }
    }
    std::printf("\n\n"), std::fflush(stdout);
    silt::detail::write_whole(path, csv + "\n");
  }

 private:
  std::vector<std::string> columns_;
  std::vector<std::pair<std::string, std::vector<double>>> rows_;
};

/// Number of grains in a bed.
inline std::size_t bed_size(const Setting& setting) { return setting.quick ? 60 : 150; }

/// Quantities of many cubes that spheres should reproduce.
struct Cubes {
  Spread heap, drum;  // [degrees]
};

using Cases = std::vector<Case>;
void strike(const Cases& cases, const Setting& setting, example::Summary& summary);   // impacts
void settle(const Cases& cases, const Setting& setting, example::Summary& summary);   // beds
Cubes repose(const Cases& cases, const Setting& setting, example::Summary& summary);  // angles
/// Spheres with rolling friction instead of cubes.
void roll(const Cases& cases, const Cubes& cubes, const Setting& setting,
          example::Summary& summary);

}  // namespace studies::shape
