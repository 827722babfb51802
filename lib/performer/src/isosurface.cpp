// Marching tetrahedra (Doi and Koide 1991) on the Freudenthal subdivision of a regular grid: six
// tetrahedra per cell, each a monotone path of corners from 000 to 111, alike in every cell, so
// neighboring cells share their faces' diagonals.
#include "isosurface.h"

#include <algorithm>
#include <cmath>

#include "pleat/base/parallel.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr std::array<std::array<int, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

class Marcher {
 public:
  Marcher(const Vector3d& low, const Vector3d& high, double spacing)
      : low_(low), spacing_(spacing) {
    size_ = ((high - low) / spacing).array().ceil().matrix().cast<int>() + Vector3i::Ones();
    values_.resize(static_cast<size_t>(size_.x()) * size_.y() * size_.z());
    edge_vertices_.assign(values_.size() * 8, -1);
  }

  absl::Status Sample(const std::function<double(const Vector3d&)>& distance,
                      const Progress& progress) {
    ParallelFor(size_.z(), 0, [&](int k) {
      if (progress.cancelled()) return;
      for (int j = 0; j < size_.y(); ++j) {
        for (int i = 0; i < size_.x(); ++i) {
          values_[Index(i, j, k)] = distance(Position(Vector3i(i, j, k)));
        }
      }
    });
    return progress.Report(.8);
  }

  TriangleSoup March() {
    for (int k = 0; k + 1 < size_.z(); ++k) {
      for (int j = 0; j + 1 < size_.y(); ++j) {
        for (int i = 0; i + 1 < size_.x(); ++i) MarchCell(Vector3i(i, j, k));
      }
    }
    return std::move(soup_);
  }

 private:
  size_t Index(int i, int j, int k) const {
    return (static_cast<size_t>(k) * size_.y() + j) * size_.x() + i;
  }
  Vector3d Position(const Vector3i& cell) const { return low_ + spacing_ * cell.cast<double>(); }
  static Vector3i Corner(int bits) { return {bits & 1, bits >> 1 & 1, bits >> 2 & 1}; }
  double Value(const Vector3i& cell, int bits) const {
    const Vector3i c = cell + Corner(bits);
    return values_[Index(c.x(), c.y(), c.z())];
  }

  void MarchCell(const Vector3i& cell) {
    int inside_corners = 0;
    for (int bits = 0; bits < 8; ++bits) inside_corners += Value(cell, bits) < 0;
    if (inside_corners == 0 || inside_corners == 8) return;
    for (const std::array<int, 4>& tetrahedron : kTetrahedra) MarchTetrahedron(cell, tetrahedron);
  }

  void MarchTetrahedron(const Vector3i& cell, const std::array<int, 4>& corners) {
    std::array<int, 4> inside{}, outside{};
    int num_inside = 0, num_outside = 0;
    for (int bits : corners) {
      (Value(cell, bits) < 0 ? inside[num_inside++] : outside[num_outside++]) = bits;
    }
    if (num_inside == 0 || num_outside == 0) return;
    Vector3d outward = Vector3d::Zero();  // from the inner to the outer corners
    for (int i = 0; i < num_inside; ++i) {
      outward -= Corner(inside[i]).cast<double>() / num_inside;
    }
    for (int i = 0; i < num_outside; ++i) {
      outward += Corner(outside[i]).cast<double>() / num_outside;
    }
    using Edge = std::array<int, 2>;  // inner and outer corner
    if (num_inside == 2) {            // a quadrilateral
      const Edge a{inside[0], outside[0]}, b{inside[0], outside[1]}, c{inside[1], outside[1]},
          d{inside[1], outside[0]};
      AddTriangle(cell, a, b, c, outward);
      AddTriangle(cell, a, c, d, outward);
    } else if (num_inside == 1) {
      AddTriangle(cell, {inside[0], outside[0]}, {inside[0], outside[1]}, {inside[0], outside[2]},
                  outward);
    } else {
      AddTriangle(cell, {inside[0], outside[0]}, {inside[1], outside[0]}, {inside[2], outside[0]},
                  outward);
    }
  }

  void AddTriangle(const Vector3i& cell, const std::array<int, 2>& a, const std::array<int, 2>& b,
                   const std::array<int, 2>& c, const Vector3d& outward) {
    // Orientation is judged on edge midpoints, which are exact numbers, unlike the crossings
    // themselves.
    const auto middle = [](const std::array<int, 2>& e) {
      return Vector3d((Corner(e[0]) + Corner(e[1])).cast<double>());
    };
    const Vector3d normal = (middle(b) - middle(a)).cross(middle(c) - middle(a));
    std::array<int, 3> triangle = {EdgeVertex(cell, a), EdgeVertex(cell, b), EdgeVertex(cell, c)};
    if (normal.dot(outward) < 0) std::swap(triangle[1], triangle[2]);
    soup_.triangles.push_back(triangle);
  }

  // An edge is named by its lower grid point and the bits of the offset to the other one, so that
  // all tetrahedra around it share one vertex. That is what makes the surface closed.
  int EdgeVertex(const Vector3i& cell, const std::array<int, 2>& edge) {
    const int low = std::min(edge[0], edge[1]), high = std::max(edge[0], edge[1]);
    const Vector3i origin = cell + Corner(low);
    int& vertex = edge_vertices_[Index(origin.x(), origin.y(), origin.z()) * 8 + (low ^ high)];
    if (vertex < 0) {
      vertex = static_cast<int>(soup_.positions.size());
      const double a = Value(cell, low), b = Value(cell, high);
      // Crossings are kept off the grid points, where several vertices would coincide.
      const double t = std::clamp(a / (a - b), .02, .98);
      soup_.positions.push_back((1 - t) * Position(origin) + t * Position(cell + Corner(high)));
    }
    return vertex;
  }

  Vector3d low_;
  double spacing_;
  Vector3i size_;
  std::vector<double> values_;
  std::vector<int> edge_vertices_;  // per grid point and direction 1..7 (bits of the offset)
  TriangleSoup soup_;
};

}  // namespace

absl::StatusOr<TriangleSoup> ExtractIsosurface(
    const std::function<double(const Vector3d&)>& distance, const Vector3d& low,
    const Vector3d& high, double spacing, const Progress& progress) {
  Marcher marcher(low, high, spacing);
  PLEAT_RETURN_IF_ERROR(marcher.Sample(distance, progress));
  TriangleSoup soup = marcher.March();
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return soup;
}

}  // namespace pleat
