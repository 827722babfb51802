// Skinning weights: at most eight bones per vertex.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "absl/status/statusor.h"

namespace pleat {

inline constexpr int kMaxInfluences = 8;
// What automatic rigs begin with, and what every engine takes.
inline constexpr int kStandardInfluences = 4;

// The bones that move one vertex. Bone b is the bone that ends in joint b (b >= 1).
struct VertexInfluences {
  std::array<uint16_t, kMaxInfluences> bones{};
  std::array<float, kMaxInfluences> weights{};  // >= 0, sum 1, falling; unused entries are 0
};

// Returns the kMaxInfluences largest of `bone_weights` (bone -> weight >= 0, at least one
// positive), normalized.
VertexInfluences StrongestInfluences(const std::map<int, double>& bone_weights);

// Skinning weights of a mesh, valid by construction: finite, non-negative, normalized, with bones
// in [1, num_joints).
class SkinWeights {
 public:
  // Keeps the kStandardInfluences largest weights of every row of `dense` (V x num_joints, column b
  // = bone b, column 0 ignored) and normalizes them. The error is kInvalidArgument and names the
  // first vertex without weight.
  static absl::StatusOr<SkinWeights> FromDense(const Eigen::Ref<const Eigen::MatrixXd>& dense);
  // Checks `influences` and takes them as they are (sums within 1e-4 of 1, used entries first),
  // but for the bones of unused entries, which become 0. The error is kInvalidArgument and names
  // the first bad vertex.
  static absl::StatusOr<SkinWeights> Create(int num_joints,
                                            std::vector<VertexInfluences> influences);

  int num_vertices() const { return static_cast<int>(influences_.size()); }
  int num_joints() const { return num_joints_; }
  const VertexInfluences& vertex(int v) const { return influences_[v]; }
  const std::vector<VertexInfluences>& influences() const { return influences_; }
  // The largest number of bones that move one vertex.
  int most_influences() const;
  Eigen::MatrixXd ToDense() const;  // V x num_joints

 private:
  int num_joints_ = 0;
  std::vector<VertexInfluences> influences_;
};

}  // namespace pleat
