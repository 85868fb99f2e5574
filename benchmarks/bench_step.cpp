// silt - BSD-3-Clause, see LICENSE
//
// Cost of a time step on a settled bed: features left out of a scene cost nothing; and the gain of
// each law from SIMD lanes. Items are particle-steps.

#include <cmath>
#include <string>
#include <type_traits>

#include <benchmark/benchmark.h>

#include <silt/silt.hpp>

namespace {

using silt::Contacts;

/// A bed in a box, at rest; `walls` false: on a floor that is periodic in x and y.
template <class ContactsType, class... Policies>
auto settled(const ContactsType& contacts, std::size_t n, double spread, Policies... policies) {
  const double width = std::cbrt(static_cast<double>(n)) * 2.2e-3;
  silt::Particles<silt::Sphere> spheres;
  spheres.fill({.min = {0, 0, 0}, .max = {width, width, 4 * width}},
               {.radius = silt::uniform((1 - spread) * 1e-3, (1 + spread) * 1e-3),
                .density = 2500,
                .count = n});
  for (std::size_t k = 0; k < spheres.size(); ++k)  // a perfect lattice would stand
    spheres[k].velocity = {0.05 * std::sin(double(k)), 0.05 * std::cos(double(k)), 0};
  silt::Simulation sim{std::move(spheres), contacts, policies...};
  sim.gravity = {0, 0, -9.81};
  sim.threads = 1;
  sim.time_step = 1e-5;
  sim.guard.max_overlap = 1;
  if constexpr (sizeof...(Policies) > 0 && (std::is_same_v<Policies, silt::PeriodicBox> || ...))
    sim.add_wall(silt::Plane{{0, 0, 0}, {0, 0, 1}}, contacts.material(0));
  else
    sim.add_wall(silt::box({0, 0, 0}, {width, width, 5 * width}), contacts.material(0));
  sim.run(0.1);
  return sim;
}

template <class ContactsType, class... Policies>
void run(benchmark::State& state, const ContactsType& contacts, double spread,
         Policies... policies) {
  const auto n = static_cast<std::size_t>(state.range(0));
  auto sim = settled(contacts, n, spread, policies...);
  if constexpr (decltype(sim)::has_events) {
    double lost = 0;
    const auto ends =
        silt::on_contact_end([&](const silt::ContactEvent& c) { lost += c.lost_energy; });
    for (auto _ : state) sim.run(20 * sim.step_length(), ends);
    benchmark::DoNotOptimize(lost);
  } else {
    for (auto _ : state) sim.run(20 * sim.step_length());
  }
  state.SetItemsProcessed(state.iterations() * 20 * state.range(0));
  state.counters["bytes/particle"] = static_cast<double>(sim.bytes_per_particle);
  state.counters["bytes/contact"] = static_cast<double>(sim.bytes_per_contact);
  state.counters["contacts/particle"] =
      static_cast<double>(sim.touching_pairs()) / static_cast<double>(n);
}

constexpr double spread = 0.1;  // of the radii
const silt::HertzMindlin::Material glass{1e7, 0.3, 0.5, 0.4};
const silt::LinearSpring::Material spring{2000, 0.5};
const silt::LinearSpringFriction::Material rough_spring{2000, 0.5, 0.4};

void BM_hertz_mindlin(benchmark::State& s) { run(s, Contacts<silt::HertzMindlin>{glass}, spread); }
void BM_hertz_mindlin_ledger(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin>{glass}, spread, silt::EnergyLedger{});
}
void BM_hertz_mindlin_events(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin>{glass}, spread, silt::ContactEvents{});
}
void BM_hertz_mindlin_mixed(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin>{glass}, spread, silt::Mixed{});
}
void BM_hertz_mindlin_one_size(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin>{glass}, 0);
}
void BM_hertz_mindlin_no_side_walls(benchmark::State& s) {
  const double width = std::cbrt(static_cast<double>(s.range(0))) * 2.2e-3;
  run(s, Contacts<silt::HertzMindlin>{glass}, spread,
      silt::PeriodicBox{{{0, 0, 0}, {width, width, 1}}, {true, true, false}});
}
void BM_hertz_mindlin_rolling(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin, silt::RollingEpsd>{glass, {.rolling_friction = 0.1}}, spread);
}
void BM_hertz_mindlin_several_materials(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin, silt::SeveralMaterials>{{glass}}, spread);
}
void BM_linear_friction(benchmark::State& s) {
  run(s, Contacts<silt::LinearSpringFriction>{rough_spring}, spread);
}
void BM_linear_frictionless(benchmark::State& s) {
  run(s, Contacts<silt::LinearSpring>{spring}, spread);
}
void BM_linear_frictionless_mixed(benchmark::State& s) {
  run(s, Contacts<silt::LinearSpring>{spring}, spread, silt::Mixed{});
}

