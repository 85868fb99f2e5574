// silt - BSD-3-Clause, see LICENSE
#pragma once
namespace silt::inline SILT_TARGET {
struct NoFatigue { double weakened(double s, double) const { return s; } void check() const {} };
struct PowerFatigue { double kappa, psi; double weakened(double s, double l) const { return s * (1 - kappa * __builtin_pow(l / s, psi)); } void check() const {} };
}
