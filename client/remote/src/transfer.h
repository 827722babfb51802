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
#include "pleat/service/content_upload.h"
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

// One call of an upload. The server may end it early, when it has the file already or refuses it.
// What is appended after that goes nowhere, and Finish says how the call ended.
template <typename Info, typename Response>
class RemoteUpload final : public ContentUpload<Info> {
 public:
  // progress: its cancellation cancels the call.
  RemoteUpload(const UploadCalls<Info, Response>& calls, const std::string& id, uint64_t size_bytes,
               uint64_t offset_bytes, const Progress& progress)
      : info_of_(calls.info_of),
        received_bytes_(offset_bytes),
        watcher_(&context_, progress),
        writer_(calls.start(&context_, &response_)) {
    v1::UploadSequenceRequest request;
    request.mutable_header()->set_id(id);
    request.mutable_header()->set_size_bytes(size_bytes);
    request.mutable_header()->set_offset_bytes(offset_bytes);
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
absl::StatusOr<Info> SendRest(const UploadCalls<Info, Response>& calls, const std::string& id,
                              std::string_view bytes, uint64_t offset, const Progress& progress) {
  RemoteUpload<Info, Response> upload(calls, id, bytes.size(), offset, progress);
  while (offset < bytes.size()) {
    const size_t count = std::min<size_t>(kUploadChunkBytes, bytes.size() - offset);
    if (!upload.Append(bytes.substr(offset, count)).ok()) break;  // Finish says why
    offset += count;
    PLEAT_RETURN_IF_ERROR(
        progress.Report(static_cast<double>(offset) / static_cast<double>(bytes.size())));
  }
  return upload.Finish();
}

// Uploads `bytes`, whose content id is `id`. Before each attempt it asks the server how much is
// there, because a call that broke off does not say what has arrived.
template <typename Info, typename Response>
absl::StatusOr<Info> UploadFile(const RemoteState& state, const UploadCalls<Info, Response>& calls,
                                const std::string& id, const std::string& bytes,
                                const Progress& progress) {
  uint64_t farthest = 0;
  for (int attempt = 1;; ++attempt) {
    v1::QueryUploadRequest query;
    v1::QueryUploadResponse known;
    query.set_id(id);
    absl::StatusOr<Info> result = absl::UnknownError("not asked");
    if (const absl::Status asked = state.Call(
            state.sequences.get(), &v1::SequenceService::Stub::QueryUpload, query, &known);
        !asked.ok()) {
      result = asked;
    } else {
      if (known.received_bytes() > farthest) attempt = 1;  // progress was made
      farthest = std::max<uint64_t>(farthest, known.received_bytes());
      const uint64_t offset = known.received_bytes() <= bytes.size() ? known.received_bytes() : 0;
      result = SendRest(calls, id, bytes, offset, progress);
    }
    PLEAT_RETURN_IF_ERROR(progress.Report(result.ok() ? 1 : 0));  // says that it was cancelled
    if (result.ok()) return result;
    // kOutOfRange means that what the server holds has changed since it was asked.
    const bool again =
        IsTransient(result.status()) || result.status().code() == absl::StatusCode::kOutOfRange;
    if (!again || attempt >= state.options.max_attempts) return result;
    if (!BackOff(attempt, progress)) return absl::CancelledError("the upload was cancelled");
  }
}

// Opens a download from the offset in the request.
template <typename Request, typename Response>
using StartDownload = std::function<std::unique_ptr<grpc::ClientReader<Response>>(
    grpc::ClientContext*, const Request&)>;

// Appends the file `id` to `bytes`, which hold the part from `offset` on that is there already. It
// stops at the end of the file, or when `more`, which is asked after every part, says no or fails.
template <typename Request, typename Response>
absl::Status ReadParts(const StartDownload<Request, Response>& start, const std::string& id,
                       uint64_t offset, const Progress& progress, std::string* bytes,
                       const std::function<absl::StatusOr<bool>(uint64_t size_bytes)>& more) {
  grpc::ClientContext context;
  const CancelWatcher watcher(&context, progress);
  Request request;
  request.set_id(id);
  request.set_offset_bytes(offset + bytes->size());
  const auto reader = start(&context, request);
  Response part;
  absl::Status status;
  bool wanted = true;
  while (wanted && status.ok() && reader->Read(&part)) {
    if (part.offset_bytes() != offset + bytes->size() || part.data().size() > part.size_bytes() ||
        part.offset_bytes() > part.size_bytes() - part.data().size()) {
      status = absl::DataLossError("the server sent a part of the file that does not follow");
      break;
    }
    *bytes += part.data();
    const absl::StatusOr<bool> goes_on = more(part.size_bytes());
    status = goes_on.status();
    wanted = status.ok() && *goes_on;
  }
  if (!status.ok() || !wanted) context.TryCancel();
  const absl::Status end = FromGrpcStatus(reader->Finish());
  PLEAT_RETURN_IF_ERROR(status);
  return wanted ? end : absl::OkStatus();
}

// Downloads the whole file, whose SHA-256 is `id`. kDataLoss when the bytes do not have it.
template <typename Request, typename Response>
absl::StatusOr<std::string> DownloadFile(const RemoteState& state, const std::string& id,
                                         const Progress& progress,
                                         const StartDownload<Request, Response>& start) {
  std::string bytes;
  size_t farthest = 0;
  for (int attempt = 1;; ++attempt) {
    const absl::Status status = ReadParts<Request, Response>(
        start, id, 0, progress, &bytes, [&](uint64_t size_bytes) -> absl::StatusOr<bool> {
          if (bytes.size() == farthest) return true;  // an empty part is no progress
          farthest = bytes.size();
          attempt = 1;
          PLEAT_RETURN_IF_ERROR(
              progress.Report(static_cast<double>(bytes.size()) / static_cast<double>(size_bytes)));
          return true;
        });
    if (status.ok()) break;
    PLEAT_RETURN_IF_ERROR(progress.Report(0));
    if (!IsTransient(status) || attempt >= state.options.max_attempts) return status;
    if (!BackOff(attempt, progress)) return absl::CancelledError("the download was cancelled");
  }
  if (ToHex(ComputeSha256(bytes)) != id) {
    return absl::DataLossError(
        absl::StrCat("the downloaded file does not have the SHA-256 ", id, "; download it again"));
  }
  return bytes;
}

// Downloads `count` bytes of the file from `offset` on, fewer at its end. Their hash is not
// checked.
template <typename Request, typename Response>
absl::StatusOr<std::string> ReadFileBytes(const std::string& id, uint64_t offset, uint64_t count,
                                          const StartDownload<Request, Response>& start) {
  std::string bytes;
  PLEAT_RETURN_IF_ERROR((ReadParts<Request, Response>(
      start, id, offset, {}, &bytes,
      [&](uint64_t) -> absl::StatusOr<bool> { return bytes.size() < count; })));
  if (bytes.size() > count) bytes.resize(count);
  return bytes;
}

}  // namespace pleat
