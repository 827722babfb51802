#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "error_report.h"
#include "pleat/base/status.h"
#include "pleat/formats/model_file.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat_session.h"
#include "pose_argument.h"
#include "query_argument.h"
#include "server_argument.h"

struct pleat_session {
  std::unique_ptr<pleat::RemoteCharacterService> service;  // declared first: the session uses it
  std::unique_ptr<pleat::LiveSession> live;
  int num_vertices = 0;
  pleat::Pose pose;                  // the one that is being sent
  std::vector<pleat::Pose> history;  // of its own
  pleat::LiveFrame answer;           // the one that is being received
};

namespace pleat {
namespace {

absl::StatusOr<LiveSessionOptions> TakeLiveOptions(const pleat_session_options& options) {
  LiveSessionOptions live{.latest_wins = options.latest_wins != 0};
  live.stream.encoding = FrameEncoding::kDracoDelta;
  const auto set = [](uint32_t given, int* option) {
    constexpr uint32_t kTooLarge = 1 << 20;  // every option refuses it
    if (given > 0) *option = static_cast<int>(std::min(given, kTooLarge));
  };
  set(options.position_bits, &live.stream.position_bits);
  set(options.max_in_flight, &live.max_in_flight);
  set(options.max_reconnects, &live.max_reconnects);
  if (options.content == PLEAT_CONTENT_PARAMETERS) {
    live.stream.content = StreamContent::kParameters;
  } else if (options.content != PLEAT_CONTENT_MESH) {
    return absl::InvalidArgumentError(absl::StrCat("content ", options.content, " is not known"));
  }
  return live;
}

absl::Status Start(const pleat_session_options& options, pleat_session* session) {
  PLEAT_ASSIGN_OR_RETURN(LiveSessionOptions live, TakeLiveOptions(options));
  const std::string model_id = options.model_id;
  if (live.stream.content == StreamContent::kParameters) {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes,
                           session->service->models().Download(model_id, {}));
    PLEAT_ASSIGN_OR_RETURN(live.model, DecodeModel(bytes));
    session->num_vertices = live.model->num_vertices();
  }
  ClipQuery character;
  character.model_id = model_id;
  character.skinned_only = options.skinned_only != 0;
  if (options.bone_scales != nullptr) {
    character.bone_scales.assign(options.bone_scales,
                                 options.bone_scales + options.num_bone_scales);
  }
  PLEAT_ASSIGN_OR_RETURN(session->live, session->service->poses().OpenLiveSession(character, live));
  if (session->num_vertices == 0) session->num_vertices = session->live->header().num_vertices;
  return absl::OkStatus();
}

absl::Status Open(const pleat_session_options* options, pleat_session** session) {
  if (session == nullptr) return IsNull("session");
  *session = nullptr;
  if (options == nullptr) return IsNull("options");
  PLEAT_RETURN_IF_ERROR(CheckStructSize("pleat_session_options", options->struct_size,
                                        sizeof(pleat_session_options)));
  if (options->address == nullptr) return IsNull("address");
  if (options->model_id == nullptr) return IsNull("model_id");
  auto opened = std::make_unique<pleat_session>();
  PLEAT_ASSIGN_OR_RETURN(
      opened->service,
      RemoteCharacterService::Connect(
          options->address, TakeRemoteOptions(options->token, options->tls_root_certificates,
                                              options->connect_seconds)));
  PLEAT_RETURN_IF_ERROR(NameOtherServers(Start(*options, opened.get()), options->address));
  *session = opened.release();
  return absl::OkStatus();
}

absl::Status Send(pleat_session* session, uint64_t number, const pleat_pose* poses,
                  size_t num_poses, uint32_t flags) {
  if ((flags & ~uint32_t{PLEAT_SEND_RESTART | PLEAT_SEND_KEYFRAME}) != 0) {
    return absl::InvalidArgumentError(absl::StrCat("flags ", flags, " are not known"));
  }
  constexpr size_t kMostPoses = 8;  // what the server takes
  if (num_poses == 0 || num_poses > kMostPoses) {
    return absl::InvalidArgumentError(
        absl::StrCat(num_poses, " poses; one is shown, and at most 7 come before it"));
  }
  session->history.resize(num_poses - 1);
  for (size_t h = 0; h < num_poses; ++h) {
    // The server knows the skeleton, so it checks the number of joints; here it is only bounded.
    constexpr size_t kMostJoints = 1 << 16;
    if (poses[h].num_joints > kMostJoints) {
      return absl::InvalidArgumentError(
          absl::StrCat("the pose has ", poses[h].num_joints, " joints"));
    }
    PLEAT_RETURN_IF_ERROR(TakePose(poses[h], static_cast<int>(poses[h].num_joints),
                                   h == 0 ? &session->pose : &session->history[h - 1]));
  }
  return session->live->Send(number, session->pose, session->history,
                             (flags & PLEAT_SEND_RESTART) != 0, (flags & PLEAT_SEND_KEYFRAME) != 0);
}

absl::Status Receive(pleat_session* session, pleat_frame* frame) {
  PLEAT_RETURN_IF_ERROR(CheckStructSize("pleat_frame", frame->struct_size, sizeof(pleat_frame)));
  VertexRows rows;
  if (frame->positions.data != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(rows, TakeRows("positions", frame->positions, session->num_vertices));
  }
  LiveFrame& answer = session->answer;
  const absl::Status status = session->live->Receive(&answer);
  frame->number = answer.number;
  PLEAT_RETURN_IF_ERROR(status);
  frame->confidence = answer.confidence;
  frame->num_superseded = static_cast<uint32_t>(answer.num_superseded);
  frame->resumed = answer.resumed ? 1 : 0;
  frame->queue_us = answer.times.queue_us;
  frame->evaluate_us = answer.times.evaluate_us;
  frame->encode_us = answer.times.encode_us;
  if (answer.positions.cols() != session->num_vertices) {
    return absl::DataLossError(absl::StrCat("the frame has ", answer.positions.cols(),
                                            " vertices, the stream has ", session->num_vertices));
  }
  for (int v = 0; rows.data != nullptr && v < session->num_vertices; ++v) {
    std::copy_n(answer.positions.col(v).data(), 3, rows.row(v));
  }
  return absl::OkStatus();
}

}  // namespace
}  // namespace pleat

