// Two kinds of regions, each of which covers the whole body: one region for each bone, and 60
// patches of the surface. Bones know which joints matter; patches do not cut a skirt where the rig
// says that one leg ends and the other begins. The mean of both errs less than either, on every
// sequence that was measured (docs/performance.md, "Regions"). The numbers of components were
// chosen on blocks held out inside the training frames.
#include "regional_data.h"

#include <utility>

#include "body_regions.h"
#include "detail_regions.h"
#include "pleat/base/status.h"
#include "skin_features_train.h"

namespace pleat {
namespace {

constexpr int kNumPatches = 60;
constexpr int kBoneComponents = 128, kBoneSkinFeatures = 48;
constexpr int kPatchComponents = 48, kPatchSkinFeatures = 24;
constexpr double kShareOfBones = .5;  // in the prediction; patches have the rest

void SetSizes(int max_components, int max_skin_features, std::vector<BodyRegion>* regions) {
  for (BodyRegion& region : *regions) {
    region.max_components = max_components;
    region.max_skin_features = max_skin_features;
  }
}

}  // namespace

RegionalData RegionalData::OfRows(const std::vector<int>& rows) const {
  RegionalData part{regions, num_bone_regions, skin_features, {}};
  if (skin_features) part.skin_rows = skin_rows(rows, Eigen::all);
  return part;
}

RegionalData RegionalData::WithoutPatches(const Rig& rig) const {
  RegionalData bones{
      {regions.begin(), regions.begin() + num_bone_regions}, num_bone_regions, {}, {}};
  for (DetailRegion& region : bones.regions) region.weights /= kShareOfBones;
  if (!skin_features) return bones;
  bones.skin_features = skin_features->FirstRegions(rig, num_bone_regions);
  bones.skin_rows = skin_rows.leftCols(bones.skin_features->num_features());
  return bones;
}

absl::StatusOr<RegionalData> ComputeRegionalData(const Topology& topology, const Rig& rig,
                                                 const PoseTrack& track,
                                                 const std::vector<int>& control_vertices,
                                                 int num_pose_features, const TrainOptions& options,
                                                 int num_threads) {
  std::vector<BodyRegion> body = BoneRegions(rig, control_vertices);
  SetSizes(kBoneComponents, kBoneSkinFeatures, &body);
  std::vector<BodyRegion> patches = PatchRegions(rig, control_vertices, kNumPatches);
  SetSizes(kPatchComponents, kPatchSkinFeatures, &patches);
  RegionalData data;
  data.num_bone_regions = static_cast<int>(body.size());
  data.regions = DetailRegions(body, rig.skeleton, control_vertices, kShareOfBones, options);
  const std::vector<DetailRegion> more =
      DetailRegions(patches, rig.skeleton, control_vertices, 1 - kShareOfBones, options);
  data.regions.insert(data.regions.end(), more.begin(), more.end());
  body.insert(body.end(), patches.begin(), patches.end());
  PLEAT_ASSIGN_OR_RETURN(SkinFeatures features, TrainSkinFeatures(topology, rig, track, body,
                                                                  {.num_threads = num_threads}));
  if (features.num_features() == 0) return data;
  data.skin_rows = features.ComputeTrack(rig.skeleton, track, num_threads);
  AddSkinFeatureSets(features, num_pose_features, &data.regions);
  data.skin_features = std::move(features);
  return data;
}

}  // namespace pleat
