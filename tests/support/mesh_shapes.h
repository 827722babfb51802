// Simple meshes. Closed ones face outwards.
#pragma once

#include <Eigen/Core>

#include "pleat/mesh/topology.h"

namespace pleat {

struct MeshShape {
  Topology topology;
  Eigen::Matrix3Xd positions;  // 3 x V, meters
};

// num_x x num_z quads in the plane y = 0, centered, facing +y; size_x, size_z meters.
MeshShape MakeGrid(int num_x, int num_z, double size_x, double size_z);

// Six quads around the origin; edge lengths in `size`, meters.
MeshShape MakeBox(const Eigen::Vector3d& size);

// Closed surface around the origin with poles on the y axis: rings of quads between two fans of
// triangles. num_rings >= 1 circles of vertices between the poles, num_segments >= 3 around.
MeshShape MakeUvSphere(double radius, int num_rings, int num_segments);

// Open cylinder around the y axis, centered: num_rings >= 2 circles of vertices.
MeshShape MakeTube(double radius, double length, int num_rings, int num_segments);

// Closed cylinder with hemispheres: `length` is that of the straight part, which has num_rings >= 2
// circles of vertices; each hemisphere has num_cap_rings >= 0 more.
MeshShape MakeCapsule(double radius, double length, int num_rings, int num_cap_rings,
                      int num_segments);

}  // namespace pleat
