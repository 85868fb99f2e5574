// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <cmath>
#include <numbers>

#include <silt/core/error.hpp>
#include <silt/sph/kernels.hpp>

/// Optional terms of an SPH liquid, each a small type: viscosity, diffusion of density, shifting.
/// Omitted terms cost nothing.
///
/// Units:  SI.
/// Errors: check() throws InputError naming field, value and allowed range.
namespace silt::inline SILT_TARGET {

/// @name Viscosity: the acceleration of a by b, per mass
/// @{

/// No viscosity except that of the scheme.
/// Source: none.
/// Valid:  short runs of liquids whose viscosity is not important: sound is not damped.
/// Tests:  tests/sph/flows.cpp, tests/sph/pair_sums.cpp.
struct Inviscid {
  static constexpr SphAxis sph_axis = SphAxis::Viscosity;
  static constexpr bool artificial = false, laminar = false;
  static constexpr const char* policy_name = "Inviscid";
  void check() const {}
  double longest_step(double, double) const { return INFINITY; }
};

namespace detail {

/// [s] Longest step for an artificial viscosity with the kernel's h [m] and the speed of sound c
/// [m/s]: it stops pairs that approach within about h/(alpha c). Shorter than that of sound from
/// alpha = 1.7 on (Courant number 0.6). With 3 times its length, at alpha = 5, a tank at rest began
/// to move.
inline double artificial_step(double alpha, double h, double c) {
  return alpha > 0 ? h / (alpha * c) : INFINITY;
}

}  // namespace detail

/// Artificial viscosity -Pi grad W, Pi = -alpha c mu/rho_ab, mu = h v_ab.r_ab/(r^2 + (0.1 h)^2) for
/// approaching particles, 0 for others. It damps sound and keeps particles ordered.
///
/// It acts as a kinematic viscosity of alpha h c/10 in 3D, alpha h c/8 in 2D. In shear it is half
/// as large, since half of all pairs move apart.
/// Source: J. J. Monaghan, J. Comput. Phys. 110 (1994) 399.
/// Valid:  alpha of 0.01 to 0.1; flows in which its effective viscosity is not important.
/// Tests:  tests/sph/pair_sums.cpp, tests/sph/waves.cpp.
struct ArtificialViscosity {
  double alpha = 0.02;  // [-]

  static constexpr SphAxis sph_axis = SphAxis::Viscosity;
  static constexpr bool artificial = true, laminar = false;
  static constexpr const char* policy_name = "ArtificialViscosity";
  void check() const {
    require(std::isfinite(alpha) && alpha >= 0, "ArtificialViscosity.alpha = ", alpha,
            " must be at least 0; 0.01 to 0.1 are usual");
  }
  double longest_step(double h, double c) const { return detail::artificial_step(alpha, h, c); }
};

/// Viscosity of the liquid: 4 nu (D/s^2) m_b v_ab.r/(rho_a + rho_b) grad W in D dimensions, where
/// s^2 = int r^2 W dV is the second moment of the kernel, plus an artificial viscosity if `alpha`
/// is not 0. Forces act along r: angular momentum is conserved, a liquid that turns as a whole is
/// not braked, and walls and free surfaces have the traction of the symmetric stress, 2 mu (grad
/// v)_sym. The usual form with r.grad W v_ab/(r^2 + (0.1 h)^2) (Lo and Shao 2002) has mu grad v
/// there: the torque of a turning cylinder was a third too small, and a liquid with a free surface
/// turned faster than its drum. Monaghan's form has v_ab.r/(r^2 + (0.1 h)^2) grad W, with 4 (D + 2)
/// nu; without the division the viscosity depends less on the lattice (docs/sph_method.md).
///
/// Source: silt's own, after J. J. Monaghan, Rep. Prog. Phys. 68 (2005) 1703; traction at free
///         surfaces: A. Colagrossi, M. Antuono, A. Souto-Iglesias, D. Le Touze, Phys. Rev. E 84
///         (2011) 026705 (both recalled).
/// Valid:  flows resolved by the spacing.
/// Tests:  tests/sph/taylor_green.cpp, tests/sph/flows.cpp, tests/sph/stokes_sphere.cpp,
///         tests/sph/turning.cpp.
struct LaminarViscosity {
  double kinematic = 0;  // [m2/s]
  double alpha = 0.02;   // [-] of an additional ArtificialViscosity

