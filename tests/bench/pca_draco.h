// The baseline that the sequence codec is measured against: principal components of the frames
// whose integer coefficients are coded as Draco attributes.
#pragma once

#include <cstddef>

#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

struct PcaDracoResult {
  size_t num_bytes =
      0;  // mean, components, weights, centroids; not the order of vertices and faces
  int num_components = 0;
  double kg_percent = 0;
};

// The smallest of several numbers of components at a KG error of at most kg_percent.
PcaDracoResult CompressWithPcaDraco(const MeshSequence& sequence, double kg_percent);

}  // namespace pleat
