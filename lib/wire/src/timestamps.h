// Points in time on the wire.
#pragma once

#include <google/protobuf/timestamp.pb.h>

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "pleat/base/status.h"
#include "pleat/service/entry_life.h"

namespace pleat {

google::protobuf::Timestamp ToProto(absl::Time time);
// kInvalidArgument names `what` when the time is not within the years 1 to 9999.
absl::StatusOr<absl::Time> FromProto(const google::protobuf::Timestamp& message,
                                     const std::string& what);

// The fields of a message that EntryLife has.
template <typename Message>
void LifeToProto(const EntryLife& life, Message* message) {
  if (life.created) *message->mutable_created() = ToProto(*life.created);
  if (life.expires) *message->mutable_expires() = ToProto(*life.expires);
  message->set_pinned(life.pinned);
}

// what: the name of the message in errors, such as "sequence".
template <typename Message>
absl::StatusOr<EntryLife> LifeFromProto(const Message& message, const std::string& what) {
  EntryLife life;
  if (message.has_created()) {
    PLEAT_ASSIGN_OR_RETURN(life.created, FromProto(message.created(), what + ".created"));
  }
  if (message.has_expires()) {
    PLEAT_ASSIGN_OR_RETURN(life.expires, FromProto(message.expires(), what + ".expires"));
  }
  life.pinned = message.pinned();
  return life;
}

}  // namespace pleat
