// Trained characters that a service keeps.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/character/character_model.h"
#include "pleat/service/content_download.h"
#include "pleat/service/entry_life.h"
#include "pleat/service/list_page.h"

namespace pleat {

struct ModelInfo {
  std::string id;  // hex SHA-256 of the model file's bytes
  std::string name;
  Skeleton skeleton;
  FrameRate frame_rate;
  int num_vertices = 0, num_faces = 0, num_control_vertices = 0, num_components = 0;
  uint64_t size_bytes = 0;    // model file
  uint64_t memory_bytes = 0;  // in the cache
  TrainOptions options;
  TrainingRecord record;
  EntryLife life{};
};

// Thread-safe. kNotFound for an id that the service does not have.
class ModelService {
 public:
  virtual ~ModelService() = default;

  virtual absl::StatusOr<ModelInfo> Get(const std::string& id) = 0;
  // Oldest first. kInvalidArgument for a size out of range, or a token that this list did not give.
  virtual absl::StatusOr<Page<ModelInfo>> ListPage(const PageRequest& request) = 0;
  // All pages together.
  absl::StatusOr<std::vector<ModelInfo>> List() {
    return ReadAllPages<ModelInfo>(
        [this](const PageRequest& request) { return ListPage(request); });
  }
  // Whoever uses the model at the moment keeps it until the end.
  virtual absl::Status Delete(const std::string& id) = 0;
  // A pinned one is never removed by retention, only by Delete.
  virtual absl::Status SetPinned(const std::string& id, bool pinned) = 0;
  // The whole model file.
  virtual absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) = 0;
  // The file in pieces, from `offset_bytes` on. kOutOfRange when that is behind its end, kDataLoss
  // when the file has changed.
  virtual absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                        uint64_t offset_bytes) = 0;
};

}  // namespace pleat
