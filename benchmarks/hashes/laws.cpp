// silt - BSD-3-Clause, see LICENSE
// Contact laws: with and without history, rotation, range, safeguard; rolling models.

#include "scene_hash.hpp"

namespace {

template <class ContactsType, class Material, class... Policies>
auto bed(const ContactsType& contacts, const Material& m, const Policies&... policies) {
  silt::Particles<silt::Sphere> all;
  all.fill({{0, 0, 0}, {0.015, 0.015, 0.02}},
           {.radius = silt::uniform(0.8e-3, 1.2e-3), .density = 2500, .count = 300});
  silt::Simulation sim{std::move(all), contacts, policies...};
  sim.gravity = {0, 0, -9.81};
  sim.add_wall(silt::box({0, 0, 0}, {0.015, 0.015, 0.04}), m);
  return sim;
}

}  // namespace

void hashes::laws() {
  using silt::Contacts;
  using namespace silt;
  const LinearSpring::Material spring{.stiffness = 1000, .restitution = 0.6};
  print("linear spring", 0.04, [&] { return bed(Contacts<LinearSpring>{spring}, spring); });
  const LinearSpringFriction::Material slides{
      .stiffness = 1000, .restitution = 0.6, .friction = 0.4};
  print("linear spring, friction", 0.04, [&] {
    return bed(Contacts<LinearSpringFriction, RollingViscous>{slides, {.rolling_viscosity = 0.02}},
               slides, EnergyLedger{});
  });
  const Jkr::Material sticks{.youngs_modulus = 1e7,
                             .poisson_ratio = 0.25,
                             .work_of_adhesion = 0.05,
                             .restitution = 0.7,
                             .friction = 0.4};
  print("JKR", 0.04, [&] { return bed(Contacts<Jkr>{sticks}, sticks); });
  using Soft = Softened<HertzMindlin>;
  const Soft::Material soft{.solid = {1e7, 0.25, 0.7, 0.4}, .full_radius = 1.1e-3};
  print("softened", 0.04, [&] { return bed(Contacts<Soft>{soft}, soft, EnergyLedger{}); });
  using Forces = Cohesive<HertzMindlin, VanDerWaals>;
  const Forces::Material waals{
      .body = {1e7, 0.25, 0.7, 0.4},
      .cohesion = {.hamaker = 1e-11, .closest = 1e-5, .cutoff = 1e-4}};
  print("Van der Waals", 0.03, [&] { return bed(Contacts<Forces>{waals}, waals, Mixed{}); });
}
