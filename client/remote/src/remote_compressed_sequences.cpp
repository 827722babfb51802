#include <cstring>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pages.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/wire/service_messages.h"
#include "remote_services.h"
#include "transfer.h"

namespace pleat {
namespace {

constexpr uint64_t kMaxShapeBytes = uint64_t{1} << 30;
constexpr size_t kBytesPerVertex = 3 * sizeof(float);

// Puts the parts of a stream together: first those of the shape, then those of the positions, frame
// by frame. Parts are read when they are needed, except for the first positions, which say that the
// shape is complete; they wait in part_ for the first call of Next. The server is not trusted:
// every part must be the one that follows.
class RemoteDecodeSession final : public DecodeSession {
 public:
  RemoteDecodeSession(v1::CompressedSequenceService::Stub* stub, const std::string& id,
                      FrameRange range)
      : range_(range), next_(range.begin) {
    v1::DecodeFramesRequest request;
    request.set_id(id);
    request.set_begin_frame(range.begin);
    request.set_end_frame(range.end);
    stream_ = stub->DecodeFrames(&context_, request);
  }
  ~RemoteDecodeSession() override {
    if (ended_) return;
    context_.TryCancel();
    stream_->Finish();
  }

  // Reads up to the first positions, so that a request that is refused opens no session.
  absl::Status ReadShape() {
    std::string bytes;
    while (true) {
      PLEAT_ASSIGN_OR_RETURN(const bool more, Read());
      if (!more) return BrokenStream("it ended too early");
      if (part_.part_case() == v1::DecodeFramesResponse::kPositions) break;
      if (part_.part_case() != v1::DecodeFramesResponse::kShape) return BrokenStream("empty part");
      if (bytes.size() + part_.shape().size() > kMaxShapeBytes) {
        return BrokenStream("the shape is too large");
      }
      bytes += part_.shape();
    }
    has_part_ = true;
    PLEAT_ASSIGN_OR_RETURN(MeshSequence shape, DecodeSequence(bytes));
    positions_.resize(3, shape.num_vertices());
    shape_.emplace(std::move(shape));
    return absl::OkStatus();
  }

  absl::StatusOr<MeshSequence> Shape() override { return *std::move(shape_); }

  absl::StatusOr<const Eigen::Matrix3Xf*> Next() override {
    int64_t next_vertex = 0;
    while (next_vertex < positions_.cols()) {
      if (!std::exchange(has_part_, false)) {
        PLEAT_ASSIGN_OR_RETURN(const bool more, Read());
        if (!more) {
          if (next_vertex != 0 || !Complete()) return BrokenStream("it ended too early");
          return nullptr;
        }
      }
      PLEAT_RETURN_IF_ERROR(TakePositions(&next_vertex));
    }
    if (!positions_.allFinite()) return BrokenStream("a position is not finite");
    ++next_;
    return &positions_;
  }

 private:
  bool Complete() const { return next_ > range_.begin && (range_.end == 0 || next_ == range_.end); }

  // Reads the next part. Returns false at the end of the stream, or the reason why it broke off.
  absl::StatusOr<bool> Read() {
    if (ended_) return false;
    if (stream_->Read(&part_)) return true;
    ended_ = true;
    PLEAT_RETURN_IF_ERROR(FromGrpcStatus(stream_->Finish()));
    return false;
  }

  // Copies part_ behind the first *next_vertex vertices of the frame.
  absl::Status TakePositions(int64_t* next_vertex) {
    if (part_.part_case() == v1::DecodeFramesResponse::kShape)
      return BrokenStream("a second shape");
    if (part_.part_case() != v1::DecodeFramesResponse::kPositions)
      return BrokenStream("empty part");
    const v1::DecodeFramesResponse::Positions& part = part_.positions();
    const size_t count = part.xyz().size() / kBytesPerVertex;
    if (part.frame() != next_ || (range_.end != 0 && next_ >= range_.end) ||
        part.first_vertex() != *next_vertex || count == 0 ||
        part.xyz().size() % kBytesPerVertex != 0 ||
        count > static_cast<size_t>(positions_.cols() - *next_vertex)) {
      return BrokenStream("a part does not follow");
    }
    std::memcpy(positions_.data() + 3 * *next_vertex, part.xyz().data(), part.xyz().size());
    *next_vertex += static_cast<int64_t>(count);
    return absl::OkStatus();
  }

