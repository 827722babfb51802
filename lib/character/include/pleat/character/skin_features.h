// What the regional learner knows about a pose beside its joints: how the skin stretches and bends
// where each region is, as principal components of skinned edges
// (docs/method/learner.md#skinned-edges).
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/learner/coefficient_fold.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/skin_edges.h"

namespace pleat {

// What a model file holds. E: edges, k: components of a region.
struct SkinFeaturesParameters {
  struct Region {
    std::vector<int> edges;  // e of the E edges, ascending; a region without any has no features
    DetailBasisParameters weights;  // k x 3 e in planes of 8-bit integers, of mean zero
    Eigen::VectorXf offset;         // k: features = weights (values of the edges) - offset
  };
  SkinEdgesParameters edges;
  // 3 E, near the values of the edges, or empty. It is taken off the values before these are
  // rounded for the product, and changes nothing else.
  Eigen::VectorXf center;
  std::vector<Region> regions;
};

// Immutable: threads share it.
class SkinFeatures {
 public:
  // The memory of one thread, reused without allocation.
  struct Workspace {
    SkinEdges::Workspace edges;
    Eigen::VectorXf values;    // 3 E, without the center
    Eigen::VectorXf gathered;  // those of each region's edges, region after region
    Eigen::VectorXf features;  // D_E
    CoefficientFold::Workspace projection;
  };

  // kInvalidArgument when sizes do not fit, an edge is out of range or a number is not finite.
  static absl::StatusOr<SkinFeatures> FromParameters(const Rig& rig,
                                                     SkinFeaturesParameters parameters);
  SkinFeaturesParameters parameters() const;

  int num_features() const { return num_features_; }  // D_E, all regions one after the other
  int num_regions() const { return static_cast<int>(region_ends_.size()); }
  // The features of a region are [begin, end).
  int region_begin(int region) const { return region == 0 ? 0 : region_ends_[region - 1]; }
  int region_end(int region) const { return region_ends_[region]; }
  size_t memory_bytes() const;

  // Returns the features of the first `count` regions alone. rig: the one that they were made with.
  SkinFeatures FirstRegions(const Rig& rig, int count) const;

  // Writes the features (D_E) of a pose, without an allocation after the first call. transforms: of
  // the rig's skeleton, without stretched bones.
  void Compute(const BoneTransforms& transforms, Workspace* workspace,
               Eigen::Ref<Eigen::VectorXd> features) const;

  // Does the same in two steps, for several poses at once: what is computed for each pose, and the
  // product with the weights, which are read once. features: D_E. The bits are those of Compute().
  void Gather(const BoneTransforms& transforms, Workspace* workspace) const;
  struct Query {
    Workspace* workspace = nullptr;  // after Gather(); another for each query
    double* features = nullptr;
  };
  void Project(std::span<const Query> queries) const;

  // The features of all frames, T x D_E.
  Eigen::MatrixXd ComputeTrack(const Skeleton& skeleton, const PoseTrack& track,
                               int num_threads) const;

 private:
  explicit SkinFeatures(SkinEdges edges) : edges_(std::move(edges)) {}

  SkinEdges edges_;
  std::vector<std::vector<int>> region_edges_;
  std::vector<int> region_ends_;
  CoefficientFold projection_;       // from the gathered values, one block for each region
  Eigen::VectorXf center_;           // 3 E
  Eigen::VectorXf offset_;           // D_E, as it is stored
  Eigen::VectorXf centered_offset_;  // D_E, of values without the center
  int num_features_ = 0;
};

}  // namespace pleat
