// silt - BSD-3-Clause, see LICENSE
// refused: a module's pair_force() does not fit
// refused: a module's pair_force_on_both() does not fit
// refused: a module's pair_flux() does not fit
// refused: a module with pair_flux() needs update(seen, fields, received, dt)
// refused: a module's pair_stiffness() does not fit
// refused: a module's pair_slope() does not fit
// refused: a module's reach() does not fit
// refused: a module's gap_reach() does not fit
// refused: a module with pair_force() or pair_flux() needs either `double reach() const` or
// refused: a module with reach() or gap_reach() needs pair_force() or pair_flux()
// refused: the Fields of a module are only doubles and silt::Vec3d
// refused: PairsFit<PushesToANumber>
// refused: PairsFit<PushesWithTorque>
// refused: PairsFit<PushesByFields>
// refused: PairsFit<PushesBothUnasked>
// refused: PairsFit<FlowsByReference>
// refused: PairsFit<FlowsWithoutFields>
// refused: PairsFit<FlowsUnheard>
// refused: PairsFit<StiffByReference>
// refused: PairsFit<StiffAlone>
// refused: PairsFit<SlopeToAVector>
// refused: PairsFit<SlopeAlone>
// refused: PairsFit<ReachesByANumber>
// refused: PairsFit<ReachesNot>
// refused: PairsFit<ReachesTwice>
// refused: PairsFit<ReachesByGapNot>
// refused: PairsFit<ReachesForNothing>
// refused: ModuleFits<OfFloats>
#include "scene.hpp"

// Functions between pairs within a reach that silt would not find: each module has one mistake.
#if defined(SILT_MENDED)
#define RIGHT_OR_WRONG(right, wrong) right
#else
#define RIGHT_OR_WRONG(right, wrong) wrong
#endif
#define APART const silt::Apart&, const silt::Seen&, const silt::Seen&
#define PAIR const silt::Apart&, const silt::Seen&, const Fields&, const silt::Seen&, const Fields&

struct Near {
  struct Fields {
    double level = 0;
  };
  double reach() const { return 1; }
};
struct Pushing : Near {
  silt::Vec3d pair_force(PAIR) const { return {}; }
};
struct Flowing : Near {
  double pair_flux(PAIR) const { return 0; }
  void update(const silt::Seen&, Fields&, double, double) const {}
};

struct PushesToANumber : Near {
  RIGHT_OR_WRONG(silt::Vec3d, double) pair_force(PAIR) const { return {}; }
};
struct PushesWithTorque : Near {
  RIGHT_OR_WRONG(silt::Vec3d, silt::Push)
  pair_force(APART) const { return {}; }
};
struct PushesByFields {
  double reach() const { return 1; }
  silt::Vec3d pair_force(const silt::Apart&, const silt::Seen&,
                         RIGHT_OR_WRONG(const, ) silt::Seen&) const {
    return {};
  }
};
struct PushesBothUnasked : Pushing {
  silt::Vec3d pair_force_on_both(PAIR) const { return {}; }
  RIGHT_OR_WRONG(
      bool pushes_both() const { return true; }, )
};
struct FlowsByReference : Near {
  double pair_flux(const silt::Apart&, const silt::Seen&, RIGHT_OR_WRONG(const, ) Fields&,
                   const silt::Seen&, const Fields&) const {
    return 0;
  }
  void update(const silt::Seen&, Fields&, double, double) const {}
};
struct FlowsWithoutFields : Near {
  double pair_flux(RIGHT_OR_WRONG(PAIR, APART)) const { return 0; }
  void update(const silt::Seen&, Fields&, double, double) const {}
};
struct FlowsUnheard : RIGHT_OR_WRONG(Flowing, Near) {
  double pair_flux(PAIR) const { return 0; }
};
struct StiffByReference : Pushing {
  double pair_stiffness(PAIR) RIGHT_OR_WRONG(const, ) { return 1; }
};
struct StiffAlone : RIGHT_OR_WRONG(Pushing, Flowing) {
  double pair_stiffness(PAIR) const { return 1; }
};
struct SlopeToAVector : Flowing {
  RIGHT_OR_WRONG(double, silt::Vec3d) pair_slope(PAIR) const { return {}; }
};
struct SlopeAlone : RIGHT_OR_WRONG(Flowing, Pushing) {
  double pair_slope(PAIR) const { return 1; }
};
struct ReachesByANumber {
  double RIGHT_OR_WRONG(
      reach() const { return 1; }, reach = 1;) silt::Vec3d pair_force(APART) const {
    return {};
  }
};
struct ReachesNot {
  RIGHT_OR_WRONG(
      double reach() const { return 1; }, )
  silt::Vec3d pair_force(APART) const { return {}; }
};
struct ReachesTwice : Pushing {
  RIGHT_OR_WRONG(
      , double gap_reach() const { return 1; })
};
struct ReachesByGapNot {
  double gap_reach() RIGHT_OR_WRONG(const, ) { return 1; }
  silt::Vec3d pair_force(APART) const { return {}; }
};
struct ReachesForNothing : RIGHT_OR_WRONG(Pushing, Near) {};
struct OfFloats {
  struct Fields {
    RIGHT_OR_WRONG(double, float) charge, other;
  };
  double reach() const { return 1; }
  silt::Vec3d pair_force(PAIR) const { return {}; }
};
template <class M>
using With = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>, M>;
inline const bool all = With<PushesToANumber>::rotates && With<PushesWithTorque>::rotates &&
                        With<PushesByFields>::rotates && With<PushesBothUnasked>::rotates &&
                        With<FlowsByReference>::rotates &&
                        With<FlowsWithoutFields>::rotates && With<FlowsUnheard>::rotates &&
                        With<StiffByReference>::rotates && With<StiffAlone>::rotates &&
                        With<SlopeToAVector>::rotates && With<SlopeAlone>::rotates &&
                        With<ReachesByANumber>::rotates && With<ReachesNot>::rotates &&
                        With<ReachesTwice>::rotates && With<ReachesByGapNot>::rotates &&
                        With<ReachesForNothing>::rotates && With<OfFloats>::rotates;
#undef RIGHT_OR_WRONG
#undef APART
#undef PAIR
