// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <vector>

#include <silt/parallel/decomposition/concept.hpp>
#include <silt/parallel/zoltan.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// The callbacks' data of one rank: its points and their weights, of mean 1.
struct ZoltanPoints {
  std::vector<Vec3d> points;
  std::vector<float> weights;
  int rank;

  static const ZoltanPoints& of(void* data) { return *static_cast<const ZoltanPoints*>(data); }

  static int count(void* data, int* error) {
    *error = ZOLTAN_OK;
    return static_cast<int>(of(data).points.size());
  }
  static void list(void* data, int, int, ZOLTAN_ID_PTR ids, ZOLTAN_ID_PTR places, int,
                   float* weights, int* error) {
    const auto& own = of(data);
    for (std::size_t k = 0; k < own.points.size(); ++k) {
      ids[2 * k] = static_cast<ZOLTAN_ID_TYPE>(own.rank);
      ids[2 * k + 1] = places[k] = static_cast<ZOLTAN_ID_TYPE>(k);
      weights[k] = own.weights[k];
    }
    *error = ZOLTAN_OK;
  }
  static int dimensions(void*, int* error) {
    *error = ZOLTAN_OK;
    return 3;
  }
  static void places(void* data, int, int, int count, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int,
                     double* x, int* error) {
    for (int k = 0; k < count; ++k) {
      const auto& p = of(data).points[local[k]];
      *x++ = p.x, *x++ = p.y, *x++ = p.z;
    }
    *error = ZOLTAN_OK;
  }
};

}  // namespace detail

/// Recursive coordinate bisection by Zoltan, for MPI. Bisection does the same without Zoltan.
///
/// Zoltan cuts by planes normal to the axes. It is given the points sheared by a millionth, so that
/// the points of a lattice do not lie in one plane, which no cut could divide.
///
/// Source: Devine, Boman, Heaphy, Hendrickson, Vaughan, Computing in Science & Engineering 4 (2002)
///         90-97 (recalled); Zoltan of Trilinos 13.2, LB_METHOD = RCB.
/// Errors: InputError for a tolerance below 1, Error if Zoltan fails.
/// Tests:  tests/mpi/decompositions.cpp (work beside Bisection's).
/// Valid:  as Bisection, where Zoltan is installed.
/// Units:  [m]; work in units of the weights.
struct Rcb {
  double tolerance = 1.002;  // [-] largest over mean work at which Zoltan stops refining
  detail::ZoltanHandle zoltan = {};
  int ranks = 0;     // number of ranks
  bool cut = false;  // whether there have been points

  static constexpr bool by_place = true;

  std::vector<int> partition(const MpiComm& comm, std::span<const Vec3d> points,
                             std::span<const double> weights) {
    require(std::isfinite(tolerance) && tolerance >= 1, "Rcb.tolerance = ", tolerance,
            " [-] must be finite and at least 1");
    const detail::WholeWeights whole(comm, points, weights);
    if (whole.points > 0) {
      std::exception_ptr error;
      try {
        divide(comm, points, whole);
      } catch (const Error&) {
        error = std::current_exception();
      }
      agree(comm, "Zoltan's RCB", error);
    }
    std::vector<int> owner;
    owner.reserve(points.size());
    for (const auto& p : points) owner.push_back(is_finite(p) ? rank_of(p) : comm.rank());
    return owner;
  }

  int rank_of(const Vec3d& place) const {
    if (!cut) return 0;
    const auto p = sheared(place);
    double x[] = {p.x, p.y, p.z};
    int rank = 0, part = 0;
    detail::check_zoltan(Zoltan_LB_Point_PP_Assign(zoltan.get(), x, &rank, &part),
                         "Zoltan_LB_Point_PP_Assign");
    return rank;
  }

 private:
  static Vec3d sheared(const Vec3d& p) {
    constexpr double a = 1e-6, b = 1e-10;
    return {p.x + a * p.y + b * p.z, p.y + a * p.z + b * p.x, p.z + a * p.x + b * p.y};
  }

  void divide(const MpiComm& comm, std::span<const Vec3d> points,
              const detail::WholeWeights& whole) {
    if (!zoltan || ranks != comm.size()) {
      zoltan.make(comm);
      ranks = comm.size();
      for (const auto& [parameter, value] : {std::pair{"LB_METHOD", "RCB"},
                                             {"KEEP_CUTS", "1"},
                                             {"RETURN_LISTS", "NONE"},
                                             {"AVERAGE_CUTS", "1"},
                                             {"RCB_REUSE", "1"},
                                             {"REMAP", "0"}})
        zoltan.set(parameter, value);
    }
    zoltan.set("IMBALANCE_TOL", std::to_string(tolerance));
    detail::ZoltanPoints own{{}, {}, comm.rank()};
    const double mean = static_cast<double>(whole.total) / static_cast<double>(whole.points);
    for (std::size_t k = 0; k < points.size(); ++k)
      if (is_finite(points[k])) {
        own.points.push_back(sheared(points[k]));
        own.weights.push_back(static_cast<float>(static_cast<double>(whole.weights[k]) / mean));
      }
    Zoltan_Struct* z = zoltan.get();
    Zoltan_Set_Num_Obj_Fn(z, detail::ZoltanPoints::count, &own);
    Zoltan_Set_Obj_List_Fn(z, detail::ZoltanPoints::list, &own);
    Zoltan_Set_Num_Geom_Fn(z, detail::ZoltanPoints::dimensions, &own);
    Zoltan_Set_Geom_Multi_Fn(z, detail::ZoltanPoints::places, &own);
    zoltan.partition([](unsigned, int) {});  // its cuts are enough: rank_of
    cut = true;
  }
};
static_assert(Decomposition<Rcb, MpiComm>);

}  // namespace silt
