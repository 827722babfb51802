// What the messages of stored sequences have in common, compressed or not: id, name, counts, frame
// rate, size and life.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "pleat/base/check_count.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/wire/skeleton_messages.h"
#include "timestamps.h"

namespace pleat {

template <typename Info, typename Message>
void ClipInfoToProto(const Info& info, Message* message) {
  message->set_id(info.id);
  message->set_name(ToValidUtf8(info.name));
  message->set_num_frames(info.num_frames);
  message->set_num_vertices(info.num_vertices);
  message->set_num_faces(info.num_faces);
  *message->mutable_frame_rate() = ToProto(info.frame_rate);
  message->set_size_bytes(info.size_bytes);
  LifeToProto(info.life, message);
}

// what: the name of the message in errors, such as "sequence".
template <typename Info, typename Message>
absl::Status ClipInfoFromProto(const Message& message, const std::string& what, Info* info) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(message.id(), absl::StrCat(what, ".id")));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_frames(), absl::StrCat(what, ".num_frames")));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_vertices(), absl::StrCat(what, ".num_vertices")));
  PLEAT_RETURN_IF_ERROR(CheckCount(message.num_faces(), absl::StrCat(what, ".num_faces")));
  info->id = message.id();
  info->name = message.name();
  info->num_frames = message.num_frames();
  info->num_vertices = message.num_vertices();
  info->num_faces = message.num_faces();
  PLEAT_ASSIGN_OR_RETURN(info->frame_rate, FromProto(message.frame_rate()));
  info->size_bytes = message.size_bytes();
  PLEAT_ASSIGN_OR_RETURN(info->life, LifeFromProto(message, what));
  return absl::OkStatus();
}

}  // namespace pleat
