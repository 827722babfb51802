// What a load run found: percentiles, rates, JSON, text and a plot.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/load/load_run.h"
#include "pleat/render/image.h"

namespace pleat {

// The smallest value that at least `percent` of `sorted` (ascending, not empty) do not exceed.
double Percentile(const std::vector<double>& sorted, double percent);

// Draco's own encoder on frames of the run, on one core.
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

  // Measured parts of all frames, milliseconds, ascending.
  std::vector<double> latency_ms, queue_ms, evaluate_ms, encode_ms;
  int num_frames = 0;
  double bytes_per_frame = 0;
  std::vector<double> achieved_fps;  // per client

  // Fills the last seven from `result`.
  void Summarize();
  double frames_per_cpu_second() const;  // of the server
  double draco_frames_per_cpu_second() const;
};

nlohmann::ordered_json LoadReportJson(const LoadReport& report);  // "pleat.bench/1"
void PrintLoadReport(const LoadReport& report, std::ostream& out);
// Milliseconds over the percentile of the frames.
absl::StatusOr<Image> PlotLoad(const LoadReport& report);

}  // namespace pleat
