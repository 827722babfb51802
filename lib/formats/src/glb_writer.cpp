// Khronos, glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.11 (animations).
#include "pleat/formats/glb_writer.h"

#include <bit>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gltf_file.h"
#include "pleat/base/file_parts.h"
#include "pleat/base/status.h"
#include "split_vertices.h"

namespace pleat {
namespace {

using nlohmann::json;

constexpr int kFloats = 5126, kUnsignedInts = 5125, kVertexBuffer = 34962, kIndexBuffer = 34963;
// What the header of a GLB can count, less what its JSON and headers take at most.
constexpr uint64_t kMaxBinaryBytes = (uint64_t{4} << 30) - (uint64_t{256} << 20);

// The binary chunk and the lists of the JSON that describe it.
class BufferWriter {
 public:
  explicit BufferWriter(uint64_t num_bytes) { binary_.reserve(num_bytes); }

  // Appends elements of one accessor and returns its index. target: 0 = none.
  template <typename T>
  size_t Add(const std::vector<T>& values, const char* type, int num_components, int target) {
    return Add(std::span<const T>(values), type, num_components, target);
  }
  template <typename T>
  size_t Add(std::span<const T> values, const char* type, int num_components, int target) {
    json view = {
        {"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (target != 0) view["target"] = target;
    views_.push_back(std::move(view));
    accessors_.push_back(
        {{"bufferView", views_.size() - 1},
         {"componentType", sizeof(T) == 4 && std::is_floating_point_v<T> ? kFloats : kUnsignedInts},
         {"count", values.size() / static_cast<size_t>(num_components)},
         {"type", type}});
    binary_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return accessors_.size() - 1;
  }
  size_t AddPoints(const Eigen::Matrix3Xf& points) {
    const std::span<const float> values(points.data(), static_cast<size_t>(points.size()));
    const size_t index = Add(values, "VEC3", 3, kVertexBuffer);
    const Eigen::Vector3f low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    accessors_[index]["min"] = {low.x(), low.y(), low.z()};
    accessors_[index]["max"] = {high.x(), high.y(), high.z()};
    return index;
  }
  void SetRange(size_t accessor, double low, double high) {
    accessors_[accessor]["min"] = {low};
    accessors_[accessor]["max"] = {high};
  }

  // The binary chunk is what `binary` receives; everything before it is returned.
  std::string Finish(json root, std::string* binary) {
    root["bufferViews"] = std::move(views_);
    root["accessors"] = std::move(accessors_);
    root["buffers"] = json::array({{{"byteLength", binary_.size()}}});
    *binary = std::move(binary_);  // whole numbers of 4 bytes
    return GlbStart(root.dump(-1, ' ', false, json::error_handler_t::replace), binary->size());
  }

 private:
  std::string binary_;
  json views_ = json::array(), accessors_ = json::array();
};

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
        split_(SplitAtSeams(sequence.topology(), sequence.appearance())),
        num_targets_(sequence.num_frames() - 1) {}

  // Returns what comes before the binary chunk.
  absl::StatusOr<std::string> Encode(std::string* binary) {
    const uint64_t num_frames = static_cast<uint64_t>(sequence_.num_frames());
    const uint64_t num_bytes = num_frames * split_.sources.size() * 12 +
                               num_frames * num_frames * 4 + split_.sources.size() * 12 +
                               static_cast<uint64_t>(split_.triangles.size()) * 4;
    if (num_bytes > kMaxBinaryBytes) {
      return absl::ResourceExhaustedError(absl::StrCat(
          num_frames, " frames of ", split_.sources.size(), " vertices are ", num_bytes,
          " bytes, more than a GLB can hold; write fewer frames, or Alembic (.abc)"));
    }
    buffers_ = BufferWriter(num_bytes);
    json attributes = Attributes();
    PLEAT_ASSIGN_OR_RETURN(const json targets, Targets());
    json mesh = {{"name", sequence_.name()}, {"primitives", Primitives(attributes, targets)}};
    if (num_targets_ > 0) {
      mesh["weights"] = std::vector<int>(static_cast<size_t>(num_targets_), 0);
      mesh["extras"] = Extras();
    }
    json root = {{"asset", {{"version", "2.0"}, {"generator", "Pleat"}}},
                 {"scene", 0},
                 {"scenes", json::array({{{"nodes", json::array({0})}}})},
                 {"nodes", json::array({{{"name", sequence_.name()}, {"mesh", 0}}})},
                 {"meshes", json::array({std::move(mesh)})}};
    const std::vector<std::string>& names = sequence_.appearance().material_names;
    for (const std::string& name : names) root["materials"].push_back({{"name", name}});
    if (num_targets_ > 0) root["animations"] = json::array({Animation()});
    return buffers_.Finish(std::move(root), binary);
  }

 private:
  Eigen::Matrix3Xf Spread(const Eigen::Matrix3Xf& frame) const {
    Eigen::Matrix3Xf spread(3, static_cast<Eigen::Index>(split_.sources.size()));
    spread.leftCols(frame.cols()) = frame;
    for (Eigen::Index v = frame.cols(); v < spread.cols(); ++v) {
      spread.col(v) = frame.col(split_.sources[static_cast<size_t>(v)]);
    }
    return spread;
  }

  json Attributes() {
    json attributes = {{"POSITION", buffers_.AddPoints(Spread(sequence_.frame(0)))}};
    if (!split_.texcoords.empty()) {
      std::vector<float> texcoords;
      for (const Eigen::Vector2f& texcoord : split_.texcoords) {
        texcoords.insert(texcoords.end(), {texcoord.x(), 1 - texcoord.y()});
      }
      attributes["TEXCOORD_0"] = buffers_.Add(texcoords, "VEC2", 2, kVertexBuffer);
    }
    if (split_.sources.size() > static_cast<size_t>(sequence_.num_vertices())) {
      // The specification wants attributes of floats, whole numbers of up to 16 bits, or both.
      std::vector<float> ids(split_.sources.begin(), split_.sources.end());
      attributes["_VERTEX_ID"] = buffers_.Add(ids, "SCALAR", 1, kVertexBuffer);
    }
    return attributes;
  }

  absl::StatusOr<json> Targets() {
    json targets = json::array();
    const Eigen::Matrix3Xf base = Spread(sequence_.frame(0));
    for (int t = 1; t <= num_targets_; ++t) {
      const Eigen::Matrix3Xf frame = Spread(sequence_.frame(t));
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

  // A primitive for each material, in the order in which faces have them.
  json Primitives(const json& attributes, const json& targets) {
    std::vector<int32_t> order;
    std::vector<std::vector<uint32_t>> indices;
    for (Eigen::Index t = 0; t < split_.triangles.cols(); ++t) {
      const int32_t material = split_.triangle_materials.empty()
                                   ? -1
                                   : split_.triangle_materials[static_cast<size_t>(t)];
      size_t p = 0;
      while (p < order.size() && order[p] != material) ++p;
      if (p == order.size()) {
        order.push_back(material);
        indices.emplace_back();
      }
      for (int c = 0; c < 3; ++c) {
        indices[p].push_back(static_cast<uint32_t>(split_.triangles(c, t)));
      }
    }
    json primitives = json::array();
    for (size_t p = 0; p < order.size(); ++p) {
      json primitive = {{"attributes", attributes},
                        {"indices", buffers_.Add(indices[p], "SCALAR", 1, kIndexBuffer)}};
      if (order[p] >= 0) primitive["material"] = order[p];
      if (num_targets_ > 0) primitive["targets"] = targets;
      primitives.push_back(std::move(primitive));
    }
    return primitives;
  }

  json Extras() {
    json names = json::array();
    for (int t = 1; t <= num_targets_; ++t) names.push_back(absl::StrCat("frame_", t));
    json extras = {{"targetNames", std::move(names)}};
    if (!remainders_.values.empty()) {
      extras["pleat_remainders"] = {{"counts", buffers_.Add(remainders_.counts, "SCALAR", 1, 0)},
                                    {"indices", buffers_.Add(remainders_.indices, "SCALAR", 1, 0)},
                                    {"values", buffers_.Add(remainders_.values, "SCALAR", 1, 0)}};
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
    const size_t input = buffers_.Add(times, "SCALAR", 1, 0);
    buffers_.SetRange(input, times.front(), times.back());
    const size_t output = buffers_.Add(weights, "SCALAR", 1, 0);
    return {{"name", sequence_.name()},
            {"extras", {{"frame_rate", {rate.numerator, rate.denominator}}}},
            {"samplers",
             json::array({{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}})},
            {"channels",
             json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})}};
  }

  const MeshSequence& sequence_;
  const SplitVertices split_;
  const int num_targets_;
  BufferWriter buffers_{0};
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
