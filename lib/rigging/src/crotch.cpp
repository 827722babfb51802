#include "crotch.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

constexpr int kNumSteps = 120;  // from the ankles to the chest
// Shares of the height: what belongs to the feet, how far a section reaches, and how far sections
// keep from the crotch.
constexpr double kFootShare = .02, kSectionReach = .25, kSliceShare = .02;
// Legs that part below this share of the way to the hips cross or touch.
constexpr double kShortestLeg = .35;
// Legs that make up this share of the section above them end in a crotch (.65 to 1 in people),
// thinner ones in a hem (.11 to .18) or in a belly.
constexpr double kLegShare = .5;
// So much above the crotch, as a share of the height, the section is that of the pelvis.
constexpr double kPelvisAbove = .08;
// A belly is round there (two legs that touch are twice as wide as deep), and it narrows towards
// the crotch to less than that share of its area. A hem grows wider instead, and the pelvis of
// people keeps .75 to 1.
constexpr double kLongestBelly = 1.75, kNarrowed = .7;
// Half way up to the chest a fat body has at least that share of its area; a skirt whose hem is
// drawn in, like a balloon, ends at a waist of half of it.
constexpr double kWaist = .65;
// The hips of the legs lie that many radii of the pelvis above the crotch. Five bodies that artists
// rigged have -.1, .7, .8, .9 and 1.4.
constexpr double kHipsInPelvis = .8;

// A part of a horizontal section.
struct Patch {
  double area = 0;    // in cells of the field
  double aspect = 0;  // length per width, of the ellipse with the same moments
};

// A horizontal section of the body, in cells of the field.
class Section {
 public:
  Section(const DistanceField& field, const Eigen::Matrix3d& input_from_upright,
          const Eigen::Vector3d& center, double reach)
      : spacing_(field.spacing()), origin_(center - reach * Eigen::Vector3d(1, 0, 1)) {
    size_ = static_cast<int>(std::ceil(2 * reach / spacing_)) + 1;
    inside_.resize(static_cast<size_t>(size_) * size_);
    for (int j = 0; j < size_; ++j) {
      for (int i = 0; i < size_; ++i) {
        const Eigen::Vector3d point = origin_ + spacing_ * Eigen::Vector3d(i, 0, j);
        inside_[i + size_ * j] = field.SignedDistance(input_from_upright * point) < 0 ? 1 : 0;
      }
    }
  }

  // Returns the part that holds `seed`, empty outside. Cells counted once are not counted again.
  Patch PatchAround(const Eigen::Vector3d& seed) {
    const int i = static_cast<int>(std::lround((seed.x() - origin_.x()) / spacing_));
    const int j = static_cast<int>(std::lround((seed.z() - origin_.z()) / spacing_));
    Patch patch;
    if (i < 0 || j < 0 || i >= size_ || j >= size_) return patch;
    std::vector<int> cells;
    const auto visit = [&](int at) {
      if (inside_[at] == 0) return;
      inside_[at] = 0;
      cells.push_back(at);
    };
    visit(i + size_ * j);
    for (size_t k = 0; k < cells.size(); ++k) {
      const int at = cells[k];
      if (at % size_ > 0) visit(at - 1);
      if (at % size_ + 1 < size_) visit(at + 1);
      if (at >= size_) visit(at - size_);
      if (at + size_ < size_ * size_) visit(at + size_);
    }
    patch.area = static_cast<double>(cells.size());
    if (cells.size() < 2) return patch;
    Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(cells.size()));
    for (size_t k = 0; k < cells.size(); ++k) {
      places.col(static_cast<Eigen::Index>(k)) << cells[k] % size_, cells[k] / size_;
    }
    const Eigen::Matrix2Xd centered = places.colwise() - places.rowwise().mean();
    const Eigen::Vector2d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(
                                        centered * centered.transpose(), Eigen::EigenvaluesOnly)
                                        .eigenvalues();
    patch.aspect = std::sqrt(moments[1] / std::max(moments[0], 1e-9));
    return patch;
  }

 private:
  double spacing_;
  Eigen::Vector3d origin_;
  int size_ = 0;
  std::vector<char> inside_;
};

// Returns the point at height y of the leg that ends in the joint `ankle`.
Eigen::Vector3d PointOfLeg(const Eigen::Matrix3Xd& joints, int ankle, double y) {
  const int lower = y > joints(1, ankle - 1) ? ankle - 1 : ankle;
  const Eigen::Vector3d below = joints.col(lower), above = joints.col(lower - 1);
  const double rise = above.y() - below.y();
  const double share = rise > 0 ? std::clamp((y - below.y()) / rise, 0.0, 1.0) : 0.0;
  return below + share * (above - below);
}

}  // namespace

std::optional<Crotch> FindCrotch(const DistanceField& field,
                                 const Eigen::Matrix3d& upright_from_input,
                                 const Eigen::Matrix3Xd& joints,
                                 const Eigen::AlignedBox3d& bounds) {
  const Eigen::Matrix3d input_from_upright = upright_from_input.transpose();
  const double height = bounds.sizes().y();
  const double low = std::max(joints(1, kLeftFoot), joints(1, kRightFoot)) + kFootShare * height;
  const double high = joints(1, kChest);
  const auto middle = [&](double y) -> Eigen::Vector3d {
    Eigen::Vector3d m = .5 * (PointOfLeg(joints, kLeftFoot, y) + PointOfLeg(joints, kRightFoot, y));
    m.y() = y;
    return m;
  };
  // From above, since feet may touch.
  int step = kNumSteps;
  double crotch = high;
  for (; step >= 0; --step) {
    crotch = low + (high - low) * step / kNumSteps;
    if (field.SignedDistance(input_from_upright * middle(crotch)) > 0) break;
  }
  if (step < 0 || step == kNumSteps) return std::nullopt;
  const double reach = kSectionReach * height;
  const auto section_at = [&](double y) {
    return Section(field, input_from_upright, middle(y), reach);
  };
  const auto patch_at = [&](double y) { return section_at(y).PatchAround(middle(y)); };
  const double y_below = crotch - kSliceShare * height;
  Section lower = section_at(y_below);
  const double legs = lower.PatchAround(PointOfLeg(joints, kLeftFoot, y_below)).area +
                      lower.PatchAround(PointOfLeg(joints, kRightFoot, y_below)).area;
  const double above = patch_at(crotch + kSliceShare * height).area;
  const Patch pelvis = patch_at(crotch + kPelvisAbove * height);
  const bool is_belly = pelvis.aspect < kLongestBelly && above < kNarrowed * pelvis.area &&
                        patch_at(.5 * (crotch + high)).area > kWaist * pelvis.area;
  const double hips = .5 * (joints(1, kLeftUpperLeg) + joints(1, kRightUpperLeg));
  const bool are_legs = legs > kLegShare * above && crotch - low >= kShortestLeg * (hips - low);
  if (!is_belly && !are_legs) return std::nullopt;
  const double radius = field.spacing() * std::sqrt(pelvis.area / std::numbers::pi);
  return Crotch{crotch, crotch + kHipsInPelvis * radius};
}

}  // namespace pleat
