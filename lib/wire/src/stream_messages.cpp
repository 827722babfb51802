#include "pleat/wire/stream_messages.h"

#include "absl/strings/str_cat.h"
#include "packed_coefficients.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

namespace {
constexpr int kMaxWireCoefficients = 4096;
}

v1::Character ToProto(const CharacterQuery& query) {
  v1::Character message;
  message.set_model_id(query.model_id);
  for (const double scale : query.bone_scales) message.add_bone_scales(scale);
  message.set_skinned_only(query.skinned_only);
  for (const double strength : query.strengths.joints) message.add_detail_strengths(strength);
  message.mutable_vertex_strengths()->Add(query.strengths.vertices.begin(),
                                          query.strengths.vertices.end());
  return message;
}

absl::StatusOr<CharacterQuery> FromProto(const v1::Character& message) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(message.model_id(), "character.model_id"));
  if (message.bone_scales_size() > kMaxWireJoints) {
    return absl::InvalidArgumentError(absl::StrCat("character.bone_scales has ",
                                                   message.bone_scales_size(),
                                                   " entries, the limit is ", kMaxWireJoints));
  }
  if (message.detail_strengths_size() > kMaxWireJoints) {
    return absl::InvalidArgumentError(absl::StrCat("character.detail_strengths has ",
                                                   message.detail_strengths_size(),
                                                   " entries, the limit is ", kMaxWireJoints));
  }
  if (message.vertex_strengths_size() > MeshLimits().max_vertices) {
    return absl::InvalidArgumentError(
        absl::StrCat("character.vertex_strengths has ", message.vertex_strengths_size(),
                     " entries, the limit is ", MeshLimits().max_vertices));
  }
  CharacterQuery query;
  query.model_id = message.model_id();
  query.bone_scales.assign(message.bone_scales().begin(), message.bone_scales().end());
  query.skinned_only = message.skinned_only();
  query.strengths.joints.assign(message.detail_strengths().begin(),
                                message.detail_strengths().end());
  query.strengths.vertices.assign(message.vertex_strengths().begin(),
                                  message.vertex_strengths().end());
  return query;
}

v1::FrameEncoding ToProto(FrameEncoding encoding) {
  switch (encoding) {
    case FrameEncoding::kDracoMesh:
      return v1::FRAME_ENCODING_DRACO_MESH;
    case FrameEncoding::kDracoPointCloud:
      return v1::FRAME_ENCODING_DRACO_POINT_CLOUD;
    case FrameEncoding::kDracoDelta:
      break;
  }
  return v1::FRAME_ENCODING_DRACO_DELTA;
}

absl::StatusOr<FrameEncoding> FromProto(v1::FrameEncoding encoding) {
  switch (encoding) {
    case v1::FRAME_ENCODING_DRACO_MESH:
      return FrameEncoding::kDracoMesh;
    case v1::FRAME_ENCODING_UNSPECIFIED:
    case v1::FRAME_ENCODING_DRACO_POINT_CLOUD:
      return FrameEncoding::kDracoPointCloud;
    case v1::FRAME_ENCODING_DRACO_DELTA:
      return FrameEncoding::kDracoDelta;
    default:
      return absl::InvalidArgumentError(
          absl::StrCat("encoding is ", static_cast<int>(encoding), ", which is unknown"));
  }
}

v1::StreamContent ToProto(StreamContent content) {
  switch (content) {
    case StreamContent::kMesh:
      return v1::STREAM_CONTENT_MESH;
    case StreamContent::kControlMesh:
      return v1::STREAM_CONTENT_CONTROL_MESH;
    case StreamContent::kParameters:
      break;
  }
  return v1::STREAM_CONTENT_PARAMETERS;
}

absl::StatusOr<StreamContent> FromProto(v1::StreamContent content) {
  switch (content) {
    case v1::STREAM_CONTENT_UNSPECIFIED:
    case v1::STREAM_CONTENT_MESH:
      return StreamContent::kMesh;
    case v1::STREAM_CONTENT_CONTROL_MESH:
      return StreamContent::kControlMesh;
    case v1::STREAM_CONTENT_PARAMETERS:
      return StreamContent::kParameters;
    default:
      return absl::InvalidArgumentError(
          absl::StrCat("content is ", static_cast<int>(content), ", which is unknown"));
  }
}

v1::FrameParameters ToProto(const FrameParameters& parameters) {
  v1::FrameParameters message;
  const Eigen::Vector3d& root = parameters.pose.root_position;
  message.mutable_root_position()->set_x(root.x());
  message.mutable_root_position()->set_y(root.y());
  message.mutable_root_position()->set_z(root.z());
  for (const Eigen::Quaterniond& rotation : parameters.pose.rotations) {
    for (const double value : {rotation.w(), rotation.x(), rotation.y(), rotation.z()}) {
      message.add_rotations(static_cast<float>(value));
    }
  }
  if (parameters.coefficients.size() > kMaxPlainCoefficients) {
    message.set_packed_coefficients(PackCoefficients(parameters.coefficients));
  } else {
    message.mutable_coefficients()->Add(parameters.coefficients.begin(),
                                        parameters.coefficients.end());
  }
  return message;
}

