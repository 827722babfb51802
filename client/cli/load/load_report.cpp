#include "cli/load/load_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "absl/strings/str_format.h"
#include "cli/show/text_table.h"
#include "cli/verbs/content_flag.h"
#include "pleat/render/line_plot.h"

namespace pleat {
namespace {

const char* ArrivalsName(Arrivals arrivals) {
  switch (arrivals) {
    case Arrivals::kFixed:
      return "fixed";
    case Arrivals::kPoisson:
      return "poisson";
    case Arrivals::kClosed:
      break;
  }
  return "closed";
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Returns "delta", "control delta", "parameters" and so on.
std::string ContentAndEncoding(const LoadReport& report) {
  const StreamContent content = report.options.session.stream.content;
  if (content == StreamContent::kMesh) return report.encoding;
  const std::string name = StreamContentName(content);
  return content == StreamContent::kParameters ? name : name + " " + report.encoding;
}

nlohmann::ordered_json TimesJson(const std::vector<double>& sorted) {
  return {{"mean", Mean(sorted)},
          {"p50", Percentile(sorted, 50)},
          {"p90", Percentile(sorted, 90)},
          {"p99", Percentile(sorted, 99)},
          {"p99_9", Percentile(sorted, 99.9)},
          {"max", sorted.back()}};
}

}  // namespace

double Percentile(const std::vector<double>& sorted, double percent) {
  // The small number undoes the rounding of float64: 99.9 % of 1000 values are 999.
  const double rank = std::ceil(percent / 100 * static_cast<double>(sorted.size()) - 1e-9);
  const auto index = static_cast<size_t>(std::max(rank, 1.0)) - 1;
  return sorted[std::min(index, sorted.size() - 1)];
}

void LoadReport::Summarize() {
  double num_bytes = 0;
  for (const std::vector<LoadSample>& samples : result.clients) {
    for (const LoadSample& sample : samples) {
      latency_ms.push_back(sample.latency_ms);
      queue_ms.push_back(sample.times.queue_us * 1e-3);
      evaluate_ms.push_back(sample.times.evaluate_us * 1e-3);
      encode_ms.push_back(sample.times.encode_us * 1e-3);
      num_bytes += static_cast<double>(sample.num_bytes);
    }
    achieved_fps.push_back(static_cast<double>(samples.size()) /
                           std::max(result.seconds, options.seconds));
  }
  for (std::vector<double>* values : {&latency_ms, &queue_ms, &evaluate_ms, &encode_ms}) {
    std::sort(values->begin(), values->end());
  }
  num_frames = static_cast<int>(latency_ms.size());
  bytes_per_frame = num_bytes / num_frames;
}

double LoadReport::frames_per_cpu_second() const { return num_frames / result.server_cpu_seconds; }
double LoadReport::draco_frames_per_cpu_second() const { return 1e3 / draco.encode_ms; }

nlohmann::ordered_json LoadReportJson(const LoadReport& report) {
  const LoadResult& result = report.result;
  const auto [lowest, highest] =
      std::minmax_element(report.achieved_fps.begin(), report.achieved_fps.end());
  return {
      {"schema", "pleat.bench/1"},
      {"model_id", report.model_id},
      {"num_vertices", report.num_vertices},
      {"encoding", report.encoding},
      {"content", StreamContentName(report.options.session.stream.content)},
      {"num_clients", report.options.num_clients},
      {"arrivals", ArrivalsName(report.options.arrivals)},
      {"rate_fps", report.options.rate_fps},
      {"seconds", result.seconds},
      {"max_in_flight", report.options.session.max_in_flight},
      {"latest_wins", report.options.session.latest_wins},
      {"num_poses", result.num_intended},
      {"num_sent", result.num_sent},
      {"num_frames", report.num_frames},
      {"num_superseded", result.num_superseded},
      {"num_rejected", result.num_rejected},
      {"num_resumed", result.num_resumed},
      {"achieved_fps",
       {{"lowest", *lowest}, {"mean", Mean(report.achieved_fps)}, {"highest", *highest}}},
      {"latency_ms", TimesJson(report.latency_ms)},
      {"server_ms",
       {{"queue", TimesJson(report.queue_ms)},
        {"evaluate", TimesJson(report.evaluate_ms)},
        {"encode", TimesJson(report.encode_ms)}}},
      {"bytes_per_frame", report.bytes_per_frame},
      {"server_cpu_seconds", result.server_cpu_seconds},
      {"frames_per_cpu_second", report.frames_per_cpu_second()},
      {"draco",
       {{"encode_ms", report.draco.encode_ms},
        {"frames_per_cpu_second", report.draco_frames_per_cpu_second()}}},
      {"share_of_draco", report.frames_per_cpu_second() / report.draco_frames_per_cpu_second()}};
}

void PrintLoadReport(const LoadReport& report, std::ostream& out) {
  const LoadResult& result = report.result;
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const std::string& name, const std::vector<double>& sorted) {
    std::vector<std::string> row{name};
    for (const double percent : {50.0, 90.0, 99.0, 99.9}) {
      row.push_back(absl::StrFormat("%.2f", Percentile(sorted, percent)));
    }
    row.push_back(absl::StrFormat("%.2f", sorted.back()));
    rows.push_back(std::move(row));
  };
  add("pose to frame", report.latency_ms);
  add("  waiting in the server", report.queue_ms);
  add("  evaluation", report.evaluate_ms);
  add("  encoding", report.encode_ms);
  const auto [lowest, highest] =
      std::minmax_element(report.achieved_fps.begin(), report.achieved_fps.end());
  out << absl::StrFormat("%d clients, %s arrivals, %s: %d of %d poses answered in %.1f s",
                         report.options.num_clients, ArrivalsName(report.options.arrivals),
                         ContentAndEncoding(report), report.num_frames, result.num_intended,
                         result.seconds);
  if (result.num_superseded > 0) out << ", " << result.num_superseded << " superseded";
  if (result.num_rejected > 0) out << ", " << result.num_rejected << " rejected";
  if (result.num_resumed > 0) out << ", " << result.num_resumed << " reconnections";
  out << "\n"
      << FormatTable({"milliseconds", "p50", "p90", "p99", "p99.9", "max"}, rows)
      << absl::StrFormat("frames per second and client %.1f to %.1f, %.1f kB per frame\n", *lowest,
                         *highest, report.bytes_per_frame / 1e3)
      << absl::StrFormat(
             "server %.2f s of processor time: %.0f frames per second and core; Draco's encoder "
             "alone %.0f (%.2f)\n",
             result.server_cpu_seconds, report.frames_per_cpu_second(),
             report.draco_frames_per_cpu_second(),
             report.frames_per_cpu_second() / report.draco_frames_per_cpu_second());
}

absl::StatusOr<std::string> PlotLoad(const LoadReport& report, const std::string& path) {
  std::vector<PlotSeries> series = {
      {"pose to frame", {}}, {"waiting in the server", {}}, {"evaluation", {}}, {"encoding", {}}};
  const std::vector<double>* parts[] = {&report.latency_ms, &report.queue_ms, &report.evaluate_ms,
                                        &report.encode_ms};
  for (int percent = 0; percent <= 100; ++percent) {
    for (size_t i = 0; i < series.size(); ++i) {
      series[i].values.push_back(Percentile(*parts[i], percent));
    }
  }
  return EncodeLinePlot(
      path, series,
      {.title = absl::StrFormat("%d clients, %s, %d vertices", report.options.num_clients,
                                ContentAndEncoding(report), report.num_vertices),
       .x_label = "percent of the frames",
       .y_label = "at most (ms)"});
}

}  // namespace pleat
