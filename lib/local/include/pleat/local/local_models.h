// Trained characters in the store of this process, and in its memory while they are in use.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pleat/cache/byte_cache.h"
#include "pleat/local/stored_files.h"
#include "pleat/service/model_service.h"

namespace pleat {

using ModelCache = ByteCache<CharacterModel>;

// Thread-safe. `files` and `cache` must outlive it.
class LocalModels final : public ModelService {
 public:
  LocalModels(StoredFiles* files, ModelCache* cache) : files_(files), cache_(cache) {}

  absl::StatusOr<ModelInfo> Get(const std::string& id) override;
  absl::StatusOr<Page<ModelInfo>> ListPage(const PageRequest& request) override;
  absl::Status Delete(const std::string& id) override;
  absl::Status SetPinned(const std::string& id, bool pinned) override;
  absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) override;
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override;

  // Returns the model, from the cache or loaded from the store. It stays in memory as long as the
  // handle lives. kNotFound when there is none, kDataLoss when its file is damaged.
  absl::StatusOr<std::shared_ptr<const CharacterModel>> Acquire(const std::string& id);
  // Lets go of a model whose entry was deleted elsewhere; who uses it keeps it.
  void Forget(const std::string& id) { cache_->Erase(id); }
  ByteCacheStats cache_stats() const { return cache_->stats(); }

 private:
  StoredFiles* const files_;
  ModelCache* const cache_;
};

}  // namespace pleat
