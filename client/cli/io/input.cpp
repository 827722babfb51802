#include "cli/io/input.h"

#include "cli/io/draco_folder.h"
#include "cli/io/draco_process.h"
#include "cli/io/frame_rate.h"
#include "cli/show/progress_display.h"
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
  const Progress progress = InterruptibleProgress(&display).Stage("read", 0, 1);
  if (IsDracoFolder(input)) return ReadDracoFolder(input, progress);
  options.read_draco = [&progress](const std::string& path) {
    return ReadDracoMesh(path, progress);
  };
  return ReadSequence(input, options, progress);
}

}  // namespace pleat
