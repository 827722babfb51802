// Fit error of the automatic rig, plain and refined, on whole sequences and on held-out halves:
// refine_table INPUT... The tables of docs/performance.md.
#include <chrono>
#include <cstdio>
#include <numeric>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/fitting/rig_refinement.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/mesh/bounds.h"
#include "pleat/rigging/auto_rig.h"

namespace pleat {
namespace {

constexpr double kBendStiffness = 1e-4;  // the default of training

PoseFitOptions FitOptions() { return {.bend_stiffness = kBendStiffness, .num_threads = 1}; }

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

MeshSequence Frames(const MeshSequence& sequence, int begin, int end) {
  std::vector<int> frames(end - begin);
  std::iota(frames.begin(), frames.end(), begin);
  return sequence.Subset(frames);
}

// RMS in % of the diagonal of frame 0, and seconds of the pose fit.
absl::StatusOr<double> FitPercent(const MeshSequence& sequence, const Rig& rig, double diagonal_m) {
  PoseFitSummary summary;
  PLEAT_RETURN_IF_ERROR(FitPoses(sequence, rig, FitOptions(), &summary).status());
  return 100 * summary.rms_m / diagonal_m;
}

// A row per kind of refinement on the rig of `train`; `test`: other frames with that rig fixed.
absl::Status PrintRows(const std::string& label, const MeshSequence& train,
                       const MeshSequence* test, double diagonal_m) {
  PLEAT_ASSIGN_OR_RETURN(const Rig rig, AutoRig(train));
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitPoses(train, rig, FitOptions(), nullptr));
  for (const std::string refine : {"none", "joints", "full"}) {
    Rig refined = rig;
    const double start = Seconds();
    double moved_m = 0;
    if (refine != "none") {
      RigRefinementOptions options =
          refine == "joints" ? RigRefinementOptions::JointsOnly() : RigRefinementOptions();
      options.bend_stiffness = kBendStiffness;
      options.num_threads = 1;
      RigRefinementSummary summary;
      PLEAT_ASSIGN_OR_RETURN(refined, RefineRig(train, rig, track, options, &summary));
      for (const double moved : summary.joint_moved_m) moved_m = std::max(moved_m, moved);
    }
    const double seconds = Seconds() - start;
    PLEAT_ASSIGN_OR_RETURN(const double percent, FitPercent(train, refined, diagonal_m));
    std::printf("%-28s %-7s RMS %.3f %%", label.c_str(), refine.c_str(), percent);
    if (test != nullptr) {
      PLEAT_ASSIGN_OR_RETURN(const double held_out, FitPercent(*test, refined, diagonal_m));
      std::printf("  held out %.3f %%", held_out);
    }
    std::printf("  joints moved up to %.0f mm  %.2f s\n", 1000 * moved_m, seconds);
  }
  return absl::OkStatus();
}

absl::Status PrintTable(const std::string& input) {
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, ReadSequence(input));
  const double diagonal_m = BoundsDiagonal(sequence.FrameAsDouble(0));
  const int half = sequence.num_frames() / 2;
  PLEAT_RETURN_IF_ERROR(PrintRows(sequence.name() + ", all frames", sequence, nullptr, diagonal_m));
  const MeshSequence second = Frames(sequence, half, sequence.num_frames());
  return PrintRows(sequence.name() + ", first half", Frames(sequence, 0, half), &second,
                   diagonal_m);
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const absl::Status status = pleat::PrintTable(argv[i]);
    if (!status.ok()) {
      std::fprintf(stderr, "%s\n", status.ToString().c_str());
      return 1;
    }
  }
}
