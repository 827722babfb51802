#include "pleat/service/shared_service.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using Ids = std::set<std::string>;

absl::Status Refused() {
  return absl::PermissionDeniedError(
      "this is a shared view: it shows a character and changes nothing");
}
absl::Status CheckShared(const Ids& ids, const std::string& id, const char* what) {
  if (ids.contains(id)) return absl::OkStatus();
  return absl::NotFoundError(absl::StrCat("there is no ", what, " ", id));
}

// One page of those of the ids that the service has. There are few.
template <typename Info, typename Service>
absl::StatusOr<Page<Info>> ListShared(Service* service, const Ids& ids,
                                      const PageRequest& request) {
  PLEAT_RETURN_IF_ERROR(MaxItemsOf(request).status());
  if (!request.token.empty()) return absl::InvalidArgumentError("page_token: not of this list");
  Page<Info> page;
  for (const std::string& id : ids) {
    absl::StatusOr<Info> info = service->Get(id);
    if (info.ok()) page.items.push_back(*std::move(info));
  }
  return page;
}

class SharedSequences final : public SequenceService {
 public:
  SharedSequences(SequenceService* all, const Ids* ids) : all_(all), ids_(ids) {}
  absl::StatusOr<SequenceInfo> Upload(const MeshSequence&, const Progress&,
                                      absl::Duration) override {
    return Refused();
  }
  absl::StatusOr<SequenceInfo> Get(const std::string& id) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, id, "sequence"));
    return all_->Get(id);
  }
  absl::StatusOr<Page<SequenceInfo>> ListPage(const PageRequest& request) override {
    return ListShared<SequenceInfo>(all_, *ids_, request);
  }
  absl::Status Delete(const std::string&) override { return Refused(); }
  absl::Status SetPinned(const std::string&, bool) override { return Refused(); }
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, id, "sequence"));
    return all_->OpenDownload(id, offset_bytes);
  }
  absl::StatusOr<UploadStatus> QueryUpload(const std::string&) override { return Refused(); }
  absl::StatusOr<std::unique_ptr<SequenceUpload>> BeginUpload(const std::string&, uint64_t,
                                                              uint64_t, absl::Duration) override {
    return Refused();
  }
  absl::Status DeleteUpload(const std::string&) override { return Refused(); }

 private:
  SequenceService* const all_;
  const Ids* const ids_;
};

class SharedJobs final : public JobService {
 public:
  SharedJobs(JobService* all, const Ids* ids) : all_(all), ids_(ids) {}
  absl::StatusOr<JobInfo> CreateTraining(const TrainingRequest&) override { return Refused(); }
  absl::StatusOr<JobInfo> CreateCompression(const CompressionRequest&) override {
    return Refused();
  }
  absl::StatusOr<JobInfo> Get(const std::string& id) override {
    absl::StatusOr<JobInfo> job = all_->Get(id);
    if (!job.ok() || IsShown(*job)) return job;
    return absl::NotFoundError(absl::StrCat("there is no job ", id));
  }
  absl::StatusOr<Page<JobInfo>> ListPage(const PageRequest& request) override {
    PLEAT_ASSIGN_OR_RETURN(Page<JobInfo> page, all_->ListPage(request));
    std::erase_if(page.items, [this](const JobInfo& job) { return !IsShown(job); });
    return page;
  }
  absl::Status Cancel(const std::string&) override { return Refused(); }
  absl::Status Delete(const std::string&) override { return Refused(); }
  absl::StatusOr<std::unique_ptr<JobSubscription>> Subscribe(
      const std::string& id, std::function<void()> listener) override {
    PLEAT_RETURN_IF_ERROR(Get(id).status());
    return all_->Subscribe(id, std::move(listener));
  }

 private:
  bool IsShown(const JobInfo& job) const {
    return !job.result_id.empty() && ids_->contains(job.result_id);
  }
  JobService* const all_;
  const Ids* const ids_;
};

class SharedModels final : public ModelService {
 public:
  SharedModels(ModelService* all, const Ids* ids) : all_(all), ids_(ids) {}
  absl::StatusOr<ModelInfo> Get(const std::string& id) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, id, "model"));
    return all_->Get(id);
  }
  absl::StatusOr<Page<ModelInfo>> ListPage(const PageRequest& request) override {
    return ListShared<ModelInfo>(all_, *ids_, request);
  }
  absl::Status Delete(const std::string&) override { return Refused(); }
  absl::Status SetPinned(const std::string&, bool) override { return Refused(); }
  absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, id, "model"));
    return all_->Download(id, progress);
  }
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, id, "model"));
    return all_->OpenDownload(id, offset_bytes);
  }

 private:
  ModelService* const all_;
  const Ids* const ids_;
};

