// Rows of the dynamics: which frames predict which, never across two clips.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

struct DynamicsRows {
  int order = 1;
  std::vector<int> targets;  // rows t that are predicted from t-1 (.. t-order)
  std::vector<int> firsts;   // rows without enough history: x ~ N(0, 1)

  // Copies inputs [x_(t-1), .., x_(t-order)] (N_d x order q) and outputs x_t (N_d x q).
  void Gather(const Eigen::MatrixXd& latents, Eigen::MatrixXd* inputs,
              Eigen::MatrixXd* outputs) const;
  // Adds `scale` times the gradients of Gather's results to d/dX (N x q). A row may be input of one
  // target and output of another, and gets both.
  void Scatter(const Eigen::MatrixXd& input_gradient, const Eigen::MatrixXd& output_gradient,
               double scale, Eigen::MatrixXd* gradient) const;
};

// `clip_starts` rises from 0; a clip of at most `order` rows has no targets.
DynamicsRows MakeDynamicsRows(const std::vector<int>& clip_starts, int num_rows, int order);

}  // namespace pleat
