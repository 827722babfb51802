// One animation of a glTF file: what its channels say at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "glb_container.h"
#include "glb_nodes.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

class GlbAnimation {
 public:
  // Reads animation number `index`. kInvalidArgument for samplers whose times do not ascend or
  // whose values do not fit them; channels of targets that glTF does not define are left out. The
  // container must outlive it.
  static absl::StatusOr<GlbAnimation> Read(const GlbContainer& glb, const GlbNodes& nodes,
                                           size_t index);

  size_t num_channels() const { return channels_.size(); }
  // The times of all keys, each once, ascending. Empty without channels.
  std::vector<float> KeyTimes() const;
  // The rate that Pleat wrote beside the keys, which are rounded.
  std::optional<FrameRate> frame_rate() const { return frame_rate_; }

  // Changes what the channels drive: the transforms of nodes and the weights of the morph targets
  // of each node, one list for each node, which is empty where nothing drives it.
  void Sample(float seconds, std::vector<GlbTransform>* transforms,
              std::vector<std::vector<float>>* weights) const;

 private:
  enum class Path { kTranslation, kRotation, kScale, kWeights };
  enum class Interpolation { kStep, kLinear, kCubic };
  struct Channel {
    int node = 0;
    Path path = Path::kTranslation;
    Interpolation interpolation = Interpolation::kLinear;
    std::shared_ptr<const std::vector<float>> times{};
    GlbAccessor values{};
    int components = 1;     // of each element of `values`
    size_t num_values = 1;  // numbers of a key: 3, 4, or the targets
  };

  absl::Status ReadChannel(const GlbContainer& glb, const GlbNodes& nodes,
                           const nlohmann::json& channel, const nlohmann::json& samplers);
  absl::Status ReadSampler(const GlbContainer& glb, const nlohmann::json& sampler,
                           Channel* channel);
  absl::StatusOr<std::shared_ptr<const std::vector<float>>> ReadTimes(const GlbContainer& glb,
                                                                      const nlohmann::json& index);
  static std::vector<double> ValueAt(const Channel& channel, float seconds);

  std::vector<Channel> channels_;
  // Times by their accessor: channels share them.
  std::vector<std::pair<size_t, std::shared_ptr<const std::vector<float>>>> times_;
  size_t num_keys_ = 0;
  std::optional<FrameRate> frame_rate_;
};

}  // namespace pleat
