// Polygons with their exact order, numbering and rotation, coded by growing a region of faces.
// Connectivity follows Gumhold and Strasser 1998 (cut-border machine) with vertex valences as
// context; numbers are coded as ranks among the numbers that are still free. Any polygon soup is
// accepted. See docs/method/codec.md#connectivity.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "binary_coder.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// A face, and which of its corners is visited first.
struct FaceVisit {
  int face = 0, first_corner = 0;
};
// Returns the order in which the coder visits the faces. Numbers and rotations in this order cost
// nothing; kept as a file has them they are about two thirds of the code.
std::vector<FaceVisit> VisitOrder(const Topology& topology);

// Codes `topology`. The decoder has to be told the counts of vertices, faces and corners.
void EncodeTopology(const Topology& topology, BinaryCoder* coder);

// Decodes what EncodeTopology wrote. num_corners: the sum of all face sizes. The error is kDataLoss
// when the code is damaged, kResourceExhausted when it would take too long.
absl::StatusOr<Topology> DecodeTopology(int num_vertices, int num_faces, int num_corners,
                                        BinaryCoder* coder);

}  // namespace pleat
