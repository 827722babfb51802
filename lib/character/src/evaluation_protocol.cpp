// The frame splits of docs/method/evaluation.md#protocols.
#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/character/evaluate.h"

namespace pleat {
namespace {

constexpr std::array<std::pair<EvaluationProtocol, const char*>, 5> kProtocols = {{
    {EvaluationProtocol::kReconstruct, "reconstruct"},
    {EvaluationProtocol::kEvery5th, "every5th"},
    {EvaluationProtocol::kBlocks10, "blocks10"},
    {EvaluationProtocol::kLast30, "last30"},
    {EvaluationProtocol::kCross, "cross"},
}};

bool IsTestFrame(EvaluationProtocol protocol, int t, int num_frames) {
  switch (protocol) {
    case EvaluationProtocol::kEvery5th:
      return t % 5 == 2;
    case EvaluationProtocol::kBlocks10: {
      const int start = t < 15 ? -1 : t - (t - 15) % 35;  // where the block of t would begin
      return start >= 0 && start < num_frames - 5 && t < start + 10;
    }
    case EvaluationProtocol::kLast30:
      return t >= num_frames - num_frames * 3 / 10;
    case EvaluationProtocol::kReconstruct:
    case EvaluationProtocol::kCross:
      return false;
  }
  return false;
}

}  // namespace

absl::StatusOr<EvaluationProtocol> ParseEvaluationProtocol(const std::string& name) {
  std::string known;
  for (const auto& [protocol, protocol_name] : kProtocols) {
    if (name == protocol_name) return protocol;
    absl::StrAppend(&known, known.empty() ? "" : ", ", protocol_name);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("unknown protocol '", name, "'; choose one of ", known));
}

const char* EvaluationProtocolName(EvaluationProtocol protocol) {
  for (const auto& [known, name] : kProtocols) {
    if (known == protocol) return name;
  }
  return "unknown";
}

absl::StatusOr<FrameSplit> SplitFrames(EvaluationProtocol protocol, int num_frames) {
  FrameSplit split;
  for (int t = 0; t < num_frames; ++t) {
    if (protocol == EvaluationProtocol::kReconstruct) split.test.push_back(t);
    (IsTestFrame(protocol, t, num_frames) ? split.test : split.train).push_back(t);
  }
  if (protocol != EvaluationProtocol::kCross && (split.train.size() < 2 || split.test.empty())) {
    return absl::InvalidArgumentError(absl::StrCat(
        "protocol ", EvaluationProtocolName(protocol), " needs a longer sequence: ", num_frames,
        " frames leave ", split.train.size(), " to train and ", split.test.size(), " to test"));
  }
  return split;
}

}  // namespace pleat
