#include "pleat/geometry/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kMinResolution = 8, kMaxResolution = 512;
constexpr double kBandCells = 2;
constexpr int kBlockNodes = 16;             // side of a work item of the parallel loop
constexpr double kWindingTolerance = 0.05;  // error of the dipoles
constexpr double kClearSpacing = 1 + 1e-5;  // of spacings; the distances are rounded to floats

// The side on which a ball lies that is free of surface.
enum class Side { kUnknown, kInside, kOutside };

// Decides it from the winding number at the ball's center for the part within `ratio` of its
// radius. The winding number is harmonic away from the surface, so that its distance u >= 0 to 0
// (outside) or to 1 (inside) obeys Harnack's inequality: within `ratio` of the radius it is at most
// u (1 + ratio) / (1 - ratio)^2. That part lies on one side when this stays under one half. Across
// the holes of an open mesh it does not (docs/method/rig.md#coarse-to-fine).
Side SideOfBall(double winding, double ratio) {
  if (!(ratio < 1)) return Side::kUnknown;
  const bool is_inside = winding > 0.5;
  const double offset = std::max(is_inside ? 1 - winding : winding, 0.0) + kWindingTolerance;
  const double largest = offset * (1 + ratio) / ((1 - ratio) * (1 - ratio));
  if (!(largest < 0.5)) return Side::kUnknown;
  return is_inside ? Side::kInside : Side::kOutside;
}

}  // namespace

// Fills one block of nodes from coarse to fine: far from the surface one closest point and one
// winding number decide about many nodes. Blocks share no node, so they are filled in parallel.
class DistanceField::Sampler {
 public:
  Sampler(const TriangleTree& tree, const WindingNumber& winding_number, bool is_closed,
          DistanceField* field)
      : tree_(tree), winding_number_(winding_number), is_closed_(is_closed), field_(*field) {}

  // Fills the nodes low <= node < high.
  void FillBlock(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    Fill(low, high, std::numeric_limits<double>::infinity());
    DecideSides(low, high);
  }

 private:
  // Does it for a part of the block. `reach` is an upper bound of the distance from the part's
  // center to the surface, known from the larger part around it by the triangle inequality; it
  // makes the search of the closest point short.
  void Fill(const Eigen::Vector3i& low, const Eigen::Vector3i& high, double reach) {
    const Eigen::Vector3i sizes = high - low;
    if (sizes.prod() == 1) {
      FillNode(low, reach, Side::kUnknown);
      return;
    }
    const Eigen::Vector3d center = Center(low, high);
    const double radius =
        0.5 * field_.spacing_ * (sizes.array() - 1).matrix().cast<double>().norm();
    const double distance = DistanceWithin(center, reach);
    const Side side = distance > radius ? SideOfPart(center, radius / distance) : Side::kUnknown;
    if (side != Side::kUnknown) {
      FillOneSided(low, high, center, distance, side);
      return;
    }
    Eigen::Vector3i middle = low + (sizes + Eigen::Vector3i::Ones()) / 2;
    for (int part = 0; part < 8; ++part) {
      Eigen::Vector3i from = low, to = high;
      for (int k = 0; k < 3; ++k) ((part >> k & 1) != 0 ? from[k] : to[k]) = middle[k];
      if ((from.array() >= to.array()).any()) continue;
      Fill(from, to, distance + (Center(from, to) - center).norm());
    }
  }

  Eigen::Vector3d Center(const Eigen::Vector3i& low, const Eigen::Vector3i& high) const {
    return field_.origin_ +
           0.5 * field_.spacing_ * (low + high - Eigen::Vector3i::Ones()).cast<double>();
  }

  // Returns the side of a ball around `center` that no surface meets, for the part within `ratio`
  // of its radius.
  Side SideOfPart(const Eigen::Vector3d& center, double ratio) const {
    const double winding = winding_number_(center);
    if (is_closed_) return winding > 0.5 ? Side::kInside : Side::kOutside;
    return SideOfBall(winding, ratio);
  }

  // The bound is widened by a trace, since the search is exclusive and the bound may be met
  // exactly.
  double DistanceWithin(const Eigen::Vector3d& point, double reach) const {
    reach *= 1 + 1e-9;
    return std::sqrt(tree_.ClosestPoint(point, reach * reach).squared_distance);
  }

