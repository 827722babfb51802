// Small closed triangle meshes: polygonized shapes, unions of capsules, boxes, spheres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"

namespace pleat {

struct TriangleMesh {
  Eigen::Matrix3Xd positions;  // 3 x V
  Eigen::Matrix3Xi triangles;  // 3 x F, outward
};

// The zero surface of `signed_distance` (negative inside) in `box`, by marching tetrahedra on a
// grid of `cell` meters: closed and oriented outward when the box encloses the shape.
inline TriangleMesh PolygonizeShape(
    const std::function<double(const Eigen::Vector3d&)>& signed_distance,
    const Eigen::AlignedBox3d& box, double cell) {
  Eigen::Vector3i num;
  for (int k = 0; k < 3; ++k) num[k] = static_cast<int>(std::ceil(box.sizes()[k] / cell)) + 1;
  const auto index = [&](const Eigen::Vector3i& n) {
    return n.x() + num.x() * (n.y() + num.y() * n.z());
  };
  const auto position = [&](int n) {
    return Eigen::Vector3d(box.min() + cell * Eigen::Vector3d(n % num.x(), n / num.x() % num.y(),
                                                              n / (num.x() * num.y())));
  };
  std::vector<double> values(num.prod());
  for (size_t n = 0; n < values.size(); ++n) {
    values[n] = signed_distance(position(static_cast<int>(n)));
    if (values[n] == 0) values[n] = 1e-12;
  }
  std::map<std::pair<int, int>, int> crossings;  // grid edge -> vertex
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3i> triangles;
  const auto crossing = [&](int a, int b) {
    const auto [entry, is_new] = crossings.try_emplace(std::minmax(a, b), positions.size());
    if (is_new) {
      const double share = values[a] / (values[a] - values[b]);
      positions.push_back(position(a) + share * (position(b) - position(a)));
    }
    return entry->second;
  };
  const auto add = [&](int a, int b, int c, const Eigen::Vector3d& outward) {
    const Eigen::Vector3d normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    triangles.push_back(normal.dot(outward) > 0 ? Eigen::Vector3i(a, b, c)
                                                : Eigen::Vector3i(a, c, b));
  };
  // Six tetrahedra around the diagonal 0-7 of each cube.
  static constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                            {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (int z = 0; z + 1 < num.z(); ++z) {
    for (int y = 0; y + 1 < num.y(); ++y) {
      for (int x = 0; x + 1 < num.x(); ++x) {
        for (const auto& tetrahedron : kTetrahedra) {
          std::vector<int> inside, outside;
          Eigen::Vector3d outward = Eigen::Vector3d::Zero();
          for (int corner : tetrahedron) {
            const int n =
                index(Eigen::Vector3i(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)));
            (values[n] < 0 ? inside : outside).push_back(n);
          }
          if (inside.empty() || outside.empty()) continue;
          for (int n : outside) outward += position(n) / outside.size();
          for (int n : inside) outward -= position(n) / inside.size();
          if (inside.size() == 2) {
            const int a = crossing(inside[0], outside[0]), b = crossing(inside[0], outside[1]);
            const int c = crossing(inside[1], outside[1]), d = crossing(inside[1], outside[0]);
            add(a, b, c, outward);
            add(a, c, d, outward);
          } else {
            const std::vector<int>& one = inside.size() == 1 ? inside : outside;
            const std::vector<int>& three = inside.size() == 1 ? outside : inside;
            add(crossing(one[0], three[0]), crossing(one[0], three[1]), crossing(one[0], three[2]),
                outward);
          }
        }
      }
    }
  }
  TriangleMesh mesh;
  mesh.positions.resize(3, positions.size());
  for (size_t v = 0; v < positions.size(); ++v) mesh.positions.col(v) = positions[v];
  mesh.triangles.resize(3, triangles.size());
  for (size_t f = 0; f < triangles.size(); ++f) mesh.triangles.col(f) = triangles[f];
  return mesh;
}

struct Capsule {
  Eigen::Vector3d start, end;
  double start_radius, end_radius;
};

// The union of capsules, slightly rounded where they meet, cut off flat at the height `floor`.
inline TriangleMesh MakeCapsuleBody(const std::vector<Capsule>& capsules, double cell,
                                    double floor = -1e9) {
  Eigen::AlignedBox3d box;
  for (const Capsule& capsule : capsules) {
    const double radius = std::max(capsule.start_radius, capsule.end_radius) + 2 * cell;
    for (const Eigen::Vector3d& end : {capsule.start, capsule.end}) {
      box.extend(Eigen::Vector3d(end.array() - radius));
      box.extend(Eigen::Vector3d(end.array() + radius));
    }
  }
  const auto signed_distance = [&](const Eigen::Vector3d& point) {
    double nearest = 1e9;
    for (const Capsule& capsule : capsules) {
      const Eigen::Vector3d axis = capsule.end - capsule.start;
      const double share =
          std::clamp(axis.dot(point - capsule.start) / axis.squaredNorm(), 0.0, 1.0);
      const double radius =
          capsule.start_radius + share * (capsule.end_radius - capsule.start_radius);
      nearest = std::min(nearest, (capsule.start + share * axis - point).norm() - radius);
    }
    return std::max(nearest, floor - point.y());
  };
  return PolygonizeShape(signed_distance, box, cell);
}

// A horse-like body, two meters long, its head towards +z.
inline TriangleMesh MakeCapsuleQuadruped(double cell = 0.03) {
  std::vector<Capsule> capsules = {{{0, 1.1, -.6}, {0, 1.1, .5}, .26, .26},
                                   {{0, 1.15, .6}, {0, 1.7, 1.0}, .16, .11},
                                   {{0, 1.7, 1.0}, {0, 1.5, 1.4}, .12, .07},
                                   {{0, 1.2, -.8}, {0, .7, -1.1}, .04, .04}};
  for (double side : {-1, 1}) {
    for (double z : {-.65, .5}) {
      capsules.push_back({{side * .16, 1.0, z}, {side * .17, .5, z + .03}, .12, .07});
      capsules.push_back({{side * .17, .5, z + .03}, {side * .17, .06, z}, .06, .05});
    }
  }
  return MakeCapsuleBody(capsules, cell);
}

// An axis-aligned box of 12 triangles.
inline TriangleMesh MakeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  mesh.positions.resize(3, 8);
  for (int v = 0; v < 8; ++v) {
    mesh.positions.col(v) << (v & 1 ? high : low).x(), (v & 2 ? high : low).y(),
        (v & 4 ? high : low).z();
  }
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

// A sphere of about `num_rings` triangles across.
inline TriangleMesh MakeSphere(const Eigen::Vector3d& center, double radius, int num_rings = 24) {
  Eigen::AlignedBox3d box(center.array() - 1.2 * radius, center.array() + 1.2 * radius);
  return PolygonizeShape([&](const Eigen::Vector3d& p) { return (p - center).norm() - radius; },
                         box, 2 * radius / num_rings);
}

// Both meshes in one.
inline TriangleMesh JoinMeshes(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.positions.resize(3, a.positions.cols() + b.positions.cols());
  mesh.positions << a.positions, b.positions;
  mesh.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  mesh.triangles << a.triangles,
      (b.triangles.array() + static_cast<int>(a.positions.cols())).matrix();
  return mesh;
}

inline Topology MakeTopology(const TriangleMesh& mesh) {
  return *Topology::FromTriangles(static_cast<int>(mesh.positions.cols()), mesh.triangles);
}

// A sequence of one frame.
inline MeshSequence MakeStillSequence(const TriangleMesh& mesh) {
  MeshSequenceOptions options;
  options.name = "figure";
  return *MeshSequence::Create(MakeTopology(mesh), {mesh.positions.cast<float>()}, options);
}

}  // namespace pleat
