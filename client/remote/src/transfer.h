// Transfers files in chunks, to a server and from it. UploadFile and DownloadFile are whole
// transfers: when a call breaks off, they continue where it stopped. They give up after
// max_attempts attempts in a row that brought nothing, so a slow network with many interruptions
// still gets the file across.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/progress.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/service/content_download.h"
#include "pleat/service/content_upload.h"
#include "pleat/service/entry_life.h"
#include "pleat/wire/service_messages.h"
#include "remote_state.h"

namespace pleat {

inline constexpr size_t kUploadChunkBytes = 512 << 10;

// How an upload of one kind is made: `start` opens the call, `info_of` reads its answer.
template <typename Info, typename Response>
struct UploadCalls {
  std::function<std::unique_ptr<grpc::ClientWriter<v1::UploadSequenceRequest>>(grpc::ClientContext*,
                                                                               Response*)>
      start;
  std::function<absl::StatusOr<Info>(const Response&)> info_of;
};

// What is uploaded, and how long the server keeps it at least.
struct UploadedFile {
  std::string id;
  uint64_t size_bytes = 0;
  absl::Duration ttl = kKeepForEver;
};

// One call of an upload. The server may end it early, when it has the file already or refuses it.
// What is appended after that goes nowhere, and Finish says how the call ended.
template <typename Info, typename Response>
class RemoteUpload final : public ContentUpload<Info> {
 public:
  // progress: its cancellation cancels the call.
  RemoteUpload(const UploadCalls<Info, Response>& calls, const UploadedFile& file,
               uint64_t offset_bytes, const Progress& progress)
      : info_of_(calls.info_of),
        received_bytes_(offset_bytes),
        watcher_(&context_, progress),
        writer_(calls.start(&context_, &response_)) {
    v1::UploadSequenceRequest request;
    request.mutable_header()->set_id(file.id);
    request.mutable_header()->set_size_bytes(file.size_bytes);
    request.mutable_header()->set_offset_bytes(offset_bytes);
    request.mutable_header()->set_ttl_seconds(TtlToSeconds(file.ttl));
    open_ = writer_->Write(request);
  }
  ~RemoteUpload() override {
    if (end_.has_value()) return;
    context_.TryCancel();
    writer_->Finish();
  }

  absl::Status Append(std::string_view bytes) override {
    v1::UploadSequenceRequest request;
    while (open_ && !bytes.empty()) {
      const size_t count = std::min(kUploadChunkBytes, bytes.size());
      request.set_data(std::string(bytes.substr(0, count)));
      open_ = writer_->Write(request);
      received_bytes_ += count;
      bytes.remove_prefix(count);
    }
    return open_ ? absl::OkStatus() : End();
  }
  uint64_t received_bytes() const override { return received_bytes_; }
  absl::StatusOr<Info> Finish() override {
    if (open_) writer_->WritesDone();
    PLEAT_RETURN_IF_ERROR(End());
    return info_of_(response_);
  }

 private:
  absl::Status End() {
    if (!end_.has_value()) end_ = FromGrpcStatus(writer_->Finish());
    return *end_;
  }

  const std::function<absl::StatusOr<Info>(const Response&)> info_of_;
  uint64_t received_bytes_;
  grpc::ClientContext context_;
  const CancelWatcher watcher_;
  Response response_;
  std::unique_ptr<grpc::ClientWriter<v1::UploadSequenceRequest>> writer_;
  bool open_ = false;
  std::optional<absl::Status> end_;  // how the call ended
};

// Makes one attempt to send the rest of `bytes` from `offset` on.
template <typename Info, typename Response>
absl::StatusOr<Info> SendRest(const UploadCalls<Info, Response>& calls, const UploadedFile& file,
                              std::string_view bytes, uint64_t offset, const Progress& progress) {
  RemoteUpload<Info, Response> upload(calls, file, offset, progress);
  while (offset < bytes.size()) {
    const size_t count = std::min<size_t>(kUploadChunkBytes, bytes.size() - offset);
    if (!upload.Append(bytes.substr(offset, count)).ok()) break;  // Finish says why
    offset += count;
    PLEAT_RETURN_IF_ERROR(
        progress.Report(static_cast<double>(offset) / static_cast<double>(bytes.size())));
  }
  return upload.Finish();
}

// Uploads `bytes`, the content of `file`. Before each attempt it asks the server how much is
// there, because a call that broke off does not say what has arrived.
template <typename Info, typename Response>
absl::StatusOr<Info> UploadFile(const RemoteState& state, const UploadCalls<Info, Response>& calls,
                                const UploadedFile& file, const std::string& bytes,
                                const Progress& progress) {
  uint64_t farthest = 0;
  for (int attempt = 1;; ++attempt) {
    v1::QueryUploadRequest query;
    v1::QueryUploadResponse known;
    query.set_id(file.id);
    absl::StatusOr<Info> result = absl::UnknownError("not asked");
    if (const absl::Status asked = state.Call(
            state.sequences.get(), &v1::SequenceService::Stub::QueryUpload, query, &known);
        !asked.ok()) {
      result = asked;
    } else {
      if (known.received_bytes() > farthest) attempt = 1;  // progress was made
      farthest = std::max<uint64_t>(farthest, known.received_bytes());
      const uint64_t offset = known.received_bytes() <= bytes.size() ? known.received_bytes() : 0;
      result = SendRest(calls, file, bytes, offset, progress);
    }
    PLEAT_RETURN_IF_ERROR(progress.Report(result.ok() ? 1 : 0));  // says that it was cancelled
    if (result.ok()) return result;
    // kOutOfRange means that what the server holds has changed since it was asked.
    const bool again =
        IsTransient(result.status()) || result.status().code() == absl::StatusCode::kOutOfRange;
    if (WaitForRetry(result.status(), attempt, state.options, progress)) continue;
    if (!again || attempt >= state.options.max_attempts) return result;
    if (!BackOff(attempt, progress)) return absl::CancelledError("the upload was cancelled");
  }
}

// Opens a download from the offset in the request.
template <typename Request, typename Response>
using StartDownload = std::function<std::unique_ptr<grpc::ClientReader<Response>>(
    grpc::ClientContext*, const Request&)>;

// One call of a download. Its parts follow each other, or it ends with kDataLoss.
template <typename Request, typename Response>
class RemoteDownload final : public ContentDownload {
 public:
  // progress: its cancellation cancels the call.
  RemoteDownload(const StartDownload<Request, Response>& start, const std::string& id,
                 uint64_t offset_bytes, const Progress& progress)
      : offset_bytes_(offset_bytes), watcher_(&context_, progress) {
    Request request;
    request.set_id(id);
    request.set_offset_bytes(offset_bytes);
    reader_ = start(&context_, request);
  }
  ~RemoteDownload() override {
    if (end_.has_value()) return;
    context_.TryCancel();
    reader_->Finish();
  }

