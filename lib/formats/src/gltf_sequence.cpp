#include "gltf_sequence.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "frame_times.h"
#include "glb_animation.h"
#include "glb_frames.h"
#include "glb_mesh.h"
#include "glb_pose.h"
#include "glb_remainders.h"
#include "glb_vertex_ids.h"
#include "gltf_file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

// How many vertices of morph targets are added for each vertex of a frame at most.
constexpr uint64_t kMaxTargetsPerVertex = 256;

// The weights of morph targets that a node has without an animation.
std::vector<float> WeightsOf(const GlbContainer& glb, int node) {
  const json& entry = glb.List("nodes")[static_cast<size_t>(node)];
  const json& mesh = glb.Entry("meshes", entry.value("mesh", json()));
  json list = entry.value("weights", json());
  if (!list.is_array() && mesh.is_object()) list = mesh.value("weights", json());
  std::vector<float> weights;
  for (const json& weight : list.is_array() ? list : json::array()) {
    weights.push_back(weight.is_number() ? weight.get<float>() : 0.f);
  }
  return weights;
}

class AnimationReader {
 public:
  AnimationReader(const GlbContainer& glb, GlbNodes nodes, const GlbAnimation& animation,
                  const InputReading& reading)
      : glb_(glb), nodes_(std::move(nodes)), animation_(animation), reading_(reading) {}

  absl::StatusOr<MeshSequence> Read(const std::string& path) {
    PLEAT_ASSIGN_OR_RETURN(mesh_, ReadGlbMesh(glb_, nodes_, false, reading_.options.limits));
    reading_.report->notes.insert(reading_.report->notes.end(), mesh_.notes.begin(),
                                  mesh_.notes.end());
    const GlbFrames frames = ChooseGlbFrames(
        animation_, {reading_.options.frame_rate, reading_.options.limits.max_frames},
        reading_.report);
    reading_.report->first_frame = FrameNumberAt(frames.times.front(), frames.rate);
    PLEAT_RETURN_IF_ERROR(
        CheckSequenceCounts({.num_vertices = mesh_.topology.num_vertices(),
                             .num_frames = static_cast<int64_t>(frames.times.size())},
                            reading_.options.limits));
    if (mesh_.parts.size() == 1) remainders_ = ReadGlbRemainders(glb_, mesh_.parts[0]);
    PLEAT_RETURN_IF_ERROR(PoseAll(frames.times));
    if (const auto originals = OriginalVertices(mesh_)) {
      JoinVertices(*originals, &mesh_, &frames_);
    }
    MeshSequenceOptions options;
    options.name = std::filesystem::path(path).stem().string();
    options.frame_rate = frames.rate;
    return CreateSequence({.topology = std::move(mesh_.topology),
                           .positions = {},
                           .appearance = std::move(mesh_.appearance)},
                          std::move(frames_), std::move(options), path);
  }

 private:
  absl::Status PoseAll(const std::vector<float>& times) {
    std::vector<GlbTransform> transforms = nodes_.transforms();
    std::vector<std::vector<float>> node_weights(static_cast<size_t>(nodes_.count()));
    for (const GlbPart& part : mesh_.parts) {
      if (!part.targets.empty()) {
        node_weights[static_cast<size_t>(part.node)] = WeightsOf(glb_, part.node);
      }
    }
    std::vector<std::vector<float>> weights(mesh_.parts.size());
    uint64_t num_added = 0;
    for (size_t t = 0; t < times.size(); ++t) {
      if (t % 16 == 0) {
        PLEAT_RETURN_IF_ERROR(
            reading_.progress.Report(static_cast<double>(t) / static_cast<double>(times.size())));
      }
      animation_.Sample(times[t], &transforms, &node_weights);
      nodes_.Pose(transforms);
      for (size_t p = 0; p < mesh_.parts.size(); ++p) {
        const GlbPart& part = mesh_.parts[p];
        weights[p] = node_weights[static_cast<size_t>(part.node)];
        const auto num_active = weights[p].size() - std::ranges::count(weights[p], 0.f);
        num_added +=
            static_cast<uint64_t>(num_active) * static_cast<uint64_t>(part.positions.cols());
      }
      if (num_added / 12 >
          kMaxTargetsPerVertex * (reading_.options.limits.max_sequence_bytes / 144)) {
        return absl::ResourceExhaustedError(
            "GLB: the morph targets of all frames together are more than can be added");
      }
      frames_.push_back(PlaceGlbMesh(mesh_, nodes_, weights));
      const bool is_in_place =
          nodes_.world_from_node(mesh_.parts[0].node) == Eigen::Matrix4d::Identity();
      if (remainders_ && is_in_place) {
        ApplyGlbRemainders(*remainders_, weights[0], mesh_.parts[0].positions, &frames_.back());
      }
    }
    return absl::OkStatus();
  }

  const GlbContainer& glb_;
  GlbNodes nodes_;
  const GlbAnimation& animation_;
  const InputReading& reading_;
  GlbMesh mesh_;
  std::optional<GlbRemainders> remainders_;
  std::vector<Eigen::Matrix3Xf> frames_;
};

}  // namespace

absl::StatusOr<std::optional<MeshSequence>> DecodeGlbAnimation(std::string_view bytes,
                                                               const std::string& path,
                                                               const InputReading& reading) {
  // What is no GLB is refused by the reader of still meshes, in the same words.
  absl::StatusOr<GlbContainer> glb = GlbContainer::Open(bytes, reading.options.limits);
  const std::string& wanted = reading.options.animation;
  if (!glb.ok() || (glb->List("animations").empty() && wanted.empty())) {
    return std::optional<MeshSequence>();
  }
  absl::StatusOr<GlbNodes> nodes = GlbNodes::Read(*glb);
  if (!nodes.ok()) return WithContext(path, nodes.status());
  InputReport report;
  absl::StatusOr<std::optional<GlbAnimation>> animation =
      ChooseGlbAnimation(*glb, *nodes, wanted, &report);
  if (!animation.ok()) return WithContext(path, animation.status());
  if (!*animation) return std::optional<MeshSequence>();
  absl::StatusOr<MeshSequence> sequence =
      AnimationReader(*glb, *std::move(nodes), **animation,
                      {reading.options, reading.progress, &report})
          .Read(path);
  for (InputNote& note : report.notes) {
    note.text = absl::StrCat(DisplayName(path), ": ", note.text);
    reading.report->notes.push_back(std::move(note));
  }
  reading.report->has_frame_rate = report.has_frame_rate;
  reading.report->first_frame = report.first_frame;
  if (!sequence.ok()) return WithContext(path, sequence.status());
  return std::optional(*std::move(sequence));
}

absl::StatusOr<MeshSequence> ReadGltfSequence(const std::string& path,
                                              const InputReading& reading) {
  {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadGltfBytes(path, reading.options.limits));
    PLEAT_ASSIGN_OR_RETURN(std::optional<MeshSequence> sequence,
                           DecodeGlbAnimation(bytes, path, reading));
    if (sequence) return *std::move(sequence);
  }
  return ReadFrameFiles({path}, std::filesystem::path(path).stem().string(), path, reading);
}

}  // namespace pleat
