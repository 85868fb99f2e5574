// silt - BSD-3-Clause, see LICENSE
#include "verification/published.hpp"

#include <fstream>
#include <sstream>

#include <silt/core/error.hpp>

namespace verification {

std::vector<PublishedPoint> published(const std::string& figure, const std::string& series) {
  std::ifstream file(SILT_GALLERY_REFERENCE);
  std::vector<PublishedPoint> out;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string of_figure, of_series, x, y;
    std::getline(words, of_figure, ',');
    std::getline(words, of_series, ',');
    if (of_figure != figure || of_series != series) continue;
    std::getline(words, x, ',');
    std::getline(words, y);
    out.push_back({std::stod(x), std::stod(y)});
  }
  if (out.empty())
    throw silt::FileError("file '" SILT_GALLERY_REFERENCE "' has no points of '" + figure + "', '" +
                          series + "'");
  return out;
}

}  // namespace verification