  // Reads the first bytes, which tell the size, or why there are none.
  absl::Status Open() {
    PLEAT_ASSIGN_OR_RETURN(first_, ReadPart());
    return absl::OkStatus();
  }
  uint64_t size_bytes() const override { return size_bytes_; }
  absl::StatusOr<std::string> Next() override {
    if (!first_.empty()) return std::exchange(first_, std::string());
    return ReadPart();
  }

 private:
  // The next bytes; empty when the call has ended well.
  absl::StatusOr<std::string> ReadPart() {
    Response part;
    while (!end_.has_value() && part.data().empty()) {
      if (!reader_->Read(&part)) {
        end_ = FromGrpcStatus(reader_->Finish());
        break;
      }
      if (!Follows(part)) {
        context_.TryCancel();
        reader_->Finish();
        end_ = absl::DataLossError("the server sent a part of the file that does not follow");
        break;
      }
      size_bytes_ = part.size_bytes();
      offset_bytes_ += part.data().size();
    }
    if (end_.has_value()) {
      PLEAT_RETURN_IF_ERROR(*end_);
      return std::string();
    }
    return std::move(*part.mutable_data());
  }
  bool Follows(const Response& part) const {
    return part.offset_bytes() == offset_bytes_ && part.data().size() <= part.size_bytes() &&
           part.offset_bytes() <= part.size_bytes() - part.data().size();
  }

  uint64_t offset_bytes_;  // of the next part
  uint64_t size_bytes_ = 0;
  grpc::ClientContext context_;
  const CancelWatcher watcher_;
  std::unique_ptr<grpc::ClientReader<Response>> reader_;
  std::string first_;                // read by Open and not yet given
  std::optional<absl::Status> end_;  // how the call ended
};

// Downloads the whole file, whose SHA-256 is `id`. kDataLoss when the bytes do not have it.
template <typename Request, typename Response>
absl::StatusOr<std::string> DownloadFile(const RemoteState& state, const std::string& id,
                                         const Progress& progress,
                                         const StartDownload<Request, Response>& start) {
  std::string bytes;
  for (int attempt = 1;; ++attempt) {
    RemoteDownload<Request, Response> download(start, id, bytes.size(), progress);
    absl::Status status;
    while (status.ok()) {
      const absl::StatusOr<std::string> part = download.Next();
      status = part.status();
      if (!status.ok() || part->empty()) break;
      bytes += *part;
      attempt = 1;
      status = progress.Report(static_cast<double>(bytes.size()) /
                               static_cast<double>(download.size_bytes()));
    }
    if (status.ok()) break;
    PLEAT_RETURN_IF_ERROR(progress.Report(0));
    if (WaitForRetry(status, attempt, state.options, progress)) continue;
    if (!IsTransient(status) || attempt >= state.options.max_attempts) return status;
    if (!BackOff(attempt, progress)) return absl::CancelledError("the download was cancelled");
  }
  if (ToHex(ComputeSha256(bytes)) != id) {
    return absl::DataLossError(
        absl::StrCat("the downloaded file does not have the SHA-256 ", id, "; download it again"));
  }
  return bytes;
}

// Opens a download in pieces.
template <typename Request, typename Response>
absl::StatusOr<std::unique_ptr<ContentDownload>> OpenRemoteDownload(
    const RemoteOptions& options, const StartDownload<Request, Response>& start,
    const std::string& id, uint64_t offset_bytes) {
  return RetryRefused(options, [&]() -> absl::StatusOr<std::unique_ptr<ContentDownload>> {
    auto download =
        std::make_unique<RemoteDownload<Request, Response>>(start, id, offset_bytes, Progress());
    PLEAT_RETURN_IF_ERROR(download->Open());
    return download;
  });
}

}  // namespace pleat
