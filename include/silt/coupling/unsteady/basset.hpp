// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include <silt/core/dyn_array.hpp>
#include <silt/core/error.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/storage.hpp>

namespace silt::inline SILT_TARGET {

/// Basset's history integral by the window method, for a fixed time step:
///
///   I(t) = int_-inf^t g(s)/sqrt(t - s) ds + W(0)/sqrt(t - t0),  g = dW/dt                     (1)
///   window:  sum over the last N steps, g linear in each: exact for such g                     (2)
///   tail:    1/sqrt(t) ~ sum_i a_i sqrt(e/t_i) exp(-t/(2 t_i)) for t > t_win = N dt            (3)
///            which needs one number per term: F_i <- e^-x F_i + part that left the window,
///            x = dt/(2 t_i)
///
/// The force is basset_coefficient() times I, W the slip [m/s] (fluid minus particle).
///
/// Source: M. A. T. van Hinsberg, J. H. M. ten Thije Boonkkamp, H. J. H. Clercx, J. Comput. Phys.
///         230 (2011) 1465.
/// Errors: kernel of the tail: 0.07 % up to 3 t_win, 0.3 % to 10, 0.7 % to 100, 3.4 % to 1000; (2):
///         of order dt^2 for smooth g. N = 10 to 30 with at least 20 steps per period are
///         sufficient. InputError for a step or a window out of range.
/// Tests:  tests/coupling/unsteady.cpp.
struct BassetKernel {
  static constexpr std::size_t terms = 10;

  double dt;                               // [s]
  std::size_t steps;                       // N
  DynArray<double> weight;                 // [s^1/2] of g_0 (now) ... g_N in (2)
  DynArray<double> first_weight;           // of g_k without a predecessor
  std::array<double, terms> decay;         // [-] e^-x
  std::array<double, terms> newer, older;  // [s^1/2] of g_N and g_N+1 in (3)
  std::array<double, terms> at_window;     // [s^-1/2] terms of (3) at t_win

  BassetKernel(double time_step, std::size_t window_steps) : dt(time_step), steps(window_steps) {
    require_positive("BassetKernel: time step", dt, "s");
    require(steps >= 1 && steps <= 10000, "BassetKernel: window_steps = ", steps,
            " [-] must be in [1, 10000]");
    const auto power = [](double k) { return k * std::sqrt(k); };
    const double scale = std::sqrt(dt);
    weight.resize(steps + 1), first_weight.resize(steps + 1);
    for (std::size_t n = 1; n <= steps; ++n) {
      const auto k = static_cast<double>(n);
      weight[n] = scale * 4 / 3 * (power(k + 1) - 2 * power(k) + power(k - 1));
      first_weight[n] = scale * (2 * std::sqrt(k) - 4.0 / 3 * (power(k) - power(k - 1)));
    }
    weight[0] = scale * 4 / 3, first_weight[0] = 0;
    weight[steps] = first_weight[steps];
    static constexpr double a[terms]{
        .23477481312586, .28549576238194, .28479416718255, .26149775537574, .32056200511938,
        .35354490689146, .39635904496921, .42253908596514, .48317384225265, .63661146557001};
    static constexpr double time[terms]{.1, .3, 1, 3, 10, 40, 190, 1000, 6500, 50000};
    for (std::size_t i = 0; i < terms; ++i) {
      const double t = time[i] * window(), x = dt / (2 * t);
      decay[i] = std::exp(-x);
      at_window[i] = a[i] * std::sqrt(std::exp(1) / t) * std::exp(-0.5 / time[i]);
      newer[i] = at_window[i] * 2 * t * leaving(x).first;
      older[i] = at_window[i] * 2 * t * leaving(x).second;
    }
  }

  double window() const { return static_cast<double>(steps) * dt; }  // [s]

  /// The sum of (3) [s^-1/2], near 1/sqrt(t) for t >= t_win.
  double tail(double t) const {
    double sum = 0;
    for (std::size_t i = 0; i < terms; ++i)
      sum += at_window[i] * std::pow(decay[i], (t - window()) / dt);
    return sum;
  }

