#include "pleat/formats/obj_reader.h"

#include <utility>

#include "obj_parser.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {

absl::StatusOr<MeshFile> DecodeObj(std::string_view text, const std::string& file,
                                   const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(ObjFrame frame, ParseObj(text, file, limits, nullptr, nullptr));
  return std::move(frame.mesh);
}

absl::StatusOr<MeshFile> ReadObj(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, limits.max_file_bytes));
  return DecodeObj(text, path, limits);
}

}  // namespace pleat
