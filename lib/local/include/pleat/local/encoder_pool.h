// Frame encoders that are ready for use. Making one costs more than a frame, because it encodes the
// topology.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/character/character_model.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {

// Keeps the encoders that nobody uses at the moment, by model and options, up to a number of bytes.
// When there are too many, those that have been unused for longest go first. An encoder does not
// keep its model in memory. Thread-safe. The pool must outlive what it lends.
class EncoderPool {
 public:
  // capacity_bytes: of the encoders that nobody uses. memory: of these and of the sessions that use
  // the others, shared with whoever else needs memory; null: not counted. It must outlive the pool.
  explicit EncoderPool(uint64_t capacity_bytes, MemoryBudget* memory = nullptr)
      : capacity_bytes_(capacity_bytes), memory_(memory) {}

  // An encoder that is lent until the lease is destroyed. Its first frame is a key frame. A lease
  // serves one thread.
  class Lease {
   public:
    Lease(EncoderPool* pool, std::string key, FrameEncoder encoder, Reservation memory);
    ~Lease();
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    FrameEncoder& operator*() { return encoder_; }
    FrameEncoder* operator->() { return &encoder_; }
    const FrameEncoder* operator->() const { return &encoder_; }

   private:
    EncoderPool* pool_;  // null: the encoder goes back to no pool
    std::string key_;
    Reservation memory_;  // of the encoder and of the session that uses it; goes after it
    FrameEncoder encoder_;
  };

  // Lends an encoder for `model`, whose content id is `model_id`. With kControlMesh, the frames
  // that it encodes hold the control vertices alone. Returns null for kParameters, which need no
  // encoder, and otherwise the errors of FrameEncoder::Create. kResourceExhausted when there is no
  // memory for the encoder and the session around it.
  absl::StatusOr<std::unique_ptr<Lease>> Take(const std::string& model_id,
                                              const CharacterModel& model,
                                              const FrameEncoderOptions& options);

  // Does the same without a pool: the encoder is made anew and destroyed with its lease.
  static absl::StatusOr<std::unique_ptr<Lease>> Make(const CharacterModel& model,
                                                     const FrameEncoderOptions& options);

  // Drops encoders that nobody uses until `bytes` are free or none is left.
  void Reclaim(uint64_t bytes);

  uint64_t num_made() const;  // encoders that Take could not find ready
  uint64_t used_bytes() const;

 private:
  struct Entry {
    std::string key;
    Reservation memory;  // goes after the encoder
    FrameEncoder encoder;
  };
  void GiveBack(std::string key, FrameEncoder encoder, Reservation memory);
  void DropOldest();  // call with mutex_ held

  const uint64_t capacity_bytes_;
  MemoryBudget* const memory_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // the one given back last is first; guarded by mutex_
  uint64_t used_bytes_ = 0;   // guarded by mutex_
  uint64_t num_made_ = 0;     // guarded by mutex_
};

}  // namespace pleat
