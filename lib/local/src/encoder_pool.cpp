#include "pleat/local/encoder_pool.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/geometry/control_mesh.h"
#include "pleat/geometry/control_topology.h"

namespace pleat {
namespace {

// What an encoder holds: the topology mesh, a cloud, the header and the integers of two frames. The
// number was measured once and is not exact.
constexpr uint64_t kBytesPerVertex = 300;
// What a session holds beside its encoder: an evaluator and frames in several forms. Measured like
// the other.
constexpr uint64_t kSessionBytesPerVertex = 200;
constexpr double kControlShare = .05;  // the share of the vertices that are control vertices

uint64_t ChargeOf(const FrameEncoder& encoder) {
  return kBytesPerVertex * static_cast<uint64_t>(encoder.header().num_vertices);
}

std::string KeyOf(const std::string& model_id, const FrameEncoderOptions& options) {
  return absl::StrCat(model_id, "/", static_cast<int>(options.content), "/",
                      static_cast<int>(options.encoding), "/", options.position_bits, "/",
                      options.max_error_mm, "/", options.speed, "/", options.box_margin);
}

// Makes an encoder for the model's mesh or for its control mesh.
absl::StatusOr<FrameEncoder> MakeEncoder(const CharacterModel& model,
                                         const FrameEncoderOptions& options) {
  const Eigen::Matrix3Xd& rest = model.rig().rest_positions;
  if (options.content == StreamContent::kMesh) {
    return FrameEncoder::Create(model.topology(), rest.cast<float>(), options);
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<int> vertices,
                         SelectControlVertices(model.topology(), rest, kControlShare));
  PLEAT_ASSIGN_OR_RETURN(const Topology topology,
                         ControlTopology(model.topology(), rest, vertices));
  return FrameEncoder::Create(topology, rest(Eigen::all, vertices).cast<float>(), options,
                              {vertices.begin(), vertices.end()});
}

}  // namespace

EncoderPool::Lease::Lease(EncoderPool* pool, std::string key, FrameEncoder encoder,
                          Reservation memory)
    : pool_(pool), key_(std::move(key)), memory_(std::move(memory)), encoder_(std::move(encoder)) {}

EncoderPool::Lease::~Lease() {
  if (pool_ != nullptr) pool_->GiveBack(std::move(key_), std::move(encoder_), std::move(memory_));
}

absl::StatusOr<std::unique_ptr<EncoderPool::Lease>> EncoderPool::Take(
    const std::string& model_id, const CharacterModel& model, const FrameEncoderOptions& options) {
  if (options.content == StreamContent::kParameters) return nullptr;
  std::string key = KeyOf(model_id, options);
  Reservation memory;
  if (memory_ != nullptr) {
    const auto num_vertices = static_cast<uint64_t>(model.num_vertices());
    PLEAT_ASSIGN_OR_RETURN(
        memory, memory_->Reserve((kBytesPerVertex + kSessionBytesPerVertex) * num_vertices,
                                 "a stream of frames"));
  }
  {
    std::lock_guard lock(mutex_);
    for (auto it = entries_.begin(); it != entries_.end(); ++it) {
      if (it->key != key) continue;
      auto lease =
          std::make_unique<Lease>(this, std::move(key), std::move(it->encoder), std::move(memory));
      used_bytes_ -= ChargeOf(**lease);
      entries_.erase(it);
      (*lease)->RequestKeyframe();
      return lease;
    }
    ++num_made_;
  }
  // Made without the lock, since it takes longer than all that other sessions do under it.
  PLEAT_ASSIGN_OR_RETURN(FrameEncoder encoder, MakeEncoder(model, options));
  return std::make_unique<Lease>(this, std::move(key), std::move(encoder), std::move(memory));
}

absl::StatusOr<std::unique_ptr<EncoderPool::Lease>> EncoderPool::Make(
    const CharacterModel& model, const FrameEncoderOptions& options) {
  if (options.content == StreamContent::kParameters) return nullptr;
  PLEAT_ASSIGN_OR_RETURN(FrameEncoder encoder, MakeEncoder(model, options));
  return std::make_unique<Lease>(nullptr, std::string(), std::move(encoder), Reservation());
}

void EncoderPool::GiveBack(std::string key, FrameEncoder encoder, Reservation memory) {
  std::lock_guard lock(mutex_);
  memory.ShrinkTo(ChargeOf(encoder));  // the session is gone
  used_bytes_ += ChargeOf(encoder);
  entries_.push_front({std::move(key), std::move(memory), std::move(encoder)});
  // This drops the encoder itself when it is too large for the pool.
  while (used_bytes_ > capacity_bytes_) DropOldest();
}

void EncoderPool::DropOldest() {
  used_bytes_ -= ChargeOf(entries_.back().encoder);
  entries_.pop_back();
}

void EncoderPool::Reclaim(uint64_t bytes) {
  std::lock_guard lock(mutex_);
  const uint64_t enough = used_bytes_ - std::min(used_bytes_, bytes);
  while (used_bytes_ > enough) DropOldest();
}

uint64_t EncoderPool::num_made() const {
  std::lock_guard lock(mutex_);
  return num_made_;
}

uint64_t EncoderPool::used_bytes() const {
  std::lock_guard lock(mutex_);
  return used_bytes_;
}

}  // namespace pleat
