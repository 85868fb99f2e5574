// silt - BSD-3-Clause, see LICENSE
//
// The tangential spring, its dashpot and the slider: each takes or holds what it was given.
#include <doctest/doctest.h>

#include <cmath>

#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/contact/rolling/twisting.hpp>
#include <silt/core/random.hpp>

#include "near.hpp"

namespace spring_slider_test {

using silt::Contact;
using silt::Random;
using silt::SpringSlider;
using silt::TangentialMemory;
using silt::Vec3;
using silt::Vec3d;

namespace {

Contact<double> flat_contact(double time_step) {
  Contact<double> c{};
  c.normal = {0, 0, 1};
  c.overlap = 1e-5, c.time_step = c.lag = time_step;
  c.R_eff = 1e-3, c.m_eff = 1e-5, c.inverse_m_eff = 1e5;
  return c;
}

/// A spring with one of the memories, and the energy in it.
template <TangentialMemory Memory>
struct Spring {
  SpringSlider<double> slider;
  Vec3d memory{0, 0, 0};

  Vec3d force(const Contact<double>& c, double normal) {
    if constexpr (Memory == TangentialMemory::Force)
      return slider.from_force(c, normal, 1.0, memory);
    else
      return slider.from_displacement(c, normal, memory);
  }
  double energy(const Contact<double>& c) const {
    return silt::stored_in<Memory>(slider, c, 0.0, 0.0, memory).tangential;
  }
};

template <TangentialMemory Memory>
void gains_only_what_it_is_given() {
  Random random(3);
  for (int run = 0; run < 100; ++run) {
    auto c = flat_contact(1e-6);
    Spring<Memory> spring{{std::pow(10, random.uniform(2, 5)), std::pow(10, random.uniform(-3, 1)),
                           random.uniform(0, 1.5)}};
    double normal = 0, given = 0, worst = 0;
    Vec3d v{0, 0, 0};
    for (int step = 0; step < 400; ++step) {
      v = 0.97 * v + 0.2 * Vec3d{random.normal(), random.normal(), 0};
      normal = std::max(0.0, 0.98 * normal + 0.02 * random.normal());
      c.tangential_velocity = v;
      const double before = spring.energy(c);
      const double work = -dot(spring.force(c, normal), v) * c.time_step;  // on the contact
      // What neither dashpot nor slider may give back, in any step.
      worst = std::min(worst, work - (spring.energy(c) - before));
      given += std::abs(work);
    }
    CHECK(worst > -1e-13 * given);  // rounding
    // Released slowly, under a normal force that lets it stick, it gives back what it holds, less
    // c v over the spring's force: 1e-3 at this speed.
    const double held = spring.energy(c);
    const Vec3d T =
        spring.force(c, 1e30) + spring.slider.tangential_damping(c) * c.tangential_velocity;
    const double size = norm(T), stretch = size / spring.slider.stiffness;
    c.time_step = c.lag = 1e-3 * stretch;  // [s] at 1 m/s in units of the stretch
    if (held <= 0) continue;
    const double start = spring.energy(c);
    spring.slider.damping = 0;
    c.tangential_velocity = (1 / size) * T;
    double back = 0;
    for (int step = 0; step < 1000; ++step)
      back += dot(spring.force(c, 1e30), c.tangential_velocity) * c.time_step;
    CHECK(back == near(start).epsilon(2e-3));  // the sum of 1000 steps
    CHECK(spring.energy(c) < 1e-4 * start);
  }
}

}  // namespace

TEST_CASE("spring_slider: no history makes energy, and a release gives back what is stored") {
  gains_only_what_it_is_given<TangentialMemory::Force>();
  gains_only_what_it_is_given<TangentialMemory::Displacement>();
}

TEST_CASE("spring_slider: a sliding contact charges its spring through the dashpot") {
  // A spring and a dashpot side by side under a constant force F: T = F (1 - exp(-S t/c)); what the
  // spring holds in the end, F^2/(2 S), the dashpot has taken too. The slider takes the rest.
  auto c = flat_contact(1e-7);
  c.lag = 0;  // c_t as it is
  const double S = 1e4, damping = 0.5, mu = 0.4, Fn = 2, F = mu * Fn, tau = damping / S;
  c.tangential_velocity = {3, 0, 0};
  Spring<TangentialMemory::Force> spring{{S, damping, mu}};
  double work = 0, damped = 0;
  const int steps = 5000;  // 10 tau
  for (int step = 1; step <= steps; ++step) {
    const Vec3d f = spring.force(c, Fn);
    CHECK(f.x == near(-F).epsilon(1e-12));
    const double T = -F * (1 - std::exp(-step * c.time_step / tau));
    CHECK(std::abs(spring.memory.x - T) < 2e-3 * F);  // implicit: some dt/(2 tau) = 1e-3
    work -= f.x * 3 * c.time_step;
    damped += std::pow(f.x - spring.memory.x, 2) / damping * c.time_step;
  }
  CHECK(work == near(F * 3 * steps * c.time_step));
  CHECK(spring.energy(c) == near(F * F / (2 * S)).epsilon(1e-4));
  CHECK(damped == near(F * F / (2 * S)).epsilon(2e-3));
}

TEST_CASE("spring_slider: what has slid far still pulls against the sliding as it lets go") {
  // Hertz and Mindlin, both memories: a normal force that comes and goes while v stays; friction
  // never pushes along v. (With T = F_t + c_t v while it slides it did, from displacements.)
  const auto run = [](auto law, double restitution) {
    using Law = decltype(law);
    auto c = flat_contact(1e-6);
    const typename Law::Material m{1e7, 0.25, restitution, 0.1};
    const auto p = Law::mix(m, m, Law::like(m));
    typename Law::template History<double> h{};
    c.tangential_velocity = {3, 0, 0};
    double along = 0;
    for (int step = 1; step < 300; ++step) {
      c.overlap = 4e-5 * std::sin(M_PI * step / 300);
      c.normal_velocity = -4e-5 * M_PI / 300e-6 * std::cos(M_PI * step / 300);
      along = std::max(along, Law::force(c, p, h).tangential.x);
    }
    return along;
  };
  using silt::DampingEnd;
  for (const double e : {0.3, 0.5, 0.8}) {
    CHECK(run(silt::HertzMindlin{}, e) <= 0);
    CHECK(run(silt::BasicHertzMindlin<DampingEnd::ZeroForce, TangentialMemory::Displacement>{},
              e) <= 0);
  }
}

TEST_CASE("spring_slider: a lane at the limit does not depend on whether another one slides") {
  // Narrow packs leave the slider out where no lane slides. Where a trial force is the limit but
  // for rounding, its lane must get the same bits either way: without the margin of that look it
  // fails. All lanes but the first have one and the same trial force, as any other above the limit
  // would make them look alike; packs of four, which these compile flags may not have as default.
#if defined(__AVX__) && !defined(SILT_NO_SIMD)
  constexpr std::size_t W = 4;
#else
  constexpr std::size_t W = silt::Lanes<silt::DefaultArch>::width;
#endif
  using Batch = silt::PackOf<W>::type;
  Random random(7);
  const double stiffness = 1e3, friction = 0.4;
  Contact<Batch> c{};
  const Batch none(0), one(1);
  c.normal = {none, none, one}, c.turn = c.tangential_velocity = {none, none, none};
  c.overlap = Batch(1e-5), c.time_step = c.lag = Batch(1e-6);
  c.inverse_m_eff = Batch(1e5), c.slip_mobility = Batch(3.5);
  for (int run = 0; run < 4000; ++run) {
    // Of one in forty of these the product of roundings is less than 1 within the limit.
    const double normal = random.uniform(0.005, 0.05), damping = random.uniform(0.01, 1);
    const double limit = friction * normal;
    const double angle = random.uniform(0, 6.2), size = limit * (1 + 1e-15 * random.normal());
    alignas(64) double x[W], y[W];
    for (std::size_t w = 0; w < W; ++w)
      x[w] = size / stiffness * std::cos(angle), y[w] = size / stiffness * std::sin(angle);
    alignas(64) double found[2][3][W];
    for (int slides = 0; slides < 2; ++slides) {
      x[0] = slides ? 1.0 : 0.0, y[0] = 0;
      Vec3<Batch> slip{silt::load<Batch>(x), silt::load<Batch>(y), none};
      const SpringSlider<Batch> slider{Batch(stiffness), Batch(damping), Batch(friction)};
      const auto f = slider.from_displacement(c, Batch(normal), slip);
      silt::store(found[slides][0], f.x), silt::store(found[slides][1], f.y);
      silt::store(found[slides][2], slip.x);
    }
    for (int k = 0; k < 3; ++k)
      for (std::size_t w = 1; w < W; ++w) REQUIRE(found[0][k][w] == found[1][k][w]);
  }
}

TEST_CASE("rolling and twisting springs that soften make no energy") {
  // Loaded while the contact is deep, kept as it opens, its limit far away: Hertz.
  silt::RollingContact<double> c{};
  c.normal = {0, 0, 1}, c.R_eff = 1e-3, c.inertia_eff = 1e-12, c.time_step = 1e-6;
  c.normal_force = 1;
  silt::RollingEpsd::History<double> rolling{};
  silt::Twisting::History<double> twisting{};
  const auto roll = silt::RollingEpsd::mix({.rolling_friction = 0.5, .damping = 0});
  const auto twist = silt::Twisting::mix({.twisting_friction = 0.5, .damping = 0});
  double work = 0, most = 0, last = 2e-6;
  for (int step = 0; step < 400; ++step) {
    c.overlap = step < 200 ? 2e-6 : 2e-6 * (401 - step) / 201.0;
    c.normal_stiffness = 1e6 * std::sqrt(c.overlap);
    c.unloading = std::sqrt(c.overlap / last), c.shrinking = c.overlap / last, last = c.overlap;
    const bool turns = step < 200;
    c.angular_velocity = {turns ? 1.0 : 0.0, 0, 0}, c.twist = turns ? 1.0 : 0.0;
    const Vec3d M =
        silt::RollingEpsd::torque(c, roll, rolling) + silt::Twisting::torque(c, twist, twisting);
    work -= (M.x * c.angular_velocity.x + M.z * c.twist) * c.time_step;
    const double held =
        silt::RollingEpsd::stored(c, roll, rolling) + silt::Twisting::stored(c, twist, twisting);
    most = std::max(most, held / work);
  }
  CHECK(most <= 1);
  CHECK(most > 0.9);  // it holds what it was given before it opens
}

}  // namespace spring_slider_test
