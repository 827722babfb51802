#include "model_routes.h"

#include <cmath>
#include <cstdlib>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "file_name.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/character/fit_motion.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/bvh.h"
#include "pleat/formats/glb_writer.h"
#include "pleat/formats/mdd.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/motion_file.h"
#include "pleat/formats/motion_reader.h"
#include "pleat/formats/npz.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/rig_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/usda_writer.h"
#include "rpc_routes.h"

namespace pleat {
namespace {

using ModelPointer = std::shared_ptr<const CharacterModel>;

absl::StatusOr<ModelPointer> LoadModel(const ModelRoutes& routes, const HttpRequest& request,
                                       const std::string& id) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(id, "model"));
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      DownloadFile(routes.gateway, CallerOf(request), "ModelService", "DownloadModel", id));
  return DecodeModel(bytes, routes.limits);
}

absl::StatusOr<HttpResponse> RigOf(const CharacterModel& model) {
  return JsonResponse(EncodeRig({.skeleton = model.skeleton(),
                                 .weights = model.rig().weights,
                                 .rest_frame = model.record().rest_frame,
                                 .locked_joints = {}}));
}

absl::StatusOr<Motion> MotionOfTake(const ModelRoutes& routes, const HttpRequest& request,
                                    const std::string& id, const CharacterModel& model) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(id, "sequence"));
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      DownloadFile(routes.gateway, CallerOf(request), "SequenceService", "DownloadSequence", id));
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, DecodeSequence(bytes, routes.limits));
  Motion motion;
  PLEAT_ASSIGN_OR_RETURN(motion.track, FitMotion(model, sequence));
  return motion;
}

absl::StatusOr<Motion> MotionOfUpload(const ModelRoutes& routes, const HttpRequest& request,
                                      const std::string& id, const CharacterModel& model) {
  PLEAT_ASSIGN_OR_RETURN(const UploadFolders::Folder folder,
                         routes.uploads->Find(CallerOf(request).token, id));
  PLEAT_ASSIGN_OR_RETURN(const std::string input, ChooseInput(folder.path));
  absl::StatusOr<Motion> motion =
      ReadMotion(input, model.skeleton(), {.limits = routes.limits, .frame_rate = {}});
  routes.uploads->Remove(CallerOf(request).token, id);
  return motion;
}

absl::StatusOr<HttpResponse> ReadOrFitMotion(const ModelRoutes& routes, const RequestTarget& target,
                                             const HttpRequest& request,
                                             const CharacterModel& model) {
  const auto upload = target.query.find("upload"), sequence = target.query.find("sequence");
  if (upload == target.query.end() && sequence == target.query.end()) {
    return absl::InvalidArgumentError("a motion comes of ?sequence=ID or of ?upload=ID");
  }
  PLEAT_ASSIGN_OR_RETURN(const Motion motion,
                         upload != target.query.end()
                             ? MotionOfUpload(routes, request, upload->second, model)
                             : MotionOfTake(routes, request, sequence->second, model));
  return JsonResponse(EncodeMotion(model.skeleton(), motion.track, motion.bone_scales));
}

std::vector<Eigen::Matrix3Xf> FramesOf(const MeshSequence& sequence) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  return frames;
}

struct ExportFormat {
  std::string name;
  absl::StatusOr<std::string> (*encode)(const MeshSequence& sequence);
};

const std::vector<ExportFormat>& Formats() {
  using Result = absl::StatusOr<std::string>;
  using Sequence = const MeshSequence&;
  static const std::vector<ExportFormat>& formats = *new std::vector<ExportFormat>{
      {"glb", [](Sequence sequence) { return EncodeGlb(sequence); }},
      {"abc", [](Sequence sequence) -> Result { return EncodeAlembic(sequence); }},
      {"usda", [](Sequence sequence) -> Result { return EncodeUsda(sequence); }},
      {"pc2",
       [](Sequence sequence) -> Result {
         return EncodePointCache({.start_frame = 0, .frames = FramesOf(sequence)});
       }},
      {"mdd",
       [](Sequence sequence) -> Result {
         MddCache cache{.times_s = {}, .frames = FramesOf(sequence)};
         for (int t = 0; t < sequence.num_frames(); ++t) {
           cache.times_s.push_back(static_cast<float>(t / sequence.frame_rate().fps()));
         }
         return EncodeMdd(cache);
       }},
      {"obj",
       [](Sequence sequence) -> Result {
         return EncodeObj(sequence.topology(), sequence.frame(0), sequence.appearance());
       }},
      {"npz", [](Sequence sequence) -> Result { return EncodeNpz(sequence); }},
      {"npy", [](Sequence sequence) -> Result { return EncodeNpy(sequence); }},
      {"pseq", [](Sequence sequence) -> Result { return EncodeSequence(sequence); }}};
  return formats;
}

