#include "pleat/local/local_models.h"

#include <utility>

#include "pleat/base/status.h"
#include "pleat/formats/model_file.h"
#include "stored_infos.h"

namespace pleat {

absl::StatusOr<ModelInfo> LocalModels::Get(const std::string& id) {
  return GetStored<ModelInfo>(files_->catalog(), id);
}

absl::StatusOr<Page<ModelInfo>> LocalModels::ListPage(const PageRequest& request) {
  return ListStoredPage<ModelInfo>(files_, request);
}

absl::Status LocalModels::Delete(const std::string& id) {
  PLEAT_RETURN_IF_ERROR(files_->Delete(EntryKind::kModel, id));
  // Sessions that use the model keep it until they end. Other projects keep theirs in the cache.
  if (!files_->store().catalog().GetInAnyProject(EntryKind::kModel, id).ok()) cache_->Erase(id);
  return absl::OkStatus();
}

absl::Status LocalModels::SetPinned(const std::string& id, bool pinned) {
  return files_->catalog().SetPinned(EntryKind::kModel, id, pinned);
}

absl::StatusOr<std::string> LocalModels::Download(const std::string& id, const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, Get(id));
  return files_->Download(EntryKind::kModel, id, info.size_bytes, progress);
}

absl::StatusOr<std::unique_ptr<ContentDownload>> LocalModels::OpenDownload(const std::string& id,
                                                                           uint64_t offset_bytes) {
  return files_->OpenDownload(EntryKind::kModel, id, offset_bytes);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> LocalModels::Acquire(const std::string& id) {
  using Loaded = ModelCache::Loaded;
  // Files of all kinds lie in one place, and the cache knows the models of all projects; the row
  // says that this is a model and that the project has it.
  PLEAT_RETURN_IF_ERROR(files_->catalog().Get(EntryKind::kModel, id).status());
  return cache_->Get(id, [this](const std::string& key) -> absl::StatusOr<Loaded> {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, files_->Read(key));
    PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, DecodeModel(bytes));
    const uint64_t charge = model->memory_bytes();
    return Loaded{std::move(model), charge};
  });
}

}  // namespace pleat
