// A folder of Draco frames: stream.json with what a stream says once, topology.drc, frame_0000.drc
// and so on. client/README.md describes the layout.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

// Writes a stream as it comes, whatever has encoded it.
class DracoFolderWriter {
 public:
  DracoFolderWriter(std::string folder, FrameRate frame_rate)
      : folder_(std::move(folder)), frame_rate_(frame_rate) {}

  absl::Status AddFrame(std::string_view draco_bytes);
  // Writes topology.drc and, last of all, stream.json, so that a folder with it is complete.
  absl::Status Finish(const StreamHeader& header);

 private:
  std::string folder_;
  FrameRate frame_rate_;
  int num_frames_ = 0;
};

bool IsDracoFolder(const std::string& path);

// Decodes such a folder. Vertices are in the character's order, triangles are those of the stream.
// kInvalidArgument and kDataLoss name the file that is wrong.
absl::StatusOr<MeshSequence> ReadDracoFolder(const std::string& folder,
                                             const Progress& progress = {});

}  // namespace pleat
