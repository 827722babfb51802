// Encoders that are ready for use: to make one costs more than a frame (it encodes the topology).
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/character/character_model.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {

// Keeps encoders that nobody uses, by model and options; those unused for longest go first. They do
// not keep the model itself. Thread-safe. Must outlive what it lends.
class EncoderPool {
 public:
  explicit EncoderPool(uint64_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  // Lent until it is destroyed; begins with a key frame.
  class Lease {
   public:
    Lease(EncoderPool* pool, std::string key, FrameEncoder encoder);
    ~Lease();
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    FrameEncoder& operator*() { return encoder_; }
    FrameEncoder* operator->() { return &encoder_; }
    const FrameEncoder* operator->() const { return &encoder_; }

   private:
    EncoderPool* pool_;  // may be null
    std::string key_;
    FrameEncoder encoder_;
  };

  // An encoder of `model`, whose content id is `model_id`, for one user at a time; of kControlMesh
  // it takes the control vertices alone. Null for kParameters, which need none.
  absl::StatusOr<std::unique_ptr<Lease>> Take(const std::string& model_id,
                                              const CharacterModel& model,
                                              const FrameEncoderOptions& options);

  // Makes one that goes back to no pool.
  static absl::StatusOr<std::unique_ptr<Lease>> Make(const CharacterModel& model,
                                                     const FrameEncoderOptions& options);

  uint64_t num_made() const;
  uint64_t used_bytes() const;

 private:
  struct Entry {
    std::string key;
    FrameEncoder encoder;
  };
  void GiveBack(std::string key, FrameEncoder encoder);

  const uint64_t capacity_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // newest first; guarded by mutex_
  uint64_t used_bytes_ = 0;   // guarded by mutex_
  uint64_t num_made_ = 0;     // guarded by mutex_
};

}  // namespace pleat
