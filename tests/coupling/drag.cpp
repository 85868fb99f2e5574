// silt - BSD-3-Clause, see LICENSE
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>

#include <silt/coupling/drag/laws.hpp>

#include "near.hpp"

namespace drag_test {

// The table is C2 of the physics reference, computed there from the laws' formulas by other code.

namespace {

using silt::Beetstra;
using silt::DiFelice;
using silt::Ergun;
using silt::FreeStream;
using silt::Gidaspow;
using silt::HuilinGidaspow;
using silt::KochHill;
using silt::Rong;
using silt::SchillerNaumann;
using silt::Stokes;
using silt::Tenneti;
using silt::WenYu;

/// In the table's order.
using Laws = std::tuple<WenYu, Ergun, Gidaspow, HuilinGidaspow, DiFelice, Rong, Beetstra, KochHill,
                        Tenneti, FreeStream>;
constexpr const char* names[] = {"WenYu", "Ergun",    "Gidaspow", "HuilinGidaspow", "DiFelice",
                                 "Rong",  "Beetstra", "KochHill", "Tenneti",        "FreeStream"};

constexpr struct {
  double eps, Re, Fhat[10];
} table[] = {
    {0.4,
     0.1,
     {29.2194, 31.3108, 31.3108, 31.3044, 30.1028, 30.4117, 37.8460, 37.5492, 34.5713, 6.2500}},
    {0.4,
     1,
     {32.5971, 31.8576, 31.8576, 31.8599, 30.0463, 30.5584, 37.8654, 37.9920, 35.4540, 7.1875}},
    {0.4,
     10,
     {49.0263, 37.3264, 37.3264, 37.3619, 33.7229, 34.7564, 41.1945, 42.4202, 40.4556, 10.8101}},
    {0.4,
     100,
     {128.9393, 92.0139, 92.0139, 92.1258, 90.0628, 92.8229, 89.7894, 86.7025, 71.8668, 28.4305}},
    {0.4,
     500,
     {332.2691, 335.0694, 335.0694, 335.0610, 329.9467, 336.8725, 264.2308, 283.5125, 177.9922,
      73.2637}},
    {0.5,
     0.1,
     {12.9405, 16.7056, 16.7056, 16.6903, 13.2681, 15.9386, 20.5153, 20.0229, 18.7990, 4.0000}},
    {0.5,
     1,
     {14.4363, 17.0556, 17.0556, 17.0450, 13.7935, 15.8215, 20.5387, 20.2289, 19.3462, 4.6000}},
    {0.5,
     10,
     {21.7124, 20.5556, 20.5556, 20.5602, 16.7860, 17.5645, 22.7740, 22.2892, 22.3706, 6.9184}},
    {0.5,
     100,
     {57.1037, 55.5556, 55.5556, 55.5618, 44.8299, 46.9091, 50.4134, 42.8925, 40.7071, 18.1955}},
    {0.5,
     500,
     {147.1527, 211.1111, 211.1111, 210.8526, 155.0872, 173.1873, 149.0979, 134.4625, 100.7753,
      46.8888}},
    {0.6, 0.1, {6.6518, 9.2863, 9.2863, 9.2703, 6.7936, 8.8512, 11.8130, 11.1246, 10.9604, 2.7778}},
    {0.6, 1, {7.4207, 9.5293, 9.5293, 9.5165, 7.3015, 8.8523, 11.8432, 11.2462, 11.3280, 3.1944}},
    {0.6,
     10,
     {11.1608, 11.9599, 11.9599, 11.9550, 9.4929, 9.9750, 13.4643, 12.4625, 13.3038, 4.8045}},
    {0.6,
     100,
     {29.3530, 36.2654, 36.2654, 36.2235, 25.3523, 26.6400, 30.7416, 24.6247, 24.7931, 12.6358}},
    {0.6,
     500,
     {75.6409, 144.2901, 144.2901, 143.8740, 83.6928, 97.3220, 92.2796, 78.6792, 60.9767, 32.5616}},
    {0.8, 0.1, {2.3276, 2.6194, 2.3276, 2.4735, 2.3626, 2.9720, 4.1960, 4.1801, 3.9752, 1.5625}},
    {0.8, 1, {2.5967, 2.7561, 2.5967, 2.6764, 2.6761, 3.1718, 4.2490, 4.2450, 4.1669, 1.7969}},
    {0.8, 10, {3.9054, 4.1233, 3.9054, 4.0144, 3.8618, 4.0667, 5.1872, 4.8948, 5.1277, 2.7025}},
    {0.8,
     100,
     {10.2713, 17.7951, 10.2713, 14.0332, 10.3136, 10.8607, 12.9478, 11.3929, 10.0844, 7.1076}},
    {0.8,
     500,
     {26.4686, 78.5590, 26.4686, 52.5138, 31.6223, 36.2092, 40.3157, 40.2730, 23.7442, 18.3159}},
    {0.9, 0.1, {1.5143, 1.0408, 1.5143, 1.5085, 1.5332, 1.7558, 2.4326, 2.5467, 2.2956, 1.2346}},
    {0.9, 1, {1.6893, 1.1488, 1.6893, 1.6828, 1.7743, 1.9675, 2.4982, 2.5984, 2.4435, 1.4198}},
    {0.9, 10, {2.5408, 2.2291, 2.5408, 2.5370, 2.6722, 2.7789, 3.2181, 3.1160, 3.1668, 2.1353}},
    {0.9, 100, {6.6822, 13.0316, 6.6822, 6.7592, 7.1366, 7.4216, 8.5537, 8.2914, 6.7244, 5.6159}},
    {0.9,
     500,
     {17.2196, 61.0425, 17.2196, 17.7508, 21.2292, 23.1035, 27.0522, 31.2935, 15.9226, 14.4718}},
    {0.999, 0.1, {1.0346, 0.0181, 1.0346, 1.0284, 1.0452, 1.0468, 1.0634, 1.0714, 1.0869, 1.0020}},
    {0.999, 1, {1.1542, 0.1058, 1.1542, 1.1478, 1.2328, 1.2343, 1.1362, 1.1122, 1.2063, 1.1523}},
    {0.999, 10, {1.7359, 0.9825, 1.7359, 1.7313, 1.9283, 1.9294, 1.6861, 1.5206, 1.7870, 1.7331}},
    {0.999, 100, {4.5655, 9.7500, 4.5655, 4.5971, 5.1498, 5.1528, 5.3433, 5.6037, 4.6120, 4.5580}},
    {0.999,
     500,
     {11.7651, 48.7168, 11.7651, 11.9902, 14.9140, 14.9295, 17.5691, 23.7512, 11.7996, 11.7457}}};

/// call(law, its place in the table) for each law.
template <class Call>
void for_each_law(const Call& call) {
  std::apply(
      [&](const auto&... law) {
        std::size_t place = 0;
        (call(law, place++), ...);
      },
      Laws());
}

/// Largest relative difference of a law in packs of Scalar from that in doubles.
template <class Scalar, class Law>
double pack_difference(const Law& law) {
  using Pack = typename silt::Lanes<silt::DefaultArch, Scalar>::Real;
  constexpr std::size_t W = silt::Lanes<silt::DefaultArch, Scalar>::width;
  double worst = 0;
  // Not where a law jumps: there a rounding of eps or Re decides. Lanes stand on both sides.
  for (const double Re : {0.0, 1e-8, 1e-3, 0.3, 7.0, 80.0, 990.0, 3000.0})
    for (double eps = 0.31; eps < 0.999; eps += 0.013) {
      alignas(64) Scalar e[W], r[W], F[W];
      for (std::size_t w = 0; w < W; ++w) {
        e[w] = static_cast<Scalar>(w % 2 == 0 ? eps : 1.3 - eps);
        r[w] = static_cast<Scalar>(w % 3 == 0 ? Re : 1.7 * Re);
      }
      silt::store(F, law.normalised(silt::load<Pack>(e), silt::load<Pack>(r)));
      for (std::size_t w = 0; w < W; ++w) {
        const double one = law.normalised(static_cast<double>(e[w]), static_cast<double>(r[w]));
        const double error = std::abs(static_cast<double>(F[w]) / one - 1);
        worst = error <= worst ? worst : error;  // keeps what is not a number
        if (!(error < 1)) return error;
      }
    }
  return worst;
}

/// Not laws: of doubles alone, and without a result.
struct OfDoubles {
  double normalised(double eps, double) const { return eps; }
};
struct Nothing {
  template <class Real>
  void normalised(const Real&, const Real&) const {}
};
static_assert(!silt::DragLaw<OfDoubles> && !silt::DragLaw<Nothing> && !silt::DragLaw<int>);

}  // namespace

TEST_CASE("drag: Fhat of every law equals the table's to its last digit") {
  for (const auto& row : table)
    for_each_law([&](const auto& law, std::size_t k) {
      CAPTURE(names[k]);
      CAPTURE(row.eps);
      CAPTURE(row.Re);
      CHECK(std::abs(law.normalised(row.eps, row.Re) - row.Fhat[k]) <= 0.50001e-4);
    });
}

TEST_CASE("drag: lanes equal doubles to 1e-13, lanes of float to 3e-6") {
  // Re^y and eps^-chi take the rounding of an exponent of some 40 at most.
  for_each_law([&](const auto& law, std::size_t k) {
    CAPTURE(names[k]);
    CHECK(pack_difference<double>(law) <= 1e-13);
    CHECK(pack_difference<float>(law) <= 3e-6);
    const float one = law.normalised(0.55f, 40.f);
    CHECK(near_relative(one, law.normalised(static_cast<double>(0.55f), 40.0), 3e-6));
  });
  CHECK(pack_difference<double>(Stokes()) <= 1e-15);
  CHECK(pack_difference<double>(SchillerNaumann()) <= 1e-13);
}

TEST_CASE("drag: at Re = 0 every law is finite and the limit of slow flow") {
  const double eps = 0.6, p = 1 - eps;
  // What each formula leaves at Re = 0, by hand; the guard of Re is good to 1e-7.
  const double limit[] = {std::pow(eps, -3.65),
                          150 * p / (18 * eps * eps),
                          150 * p / (18 * eps * eps),
                          0,
                          0.96 * std::pow(eps, -3.7),
                          0.96 * std::pow(eps, -2.65 * (eps + 1)),
                          10 * p / (eps * eps) + eps * eps * (1 + 1.5 * std::sqrt(p)),
                          10 * p / (eps * eps),
                          (1 + 5.81 * p + 0.48 * std::cbrt(p) / eps) / (eps * eps),
                          1 / (eps * eps)};
  for_each_law([&](const auto& law, std::size_t k) {
    CAPTURE(names[k]);
    const double F = law.normalised(eps, 0.0);
    if (limit[k] > 0) CHECK(near_relative(F, limit[k], 1e-6));
    // And continuous: a slip of 1e-7 changes less than sqrt(Re) can.
    CHECK(near_relative(law.normalised(eps, 1e-7), F, 1e-4));
    CHECK(std::isfinite(law.normalised(static_cast<float>(eps), 0.f)));
    CHECK(std::isfinite(law.normalised(1.0, 0.0)));
  });
  CHECK(near_relative(
      HuilinGidaspow().normalised(eps, 0.0),
      limit[1] + (limit[0] - limit[1]) * (std::atan(262.5 * -0.2) / std::numbers::pi + 0.5), 1e-6));
}

TEST_CASE("drag: a lone sphere feels Stokes' force, and Schiller-Naumann's") {
  const double d = 1e-3, mu = 1.8e-5, K = 3 * std::numbers::pi * mu * d;
  for (const double eps : {1.0, 0.7}) {
    CHECK(near_relative(silt::drag_coefficient(Stokes(), eps, 3.0, d, mu), K, 1e-15));
    CHECK(near_relative(silt::drag_coefficient(SchillerNaumann(), eps, 50 * eps, d, mu),
                        K * (1 + 0.15 * std::pow(50, 0.687)), 1e-14));
  }
  // C4 of the reference: air 1.2/1.8e-5, d 1 mm, slip 1 m/s: drag 6.253e-7 N.
  const silt::Vec3d F = silt::drag_force(SchillerNaumann(), 1.0, 1.2, mu, d, {0, -1, 0});
  CHECK(std::abs(F.y + 6.253e-7) <= 0.5e-10);
  CHECK(F.x == 0);
  // Newton's range: F = (pi/8) 0.44 rho d^2 W^2.
  const silt::Vec3d fast = silt::drag_force(SchillerNaumann(), 1.0, 1.2, mu, d, {40, 0, 0});
  CHECK(near_relative(fast.x, std::numbers::pi / 8 * 0.44 * 1.2 * d * d * 1600, 1e-13));
}

TEST_CASE("drag: coefficients: F = V beta W/(1 - eps), model B, Ergun's pressure drop") {
  const double eps = 0.45, d = 2e-3, mu = 1e-3, rho = 1000, W = 0.03;
  const double Re = silt::slip_reynolds(eps, rho, W, d, mu), V = std::numbers::pi / 6 * d * d * d;
  CHECK(near_relative(Re, 27, 1e-14));
  for_each_law([&](const auto& law, std::size_t k) {
    CAPTURE(names[k]);
    const double K = silt::drag_coefficient(law, eps, Re, d, mu);
    const double beta = silt::interphase_coefficient(law, eps, Re, d, mu);
    CHECK(near_relative(V * beta / (1 - eps), K, 1e-14));
    CHECK(near_relative(silt::model_b(K, eps), K / eps, 1e-15));
  });
  // A fixed bed: -dp/dx = beta W/eps, which is Ergun's with U = eps W.
  const double U = eps * W, e3 = eps * eps * eps, p = 1 - eps;
  const double drop = 150 * mu * p * p * U / (e3 * d * d) + 1.75 * rho * p * U * U / (e3 * d);
  CHECK(
      near_relative(silt::interphase_coefficient(Ergun(), eps, Re, d, mu) * W / eps, drop, 1e-14));
}

}  // namespace drag_test
