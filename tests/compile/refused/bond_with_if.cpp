// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
// on every instruction set
#include "scene.hpp"

/// A stop that pushes and never pulls. Branches on a strain: with AVX-512, one lane decided for
/// all.
struct EndStop {
  double stiffness;  // [N/m]
  template <class Real>
  struct Numbers {
    Real k;
  };
  Numbers<double> numbers(const silt::BondedPair&) const { return {stiffness}; }
  template <class Real>
  silt::BondAnswer<Real> answer(const silt::BondStrain<Real>& s, const Numbers<Real>& p) const {
    const silt::Vec3<Real> none{Real(0), Real(0), Real(0)};
#if defined(SILT_MENDED)
    const Real k = silt::select(dot(s.shift, s.normal) > Real(0), Real(0), p.k);
    return {s.shift * -k, none, none, none};
#else
    if (dot(s.shift, s.normal) > Real(0)) return {none, none, none, none};
    return {s.shift * -p.k, none, none, none};
#endif
  }
  template <class Real>
  Real load(const silt::BondAnswer<Real>&, const silt::Vec3<Real>&, const Numbers<Real>& p) const {
    return Real(0) * p.k;
  }
  double energy(const silt::BondStrain<double>&, const Numbers<double>&) const { return 0; }
  silt::BondStiffness stiffest(const Numbers<double>&) const { return {stiffness, 0}; }
};

inline void glue_two() {
  silt::Simulation sim{beads, contacts, silt::Bonds{EndStop{1e3}}};
  sim.bond(0, 1);
}
