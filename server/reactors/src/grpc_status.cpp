#include "pleat/reactors/grpc_status.h"

#include <string>

#include "pleat/base/utf8.h"
#include "pleat/wire/limit_messages.h"

namespace pleat {
namespace {

constexpr size_t kMaxMessageBytes = 2000;  // percent-encoded, they fit into the 8 KiB of metadata

}  // namespace

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  std::string message(status.message());
  if (message.size() > kMaxMessageBytes) message = message.substr(0, kMaxMessageBytes) + "...";
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), ToValidUtf8(message),
                      LimitDetailsOf(status));
}

}  // namespace pleat
