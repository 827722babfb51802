#include "gltf_sequence.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "frame_times.h"
#include "glb_animation.h"
#include "glb_mesh.h"
#include "glb_pose.h"
#include "glb_remainders.h"
#include "glb_vertex_ids.h"
#include "gltf_file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

using nlohmann::json;

// How many vertices of morph targets are added for each vertex of a frame at most.
constexpr uint64_t kMaxTargetsPerVertex = 256;

// When the frames are, and how many a second has.
struct FrameTimes {
  std::vector<float> times;
  FrameRate rate;
};

void AddGltfNote(NoteSeverity severity, const char* kind, std::string text, InputReport* report) {
  report->notes.push_back({.severity = severity, .kind = kind, .text = std::move(text)});
}

std::vector<float> TimesOfFrames(float begin, float end, FrameRate rate, int64_t max_frames) {
  const double num_steps = std::floor((double{end} - begin) * rate.fps() + 1e-3);
  const auto count = static_cast<int64_t>(std::min(num_steps, static_cast<double>(max_frames)));
  std::vector<float> times;
  for (int64_t i = 0; i <= count; ++i) {
    times.push_back(static_cast<float>(begin + static_cast<double>(i) / rate.fps()));
  }
  return times;
}

// The keys themselves where they are evenly spaced; else the frames of a rate between the first key
// and the last.
FrameTimes ChooseFrames(const GlbAnimation& animation, const InputReading& reading) {
  const std::vector<float> keys = animation.KeyTimes();
  const std::optional<FrameRate>& wanted = reading.options.frame_rate;
  std::optional<FrameRate> even = RateOfFloatTimes(keys);
  const std::optional<FrameRate> said = animation.frame_rate();
  if (even && said && std::abs(even->fps() / said->fps() - 1) < 1e-3) even = said;
  InputReport* report = reading.report;
  report->has_frame_rate = even.has_value();
  if ((even && wanted.value_or(*even) == *even) || keys.size() == 1) {
    return {keys, wanted.value_or(even.value_or(FrameRate{}))};
  }
  const std::optional<FrameRate> between = RateOfKeys(keys);
  report->has_frame_rate = even || between;
  const FrameRate rate = wanted.value_or(even ? *even : between.value_or(FrameRate{}));
  if (!wanted && !between) {
    AddGltfNote(NoteSeverity::kWarning, "frame_rate_assumed",
                absl::StrFormat("the keys lie at the frames of no usual rate; %g frames per second "
                                "are taken, say --fps for another rate",
                                rate.fps()),
                report);
  } else {
    AddGltfNote(NoteSeverity::kNote, "animation_sampled",
                absl::StrFormat("its %d keys are sampled at %g frames per second%s", keys.size(),
                                rate.fps(), wanted ? "" : ", at whose frames they lie"),
                report);
  }
  return {TimesOfFrames(keys.front(), keys.back(), rate, reading.options.limits.max_frames), rate};
}

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
    const FrameTimes frames = ChooseFrames(animation_, reading_);
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

std::string AnimationName(const GlbContainer& glb, size_t index) {
  const json& entry = glb.Entry("animations", index);
  const auto name = entry.is_object() ? entry.find("name") : entry.end();
  return entry.is_object() && name != entry.end() && name->is_string()
             ? EscapeControls(name->get<std::string>())
             : std::string();
}

// The first animation with channels, none when there is none; a note says which others there are.
absl::StatusOr<std::optional<GlbAnimation>> ChooseAnimation(const GlbContainer& glb,
                                                            const GlbNodes& nodes,
                                                            InputReport* report) {
  const size_t count = glb.List("animations").size();
  for (size_t i = 0; i < count; ++i) {
    PLEAT_ASSIGN_OR_RETURN(GlbAnimation animation, GlbAnimation::Read(glb, nodes, i));
    if (animation.num_channels() == 0) continue;
    if (count > 1) {
      AddGltfNote(NoteSeverity::kWarning, "animations_left_out",
                  absl::StrCat("the file holds ", count, " animations; number ", i, " '",
                               AnimationName(glb, i),
                               "' is read; export the others into files of their own"),
                  report);
    }
    return std::optional(std::move(animation));
  }
  return std::optional<GlbAnimation>();
}

}  // namespace

absl::StatusOr<std::optional<MeshSequence>> DecodeGlbAnimation(std::string_view bytes,
                                                               const std::string& path,
                                                               const InputReading& reading) {
  // What is no GLB is refused by the reader of still meshes, in the same words.
  absl::StatusOr<GlbContainer> glb = GlbContainer::Open(bytes, reading.options.limits);
  if (!glb.ok() || glb->List("animations").empty()) return std::optional<MeshSequence>();
  absl::StatusOr<GlbNodes> nodes = GlbNodes::Read(*glb);
  if (!nodes.ok()) return WithContext(path, nodes.status());
  InputReport report;
  absl::StatusOr<std::optional<GlbAnimation>> animation = ChooseAnimation(*glb, *nodes, &report);
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