void BM_hertz_kuwabara_kono(benchmark::State& s) {
  using Law = silt::HertzDamped<silt::KuwabaraKono>;
  run(s, Contacts<Law>{Law::Material{1e7, 0.3, 1e-5, 0.4}}, spread);
}
void BM_dcdem(benchmark::State& s) {
  run(s, Contacts<silt::Dcdem>{silt::Dcdem::Material{1e7, 0.3, 0.5, 0.4}}, spread);
}
void BM_hertz_dmt(benchmark::State& s) {
  using Law = silt::Cohesive<silt::HertzMindlin, silt::Dmt>;
  run(s, Contacts<Law>{Law::Material{glass, {0.01}}}, spread);
}
void BM_hertz_van_der_waals(benchmark::State& s) {
  using Law = silt::Cohesive<silt::HertzMindlin, silt::VanDerWaals>;
  run(s, Contacts<Law>{Law::Material{glass, {1e-12, 1e-4, 2e-4}}}, spread);
}
void BM_hertz_capillary(benchmark::State& s) {
  using Law = silt::Cohesive<silt::HertzMindlin, silt::CapillaryBridge>;
  run(s, Contacts<Law>{Law::Material{glass, {0.01, 0.3, 1e-12}}}, spread);
}
void BM_jkr(benchmark::State& s) {
  run(s, Contacts<silt::Jkr>{silt::Jkr::Material{1e7, 0.3, 0.01, 0.5, 0.4}}, spread);
}
void BM_hertz_mindlin_directional(benchmark::State& s) {
  run(s, Contacts<silt::HertzMindlin, silt::RollingDirectional>{glass, {0.05}}, spread);
}
void BM_hertz_mindlin_rolling_twisting(benchmark::State& s) {
  using Full = silt::Both<silt::RollingEpsd, silt::Twisting>;
  run(s, Contacts<silt::HertzMindlin, Full>{glass, {{0.1}, {0.4}}}, spread);
}

constexpr auto ms = benchmark::kMillisecond;

/// Times a law on the lanes of this machine and on one lane: for a user-defined law it shows
/// whether the compiler vectorises it as well as the others.
template <class Law>
bool compare_lanes(const std::string& name, const typename Law::Material& material) {
  const auto time = [&](const char* kind, auto... kernels) {
    benchmark::RegisterBenchmark(
        (name + kind).c_str(),
        [=](benchmark::State& s) { run(s, Contacts<Law>{material}, spread, kernels...); })
        ->Arg(5000)
        ->Unit(ms);
  };
  time("/lanes");
  time("/one_lane", silt::KernelsFor<silt::OneLane>{});
  return true;
}
const bool laws = compare_lanes<silt::HertzMindlin>("law_hertz_mindlin", glass) &&
                  compare_lanes<silt::LinearSpring>("law_linear", spring);

BENCHMARK(BM_hertz_mindlin_several_materials)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_rolling)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin)->Arg(5000)->Arg(50000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_ledger)->Arg(5000)->Arg(50000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_events)->Arg(5000)->Arg(50000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_one_size)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_no_side_walls)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_mixed)->Arg(5000)->Arg(50000)->Unit(ms);
BENCHMARK(BM_linear_friction)->Arg(5000)->Unit(ms);
BENCHMARK(BM_linear_frictionless)->Arg(5000)->Arg(50000)->Unit(ms);
BENCHMARK(BM_linear_frictionless_mixed)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_kuwabara_kono)->Arg(5000)->Unit(ms);
BENCHMARK(BM_dcdem)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_dmt)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_van_der_waals)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_capillary)->Arg(5000)->Unit(ms);
BENCHMARK(BM_jkr)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_directional)->Arg(5000)->Unit(ms);
BENCHMARK(BM_hertz_mindlin_rolling_twisting)->Arg(5000)->Unit(ms);

}  // namespace

BENCHMARK_MAIN();
