#include "cli/input.h"

#include "cli/draco_folder.h"
#include "cli/frame_rate.h"
#include "cli/progress_display.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_reader.h"

namespace pleat {

absl::StatusOr<MeshSequence> ReadInput(const Session& session, const std::string& input,
                                       const std::string& fps) {
  ReadSequenceOptions options;
  if (!fps.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.frame_rate, ParseFrameRate(fps));
  }
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  if (IsDracoFolder(input)) {
    return ReadDracoFolder(input, InterruptibleProgress(&display).Stage("read", 0, 1));
  }
  return ReadSequence(input, options, InterruptibleProgress(&display).Stage("read", 0, 1));
}

}  // namespace pleat
