#include "pleat/mesh/mesh_sequence.h"

#include <cassert>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

std::string FrameLabel(const MeshSequenceOptions& options, size_t t) {
  return t < options.frame_names.size()
             ? absl::StrCat("frame ", t, " ('", options.frame_names[t], "')")
             : absl::StrCat("frame ", t);
}

absl::Status CheckFrame(const Eigen::Matrix3Xf& frame, int num_vertices, const std::string& label) {
  if (frame.cols() != num_vertices) {
    return absl::InvalidArgumentError(
        absl::StrCat(label, " has ", frame.cols(), " vertices, the topology has ", num_vertices));
  }
  if (frame.allFinite()) return absl::OkStatus();
  for (Eigen::Index v = 0; v < frame.cols(); ++v) {
    if (!frame.col(v).allFinite()) {
      return absl::InvalidArgumentError(
          absl::StrCat(label, ", vertex ", v, ": position (", frame(0, v), ", ", frame(1, v), ", ",
                       frame(2, v), ") is not finite; repair or remove the frame"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<MeshSequence> MeshSequence::Create(Topology topology,
                                                  std::vector<Eigen::Matrix3Xf> frames,
                                                  MeshSequenceOptions options) {
  if (frames.empty()) {
    return absl::InvalidArgumentError("a mesh sequence needs at least one frame");
  }
  if (options.frame_rate.numerator <= 0 || options.frame_rate.denominator <= 0) {
    return absl::InvalidArgumentError(absl::StrCat("frame rate ", options.frame_rate.numerator, "/",
                                                   options.frame_rate.denominator,
                                                   " is not positive"));
  }
  if (absl::Status status = CheckAppearance(options.appearance, topology); !status.ok()) {
    return status;
  }
  for (size_t t = 0; t < frames.size(); ++t) {
    if (absl::Status status =
            CheckFrame(frames[t], topology.num_vertices(), FrameLabel(options, t));
        !status.ok()) {
      return status;
    }
  }
  return MeshSequence(std::make_shared<const Data>(
      Data{std::move(topology), std::move(frames), std::move(options)}));
}

MeshSequence MeshSequence::Subset(const std::vector<int>& frame_indices) const {
  assert(!frame_indices.empty());
  Data subset{data_->topology, {}, data_->options};
  subset.options.frame_names.clear();
  for (int t : frame_indices) subset.frames.push_back(data_->frames[t]);
  return MeshSequence(std::make_shared<const Data>(std::move(subset)));
}

}  // namespace pleat
