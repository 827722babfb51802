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
  // The fast answer first; only a bad frame is searched for its first bad vertex.
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
  Data data{std::move(topology), {}, std::move(options)};
  for (Eigen::Matrix3Xf& frame : frames) {
    data.frames.push_back(std::make_shared<const Eigen::Matrix3Xf>(std::move(frame)));
  }
  return MeshSequence(std::make_shared<const Data>(std::move(data)));
}

MeshSequence MeshSequence::Subset(const std::vector<int>& frame_indices) const {
  assert(!frame_indices.empty());
  Data subset{data_->topology, {}, data_->options};
  subset.options.frame_names.clear();
  for (int t : frame_indices) subset.frames.push_back(data_->frames[t]);
  return MeshSequence(std::make_shared<const Data>(std::move(subset)));
}

MeshSequence MeshSequence::Join(const std::vector<MeshSequence>& clips) {
  assert(!clips.empty());
  Data joined{clips[0].topology(), {}, clips[0].data_->options};
  joined.options.frame_names.clear();
  for (const MeshSequence& clip : clips) {
    assert(clip.topology() == clips[0].topology());
    joined.frames.insert(joined.frames.end(), clip.data_->frames.begin(), clip.data_->frames.end());
  }
  return MeshSequence(std::make_shared<const Data>(std::move(joined)));
}

}  // namespace pleat
