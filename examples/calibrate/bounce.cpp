// silt - BSD-3-Clause, see LICENSE
//
// Restitution, friction and Young's modulus from single impacts on a plate.

#include "calibrate/cases.hpp"
#include "calibrate/impacts.hpp"

namespace {

calibrate::Case make(const calibrate::Setting& setting) {
  calibrate::Case c{
      .parameters =
          {{.name = "restitution [-]", .least = 0.3, .most = 0.95},
           {.name = "friction [-]", .least = 0.05, .most = 0.6},
           {.name = "Young's modulus [Pa]", .least = 1e6, .most = 1e9, .logarithmic = true}},
      .targets = {{.name = "rebound, straight [-]", .measured = 0, .error = 0.02},
                  {.name = "tangential, 25 deg [-]", .measured = 0, .error = 0.02},
                  {.name = "tangential, 50 deg [-]", .measured = 0, .error = 0.02},
                  {.name = "contact time [us]", .measured = 0, .error = 10}},
      .scene = [](const std::vector<double>& p, std::uint64_t) { return calibrate::impacts(p); },
      .options = {.budget = setting.quick ? 30u : 60u}};
  calibrate::plant(c, {0.75, 0.22, 2e7}, 1, 1);
  return c;
}

const calibrate::Registered here{
    "bounce", "restitution, friction and modulus from single impacts on a plate", make};

}  // namespace
