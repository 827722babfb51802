// pose MODEL --motion FILE -o OUT: writes the character in other poses, evaluated here or on a
// server.
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/animation_writer.h"
#include "cli/io/draco_folder.h"
#include "cli/io/model_input.h"
#include "cli/io/motion_edit.h"
#include "cli/io/output_path.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/verbs/content_flag.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/motion_reader.h"
#include "pleat/mesh/frame_rate.h"
#include "pleat/stream/frame_encoder.h"

namespace pleat {
namespace {

struct PoseVerbOptions {
  std::string model, motion, output, format = "auto", encoding = "mesh";
  StreamContent content = StreamContent::kMesh;
  int position_bits = FrameEncoderOptions().position_bits;
  std::vector<std::string> bone_scales;
  bool skinned_only = false;
};

// How near the motion is to what training has seen: the mean and the lowest confidence.
struct Confidence {
  double sum = 0, lowest = 1;
  int num_frames = 0, lowest_frame = 0;

  void Add(int t, double confidence) {
    sum += confidence;
    ++num_frames;
    if (confidence < lowest) {
      lowest = confidence;
      lowest_frame = t;
    }
  }
  double mean() const { return num_frames == 0 ? 0 : sum / num_frames; }
};

FrameEncoderOptions EncoderOptions(const PoseVerbOptions& options) {
  FrameEncoderOptions encoder;
  encoder.encoding =
      options.encoding == "mesh" ? FrameEncoding::kDracoMesh : FrameEncoding::kDracoPointCloud;
  encoder.content = options.content;
  encoder.position_bits = options.position_bits;
  return encoder;
}

absl::StatusOr<ClipQuery> ReadQuery(const PoseVerbOptions& options, const Skeleton& skeleton,
                                    const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(Motion motion, ReadMotion(options.motion, skeleton));
  for (const std::string& warning : motion.warnings) {
    *session.err << "warning: " << warning << "\n";
  }
  PLEAT_ASSIGN_OR_RETURN(std::vector<double> scales,
                         ParseJointFactors(JointNames(skeleton), options.bone_scales));
  ClipQuery query;
  query.track = std::move(motion.track);
  query.strengths = {std::move(motion.detail_strengths), std::move(motion.vertex_strengths)};
  query.bone_scales = scales.empty() ? std::move(motion.bone_scales) : std::move(scales);
  query.skinned_only = options.skinned_only;
  return query;
}

using ConsumeFrame = std::function<absl::Status(int t, const EvaluatedFrame& frame)>;

absl::Status EvaluateHere(std::shared_ptr<const CharacterModel> model, const ClipQuery& query,
                          const ConsumeFrame& consume) {
  PoseEvaluator evaluator(std::move(model));
  PLEAT_RETURN_IF_ERROR(evaluator.SetDetailStrengths(query.strengths));
  return query.skinned_only ? evaluator.EvaluateSkinnedClip(query.track, query.bone_scales, consume)
                            : evaluator.EvaluateClip(query.track, query.bone_scales, consume);
}

void PrintSummary(const PoseVerbOptions& options, const Confidence& confidence, int num_vertices,
                  double seconds, const Session& session) {
  if (session.json) {
    const nlohmann::ordered_json json = {{"schema", "pleat.pose/1"},
                                         {"output", options.output},
                                         {"num_frames", confidence.num_frames},
                                         {"num_vertices", num_vertices},
                                         {"confidence",
                                          {{"mean", confidence.mean()},
                                           {"lowest", confidence.lowest},
                                           {"lowest_frame", confidence.lowest_frame}}},
                                         {"seconds", seconds}};
    *session.out << JsonText(json);
  } else {
    *session.out << absl::StrFormat("%s: %d frames of %d vertices in %.2f s", options.output,
                                    confidence.num_frames, num_vertices, seconds);
    if (!options.skinned_only) {
      *session.out << absl::StrFormat("; confidence %.2f, lowest %.2f in frame %d",
                                      confidence.mean(), confidence.lowest,
                                      confidence.lowest_frame);
    }
    *session.out << "\n";
  }
}

// Writes the frames of `query` with an AnimationWriter, wherever `evaluate` takes them from.
absl::Status WriteFrames(const PoseVerbOptions& options, AnimationFormat format,
                         const CharacterModel& model, const ClipQuery& query,
                         const std::function<absl::Status(const ConsumeFrame&)>& evaluate,
                         const Progress& progress, Confidence* confidence) {
  AnimationOptions animation;
  animation.frame_rate = FrameRateFromFps(query.track.fps());
  animation.appearance = model.parts().appearance;
  animation.name = model.name();
  animation.encoder = EncoderOptions(options);
  animation.reference = model.rig().rest_positions.cast<float>();
  const std::unique_ptr<AnimationWriter> writer =
      MakeAnimationWriter(format, options.output, model.topology(), std::move(animation));
  PLEAT_RETURN_IF_ERROR(evaluate([&](int t, const EvaluatedFrame& frame) {
    confidence->Add(t, frame.confidence);
    PLEAT_RETURN_IF_ERROR(writer->AddFrame(frame.positions));
    return progress.Report((t + 1.0) / query.track.num_frames());
  }));
  return writer->Finish();
}

// Writes the server's Draco bytes as they come and returns the number of their vertices.
absl::StatusOr<int> WriteStream(const PoseVerbOptions& options, PoseService& poses,
                                const ClipQuery& query, const Progress& progress,
                                Confidence* confidence) {
  DracoFolderWriter writer(options.output, FrameRateFromFps(query.track.fps()));
  StreamHeader header;
  ClipStreamSink sink;
  sink.on_header = [&](const StreamHeader& received) {
    header = received;
    return absl::OkStatus();
  };
  sink.on_frame = [&](int t, std::string_view draco, const FrameMark&, double frame_confidence) {
    confidence->Add(t, frame_confidence);
    PLEAT_RETURN_IF_ERROR(writer.AddFrame(draco));
    return progress.Report((t + 1.0) / query.track.num_frames());
  };
  PLEAT_RETURN_IF_ERROR(StreamClip(poses, query, EncoderOptions(options), sink));
  PLEAT_RETURN_IF_ERROR(writer.Finish(header));
  return header.num_vertices;
}

// Takes poses and coefficients from the server and shows them with the model here.
absl::Status EvaluateByParameters(PoseService& poses, std::shared_ptr<const CharacterModel> model,
                                  const ClipQuery& query, const ConsumeFrame& consume) {
  PoseEvaluator evaluator(std::move(model));
  PLEAT_RETURN_IF_ERROR(evaluator.SetDetailStrengths(query.strengths));
  EvaluatedFrame frame;
  ClipStreamSink sink;
  sink.on_parameters = [&](int t, const FrameParameters& parameters) -> absl::Status {
    PLEAT_RETURN_IF_ERROR(evaluator.Show(parameters, query.bone_scales, &frame));
    return consume(t, frame);
  };
  return StreamClip(poses, query, {.content = StreamContent::kParameters}, sink);
}

// Checks that `content` can be had: only a server sends less than the mesh, and not every format
// can hold it.
absl::Status CheckContent(StreamContent content, AnimationFormat format, bool from_server) {
  if (content == StreamContent::kMesh) return absl::OkStatus();
  if (!from_server) {
    return UsageError("--content is about frames from a server; this model is evaluated here");
  }
  const bool is_draco = format == AnimationFormat::kDraco;
  if (content == StreamContent::kControlMesh && !is_draco) {
    return UsageError("--content control is a stream of another mesh: write it with --format drc");
  }
  if (content == StreamContent::kParameters && is_draco) {
    return UsageError(
        "--content parameters has no Draco frames: choose pc2, abc, pseq, obj or ply");
  }
  return absl::OkStatus();
}

// Evaluates a model file here and returns the number of vertices of what was written.
absl::StatusOr<int> PoseFromFile(const PoseVerbOptions& options, AnimationFormat format,
                                 const Session& session, const Progress& progress,
                                 Confidence* confidence) {
  PLEAT_RETURN_IF_ERROR(CheckContent(options.content, format, false));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                         ReadModelFile(options.model));
  PLEAT_ASSIGN_OR_RETURN(const ClipQuery query, ReadQuery(options, model->skeleton(), session));
  PLEAT_RETURN_IF_ERROR(WriteFrames(
      options, format, *model, query,
      [&](const ConsumeFrame& consume) { return EvaluateHere(model, query, consume); }, progress,
      confidence));
  return model->num_vertices();
}

// Does the same for a model that a service keeps, which is evaluated there.
absl::StatusOr<int> PoseFromService(const PoseVerbOptions& options, AnimationFormat format,
                                    const Session& session, const Progress& progress,
                                    Confidence* confidence) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::string id, FindModel(service->models(), options.model));
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, service->models().Get(id));
  PLEAT_ASSIGN_OR_RETURN(ClipQuery query, ReadQuery(options, info.skeleton, session));
  query.model_id = id;
  PLEAT_RETURN_IF_ERROR(CheckContent(options.content, format, !session.local));
  if (!session.local && format == AnimationFormat::kDraco) {
    return WriteStream(options, service->poses(), query, progress, confidence);
  }
  // A stream has neither polygons nor texture coordinates, so they are taken from the model.
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, service->models().Download(id, {}));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model, DecodeModel(bytes));
  PLEAT_RETURN_IF_ERROR(WriteFrames(
      options, format, *model, query,
      [&](const ConsumeFrame& consume) {
        return options.content == StreamContent::kParameters
                   ? EvaluateByParameters(service->poses(), model, query, consume)
                   : service->poses().EvaluateClip(query, consume);
      },
      progress, confidence));
  return info.num_vertices;
}