  const FrameRange range_;
  int next_;  // the frame that Next gives next
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::DecodeFramesResponse>> stream_;
  v1::DecodeFramesResponse part_;
  bool has_part_ = false;  // part_ was read and has not been used
  bool ended_ = false;
  std::optional<MeshSequence> shape_;
  Eigen::Matrix3Xf positions_;  // 3 x V, meters
};

class RemoteCompressedSequences final : public CompressedSequenceService {
 public:
  explicit RemoteCompressedSequences(RemoteState* state) : state_(state) {}

  absl::StatusOr<CompressedSequenceInfo> Upload(const std::string& file, const Progress& progress,
                                                absl::Duration ttl) override {
    return UploadFile(*state_, Calls(), {ToHex(ComputeSha256(file)), file.size(), ttl}, file,
                      progress);
  }

  absl::StatusOr<CompressedSequenceInfo> Get(const std::string& id) override {
    v1::GetCompressedSequenceRequest request;
    v1::GetCompressedSequenceResponse response;
    request.set_id(id);
    PLEAT_RETURN_IF_ERROR(
        Call(&v1::CompressedSequenceService::Stub::GetCompressedSequence, request, &response));
    return FromProto(response.compressed_sequence());
  }

  absl::StatusOr<Page<CompressedSequenceInfo>> ListPage(const PageRequest& page) override {
    return ReadPage<CompressedSequenceInfo, v1::ListCompressedSequencesRequest,
                    v1::ListCompressedSequencesResponse>(
        page,
        [this](const auto& request, auto* response) {
          return Call(&v1::CompressedSequenceService::Stub::ListCompressedSequences, request,
                      response);
        },
        [](const auto& response) -> const auto& { return response.compressed_sequences(); });
  }

  absl::Status Delete(const std::string& id) override {
    v1::DeleteCompressedSequenceRequest request;
    v1::DeleteCompressedSequenceResponse response;
    request.set_id(id);
    return Call(&v1::CompressedSequenceService::Stub::DeleteCompressedSequence, request, &response);
  }

  absl::Status SetPinned(const std::string& id, bool pinned) override {
    v1::PinCompressedSequenceRequest request;
    v1::PinCompressedSequenceResponse response;
    request.set_id(id);
    request.set_pinned(pinned);
    return Call(&v1::CompressedSequenceService::Stub::PinCompressedSequence, request, &response);
  }

  absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) override {
    return DownloadFile(*state_, id, progress, Start());
  }

  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override {
    return OpenRemoteDownload(state_->options, Start(), id, offset_bytes);
  }

  absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>> BeginUpload(
      const std::string& id, uint64_t size_bytes, uint64_t offset_bytes,
      absl::Duration ttl) override {
    return std::make_unique<
        RemoteUpload<CompressedSequenceInfo, v1::UploadCompressedSequenceResponse>>(
        Calls(), UploadedFile{id, size_bytes, ttl}, offset_bytes, Progress());
  }

  absl::StatusOr<std::unique_ptr<DecodeSession>> OpenDecode(const std::string& id,
                                                            FrameRange range) override {
    return RetryRefused(state_->options, [&]() -> absl::StatusOr<std::unique_ptr<DecodeSession>> {
      auto session = std::make_unique<RemoteDecodeSession>(state_->compressed.get(), id, range);
      PLEAT_RETURN_IF_ERROR(session->ReadShape());
      return session;
    });
  }

 private:
  template <typename Request, typename Response>
  absl::Status Call(grpc::Status (v1::CompressedSequenceService::Stub::*method)(
                        grpc::ClientContext*, const Request&, Response*),
                    const Request& request, Response* response) const {
    return state_->Call(state_->compressed.get(), method, request, response);
  }
  UploadCalls<CompressedSequenceInfo, v1::UploadCompressedSequenceResponse> Calls() const {
    return {.start =
                [stub = state_->compressed.get()](grpc::ClientContext* context,
                                                  v1::UploadCompressedSequenceResponse* response) {
                  return stub->UploadCompressedSequence(context, response);
                },
            .info_of =
                [](const v1::UploadCompressedSequenceResponse& response) {
                  return FromProto(response.compressed_sequence());
                }};
  }
  StartDownload<v1::DownloadCompressedSequenceRequest, v1::DownloadCompressedSequenceResponse>
  Start() const {
    return [stub = state_->compressed.get()](grpc::ClientContext* context,
                                             const v1::DownloadCompressedSequenceRequest& request) {
      return stub->DownloadCompressedSequence(context, request);
    };
  }

  RemoteState* const state_;
};

}  // namespace

std::unique_ptr<CompressedSequenceService> MakeRemoteCompressedSequences(RemoteState* state) {
  return std::make_unique<RemoteCompressedSequences>(state);
}

}  // namespace pleat