  // Fills a block that lies on one side. Nodes far outside need no search at all.
  void FillOneSided(const Eigen::Vector3i& low, const Eigen::Vector3i& high,
                    const Eigen::Vector3d& center, double distance, Side side) {
    const double band = kBandCells * field_.spacing_;
    for (int z = low.z(); z < high.z(); ++z) {
      for (int y = low.y(); y < high.y(); ++y) {
        // The node before is the nearest bound, but for nodes whose distance was clamped.
        double reach = std::numeric_limits<double>::infinity();
        for (int x = low.x(); x < high.x(); ++x) {
          const double offset = (field_.NodePosition(x, y, z) - center).norm();
          if (side == Side::kOutside && distance - offset >= band) {
            field_.distances_[field_.NodeIndex(x, y, z)] = static_cast<float>(band);
            continue;
          }
          const double found =
              FillNode({x, y, z}, std::min(distance + offset, reach + field_.spacing_), side);
          if (side == Side::kInside) reach = found;
        }
      }
    }
  }

  // Returns the distance, clamped to the band outside. Where the side is unknown and a neighbor may
  // tell it, the distance is kept as if it were outside, without the clamp, until DecideSides.
  double FillNode(const Eigen::Vector3i& at, double reach, Side side) {
    const Eigen::Vector3d point = field_.NodePosition(at.x(), at.y(), at.z());
    const int node = field_.NodeIndex(at.x(), at.y(), at.z());
    if (side == Side::kUnknown && !is_closed_) side = SideOf(at);
    const double band = kBandCells * field_.spacing_;
    const double bound = reach * (1 + 1e-9);
    const double radius = side == Side::kOutside ? std::min(band, bound) : bound;
    const SurfacePoint nearest = tree_.ClosestPoint(point, radius * radius);
    const double distance = nearest.triangle < 0 ? band : std::sqrt(nearest.squared_distance);
    field_.distances_[node] = static_cast<float>(side == Side::kInside ? -distance : distance);
    if (side != Side::kOutside && distance > 0) {
      field_.directions_[node] = ((nearest.position - point) / distance).cast<float>();
    }
    if (side == Side::kUnknown) undecided_.push_back(at);
    return distance;
  }

  Side SideOf(const Eigen::Vector3i& at) const {
    return winding_number_.IsInside(field_.NodePosition(at.x(), at.y(), at.z())) ? Side::kInside
                                                                                 : Side::kOutside;
  }

  // Gives the undecided nodes of a block the sides of their neighbors: two nodes that are nearer to
  // each other than their distances to the surface together have no surface between them. The
  // winding number is asked where no neighbor tells.
  void DecideSides(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    if (undecided_.empty()) return;
    const Eigen::Vector3i sizes = high - low;
    is_open_.assign(sizes.prod(), 0);
    const auto is_open = [&](const Eigen::Vector3i& at) -> char& {
      const Eigen::Vector3i local = at - low;
      return is_open_[local.x() + sizes.x() * (local.y() + sizes.y() * local.z())];
    };
    for (const Eigen::Vector3i& at : undecided_) is_open(at) = 1;
    std::vector<Eigen::Vector3i> stack;
    const auto decide = [&](const Eigen::Vector3i& at, Side side) {
      is_open(at) = 0;
      SetSide(field_.NodeIndex(at.x(), at.y(), at.z()), side);
      stack.push_back(at);
    };
    // Calls visit(neighbor) for the neighbors in the block without surface before them.
    const auto for_clear_neighbors = [&](const Eigen::Vector3i& at, const auto& visit) {
      for (int k = 0; k < 6; ++k) {
        Eigen::Vector3i next = at;
        next[k / 2] += k % 2 == 0 ? 1 : -1;
        if ((next.array() < low.array()).any() || (next.array() >= high.array()).any()) continue;
        const float clear = std::abs(DistanceAt(at)) + std::abs(DistanceAt(next));
        if (clear > kClearSpacing * field_.spacing_) visit(next);
      }
    };
    const auto spread = [&] {
      while (!stack.empty()) {
        const Eigen::Vector3i at = stack.back();
        stack.pop_back();
        const Side side = DistanceAt(at) < 0 ? Side::kInside : Side::kOutside;
        for_clear_neighbors(at, [&](const Eigen::Vector3i& next) {
          if (is_open(next) != 0) decide(next, side);
        });
      }
    };
    for (const Eigen::Vector3i& at : undecided_) {
      if (is_open(at) == 0) continue;
      for_clear_neighbors(at, [&](const Eigen::Vector3i& next) {
        if (is_open(at) == 0 || is_open(next) != 0 || DistanceAt(next) == 0) return;
        decide(at, DistanceAt(next) < 0 ? Side::kInside : Side::kOutside);
      });
      spread();
    }
    for (const Eigen::Vector3i& at : undecided_) {
      if (is_open(at) == 0) continue;
      decide(at, SideOf(at));
      spread();
    }
    undecided_.clear();
  }

