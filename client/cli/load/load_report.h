// What a load run found, as percentiles and rates, in JSON, text and a plot.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/load/load_run.h"

namespace pleat {

// Returns the smallest value that at least `percent` % of `sorted` do not exceed. `sorted` ascends
// and is not empty.
double Percentile(const std::vector<double>& sorted, double percent);

// The speed of Draco's own encoder on frames of the run, on one core.
struct DracoSpeed {
  double encode_ms = 0;  // processor time per frame
  int num_frames = 0;
};

struct LoadReport {
  std::string model_id, encoding;
  int num_vertices = 0;
  LoadOptions options;
  LoadResult result;
  DracoSpeed draco;

  // The parts of the time that each frame took, in milliseconds, over all frames and ascending.
  std::vector<double> latency_ms, queue_ms, evaluate_ms, encode_ms;
  int num_frames = 0;
  double bytes_per_frame = 0;
  std::vector<double> achieved_fps;  // one per client

  // Fills in the seven members above from `result`.
  void Summarize();
  double frames_per_cpu_second() const;  // frames per second of the server's processor time
  double draco_frames_per_cpu_second() const;
};

nlohmann::ordered_json LoadReportJson(const LoadReport& report);  // "pleat.bench/1"
void PrintLoadReport(const LoadReport& report, std::ostream& out);
// Plots milliseconds over the percentile of the frames: the bytes of `path` (EncodeLinePlot).
absl::StatusOr<std::string> PlotLoad(const LoadReport& report, const std::string& path);

}  // namespace pleat
