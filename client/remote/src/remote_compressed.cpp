// Compressed sequences over the network: the catalogue and decoded frames.
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pages.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/wire/service_messages.h"
#include "state.h"

namespace pleat {
namespace {

constexpr uint64_t kMaxShapeBytes = uint64_t{1} << 30;
constexpr size_t kBytesPerVertex = 3 * sizeof(float);

absl::Status BrokenStream(absl::string_view why) {
  return absl::DataLossError(absl::StrCat("the server's stream of frames is wrong: ", why));
}

// Puts the parts of a stream together.
class DecodedFramesReader {
 public:
  DecodedFramesReader(FrameRange range, const DecodedFramesSink* sink)
      : range_(range), next_(range.begin), sink_(sink) {}

  absl::Status Take(const v1::DecodeFramesResponse& part) {
    if (part.part_case() == v1::DecodeFramesResponse::kShape) return TakeShape(part.shape());
    if (part.part_case() != v1::DecodeFramesResponse::kPositions) return BrokenStream("empty part");
    if (num_vertices_ == 0) PLEAT_RETURN_IF_ERROR(FinishShape());
    return TakePositions(part.positions());
  }

  absl::Status End() const {
    const bool complete =
        next_vertex_ == 0 && next_ > range_.begin && (range_.end == 0 || next_ == range_.end);
    return complete ? absl::OkStatus() : BrokenStream("it ended too early");
  }

 private:
  absl::Status TakeShape(const std::string& bytes) {
    if (num_vertices_ != 0) return BrokenStream("a second shape");
    if (shape_.size() + bytes.size() > kMaxShapeBytes)
      return BrokenStream("the shape is too large");
    shape_ += bytes;
    return absl::OkStatus();
  }

  absl::Status FinishShape() {
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence shape, DecodeSequence(shape_));
    shape_ = {};
    num_vertices_ = shape.num_vertices();
    positions_.resize(3, num_vertices_);
    return sink_->on_shape(shape);
  }

  absl::Status TakePositions(const v1::DecodeFramesResponse::Positions& part) {
    const size_t count = part.xyz().size() / kBytesPerVertex;
    if (part.frame() != next_ || part.first_vertex() != next_vertex_ || count == 0 ||
        part.xyz().size() % kBytesPerVertex != 0 ||
        count > static_cast<size_t>(num_vertices_ - next_vertex_)) {
      return BrokenStream("a part does not follow");
    }
    std::memcpy(positions_.data() + 3 * int64_t{next_vertex_}, part.xyz().data(),
                part.xyz().size());
    next_vertex_ += static_cast<int>(count);
    if (next_vertex_ < num_vertices_) return absl::OkStatus();
    if (!positions_.allFinite()) return BrokenStream("a position is not finite");
    next_vertex_ = 0;
    return sink_->on_frame(next_++, positions_);
  }

  const FrameRange range_;
  int next_;
  const DecodedFramesSink* sink_;
  std::string shape_;
  int num_vertices_ = 0;        // 0 before the shape is complete
  int next_vertex_ = 0;         // of the frame that is arriving
  Eigen::Matrix3Xf positions_;  // 3 x V, meters
};

}  // namespace

absl::StatusOr<CompressedSequenceInfo> RemoteCharacterService::GetCompressedSequence(
    const std::string& id) {
  v1::GetCompressedSequenceRequest request;
  v1::GetCompressedSequenceResponse response;
  request.set_id(id);
  PLEAT_RETURN_IF_ERROR(state_->Call(state_->compressed.get(),
                                     &v1::CompressedSequenceService::Stub::GetCompressedSequence,
                                     request, &response));
  return FromProto(response.compressed_sequence());
}

absl::StatusOr<std::vector<CompressedSequenceInfo>>
RemoteCharacterService::ListCompressedSequences() {
  std::vector<CompressedSequenceInfo> infos;
  PLEAT_RETURN_IF_ERROR(
      (ReadPages<v1::ListCompressedSequencesRequest, v1::ListCompressedSequencesResponse>(
          [&](const auto& request, auto* response) {
            return state_->Call(state_->compressed.get(),
                                &v1::CompressedSequenceService::Stub::ListCompressedSequences,
                                request, response);
          },
          [&](const v1::ListCompressedSequencesResponse& response) -> absl::Status {
            for (const v1::CompressedSequence& message : response.compressed_sequences()) {
              PLEAT_ASSIGN_OR_RETURN(CompressedSequenceInfo info, FromProto(message));
              infos.push_back(std::move(info));
            }
            return absl::OkStatus();
          })));
  return infos;
}

absl::Status RemoteCharacterService::DeleteCompressedSequence(const std::string& id) {
  v1::DeleteCompressedSequenceRequest request;
  v1::DeleteCompressedSequenceResponse response;
  request.set_id(id);
  return state_->Call(state_->compressed.get(),
                      &v1::CompressedSequenceService::Stub::DeleteCompressedSequence, request,
                      &response);
}

absl::Status RemoteCharacterService::DecodeFrames(const std::string& id, FrameRange range,
                                                  const DecodedFramesSink& sink) {
  v1::DecodeFramesRequest request;
  request.set_id(id);
  request.set_begin_frame(range.begin);
  request.set_end_frame(range.end);
  grpc::ClientContext context;
  const auto stream = state_->compressed->DecodeFrames(&context, request);
  DecodedFramesReader reader(range, &sink);
  v1::DecodeFramesResponse part;
  absl::Status status;
  while (status.ok() && stream->Read(&part)) status = reader.Take(part);
  if (!status.ok()) context.TryCancel();
  const absl::Status end = FromGrpcStatus(stream->Finish());
  PLEAT_RETURN_IF_ERROR(status);
  PLEAT_RETURN_IF_ERROR(end);
  return reader.End();
}

}  // namespace pleat
