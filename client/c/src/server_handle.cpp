#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "error_report.h"
#include "pleat/base/status.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat_server.h"
#include "server_argument.h"
#include "take_handle.h"

struct pleat_server {
  std::string address;
  std::unique_ptr<pleat::RemoteCharacterService> service;
};

namespace pleat {
namespace {

// Copies as much of `text` as `room` has bytes for, with a zero behind it.
void CopyText(const std::string& text, char* target, size_t room) {
  const size_t count = std::min(text.size(), room - 1);
  std::memcpy(target, text.data(), count);
  target[count] = '\0';
}

absl::Status Connect(const pleat_server_options* options, pleat_server** server) {
  if (server == nullptr) return IsNull("server");
  *server = nullptr;
  if (options == nullptr) return IsNull("options");
  PLEAT_RETURN_IF_ERROR(
      CheckStructSize("pleat_server_options", options->struct_size, sizeof(pleat_server_options)));
  if (options->address == nullptr) return IsNull("address");
  auto connected = std::make_unique<pleat_server>();
  connected->address = options->address;
  PLEAT_ASSIGN_OR_RETURN(
      connected->service,
      RemoteCharacterService::Connect(
          options->address, TakeRemoteOptions(options->token, options->tls_root_certificates,
                                              options->connect_seconds)));
  // Any call tells another server apart; this one is cheap and asks for the token too.
  PLEAT_RETURN_IF_ERROR(NameOtherServers(
      connected->service->models().ListPage({.size = 1}).status(), options->address));
  *server = connected.release();
  return absl::OkStatus();
}

absl::Status Upload(const pleat_server& server, const pleat_take& take, pleat_progress progress,
                    void* user, char* id) {
  CallerProgress report(progress, user);
  PLEAT_ASSIGN_OR_RETURN(
      const SequenceInfo info,
      server.service->sequences().Upload(take.sequence, report.token().Stage("upload", 0, 1)));
  CopyText(info.id, id, PLEAT_ID_SIZE);
  return absl::OkStatus();
}

absl::Status Train(const pleat_server& server, const pleat_training& training, char* job_id) {
  PLEAT_RETURN_IF_ERROR(
      CheckStructSize("pleat_training", training.struct_size, sizeof(pleat_training)));
  constexpr size_t kMostClips = 64;  // what the server takes
  if (training.num_sequences == 0 || training.num_sequences > kMostClips) {
    return absl::InvalidArgumentError(
        absl::StrCat("a training takes 1 to ", kMostClips, " clips, not ", training.num_sequences));
  }
  if (training.sequence_ids == nullptr) return IsNull("sequence_ids");
  TrainingRequest request;
  for (size_t i = 0; i < training.num_sequences; ++i) {
    if (training.sequence_ids[i] == nullptr) return IsNull("a sequence id");
    request.sequence_ids.emplace_back(training.sequence_ids[i]);
  }
  if (training.name != nullptr) request.model_name = training.name;
  if (training.options != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(request.options, ParseTrainOptions(training.options));
  }
  PLEAT_ASSIGN_OR_RETURN(const JobInfo job, server.service->jobs().CreateTraining(request));
  CopyText(job.id, job_id, PLEAT_ID_SIZE);
  return absl::OkStatus();
}

uint32_t ShowState(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return PLEAT_JOB_QUEUED;
    case JobState::kRunning:
      return PLEAT_JOB_RUNNING;
    case JobState::kSucceeded:
      return PLEAT_JOB_SUCCEEDED;
    case JobState::kFailed:
      return PLEAT_JOB_FAILED;
    case JobState::kCancelled:
      return PLEAT_JOB_CANCELLED;
  }
  return PLEAT_JOB_FAILED;
}

pleat_job ShowJob(const JobInfo& info) {
  pleat_job job{};
  job.struct_size = sizeof(job);
  job.state = ShowState(info.state);
  job.fraction = info.fraction;
  job.eta_seconds = info.eta_seconds.value_or(-1);
  CopyText(info.stage, job.stage, sizeof(job.stage));
  CopyText(info.result_id, job.result_id, PLEAT_ID_SIZE);
  return job;
}

absl::Status Watch(const pleat_server& server, const std::string& job_id,
                   pleat_job_observer observe, void* user, pleat_job* last) {
  JobInfo final_job;
  bool stopped = false;
  PLEAT_RETURN_IF_ERROR(WatchJob(server.service->jobs(), job_id, [&](const JobInfo& info) {
    const pleat_job shown = ShowJob(info);
    stopped = observe != nullptr && observe(user, &shown) != 0;
    final_job = info;
    return !stopped;
  }));
  if (last != nullptr) *last = ShowJob(final_job);
  if (IsFinal(final_job.state)) return final_job.error;
  return absl::CancelledError("the watching was ended, and the job goes on");
}

absl::Status ListModels(const pleat_server& server, pleat_model_visitor visit, void* user) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<ModelInfo> models, server.service->models().List());
  for (const ModelInfo& info : models) {
    pleat_model_entry entry{};
    entry.struct_size = sizeof(entry);
    entry.id = info.id.c_str();
    entry.name = info.name.c_str();
    entry.learner = info.record.learner.c_str();
    entry.num_vertices = static_cast<uint32_t>(info.num_vertices);
    entry.num_joints = static_cast<uint32_t>(info.skeleton.num_joints());
    entry.frames_per_second = info.frame_rate.fps();
    entry.size_bytes = info.size_bytes;
    if (visit(user, &entry) != 0) break;
  }
  return absl::OkStatus();
}

