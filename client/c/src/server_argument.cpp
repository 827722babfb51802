#include "server_argument.h"

#include <string>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

std::string TextOrEmpty(const char* text) { return text == nullptr ? "" : text; }

}  // namespace

RemoteOptions TakeRemoteOptions(const char* token, const char* tls_root_certificates,
                                double connect_seconds) {
  RemoteOptions remote{.token = TextOrEmpty(token)};
  if (connect_seconds > 0) remote.connect_seconds = connect_seconds;
  remote.tls = tls_root_certificates != nullptr;
  remote.tls_root_certificates = TextOrEmpty(tls_root_certificates);
  return remote;
}

absl::Status NameOtherServers(absl::Status status, const char* address) {
  if (status.code() != absl::StatusCode::kUnimplemented) return status;
  return absl::UnimplementedError(
      absl::StrCat("the server at ", address,
                   " does not have what version " PLEAT_VERSION
                   " asks for (pleat.v1): it is no Pleat server, or one of another version: ",
                   status.message()));
}

}  // namespace pleat
