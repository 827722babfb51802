// What each kind of edit has: the one list that the reader, the writer and the command line follow.
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/formats/edited_motion_file.h"

namespace pleat {
namespace {

constexpr double kFarDegrees = 36'000, kFarMeters = 1e6, kLongSeconds = 1e6;

}  // namespace

const std::vector<EditForm>& EditForms() {
  static const std::vector<EditForm> kForms = {
      {EditKind::kOffsetRotation,
       "offset_rotation",
       true,
       false,
       {{"degrees", 3, -kFarDegrees, kFarDegrees}}},
      {EditKind::kScaleRotation, "scale_rotation", true, false, {{"factor", 1, -100, 100}}},
      {EditKind::kOffsetRoot,
       "offset_root",
       false,
       false,
       {{"meters", 3, -kFarMeters, kFarMeters}}},
      {EditKind::kLimit,
       "limit",
       true,
       false,
       {{"swing_degrees", 1, 0, 180}, {"twist_degrees", 1, 0, 180}}},
      {EditKind::kMirror, "mirror", false, false, {}},
      {EditKind::kSmooth, "smooth", true, false, {{"seconds", 1, 0, 10}}},
      {EditKind::kTimeScale, "time_scale", false, false, {{"factor", 1, .01, 100}}},
      {EditKind::kTimeWarp,
       "time_warp",
       false,
       false,
       {{"from_seconds", 0, 0, kLongSeconds}, {"to_seconds", 0, 0, kLongSeconds}}},
      {EditKind::kResample, "resample", false, false, {{"fps", 1, .1, 1000}}},
      {EditKind::kTrim,
       "trim",
       false,
       false,
       {{"from_seconds", 1, 0, kLongSeconds}, {"to_seconds", 1, 0, kLongSeconds}}},
      {EditKind::kLoop, "loop", false, false, {{"blend_seconds", 1, 0, 60}, {"count", 1, 1, 1000}}},
      {EditKind::kBlend, "blend", true, true, {{"weight", 1, 0, 1}}},
      {EditKind::kConcatenate, "concatenate", false, true, {{"blend_seconds", 1, 0, 60}}},
      {EditKind::kBoneScale, "bone_scale", true, false, {{"factor", 1, .05, 20}}},
      {EditKind::kDetail, "detail", true, false, {{"strength", 1, 0, 2}}},
      {EditKind::kVertexDetail, "vertex_detail", false, false, {{"strengths", 0, 0, 2}}},
      {EditKind::kCleanFeet, "clean_feet", false, false, {}},
  };
  return kForms;
}

const EditForm& FormOf(EditKind kind) { return EditForms()[static_cast<size_t>(kind)]; }

absl::Status CheckEdit(const MotionEdit& edit) {
  const EditForm& form = FormOf(edit.kind);
  const auto fault = [&](const std::string& what) {
    return absl::InvalidArgumentError(absl::StrCat(std::string(form.name), ": ", what));
  };
  if (form.has_joints && edit.joints.empty()) return fault("'joints' is empty");
  if (form.has_other && edit.other.empty()) return fault("'motion' is missing");
  for (size_t f = 0; f < form.fields.size(); ++f) {
    const EditField& field = form.fields[f];
    const std::string name(field.name);
    const size_t count = f < edit.numbers.size() ? edit.numbers[f].size() : 0;
    if (count == 0) return fault(absl::StrCat("'", name, "' is missing"));
    if (field.count > 0 && count != field.count) {
      return fault(absl::StrCat("'", name, "' has ", count, " numbers in place of ", field.count));
    }
    for (const double number : edit.numbers[f]) {
      if (number >= field.min && number <= field.max) continue;
      return fault(
          absl::StrCat("'", name, "' is ", number, ", outside ", field.min, " to ", field.max));
    }
  }
  return absl::OkStatus();
}

}  // namespace pleat
