// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include <silt/core/error.hpp>
#include <silt/core/vec3.hpp>
#include <silt/simulation.hpp>

namespace silt::inline SILT_TARGET {

/// Samples of a mixture: cubes.
struct MixingOptions {
  double side = 0;        // [m] of a cube; about 15 to 100 particles in each are usual
  Vec3d corner{0, 0, 0};  // [m] of one of them
  std::size_t least = 1;  // [-] particles of a sample; cubes with fewer are left out
};

/// How well two kinds of particles are mixed, by number.
struct Mixing {
  double lacey = 0;                // [-] Lacey's index: 0 unmixed, 1 as random mixtures in the mean
  double lacey_scatter = 0;        // [-] standard deviation of the index over random mixtures
  double relative_deviation = 0;   // [-] standard deviation of the share over its mean
  double share = 0;                // [-] of the first kind in all samples
  double variance = 0;             // [-] of the share over samples, S^2
  double unmixed = 0, random = 0;  // [-] S0^2 and SR^2
  std::size_t particles = 0, samples = 0;
};

/// Lacey's index of mixing and the relative standard deviation of two kinds of particles, from
/// samples: all particles with their centre in one of the cubes of a grid.
///
///   M = (S0^2 - S^2)/(S0^2 - SR^2),   RSD = S/p                                               (1)
///   S0^2 = p (1 - p),   S^2 = sum n_i (p_i - p)^2/N,   SR^2 = p (1 - p) (k - 1)/(N - 1)       (2)
///
/// p: share of the first kind among all N particles; p_i: in sample i of k, which has n_i. SR^2 is
/// the mean of S^2 where the N particles are dealt out to the k samples at random; with n particles
/// in each it is Lacey's p (1 - p)/n, less a share 1/k of it. M is 0 where no sample has both
/// kinds, 1 in the mean over random mixtures, and above 1 where particles are more regular than
/// that. Over random mixtures M scatters by about SR^2/(S0^2 - SR^2) sqrt(2/(k - 1)), and RSD is
/// about sqrt(SR^2)/p. Both depend on the size of the samples: compare at equal `side`.
///
/// Source: P.M.C. Lacey, J. Appl. Chem. 4 (1954) 257 (recalled), with the weights n_i and the
///         finite number of particles of (2), derived here.
/// Valid:  two kinds of about equal size; shares are by number. N > k > 1 samples, both kinds
///         present.
/// Units:  [m], [-].
/// Errors: InputError naming the field and its unit; if there are too few particles or samples.
/// Tests:  tests/measure/mixing.cpp.
class MixingSamples {
 public:
  explicit MixingSamples(const MixingOptions& options) : options_(options) {
    require_positive("MixingOptions.side", options.side, "m");
    require(is_finite(options.corner), "MixingOptions.corner = ", options.corner,
            " [m] must be finite");
  }
  void add(const Vec3d& place, bool is_first) {  // [m]
    const Vec3d at = (1 / options_.side) * (place - options_.corner);
    Sample& sample = samples_[{std::floor(at.x), std::floor(at.y), std::floor(at.z)}];
    ++sample.all, sample.first += is_first ? 1 : 0;
  }
  Mixing mixing() const {
    Mixing m;
    double all = 0, first = 0;
    for_each([&](const Sample& s) { all += s.all, first += s.first, ++m.samples; });
    m.particles = static_cast<std::size_t>(all);
    require(m.samples > 1 && m.particles > m.samples, "mixing: ", m.particles, " particles in ",
            m.samples, m.samples == 1 ? " sample of " : " samples of ", options_.side,
            " m do not tell how well they are mixed; it takes two samples or more, with more than "
            "one particle each: set another MixingOptions.side, or a smaller `least`");
    const auto k = static_cast<double>(m.samples);
    m.share = first / all, m.unmixed = m.share * (1 - m.share);
    require(m.unmixed > 0, "mixing: all ", m.particles, " particles are of the ",
            first > 0 ? "first" : "second", " kind; both must be there");
    m.random = m.unmixed * (k - 1) / (all - 1);
    for_each([&](const Sample& s) {
      const double off = s.first / s.all - m.share;
      m.variance += s.all * off * off / all;
    });
    m.lacey = (m.unmixed - m.variance) / (m.unmixed - m.random);
    m.lacey_scatter = m.random / (m.unmixed - m.random) * std::sqrt(2 / (k - 1));
    m.relative_deviation = std::sqrt(m.variance) / m.share;
    return m;
  }

 private:
  struct Sample {
    double all = 0, first = 0;
  };
  template <class F>
  void for_each(const F& f) const {
    for (const auto& [place, sample] : samples_)
      if (sample.all >= static_cast<double>(options_.least)) f(sample);
  }

  MixingOptions options_;
  std::map<std::array<double, 3>, Sample> samples_;
};

/// The same for the particles of a simulation: `is_first(k)` says of the one at place k whether it
/// is of the first kind.
///
///   const auto m = silt::mixing(sim, {.side = 0.01},
///                               [&](auto k) { return sim.material(k) == 0; });
template <class Sim, class IsFirst>
Mixing mixing(const Sim& sim, const MixingOptions& options, const IsFirst& is_first) {
  detail::need_one_process<Sim>();
  MixingSamples samples(options);
  for (std::size_t k = 0; k < sim.rows(); ++k)
    if (sim.is_present(k)) samples.add(sim.position(k), is_first(k));
  return samples.mixing();
}

}  // namespace silt
