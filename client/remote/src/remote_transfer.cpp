// Streams of bytes and of job states: uploads, downloads, watches. All go on after a break.
#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/wire/service_messages.h"
#include "state.h"

namespace pleat {
namespace {

constexpr size_t kChunkBytes = 512 << 10;
constexpr auto kHeartbeat = std::chrono::milliseconds(250);

// Writes header and chunks; the server's answer comes from Finish, whatever a write said.
void WriteUpload(grpc::ClientWriter<v1::UploadSequenceRequest>* writer, const std::string& id,
                 std::string_view bytes, uint64_t offset, const Progress& progress) {
  v1::UploadSequenceRequest request;
  request.mutable_header()->set_id(id);
  request.mutable_header()->set_size_bytes(bytes.size());
  request.mutable_header()->set_offset_bytes(offset);
  bool open = writer->Write(request);
  while (open && offset < bytes.size()) {
    const size_t count = std::min<size_t>(kChunkBytes, bytes.size() - offset);
    request.set_data(std::string(bytes.substr(offset, count)));
    open = writer->Write(request);
    offset += count;
    if (!progress.Report(static_cast<double>(offset) / static_cast<double>(bytes.size())).ok()) {
      return;  // the watcher cancels the call
    }
  }
  if (open) writer->WritesDone();
}

// Reads one watch on a thread of its own, so that its owner can look up in between.
class WatchReader {
 public:
  WatchReader(v1::JobService::Stub* stub, const std::string& id) {
    v1::WatchJobRequest request;
    request.set_id(id);
    reader_ = stub->WatchJob(&context_, request);
    thread_ = std::thread([this] { Read(); });
  }
  ~WatchReader() {
    context_.TryCancel();
    thread_.join();
  }

  // Waits up to a heartbeat. True: `job` was replaced by a newer state or stayed as it is; false:
  // the stream has ended, see status().
  bool Next(v1::Job* job) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kHeartbeat, [this] { return fresh_ || ended_; });
    if (fresh_) *job = newest_;
    const bool more = fresh_ || !ended_;
    fresh_ = false;
    return more;
  }
  absl::Status status() {
    std::lock_guard lock(mutex_);
    return status_;
  }

