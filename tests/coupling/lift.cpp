// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include <silt/coupling/lift/magnus.hpp>
#include <silt/coupling/lift/saffman_mei.hpp>

#include "near.hpp"

namespace lift_test {

using silt::OesterleBuiDinh;
using silt::SaffmanMei;
using silt::Vec3d;

namespace {

// Values of C4 are computed in the physics reference from the same formulas by other code: air, 1
// mm, slip 1 m/s, shear 100 1/s, spin 1000 1/s. The limits are other sources.
constexpr double rho = 1.2, mu = 1.8e-5, d = 1e-3, shear = 100;
constexpr double pi = std::numbers::pi;

/// `value` rounds to `printed` of so many significant digits.
bool prints(double value, double printed, int digits) {
  const double unit = std::pow(10.0, std::floor(std::log10(printed)) + 1 - digits);
  return std::abs(value - printed) <= 0.50001 * unit;
}

}  // namespace

TEST_CASE("lift: Saffman-Mei: the values of C4, and Saffman's limit") {
  const auto factor = [](double W) {
    return SaffmanMei::factor(rho * d * W / mu, 0.5 * d * shear / W);
  };
  // Flow along x that is faster above: u = shear y, curl u = -shear along z.
  const Vec3d curl{0, 0, -shear};
  const auto lift = [&](double W) { return SaffmanMei::force(d, rho, mu, {W, 0, 0}, curl); };
  CHECK(prints(factor(1), 0.0957, 3));
  CHECK(prints(factor(0.1), 0.6274, 4));
  // Lags behind the fluid (W > 0): drifts up, to the faster; leads: down.
  CHECK(prints(lift(1).y, 7.181e-9, 4));
  CHECK(prints(-lift(-1).y, 7.181e-9, 4));
  CHECK(prints(lift(0.1).y, 4.71e-9, 3));  // 4.7095e-9
  CHECK(lift(1).x == 0);
  CHECK(lift(1).z == 0);
  // Slow and weakly sheared: 1.615 d^2 W sqrt(rho mu shear); f is 1 - Re/10 - 0.33 sqrt(b) there.
  const double tiny = 1e-3 * mu / (rho * d), weak = 1e-6 * tiny / d;
  const Vec3d slow = SaffmanMei::force(d, rho, mu, {tiny, 0, 0}, Vec3d{0, 0, -weak});
  CHECK(near_relative(slow.y, 1.615 * d * d * tiny * std::sqrt(rho * mu * weak), 5e-4));
  CHECK(norm(SaffmanMei::force(d, rho, mu, {0, 0, 0}, curl)) == 0);
  CHECK(norm(SaffmanMei::force(d, rho, mu, {1, 0, 0}, {0, 0, 0})) == 0);
  // (2) nearly joins at Re = 40: 0.0183 + 0.3253 sqrt(b) and 0.3314 sqrt(b), by b = 0.2 within 12
  // %.
  CHECK(near_relative(SaffmanMei::factor(40.0, 0.2), SaffmanMei::factor(40.0001, 0.2), 0.12));
}

TEST_CASE("lift: Magnus: the values of C4, Rubinow and Keller's limit, back spin lifts") {
  const double spin = 1000, Re = rho * d / mu, Re_spin = rho * d * d * spin / mu;
  CHECK(prints(Re, 66.67, 4));
  CHECK(prints(OesterleBuiDinh::lift_coefficient(Re_spin, Re), 0.6377, 4));
  // A ball that flies along x in still air, its top moving back: angular velocity +z, relative
  // spin of the fluid -z, W = -x. It is lifted up (y).
  const Vec3d F = OesterleBuiDinh::force(d, rho, mu, {-1, 0, 0}, {0, 0, -spin});
  CHECK(prints(F.y, 3.005e-7, 4));
  CHECK(F.x == 0);
  CHECK(F.z == 0);
  // Low Re: (pi/8) rho d^3 Omega x W; exp(-0.057 Re_R^0.4 Re^0.3) is 1 to 1e-4 here.
  const double W = 1e-4 * mu / (rho * d), slow = 2 * W / d;
  const Vec3d low = OesterleBuiDinh::force(d, rho, mu, {-W, 0, 0}, {0, 0, -slow});
  CHECK(near_relative(low.y, pi / 8 * rho * d * d * d * slow * W, 2e-4));
  CHECK(norm(OesterleBuiDinh::force(d, rho, mu, {0, 0, 0}, {0, 0, 3})) == 0);
  CHECK(norm(OesterleBuiDinh::force(d, rho, mu, {1, 0, 0}, {0, 0, 0})) == 0);
}

TEST_CASE("lift: torque: the values of C4, Stokes' limit, against the particle's own spin") {
  const Vec3d T = silt::rotational_torque(d, rho, mu, {0, 0, 1000});
  CHECK(prints(T.z, 6.574e-11, 4));
  const double Re_spin = rho * d * d * 1000 / mu;
  CHECK(prints(64 * pi / Re_spin * silt::rotational_drag(Re_spin), 3.506, 4));
  const Vec3d slow = silt::rotational_torque(d, rho, mu, {0, -3, 0});
  CHECK(near_relative(slow.y, -pi * mu * d * d * d * 3, 1e-15));
  // C_R at 32: 2 pi below and 12.9/sqrt(32) + 128.4/32 = 6.293 above.
  CHECK(near_relative(silt::rotational_drag(32.0), silt::rotational_drag(32.00001), 0.002));
}

TEST_CASE("lift: lanes of double and float equal doubles") {
  const auto compare = [](auto zero, double allowed) {
    using Scalar = decltype(zero);
    using Pack = typename silt::Lanes<silt::DefaultArch, Scalar>::Real;
    constexpr std::size_t width = silt::Lanes<silt::DefaultArch, Scalar>::width;
    for (const double W : {0.0, 1e-3, 0.3, 0.9, 3.0})
      for (const double w : {0.0, 1e-2, 30.0, 1000.0}) {
        const auto one = [](auto x) { return Pack(static_cast<Scalar>(x)); };
        const silt::Vec3<Pack> slip{one(W), one(0.5 * W), one(0)}, curl{one(0), one(w), one(-w)};
        const Vec3d slip1{W, 0.5 * W, 0}, curl1{0, w, -w};
        const auto check = [&](const silt::Vec3<Pack>& got, const Vec3d& want) {
          alignas(64) Scalar x[width], y[width], z[width];
          silt::store(x, got.x), silt::store(y, got.y), silt::store(z, got.z);
          for (std::size_t k = 0; k < width; ++k)
            CHECK(norm(Vec3d{x[k], y[k], z[k]} - want) <= allowed * norm(want));
        };
        check(SaffmanMei::force(one(d), one(rho), one(mu), slip, curl),
              SaffmanMei::force(d, rho, mu, slip1, curl1));
        check(OesterleBuiDinh::force(one(d), one(rho), one(mu), slip, curl),
              OesterleBuiDinh::force(d, rho, mu, slip1, curl1));
        check(silt::rotational_torque(one(d), one(rho), one(mu), curl),
              silt::rotational_torque(d, rho, mu, curl1));
      }
  };
  compare(1.0, 1e-13);
  compare(1.0f, 3e-6);
}

}  // namespace lift_test
