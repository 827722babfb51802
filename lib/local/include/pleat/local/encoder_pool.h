// Frame encoders that are ready for use. Making one costs more than a frame, because it encodes the
// topology.
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

// Keeps the encoders that nobody uses at the moment, by model and options, up to a number of bytes.
// When there are too many, those that have been unused for longest go first. An encoder does not
// keep its model in memory. Thread-safe. The pool must outlive what it lends.
class EncoderPool {
 public:
  explicit EncoderPool(uint64_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  // An encoder that is lent until the lease is destroyed. Its first frame is a key frame. A lease
  // serves one thread.
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
    EncoderPool* pool_;  // null: the encoder goes back to no pool
    std::string key_;
    FrameEncoder encoder_;
  };

  // Lends an encoder for `model`, whose content id is `model_id`. With kControlMesh, the frames
  // that it encodes hold the control vertices alone. Returns null for kParameters, which need no
  // encoder, and otherwise the errors of FrameEncoder::Create.
  absl::StatusOr<std::unique_ptr<Lease>> Take(const std::string& model_id,
                                              const CharacterModel& model,
                                              const FrameEncoderOptions& options);

  // Does the same without a pool: the encoder is made anew and destroyed with its lease.
  static absl::StatusOr<std::unique_ptr<Lease>> Make(const CharacterModel& model,
                                                     const FrameEncoderOptions& options);

  uint64_t num_made() const;  // encoders that Take could not find ready
  uint64_t used_bytes() const;

 private:
  struct Entry {
    std::string key;
    FrameEncoder encoder;
  };
  void GiveBack(std::string key, FrameEncoder encoder);

  const uint64_t capacity_bytes_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // the one given back last is first; guarded by mutex_
  uint64_t used_bytes_ = 0;   // guarded by mutex_
  uint64_t num_made_ = 0;     // guarded by mutex_
};

}  // namespace pleat
