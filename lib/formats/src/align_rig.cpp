// Corresponding vertices by Kabsch's fit (pleat/math/rigid.h), others by principal axes and turns
// between coordinate axes, each refined by closest points (Besl and McKay, A Method for
// Registration of 3-D Shapes, 1992). Whatever was guessed is measured against every vertex.
#include "align_rig.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "absl/strings/str_format.h"
#include "pleat/base/status.h"
#include "pleat/geometry/point_index.h"
#include "pleat/math/principal_axes.h"
#include "pleat/math/rigid.h"

namespace pleat {
namespace {

// Clip units per file unit: centimeters and inches to meters, and back.
constexpr double kUnitRatios[] = {1, .01, 100, .0254, 1 / .0254};
constexpr double kRatioTolerance = .05;  // of the ratio of two sizes that should be a unit
constexpr int kMaxSamples = 400, kNumClosestPointSteps = 15;
// Two placements are told apart when the better one has at most half of the other's distance.
constexpr double kClearlyBetter = .5;

// A point x of the file lies at motion * (scale * x) in the clip.
struct Placement {
  double scale = 1;
  RigidTransform motion;

  Eigen::Matrix3Xd Apply(const Eigen::Matrix3Xd& points) const {
    return ((scale * motion.rotation) * points).colwise() + motion.translation;
  }
};

// What every guess is measured against.
struct Meshes {
  const Eigen::Matrix3Xd& file;
  const Eigen::Matrix3Xd& clip;
  double max_distance;
  PointIndex file_index;
  Eigen::Vector3d file_center, clip_center;
  double file_size, clip_size;  // root mean square distance from the center
};

// The first of points that lie at the same place, which exporters split, so that the center does
// not depend on seams.
Eigen::Matrix3Xd Distinct(const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> order(points.cols());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
  const auto key = [&](Eigen::Index i) {
    return std::array<double, 3>{points(0, i), points(1, i), points(2, i)};
  };
  std::ranges::sort(order, {}, key);
  const auto is_same = [&](Eigen::Index a, Eigen::Index b) { return key(a) == key(b); };
  order.erase(std::unique(order.begin(), order.end(), is_same), order.end());
  return points(Eigen::all, order);
}

double SizeAround(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& center) {
  return std::sqrt((points.colwise() - center).colwise().squaredNorm().mean());
}

// Returns the root mean square distance of the clip's vertices from the file's, or nothing when one
// is too far.
std::optional<double> Distance(const Meshes& meshes, const Placement& placement) {
  const RigidTransform back = placement.motion.Inverse();
  double total = 0;
  for (Eigen::Index v = 0; v < meshes.clip.cols(); ++v) {
    double squared = 0;
    meshes.file_index.Nearest(back * meshes.clip.col(v) / placement.scale, &squared);
    squared *= placement.scale * placement.scale;
    if (!(squared <= meshes.max_distance * meshes.max_distance)) return std::nullopt;
    total += squared;
  }
  return std::sqrt(total / static_cast<double>(meshes.clip.cols()));
}

Placement Refine(const Meshes& meshes, Placement placement) {
  const Eigen::Index step = meshes.clip.cols() / kMaxSamples + 1;
  const Eigen::Index num_samples = (meshes.clip.cols() + step - 1) / step;
  Eigen::Matrix3Xd source(3, num_samples), target(3, num_samples);
  for (int k = 0; k < kNumClosestPointSteps; ++k) {
    const RigidTransform back = placement.motion.Inverse();
    for (Eigen::Index i = 0; i < num_samples; ++i) {
      target.col(i) = meshes.clip.col(i * step);
      const int nearest =
          meshes.file_index.Nearest(back * target.col(i) / placement.scale, nullptr);
      if (nearest < 0) return placement;
      source.col(i) = placement.scale * meshes.file.col(nearest);
    }
    const absl::StatusOr<RigidTransform> motion = FitRigidTransform(source, target);
    if (!motion.ok()) return placement;
    placement.motion = *motion;
  }
  return placement;
}

// Returns the proper rotations between two sets of principal axes and those between coordinate
// axes.
std::vector<Eigen::Matrix3d> GuessRotations(const Meshes& meshes) {
  const auto axes = [](const Eigen::Matrix3Xd& points, const Eigen::Vector3d& center) {
    Eigen::Matrix3d vectors = PrincipalAxes(points, center);
    if (vectors.determinant() < 0) vectors.col(0) *= -1;
    return vectors;
  };
  const Eigen::Matrix3d from = axes(Distinct(meshes.file), meshes.file_center);
  const Eigen::Matrix3d to = axes(Distinct(meshes.clip), meshes.clip_center);
  std::vector<Eigen::Matrix3d> rotations;
  for (const Eigen::Vector3d& signs : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, -1, -1),
                                       Eigen::Vector3d(-1, 1, -1), Eigen::Vector3d(-1, -1, 1)}) {
    rotations.push_back(to * signs.asDiagonal() * from.transpose());
  }
  for (int code = 0; code < 6 * 8; ++code) {
    std::array<int, 3> order = {0, 1, 2};
    for (int k = 0; k < code / 8; ++k) std::next_permutation(order.begin(), order.end());
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) turn(k, order[k]) = (code >> k) % 2 == 0 ? 1 : -1;
    if (turn.determinant() > 0) rotations.push_back(turn);
  }
  return rotations;
}

