// Reads files that a browser has sent into a sequence of the service.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/grpc/call_gateway.h"
#include "pleat/mesh/mesh_limits.h"
#include "upload_folders.h"

namespace pleat {

// Makes a performer (lib/performer) and stores it like a take that was sent.
absl::StatusOr<std::string> StoreExample(CallGateway* gateway, const ForeignCaller& caller);

// Reads the files of `folder` (ReadSequence), stores them by the RPC UploadSequence on behalf of
// `caller`, and returns what the page shows, as JSON: the sequence, what the reader noticed, and
// what is unclean about the mesh. name: of the
// sequence, or empty for that of the files. memory may be null.
absl::StatusOr<std::string> StoreTake(CallGateway* gateway, const ForeignCaller& caller,
                                      const UploadFolders::Folder& folder, const std::string& name,
                                      const MeshLimits& limits, MemoryBudget* memory);

}  // namespace pleat
