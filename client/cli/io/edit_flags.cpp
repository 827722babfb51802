#include "cli/io/edit_flags.h"

#include <array>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "cli/exit_code.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/vertex_channel.h"
#include "pleat/mesh/mesh_limits.h"

namespace pleat {
namespace {

struct FlagWords {
  EditKind kind;
  const char* value;
  const char* help;
};
constexpr std::array<FlagWords, 17> kFlags = {{
    {EditKind::kOffsetRotation, "JOINTS=X,Y,Z", "turns bones further, degrees"},
    {EditKind::kScaleRotation, "JOINTS=FACTOR", "more or less of the motion of bones"},
    {EditKind::kOffsetRoot, "X,Y,Z", "moves the body, meters"},
    {EditKind::kLimit, "JOINTS=SWING[,TWIST]", "cuts the angles of bones, degrees"},
    {EditKind::kMirror, "", "left becomes right"},
    {EditKind::kSmooth, "JOINTS=SECONDS", "Gaussian means over time; name the root to smooth it"},
    {EditKind::kTimeScale, "FACTOR", "the duration times this"},
    {EditKind::kTimeWarp, "FROM=TO,FROM=TO,...", "what was at FROM comes at TO, seconds"},
    {EditKind::kResample, "FPS", "the same motion at another frame rate"},
    {EditKind::kTrim, "FROM,TO", "keeps what is between, seconds"},
    {EditKind::kLoop, "BLEND[,COUNT]",
     "the last BLEND seconds lead back to the start; COUNT rounds"},
    {EditKind::kBlend, "FILE=WEIGHT[:JOINTS]", "towards another motion of the character, 0 to 1"},
    {EditKind::kConcatenate, "FILE[=BLEND]", "another motion follows; BLEND seconds of transition"},
    {EditKind::kBoneScale, "JOINTS=FACTOR", "lengths of the bones that end in JOINTS"},
    {EditKind::kDetail, "JOINTS=STRENGTH", "strength of the folds where bones move them, 0 to 2"},
    {EditKind::kVertexDetail, "FILE", "the same painted on vertices: .npy, or .json with a list"},
    {EditKind::kCleanFeet, "", "holds feet still while they stand"},
}};

const FlagWords& WordsOf(EditKind kind) { return kFlags[static_cast<size_t>(kind)]; }

absl::Status ValueFault(EditKind kind, const std::string& text) {
  return UsageError(absl::StrCat(EditFlag(kind), " '", text, "' is not ", WordsOf(kind).value));
}

absl::StatusOr<std::vector<double>> ParseNumbers(EditKind kind, const std::string& text,
                                                 absl::string_view list) {
  std::vector<double> numbers;
  for (const absl::string_view part : absl::StrSplit(list, ',')) {
    double number = 0;
    if (!absl::SimpleAtod(part, &number)) return ValueFault(kind, text);
    numbers.push_back(number);
  }
  return numbers;
}

// Deals the numbers out to the fields of the form; those that may be left out follow.
absl::Status DealNumbers(const std::string& text, std::vector<double> numbers, MotionEdit* edit) {
  if (edit->kind == EditKind::kLimit && numbers.size() == 1) numbers.push_back(180);
  if (edit->kind == EditKind::kLoop && numbers.size() == 1) numbers.push_back(1);
  size_t next = 0;
  for (const EditField& field : FormOf(edit->kind).fields) {
    if (next + field.count > numbers.size()) return ValueFault(edit->kind, text);
    edit->numbers.emplace_back(numbers.begin() + static_cast<std::ptrdiff_t>(next),
                               numbers.begin() + static_cast<std::ptrdiff_t>(next + field.count));
    next += field.count;
  }
  return next == numbers.size() ? absl::OkStatus() : ValueFault(edit->kind, text);
}

absl::Status ParseTimeWarp(const std::string& text, MotionEdit* edit) {
  edit->numbers.resize(2);
  for (const absl::string_view key : absl::StrSplit(text, ',')) {
    const std::vector<std::string> times = absl::StrSplit(key, '=');
    double from = 0, to = 0;
    if (times.size() != 2 || !absl::SimpleAtod(times[0], &from) ||
        !absl::SimpleAtod(times[1], &to)) {
      return ValueFault(edit->kind, text);
    }
    edit->numbers[0].push_back(from);
    edit->numbers[1].push_back(to);
  }
  return absl::OkStatus();
}

// "FILE=NUMBER[:JOINTS]", and for --concatenate the file alone.
absl::Status ParseOther(const std::string& text, MotionEdit* edit) {
  const bool is_blend = edit->kind == EditKind::kBlend;
  std::string file = text;
  double number = is_blend ? 0 : .3;
  if (is_blend) edit->joints = {"all"};
  const size_t equals = text.rfind('=');
  if (equals != std::string::npos) {
    file = text.substr(0, equals);
    const std::pair<std::string, std::string> value =
        absl::StrSplit(text.substr(equals + 1), absl::MaxSplits(':', 1));
    if (!absl::SimpleAtod(value.first, &number)) return ValueFault(edit->kind, text);
    if (is_blend && !value.second.empty()) edit->joints = absl::StrSplit(value.second, '+');
  } else if (is_blend) {
    return ValueFault(edit->kind, text);
  }
  edit->numbers = {{number}};
  PLEAT_ASSIGN_OR_RETURN(edit->other, ReadFile(file, MeshLimits().max_document_bytes));
  return absl::OkStatus();
}

}  // namespace

std::string EditFlag(EditKind kind) {
  if (kind == EditKind::kVertexDetail) return "--detail-channel";
  return absl::StrCat("--", absl::StrReplaceAll(std::string(FormOf(kind).name), {{"_", "-"}}));
}

std::string EditFlagValue(EditKind kind) { return WordsOf(kind).value; }
std::string EditFlagHelp(EditKind kind) { return WordsOf(kind).help; }

absl::StatusOr<MotionEdit> ParseEditFlag(EditKind kind, const std::string& text) {
  const EditForm& form = FormOf(kind);
  MotionEdit edit{.kind = kind};
  absl::Status status;
  if (form.has_other) {
    status = ParseOther(text, &edit);
  } else if (kind == EditKind::kTimeWarp) {
    status = ParseTimeWarp(text, &edit);
  } else if (kind == EditKind::kVertexDetail) {
    PLEAT_ASSIGN_OR_RETURN(std::vector<float> strengths, ReadVertexChannel(text));
    edit.numbers.emplace_back(strengths.begin(), strengths.end());
  } else if (!form.fields.empty()) {
    std::string list = text;
    if (form.has_joints) {
      const size_t equals = text.find('=');
      if (equals == std::string::npos) return ValueFault(kind, text);
      edit.joints = absl::StrSplit(text.substr(0, equals), '+', absl::SkipEmpty());
      list = text.substr(equals + 1);
    }
    PLEAT_ASSIGN_OR_RETURN(std::vector<double> numbers, ParseNumbers(kind, text, list));
    status = DealNumbers(text, std::move(numbers), &edit);
  }
  PLEAT_RETURN_IF_ERROR(status);
  const absl::Status checked = CheckEdit(edit);
  if (!checked.ok()) return UsageError(absl::StrCat(EditFlag(kind), " ", checked.message()));
  return edit;
}

std::string DescribeEdit(const MotionEdit& edit) {
  std::string text(FormOf(edit.kind).name);
  if (!edit.joints.empty()) absl::StrAppend(&text, " of ", absl::StrJoin(edit.joints, ", "));
  for (const std::vector<double>& numbers : edit.numbers) {
    if (numbers.size() <= 8) {
      absl::StrAppend(&text, " ", absl::StrJoin(numbers, ","));
    } else {
      absl::StrAppend(&text, " (", numbers.size(), " numbers)");
    }
  }
  return text;
}

}  // namespace pleat
