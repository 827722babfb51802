// What a request is about, for the audit log.
#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <vector>

namespace pleat {

// The values of the fields `id`, `..._id` and `..._ids` of `message` and of the messages in it, at
// most eight, each cut to 64 bytes. They come from outside and may be anything.
std::vector<std::string> NamedIds(const google::protobuf::Message& message);

}  // namespace pleat
