// Polygons one after the other as a file lists them. Small where a file's vertices are numbered
// about in the order in which its faces use them and its faces come in rows, as modeling programs
// write them; connectivity_coder.h is for files whose order says nothing. Any polygon soup is
// accepted.
#pragma once

#include "absl/status/statusor.h"
#include "binary_coder.h"
#include "pleat/mesh/topology.h"

namespace pleat {

void EncodeFaceList(const Topology& topology, BinaryCoder* coder);

// num_corners: the sum of all face sizes. kDataLoss when the code is damaged, kResourceExhausted
// when it would take too long.
absl::StatusOr<Topology> DecodeFaceList(int num_vertices, int num_faces, int num_corners,
                                        BinaryCoder* coder);

}  // namespace pleat
