// silt - BSD-3-Clause, see LICENSE
#pragma once

/// All drag laws of spheres, and of mixtures of their sizes.
#include <silt/coupling/drag/beetstra.hpp>
#include <silt/coupling/drag/di_felice.hpp>
#include <silt/coupling/drag/ergun.hpp>
#include <silt/coupling/drag/koch_hill.hpp>
#include <silt/coupling/drag/lone_sphere.hpp>
#include <silt/coupling/drag/polydisperse.hpp>
#include <silt/coupling/drag/syamlal_obrien.hpp>
#include <silt/coupling/drag/tenneti.hpp>
#include <silt/coupling/drag/wen_yu.hpp>