 private:
  /// 1 - f and f - e^-x with f = (1 - e^-x)/x; by series where they would cancel.
  static std::pair<double, double> leaving(double x) {
    if (x > 0.5) {
      const double f = -std::expm1(-x) / x;
      return {1 - f, f - std::exp(-x)};
    }
    double term = 1, first = 0, second = 0;  // (-x)^k/(k + 1)!
    for (int k = 1; k <= 16; ++k) {
      term *= -x / (k + 1);
      first -= term, second -= k * term;
    }
    return {first, second};
  }
};

/// History of many particles; each row of memory is one quantity of all. The window and the tail
/// take 3 (N + 12) numbers per particle (N = 10: 528 bytes in double, 264 in float). All have the
/// same step; particles may start at any step.
///
/// In a step: advance(); then for every particle its g at the new time from past(i) and newest(),
/// and record(i, g). The integral is past(i) + newest() g. As g contains -dv/dt, add newest() times
/// basset_coefficient() to the mass, as with the virtual mass.
template <class Scalar = double>
class BassetHistory {
 public:
  explicit BassetHistory(const BassetKernel& kernel, std::size_t particles = 0)
      : kernel_(kernel), slots_(kernel.steps + 1) {
    resize(particles);
  }

  const BassetKernel& kernel() const { return kernel_; }
  std::size_t size() const { return size_; }
  std::size_t bytes_per_particle() const { return rows() * sizeof(Scalar); }

  /// Keeps the first ones; new ones have no history, as if they had always moved with the fluid.
  void resize(std::size_t particles) {
    const std::size_t stride = (particles + block - 1) / block * block;
    if (stride != stride_) {
      AlignedVector<Scalar> fresh(rows() * stride);
      for (std::size_t r = 0; r < rows(); ++r)
        for (std::size_t i = 0; i < std::min(size_, particles); ++i)
          fresh[r * stride + i] = values_[r * stride_ + i];
      values_.swap(fresh), stride_ = stride;
    }
    for (std::size_t i = size_; i < particles; ++i) clear(i);
    erase_if(young_, [&](const Young& y) { return y.particle >= particles; });
    size_ = particles;
  }

  /// Starts particle i with the slip W [m/s] and its rate g [m/s2], without a history.
  void start(std::size_t i, const Vec3d& W, const Vec3d& g) {
    check(i);
    clear(i);
    erase_if(young_, [&](const Young& y) { return y.particle == i; });
    young_.push_back({i, 0, W, g});
    put(slot_row(0), i, g);
  }
  /// Starts particle i with the slip W, with the mean of g in each step as the recorded value:
  /// past(i) + newest() g is then the mean of the integral over the step, exact within the window
  /// for g constant in each step. Its first step has the length `first` [-] of a step; the value
  /// recorded after it is the change of the slip over a whole step.
  void start_mean(std::size_t i, const Vec3d& W, double first = 1) {
    start(i, W, {0, 0, 0});
    young_.back().mean = true, young_.back().first = first;
  }

  /// Complete state, for the same kernel and number of particles.
  DynArray<double> state() const {
    DynArray<double> all{static_cast<double>(young_.size())};
    for (std::size_t k = 0; k < slots_; ++k) append_row(all, slot_row(k));
    for (std::size_t i = 0; i <= terms; ++i) append_row(all, tail_row(i));  // the last is past
    for (const Young& y : young_)
      all.insert(all.end(),
                 {static_cast<double>(y.particle), static_cast<double>(y.age), y.slip.x, y.slip.y,
                  y.slip.z, y.rate.x, y.rate.y, y.rate.z, double(y.mean), y.first});
    return all;
  }
  void restore(std::span<const double> all) {
    constexpr std::size_t of_young = 10;
    const std::size_t of_rows = rows() * size_;
    const bool whole = !all.empty() && all.size() > of_rows &&
                       all[0] == static_cast<double>((all.size() - 1 - of_rows) / of_young) &&
                       (all.size() - 1 - of_rows) % of_young == 0;
    require(whole, "BassetHistory: a state of ", all.size(), " numbers does not match ", size_,
            " particles and a window of ", kernel_.steps, " steps");
    const double* next = all.data() + 1;
    for (const double* young = next + of_rows; young < all.data() + all.size(); young += of_young)
      require(young[0] >= 0 && young[0] < static_cast<double>(size_) &&
                  young[0] == std::floor(young[0]) && young[1] >= 0 &&
                  young[1] < static_cast<double>(kernel_.steps) &&
                  young[1] == std::floor(young[1]) && young[9] > 0 && young[9] <= 1,
              "BassetHistory: a state with particle ", young[0], " of ", size_, ", new since ",
              young[1], " of ", kernel_.steps, " steps, the first ", young[9], " of a step long");
    head_ = 0;
    for (std::size_t r = 0; r < rows(); ++r, next += size_)
      std::transform(next, next + size_, &values_[r * stride_],
                     [](double v) { return static_cast<Scalar>(v); });
    young_.clear();
    for (const double* end = all.data() + all.size(); next < end; next += of_young)
      young_.push_back({static_cast<std::size_t>(next[0]),
                        static_cast<std::size_t>(next[1]),
                        {next[2], next[3], next[4]},
                        {next[5], next[6], next[7]},
                        next[8] != 0,
                        next[9]});
  }

