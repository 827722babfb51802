#include "pleat/character/skin_features.h"

#include <algorithm>
#include <array>
#include <functional>

#include "absl/strings/str_cat.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckRegion(const SkinFeaturesParameters::Region& region, int num_edges) {
  const std::vector<int>& edges = region.edges;
  if (edges.empty() || edges.front() < 0 || edges.back() >= num_edges ||
      std::adjacent_find(edges.begin(), edges.end(), std::greater_equal<>()) != edges.end()) {
    return absl::InvalidArgumentError(
        absl::StrCat("skin features: the edges of a region do not ascend below ", num_edges));
  }
  if (region.weights.num_components != 3 * static_cast<int64_t>(edges.size()) ||
      region.weights.values.rows() < 1 || region.offset.size() != region.weights.values.rows() ||
      !region.offset.allFinite()) {
    return absl::InvalidArgumentError(
        absl::StrCat("skin features: weights are ", region.weights.values.rows(), " x ",
                     region.weights.num_components, " with ", region.offset.size(), " offsets for ",
                     edges.size(), " edges"));
  }
  return absl::OkStatus();
}

// Copies the values of the edges of a region, one after the other; returns the end of `target`.
float* CopyEdges(const Eigen::VectorXf& values, const std::vector<int>& edges, float* target) {
  for (const int edge : edges) {
    target = std::copy_n(values.data() + 3 * static_cast<ptrdiff_t>(edge), 3, target);
  }
  return target;
}

// The offset of features that are computed from values without the center.
Eigen::VectorXf CenteredOffset(const CoefficientFoldBlock& block, const std::vector<int>& edges,
                               const Eigen::VectorXf& center,
                               const Eigen::Ref<const Eigen::VectorXf>& offset) {
  Eigen::VectorXf own(3 * static_cast<Eigen::Index>(edges.size()));
  CopyEdges(center, edges, own.data());
  return (offset.cast<double>() - block.Dense() * own.cast<double>()).cast<float>();
}

}  // namespace

absl::StatusOr<SkinFeatures> SkinFeatures::FromParameters(const Rig& rig,
                                                          SkinFeaturesParameters parameters) {
  const int num_edges = static_cast<int>(parameters.edges.edges.size());
  PLEAT_ASSIGN_OR_RETURN(SkinEdges edges, SkinEdges::Create(rig, std::move(parameters.edges)));
  if (parameters.center.size() == 0) parameters.center.setZero(edges.num_values());
  if (parameters.center.size() != edges.num_values() || !parameters.center.allFinite()) {
    return absl::InvalidArgumentError(absl::StrCat("skin features: the center has ",
                                                   parameters.center.size(), " values for ",
                                                   num_edges, " edges, or they are not finite"));
  }
  SkinFeatures result(std::move(edges));
  result.center_ = std::move(parameters.center);
  std::vector<CoefficientFoldBlock> blocks;
  int num_gathered = 0;
  for (SkinFeaturesParameters::Region& region : parameters.regions) {
    result.region_ends_.push_back(result.num_features_);
    result.region_edges_.push_back(region.edges);
    if (region.edges.empty() && region.weights.values.rows() == 0) continue;
    PLEAT_RETURN_IF_ERROR(CheckRegion(region, num_edges));
    const auto count = static_cast<int>(region.offset.size());
    result.offset_.conservativeResize(result.num_features_ + count);
    result.offset_.tail(count) = region.offset;
    blocks.push_back({num_gathered, {{result.num_features_, count}}, std::move(region.weights)});
    num_gathered += 3 * static_cast<int>(region.edges.size());
    result.num_features_ += count;
    result.region_ends_.back() = result.num_features_;
  }
  PLEAT_ASSIGN_OR_RETURN(result.projection_,
                         CoefficientFold::FromBlocks(blocks, num_gathered, result.num_features_));
  result.centered_offset_ = result.offset_;
  auto block = blocks.begin();
  for (const std::vector<int>& own : result.region_edges_) {
    if (own.empty()) continue;
    const auto [first, count] = block->targets[0];
    auto offset = result.centered_offset_.segment(first, count);
    offset = CenteredOffset(*block, own, result.center_, offset.eval());
    ++block;
  }
  return result;
}