  static constexpr SphAxis sph_axis = SphAxis::Viscosity;
  static constexpr bool artificial = true, laminar = true;
  static constexpr const char* policy_name = "LaminarViscosity";
  void check() const {
    require_positive("LaminarViscosity.kinematic", kinematic, "m2/s");
    require(std::isfinite(alpha) && alpha >= 0, "LaminarViscosity.alpha = ", alpha,
            " must be at least 0; 0.01 keeps impacts calm");
  }
  double longest_step(double h, double c) const {
    return std::min(0.125 * h * h / kinematic, detail::artificial_step(alpha, h, c));
  }
};
/// @}

/// @name Diffusion of density, among liquid particles: against noise in the pressure
/// @{

/// No diffusion of density; the pressure remains noisy.
/// Source: none.
/// Valid:  short runs and comparison.
/// Tests:  tests/sph/pair_sums.cpp, tests/sph/elliptic_drop.cpp.
struct NoDiffusion {
  static constexpr SphAxis sph_axis = SphAxis::Diffusion;
  static constexpr bool diffuses = false, hydrostatic = false;
  static constexpr const char* policy_name = "NoDiffusion";
  void check() const {}
};

/// Diffusion d rho/dt = delta h c sum_b 2 (rho_a - rho_b) (r_ab.grad W)/(r^2 + (0.1 h)^2) V_b. In a
/// liquid at rest under gravity it changes the density near the free surface.
/// Source: D. Molteni, A. Colagrossi, Comput. Phys. Commun. 180 (2009) 861.
/// Valid:  without gravity, or where the layer at the free surface is not important.
/// Tests:  tests/sph/pair_sums.cpp.
struct MolteniColagrossi {
  double delta = 0.1;  // [-]

  static constexpr SphAxis sph_axis = SphAxis::Diffusion;
  static constexpr bool diffuses = true, hydrostatic = false;
  static constexpr const char* policy_name = "MolteniColagrossi";
  void check() const {
    require(std::isfinite(delta) && delta >= 0, "MolteniColagrossi.delta = ", delta,
            " must be at least 0; 0.1 is usual");
  }
};

/// MolteniColagrossi for the deviation from the hydrostatic difference: (rho_a - rho_b) -
/// rho_0 g.r_ab/c^2, with an equation of state that is linear over the kernel.
/// Source: G. Fourtakas, J. M. Dominguez, R. Vacondio, B. D. Rogers, Comput. Fluids 190 (2019) 346;
///         with the sign that gives diffusion.
/// Valid:  with and without gravity.
/// Tests:  tests/sph/pair_sums.cpp, tests/sph/flows.cpp.
struct Fourtakas {
  double delta = 0.1;  // [-]

