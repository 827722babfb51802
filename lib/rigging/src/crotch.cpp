#include "crotch.h"

#include <algorithm>
#include <cmath>
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
// thinner ones in a hem (.11 to .18).
constexpr double kLegShare = .5;

// The area of the parts of a horizontal section that hold one of the `seeds`, in cells of the
// field.
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

  // Cells counted once are not counted again.
  int AreaAround(const Eigen::Vector3d& seed) {
    const int i = static_cast<int>(std::lround((seed.x() - origin_.x()) / spacing_));
    const int j = static_cast<int>(std::lround((seed.z() - origin_.z()) / spacing_));
    if (i < 0 || j < 0 || i >= size_ || j >= size_) return 0;
    std::vector<int> stack;
    const auto visit = [&](int at) {
      if (inside_[at] == 0) return;
      inside_[at] = 0;
      stack.push_back(at);
    };
    visit(i + size_ * j);
    int area = 0;
    while (!stack.empty()) {
      const int at = stack.back();
      stack.pop_back();
      ++area;
      if (at % size_ > 0) visit(at - 1);
      if (at % size_ + 1 < size_) visit(at + 1);
      if (at >= size_) visit(at - size_);
      if (at + size_ < size_ * size_) visit(at + size_);
    }
    return area;
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

std::optional<double> CrotchHeight(const DistanceField& field,
                                   const Eigen::Matrix3d& upright_from_input,
                                   const Eigen::Matrix3Xd& joints, double height) {
  const Eigen::Matrix3d input_from_upright = upright_from_input.transpose();
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
  const double hips = .5 * (joints(1, kLeftUpperLeg) + joints(1, kRightUpperLeg));
  if (step < 0 || step == kNumSteps || crotch - low < kShortestLeg * (hips - low)) {
    return std::nullopt;
  }
  const double reach = kSectionReach * height;
  const Eigen::Vector3d above = middle(crotch + kSliceShare * height);
  const double y_below = crotch - kSliceShare * height;
  Section upper(field, input_from_upright, above, reach);
  Section lower(field, input_from_upright, middle(y_below), reach);
  const double whole = upper.AreaAround(above);
  const double legs = lower.AreaAround(PointOfLeg(joints, kLeftFoot, y_below)) +
                      lower.AreaAround(PointOfLeg(joints, kRightFoot, y_below));
  if (!(legs > kLegShare * whole)) return std::nullopt;
  return crotch;
}

}  // namespace pleat