absl::Status Download(const pleat_server& server, const std::string& model_id,
                      pleat_progress progress, pleat_bytes_taker take, void* user) {
  CallerProgress report(progress, user);
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      server.service->models().Download(model_id, report.token().Stage("download", 0, 1)));
  take(user, bytes.data(), bytes.size());
  return absl::OkStatus();
}

// Runs `call` on a server that is there.
template <typename Call>
pleat_code OnServer(const pleat_server* server, pleat_error* error, Call&& call) noexcept {
  return Guarded(error, [&]() -> absl::Status {
    if (server == nullptr) return IsNull("server");
    return NameOtherServers(call(*server), server->address.c_str());
  });
}

}  // namespace
}  // namespace pleat

using pleat::Guarded;
using pleat::IsNull;
using pleat::OnServer;

extern "C" {

pleat_code pleat_server_connect(const pleat_server_options* options, pleat_server** server,
                                pleat_error* error) {
  return Guarded(error, [&] { return pleat::Connect(options, server); });
}

void pleat_server_destroy(pleat_server* server) { delete server; }

pleat_code pleat_server_upload(pleat_server* server, const pleat_take* take,
                               pleat_progress progress, void* user, char sequence_id[PLEAT_ID_SIZE],
                               pleat_error* error) {
  return OnServer(server, error, [&](const pleat_server& there) -> absl::Status {
    if (take == nullptr) return IsNull("take");
    if (sequence_id == nullptr) return IsNull("sequence_id");
    return pleat::Upload(there, *take, progress, user, sequence_id);
  });
}

pleat_code pleat_server_train(pleat_server* server, const pleat_training* training,
                              char job_id[PLEAT_ID_SIZE], pleat_error* error) {
  return OnServer(server, error, [&](const pleat_server& there) -> absl::Status {
    if (training == nullptr) return IsNull("training");
    if (job_id == nullptr) return IsNull("job_id");
    return pleat::Train(there, *training, job_id);
  });
}

pleat_code pleat_server_watch(pleat_server* server, const char* job_id, pleat_job_observer observe,
                              void* user, pleat_job* last, pleat_error* error) {
  return OnServer(server, error, [&](const pleat_server& there) -> absl::Status {
    if (job_id == nullptr) return IsNull("job_id");
    if (last != nullptr) {
      PLEAT_RETURN_IF_ERROR(
          pleat::CheckStructSize("pleat_job", last->struct_size, sizeof(pleat_job)));
    }
    return pleat::Watch(there, job_id, observe, user, last);
  });
}

pleat_code pleat_server_cancel(pleat_server* server, const char* job_id, pleat_error* error) {
  return OnServer(server, error, [&](const pleat_server& there) -> absl::Status {
    if (job_id == nullptr) return IsNull("job_id");
    return there.service->jobs().Cancel(job_id);
  });
}

pleat_code pleat_server_list_models(pleat_server* server, pleat_model_visitor visit, void* user,
                                    pleat_error* error) {
  return OnServer(server, error, [&](const pleat_server& there) -> absl::Status {
    if (visit == nullptr) return IsNull("visit");
    return pleat::ListModels(there, visit, user);
  });
}

pleat_code pleat_server_download(pleat_server* server, const char* model_id,
                                 pleat_progress progress, pleat_bytes_taker take, void* user,
                                 pleat_error* error) {
  return OnServer(server, error, [&](const pleat_server& there) -> absl::Status {
    if (model_id == nullptr) return IsNull("model_id");
    if (take == nullptr) return IsNull("take");
    return pleat::Download(there, model_id, progress, take, user);
  });
}

}  // extern "C"
