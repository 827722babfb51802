#include "pleat/geometry/medial_samples.h"

#include <algorithm>
#include <cmath>

namespace pleat {

std::vector<MedialSample> FindMedialSamples(const DistanceField& field,
                                            const MedialSampleOptions& options) {
  std::vector<MedialSample> samples;
  const Eigen::Vector3i& num = field.num_nodes();
  const double spacing = field.spacing();
  for (int z = 0; z < num.z(); ++z) {
    for (int y = 0; y < num.y(); ++y) {
      for (int x = 0; x < num.x(); ++x) {
        const int node = field.NodeIndex(x, y, z);
        const double depth = -field.node_distance(node);
        // A sample between two nodes can be deeper than either by at most the spacing.
        if (depth <= 0 || depth < options.min_depth - spacing) continue;
        const Eigen::Vector3f& direction = field.node_direction(node);
        for (int axis = 0; axis < 3; ++axis) {
          Eigen::Vector3i next(x, y, z);
          if (++next[axis] >= num[axis]) continue;
          const int next_node = field.NodeIndex(next.x(), next.y(), next.z());
          const double next_depth = -field.node_distance(next_node);
          const Eigen::Vector3f& next_direction = field.node_direction(next_node);
          if (next_depth <= 0 || direction.dot(next_direction) > options.max_cosine) continue;
          // The depth grows from both ends as if both nearest surfaces were planes; it is largest
          // where the two lines meet.
          const double slope = -direction[axis], next_slope = next_direction[axis];
          const double sum = slope + next_slope;
          const double step =
              sum > 1e-9
                  ? std::clamp((next_depth - depth + spacing * next_slope) / sum, 0.0, spacing)
                  : (depth > next_depth ? 0 : spacing);
          const double sample_depth = std::max({depth, next_depth, depth + step * slope});
          if (sample_depth < options.min_depth) continue;
          Eigen::Vector3d position = field.NodePosition(x, y, z);
          position[axis] += step;
          samples.push_back({position, sample_depth});
        }
      }
    }
  }
  return samples;
}

}  // namespace pleat
