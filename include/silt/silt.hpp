// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <silt/boundary/cone.hpp>
#include <silt/boundary/cylinder.hpp>
#include <silt/boundary/domain.hpp>
#include <silt/boundary/motion.hpp>
#include <silt/boundary/plane.hpp>
#include <silt/boundary/stl.hpp>
#include <silt/boundary/triangle_mesh.hpp>
#include <silt/boundary/wall.hpp>
#include <silt/contact/contacts.hpp>
#include <silt/contact/hertz_mindlin.hpp>
#include <silt/contact/impact.hpp>
#include <silt/contact/linear_spring.hpp>
#include <silt/contact/rolling/epsd.hpp>
#include <silt/coupling/no_fluid.hpp>
#include <silt/fill/particle_file.hpp>
#include <silt/fill/particles.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/observers.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/cell_grid.hpp>
#include <silt/search/hashed_grid.hpp>
#include <silt/search/nbs.hpp>
#include <silt/search/verlet_list.hpp>
#include <silt/shape/sphere.hpp>
#include <silt/simulation.hpp>
