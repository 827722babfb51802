#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "job_subscription.h"
#include "pages.h"
#include "pleat/base/random_id.h"
#include "pleat/base/status.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/training_messages.h"
#include "remote_services.h"

namespace pleat {
namespace {

constexpr auto kRetryPause = std::chrono::milliseconds(200);

std::string MakeRequestId() { return RandomHexId(4); }

class RemoteJobs final : public JobService {
 public:
  explicit RemoteJobs(RemoteState* state) : state_(state) {}

  absl::StatusOr<JobInfo> CreateTraining(const TrainingRequest& request) override {
    v1::CreateTrainingJobRequest message;
    v1::CreateTrainingJobResponse response;
    for (const std::string& id : request.sequence_ids) message.add_sequence_ids(id);
    *message.mutable_options() = ToProto(request.options);
    message.set_model_name(request.model_name);
    message.set_rig(request.rig);
    message.set_request_id(request.request_id.empty() ? MakeRequestId() : request.request_id);
    message.set_model_ttl_seconds(TtlToSeconds(request.model_ttl));
    PLEAT_RETURN_IF_ERROR(Create(&v1::JobService::Stub::CreateTrainingJob, message, &response));
    return FromProto(response.job());
  }

  absl::StatusOr<JobInfo> CreateCompression(const CompressionRequest& request) override {
    v1::CreateCompressionJobRequest message;
    v1::CreateCompressionJobResponse response;
    message.set_sequence_id(request.sequence_id);
    *message.mutable_options() = ToProto(request.options);
    message.set_request_id(request.request_id.empty() ? MakeRequestId() : request.request_id);
    message.set_result_ttl_seconds(TtlToSeconds(request.result_ttl));
    PLEAT_RETURN_IF_ERROR(Create(&v1::JobService::Stub::CreateCompressionJob, message, &response));
    return FromProto(response.job());
  }

  absl::StatusOr<JobInfo> Get(const std::string& id) override {
    v1::GetJobRequest request;
    v1::GetJobResponse response;
    request.set_id(id);
    PLEAT_RETURN_IF_ERROR(Call(&v1::JobService::Stub::GetJob, request, &response));
    return FromProto(response.job());
  }

  absl::StatusOr<Page<JobInfo>> ListPage(const PageRequest& page) override {
    return ReadPage<JobInfo, v1::ListJobsRequest, v1::ListJobsResponse>(
        page,
        [this](const auto& request, auto* response) {
          return Call(&v1::JobService::Stub::ListJobs, request, response);
        },
        [](const auto& response) -> const auto& { return response.jobs(); });
  }

  absl::Status Cancel(const std::string& id) override {
    v1::CancelJobRequest request;
    v1::CancelJobResponse response;
    request.set_id(id);
    return Call(&v1::JobService::Stub::CancelJob, request, &response);
  }

  absl::Status Delete(const std::string& id) override {
    v1::DeleteJobRequest request;
    v1::DeleteJobResponse response;
    request.set_id(id);
    return Call(&v1::JobService::Stub::DeleteJob, request, &response);
  }

  absl::StatusOr<std::unique_ptr<JobSubscription>> Subscribe(
      const std::string& id, std::function<void()> listener) override {
    return OpenRemoteSubscription(state_, id, std::move(listener));
  }

 private:
  template <typename Request, typename Response>
  absl::Status Call(grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*,
                                                                 const Request&, Response*),
                    const Request& request, Response* response) const {
    return state_->Call(state_->jobs.get(), method, request, response);
  }

  // A call that was lost on the way, or whose answer was, is made again: it has a request id.
  template <typename Request, typename Response>
  absl::Status Create(grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*,
                                                                   const Request&, Response*),
                      const Request& request, Response* response) const {
    for (int attempt = 1;; ++attempt) {
      const absl::Status status = Call(method, request, response);
      if (!IsTransient(status) || attempt >= state_->options.max_attempts) return status;
      std::this_thread::sleep_for(kRetryPause);
    }
  }

  RemoteState* const state_;
};

}  // namespace

std::unique_ptr<JobService> MakeRemoteJobs(RemoteState* state) {
  return std::make_unique<RemoteJobs>(state);
}

}  // namespace pleat