SkinFeaturesParameters SkinFeatures::parameters() const {
  SkinFeaturesParameters p{edges_.parameters(), center_, {}};
  std::vector<CoefficientFoldBlock> blocks = projection_.blocks();
  auto block = blocks.begin();
  for (const std::vector<int>& edges : region_edges_) {
    p.regions.emplace_back();
    if (edges.empty()) continue;
    const auto [first, count] = block->targets[0];
    p.regions.back() = {edges, std::move(block->weights), offset_.segment(first, count)};
    ++block;
  }
  return p;
}

SkinFeatures SkinFeatures::FirstRegions(const Rig& rig, int count) const {
  SkinFeaturesParameters p = parameters();
  p.regions.resize(static_cast<size_t>(count));
  return FromParameters(rig, std::move(p)).value();
}

size_t SkinFeatures::memory_bytes() const {
  size_t bytes = edges_.memory_bytes() + projection_.memory_bytes();
  for (const std::vector<int>& edges : region_edges_) bytes += edges.size() * sizeof(int);
  return bytes;
}

void SkinFeatures::Compute(const BoneTransforms& transforms, Workspace* workspace,
                           Eigen::Ref<Eigen::VectorXd> features) const {
  Gather(transforms, workspace);
  const Query query{.workspace = workspace, .features = features.data()};
  Project({&query, 1});
}

void SkinFeatures::Gather(const BoneTransforms& transforms, Workspace* workspace) const {
  Workspace& w = *workspace;
  w.values.resize(edges_.num_values());
  w.gathered.resize(projection_.num_inputs());
  edges_.Compute(transforms, &w.edges, w.values);
  w.values -= center_;
  float* target = w.gathered.data();
  for (const std::vector<int>& edges : region_edges_) target = CopyEdges(w.values, edges, target);
}

void SkinFeatures::Project(std::span<const Query> queries) const {
  constexpr size_t kMostTogether = 16;
  std::array<CoefficientFold::Query, kMostTogether> products;
  for (size_t begin = 0; begin < queries.size(); begin += kMostTogether) {
    const auto together = queries.subspan(begin, std::min(kMostTogether, queries.size() - begin));
    for (size_t q = 0; q < together.size(); ++q) {
      Workspace& w = *together[q].workspace;
      w.features.resize(num_features_);
      products[q] = {
          .inputs = w.gathered.data(), .outputs = w.features.data(), .workspace = &w.projection};
    }
    projection_.Apply({products.data(), together.size()});
    for (const Query& query : together) {
      Eigen::Map<Eigen::VectorXd>(query.features, num_features_) =
          (query.workspace->features - centered_offset_).cast<double>();
    }
  }
}

Eigen::MatrixXd SkinFeatures::ComputeTrack(const Skeleton& skeleton, const PoseTrack& track,
                                           int num_threads) const {
  constexpr int kItemFrames = 32;
  const int num_frames = track.num_frames();
  Eigen::MatrixXd rows(num_frames, num_features_);
  ParallelFor((num_frames + kItemFrames - 1) / kItemFrames, num_threads, [&](int item) {
    Workspace workspace;
    BoneTransforms transforms;
    Eigen::VectorXd row(num_features_);
    for (int t = item * kItemFrames; t < std::min(num_frames, (item + 1) * kItemFrames); ++t) {
      ComputeBoneTransforms(skeleton, track.pose(t), {}, &transforms);
      Compute(transforms, &workspace, row);
      rows.row(t) = row.transpose();
    }
  });
  return rows;
}

}  // namespace pleat
