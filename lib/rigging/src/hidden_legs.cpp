#include "hidden_legs.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

// Shares of the height above the sole where sections are taken, and how many of them must be those
// of a robe.
constexpr double kHeights[] = {.08, .12, .16, .20};
constexpr int kMinHidden = 3;
// Slits of twice this width are closed, in cells of the field: those of a fringe, or of a coat. The
// field knows the distances of two cells.
constexpr double kSlit = 1.5;
constexpr int kMargin = 3;  // cells around the body
// A robe has at least this area, as a share of the squared height (a circle of .075, slits closed;
// two lower legs in trousers have .01 to .015).
constexpr double kLeastArea = .02;
// Its outline is so much longer than wide at most. Two legs that touch have 2.2.
constexpr double kLongestOutline = 1.75;
constexpr double kOneOutline = .9;  // share of the section's area
// Its area is that of the ellipse with the same moments. Two round legs or shoes that touch have
// .89 of it, a rectangle .955.
constexpr double kLeastOfEllipse = .94;
// A little above the sole two feet side by side, each with that share of their area and together
// with that share of the area of the highest section, are those of short legs: what lies above them
// is the trunk. Feet that show under a hem are far smaller than the robe.
constexpr double kFeetHeight = .04, kFootShare = .3, kFeetPerTrunk = .5;

// A horizontal section as it is seen from outside: what the outside does not reach is filled, and
// so are slits of twice the width `slit`, in cells.
class Silhouette {
 public:
  Silhouette(const DistanceField& field, const Eigen::Matrix3d& input_from_upright,
             const Eigen::AlignedBox3d& bounds, double y, double slit)
      : spacing_(field.spacing()) {
    width_ = static_cast<int>(std::ceil(bounds.sizes().x() / spacing_)) + 1 + 2 * kMargin;
    depth_ = static_cast<int>(std::ceil(bounds.sizes().z() / spacing_)) + 1 + 2 * kMargin;
    cells_.assign(static_cast<size_t>(width_) * depth_, kFilled);
    std::vector<char> is_body(cells_.size(), 0);
    for (int k = 0; k < depth_; ++k) {
      for (int i = 0; i < width_; ++i) {
        const Eigen::Vector3d point(bounds.min().x() + spacing_ * (i - kMargin), y,
                                    bounds.min().z() + spacing_ * (k - kMargin));
        if (field.SignedDistance(input_from_upright * point) < slit * spacing_) {
          is_body[i + width_ * k] = 1;
        }
      }
    }
    Mark(
        0, [&](int at) { return is_body[at] == 0; }, kOutside);
  }

  // Returns the parts of the section that do not touch, largest first. May be asked once.
  std::vector<std::vector<int>> TakePieces() {
    std::vector<std::vector<int>> pieces;
    for (size_t seed = 0; seed < cells_.size(); ++seed) {
      if (cells_[seed] != kFilled) continue;
      pieces.push_back(Mark(
          static_cast<int>(seed), [](int) { return true; }, kCounted));
    }
    std::ranges::stable_sort(pieces, std::greater(), &std::vector<int>::size);
    return pieces;
  }

  // Returns the area of `num_cells` cells.
  double Area(size_t num_cells) const {
    return static_cast<double>(num_cells) * spacing_ * spacing_;
  }

  bool IsRound(const std::vector<int>& piece) const {
    Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(piece.size()));
    for (size_t k = 0; k < piece.size(); ++k) {
      places.col(static_cast<Eigen::Index>(k)) << piece[k] % width_, piece[k] / width_;
    }
    const Eigen::Matrix2Xd centered = places.colwise() - places.rowwise().mean();
    const auto area = static_cast<double>(piece.size());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
        centered * centered.transpose() / area, Eigen::EigenvaluesOnly);
    const double narrow = std::max(axes.eigenvalues()[0], 1e-9), wide = axes.eigenvalues()[1];
    return wide < kLongestOutline * kLongestOutline * narrow &&
           area > kLeastOfEllipse * 4 * std::numbers::pi * std::sqrt(wide * narrow);
  }

 private:
  static constexpr char kFilled = 1, kOutside = 0, kCounted = 2;

  // Gives `label` to the filled cells that hang together with `seed` and may be entered.
  template <typename MayEnter>
  std::vector<int> Mark(int seed, const MayEnter& may_enter, char label) {
    std::vector<int> marked = {seed};
    cells_[seed] = label;
    for (size_t k = 0; k < marked.size(); ++k) {
      const int at = marked[k], i = at % width_, row = at / width_;
      const auto visit = [&](bool is_there, int next) {
        if (!is_there || cells_[next] != kFilled || !may_enter(next)) return;
        cells_[next] = label;
        marked.push_back(next);
      };
      visit(i > 0, at - 1);
      visit(i + 1 < width_, at + 1);
      visit(row > 0, at - width_);
      visit(row + 1 < depth_, at + width_);
    }
    return marked;
  }

  double spacing_;
  int width_ = 0, depth_ = 0;
  std::vector<char> cells_;
};

}  // namespace

bool AreLegsHidden(const BodyVolume& volume, const MainBody& body,
                   const Eigen::Matrix3d& upright_from_input) {
  const Eigen::Matrix3d input_from_upright = upright_from_input.transpose();
  const double height = body.bounds.sizes().y();
  const auto section_at = [&](double share, double slit) {
    return Silhouette(volume.field, input_from_upright, body.bounds,
                      body.bounds.min().y() + share * height, slit);
  };
  int num_hidden = 0;
  double highest = 0;  // area of the highest section
  for (const double share : kHeights) {
    Silhouette section = section_at(share, kSlit);
    const std::vector<std::vector<int>> pieces = section.TakePieces();
    if (pieces.empty()) return false;
    size_t num_cells = 0;
    for (const std::vector<int>& piece : pieces) num_cells += piece.size();
    highest = section.Area(num_cells);
    if (highest > kLeastArea * height * height &&
        static_cast<double>(pieces[0].size()) > kOneOutline * static_cast<double>(num_cells) &&
        section.IsRound(pieces[0])) {
      ++num_hidden;
    }
  }
  if (num_hidden < kMinHidden) return false;
  Silhouette lowest = section_at(kFeetHeight, 0);
  const std::vector<std::vector<int>> feet = lowest.TakePieces();
  if (feet.size() < 2) return true;
  const double both = lowest.Area(feet[0].size() + feet[1].size());
  return lowest.Area(feet[1].size()) < kFootShare * both || both < kFeetPerTrunk * highest;
}

void PlaceHiddenLegs(const MainBody& body, const Eigen::Matrix3Xd& template_joints,
                     Eigen::Matrix3Xd* joints) {
  const double scale = body.bounds.sizes().y() / body.bounds.sizes().maxCoeff();
  Eigen::Vector3d middle = joints->col(kHips);
  middle.y() = body.bounds.min().y();
  joints->col(kHips) = middle + scale * template_joints.col(kHips);
  for (int j = kLeftUpperLeg; j <= kRightToes; ++j) {
    joints->col(j) = middle + scale * template_joints.col(j);
  }
}

}  // namespace pleat
