// The target of a request, "/rpc/JobService/GetJob?x=1", and paths that a browser names files by.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace pleat {

struct RequestTarget {
  std::vector<std::string> segments;         // of the path, decoded: "rpc", "JobService", "GetJob"
  std::map<std::string, std::string> query;  // decoded; of several values of a name the last one
};

// kInvalidArgument when it is no absolute path, has a bad escape, a control character or bytes that
// are no UTF-8, or more than 32 segments or values.
absl::StatusOr<RequestTarget> ParseTarget(std::string_view target);

// A path inside a folder, as it came from outside: the same when each part can be a file's name,
// and it stays inside. kInvalidArgument says what is wrong.
absl::StatusOr<std::string> CheckRelativePath(std::string_view path);

}  // namespace pleat
