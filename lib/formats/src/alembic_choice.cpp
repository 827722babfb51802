#include "alembic_choice.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr size_t kMaxListedPaths = 8;  // paths in a message

class Chooser {
 public:
  Chooser(const std::string& object, const MeshLimits& limits, AlembicArchive* archive,
          std::vector<InputNote>* notes)
      : object_(object), limits_(limits), archive_(*archive), notes_(*notes) {}

  absl::StatusOr<AlembicChoice> Choose() {
    PLEAT_RETURN_IF_ERROR(FindMeshes());
    PLEAT_RETURN_IF_ERROR(CheckAny());
    LeaveOutWhatStandsStill();
    PLEAT_RETURN_IF_ERROR(ChooseTimes());
    return std::move(choice_);
  }

 private:
  // Reads the meshes that the path names, with the transforms above them.
  absl::Status FindMeshes() {
    const int num_objects = static_cast<int>(archive_.objects().size());
    // Parents come first, so what is above an object was seen before it.
    std::vector<int> xform_of(static_cast<size_t>(num_objects), -1);
    std::vector<bool> is_named(static_cast<size_t>(num_objects));
    for (int i = 0; i < num_objects; ++i) {
      const int parent = archive_.objects()[i].parent;
      if (parent >= 0) xform_of[i] = xform_of[parent];
      is_named[i] =
          object_.empty() || (parent >= 0 && is_named[parent]) || archive_.HasPath(i, object_);
      object_found_ = object_found_ || is_named[i];
      if (!MetadataValue(archive_.objects()[i].metadata, "isInstance").empty()) {
        if (is_named[i]) ++num_instances_;
      } else if (archive_.schema(i) == kXformSchema) {
        PLEAT_RETURN_IF_ERROR(About(i, AddXform(i, xform_of[i])));
        xform_of[i] = static_cast<int>(choice_.xforms.size()) - 1;
      } else if (IsAlembicMesh(archive_, i)) {
        all_meshes_.push_back(i);
        if (is_named[i]) PLEAT_RETURN_IF_ERROR(About(i, AddMesh(i, xform_of[i])));
      }
    }
    return absl::OkStatus();
  }

  absl::Status About(int object, absl::Status status) const {
    if (status.ok()) return status;
    return WithContext(absl::StrCat("'", archive_.Path(object), "'"), std::move(status));
  }

  absl::Status AddXform(int object, int parent) {
    PlacedXform placed;
    PLEAT_ASSIGN_OR_RETURN(placed.xform, AlembicXform::Read(object, limits_.max_frames, &archive_));
    placed.parent = parent;
    const int self = static_cast<int>(choice_.xforms.size());
    if (placed.xform.changes()) placed.most_samples = self;
    if (parent >= 0 && placed.xform.may_inherit()) {
      const int above = choice_.xforms[parent].most_samples;
      if (above >= 0 &&
          (placed.most_samples < 0 ||
           choice_.xforms[above].xform.times().num_samples > placed.xform.times().num_samples)) {
        placed.most_samples = above;
      }
    }
    placed.moves = placed.most_samples >= 0;
    choice_.xforms.push_back(std::move(placed));
    return absl::OkStatus();
  }

  // A mesh without content is left out; only damage is an error.
  absl::Status AddMesh(int object, int xform) {
    PlacedMesh placed;
    placed.xform = xform;
    absl::StatusOr<AlembicMesh> mesh = ReadAlembicMesh(object, &archive_);
    absl::Status status = mesh.status();
    if (status.ok()) {
      placed.mesh = *std::move(mesh);
      const absl::StatusOr<int> count = CountVertices(placed.mesh, limits_, &archive_);
      if (count.ok()) placed.num_vertices = *count;
      status = count.status();
    }
    if (absl::IsInvalidArgument(status)) {
      if (first_unreadable_.ok()) first_unreadable_ = About(object, status);
      left_out_.push_back(object);
      return absl::OkStatus();
    }
    PLEAT_RETURN_IF_ERROR(status);
    PLEAT_RETURN_IF_ERROR(AddTimes(&placed));
    choice_.meshes.push_back(std::move(placed));
    return absl::OkStatus();
  }

  absl::Status AddTimes(PlacedMesh* placed) {
    const bool is_moved = placed->xform >= 0 && choice_.xforms[placed->xform].moves;
    placed->moves = placed->deforms() || is_moved;
    if (!placed->deforms() && is_moved) {
      placed->times = choice_.xforms[choice_.xforms[placed->xform].most_samples].xform.times();
      return absl::OkStatus();
    }
    const uint32_t num_samples = placed->mesh.num_samples();
    if (num_samples > limits_.max_frames) {
      return absl::ResourceExhaustedError(absl::StrCat(num_samples, " samples are over the limit ",
                                                       "of ", limits_.max_frames, " frames"));
    }
    AlembicTimes& times = placed->times;
    times.num_samples = static_cast<int>(num_samples);
    times.number = placed->mesh.positions.time_sampling;
    PLEAT_ASSIGN_OR_RETURN(times.sampling, archive_.TimeSampling(times.number));
    if (!placed->moves && times.sampling->is_acyclic()) {
      times.num_samples =
          std::min(times.num_samples, static_cast<int>(times.sampling->times.size()));
    }
    return CheckTimes(times);
  }

