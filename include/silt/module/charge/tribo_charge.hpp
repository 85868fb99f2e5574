// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include <silt/core/dyn_array.hpp>
#include <silt/core/lanes.hpp>
#include <silt/core/names.hpp>
#include <silt/module/charge/charge.hpp>
#include <silt/module/wall_values.hpp>

namespace silt::inline SILT_TARGET {

/// Module: Charge, and contact charging with an effective work function for each material.
///
///   silt::TriboCharge{silt::Charge{.cutoff = 2e-3},
///                     {.work_functions = {4.5, 4.2}, .transfer_distance = 5e-7}}
///
///   dq_i = eps [V_ij/delta - E_ij] dA+,   V_ij = W_j - W_i,   dA+ = alpha pi R* d(overlap)+  (1)
///   E_ij = (q_i/R_i^2 - q_j/R_j^2)/(4 pi eps),   of a wall: 2 q_i/(4 pi eps R_i^2)           (2)
///
/// Charge is transferred only while the contact area grows (condenser model: the gap closes at the
/// potential difference and opens without leakage). (2) is the field of both spheres' own charges
/// at the contact point; a wall is grounded and acts as a mirror. E_ij neglects the charges of
/// other particles and the external field. The charge gained by i is lost by j. Charge from walls
/// is summed: sim.given_by_wall<TriboCharge>(wall).sum [C].
///
/// A sphere that hits a wall repeatedly, each time with the largest overlap d, has the charge
///   q_n = q_inf (1 - exp(-n/n0)),   q_inf = 2 pi eps R^2 V/delta,   n0 = 2 R/(alpha d)     (3)
///
/// alpha: charging area over contact area. It is less than 1 for rough surfaces. For contacts
/// softer than the solids it is (E_soft/E)^(2/5) for impacts at the same speed.
///
/// Source: (1), (2), and a mirrored particle for walls: J. Kolehmainen et al., a draft of their
///         paper on triboelectric charging of monodisperse particles in fluidised beds
///         (authorea.com/users/69387/articles/82258), read in part. It adds the neighbours' charges
///         to E_ij, which are neglected here, and takes delta = 500 nm as typical. (3): from (1),
///         (2).
/// Valid:  insulators with an effective work function; d small compared with R.
/// Units:  SI, work functions in eV. Shapes: all; for bodies R is the bounding radius, and the area
///         follows R* of the contact.
/// Errors: InputError naming field, value and unit; materials without a work function.
/// Tests:  tests/physics/charge.cpp.
struct TriboCharge : Charge {
  struct Surfaces {
    DynArray<double> work_functions{};  // [eV] of the contacts' material 0, 1, ...
    double transfer_distance = 5e-7;    // [m] delta > 0
    double area_factor = 1;             // [-] alpha > 0
    WallValues<bool> insulated{};       // walls without charge transfer: {true}, or {{"lid", true}}
  } surfaces;

  TriboCharge(Charge charge, Surfaces of) : Charge(std::move(charge)), surfaces(std::move(of)) {}

  static constexpr auto exchanged = &ChargeFields::charge;
  static constexpr bool needs_growth = true;
  template <class Real>
  struct Coefficients {
    Real push;    // [C/m2] eps V_ij/delta, into the first end
    Real factor;  // [-] alpha pi
  };
  template <class ContactsType>
  Coefficients<double> coefficients(const ContactsType&, std::size_t a, std::size_t b) const {
    const auto& w = surfaces.work_functions;
    if (a >= w.size() || b >= w.size()) return {0, 0};  // refused by check()
    return {eps0 * permittivity * (w[b] - w[a]) / surfaces.transfer_distance,
            surfaces.area_factor * std::numbers::pi};
  }
  /// 4 pi eps times the field at the surface [C/m2].
  double at_contact(const Seen& p, const Fields& f) const {
    return f.charge / (p.radius * p.radius);
  }
  std::optional<double> at_wall(std::size_t wall, double) const {
    const bool* const insulated = surfaces.insulated.of(wall);
    return insulated != nullptr && *insulated ? std::nullopt : std::optional<double>(0);
  }
  template <class Real>
  SILT_INLINE Real flux(const Touching<Real>& c, const Coefficients<Real>& p, const Real& a,
                        const Real& b) const {       // [C/s]
    const Real other = c.at_wall ? Real(0) - a : b;  // wall: mirrored particle
    const Real of_charges =
        (a - other) * Real(static_cast<ScalarOf<Real>>(0.25 * std::numbers::inv_pi));
    return (p.push - of_charges) * p.factor * c.R_eff * max(c.growth, Real(0));
  }
  void update(const Seen&, Fields& f, double received, double dt) const {
    f.charge += received * dt;
  }

  template <class Sim>
  void check(const Sim& sim) const {
    Charge::check(sim);
    const auto& w = surfaces.work_functions;
    require_positive("TriboCharge.transfer_distance", surfaces.transfer_distance, "m");
    require_positive("TriboCharge.area_factor", surfaces.area_factor, "-");
    for (std::size_t k = 0; k < w.size(); ++k)
      require(std::isfinite(w[k]), "TriboCharge.work_functions[", k, "]",
              detail::after_entry(sim.contacts(), k), " = ", w[k], " [eV] must be finite");
    detail::check_entries("TriboCharge.work_functions", w.size(), 0, sim.contacts());
    for (std::size_t k = 0; k < sim.rows(); ++k)
      if (!(sim.material(k) < w.size()))
        throw InputError(text("TriboCharge: particle ", sim.id(k), " is of ",
                              sim.material_name(sim.material(k)),
                              ", which has no value [eV] in `work_functions`; add it there"));
    surfaces.insulated.resolve(sim, "TriboCharge.insulated");
    for (std::size_t k = 0; k < sim.walls(); ++k)
      require(!at_wall(k, 0) || sim.wall(k).material < w.size(), "TriboCharge: ", sim.wall_name(k),
              " is of ", sim.material_name(sim.wall(k).material),
              ", which has no value [eV] in `work_functions`; add it there, or make the wall "
              "insulated");
  }
};

}  // namespace silt
