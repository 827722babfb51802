#include "surface_nets.h"

#include <vector>

namespace pleat {
namespace {

// The filter along one axis, which halves the number of samples there: sample i of the result lies
// between the voxels 2 i - 1 and 2 i.
std::vector<float> HalveAlong(const std::vector<float>& values, Eigen::Vector3i* size, int axis) {
  const int length = (*size)[axis], half = length / 2 + 1;
  const int stride = axis == 0 ? 1 : axis == 1 ? size->x() : size->x() * size->y();
  const int num_blocks = static_cast<int>(values.size()) / (length * stride);
  std::vector<float> result(static_cast<size_t>(num_blocks) * half * stride);
  static constexpr float kFilter[4] = {.125f, .375f, .375f, .125f};
  for (int block = 0; block < num_blocks; ++block) {
    const float* line = values.data() + static_cast<size_t>(block) * length * stride;
    float* to = result.data() + static_cast<size_t>(block) * half * stride;
    for (int middle = 0; middle < half; ++middle, to += stride) {
      for (int k = 0; k < 4; ++k) {
        const int i = 2 * middle - 2 + k;
        if (i < 0 || i >= length) continue;
        for (int j = 0; j < stride; ++j) to[j] += kFilter[k] * line[i * stride + j];
      }
    }
  }
  (*size)[axis] = half;
  return result;
}

class Extraction {
 public:
  Extraction(const VoxelGrid& grid, const VoxelMask& mask) : size_(grid.size) {
    values_.assign(mask.begin(), mask.end());
    for (int axis = 0; axis < 3; ++axis) values_ = HalveAlong(values_, &size_, axis);
    vertices_.assign(values_.size(), -1);
    PlaceVertices(grid);
    ConnectVertices();
  }

  Eigen::Matrix3Xd positions() const {
    return Eigen::Map<const Eigen::Matrix3Xd>(points_.data()->data(), 3,
                                              static_cast<Eigen::Index>(points_.size()));
  }
  Eigen::Matrix3Xi triangles() const {
    return Eigen::Map<const Eigen::Matrix3Xi>(triangles_.data()->data(), 3,
                                              static_cast<Eigen::Index>(triangles_.size()));
  }
  bool empty() const { return triangles_.empty(); }

 private:
  int Index(const Eigen::Vector3i& at) const {
    return at.x() + size_.x() * (at.y() + size_.y() * at.z());
  }
  float Value(const Eigen::Vector3i& at) const { return values_[Index(at)] - .5f; }

  template <typename Visit>
  void ForNodes(int margin, const Visit& visit) const {
    for (int z = margin; z + 1 < size_.z(); ++z) {
      for (int y = margin; y + 1 < size_.y(); ++y) {
        for (int x = margin; x + 1 < size_.x(); ++x) visit(Eigen::Vector3i(x, y, z));
      }
    }
  }

  // A cell is named after its corner with the lowest indices.
  void PlaceVertices(const VoxelGrid& grid) {
    const int dy = size_.x(), dz = size_.x() * size_.y();
    const int corners[8] = {0, 1, dy, dy + 1, dz, dz + 1, dz + dy, dz + dy + 1};
    ForNodes(0, [&](const Eigen::Vector3i& cell) {
      int num_inside = 0;
      const float* values = values_.data() + Index(cell);
      for (const int corner : corners) num_inside += values[corner] > .5f ? 1 : 0;
      if (num_inside == 0 || num_inside == 8) return;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int count = 0;
      for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 4; ++side) {
          Eigen::Vector3i from = cell;
          from[(axis + 1) % 3] += side & 1;
          from[(axis + 2) % 3] += side >> 1;
          Eigen::Vector3i to = from;
          ++to[axis];
          const float a = Value(from), b = Value(to);
          if ((a > 0) == (b > 0)) continue;
          Eigen::Vector3d crossing = from.cast<double>();
          crossing[axis] += a / (a - b);
          sum += crossing;
          ++count;
        }
      }
      vertices_[Index(cell)] = static_cast<int>(points_.size());
      points_.emplace_back(grid.origin + 2 * grid.spacing * (sum / count));
    });
  }

  // Each edge of the grid that the surface crosses has four cells around it, whose vertices make
  // two triangles.
  void ConnectVertices() {
    ForNodes(1, [&](const Eigen::Vector3i& from) {
      for (int axis = 0; axis < 3; ++axis) {
        Eigen::Vector3i to = from;
        ++to[axis];
        const bool is_inside = Value(from) > 0;
        if (is_inside == (Value(to) > 0)) continue;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        int around[4];
        for (int k = 0; k < 4; ++k) {
          Eigen::Vector3i cell = from;
          cell[u] -= k == 0 || k == 3 ? 1 : 0;
          cell[v] -= k == 0 || k == 1 ? 1 : 0;
          around[k] = vertices_[Index(cell)];
        }
        if (!is_inside) std::swap(around[1], around[3]);
        triangles_.emplace_back(around[0], around[1], around[2]);
        triangles_.emplace_back(around[0], around[2], around[3]);
      }
    });
  }

  Eigen::Vector3i size_;
  std::vector<float> values_;
  std::vector<int> vertices_;  // per cell, -1 = none
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace

void ExtractSurface(const VoxelGrid& grid, const VoxelMask& mask, Eigen::Matrix3Xd* positions,
                    Eigen::Matrix3Xi* triangles) {
  const Extraction extraction(grid, mask);
  positions->resize(3, 0);
  triangles->resize(3, 0);
  if (extraction.empty()) return;
  *positions = extraction.positions();
  *triangles = extraction.triangles();
}

}  // namespace pleat
