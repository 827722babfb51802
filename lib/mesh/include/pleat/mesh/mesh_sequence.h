// A mesh animation: one connectivity, many frames. Valid by construction.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Frames per second as an exact fraction (30000/1001 stays what it is).
struct FrameRate {
  int32_t numerator = 30;
  int32_t denominator = 1;
  double fps() const { return static_cast<double>(numerator) / denominator; }
  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};

struct MeshSequenceOptions {
  std::string name{};  // for messages and reports
  FrameRate frame_rate{};
  MeshAppearance appearance{};
  std::vector<std::string> frame_names{};  // per frame, for messages; empty = "frame N"
};

// A mesh animation. A sequence that exists has at least one frame, V finite positions in each, a
// positive frame rate and an appearance whose indices fit the topology; nobody downstream checks
// again. Positions are in meters, Y up, float32 (what captures hold); computations widen to double.
// Cheap to copy and safe to share between threads: the data are shared and immutable.
class MeshSequence {
 public:
  // Checks and takes the parts. frames: T matrices of 3 x V, V = topology.num_vertices(). The error
  // is kInvalidArgument and names the first faulty frame and vertex, or the entry of the appearance
  // that is out of range.
  static absl::StatusOr<MeshSequence> Create(Topology topology,
                                             std::vector<Eigen::Matrix3Xf> frames,
                                             MeshSequenceOptions options = {});

  int num_frames() const { return static_cast<int>(data_->frames.size()); }
  int num_vertices() const { return data_->topology.num_vertices(); }
  const Topology& topology() const { return data_->topology; }
  const MeshAppearance& appearance() const { return data_->options.appearance; }
  const std::string& name() const { return data_->options.name; }
  FrameRate frame_rate() const { return data_->options.frame_rate; }
  const Eigen::Matrix3Xf& frame(int t) const { return *data_->frames[t]; }  // 3 x V
  Eigen::Matrix3Xd FrameAsDouble(int t) const { return data_->frames[t]->cast<double>(); }

  // Returns the frames `frame_indices` of this sequence, in that order, shared with it. Indices
  // must be in range and the list not empty.
  MeshSequence Subset(const std::vector<int>& frame_indices) const;
  // Returns the frames of all `clips` one after the other, shared with them; name, rate and
  // appearance are those of the first. The list must not be empty and all clips must have the first
  // one's topology.
  static MeshSequence Join(const std::vector<MeshSequence>& clips);

 private:
  struct Data {
    Topology topology;
    std::vector<std::shared_ptr<const Eigen::Matrix3Xf>> frames;
    MeshSequenceOptions options;
  };
  explicit MeshSequence(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

}  // namespace pleat
