// Small meshes that are hard for a codec.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/mesh/topology.h"

namespace pleat {

struct TestMesh {
  Topology topology;
  Eigen::Matrix3Xf positions;  // 3 x V
};

// A closed torus of m x n quads in shuffled vertex order (major radius 1, minor .3 m).
inline TestMesh MakeTorus(int m, int n, uint64_t seed) {
  std::vector<int> shuffled(m * n);
  for (int i = 0; i < m * n; ++i) shuffled[i] = i;
  Random random(seed);
  for (int i = m * n - 1; i > 0; --i) std::swap(shuffled[i], shuffled[random.UniformInt(i + 1)]);
  Eigen::Matrix3Xf positions(3, m * n);
  std::vector<int32_t> corners, sizes;
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = 2 * M_PI * i / m, w = 2 * M_PI * j / n;
      const double radius = 1 + .3 * std::cos(w);
      positions.col(shuffled[i * n + j]) << static_cast<float>(radius * std::cos(u)),
          static_cast<float>(.3 * std::sin(w)), static_cast<float>(radius * std::sin(u));
      const int right = (i + 1) % m, up = (j + 1) % n;
      corners.insert(corners.end(), {shuffled[i * n + j], shuffled[right * n + j],
                                     shuffled[right * n + up], shuffled[i * n + up]});
      sizes.push_back(4);
    }
  }
  return {Topology::Create(m * n, corners, sizes).value(), positions};
}

// The same torus with `extra` triangles (over its vertices and `num_extra` new ones).
inline TestMesh WithExtra(const TestMesh& mesh, int num_extra,
                          const std::vector<Eigen::Vector3i>& extra) {
  TestMesh result = mesh;
  const int old = mesh.topology.num_vertices();
  result.positions.conservativeResize(3, old + num_extra);
  for (int i = 0; i < num_extra; ++i) {
    result.positions.col(old + i) << .1f * static_cast<float>(i), .7f, -.2f;
  }
  Eigen::Matrix3Xi triangles = mesh.topology.triangles();
  const Eigen::Index count = triangles.cols();
  triangles.conservativeResize(3, count + static_cast<Eigen::Index>(extra.size()));
  for (size_t i = 0; i < extra.size(); ++i) triangles.col(count + i) = extra[i];
  result.topology = Topology::FromTriangles(old + num_extra, triangles).value();
  return result;
}

// The mesh moved and bent a little; `t` is a frame number.
inline Eigen::Matrix3Xf Bend(const Eigen::Matrix3Xf& positions, int t) {
  Eigen::Matrix3Xf result = positions;
  for (int v = 0; v < positions.cols(); ++v) {
    result(0, v) += .1f * std::sin(3 * positions(1, v) + .2f * static_cast<float>(t));
    result(1, v) += .05f * static_cast<float>(t);
  }
  return result;
}

// Rows of quads as pairs of triangles, vertices numbered as the faces first use them.
inline Topology QuadsAsModeled(int rows, int columns) {
  std::vector<int> numbers((rows + 1) * (columns + 1), -1);
  int num_vertices = 0;
  std::vector<int32_t> corners;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int first = row * (columns + 1) + column;
      int quad[4] = {first, first + 1, first + columns + 2, first + columns + 1};
      for (int& corner : quad) {
        if (numbers[corner] < 0) numbers[corner] = num_vertices++;
        corner = numbers[corner];
      }
      corners.insert(corners.end(), {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
    }
  }
  return *Topology::Create(num_vertices, corners,
                           std::vector<int32_t>(2 * static_cast<size_t>(rows * columns), 3));
}

}  // namespace pleat
