// Training time and memory against the number of frames, on generated performers of 10,000
// vertices: scale_curve FOLDER [MAX_FRAMES]. The table and plot of docs/performance.md.
#include <time.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/train_character.h"
#include "pleat/performer/performer.h"
#include "pleat/render/line_plot.h"

namespace pleat {
namespace {

constexpr int kStepFrames = 2000, kNumVertices = 10000;

double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double CpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Largest resident size since the last reset, MB (Linux).
double PeakMegabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::strtod(line.c_str() + 6, nullptr) / 1000;
  }
  return 0;
}

void ResetPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }

absl::Status Measure(const std::string& folder, int max_frames) {
  PlotSeries seconds{"CPU seconds", {}}, megabytes{"peak memory (10 MB)", {}};
  std::printf("%7s %9s %9s %9s %10s %14s\n", "frames", "wall s", "CPU s", "peak MB", "learner",
              "mean error %");
  for (int frames = kStepFrames; frames <= max_frames; frames += kStepFrames) {
    PerformerOptions options;
    options.num_frames = frames;
    options.num_vertices = kNumVertices;
    PLEAT_ASSIGN_OR_RETURN(Performer performer, GeneratePerformer(options));
    const std::vector<MeshSequence> clips = {std::move(performer.sequence)};
    ResetPeak();
    const double wall = WallSeconds(), cpu = CpuSeconds();
    PLEAT_ASSIGN_OR_RETURN(const auto model, TrainCharacter(clips, {}));
    seconds.values.push_back(CpuSeconds() - cpu);
    megabytes.values.push_back(PeakMegabytes() / 10);
    std::printf("%7d %9.1f %9.1f %9.0f %10s %14.4f\n", frames, WallSeconds() - wall,
                seconds.values.back(), 10 * megabytes.values.back(),
                model->record().learner.c_str(), model->record().reconstruction.mean_percent);
    std::fflush(stdout);
  }
  PLEAT_ASSIGN_OR_RETURN(const Image plot,
                         RenderLinePlot({seconds, megabytes}, {.title = "Training at scale",
                                                               .x_label = "thousands of frames / 2",
                                                               .y_label = "s, 10 MB",
                                                               .first_x = 1}));
  return WriteFile(folder + "/scale.png", EncodePng(plot));
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "scale_curve FOLDER [MAX_FRAMES]\n");
    return 2;
  }
  const absl::Status status = pleat::Measure(argv[1], argc > 2 ? std::atoi(argv[2]) : 10000);
  if (!status.ok()) {
    std::fprintf(stderr, "%s\n", status.ToString().c_str());
    return 1;
  }
}
