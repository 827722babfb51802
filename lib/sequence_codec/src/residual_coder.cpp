#include "residual_coder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "integer_model.h"

namespace pleat {
namespace {

constexpr double kMaxSteps = 1 << 26;

using Integers = std::array<int, 3>;

double Round(double x) { return std::floor(x + 0.5); }

class ResidualWalk {
 public:
  ResidualWalk(const SurfaceHierarchy& hierarchy, const ResidualGrid& grid, BinaryCoder* coder)
      : hierarchy_(hierarchy),
        grid_(grid),
        coder_(coder),
        now_(hierarchy.order().size(), 0),
        before_(now_),
        present_({12 * 12, 12, 16}, 1),
        values_({12 * 12, 12 * 12 * 3, 36}, 12) {}

  // truth: null when decoding.
  absl::Status CodeFrame(const Eigen::Matrix3Xf* truth, Eigen::Matrix3Xf* frame) {
    now_.swap(before_);
    for (const int v : hierarchy_.order()) {
      Integers q = {0, 0, 0};
      if (truth != nullptr) {
        if (!Quantize(truth->col(v).cast<double>(), frame->col(v).cast<double>(), &q)) {
          return absl::InvalidArgumentError(
              absl::StrCat("the error of vertex ", v, " has too many steps of ", grid_.step_m * 1e3,
                           " mm; ask for a larger error"));
        }
      }
      CodeVertex(v, &q);
      frame->col(v) = Apply(frame->col(v).cast<double>(), q).cast<float>();
      if (coder_->overrun()) return absl::DataLossError("the residuals are cut off");
    }
    return absl::OkStatus();
  }

 private:
  Eigen::Vector3d Apply(const Eigen::Vector3d& predicted, const Integers& q) const {
    Eigen::Vector3d result;
    for (int c = 0; c < 3; ++c) {
      const double base =
          grid_.kind == ResidualKind::kGrid
              ? grid_.origin_m[c] +
                    (Round((predicted[c] - grid_.origin_m[c]) / grid_.step_m) + q[c]) * grid_.step_m
              : predicted[c] + q[c] * grid_.step_m;
      result[c] = base;
    }
    return result;
  }

  bool Quantize(const Eigen::Vector3d& truth, const Eigen::Vector3d& predicted, Integers* q) const {
    const bool on_grid = grid_.kind == ResidualKind::kGrid;
    if (!on_grid && (truth - predicted).norm() <= grid_.bound_m) return true;
    for (int c = 0; c < 3; ++c) {
      const double steps = on_grid ? Round((truth[c] - grid_.origin_m[c]) / grid_.step_m) -
                                         Round((predicted[c] - grid_.origin_m[c]) / grid_.step_m)
                                   : Round((truth[c] - predicted[c]) / grid_.step_m);
      if (!(std::fabs(steps) < kMaxSteps)) return false;
      (*q)[c] = static_cast<int>(steps);
    }
    if (!on_grid) Shrink(truth - predicted, q);
    return true;
  }

  // Smaller integers are cheaper: towards zero as long as the vertex stays within the bound.
  void Shrink(const Eigen::Vector3d& residual, Integers* q) const {
    for (int c = 0; c < 3; ++c) {
      while ((*q)[c] != 0) {
        Integers less = *q;
        less[c] += less[c] > 0 ? -1 : 1;
        const Eigen::Vector3d left =
            residual - grid_.step_m * Eigen::Vector3d(less[0], less[1], less[2]);
        if (left.norm() > grid_.bound_m) break;
        *q = less;
      }
    }
  }

  void CodeVertex(int v, Integers* q) {
    int around = 0;  // of the coarser neighbors in this frame, and of the vertex one frame ago
    for (const int n : hierarchy_.neighbors(v)) around += now_[n];
    const int near =
        around * 16 / std::max<int>(3, 3 * static_cast<int>(hierarchy_.neighbors(v).size()));
    const int earlier = before_[v] * 16 / 3;
    const int near_class = MagnitudeClass(near), earlier_class = MagnitudeClass(earlier);
    const int both = near_class * 12 + earlier_class;
    int sum = 0;
    if (grid_.kind == ResidualKind::kCorrection) {
      const bool any = present_.CodeUnsigned(
          coder_, (*q)[0] != 0 || (*q)[1] != 0 || (*q)[2] != 0,
          {both, MagnitudeClass((near + earlier) / 2), std::min(hierarchy_.level(v), 15)}, 0);
      now_[v] = 0;
      if (!any) return;
    }
    const int set = MagnitudeClass((near + earlier) / 2);
    for (int c = 0; c < 3; ++c) {
      const int own = MagnitudeClass(sum * 16 / std::max(c, 1));
      (*q)[c] = values_.CodeSigned(coder_, (*q)[c],
                                   {both, (own * 12 + near_class) * 3 + c, set * 3 + c}, set);
      sum += std::min(std::abs((*q)[c]), 1000);
    }
    now_[v] = static_cast<uint16_t>(sum);
  }

  const SurfaceHierarchy& hierarchy_;
  const ResidualGrid& grid_;
  BinaryCoder* coder_;
  std::vector<uint16_t> now_, before_;  // per vertex: sum of magnitudes
  IntegerModel<3> present_, values_;
};

}  // namespace

absl::Status CodeResiduals(const SurfaceHierarchy& hierarchy, const ResidualGrid& grid,
                           const std::vector<const Eigen::Matrix3Xf*>& truth, BinaryCoder* coder,
                           std::vector<Eigen::Matrix3Xf>* frames) {
  if (grid.kind == ResidualKind::kNone) return absl::OkStatus();
  ResidualWalk walk(hierarchy, grid, coder);
  for (size_t t = 0; t < frames->size(); ++t) {
    const absl::Status status = walk.CodeFrame(truth.empty() ? nullptr : truth[t], &(*frames)[t]);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace pleat
