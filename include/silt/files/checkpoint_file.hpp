// silt - BSD-3-Clause, see LICENSE
#pragma once

// The file of a checkpoint: its reader and its writer.

#include <silt/files/checkpoint_reader.hpp>
#include <silt/files/checkpoint_writer.hpp>