// Returns the placement that the file's nodes show, when it is a rigid motion and a scale.
std::optional<Placement> ShownPlacement(const Eigen::Matrix4d& shown) {
  const Eigen::Matrix3d linear = shown.topLeftCorner<3, 3>();
  const double scale = std::cbrt(linear.determinant());
  if (!shown.allFinite() || !(scale > 0) || !std::isfinite(scale)) return std::nullopt;
  const Eigen::Matrix3d rotation = linear / scale;
  if (!rotation.isUnitary(1e-3)) return std::nullopt;
  return Placement{scale, {rotation, shown.topRightCorner<3, 1>()}};
}

// Guesses that need no search, the most modest first.
std::vector<Placement> DirectGuesses(const Meshes& meshes, double unit,
                                     const Eigen::Matrix4d& shown) {
  std::vector<Placement> guesses = {{1, {}}, {unit, {}}};
  if (const auto placement = ShownPlacement(shown)) guesses.push_back(*placement);
  if (meshes.file.cols() == meshes.clip.cols()) {
    const absl::StatusOr<RigidTransform> motion =
        FitRigidTransform(unit * meshes.file, meshes.clip);
    if (motion.ok()) {
      const Placement placement{unit, *motion};
      const Eigen::Matrix3Xd offsets = placement.Apply(meshes.file) - meshes.clip;
      if (offsets.colwise().norm().maxCoeff() <= meshes.max_distance) guesses.push_back(placement);
    }
  }
  return guesses;
}

// Searches for a placement by shape alone.
absl::StatusOr<std::optional<Placement>> Search(const Meshes& meshes, double unit) {
  struct Found {
    Placement placement;
    double distance;
  };
  std::vector<Found> found;
  for (const Eigen::Matrix3d& rotation : GuessRotations(meshes)) {
    Placement guess{unit, {rotation, meshes.clip_center - unit * (rotation * meshes.file_center)}};
    guess = Refine(meshes, guess);
    if (const auto distance = Distance(meshes, guess)) found.push_back({guess, *distance});
  }
  if (found.empty()) return std::nullopt;
  std::ranges::stable_sort(found, {}, &Found::distance);
  const Eigen::Matrix3Xd best = found[0].placement.Apply(meshes.file);
  const double floor = 1e-3 * meshes.max_distance;  // below it, distances are rounding
  for (const Found& other : found) {
    if (found[0].distance <= kClearlyBetter * other.distance - floor) break;
    const Eigen::Matrix3Xd offsets = other.placement.Apply(meshes.file) - best;
    if (offsets.colwise().norm().maxCoeff() <= 2 * meshes.max_distance) continue;
    return absl::InvalidArgumentError(
        "rig: the file's mesh lies on the clip's in several ways, so it cannot be aligned: export "
        "it in the place and unit of the clip");
  }
  return found[0].placement;
}

void Move(const Placement& placement, RigFile* file, std::vector<InputNote>* notes) {
  file->positions = placement.Apply(file->positions);
  file->skeleton =
      file->skeleton.WithRestPositions(placement.Apply(file->skeleton.RestPositions()));
  if (notes == nullptr) return;
  const Eigen::AngleAxisd turn(placement.motion.rotation);
  const Eigen::Vector3d& shift = placement.motion.translation;
  notes->push_back(
      {.kind = "rig_aligned",
       .text = absl::StrFormat(
           "rig: the file's mesh was laid on the clip's frame %d: scaled by %.4g, turned by %.1f "
           "degrees about (%.2f, %.2f, %.2f), moved by (%.3g, %.3g, %.3g) m",
           file->rest_frame, placement.scale, turn.angle() * 180 / 3.14159265358979,
           turn.axis().x(), turn.axis().y(), turn.axis().z(), shift.x(), shift.y(), shift.z())});
}

}  // namespace

absl::Status AlignRig(const Eigen::Matrix3Xd& rest, double max_distance_m, RigFile* file,
                      std::vector<InputNote>* notes) {
  const Eigen::Matrix3Xd points = file->positions;
  const Eigen::Matrix3Xd distinct = Distinct(points), distinct_clip = Distinct(rest);
  Meshes meshes{points,
                rest,
                max_distance_m,
                PointIndex(points),
                distinct.rowwise().mean(),
                distinct_clip.rowwise().mean(),
                0,
                0};
  meshes.file_size = SizeAround(distinct, meshes.file_center);
  meshes.clip_size = SizeAround(distinct_clip, meshes.clip_center);
  const double ratio = meshes.clip_size / meshes.file_size;
  const auto unit = std::ranges::find_if(
      kUnitRatios, [&](double u) { return std::abs(ratio / u - 1) <= kRatioTolerance; });
  const double scale = unit != std::end(kUnitRatios) ? *unit : 1;
  const std::vector<Placement> guesses = DirectGuesses(meshes, scale, file->shown_from_mesh);
  for (size_t g = 0; g < guesses.size(); ++g) {
    if (!Distance(meshes, guesses[g])) continue;
    if (g > 0) Move(guesses[g], file, notes);
    return absl::OkStatus();
  }
  if (unit == std::end(kUnitRatios)) return absl::OkStatus();
  PLEAT_ASSIGN_OR_RETURN(const std::optional<Placement> placement, Search(meshes, scale));
  if (placement) Move(*placement, file, notes);
  return absl::OkStatus();
}

}  // namespace pleat
