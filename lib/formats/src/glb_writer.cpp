// Khronos, glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.11 (animations).
#include "pleat/formats/glb_writer.h"

#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "glb_buffers.h"
#include "glb_primitives.h"
#include "pleat/base/file_parts.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using nlohmann::json;

// Positions that base + delta, the sum that a reader computes, does not give back: where a
// coordinate is much smaller than the delta, rounding takes its last bits.
struct Remainders {
  std::vector<uint32_t> counts;   // of each target
  std::vector<uint32_t> indices;  // 3 * vertex + axis
  std::vector<float> values;      // the positions themselves
};

class MorphWriter {
 public:
  explicit MorphWriter(const MeshSequence& sequence)
      : sequence_(sequence),
        mesh_(sequence.topology(), sequence.appearance()),
        num_targets_(sequence.num_frames() - 1) {}

  // Returns what comes before the binary chunk.
  absl::StatusOr<std::string> Encode(std::string* binary) {
    const uint64_t num_frames = static_cast<uint64_t>(sequence_.num_frames());
    const uint64_t num_bytes = num_frames * mesh_.num_vertices() * 12 +
                               num_frames * num_frames * 4 + mesh_.num_vertices() * 12 +
                               static_cast<uint64_t>(mesh_.num_triangles()) * 12;
    if (num_bytes > kMaxGlbBinaryBytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat(num_frames, " frames of ", mesh_.num_vertices(), " vertices are ", num_bytes,
                       " bytes, more than a GLB can hold; write fewer frames, or Alembic (.abc)"));
    }
    buffers_ = GlbBuffers(num_bytes);
    json attributes = Attributes();
    PLEAT_ASSIGN_OR_RETURN(const json targets, Targets());
    json mesh = {{"name", sequence_.name()},
                 {"primitives",
                  mesh_.Primitives(attributes, num_targets_ > 0 ? targets : json(), &buffers_)}};
    if (num_targets_ > 0) {
      mesh["weights"] = std::vector<int>(static_cast<size_t>(num_targets_), 0);
      mesh["extras"] = Extras();
    }
    json root = {{"asset", {{"version", "2.0"}, {"generator", "Pleat"}}},
                 {"scene", 0},
                 {"scenes", json::array({{{"nodes", json::array({0})}}})},
                 {"nodes", json::array({{{"name", sequence_.name()}, {"mesh", 0}}})},
                 {"meshes", json::array({std::move(mesh)})}};
    AddGlbMaterials(sequence_.appearance(), &root);
    if (num_targets_ > 0) root["animations"] = json::array({Animation()});
    return buffers_.Finish(std::move(root), binary);
  }

 private:
  json Attributes() {
    json attributes = {{"POSITION", buffers_.AddPoints(mesh_.Spread(sequence_.frame(0)))}};
    mesh_.AddTexcoords(&buffers_, &attributes);
    if (mesh_.num_vertices() > static_cast<size_t>(sequence_.num_vertices())) {
      mesh_.AddVertexIds(&buffers_, &attributes);
    }
    return attributes;
  }

  absl::StatusOr<json> Targets() {
    json targets = json::array();
    const Eigen::Matrix3Xf base = mesh_.Spread(sequence_.frame(0));
    for (int t = 1; t <= num_targets_; ++t) {
      const Eigen::Matrix3Xf frame = mesh_.Spread(sequence_.frame(t));
      const Eigen::Matrix3Xf delta = frame - base;
      if (!delta.allFinite()) {
        return absl::InvalidArgumentError(absl::StrCat(
            "frame ", t, " is further from frame 0 than float32 can say; scale the animation"));
      }
      NoteRemainders(base, delta, frame);
      targets.push_back({{"POSITION", buffers_.AddPoints(delta)}});
    }
    return targets;
  }

  // Repetitions of a vertex have theirs as well, since a reader adds each on its own.
  void NoteRemainders(const Eigen::Matrix3Xf& base, const Eigen::Matrix3Xf& delta,
                      const Eigen::Matrix3Xf& frame) {
    uint32_t count = 0;
    for (Eigen::Index i = 0; i < frame.size(); ++i) {
      const auto sum = static_cast<float>(double{base.data()[i]} + double{delta.data()[i]});
      const float value = frame.data()[i];
      if (std::bit_cast<uint32_t>(sum) == std::bit_cast<uint32_t>(value)) continue;
      remainders_.indices.push_back(static_cast<uint32_t>(i));
      remainders_.values.push_back(value);
      ++count;
    }
    remainders_.counts.push_back(count);
  }

  json Extras() {
    json names = json::array();
    for (int t = 1; t <= num_targets_; ++t) names.push_back(absl::StrCat("frame_", t));
    json extras = {{"targetNames", std::move(names)}};
    if (!remainders_.values.empty()) {
      extras["pleat_remainders"] = {
          {"counts", buffers_.Add(remainders_.counts, "SCALAR", 1, kNoBufferTarget)},
          {"indices", buffers_.Add(remainders_.indices, "SCALAR", 1, kNoBufferTarget)},
          {"values", buffers_.Add(remainders_.values, "SCALAR", 1, kNoBufferTarget)}};
    }
    return extras;
  }

  json Animation() {
    const FrameRate rate = sequence_.frame_rate();
    const auto num_targets = static_cast<size_t>(num_targets_);
    std::vector<float> times, weights((num_targets + 1) * num_targets, 0.f);
    for (size_t t = 0; t <= num_targets; ++t) {
      times.push_back(static_cast<float>(static_cast<double>(t) / rate.fps()));
      if (t > 0) weights[t * num_targets + t - 1] = 1;
    }
    const size_t input = buffers_.Add(times, "SCALAR", 1, kNoBufferTarget);
    buffers_.SetRange(input, times.front(), times.back());
    const size_t output = buffers_.Add(weights, "SCALAR", 1, kNoBufferTarget);
    return {{"name", sequence_.name()},
            {"extras", {{"frame_rate", {rate.numerator, rate.denominator}}}},
            {"samplers",
             json::array({{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}})},
            {"channels",
             json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}};
  }

  const MeshSequence& sequence_;
  const GlbPrimitives mesh_;
  const int num_targets_;
  GlbBuffers buffers_{0};
  Remainders remainders_;
};

}  // namespace

absl::StatusOr<std::string> EncodeGlb(const MeshSequence& sequence) {
  std::string binary;
  PLEAT_ASSIGN_OR_RETURN(const std::string start, MorphWriter(sequence).Encode(&binary));
  return start + binary;
}

absl::Status WriteGlb(const std::string& path, const MeshSequence& sequence) {
  std::string binary;
  PLEAT_ASSIGN_OR_RETURN(const std::string start, MorphWriter(sequence).Encode(&binary));
  const std::string_view parts[] = {start, binary};
  return WriteFileParts(path, parts);
}

}  // namespace pleat
