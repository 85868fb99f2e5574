// silt - BSD-3-Clause, see LICENSE
#include "verification/maw_barber_fawcett.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <silt/contact/formulas.hpp>
#include <silt/core/eigen.hpp>

namespace verification {
namespace maw_barber_fawcett_cases {

constexpr double pi = std::numbers::pi;

/// The contact circle, in units E* = R = m = v_n = mu = 1.
class Circle {
 public:
  Circle(double G, double largest, int rings)
      : G_(G),
        rings_(static_cast<std::size_t>(rings)),
        moves_(rings_ * rings_),
        shape_(rings_ * rings_),
        u_(rings_, 0),
        state_(rings_, 0) {
    h_ = largest / rings * (1 + 1e-9);
    for (std::size_t i = 0; i < rings_; ++i) {
      edge_.push_back(0);
      middle_.push_back(h_ * (static_cast<double>(i) + 0.5));
    }
    for (std::size_t i = 0; i < rings_; ++i) set_circle(i, edge_of(i));
  }

  /// The shear force after a relative displacement dx of the bodies, under the normal force `load`
  /// on a circle of this radius.
  double force_after(double dx, double load, double radius) {
    std::size_t n = 0;
    while (n < rings_ && middle_[n] < radius) ++n;
    if (n == 0) {
      std::fill(u_.begin(), u_.end(), 0);
      return 0;
    }
    // The outermost circle equals that of the contact: sliding everywhere is then exact.
    if (n - 1 != outermost_) set_circle(outermost_, edge_of(outermost_));
    outermost_ = n - 1;
    set_circle(outermost_, radius);
    std::vector<double> limit(n);  // mu p
    for (std::size_t j = 0; j < n; ++j)
      limit[j] = 1.5 * load / (pi * radius * radius) *
                 std::sqrt(1 - middle_[j] * middle_[j] / (radius * radius));
    std::vector<double> q;
    for (int attempt = 0; attempt < 200; ++attempt) {
      q = tractions(n, dx, limit);
      if (!changed(q, n, dx, limit)) break;
    }
    double force = 0;
    for (std::size_t i = 0; i < n; ++i) force += 2.0 / 3 * pi * edge_[i] * edge_[i] * q[i];
    std::vector<double> moved(rings_);
    for (std::size_t j = 0; j < rings_; ++j) moved[j] = sum(moves_, j, q);
    u_ = moved;
    return force;
  }

 private:
  double edge_of(std::size_t i) const { return h_ * static_cast<double>(i + 1); }
  /// Effect of the i-th circle at the middle of each ring if its radius is a.
  void set_circle(std::size_t i, double a) {
    edge_[i] = a;
    for (std::size_t j = 0; j < rings_; ++j) {
      const double r = middle_[j], rest = 2 * a * a - r * r;
      const bool inside = r < a;
      moves_[j * rings_ + i] =
          inside ? pi * rest / (16 * G_ * a)
                 : (rest * std::asin(a / r) + a * std::sqrt(r * r - a * a)) / (8 * G_ * a);
      shape_[j * rings_ + i] = inside ? std::sqrt(1 - r * r / (a * a)) : 0;
    }
  }
  double sum(const std::vector<double>& matrix, std::size_t j, const std::vector<double>& q) const {
    double out = 0;
    for (std::size_t i = 0; i < q.size(); ++i) out += matrix[j * rings_ + i] * q[i];
    return out;
  }
  std::vector<double> tractions(std::size_t n, double dx, const std::vector<double>& limit) const {
    const auto size = static_cast<Eigen::Index>(n);
    Eigen::MatrixXd A(size, size);
    Eigen::VectorXd b(size);
    for (std::size_t j = 0; j < n; ++j) {
      const auto& matrix = state_[j] == 0 ? moves_ : shape_;
      const auto row = static_cast<Eigen::Index>(j);
      for (std::size_t i = 0; i < n; ++i)
        A(row, static_cast<Eigen::Index>(i)) = matrix[j * rings_ + i];
      b[row] = state_[j] == 0 ? u_[j] + dx : state_[j] * limit[j];
    }
    const Eigen::VectorXd q = A.partialPivLu().solve(b);
    return {q.begin(), q.end()};
  }
  /// Changes rings beyond the limit from stick to slip; if there are none, changes rings that slip
  /// in the direction of their traction to stick.
  bool changed(const std::vector<double>& q, std::size_t n, double dx,
               const std::vector<double>& limit) {
    bool any = false;
    for (std::size_t j = 0; j < n; ++j) {
      if (state_[j] != 0) continue;
      const double traction = sum(shape_, j, q);
      if (std::abs(traction) <= limit[j] * (1 + 1e-9)) continue;
      state_[j] = traction > 0 ? 1 : -1;
      any = true;
    }
    if (any) return true;
    for (std::size_t j = 0; j < n; ++j) {
      const double slip = dx - (sum(moves_, j, q) - u_[j]);
      if (state_[j] * slip >= -1e-14) continue;
      state_[j] = 0;
      any = true;
    }
    return any;
  }

  double G_, h_ = 0;
  std::size_t rings_, outermost_ = 0;
  std::vector<double> moves_, shape_;  // u and q in the middle of ring j by q_i = 1
  std::vector<double> edge_, middle_;  // [-]
  std::vector<double> u_;              // of the surface
  std::vector<int> state_;             // 0 sticks, else the sign of the traction that slips
};

}  // namespace maw_barber_fawcett_cases

double maw_barber_fawcett(double stiffness_ratio, double incidence, int rings) {
  using namespace maw_barber_fawcett_cases;
  const double kH = 4.0 / 3, deepest = std::pow(1.25 / kH, 0.4);
  const double dt = silt::hertz_time_factor * deepest / (10 * rings);
  Circle circle(stiffness_ratio / 4, std::sqrt(deepest), rings);
  double overlap = 0, approach = 1, speed = incidence;
  for (;;) {
    overlap += approach * dt;
    if (overlap <= 0) return speed;
    const double load = kH * overlap * std::sqrt(overlap);
    // For a solid sphere and a plane, the tangential effective mass is 2/7 of the mass.
    speed -= 3.5 * circle.force_after(speed * dt, load, std::sqrt(overlap)) * dt;
    approach -= load * dt;
  }
}

}  // namespace verification