// The rate of a motion as a fraction: that of the model where they agree, else in thousandths.
FrameRate RateOf(double fps, const FrameRate& of_model) {
  if (std::abs(fps - of_model.fps()) < 1e-3) return of_model;
  return {static_cast<int>(std::lround(1000 * fps)), 1000};
}

absl::StatusOr<MeshSequence> Evaluate(const ModelRoutes& routes, const HttpRequest& request,
                                      const std::string& id, const CharacterModel& model,
                                      const Motion& motion) {
  // The same permission as for a clip of frames; so are the quotas, which the service asks.
  PLEAT_ASSIGN_OR_RETURN(const AdmittedServices services,
                         routes.admit(CallerOf(request).token, "EvaluateClip"));
  // The frames, and beside them the file.
  const MeshCounts counts{model.num_vertices(), 0, motion.track.num_frames()};
  Reservation room;
  if (routes.memory != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(room, routes.memory->Reserve(3 * counts.position_bytes(), "an export"));
  }
  std::vector<Eigen::Matrix3Xf> frames;
  const ClipQuery query{.model_id = id,
                        .track = motion.track,
                        .bone_scales = motion.bone_scales,
                        .skinned_only = false};
  PLEAT_RETURN_IF_ERROR(
      services.poses->EvaluateClip(query, [&frames](int, const EvaluatedFrame& frame) {
        frames.push_back(frame.positions);
        return absl::OkStatus();
      }));
  return MeshSequence::Create(model.topology(), std::move(frames),
                              {.name = model.name(),
                               .frame_rate = RateOf(motion.track.fps(), model.frame_rate()),
                               .appearance = model.parts().appearance});
}

absl::StatusOr<HttpResponse> Export(const ModelRoutes& routes, const RequestTarget& target,
                                    const HttpRequest& request, const std::string& id,
                                    const CharacterModel& model) {
  PLEAT_ASSIGN_OR_RETURN(const Motion motion,
                         DecodeMotion(request.body, model.skeleton(), routes.limits));
  const auto asked = target.query.find("format");
  const std::string name = asked == target.query.end() ? "glb" : asked->second;
  HttpResponse response{.headers = {{"Content-Type", "application/octet-stream"}}};
  OfferAs(target, &response);
  if (name == "bvh") {
    response.body = EncodeBvh(ClipFromPoses(model.skeleton(), motion.track));
    return response;
  }
  for (const ExportFormat& format : Formats()) {
    if (format.name != name) continue;
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                           Evaluate(routes, request, id, model, motion));
    PLEAT_ASSIGN_OR_RETURN(response.body, format.encode(sequence));
    return response;
  }
  return absl::InvalidArgumentError(absl::StrCat("there is no format of this name; choose ",
                                                 absl::StrJoin(ExportFormats(), ", ")));
}

absl::StatusOr<HttpResponse> AnswerOrFail(const ModelRoutes& routes, const RequestTarget& target,
                                          const HttpRequest& request) {
  if (target.segments.size() != 4) {
    return absl::NotFoundError("there is nothing at this address");
  }
  const std::string& id = target.segments[2];
  const std::string& what = target.segments[3];
  if (what != "rig" && what != "motion" && what != "export") {
    return absl::NotFoundError("a model has a rig, a motion and an export");
  }
  PLEAT_ASSIGN_OR_RETURN(const ModelPointer model, LoadModel(routes, request, id));
  if (what == "rig") return RigOf(*model);
  if (what == "motion") return ReadOrFitMotion(routes, target, request, *model);
  return Export(routes, target, request, id, *model);
}

}  // namespace

const std::vector<std::string>& ExportFormats() {
  static const std::vector<std::string>& names = *[] {
    auto* list = new std::vector<std::string>;
    for (const ExportFormat& format : Formats()) list->push_back(format.name);
    list->push_back("bvh");
    return list;
  }();
  return names;
}

HttpResponse ModelRoutes::Answer(const RequestTarget& target, const HttpRequest& request) const {
  absl::StatusOr<HttpResponse> response = AnswerOrFail(*this, target, request);
  return response.ok() ? *std::move(response) : ErrorResponse(response.status());
}

}  // namespace pleat
