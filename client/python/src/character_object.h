// What pleat.Character is on this side of the boundary.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "arrays.h"
#include "pleat/character/pose_evaluator.h"

namespace pleat {

// A model with the evaluators that calls lend from it. Any number of threads may call it at once:
// a call that computes lets other threads of Python run, and takes an evaluator that nobody uses.
class CharacterObject {
 public:
  explicit CharacterObject(std::shared_ptr<const CharacterModel> model);

  const std::shared_ptr<const CharacterModel>& model() const { return model_; }
  std::vector<std::string> joint_names() const;
  std::vector<int> parents() const;
  pybind11::array_t<double> joint_positions() const;  // J x 3
  pybind11::array_t<int32_t> triangles() const;       // F x 3
  int num_vertices() const { return model_->num_vertices(); }
  int num_joints() const { return model_->skeleton().num_joints(); }
  int num_coefficients() const { return model_->full_basis().num_coefficients(); }
  int history() const { return model_->options().history; }

  // Every method returns positions (N x V x 3), which are `out` when it is given, and the
  // confidence (N) of each.
  pybind11::tuple EvaluateMotion(const PoseTrack& motion, const std::vector<double>& bone_scales,
                                 bool skinned_only, const pybind11::object& out,
                                 const pybind11::object& progress);
  // root_positions: N x H x 3, rotations: N x H x J x 4; pose h of a query is h intervals older.
  pybind11::tuple EvaluatePoses(const TakenArray<double>& root_positions,
                                const TakenArray<double>& rotations,
                                const std::vector<double>& bone_scales, bool skinned_only,
                                const pybind11::object& out);
  // The same poses -> root positions (N x 3), rotations (N x J x 4, float32), coefficients (N x r,
  // float32), confidence (N).
  pybind11::tuple Predict(const TakenArray<double>& root_positions,
                          const TakenArray<double>& rotations, bool skinned_only);
  // These -> positions. coefficients: N x r, or N x 0 for skinned only.
  pybind11::array_t<float> Show(const TakenArray<double>& root_positions,
                                const TakenArray<float>& rotations,
                                const TakenArray<float>& coefficients,
                                const std::vector<double>& bone_scales,
                                const pybind11::object& out);

 private:
  struct Lender {
    std::mutex mutex;
    std::vector<std::unique_ptr<PoseEvaluator>> idle;  // guarded by mutex
  };
  class Borrowed;

  // The rows of each of the N frames of `array`.
  std::vector<VertexRows> RowsOfFrames(pybind11::array_t<float>* array) const;

  std::shared_ptr<const CharacterModel> model_;
  std::shared_ptr<Lender> lender_;
};

}  // namespace pleat
