// Frame streams on the wire. Messages come from outside: each FromProto checks them, and
// kInvalidArgument names the field that is wrong.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/service/pose_service.h"
#include "pleat/stream/frame_encoder.h"
#include "pleat/stream/stream_header.h"
#include "pleat/v1/pose_service.pb.h"

namespace pleat {

// Which character is shown and how.
struct CharacterQuery {
  std::string model_id;
  std::vector<double> bone_scales;  // J or empty
  bool skinned_only = false;
  DetailStrengths strengths{};
};

v1::Character ToProto(const CharacterQuery& query);
absl::StatusOr<CharacterQuery> FromProto(const v1::Character& message);

v1::FrameEncoding ToProto(FrameEncoding encoding);
absl::StatusOr<FrameEncoding> FromProto(v1::FrameEncoding encoding);  // unspecified: point cloud

v1::StreamContent ToProto(StreamContent content);
absl::StatusOr<StreamContent> FromProto(v1::StreamContent content);  // unspecified: the mesh

v1::FrameParameters ToProto(const FrameParameters& parameters);  // leaves out the confidence
// Checks the counts alone; PoseEvaluator::Show compares the values with its model.
absl::StatusOr<FrameParameters> FromProto(const v1::FrameParameters& message);

v1::StreamOptions ToProto(const FrameEncoderOptions& options);  // the server chooses box_margin
absl::StatusOr<FrameEncoderOptions> FromProto(const v1::StreamOptions& message);

FrameMark MarkOf(const v1::Frame& frame);

v1::StreamHeader ToProto(const StreamHeader& header);
// Checks the encoding, the content and the box; FrameDecoder::Create checks the rest against its
// limits.
absl::StatusOr<StreamHeader> FromProto(const v1::StreamHeader& message);

}  // namespace pleat
