// silt - BSD-3-Clause, see LICENSE
//
// Cost of a time step on a settled bed: what a scene leaves out, it does not pay for.
// Items are particle-steps.

#include <benchmark/benchmark.h>

#include <silt/silt.hpp>

namespace {

using silt::Contacts;

template <class ContactsType>
auto settled(const ContactsType& contacts, std::size_t n) {
  const double width = std::cbrt(static_cast<double>(n)) * 2.2e-3;
  silt::Particles<silt::Sphere> spheres;
  spheres.fill({.min = {0, 0, 0}, .max = {width, width, 4 * width}},
               {.radius = silt::uniform(0.9e-3, 1.1e-3), .density = 2500, .count = n});
  silt::Simulation sim{std::move(spheres), contacts};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.guard.max_overlap = 1;
  sim.add_wall(silt::box({0, 0, 0}, {width, width, 5 * width}), contacts.material(0));
  sim.run(0.1);
  return sim;
}

template <class ContactsType>
void run(benchmark::State& state, const ContactsType& contacts) {
  auto sim = settled(contacts, static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) sim.run(20 * sim.step_length());
  state.SetItemsProcessed(state.iterations() * 20 * state.range(0));
  state.counters["bytes/particle"] = static_cast<double>(sim.bytes_per_particle);
  state.counters["bytes/contact"] = static_cast<double>(sim.bytes_per_contact);
}

const silt::HertzMindlin::Material glass{1e7, 0.3, 0.5, 0.4};
const silt::LinearSpring::Material spring{2000, 0.5};
const silt::LinearSpringFriction::Material rough_spring{2000, 0.5, 0.4};

void BM_step_hertz_mindlin(benchmark::State& s) { run(s, Contacts<silt::HertzMindlin>{glass}); }
void BM_step_hertz_mindlin_rolling(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {.rolling_friction = 0.1}});
}
void BM_step_linear_friction(benchmark::State& s) {
  run(s, Contacts<silt::LinearSpringFriction>{rough_spring});
}
void BM_step_linear_frictionless(benchmark::State& s) {
  run(s, Contacts<silt::LinearSpring>{spring});
}

BENCHMARK(BM_step_hertz_mindlin)->Arg(5000)->Arg(50000)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_step_hertz_mindlin_rolling)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_step_linear_friction)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_step_linear_frictionless)->Arg(5000)->Arg(50000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
