// silt - BSD-3-Clause, see LICENSE
#pragma once

// Eigen, for headers of silt that solve dense systems; most scenes do not need it. Found as
// <Eigen/Dense> by the flags of the project, or at its place in Debian.

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
// GCC 12 mistakes undefined values in its own AVX-512 intrinsics for an error in Eigen.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif
#if __has_include(<Eigen/Dense>)
#include <Eigen/Dense>
#elif __has_include(<eigen3/Eigen/Dense>)
#include <eigen3/Eigen/Dense>
#else
#error "this header of silt needs Eigen 3.4: apt-get install libeigen3-dev, or -I its folder"
#endif
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

#include <silt/core/target.hpp>