  float DistanceAt(const Eigen::Vector3i& at) const {
    return field_.distances_[field_.NodeIndex(at.x(), at.y(), at.z())];
  }

  void SetSide(int node, Side side) {
    float& distance = field_.distances_[node];
    if (side == Side::kInside) {
      distance = -distance;
    } else {
      distance = std::min(distance, static_cast<float>(kBandCells * field_.spacing_));
      field_.directions_[node].setZero();
    }
  }

  const TriangleTree& tree_;
  const WindingNumber& winding_number_;
  bool is_closed_;
  DistanceField& field_;
  std::vector<Eigen::Vector3i> undecided_;  // of the block at hand
  std::vector<char> is_open_;               // per node of the block: not yet decided
};

absl::StatusOr<DistanceField> DistanceField::Compute(const TriangleTree& tree,
                                                     const WindingNumber& winding_number,
                                                     const DistanceFieldOptions& options,
                                                     const Progress& progress) {
  if (options.resolution < kMinResolution || options.resolution > kMaxResolution) {
    return absl::InvalidArgumentError(absl::StrCat("distance field resolution is ",
                                                   options.resolution, ", must be ", kMinResolution,
                                                   " to ", kMaxResolution));
  }
  if (tree.num_triangles() == 0) {
    return absl::InvalidArgumentError("a distance field needs at least one triangle");
  }
  const TriangleTree::Node& root = tree.nodes()[0];
  const double longest = (root.high - root.low).maxCoeff();
  if (!(longest > 0) || !std::isfinite(longest)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the surface has no extent (longest side ", longest, ")"));
  }
  DistanceField field;
  field.spacing_ = longest / options.resolution;
  field.origin_ = root.low - Eigen::Vector3d::Constant(options.padding * field.spacing_);
  for (int k = 0; k < 3; ++k) {
    field.num_nodes_[k] =
        static_cast<int>(std::ceil((root.high[k] - root.low[k]) / field.spacing_)) + 1 +
        2 * options.padding;
  }
  const size_t num_nodes = static_cast<size_t>(field.num_nodes_.x()) * field.num_nodes_.y() *
                           static_cast<size_t>(field.num_nodes_.z());
  field.distances_.resize(num_nodes);
  field.directions_.assign(num_nodes, Eigen::Vector3f::Zero());
  const Eigen::Vector3i num_blocks = (field.num_nodes_.array() + kBlockNodes - 1) / kBlockNodes;
  ParallelFor(num_blocks.prod(), options.num_threads, [&](int block) {
    if (progress.cancelled()) return;
    const Eigen::Vector3i low =
        kBlockNodes * Eigen::Vector3i(block % num_blocks.x(),
                                      block / num_blocks.x() % num_blocks.y(),
                                      block / (num_blocks.x() * num_blocks.y()));
    Sampler(tree, winding_number, options.is_closed, &field)
        .FillBlock(low, (low.array() + kBlockNodes).min(field.num_nodes_.array()).matrix());
  });
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return field;
}

double DistanceField::SignedDistance(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = (point - origin_) / spacing_;
  Eigen::Vector3i cell;
  Eigen::Vector3d fraction;
  for (int k = 0; k < 3; ++k) {
    if (!(local[k] >= 0) || local[k] > num_nodes_[k] - 1) return kBandCells * spacing_;
    cell[k] = std::min(static_cast<int>(local[k]), num_nodes_[k] - 2);
    fraction[k] = local[k] - cell[k];
  }
  const int corner = NodeIndex(cell.x(), cell.y(), cell.z());
  const int dy = num_nodes_.x(), dz = num_nodes_.x() * num_nodes_.y();
  const auto along_x = [&](int node) {
    return distances_[node] + fraction.x() * (distances_[node + 1] - distances_[node]);
  };
  const auto along_xy = [&](int node) {
    const double low = along_x(node);
    return low + fraction.y() * (along_x(node + dy) - low);
  };
  const double low = along_xy(corner);
  return low + fraction.z() * (along_xy(corner + dz) - low);
}

double DistanceField::MaxAlongSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  const int num_steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / (0.5 * spacing_))));
  double largest = -std::numeric_limits<double>::infinity();
  for (int k = 0; k <= num_steps; ++k) {
    largest = std::max(largest, SignedDistance(a + (b - a) * (static_cast<double>(k) / num_steps)));
  }
  return largest;
}

}  // namespace pleat
