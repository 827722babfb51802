#include "pleat/rigging/embedding.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// The spheres that hang together and hold the most volume, and the bounds of the mesh components
// around them: things that float beside the character are left out.
struct MainBody {
  std::vector<Sphere> spheres;
  Eigen::AlignedBox3d bounds;
};

std::vector<Sphere> LargestConnectedGroup(const SphereGraph& graph) {
  std::vector<int> group(graph.size(), -1);
  int best_group = -1;
  double best_volume = 0;
  for (int seed = 0; seed < graph.size(); ++seed) {
    if (group[seed] >= 0) continue;
    double volume = 0;
    for (int i = 0; i < graph.size(); ++i) {
      if (!std::isfinite(graph.PathLength(seed, i))) continue;
      group[i] = seed;
      volume += std::pow(graph.sphere(i).radius, 3);
    }
    if (volume > best_volume) {
      best_volume = volume;
      best_group = seed;
    }
  }
  std::vector<Sphere> spheres;
  for (int i = 0; i < graph.size(); ++i) {
    if (group[i] == best_group) spheres.push_back(graph.sphere(i));
  }
  return spheres;
}

MainBody FindMainBody(const BodyVolume& volume, const SphereGraph& graph) {
  MainBody body;
  body.spheres = LargestConnectedGroup(graph);
  const SolidSurface& surface = volume.surface;
  std::vector<char> is_near(surface.report.num_components, 0);
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    const int component = surface.triangle_components[f];
    if (is_near[component]) continue;
    const Eigen::Vector3d corner = surface.positions.col(surface.triangles(0, f));
    is_near[component] =
        std::any_of(body.spheres.begin(), body.spheres.end(), [&](const Sphere& sphere) {
          return (sphere.centre - corner).norm() < 1.5 * sphere.radius + volume.field.spacing();
        });
  }
  for (int f = 0; f < surface.triangles.cols(); ++f) {
    if (!is_near[surface.triangle_components[f]]) continue;
    for (int k = 0; k < 3; ++k) {
      body.bounds.extend(Eigen::Vector3d(surface.positions.col(surface.triangles(k, f))));
    }
  }
  return body;
}

// Step 8: all 18 joints, those of degree two along the paths.
Eigen::Matrix3Xd PlaceAllJoints(const SphereGraph& graph, const SearchTree& tree,
                                const std::vector<int>& spheres) {
  Eigen::Matrix3Xd joints(3, kNumHumanJoints);
  for (size_t j = 0; j < tree.size(); ++j) {
    if (tree[j].parent < 0) {
      joints.col(tree[j].human_joint) = graph.sphere(spheres[j]).centre;
      continue;
    }
    const Eigen::Matrix3Xd points =
        PointsAlongPath(graph, graph.Path(spheres[tree[j].parent], spheres[j]), tree[j].fractions);
    for (size_t k = 0; k < tree[j].chain.size(); ++k) {
      joints.col(tree[j].chain[k]) = points.col(k);
    }
  }
  return joints;
}

Eigen::Matrix3Xd TurnedTemplate(double yaw_rad, double body_size) {
  return body_size * (Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() *
                      HumanTemplate().RestPositions());
}

Eigen::Matrix3Xd WorldFromUnit(const BodyVolume& volume, const Eigen::Matrix3Xd& points) {
  return (points.colwise() - volume.offset) / volume.scale;
}

}  // namespace

absl::StatusOr<Embedding> EmbedSkeleton(const BodyVolume& volume, const EmbeddingOptions& options,
                                        const Progress& progress) {
  if (options.yaws_degrees.empty()) {
    return absl::InvalidArgumentError("no facing to try for the skeleton");
  }
  const SphereGraph whole(PackSpheres(volume.medial_samples, options.max_spheres), volume.field);
  const MainBody body = FindMainBody(volume, whole);
  const SphereGraph graph(body.spheres, volume.field);
  const double body_size = body.bounds.sizes().maxCoeff();
  const double floor_height = body.bounds.min().y();

  Embedding embedding;
  embedding.num_spheres = graph.size();
  embedding.residual = std::numeric_limits<double>::infinity();
  Eigen::Matrix3Xd best_joints;
  const int num_yaws = static_cast<int>(options.yaws_degrees.size());
  for (int k = 0; k < num_yaws; ++k) {
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(k) / num_yaws));
    const double yaw = options.yaws_degrees[k];
    const SearchTree tree = MakeHumanSearchTree(body_size, yaw * std::numbers::pi / 180);
    const PenaltyModel model(graph, tree, floor_height, body_size, options.penalties);
    const absl::StatusOr<SearchResult> found = SearchEmbedding(model, options.search, progress);
    if (absl::IsCancelled(found.status())) return found.status();
    embedding.facings.push_back(
        {yaw, found.ok() ? found->penalty : std::numeric_limits<double>::infinity()});
    if (!found.ok() || found->penalty >= embedding.residual) continue;
    embedding.residual = found->penalty;
    embedding.yaw_degrees = yaw;
    best_joints = PlaceAllJoints(graph, tree, found->spheres);
  }
  if (!std::isfinite(embedding.residual)) {
    return absl::NotFoundError(
        absl::StrCat("the human skeleton fits into this body in none of the ", num_yaws,
                     " facings tried (", graph.size(), " spheres)"));
  }
  embedding.initial_joints = WorldFromUnit(volume, best_joints);
  const Eigen::Matrix3Xd refined = RefineEmbedding(
      best_joints, TurnedTemplate(embedding.yaw_degrees * std::numbers::pi / 180, body_size),
      volume.medial_samples, options.refinement);
  embedding.joints = WorldFromUnit(volume, refined);
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return embedding;
}

}  // namespace pleat
