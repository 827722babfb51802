// bench MODEL: puts load on a server by many live sessions and measures what their frames cost.
#include <time.h>

#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/exit_code.h"
#include "cli/interrupt.h"
#include "cli/io/model_input.h"
#include "cli/io/output_path.h"
#include "cli/load/load_report.h"
#include "cli/load/load_run.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/verbs/content_flag.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {
namespace {

constexpr int kSwayFrames = 60;        // the length of the motion that is made up
constexpr size_t kDracoFrames = 60;    // the frames that Draco's own encoder is measured on
constexpr double kDracoSeconds = 0.7;  // the processor time for that

struct BenchVerbOptions {
  std::string model, motion, fps, encoding = "delta", arrivals = "fixed", report, plot;
  bool closed_loop = false;
  LoadOptions load;
};

const std::map<std::string, FrameEncoding>& Encodings() {
  static const std::map<std::string, FrameEncoding> encodings = {
      {"mesh", FrameEncoding::kDracoMesh},
      {"points", FrameEncoding::kDracoPointCloud},
      {"delta", FrameEncoding::kDracoDelta}};
  return encodings;
}

// Makes a motion in which every joint sways a little, each in its own time.
std::vector<Pose> Sway(const Skeleton& skeleton) {
  std::vector<Pose> poses;
  for (int t = 0; t < kSwayFrames; ++t) {
    Pose pose = Pose::Rest(skeleton);
    for (size_t j = 1; j < pose.rotations.size(); ++j) {
      const double angle = .2 * std::sin(.1 * t * (1 + .1 * static_cast<double>(j % 7)));
      pose.rotations[j] = Eigen::AngleAxisd(
          angle,
          Eigen::Vector3d(std::cos(static_cast<double>(j)), std::sin(static_cast<double>(j)), .3)
              .normalized());
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Returns frames of `poses` as a client sees them.
absl::StatusOr<std::vector<Eigen::Matrix3Xf>> SomeFrames(RemotePoses& remote,
                                                         const ClipQuery& character,
                                                         const std::vector<Pose>& poses,
                                                         FrameEncoderOptions stream,
                                                         Topology* topology) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<LiveSession> session,
                         remote.OpenLiveSession(character, {.stream = stream}));
  *topology = session->decoder().topology();
  std::vector<Eigen::Matrix3Xf> frames;
  LiveFrame frame;
  for (size_t t = 0; t < std::min(poses.size(), kDracoFrames); ++t) {
    PLEAT_RETURN_IF_ERROR(session->Send(t, poses[t]));
    PLEAT_RETURN_IF_ERROR(session->Receive(&frame));
    frames.push_back(frame.positions);
  }
  return frames;
}

// Measures Draco's own encoder on point clouds in a good order, the fastest form that it offers for
// such frames.
absl::StatusOr<DracoSpeed> MeasureDraco(const std::vector<Eigen::Matrix3Xf>& frames,
                                        const Topology& topology, FrameEncoderOptions stream) {
  stream.encoding = FrameEncoding::kDracoPointCloud;
  PLEAT_ASSIGN_OR_RETURN(FrameEncoder encoder,
                         FrameEncoder::Create(topology, frames.front(), stream));
  DracoSpeed speed;
  const double start = ThreadSeconds();
  while (ThreadSeconds() - start < kDracoSeconds) {
    for (const Eigen::Matrix3Xf& frame : frames) {
      PLEAT_RETURN_IF_ERROR(encoder.Encode(frame).status());
      ++speed.num_frames;
    }
  }
  speed.encode_ms = 1e3 * (ThreadSeconds() - start) / speed.num_frames;
  return speed;
}

absl::StatusOr<LoadReport> Measure(const BenchVerbOptions& options, const Session& session) {
  LoadReport report;
  report.options = options.load;
  report.options.session.stream.encoding = Encodings().at(options.encoding);
  report.options.session.decode = false;
  if (options.arrivals == "poisson") report.options.arrivals = Arrivals::kPoisson;
  if (options.closed_loop) report.options.arrivals = Arrivals::kClosed;
  report.encoding = options.encoding;

  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<RemoteCharacterService> service,
                         OpenRemoteService(session, "bench"));
  PLEAT_ASSIGN_OR_RETURN(report.model_id, FindModel(service->models(), options.model));
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, service->models().Get(report.model_id));
  report.num_vertices = info.num_vertices;
  ClipQuery character;
  character.model_id = report.model_id;
  std::vector<Pose> poses;
  if (options.motion.empty()) {
    poses = Sway(info.skeleton);
  } else {
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                           LoadModel(session, report.model_id));
    PLEAT_ASSIGN_OR_RETURN(Motion motion, LoadMotion(options.motion, options.fps, *model, session));
    character.bone_scales = std::move(motion.bone_scales);
    character.strengths = {std::move(motion.detail_strengths), std::move(motion.vertex_strengths)};
    poses = std::move(motion.track).Take().poses;
  }
  if (poses.empty()) return absl::InvalidArgumentError("the motion has no frames");

  InstallInterruptHandler();
  // Draco's encoder is measured on whole meshes, whatever the sessions ask for.
  FrameEncoderOptions stream = report.options.session.stream;
  stream.content = StreamContent::kMesh;
  Topology topology;
  PLEAT_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3Xf> frames,
                         SomeFrames(service->poses(), character, poses, stream, &topology));
  PLEAT_ASSIGN_OR_RETURN(report.draco, MeasureDraco(frames, topology, stream));
  if (session.talkative()) {
    *session.err << "sending poses from " << options.load.num_clients << " clients for "
                 << options.load.seconds << " s\n"
                 << std::flush;
  }
  PLEAT_ASSIGN_OR_RETURN(report.result,
                         RunLoad(service->poses(), character, poses, report.options, Interrupted));
  report.Summarize();
  return report;
}

