// Simple meshes. Closed ones face outward.
#pragma once

#include <Eigen/Core>

#include "pleat/mesh/topology.h"

namespace pleat {

struct MeshShape {
  Topology topology;
  Eigen::Matrix3Xd positions;  // 3 x V, meters
};

// Makes num_x x num_z quads in the plane y = 0, centered, facing +y; size_x and size_z are in
// meters.
MeshShape MakeGrid(int num_x, int num_z, double size_x, double size_z);

// Makes six quads around the origin; `size` holds the edge lengths in meters.
MeshShape MakeBox(const Eigen::Vector3d& size);

// Makes a closed surface around the origin with poles on the y axis: rings of quads between two
// fans of triangles, with num_rings >= 1 circles of vertices between the poles and num_segments >=
// 3 around.
MeshShape MakeUvSphere(double radius, int num_rings, int num_segments);

// Makes an open cylinder around the y axis, centered, with num_rings >= 2 circles of vertices.
MeshShape MakeTube(double radius, double length, int num_rings, int num_segments);

// Makes a closed cylinder with hemispheres: `length` is that of the straight part, which has
// num_rings >= 2 circles of vertices; each hemisphere has num_cap_rings >= 0 more.
MeshShape MakeCapsule(double radius, double length, int num_rings, int num_cap_rings,
                      int num_segments);

}  // namespace pleat
