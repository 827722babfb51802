// The RPCs of pleat.v1 as JSON, by the mapping of Protocol Buffers.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace google::protobuf {
class MethodDescriptor;
}

namespace pleat {

// Returns the method of pleat.v1, and kNotFound when there is none.
absl::StatusOr<const google::protobuf::MethodDescriptor*> FindMethod(const std::string& service,
                                                                     const std::string& method);
// "/pleat.v1.JobService/GetJob"
std::string FullName(const google::protobuf::MethodDescriptor& method);

// Makes the bytes of a request out of hostile JSON. kInvalidArgument says what is wrong with it.
absl::StatusOr<std::string> RequestFromJson(const google::protobuf::MethodDescriptor& method,
                                            std::string_view json);
// A response as one line of JSON, with the fields that have their defaults.
absl::StatusOr<std::string> ResponseToJson(const google::protobuf::MethodDescriptor& method,
                                           std::string_view bytes);

// Whether responses are pieces of a file: they have a field `data`.
bool IsDownload(const google::protobuf::MethodDescriptor& method);
// The piece in such a response, and the size of the whole file.
struct FilePiece {
  std::string data;
  uint64_t size_bytes = 0;
};
absl::StatusOr<FilePiece> PieceOf(const google::protobuf::MethodDescriptor& method,
                                  std::string_view bytes);

}  // namespace pleat
