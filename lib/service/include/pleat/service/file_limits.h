// What a file may hold that a service reads.
#pragma once

#include "pleat/mesh/mesh_limits.h"
#include "pleat/service/limits.h"

namespace pleat {

// Returns what readers of meshes and sequences allow under `limits`. Of a file that is packed, at
// most twice its largest size is unpacked.
MeshLimits FileLimits(const ServiceLimits& limits);

}  // namespace pleat
