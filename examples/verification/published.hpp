// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <string>
#include <vector>

namespace verification {

struct PublishedPoint {
  double x, y;  // in the units of the figure
};

/// Points of one series of reference/published.csv; its sources are in reference/README.md. Throws
/// silt::FileError if there are none.
std::vector<PublishedPoint> published(const std::string& figure, const std::string& series);

}  // namespace verification