 private:
  void Read() {
    v1::WatchJobResponse response;
    while (reader_->Read(&response)) {
      std::lock_guard lock(mutex_);
      newest_ = response.job();
      fresh_ = true;
      changed_.notify_all();
    }
    const absl::Status status = FromGrpcStatus(reader_->Finish());
    std::lock_guard lock(mutex_);
    status_ = status;
    ended_ = true;
    changed_.notify_all();
  }

  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchJobResponse>> reader_;
  std::mutex mutex_;
  std::condition_variable changed_;
  v1::Job newest_;
  bool fresh_ = false, ended_ = false;
  absl::Status status_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace

template <typename Response>
absl::StatusOr<Response> RemoteCharacterService::State::Upload(
    const std::string& id, const std::string& bytes, const Progress& progress,
    const std::function<std::unique_ptr<grpc::ClientWriter<v1::UploadSequenceRequest>>(
        grpc::ClientContext*, Response*)>& start) const {
  uint64_t farthest = 0;
  for (int attempt = 1;; ++attempt) {
    v1::QueryUploadRequest query;
    v1::QueryUploadResponse known;
    query.set_id(id);
    absl::Status status =
        Call(sequences.get(), &v1::SequenceService::Stub::QueryUpload, query, &known);
    Response response;
    if (status.ok()) {
      if (known.received_bytes() > farthest) attempt = 1;  // it moves: do not give up
      farthest = std::max<uint64_t>(farthest, known.received_bytes());
      grpc::ClientContext context;
      const CancelWatcher watcher(&context, progress);
      auto writer = start(&context, &response);
      const uint64_t offset = known.received_bytes() <= bytes.size() ? known.received_bytes() : 0;
      WriteUpload(writer.get(), id, bytes, offset, progress);
      status = FromGrpcStatus(writer->Finish());
    }
    PLEAT_RETURN_IF_ERROR(progress.Report(status.ok() ? 1 : 0));  // says that it was cancelled
    if (status.ok()) return response;
    const bool again = IsTransient(status) || status.code() == absl::StatusCode::kOutOfRange;
    if (!again || attempt >= options.max_attempts) return status;
    if (!BackOff(attempt, progress)) return absl::CancelledError("the upload was cancelled");
  }
}

absl::StatusOr<SequenceInfo> RemoteCharacterService::UploadSequence(const MeshSequence& sequence,
                                                                    const Progress& progress) {
  const std::string bytes = EncodeSequence(sequence);
  PLEAT_ASSIGN_OR_RETURN(
      const v1::UploadSequenceResponse response,
      state_->Upload<v1::UploadSequenceResponse>(
          SequenceId(bytes), bytes, progress,
          [this](grpc::ClientContext* context, v1::UploadSequenceResponse* reply) {
            return state_->sequences->UploadSequence(context, reply);
          }));
  return FromProto(response.sequence());
}

absl::StatusOr<CompressedSequenceInfo> RemoteCharacterService::UploadCompressedSequence(
    const std::string& file, const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(
      const v1::UploadCompressedSequenceResponse response,
      state_->Upload<v1::UploadCompressedSequenceResponse>(
          ToHex(ComputeSha256(file)), file, progress,
          [this](grpc::ClientContext* context, v1::UploadCompressedSequenceResponse* reply) {
            return state_->compressed->UploadCompressedSequence(context, reply);
          }));
  return FromProto(response.compressed_sequence());
}

absl::Status RemoteCharacterService::WatchJob(const std::string& id,
                                              const std::function<bool(const JobInfo&)>& observe) {
  for (int attempt = 1;; ++attempt) {
    WatchReader reader(state_->jobs.get(), id);
    v1::Job message;
    bool final = false;
    while (reader.Next(&message)) {
      if (message.id().empty()) continue;  // nothing has come yet
      attempt = 1;
      PLEAT_ASSIGN_OR_RETURN(const JobInfo info, FromProto(message));
      final = IsFinal(info.state);
      if (!observe(info)) return absl::OkStatus();
      if (final) return absl::OkStatus();
    }
    const absl::Status status = reader.status();
    if (!IsTransient(status) || attempt >= state_->options.max_attempts) {
      return status.ok() ? absl::UnavailableError("the server ended the watch too early") : status;
    }
    BackOff(attempt, {});
  }
}

template <typename Request, typename Response>
absl::StatusOr<std::string> RemoteCharacterService::State::Download(
    const std::string& id, const Progress& progress,
    const std::function<std::unique_ptr<grpc::ClientReader<Response>>(
        grpc::ClientContext*, const Request&)>& start) const {
  std::string bytes;
  for (int attempt = 1;; ++attempt) {
    grpc::ClientContext context;
    const CancelWatcher watcher(&context, progress);
    Request request;
    request.set_id(id);
    request.set_offset_bytes(bytes.size());
    auto reader = start(&context, request);
    Response part;
    while (reader->Read(&part)) {
      if (part.offset_bytes() != bytes.size() || part.data().size() > part.size_bytes() ||
          part.offset_bytes() > part.size_bytes() - part.data().size()) {
        context.TryCancel();
        return absl::DataLossError("the server sent a part of the file that does not follow");
      }
      bytes += part.data();
      attempt = 1;
      PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(bytes.size()) /
                                            static_cast<double>(part.size_bytes())));
    }
    const absl::Status status = FromGrpcStatus(reader->Finish());
    if (status.ok()) break;
    PLEAT_RETURN_IF_ERROR(progress.Report(0));
    if (!IsTransient(status) || attempt >= options.max_attempts) return status;
    if (!BackOff(attempt, progress)) return absl::CancelledError("the download was cancelled");
  }
  if (ToHex(ComputeSha256(bytes)) != id) {
    return absl::DataLossError(
        absl::StrCat("the downloaded file does not have the SHA-256 ", id, "; download it again"));
  }
  return bytes;
}

absl::StatusOr<std::string> RemoteCharacterService::DownloadModel(const std::string& id,
                                                                  const Progress& progress) {
  return state_->Download<v1::DownloadModelRequest, v1::DownloadModelResponse>(
      id, progress, [this](grpc::ClientContext* context, const v1::DownloadModelRequest& request) {
        return state_->models->DownloadModel(context, request);
      });
}

absl::StatusOr<std::string> RemoteCharacterService::DownloadCompressedSequence(
    const std::string& id, const Progress& progress) {
  return state_
      ->Download<v1::DownloadCompressedSequenceRequest, v1::DownloadCompressedSequenceResponse>(
          id, progress,
          [this](grpc::ClientContext* context,
                 const v1::DownloadCompressedSequenceRequest& request) {
            return state_->compressed->DownloadCompressedSequence(context, request);
          });
}

}  // namespace pleat