  /// Particle `to` becomes a copy of `from`: to fill a gap before a resize().
  void copy(std::size_t from, std::size_t to) {
    check(from), check(to);
    if (from == to) return;
    for (std::size_t r = 0; r < rows(); ++r)
      values_[r * stride_ + to] = values_[r * stride_ + from];
    erase_if(young_, [&](const Young& y) { return y.particle == to; });
    for (std::size_t k = 0, n = young_.size(); k < n; ++k)
      if (Young y = young_[k]; y.particle == from) y.particle = to, young_.push_back(y);
  }

  /// Advances by one dt; the newest g of every particle is 0 until it is recorded.
  void advance() {
    advance([](std::size_t blocks, const auto& one) {
      for (std::size_t b = 0; b < blocks; ++b) one(b);
    });
  }
  /// The same with a loop of the caller: loop(n, one) calls one(0) ... one(n - 1), in any order,
  /// possibly in parallel.
  template <class Loop>
  void advance(const Loop& loop) {
    head_ = (head_ + slots_ - 1) % slots_;
    loop((size_ + block - 1) / block, [this](std::size_t b) {
      for (std::size_t axis = 0; axis < 3; ++axis) advance_block(b * block, axis);
    });
    correct_young();
  }

  /// [m/s^(3/2)] Part of the integral without the newest g.
  Vec3d past(std::size_t i) const {
    const Scalar* p = &values_[past_row() * stride_ + i];
    return {p[0], p[stride_], p[2 * stride_]};
  }
  double newest() const { return kernel_.weight[0]; }  // [s^1/2]
  void record(std::size_t i, const Vec3d& g) { put(slot_row(0), i, g); }

  /// (1) [m/s^(3/2)] with the newest g.
  Vec3d integral(std::size_t i) const {
    const Scalar* p = &values_[slot_row(0) * stride_ + i];
    return past(i) + newest() * Vec3d{p[0], p[stride_], p[2 * stride_]};
  }

 private:
  static constexpr std::size_t block = 256, terms = BassetKernel::terms;
  using Real = typename Lanes<DefaultArch, Scalar>::Real;
  static constexpr std::size_t width = Lanes<DefaultArch, Scalar>::width;

  /// A particle that started within the window.
  struct Young {
    std::size_t particle, age;  // [-], [steps]
    Vec3d slip, rate;           // at its beginning
    bool mean = false;          // of steps, from start_mean()
    double first = 1;           // [-] length of its first step
  };

  // Rows: slots of g, terms of the tail, past; x, y, z of each.
  std::size_t rows() const { return 3 * (slots_ + terms + 1); }
  std::size_t slot_row(std::size_t k) const { return 3 * ((head_ + k) % slots_); }
  std::size_t tail_row(std::size_t i) const { return 3 * (slots_ + i); }
  std::size_t past_row() const { return 3 * (slots_ + terms); }