  static constexpr SphAxis sph_axis = SphAxis::Diffusion;
  static constexpr bool diffuses = true, hydrostatic = true;
  static constexpr const char* policy_name = "Fourtakas";
  void check() const {
    require(std::isfinite(delta) && delta >= 0, "Fourtakas.delta = ", delta,
            " must be at least 0; 0.1 is usual");
  }
};
/// @}

/// @name Shifting: particles move a little towards where there are few
/// @{

/// No shifting: particles move with the liquid's velocity.
/// Source: none.
/// Valid:  violent flows with a free surface.
/// Tests:  tests/sph/flows.cpp, tests/sph/elliptic_drop.cpp.
struct NoShifting {
  static constexpr SphAxis sph_axis = SphAxis::Shifting;
  static constexpr bool shifts = false;
  static constexpr const char* policy_name = "NoShifting";
  void check() const {}
};

namespace detail {
/// Common checks of Shifting and ShiftingByFastest.
template <class Policy>
void check_shifting(const Policy& of) {
  require(std::isfinite(of.strength) && of.strength >= 0 && of.strength <= 6, Policy::policy_name,
          ".strength = ", of.strength, " must be in [0, 6]; ", Policy{}.strength, " is usual");
  require(of.threshold >= 0 && of.threshold < 3, Policy::policy_name, ".threshold = ", of.threshold,
          " must be in [0, 3); 0 chooses 1.5 in 2D and 2.75 in 3D");
}
inline double shifting_threshold(double threshold, int dimensions) {
  return threshold > 0 ? threshold : dimensions == 2 ? 1.5 : 2.75;
}
}  // namespace detail

/// Shifting by dr = -A h |v| dt grad C, grad C = sum_b V_b grad W. It is 0 at a free surface, where
/// div r = -sum_b V_b r.grad W is below `threshold` (1.5 in 2D, 2.75 in 3D if it is 0), and
/// increases linearly up to 2 or 3.
/// Source: S. J. Lind, R. Xu, P. K. Stansby, B. D. Rogers, J. Comput. Phys. 231 (2012) 1499; switch
///         as in DualSPHysics.
/// Valid:  flows with and without a free surface.
/// Tests:  tests/sph/taylor_green.cpp, tests/sph/refusals.cpp.
struct Shifting {
  double strength = 2, threshold = 0;  // [-] A; of div r, 0: default as above

  static constexpr SphAxis sph_axis = SphAxis::Shifting;
  static constexpr bool shifts = true, by_fastest = false;
  static constexpr const char* policy_name = "Shifting";
  void check() const { detail::check_shifting(*this); }
  double threshold_in(int dimensions) const {
    return detail::shifting_threshold(threshold, dimensions);
  }
};

/// Shifting with the speed of the fastest particle in place of |v|, for a liquid that fills its
/// space. At a stagnation point |v| is 0, while the strain that disorders particles is largest.
/// Source: P. N. Sun, A. Colagrossi, S. Marrone, A. M. Zhang, Comput. Methods Appl. Mech. Eng. 315
///         (2017) 25 (recalled); their Ma CFL (2 h)^2 is A = 4; without their term against pairing.
/// Valid:  liquids that fill their space.
/// Tests:  tests/sph/taylor_green.cpp, tests/sph/refusals.cpp.
struct ShiftingByFastest {
  double strength = 4, threshold = 0;  // [-] as of Shifting

