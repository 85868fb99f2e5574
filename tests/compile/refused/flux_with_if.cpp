// silt - BSD-3-Clause, see LICENSE
// refused: in place of if, while, ?:, std::min and std::max write silt::select(condition, a, b)
// refused: in place of std:: functions write silt::sqrt
// on every instruction set
#include "scene.hpp"

/// Branches on a difference, with AVX-512 for all lanes alike; and takes a root of a double.
struct OneWay {
  struct Fields {
    double level = 0;
  };
  static constexpr auto exchanged = &Fields::level;
  template <class Real>
  Real flux(const silt::Touching<Real>& c, const Real& a, const Real& b) const {
#if defined(SILT_MENDED)
    return silt::select(a < b, sqrt(c.overlap) * (b - a), Real(0));
#else
    if (a < b) return std::sqrt(c.overlap) * (b - a);
    return 0;
#endif
  }
  void update(const silt::Seen&, Fields& f, double received, double dt) const {
    f.level += received * dt;
  }
};

using Sim =
    silt::Simulation<silt::Particles<silt::Sphere>, silt::Contacts<silt::HertzMindlin>, OneWay>;
static_assert(Sim::bytes_per_contact > 0);
