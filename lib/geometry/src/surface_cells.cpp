#include "pleat/geometry/surface_cells.h"

#include <algorithm>
#include <limits>
#include <set>

#include "surface_neighbors.h"

namespace pleat {
namespace {

std::vector<int> SpreadVertices(const Eigen::Matrix3Xd& positions, int count) {
  std::vector<int> chosen;
  Eigen::VectorXd squared =
      Eigen::VectorXd::Constant(positions.cols(), std::numeric_limits<double>::infinity());
  while (static_cast<int>(chosen.size()) < std::min<Eigen::Index>(count, positions.cols())) {
    Eigen::Index farthest = 0;
    // Vertices at the place of a chosen one would only double its cell.
    if (!(squared.maxCoeff(&farthest) > 0)) break;
    chosen.push_back(static_cast<int>(farthest));
    const Eigen::Vector3d center = positions.col(farthest);
    squared = squared.cwiseMin((positions.colwise() - center).colwise().squaredNorm().transpose());
  }
  return chosen;
}

}  // namespace

SurfaceCells MakeSurfaceCells(const Topology& topology, const Eigen::Matrix3Xd& positions,
                              int count) {
  SurfaceCells cells{SpreadVertices(positions, count), {}};
  const auto nearest = FindSurfaceNeighbors(topology, positions, cells.centers, 1);
  std::set<std::array<int, 2>> pairs;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const auto face = topology.face(f);
    for (size_t corner = 0; corner < face.size(); ++corner) {
      const auto& a = nearest[face[corner]];
      const auto& b = nearest[face[(corner + 1) % face.size()]];
      if (a.empty() || b.empty() || a[0].source == b[0].source) continue;
      const auto [first, second] = std::minmax(a[0].source, b[0].source);
      pairs.insert({first, second});
    }
  }
  cells.neighbors.assign(pairs.begin(), pairs.end());
  return cells;
}

}  // namespace pleat
