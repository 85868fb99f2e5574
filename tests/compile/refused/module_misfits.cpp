// silt - BSD-3-Clause, see LICENSE
// refused: a module's force() does not fit
// refused: a module's rate() does not fit
// refused: a module's start() does not fit
// refused: a module's divide() does not fit
// refused: a module's update() does not fit
// refused: a module has one update()
// refused: a module's update() takes its Fields by value or as const
// refused: a module's `exchanged` must point to a double of its Fields
// refused: a module with a flux has both `exchanged` and flux()
// refused: a module's flux() does not fit
// refused: a module's at_wall() does not fit
// refused: the Fields of a module are only doubles and silt::Vec3d
// refused: PolicyOfAnAxis<Pushed
// refused: belongs to no axis
#include "scene.hpp"

// Functions that silt would not find: each module's last member is its mistake, but for the fields
// of Counted.
#if defined(SILT_MENDED)
#define RIGHT_OR_WRONG(right, wrong) right
#else
#define RIGHT_OR_WRONG(right, wrong) wrong
#endif

struct Level {
  struct Fields {
    double level = 0;
  };
};
struct PushedByFields : Level {
  silt::Vec3d force(const silt::Seen&, RIGHT_OR_WRONG(const, ) Fields&) const { return {}; }
};
struct Pushed {
  silt::Vec3d force(const silt::Seen&) RIGHT_OR_WRONG(const, ) { return {}; }
};
struct Rated : Level {
  double rate(RIGHT_OR_WRONG(const, ) silt::Seen&) const { return 1; }
};
struct Started : Level {
  RIGHT_OR_WRONG(Fields, double) start(const silt::Seen&) const { return {}; }
};
struct Divided : Level {
  void divide(Fields&, double) RIGHT_OR_WRONG(const, ) {}
};
struct Updated : Level {
  void update(const silt::Seen&, Fields&, double) RIGHT_OR_WRONG(const, ) {}
};
struct UpdatedTwice : Level {
  void update(const silt::Seen&, Fields&, double) const {}
  RIGHT_OR_WRONG(, void update(const silt::Seen&, Fields&, double, double) const {})
};
struct UpdatesACopy : Level {
  void update(const silt::Seen&, Fields RIGHT_OR_WRONG(&, ), double) const {}
};
struct FlowsByVector {
  struct Fields {
    silt::Vec3d flow{};
    double level = 0;
  };
  template <class Real>
  Real flux(const silt::Touching<Real>&, const Real& a, const Real& b) const {
    return b - a;
  }
  void update(const silt::Seen&, Fields&, double, double) const {}
  static constexpr auto exchanged = &Fields::RIGHT_OR_WRONG(level, flow);
};
struct FlowsNowhere : Level {
  void update(const silt::Seen&, Fields&, double, double) const {}
  static constexpr auto exchanged = &Fields::level;
  RIGHT_OR_WRONG(
      template <class Real> Real flux(const silt::Touching<Real>&, const Real& a, const Real& b)
          const { return b - a; }, )
};
struct FlowsByReference : Level {
  void update(const silt::Seen&, Fields&, double, double) const {}
  static constexpr auto exchanged = &Fields::level;
  template <class Real>
  Real flux(const silt::Touching<Real>&, RIGHT_OR_WRONG(const, ) Real& a, const Real& b) const {
    return b - a;
  }
};
struct FlowsAtWalls : FlowsByVector {
  static constexpr auto exchanged = &Fields::level;
  double at_wall(std::size_t, double) RIGHT_OR_WRONG(const, ) { return 0; }
};
struct Counted {
  struct Fields {
    RIGHT_OR_WRONG(double, int) contacts, steps;
  };
};

template <class M>
using With = silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>, M>;
inline const bool all = With<PushedByFields>::rotates && With<Pushed>::rotates &&
                        With<Rated>::rotates && With<Started>::rotates && With<Divided>::rotates &&
                        With<Updated>::rotates && With<UpdatedTwice>::rotates &&
                        With<UpdatesACopy>::rotates && With<FlowsByVector>::rotates &&
                        With<FlowsNowhere>::rotates && With<FlowsByReference>::rotates &&
                        With<FlowsAtWalls>::rotates && With<Counted>::rotates;
#undef RIGHT_OR_WRONG