absl::Status RunBench(const BenchVerbOptions& options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"--report", options.report, {".json"}},
                                                   {"--plot", options.plot, {".png", ".svg"}}}));
  PLEAT_ASSIGN_OR_RETURN(const LoadReport report, Measure(options, session));
  const nlohmann::ordered_json json = LoadReportJson(report);
  if (!options.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(options.report, JsonText(json)));
  }
  if (!options.plot.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const std::string plot, PlotLoad(report, options.plot));
    PLEAT_RETURN_IF_ERROR(WriteFile(options.plot, plot));
  }
  if (session.json) {
    *session.out << JsonText(json);
  } else {
    PrintLoadReport(report, *session.out);
  }
  return absl::OkStatus();
}

void AddLoadFlags(CLI::App* verb, LoadOptions* load) {
  verb->add_option("--clients", load->num_clients, "live sessions at the same time")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--rate", load->rate_fps, "poses per second of each client")
      ->check(CLI::Range(.1, 10'000.0))
      ->capture_default_str();
  verb->add_option("--seconds", load->seconds, "how long")
      ->check(CLI::Range(.1, 3600.0))
      ->capture_default_str();
  verb->add_option("--seed", load->seed, "of --arrivals poisson")->capture_default_str();
  verb->add_option("--max-in-flight", load->session.max_in_flight,
                   "poses of a client that may be under way")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  verb->add_flag("--latest-wins", load->session.latest_wins, "newer poses replace waiting ones");
  verb->add_option("--bits", load->session.stream.position_bits,
                   "bits per coordinate of the stream's grid")
      ->check(CLI::Range(QuantizationBox::kMinBits, QuantizationBox::kMaxBits))
      ->capture_default_str();
}

}  // namespace

void AddBenchVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<BenchVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "bench", "load a server and measure its live sessions",
                           [options, &session] { return RunBench(*options, session); });
  verb->add_option("MODEL", options->model, "the id of a model on the server")->required();
  verb->add_option("--motion", options->motion,
                   "poses: a motion (.json), or a mesh sequence of the model's connectivity "
                   "[every joint sways]");
  verb->add_option("--fps", options->fps, "frames per second, where a sequence does not say");
  AddObjectFlag(verb, session);
  AddLoadFlags(verb, &options->load);
  AddContentFlag(verb, &options->load.session.stream.content);
  verb->add_option("--encoding", options->encoding, "mesh, points or delta")
      ->check(CLI::IsMember({"mesh", "points", "delta"}))
      ->capture_default_str();
  CLI::Option* arrivals =
      verb->add_option("--arrivals", options->arrivals,
                       "fixed (equal distances) or poisson; poses are sent in time, not when the "
                       "server is ready for them, and latency counts from that time")
          ->check(CLI::IsMember({"fixed", "poisson"}))
          ->capture_default_str();
  verb->add_flag("--closed-loop", options->closed_loop,
                 "the next pose when the last frame is there: finds the throughput")
      ->excludes(arrivals);
  verb->add_option("--report", options->report, "JSON report (pleat.bench/1)");
  verb->add_option("--plot", options->plot,
                   ".png or .svg: percentiles of the latency and its parts");
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

}  // namespace pleat
