// silt - BSD-3-Clause, see LICENSE
//
// Restitution and friction of the balls of a laboratory mill from the angles of repose measured in
// recordings of its three drums (docs/ball_mill.md).

#include <cstdint>
#include <vector>

#include "ball_mill/measure.hpp"
#include "calibrate/cases.hpp"

namespace {

constexpr double error = 1.5;  // [degrees] of a measured angle, which the paper does not give

calibrate::Case make(const calibrate::Setting& setting) {
  ball_mill::Scene like;
  if (setting.quick) like.before = 0.5, like.turns = 1;
  calibrate::Case c{
      .parameters = {{.name = "restitution [-]", .least = 0.1, .most = 0.9},
                     {.name = "friction [-]", .least = 0.05, .most = 0.7}},
      .targets = {},
      .scene =
          [like, threads = setting.threads](const std::vector<double>& p, std::uint64_t seed) {
            auto of = like;
            of.seed = 1 + seed % 1000000;  // other places of the balls
            const auto angles = ball_mill::mill_targets(p[0], p[1], of, threads);
            return std::vector<double>(angles.begin(), angles.end());
          },
      .options = {.budget = setting.quick ? 12u : 24u}};
  for (const auto& mill : ball_mill::mills)
    c.targets.push_back({.name = silt::text("angle, ", mill.name, " mm [deg]"),
                         .measured = mill.angle,
                         .error = error});
  return c;
}

const calibrate::Registered here{
    "ball_mill", "restitution and friction of a mill's balls from measured angles of repose", make};

}  // namespace