  static constexpr SphAxis sph_axis = SphAxis::Shifting;
  static constexpr bool shifts = true, by_fastest = true;
  static constexpr const char* policy_name = "ShiftingByFastest";
  void check() const { detail::check_shifting(*this); }
  double threshold_in(int dimensions) const {
    return detail::shifting_threshold(threshold, dimensions);
  }
};
/// @}

/// @name Walls and bodies: the density of the particles in them
/// @{

/// Density of the liquid at the mirror images, by a linear fit, and mirrored velocities for no-slip
/// or slip (mDBC). Such walls hold liquid that they have pushed for as long as sound goes to and fro
/// in it, and only push otherwise (solid_hold.hpp).
/// Source: A. English and others, Comput. Part. Mech. 9 (2022) 1 (recalled).
/// Valid:  walls of any shape with liquid on one side.
/// Tests:  tests/sph/walls.cpp, tests/sph/bodies.cpp.
struct MirroredWalls {
  static constexpr SphAxis sph_axis = SphAxis::Walls;
  static constexpr bool mirrored = true;
  static constexpr const char* policy_name = "MirroredWalls";
  void check() const {}
};

/// Own density of wall particles, by the continuity equation, not below rho_0 (DBC). A particle
/// that approaches a wall raises the density on both sides and is pushed back. Cheaper, and less
/// accurate near the wall. Their velocity is the wall's.
/// Source: A. J. C. Crespo, M. Gomez-Gesteira, R. A. Dalrymple, CMC 5 (2007) 173 (recalled).
/// Valid:  where the pressure at the wall is not important.
/// Tests:  tests/sph/bodies.cpp, tests/sph/flows.cpp.
struct DynamicWalls {
  static constexpr SphAxis sph_axis = SphAxis::Walls;
  static constexpr bool mirrored = false;
  static constexpr const char* policy_name = "DynamicWalls";
  void check() const {}
};
/// @}

/// Refuses grains that are too small to be resolved. The alternative is UnresolvedGrains
/// (unresolved_grains.hpp).
/// Source: none.
/// Valid:  bodies of at least 1.5 spacings.
/// Tests:  tests/sph/bodies.cpp, tests/sph/grains.cpp.
struct ResolvedGrains {
  static constexpr SphAxis sph_axis = SphAxis::Grains;
  static constexpr bool averaged = false;
  static constexpr const char* policy_name = "ResolvedGrains";
  struct State {
    explicit State(const ResolvedGrains&) {}
  };
  void check() const {}
};

/// @name Steps in time
/// @{

/// Verlet scheme, one evaluation per step: velocity and density leap over two steps, and every
/// `restart` steps over one. The difference between odd and even steps grows in between, because
/// damping acts on it with the wrong sign: by diffusion alone as e^(7 delta c t/h), 7 = 2 int
/// |W'|/r dV h^2 of WendlandC2, which is e^(7 delta courant restart) between two restarts.
/// DualSPHysics restarts after 40 steps, which is too many here (docs/sph_method.md).
/// Source: L. Verlet, Phys. Rev. 159 (1967) 98, as in DualSPHysics but for `restart`.
/// Valid:  `courant` up to 0.2, restart * courant up to 1.5, and some damping: not Inviscid with
///         NoDiffusion.
/// Tests:  tests/sph/flows.cpp, tests/sph/refusals.cpp.
struct VerletTime {
  int restart = 5;
  static constexpr double most_courant = 0.2;
  static constexpr double longest = 1.5;  // [-] restart * SphSetup.courant
  static constexpr SphAxis sph_axis = SphAxis::Time;
  static constexpr bool two_stages = false, leaps = false;
  static constexpr const char* policy_name = "VerletTime";
  void check() const {
    require(restart >= 2, "VerletTime.restart = ", restart,
            " steps must be at least 2, as 1 is Euler's method; 5 is usual");
  }
};

/// Two evaluations per step, one of them in its middle; second order. It amplifies sound slightly,
/// the more the longer the steps.
/// Source: B. Leimkuhler, C. Matthews, Molecular Dynamics, 2015, as in DualSPHysics.
/// Valid:  Courant numbers up to 0.6.
/// Tests:  tests/sph/flows.cpp, tests/sph/waves.cpp.
struct SymplecticTime {
  static constexpr SphAxis sph_axis = SphAxis::Time;
  static constexpr bool two_stages = true, leaps = false;
  static constexpr double most_courant = 0.6;
  static constexpr const char* policy_name = "SymplecticTime";
  void check() const {}
};

/// Leapfrog: places and densities go half a step, then velocities a whole one by the forces in its
/// middle, then places and densities the other half. The forces are summed once a step; the rate of
/// density, which is cheaper, with the velocities at the start and at the end of the step. Second
/// order, except that viscosity acts with the velocities at the start. Without viscosity and
/// diffusion it conserves the energy of sound waves, which SymplecticTime amplifies slightly.
/// Source: the positions' form of L. Verlet, Phys. Rev. 159 (1967) 98 (recalled), with densities as
///         positions; similar: C. Zhang, M. Rezavand, X. Hu, J. Comput. Phys. 404 (2020) 109135
///         (recalled).
/// Valid:  Courant numbers up to 1.
/// Tests:  tests/sph/flows.cpp, tests/sph/waves.cpp, tests/sph/ledger.cpp.
struct LeapfrogTime {
  static constexpr SphAxis sph_axis = SphAxis::Time;
  static constexpr bool two_stages = true, leaps = true;
  static constexpr double most_courant = 1;
  static constexpr const char* policy_name = "LeapfrogTime";
  void check() const {}
};
/// @}

}  // namespace silt
