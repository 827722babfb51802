#include "model_routes.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "file_name.h"
#include "model_export.h"
#include "page_character.h"
#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/character/fit_motion.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/motion_file.h"
#include "pleat/formats/motion_reader.h"
#include "pleat/formats/rig_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/mesh/frame_rate.h"
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

absl::StatusOr<HttpResponse> PageOf(const ModelRoutes& routes, const CharacterModel& model) {
  Reservation room;
  if (routes.memory != nullptr) {
    // The planes, and beside them the answer.
    PLEAT_ASSIGN_OR_RETURN(
        room, routes.memory->Reserve(2 * PageCharacterBytes(model), "a character for a page"));
  }
  return HttpResponse{.headers = {{"Content-Type", "application/octet-stream"}},
                      .body = EncodePageCharacter(model)};
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
  return JsonResponse(EncodeMotionWithSkeleton(model.skeleton(), motion));
}

// Room for the frames, and beside them for the file.
absl::StatusOr<Reservation> ReserveFrames(const ModelRoutes& routes, const CharacterModel& model,
                                          const Motion& motion) {
  const MeshCounts counts{model.num_vertices(), 0, motion.track.num_frames()};
  if (routes.memory == nullptr) return Reservation();
  return routes.memory->Reserve(3 * counts.position_bytes(), "an export");
}

absl::StatusOr<MeshSequence> Evaluate(const ModelRoutes& routes, const HttpRequest& request,
                                      const std::string& id, const CharacterModel& model,
                                      const Motion& motion) {
  // The same permission as for a clip of frames; so are the quotas, which the service asks.
  PLEAT_ASSIGN_OR_RETURN(const AdmittedServices services,
                         routes.admit(CallerOf(request), "EvaluateClip"));
  PLEAT_ASSIGN_OR_RETURN(const Reservation room, ReserveFrames(routes, model, motion));
  std::vector<Eigen::Matrix3Xf> frames;
  const ClipQuery query{
      .model_id = id,
      .track = motion.track,
      .bone_scales = motion.bone_scales,
      .skinned_only = false,
      .strengths = {.joints = motion.detail_strengths, .vertices = motion.vertex_strengths}};
  PLEAT_RETURN_IF_ERROR(
      services.poses->EvaluateClip(query, [&frames](int, const EvaluatedFrame& frame) {
        frames.push_back(frame.positions);
        return absl::OkStatus();
      }));
  return MeshSequence::Create(model.topology(), std::move(frames),
                              {.name = model.name(),
                               .frame_rate = FrameRateFromFps(motion.track.fps()),
                               .appearance = model.parts().appearance});
}

absl::StatusOr<HttpResponse> Export(const ModelRoutes& routes, const RequestTarget& target,
                                    const HttpRequest& request, const std::string& id,
                                    const ModelPointer& model) {
  PLEAT_ASSIGN_OR_RETURN(const Motion motion,
                         DecodeMotion(request.body, model->skeleton(), routes.limits));
  const auto asked = target.query.find("format");
  const std::string name = asked == target.query.end() ? "glb" : asked->second;
  HttpResponse response{.headers = {{"Content-Type", "application/octet-stream"}}};
  OfferAs(target, &response);
  if (const EncodeFrames encode = FindFramesFormat(name); encode != nullptr) {
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                           Evaluate(routes, request, id, *model, motion));
    PLEAT_ASSIGN_OR_RETURN(response.body, encode(sequence));
    return response;
  }
  // Folds as morph targets are computed from the frames.
  PLEAT_RETURN_IF_ERROR(routes.admit(CallerOf(request), "EvaluateClip").status());
  PLEAT_ASSIGN_OR_RETURN(const Reservation room, ReserveFrames(routes, *model, motion));
  PLEAT_ASSIGN_OR_RETURN(response.body, EncodeCharacterAs(name, model, motion));
  return response;
}

absl::StatusOr<HttpResponse> AnswerOrFail(const ModelRoutes& routes, const RequestTarget& target,
                                          const HttpRequest& request) {
  if (target.segments.size() != 4) {
    return absl::NotFoundError("there is nothing at this address");
  }
  const std::string& id = target.segments[2];
  const std::string& what = target.segments[3];
  if (what != "rig" && what != "page" && what != "motion" && what != "export") {
    return absl::NotFoundError("a model has a rig, a page, a motion and an export");
  }
  PLEAT_ASSIGN_OR_RETURN(const ModelPointer model, LoadModel(routes, request, id));
  if (what == "rig") return RigOf(*model);
  if (what == "page") return PageOf(routes, *model);
  if (what == "motion") return ReadOrFitMotion(routes, target, request, *model);
  return Export(routes, target, request, id, model);
}

}  // namespace

HttpResponse ModelRoutes::Answer(const RequestTarget& target, const HttpRequest& request) const {
  absl::StatusOr<HttpResponse> response = AnswerOrFail(*this, target, request);
  return response.ok() ? *std::move(response) : ErrorResponse(response.status());
}

}  // namespace pleat