  std::string Paths(const std::vector<int>& objects) const {
    std::vector<std::string> paths;
    for (size_t i = 0; i < std::min(objects.size(), kMaxListedPaths); ++i) {
      paths.push_back(archive_.Path(objects[i]));
    }
    const size_t more = objects.size() - paths.size();
    return absl::StrCat(absl::StrJoin(paths, ", "),
                        more > 0 ? absl::StrCat(" and ", more, " more") : "");
  }

  absl::Status CheckAny() const {
    if (!choice_.meshes.empty()) return absl::OkStatus();
    if (!first_unreadable_.ok()) return first_unreadable_;
    if (all_meshes_.empty()) {
      std::set<std::string> schemas;
      for (size_t i = 1; i < archive_.objects().size(); ++i) {
        schemas.insert(EscapeControls(archive_.schema(static_cast<int>(i))));
        if (schemas.size() == kMaxListedPaths) break;
      }
      return absl::NotFoundError(absl::StrCat("the archive holds no mesh; its ",
                                              archive_.objects().size() - 1,
                                              " objects are of: ", absl::StrJoin(schemas, ", ")));
    }
    const std::string meshes = Paths(all_meshes_);
    if (object_found_) {
      return absl::NotFoundError(absl::StrCat("no mesh is at or below the object '", object_,
                                              "'; the meshes are: ", meshes));
    }
    return absl::NotFoundError(
        absl::StrCat("there is no object '", object_, "'; the meshes are: ", meshes));
  }

  void LeaveOutWhatStandsStill() {
    const bool any_moves = std::ranges::any_of(choice_.meshes, &PlacedMesh::moves);
    if (object_.empty() && any_moves) {
      std::vector<PlacedMesh> moving;
      for (PlacedMesh& placed : choice_.meshes) {
        if (placed.moves) {
          moving.push_back(std::move(placed));
        } else {
          left_out_.push_back(placed.mesh.object);
        }
      }
      choice_.meshes = std::move(moving);
    }
    if (!left_out_.empty()) {
      std::ranges::sort(left_out_);
      notes_.push_back({.kind = "objects_left_out",
                        .text = absl::StrCat(
                            "meshes that do not move, or hold nothing that is read, are left out: ",
                            Paths(left_out_), "; --object names what is read"),
                        .refused_when_strict = true});
    }
    if (num_instances_ > 0) {
      notes_.push_back(
          {.kind = "instances_left_out",
           .text = absl::StrCat("objects that only repeat others are left out: ", num_instances_)});
    }
  }

  // Those of the first mesh that moves, else those of the mesh with the most samples. All meshes
  // that move must have them.
  absl::Status ChooseTimes() {
    const PlacedMesh* leader = &choice_.meshes[0];
    for (const PlacedMesh& placed : choice_.meshes) {
      if (leader->moves) break;
      if (placed.moves || placed.times.num_samples > leader->times.num_samples) {
        leader = &placed;
      }
    }
    for (const PlacedMesh& placed : choice_.meshes) {
      if (!placed.moves || AreSameTimes(placed.times, leader->times)) continue;
      const auto describe = [this](const PlacedMesh& mesh) {
        return absl::StrCat(archive_.Path(mesh.mesh.object), " (", mesh.times.num_samples,
                            " samples from ", mesh.times.TimeOf(0), " to ",
                            mesh.times.TimeOf(mesh.times.num_samples - 1), " s)");
      };
      return absl::InvalidArgumentError(
          absl::StrCat("meshes move at different times: ", describe(*leader), " and ",
                       describe(placed), "; name one with --object"));
    }
    choice_.times = leader->times;
    return absl::OkStatus();
  }

  const std::string& object_;
  const MeshLimits& limits_;
  AlembicArchive& archive_;
  std::vector<InputNote>& notes_;
  AlembicChoice choice_;
  bool object_found_ = false;
  absl::Status first_unreadable_;
  std::vector<int> all_meshes_, left_out_;
  int num_instances_ = 0;
};

}  // namespace

absl::StatusOr<AlembicChoice> ChooseAlembicMeshes(const std::string& object,
                                                  const MeshLimits& limits, AlembicArchive* archive,
                                                  std::vector<InputNote>* notes) {
  return Chooser(object, limits, archive, notes).Choose();
}

}  // namespace pleat
