#include "cli/io/input.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/io/draco_folder.h"
#include "cli/io/draco_process.h"
#include "cli/io/frame_rate.h"
#include "cli/show/progress_display.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/mesh/frame_jumps.h"

namespace pleat {
namespace {

absl::StatusOr<MeshSequence> ReadWithProgress(const Session& session, const std::string& input,
                                              const std::string& fps, InputReport* report) {
  ReadSequenceOptions options;
  options.object = session.object;
  options.animation = session.animation;
  for (const std::string& key : session.npz_keys) {
    if (absl::Status status = SetNpzKey(key, &options.npz_keys); !status.ok()) {
      return UsageError(absl::StrCat("--key: ", status.message()));
    }
  }
  if (!fps.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.frame_rate, ParseFrameRate(fps));
  }
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const Progress progress = InterruptibleProgress(&display).Stage("read", 0, 1);
  if (IsDracoFolder(input)) {
    report->has_frame_rate = true;
    return ReadDracoFolder(input, progress);
  }
  options.read_draco = [&progress](const std::string& path) {
    return ReadDracoMesh(path, progress);
  };
  return ReadSequence(input, options, progress, report);
}

}  // namespace

absl::StatusOr<MeshSequence> ReadInput(const Session& session, const std::string& input,
                                       const std::string& fps, std::vector<InputNote>* notes,
                                       InputReport* wanted) {
  InputReport report;
  absl::StatusOr<MeshSequence> sequence = ReadWithProgress(session, input, fps, &report);
  if (!sequence.ok()) return sequence;
  for (InputNote& jump : DescribeJumps(FindFrameJumps(*sequence), report.frame_names)) {
    report.notes.push_back(std::move(jump));
  }
  SayNotes(session, report.notes, notes);
  if (wanted != nullptr) *wanted = report;
  const auto refused = std::ranges::count_if(report.notes, IsRefusedWhenStrict);
  if (!session.strict || refused == 0) return sequence;
  return absl::FailedPreconditionError(
      absl::StrCat("'", input, "' is refused because of --strict: see the ", refused,
                   refused == 1 ? " line above" : " lines above"));
}

void SayNotes(const Session& session, const std::vector<InputNote>& notes,
              std::vector<InputNote>* collected) {
  for (const InputNote& note : notes) {
    *session.err << SeverityName(note.severity) << ": " << EscapeControls(note.text) << "\n";
  }
  if (collected != nullptr) collected->insert(collected->end(), notes.begin(), notes.end());
}

absl::Status CheckIsClip(const MeshSequence& sequence, const std::string& input) {
  if (sequence.num_frames() >= 2) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("'", input, "' is one frame; a clip needs two frames"));
}

}  // namespace pleat