class SharedPoses final : public PoseService {
 public:
  SharedPoses(PoseService* all, const Ids* ids) : all_(all), ids_(ids) {}
  absl::Status EvaluateClip(
      const ClipQuery& query,
      const std::function<absl::Status(int, const EvaluatedFrame&)>& consume) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, query.model_id, "model"));
    return all_->EvaluateClip(query, consume);
  }
  absl::StatusOr<std::unique_ptr<PoseSession>> OpenSession(const std::string& model_id,
                                                           PoseSessionOptions options) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, model_id, "model"));
    return all_->OpenSession(model_id, std::move(options));
  }
  absl::StatusOr<std::unique_ptr<ClipSession>> OpenClip(const std::string& model_id,
                                                        PoseTrack track,
                                                        PoseSessionOptions options) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, model_id, "model"));
    return all_->OpenClip(model_id, std::move(track), std::move(options));
  }
  absl::StatusOr<std::unique_ptr<PoseStream>> OpenStream(const std::string& model_id,
                                                         PoseSessionOptions options,
                                                         LiveRules rules,
                                                         LiveListener* listener) override {
    PLEAT_RETURN_IF_ERROR(CheckShared(*ids_, model_id, "model"));
    return all_->OpenStream(model_id, std::move(options), rules, listener);
  }

 private:
  PoseService* const all_;
  const Ids* const ids_;
};

class NoCompressedSequences final : public CompressedSequenceService {
 public:
  absl::StatusOr<CompressedSequenceInfo> Upload(const std::string&, const Progress&,
                                                absl::Duration) override {
    return Refused();
  }
  absl::StatusOr<CompressedSequenceInfo> Get(const std::string& id) override { return None(id); }
  absl::StatusOr<Page<CompressedSequenceInfo>> ListPage(const PageRequest&) override {
    return Page<CompressedSequenceInfo>();
  }
  absl::Status Delete(const std::string&) override { return Refused(); }
  absl::Status SetPinned(const std::string&, bool) override { return Refused(); }
  absl::StatusOr<std::string> Download(const std::string& id, const Progress&) override {
    return None(id);
  }
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t) override {
    return None(id);
  }
  absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>> BeginUpload(const std::string&,
                                                                        uint64_t, uint64_t,
                                                                        absl::Duration) override {
    return Refused();
  }
  absl::StatusOr<std::unique_ptr<DecodeSession>> OpenDecode(const std::string& id,
                                                            FrameRange) override {
    return None(id);
  }

 private:
  static absl::Status None(const std::string& id) {
    return absl::NotFoundError(absl::StrCat("there is no compressed sequence ", id));
  }
};

class SharedService final : public CharacterService {
 public:
  SharedService(const SharedFrom& from, Ids ids)
      : ids_(std::move(ids)),
        sequences_(from.sequences, &ids_),
        jobs_(from.jobs, &ids_),
        models_(from.models, &ids_),
        poses_(from.poses, &ids_) {}
  SequenceService& sequences() override { return sequences_; }
  JobService& jobs() override { return jobs_; }
  ModelService& models() override { return models_; }
  PoseService& poses() override { return poses_; }
  CompressedSequenceService& compressed_sequences() override { return compressed_; }

 private:
  const Ids ids_;
  SharedSequences sequences_;
  SharedJobs jobs_;
  SharedModels models_;
  SharedPoses poses_;
  NoCompressedSequences compressed_;
};

}  // namespace

std::unique_ptr<CharacterService> MakeSharedService(const SharedFrom& from,
                                                    std::set<std::string> ids) {
  return std::make_unique<SharedService>(from, std::move(ids));
}

absl::StatusOr<std::set<std::string>> ContentOfModel(CharacterService* service,
                                                     const std::string& model_id) {
  PLEAT_RETURN_IF_ERROR(service->models().Get(model_id).status());
  std::set<std::string> ids = {model_id};
  PLEAT_ASSIGN_OR_RETURN(const std::vector<JobInfo> jobs, service->jobs().List());
  for (const JobInfo& job : jobs) {
    if (job.result_id != model_id) continue;
    for (const std::string& id : job.sequence_ids) {
      if (service->sequences().Get(id).ok()) ids.insert(id);
    }
  }
  return ids;
}

}  // namespace pleat
