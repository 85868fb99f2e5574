// silt - BSD-3-Clause, see LICENSE
// refused: a module's at_contact() does not fit
// refused: a module's given_by_wall() does not fit
// refused: a module's share_of_loss() does not fit
// refused: a module's worn() does not fit
// refused: ModuleFits<WearsByOneNumber>
// refused: ModuleFits<GivesNot>
// refused: ModuleFits<HasNothingAtContacts>
// refused: ModuleFits<SharesNot>
#include "scene.hpp"

// Functions at contacts that silt would not find: each module has one mistake.
#if defined(SILT_MENDED)
#define RIGHT_OR_WRONG(right, wrong) right
#else
#define RIGHT_OR_WRONG(right, wrong) wrong
#endif
#define OWN const silt::Seen&, const Fields&

struct WearsByOneNumber {
  double worn(RIGHT_OR_WRONG(const silt::WallRub&, double), std::size_t) const { return 0; }
};
struct Exchanging {
  struct Fields {
    double level = 0;
  };
  static constexpr auto exchanged = &Fields::level;
  template <class Real>
  Real flux(const silt::Touching<Real>&, const Real& a, const Real& b) const {
    return b - a;
  }
  double at_wall(std::size_t, double) const { return 0; }
  void update(const silt::Seen&, Fields&, double, double) const {}
};
struct GivesNot : Exchanging {
  RIGHT_OR_WRONG(double, silt::Vec3d) given_by_wall(std::size_t, double) const { return {}; }
};
struct HasNothingAtContacts : Exchanging {
  double at_contact(RIGHT_OR_WRONG(OWN, const silt::Seen&)) const { return 0; }
};
struct SharesNot {
  struct Fields {
    double level = 0;
  };
  template <class Real>
  struct Coefficients {
    Real factor;
  };
  Coefficients<double> coefficients(const auto&, std::size_t, std::size_t) const { return {1}; }
  static constexpr auto exchanged = &Fields::level;
  template <class Real>
  Real flux(const silt::Touching<Real>&, const Coefficients<Real>& p, const Real& a,
            const Real& b) const {
    return p.factor * (b - a);
  }
  template <class Real>
  Real share_of_loss(const Coefficients<Real>& p) RIGHT_OR_WRONG(const, ) {
    return p.factor;
  }
  void update(const silt::Seen&, Fields&, double, double) const {}
};

template <class M>
using With = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>,
                              silt::EnergyLedger, M>;
inline const bool all = With<WearsByOneNumber>::rotates && With<GivesNot>::rotates &&
                        With<HasNothingAtContacts>::rotates && With<SharesNot>::rotates;
#undef RIGHT_OR_WRONG
#undef OWN