absl::StatusOr<FrameParameters> FromProto(const v1::FrameParameters& message) {
  const int num_joints = message.rotations_size() / 4;
  if (message.rotations_size() % 4 != 0 || num_joints < 1 || num_joints > kMaxWireJoints) {
    return absl::InvalidArgumentError(
        absl::StrCat("parameters.rotations has ", message.rotations_size(),
                     " entries, not four for each of 1 to ", kMaxWireJoints, " joints"));
  }
  if (message.coefficients_size() > kMaxWireCoefficients) {
    return absl::InvalidArgumentError(
        absl::StrCat("parameters.coefficients has ", message.coefficients_size(),
                     " entries, the limit is ", kMaxWireCoefficients));
  }
  FrameParameters parameters;
  const v1::Vector3& root = message.root_position();
  parameters.pose.root_position << root.x(), root.y(), root.z();
  for (int j = 0; j < num_joints; ++j) {
    parameters.pose.rotations.emplace_back(message.rotations(4 * j), message.rotations(4 * j + 1),
                                           message.rotations(4 * j + 2),
                                           message.rotations(4 * j + 3));
  }
  if (!message.packed_coefficients().empty()) {
    if (message.coefficients_size() > 0) {
      return absl::InvalidArgumentError("parameters have plain and packed coefficients");
    }
    PLEAT_ASSIGN_OR_RETURN(parameters.coefficients,
                           UnpackCoefficients(message.packed_coefficients(), kMaxWireCoefficients));
    return parameters;
  }
  parameters.coefficients =
      Eigen::Map<const Eigen::VectorXf>(message.coefficients().data(), message.coefficients_size());
  return parameters;
}

v1::StreamOptions ToProto(const FrameEncoderOptions& options) {
  v1::StreamOptions message;
  message.set_content(ToProto(options.content));
  message.set_encoding(ToProto(options.encoding));
  if (options.max_error_mm > 0) {
    message.set_max_error_mm(options.max_error_mm);
  } else {
    message.set_position_bits(options.position_bits);
  }
  message.set_speed(options.speed);
  return message;
}

absl::StatusOr<FrameEncoderOptions> FromProto(const v1::StreamOptions& message) {
  FrameEncoderOptions options;
  PLEAT_ASSIGN_OR_RETURN(options.encoding, FromProto(message.encoding()));
  PLEAT_ASSIGN_OR_RETURN(options.content, FromProto(message.content()));
  if (message.position_bits() != 0) options.position_bits = message.position_bits();
  if (options.position_bits < QuantizationBox::kMinBits ||
      options.position_bits > QuantizationBox::kMaxBits) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.position_bits is ", options.position_bits, ", allowed are ",
                     QuantizationBox::kMinBits, " to ", QuantizationBox::kMaxBits));
  }
  options.max_error_mm = message.max_error_mm();
  if (options.max_error_mm != 0 && message.position_bits() != 0) {
    return absl::InvalidArgumentError(
        "options.max_error_mm and options.position_bits cannot both be given");
  }
  if (options.max_error_mm != 0 && !(options.max_error_mm >= 1e-3 && options.max_error_mm <= 1e6)) {
    return absl::InvalidArgumentError(absl::StrCat("options.max_error_mm is ", options.max_error_mm,
                                                   ", allowed are 1e-3 to 1e6"));
  }
  if (message.has_speed()) options.speed = message.speed();
  if (options.speed < 0 || options.speed > 10) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.speed is ", options.speed, ", allowed are 0 to 10"));
  }
  return options;
}

FrameMark MarkOf(const v1::Frame& frame) {
  return {.keyframe = !frame.difference(), .checksum = frame.checksum()};
}

v1::StreamHeader ToProto(const StreamHeader& header) {
  v1::StreamHeader message;
  message.set_encoding(ToProto(header.encoding));
  message.set_content(ToProto(header.content));
  message.mutable_control_vertices()->Add(header.control_vertices.begin(),
                                          header.control_vertices.end());
  message.set_num_vertices(header.num_vertices);
  message.set_num_points(header.num_points);
  message.set_num_triangles(header.num_triangles);
  v1::QuantizationBox* box = message.mutable_box();
  box->set_origin_x(header.box.origin_m.x());
  box->set_origin_y(header.box.origin_m.y());
  box->set_origin_z(header.box.origin_m.z());
  box->set_range(header.box.range_m);
  box->set_bits(header.box.bits);
  message.set_topology_draco(header.topology);
  message.mutable_vertex_order()->Add(header.vertex_order.begin(), header.vertex_order.end());
  return message;
}

absl::StatusOr<StreamHeader> FromProto(const v1::StreamHeader& message) {
  StreamHeader header;
  PLEAT_ASSIGN_OR_RETURN(header.encoding, FromProto(message.encoding()));
  PLEAT_ASSIGN_OR_RETURN(header.content, FromProto(message.content()));
  header.control_vertices.assign(message.control_vertices().begin(),
                                 message.control_vertices().end());
  header.num_vertices = message.num_vertices();
  header.num_points = message.num_points();
  header.num_triangles = message.num_triangles();
  const v1::QuantizationBox& box = message.box();
  header.box.origin_m << box.origin_x(), box.origin_y(), box.origin_z();
  header.box.range_m = box.range();
  header.box.bits = box.bits();
  PLEAT_RETURN_IF_ERROR(header.box.Validate());
  header.topology = message.topology_draco();
  header.vertex_order.assign(message.vertex_order().begin(), message.vertex_order().end());
  return header;
}

}  // namespace pleat
