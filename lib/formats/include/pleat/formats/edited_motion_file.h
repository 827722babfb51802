// Motions with the list of their edits and the motion that they were made from
// (docs/formats/motion.md#edits). Such a file is a motion like any other to those who only play it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/formats/motion_file.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

enum class EditKind {
  kOffsetRotation,
  kScaleRotation,
  kOffsetRoot,
  kLimit,
  kMirror,
  kSmooth,
  kTimeScale,
  kTimeWarp,
  kResample,
  kTrim,
  kLoop,
  kBlend,
  kConcatenate,
  kBoneScale,
  kDetail,
  kVertexDetail,
  kCleanFeet,
};

// A list of numbers that an edit has.
struct EditField {
  std::string_view name;
  size_t count = 1;  // so many numbers; 0: a list of any length above 0
  double min = 0, max = 0;
};
// What the edits of a kind have.
struct EditForm {
  EditKind kind;
  std::string_view name;
  bool has_joints = false;  // a list of names, in which "all" is every joint but the root
  bool has_other = false;   // another motion
  std::vector<EditField> fields{};
};
const std::vector<EditForm>& EditForms();
const EditForm& FormOf(EditKind kind);

struct MotionEdit {
  EditKind kind = EditKind::kMirror;
  std::vector<std::string> joints{};
  std::vector<std::vector<double>> numbers{};  // one list for each field of the form
  std::string other{};                         // the text of another motion file

  // The first number of field i.
  double Number(size_t i) const { return numbers[i][0]; }
};
// kInvalidArgument says which field of the edit is missing, too long or out of range.
absl::Status CheckEdit(const MotionEdit& edit);

struct EditHistory {
  std::string source;  // the text of the motion file before the first edit
  std::vector<MotionEdit> edits;
};

inline constexpr size_t kMaxEdits = 1000;

// Reads the list of edits of a hostile motion file: of a file without one, the file itself is the
// source. kInvalidArgument names the edit and the field.
absl::StatusOr<EditHistory> DecodeEditHistory(std::string_view text, const MeshLimits& limits = {});

// The skeleton that a motion file has, or none. kInvalidArgument says what is wrong with it.
absl::StatusOr<std::optional<Skeleton>> DecodeMotionSkeleton(std::string_view text,
                                                             const MeshLimits& limits = {});

// The file of an edited motion: `motion` is what the edits make of the source. The history must
// have edits (asserted).
std::string EncodeEditedMotion(const Skeleton& skeleton, const Motion& motion,
                               const EditHistory& history);

}  // namespace pleat