using pleat::Guarded;
using pleat::IsNull;

extern "C" {

pleat_code pleat_session_open(const pleat_session_options* options, pleat_session** session,
                              pleat_error* error) {
  return Guarded(error, [&] { return pleat::Open(options, session); });
}

void pleat_session_destroy(pleat_session* session) { delete session; }

uint32_t pleat_session_num_vertices(const pleat_session* session) {
  return session == nullptr ? 0 : static_cast<uint32_t>(session->num_vertices);
}

pleat_code pleat_session_send(pleat_session* session, uint64_t number, const pleat_pose* pose,
                              uint32_t flags, pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (session == nullptr) return IsNull("session");
    if (pose == nullptr) return IsNull("pose");
    return pleat::Send(session, number, pose, 1, flags);
  });
}

pleat_code pleat_session_send_poses(pleat_session* session, uint64_t number,
                                    const pleat_pose* poses, size_t num_poses, uint32_t flags,
                                    pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (session == nullptr) return IsNull("session");
    if (poses == nullptr) return IsNull("poses");
    return pleat::Send(session, number, poses, num_poses, flags);
  });
}

void pleat_session_send_done(pleat_session* session) {
  if (session != nullptr) session->live->SendDone();
}

pleat_code pleat_session_receive(pleat_session* session, pleat_frame* frame, pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (session == nullptr) return IsNull("session");
    if (frame == nullptr) return IsNull("frame");
    return pleat::Receive(session, frame);
  });
}

int pleat_session_ended(const pleat_session* session) {
  return session == nullptr || session->live->ended() ? 1 : 0;
}

}  // extern "C"
