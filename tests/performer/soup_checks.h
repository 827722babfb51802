// What several tests ask of a triangle soup.
#pragma once

#include <map>
#include <utility>

#include "isosurface.h"

namespace pleat {

// Every directed edge is there once, and so is its reverse.
inline bool IsClosedManifold(const TriangleSoup& soup) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : soup.triangles) {
    for (int c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  }
  return !edges.empty();
}

// V - E + F: 2 for a sphere, 0 for a torus. The soup must be closed.
inline int EulerCharacteristic(const TriangleSoup& soup) {
  return static_cast<int>(soup.positions.size()) - static_cast<int>(soup.triangles.size()) / 2;
}

inline double Volume(const TriangleSoup& soup) {
  double volume = 0;
  for (const auto& t : soup.triangles) {
    volume += soup.positions[t[0]].dot(soup.positions[t[1]].cross(soup.positions[t[2]])) / 6;
  }
  return volume;
}

inline double Sphere(const Eigen::Vector3d& p) { return p.norm() - 1; }
inline double Torus(const Eigen::Vector3d& p) {
  return std::hypot(std::hypot(p.x(), p.z()) - 1, p.y()) - .35;
}

}  // namespace pleat
