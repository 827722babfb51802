#include "dynamics.h"

#include <algorithm>

#include "pleat/math/clip_starts.h"

namespace pleat {

DynamicsRows MakeDynamicsRows(const std::vector<int>& clip_starts, int num_rows, int order) {
  DynamicsRows rows;
  rows.order = order;
  for (const ClipRange& clip : ClipRanges(clip_starts, num_rows)) {
    // The first `order` rows of each clip have no predecessors in it.
    for (int t = clip.begin; t < clip.end; ++t) {
      (t - clip.begin < order ? rows.firsts : rows.targets).push_back(t);
    }
  }
  return rows;
}

void DynamicsRows::Gather(const Eigen::MatrixXd& latents, Eigen::MatrixXd* inputs,
                          Eigen::MatrixXd* outputs) const {
  const Eigen::Index count = static_cast<Eigen::Index>(targets.size()), q = latents.cols();
  inputs->resize(count, order * q);
  outputs->resize(count, q);
  for (Eigen::Index i = 0; i < count; ++i) {
    outputs->row(i) = latents.row(targets[i]);
    for (int h = 0; h < order; ++h) {
      inputs->row(i).segment(h * q, q) = latents.row(targets[i] - 1 - h);
    }
  }
}

void DynamicsRows::Scatter(const Eigen::MatrixXd& input_gradient,
                           const Eigen::MatrixXd& output_gradient, double scale,
                           Eigen::MatrixXd* gradient) const {
  const Eigen::Index q = gradient->cols();
  for (size_t i = 0; i < targets.size(); ++i) {
    gradient->row(targets[i]) += scale * output_gradient.row(i);
    for (int h = 0; h < order; ++h) {
      gradient->row(targets[i] - 1 - h) += scale * input_gradient.row(i).segment(h * q, q);
    }
  }
}

}  // namespace pleat
