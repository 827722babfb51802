#include "pleat/performer/performer.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "body_mesh.h"
#include "character_shape.h"
#include "performer_motion.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "skirt_dynamics.h"

namespace pleat {
namespace {

constexpr double kGravity = 9.81;                 // m/s^2
constexpr int64_t kMaxValues = int64_t{1} << 32;  // floats of a sequence: 16 GiB

absl::Status CheckRange(absl::string_view name, double value, double low, double high) {
  if (value >= low && value <= high) return absl::OkStatus();  // false for NaN
  return absl::InvalidArgumentError(
      absl::StrCat("performer: ", name, " is ", value, ", must be ", low, " to ", high));
}

absl::Status Validate(const PerformerOptions& options) {
  PLEAT_RETURN_IF_ERROR(CheckRange("num_frames", options.num_frames, 1, 100000));
  PLEAT_RETURN_IF_ERROR(CheckRange("num_vertices", options.num_vertices, 500, 100000));
  PLEAT_RETURN_IF_ERROR(CheckRange("height_m", options.height_m, .1, 10));
  PLEAT_RETURN_IF_ERROR(CheckRange("yaw_degrees", options.yaw_degrees, -360, 360));
  if (options.frame_rate.denominator <= 0) {
    return absl::InvalidArgumentError("performer: frame_rate has a denominator of 0 or less");
  }
  PLEAT_RETURN_IF_ERROR(CheckRange("frame_rate", options.frame_rate.fps(), 5, 240));
  if (int64_t{3} * options.num_frames * options.num_vertices > kMaxValues) {
    return absl::InvalidArgumentError(
        absl::StrCat("performer: ", options.num_frames, " frames of ", options.num_vertices,
                     " vertices need more than 16 GiB; ask for fewer"));
  }
  return absl::OkStatus();
}

// The stage turns what is made in body heights, facing +z, into meters and the wanted facing.
struct Stage {
  double height_m;
  Eigen::Quaterniond facing;

  Eigen::Vector3d Place(const Eigen::Vector3d& p) const { return height_m * (facing * p); }
  // Turns a rotation in the axes of the unturned character into those of the turned one.
  Eigen::Quaterniond Turn(const Eigen::Quaterniond& q) const {
    return (facing * q * facing.conjugate()).normalized();
  }
};

Skeleton PlaceSkeleton(const Stage& stage, const Skeleton& skeleton) {
  Eigen::Matrix3Xd joints = skeleton.RestPositions();
  for (int j = 0; j < joints.cols(); ++j) {
    joints.col(j) = stage.Place(joints.col(j));
  }
  return skeleton.WithRestPositions(joints);
}

PoseTrack PlaceTrack(const Stage& stage, const Skeleton& placed_skeleton, PoseTrack track) {
  PoseTrack::Parts placed = std::move(track).Take();
  for (Pose& pose : placed.poses) {
    pose.root_position = stage.Place(pose.root_position);
    for (Eigen::Quaterniond& q : pose.rotations) q = stage.Turn(q);
  }
  placed.poses[0] = Pose::Rest(placed_skeleton);
  return PoseTrack::FromValid(std::move(placed));
}

// The detail of the skirt at the mesh's vertices: which share of which particles' displacements
// each vertex takes.
class SkirtDetail {
 public:
  SkirtDetail(const CharacterShape& shape, const SkirtDynamics& dynamics,
              const TriangleSoup& mesh) {
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const double share = shape.SkirtShare(mesh.positions[v]);
      if (share <= 0) continue;
      vertices_.push_back(static_cast<int>(v));
      shares_.push_back(share);
      samples_.push_back(dynamics.Locate(mesh.positions[v]));
    }
  }
  const std::vector<int>& vertices() const { return vertices_; }

  // Adds the skirt's displacements. grid: 3 x P, body heights, unturned world axes. positions: 3 x
  // V, meters.
  void Add(const Eigen::Matrix3Xf& grid, const Stage& stage, Eigen::Matrix3Xd* positions) const {
    for (size_t i = 0; i < vertices_.size(); ++i) {
      Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
      for (size_t k = 0; k < samples_[i].ids.size(); ++k) {
        displacement +=
            samples_[i].weights[k] * grid.col(samples_[i].ids[k]).template cast<double>();
      }
      positions->col(vertices_[i]) += shares_[i] * stage.Place(displacement);
    }
  }

