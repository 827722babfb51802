#include "bone_scales.h"

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr double kMinBoneScale = 0.05, kMaxBoneScale = 20;

}  // namespace

absl::Status CheckBoneScales(const std::vector<double>& bone_scales, int num_joints) {
  if (bone_scales.empty()) return absl::OkStatus();
  if (static_cast<int>(bone_scales.size()) != num_joints) {
    return absl::InvalidArgumentError(absl::StrCat(bone_scales.size(), " bone scales for ",
                                                   num_joints, " joints; give all or none"));
  }
  for (int j = 0; j < num_joints; ++j) {
    if (!(bone_scales[j] >= kMinBoneScale && bone_scales[j] <= kMaxBoneScale)) {
      return absl::InvalidArgumentError(absl::StrCat("bone scale ", bone_scales[j], " of joint ", j,
                                                     " is outside ", kMinBoneScale, " to ",
                                                     kMaxBoneScale));
    }
  }
  return absl::OkStatus();
}

}  // namespace pleat
