// Connecting, and the calls that are no stream.
#include "pleat/remote/remote_character_service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "pages.h"
#include "pleat/base/status.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/training_messages.h"
#include "state.h"

namespace pleat {

absl::StatusOr<std::unique_ptr<RemoteCharacterService>> RemoteCharacterService::Connect(
    const std::string& address, RemoteOptions options) {
  std::shared_ptr<grpc::Channel> channel = MakeChannel(address, options, ChannelUse::kCalls);
  PLEAT_RETURN_IF_ERROR(WaitForConnection(channel, address, options));
  return std::unique_ptr<RemoteCharacterService>(new RemoteCharacterService(
      std::make_unique<State>(address, std::move(channel), std::move(options))));
}

std::unique_ptr<RemoteCharacterService> RemoteCharacterService::OverChannel(
    std::shared_ptr<grpc::Channel> channel, RemoteOptions options) {
  return std::unique_ptr<RemoteCharacterService>(new RemoteCharacterService(
      std::make_unique<State>(std::string(), std::move(channel), std::move(options))));
}

RemoteCharacterService::RemoteCharacterService(std::unique_ptr<State> state)
    : state_(std::move(state)) {}
RemoteCharacterService::~RemoteCharacterService() = default;

absl::StatusOr<SequenceInfo> RemoteCharacterService::GetSequence(const std::string& id) {
  v1::GetSequenceRequest request;
  v1::GetSequenceResponse response;
  request.set_id(id);
  PLEAT_RETURN_IF_ERROR(state_->Call(state_->sequences.get(),
                                     &v1::SequenceService::Stub::GetSequence, request, &response));
  return FromProto(response.sequence());
}

absl::StatusOr<std::vector<SequenceInfo>> RemoteCharacterService::ListSequences() {
  std::vector<SequenceInfo> infos;
  PLEAT_RETURN_IF_ERROR((ReadPages<v1::ListSequencesRequest, v1::ListSequencesResponse>(
      [&](const auto& request, auto* response) {
        return state_->Call(state_->sequences.get(), &v1::SequenceService::Stub::ListSequences,
                            request, response);
      },
      [&](const v1::ListSequencesResponse& response) -> absl::Status {
        for (const v1::Sequence& message : response.sequences()) {
          PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, FromProto(message));
          infos.push_back(std::move(info));
        }
        return absl::OkStatus();
      })));
  return infos;
}

absl::Status RemoteCharacterService::DeleteSequence(const std::string& id) {
  v1::DeleteSequenceRequest request;
  v1::DeleteSequenceResponse response;
  request.set_id(id);
  return state_->Call(state_->sequences.get(), &v1::SequenceService::Stub::DeleteSequence, request,
                      &response);
}

absl::StatusOr<JobInfo> RemoteCharacterService::CreateTrainingJob(const TrainingRequest& request) {
  v1::CreateTrainingJobRequest message;
  v1::CreateTrainingJobResponse response;
  for (const std::string& id : request.sequence_ids) message.add_sequence_ids(id);
  *message.mutable_options() = ToProto(request.options);
  message.set_model_name(request.model_name);
  message.set_rig(request.rig);
  PLEAT_RETURN_IF_ERROR(state_->Call(state_->jobs.get(), &v1::JobService::Stub::CreateTrainingJob,
                                     message, &response));
  return FromProto(response.job());
}

absl::StatusOr<JobInfo> RemoteCharacterService::CreateCompressionJob(
    const std::string& sequence_id, const CompressOptions& options) {
  v1::CreateCompressionJobRequest request;
  v1::CreateCompressionJobResponse response;
  request.set_sequence_id(sequence_id);
  *request.mutable_options() = ToProto(options);
  PLEAT_RETURN_IF_ERROR(state_->Call(
      state_->jobs.get(), &v1::JobService::Stub::CreateCompressionJob, request, &response));
  return FromProto(response.job());
}

absl::StatusOr<JobInfo> RemoteCharacterService::GetJob(const std::string& id) {
  v1::GetJobRequest request;
  v1::GetJobResponse response;
  request.set_id(id);
  PLEAT_RETURN_IF_ERROR(
      state_->Call(state_->jobs.get(), &v1::JobService::Stub::GetJob, request, &response));
  return FromProto(response.job());
}

absl::StatusOr<std::vector<JobInfo>> RemoteCharacterService::ListJobs() {
  std::vector<JobInfo> infos;
  PLEAT_RETURN_IF_ERROR((ReadPages<v1::ListJobsRequest, v1::ListJobsResponse>(
      [&](const auto& request, auto* response) {
        return state_->Call(state_->jobs.get(), &v1::JobService::Stub::ListJobs, request, response);
      },
      [&](const v1::ListJobsResponse& response) -> absl::Status {
        for (const v1::Job& message : response.jobs()) {
          PLEAT_ASSIGN_OR_RETURN(JobInfo info, FromProto(message));
          infos.push_back(std::move(info));
        }
        return absl::OkStatus();
      })));
  return infos;
}

absl::Status RemoteCharacterService::CancelJob(const std::string& id) {
  v1::CancelJobRequest request;
  v1::CancelJobResponse response;
  request.set_id(id);
  return state_->Call(state_->jobs.get(), &v1::JobService::Stub::CancelJob, request, &response);
}

absl::StatusOr<ModelInfo> RemoteCharacterService::GetModel(const std::string& id) {
  v1::GetModelRequest request;
  v1::GetModelResponse response;
  request.set_id(id);
  PLEAT_RETURN_IF_ERROR(
      state_->Call(state_->models.get(), &v1::ModelService::Stub::GetModel, request, &response));
  return FromProto(response.model());
}

absl::StatusOr<std::vector<ModelInfo>> RemoteCharacterService::ListModels() {
  std::vector<ModelInfo> infos;
  PLEAT_RETURN_IF_ERROR((ReadPages<v1::ListModelsRequest, v1::ListModelsResponse>(
      [&](const auto& request, auto* response) {
        return state_->Call(state_->models.get(), &v1::ModelService::Stub::ListModels, request,
                            response);
      },
      [&](const v1::ListModelsResponse& response) -> absl::Status {
        for (const v1::Model& message : response.models()) {
          PLEAT_ASSIGN_OR_RETURN(ModelInfo info, FromProto(message));
          infos.push_back(std::move(info));
        }
        return absl::OkStatus();
      })));
  return infos;
}

absl::Status RemoteCharacterService::DeleteModel(const std::string& id) {
  v1::DeleteModelRequest request;
  v1::DeleteModelResponse response;
  request.set_id(id);
  return state_->Call(state_->models.get(), &v1::ModelService::Stub::DeleteModel, request,
                      &response);
}

}  // namespace pleat
