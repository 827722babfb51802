// Requests as the handlers take them: parsed, checked and converted. The first byte says which.
#include <google/protobuf/message.h>

#include <cstddef>
#include <cstdint>
#include <memory>

#include "page_token.h"
#include "pleat/service/limits.h"
#include "pleat/v1/compressed_sequence_service.pb.h"
#include "pleat/v1/job_service.pb.h"
#include "pleat/v1/pose_service.pb.h"
#include "pleat/v1/sequence_service.pb.h"
#include "pleat/wire/limit_messages.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "pleat/wire/training_messages.h"

namespace {

using namespace pleat;  // NOLINT(google-build-using-namespace)

void Take(const v1::CreateTrainingJobRequest& request) {
  CheckName(request.model_name(), "model_name").IgnoreError();
  CheckRequestId(request.request_id()).IgnoreError();
  TtlFromSeconds(request.model_ttl_seconds(), "model_ttl_seconds").IgnoreError();
  const auto options = FromProto(request.options());
  // Options that are let in must mean the same on their way back.
  if (options.ok() && !FromProto(ToProto(*options)).ok()) __builtin_trap();
}

void Take(const v1::CreateCompressionJobRequest& request) {
  CheckRequestId(request.request_id()).IgnoreError();
  TtlFromSeconds(request.result_ttl_seconds(), "result_ttl_seconds").IgnoreError();
  FromProto(request.options()).IgnoreError();
}

void Take(const v1::UploadSequenceRequest& request) {
  TtlFromSeconds(request.header().ttl_seconds(), "header.ttl_seconds").IgnoreError();
}

void Take(const v1::EvaluateClipRequest& request) {
  FromProto(request.character()).IgnoreError();
  FromProto(request.options()).IgnoreError();
  const auto track = FromProto(request.track());
  if (track.ok() && track->num_frames() != request.track().poses_size()) __builtin_trap();
}

void Take(const v1::EvaluatePoseRequest& request) {
  FromProto(request.character()).IgnoreError();
  FromProto(request.options()).IgnoreError();
  FromProto(request.poses(), "poses").IgnoreError();
}

void Take(const v1::LiveSessionRequest& request) {
  FromProto(request.start().character()).IgnoreError();
  FromProto(request.start().options()).IgnoreError();
  const auto pose = FromProto(request.pose().pose());
  if (pose.ok() && !FromProto(ToProto(*pose)).ok()) __builtin_trap();
  FromProto(request.pose().history(), "pose.history").IgnoreError();
}

template <typename Request>
void Parse(const uint8_t* data, size_t size) {
  Request request;
  if (request.ParseFromArray(data, static_cast<int>(size))) Take(request);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const uint8_t which = *data++;
  --size;
  switch (which % 8) {
    case 0:
      Parse<v1::CreateTrainingJobRequest>(data, size);
      break;
    case 1:
      Parse<v1::CreateCompressionJobRequest>(data, size);
      break;
    case 2:
      Parse<v1::UploadSequenceRequest>(data, size);
      break;
    case 3:
      Parse<v1::EvaluateClipRequest>(data, size);
      break;
    case 4:
      Parse<v1::EvaluatePoseRequest>(data, size);
      break;
    case 5:
      Parse<v1::LiveSessionRequest>(data, size);
      break;
    case 6:  // the token of a page
      PageTokens("secret", "robots")
          .Parse(EntryKind::kJob, std::string(reinterpret_cast<const char*>(data), size))
          .IgnoreError();
      break;
    default:  // what a server sends beside a refusal
      WithLimitDetails(absl::ResourceExhaustedError("x"),
                       std::string(reinterpret_cast<const char*>(data), size))
          .IgnoreError();
  }
  return 0;
}