 private:
  std::vector<int> vertices_;
  std::vector<double> shares_;
  std::vector<SkirtSample> samples_;
};

absl::StatusOr<std::vector<Eigen::Matrix3Xf>> ComputeFrames(
    const PerformerTruth& truth, const std::vector<Eigen::Matrix3Xf>& grids,
    const SkirtDetail& detail, const Stage& stage, const Progress& progress) {
  const int num_frames = truth.track.num_frames();
  std::vector<Eigen::Matrix3Xf> frames(num_frames);
  frames[0] = truth.rig.rest_positions.cast<float>();
  ParallelFor(num_frames - 1, 0, [&](int item) {
    if (progress.cancelled()) return;
    const int t = item + 1;
    BoneTransforms bones;
    ComputeBoneTransforms(truth.rig.skeleton, truth.track.pose(t), {}, &bones);
    Eigen::Matrix3Xd positions;
    SkinVertices(truth.rig.weights, truth.rig.rest_positions, bones, &positions);
    detail.Add(grids[t], stage, &positions);
    frames[t] = positions.cast<float>();
  });
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return frames;
}

}  // namespace

absl::StatusOr<Performer> GeneratePerformer(const PerformerOptions& options,
                                            const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(Validate(options));
  const CharacterShape shape(options.character_seed);
  PLEAT_ASSIGN_OR_RETURN(const TriangleSoup mesh, BuildBodyMesh(shape, options.num_vertices,
                                                                progress.Stage("shape", 0, .4)));
  PLEAT_ASSIGN_OR_RETURN(SkinWeights weights, BuildBodyWeights(shape, mesh));
  PLEAT_RETURN_IF_ERROR(progress.Report(.5));

  PoseTrack track = GenerateMotion(shape.skeleton(), {.seed = options.seed,
                                                      .style = options.style,
                                                      .num_frames = options.num_frames,
                                                      .fps = options.frame_rate.fps()});
  SkirtDynamics dynamics(shape);
  PLEAT_ASSIGN_OR_RETURN(
      const std::vector<Eigen::Matrix3Xf> grids,
      dynamics.Simulate(track, kGravity / options.height_m, progress.Stage("skirt", .5, .9)));

  const Stage stage{options.height_m,
                    Eigen::Quaterniond(Eigen::AngleAxisd(
                        options.yaw_degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitY()))};
  const int num_vertices = static_cast<int>(mesh.positions.size());
  // The rest shape is rounded to float32 first, so that frame 0 is exactly the rest shape of the
  // truth. It goes through a matrix of its own: GCC 12.2 at -O2 drops the rounding of a single
  // Vector3d -> Vector3f -> Vector3d.
  Eigen::Matrix3Xf rest(3, num_vertices);
  for (int v = 0; v < num_vertices; ++v) {
    rest.col(v) = stage.Place(mesh.positions[v]).cast<float>();
  }
  Eigen::Matrix3Xi triangles(3, mesh.triangles.size());
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    triangles.col(f) = Eigen::Vector3i(mesh.triangles[f].data());
  }
  PLEAT_ASSIGN_OR_RETURN(Topology topology, Topology::FromTriangles(num_vertices, triangles));

  const SkirtDetail detail(shape, dynamics, mesh);
  Skeleton placed_skeleton = PlaceSkeleton(stage, shape.skeleton());
  PoseTrack placed_track = PlaceTrack(stage, placed_skeleton, std::move(track));
  PerformerTruth truth{.rig = {std::move(placed_skeleton), std::move(weights), rest.cast<double>()},
                       .track = std::move(placed_track),
                       .is_skirt = std::vector<uint8_t>(num_vertices, 0)};
  for (int v : detail.vertices()) truth.is_skirt[v] = 1;
  PLEAT_ASSIGN_OR_RETURN(
      std::vector<Eigen::Matrix3Xf> frames,
      ComputeFrames(truth, grids, detail, stage, progress.Stage("frames", .9, 1)));
  MeshSequenceOptions sequence_options;
  sequence_options.name = absl::StrCat("performer-", options.character_seed, "-", options.seed);
  sequence_options.frame_rate = options.frame_rate;
  PLEAT_ASSIGN_OR_RETURN(
      MeshSequence sequence,
      MeshSequence::Create(std::move(topology), std::move(frames), std::move(sequence_options)));
  return Performer{std::move(sequence), std::move(truth)};
}

}  // namespace pleat