  void check(std::size_t i) const {
    require(i < size_, "BassetHistory: particle ", i, " of ", size_, "; resize() first");
  }
  void put(std::size_t row, std::size_t i, const Vec3d& v) {
    Scalar* p = &values_[row * stride_ + i];
    p[0] = static_cast<Scalar>(v.x);
    p[stride_] = static_cast<Scalar>(v.y);
    p[2 * stride_] = static_cast<Scalar>(v.z);
  }
  void add(std::size_t row, std::size_t i, const Vec3d& v) {
    const Scalar* p = &values_[row * stride_ + i];
    put(row, i, Vec3d{p[0], p[stride_], p[2 * stride_]} + v);
  }
  void append_row(DynArray<double>& to, std::size_t r) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Scalar* p = &values_[(r + axis) * stride_];
      to.insert(to.end(), p, p + size_);
    }
  }
  void clear(std::size_t i) {
    for (std::size_t r = 0; r < rows(); ++r) values_[r * stride_ + i] = 0;
  }

  void advance_block(std::size_t first, std::size_t axis) {
    const auto row = [&](std::size_t r) { return &values_[(r + axis) * stride_ + first]; };
    const auto lanes = [](double x) { return Real(static_cast<Scalar>(x)); };
    Scalar *sum = row(past_row()), *oldest = row(slot_row(0));  // still g_N+1
    const Scalar* last = row(slot_row(kernel_.steps));
    for (std::size_t j = 0; j < block; j += width) store<Real>(sum + j, Real(Scalar(0)));
    for (std::size_t i = 0; i < terms; ++i) {
      const Real e = lanes(kernel_.decay[i]), n = lanes(kernel_.newer[i]),
                 o = lanes(kernel_.older[i]);
      Scalar* F = row(tail_row(i));
      for (std::size_t j = 0; j < block; j += width) {
        const Real now =
            e * load<Real>(F + j) + n * load<Real>(last + j) + o * load<Real>(oldest + j);
        store<Real>(F + j, now);
        store<Real>(sum + j, load<Real>(sum + j) + now);
      }
    }
    for (std::size_t k = 1; k <= kernel_.steps; ++k) {
      const Real w = lanes(kernel_.weight[k]);
      const Scalar* g = row(slot_row(k));
      for (std::size_t j = 0; j < block; j += width)
        store<Real>(sum + j, load<Real>(sum + j) + w * load<Real>(g + j));
    }
    for (std::size_t j = 0; j < block; j += width) store<Real>(oldest + j, Real(Scalar(0)));
  }

  /// Removes the ramp of g before a particle's start, and adds the jump of its slip; both move to
  /// the tail when they leave the window.
  void correct_young() {
    for (auto& y : young_) {
      const std::size_t k = ++y.age;
      const auto age = static_cast<double>(k);
      const double late = age - 1 + y.first;  // at the end of the step
      const double root = !y.mean  ? 1 / std::sqrt(age)
                          : k == 1 ? 2 / std::sqrt(late)
                                   : 2 * (std::sqrt(late) - std::sqrt(late - 1));
      const Vec3d jump = y.slip * (root / std::sqrt(kernel_.dt));
      if (k < kernel_.steps && y.mean)
        add(past_row(), y.particle, jump + short_first_step(y));
      else if (k < kernel_.steps)
        add(past_row(), y.particle, jump - y.rate * (kernel_.weight[k] - kernel_.first_weight[k]));
      else
        leave_window(y, jump);
    }
    erase_if(young_, [&](const Young& y) { return y.age >= kernel_.steps; });
  }

  /// Difference of the effect of g in a shorter first step to that of the same change of the slip
  /// in a whole step.
  Vec3d short_first_step(Young& y) const {
    if (y.first == 1 || y.age < 2) return {0, 0, 0};
    if (y.age == 2) {
      const Scalar* g = &values_[slot_row(1) * stride_ + y.particle];
      y.rate = {g[0], g[stride_], g[2 * stride_]};
    }
    const auto power = [](double k) { return k * std::sqrt(k); };
    const double k = static_cast<double>(y.age), late = k - 1 + y.first;
    const double weight = power(late) - power(late - 1) - power(k - 1) + power(k - 2);
    return y.rate * (std::sqrt(kernel_.dt) * 4 / 3 * weight / y.first - kernel_.weight[y.age - 1]);
  }

  void leave_window(const Young& y, const Vec3d& jump) {
    for (std::size_t i = 0; i < terms; ++i) {
      const double x = -std::log(kernel_.decay[i]);
      const double mean = y.mean ? std::exp((1 - y.first) * x) * std::expm1(x) / x : 1;
      Vec3d change = y.slip * (mean * kernel_.at_window[i]);
      if (!y.mean) change -= y.rate * kernel_.newer[i];
      add(tail_row(i), y.particle, change);
      if (!y.mean) add(past_row(), y.particle, change);
    }
    if (y.mean) add(past_row(), y.particle, jump);
  }

  BassetKernel kernel_;
  std::size_t slots_, head_ = 0, size_ = 0, stride_ = 0;
  AlignedVector<Scalar> values_;
  DynArray<Young> young_;
};

}  // namespace silt
