#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/pull_stream.h"

namespace pleat {
namespace {

constexpr int64_t kChunkBytes = 512 << 10;
constexpr int64_t kBytesPerVertex = 3 * sizeof(float);

// Sends the shape, then frame after frame, in chunks.
struct Decode {
  CompressedSequenceService* compressed;
  v1::DecodeFramesRequest request;
  std::unique_ptr<DecodeSession> session = nullptr;
  std::string shape{};
  size_t shape_sent = 0;
  const Eigen::Matrix3Xf* frame = nullptr;  // is being sent and belongs to the session; or null
  int number = 0;                           // numbers this frame, or the next one when it is null
  int64_t next_vertex = 0;

  absl::StatusOr<bool> Next(v1::DecodeFramesResponse* response) {
    if (session == nullptr) PLEAT_RETURN_IF_ERROR(Open());
    if (shape_sent < shape.size()) {
      response->set_shape(shape.substr(shape_sent, kChunkBytes));
      shape_sent += response->shape().size();
      return true;
    }
    shape = {};
    if (frame == nullptr) {
      PLEAT_ASSIGN_OR_RETURN(frame, session->Next());
      if (frame == nullptr) return false;
      next_vertex = 0;
    }
    const int64_t count = std::min(frame->cols() - next_vertex, kChunkBytes / kBytesPerVertex);
    v1::DecodeFramesResponse::Positions* positions = response->mutable_positions();
    positions->set_frame(number);
    positions->set_first_vertex(static_cast<int>(next_vertex));
    positions->set_xyz(frame->data() + 3 * next_vertex, count * kBytesPerVertex);
    next_vertex += count;
    if (next_vertex == frame->cols()) {
      frame = nullptr;
      ++number;
    }
    return true;
  }

  absl::Status Open() {
    PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
    PLEAT_ASSIGN_OR_RETURN(session, compressed->OpenDecode(request.id(), {request.begin_frame(),
                                                                          request.end_frame()}));
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence first, session->Shape());
    shape = EncodeSequence(first);
    number = request.begin_frame();
    return absl::OkStatus();
  }
};

}  // namespace

grpc::ServerWriteReactor<v1::DecodeFramesResponse>* DecodeFrames(
    HandlerContext* context, const v1::DecodeFramesRequest& request) {
  const auto decode = std::make_shared<Decode>(Decode{context->compressed_sequences, request});
  return StartReactor<PullStream<v1::DecodeFramesResponse>>(
      context, context->transfer_executor, "DecodeFrames",
      [decode](v1::DecodeFramesResponse* response) { return decode->Next(response); });
}

}  // namespace pleat