absl::Status RunPose(const PoseVerbOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const AnimationFormat format,
                         ChooseAnimationFormat(options.format, options.output));
  PLEAT_RETURN_IF_ERROR(CheckAnimationOutput(session, options.output, format, options.format));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const Progress progress = InterruptibleProgress(&display).Stage("pose", 0, 1);
  const double start_seconds = MonotonicSeconds();
  Confidence confidence;
  const auto run = IsModelFile(options.model) ? PoseFromFile : PoseFromService;
  PLEAT_ASSIGN_OR_RETURN(const int num_vertices,
                         run(options, format, session, progress, &confidence));
  display.Finish();
  PrintSummary(options, confidence, num_vertices, MonotonicSeconds() - start_seconds, session);
  return absl::OkStatus();
}

}  // namespace

void AddPoseVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<PoseVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "pose", "show a character in the poses of a motion",
                           [options, &session] { return RunPose(*options, session); });
  verb->add_option("MODEL", options->model, "a .pleat file, or the id of a model on the server")
      ->required();
  verb->add_option("--motion", options->motion, "motion (.json, .bvh, or .glb with the joints)")
      ->required();
  verb->add_option("-o,--output", options->output, "OUT.ENDING (see --format) or a folder")
      ->required();
  verb->add_option("--format", options->format, FormatFlagHelp("drc"))->capture_default_str();
  verb->add_option("--encoding", options->encoding,
                   "of drc: mesh (every frame can be read alone) or points (smaller)")
      ->check(CLI::IsMember({"mesh", "points"}))
      ->capture_default_str();
  verb->add_option("--bits", options->position_bits, "of drc: bits per coordinate of the grid")
      ->check(CLI::Range(QuantizationBox::kMinBits, QuantizationBox::kMaxBits))
      ->capture_default_str();
  AddContentFlag(verb, &options->content);
  verb->add_option("--bone-scale", options->bone_scales,
                   "JOINT=FACTOR: length of the bone that ends in JOINT; wins over the motion's");
  verb->add_flag("--skinned-only", options->skinned_only, "without the learned detail");
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

}  // namespace pleat
