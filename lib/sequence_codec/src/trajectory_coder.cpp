#include "trajectory_coder.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "integer_model.h"

namespace pleat {
namespace {

constexpr double kRounding = 0.35, kMaxQuantizedStep = 1 << 26;
constexpr int kNumFrequencyClasses = 24;

// cos(pi m / (2 T)) for m = 0 .. 4 T - 1, from products and sums alone: library cosines may differ
// in the last bit from machine to machine.
std::vector<double> CosineTable(int num_frames) {
  const double x = 3.14159265358979323846 / (2.0 * num_frames);
  double cos_step = 0, sin_step = 0, term = 1;
  for (int i = 0; i < 40; ++i) {  // Taylor series; x <= pi / 2
    const double sign = i / 2 % 2 == 0 ? 1 : -1;
    (i % 2 == 0 ? cos_step : sin_step) += sign * term;
    term *= x / (i + 1);
  }
  std::vector<double> table(static_cast<size_t>(4) * num_frames);
  double c = 1, s = 0;
  for (double& entry : table) {
    entry = c;
    const double next = c * cos_step - s * sin_step;
    s = s * cos_step + c * sin_step;
    c = next;
  }
  return table;
}

// Orthonormal DCT-II and its inverse by their sums: T is at most some hundreds.
class CosineTransform {
 public:
  explicit CosineTransform(int num_frames)
      : num_frames_(num_frames),
        table_(CosineTable(num_frames)),
        constant_(std::sqrt(1.0 / num_frames)),
        factor_(std::sqrt(2.0 / num_frames)) {}

  void Forward(const double* values, double* coefficients) const {
    for (int f = 0; f < num_frames_; ++f) {
      double sum = 0;
      for (int t = 0; t < num_frames_; ++t) sum += values[t] * Cosine(f, t);
      coefficients[f] = sum * (f == 0 ? constant_ : factor_);
    }
  }
  void Inverse(const double* coefficients, double* values) const {
    std::fill(values, values + num_frames_, 0.0);
    for (int f = 0; f < num_frames_; ++f) {
      if (coefficients[f] == 0) continue;
      const double scaled = coefficients[f] * (f == 0 ? constant_ : factor_);
      for (int t = 0; t < num_frames_; ++t) values[t] += scaled * Cosine(f, t);
    }
  }

 private:
  double Cosine(int f, int t) const {
    return table_[static_cast<int64_t>(f) * (2 * t + 1) % (4 * num_frames_)];
  }

  const int num_frames_;
  const std::vector<double> table_;
  const double constant_, factor_;
};

}  // namespace

absl::Status CodeTrajectories(const Eigen::Ref<const Eigen::VectorXd>& steps, BinaryCoder* coder,
                              TrajectoryMatrix* rows) {
  const int num_frames = static_cast<int>(rows->cols());
  const CosineTransform transform(num_frames);
  IntegerModel<3> model({12 * 12, 36, kNumFrequencyClasses}, 1);
  std::vector<double> coefficients(num_frames, 0.0);
  std::vector<int> previous(num_frames + 1, 0);  // magnitudes of the row before
  for (Eigen::Index k = 0; k < rows->rows(); ++k) {
    if (!coder->decoding()) transform.Forward(&rows->coeffRef(k, 0), coefficients.data());
    int last = 0, before_last = 0;
    for (int f = 0; f < num_frames; ++f) {
      int q = 0;
      if (!coder->decoding()) {
        const double scaled = std::fabs(coefficients[f]) / steps[k];
        if (!(scaled < kMaxQuantizedStep)) {
          return absl::InvalidArgumentError("the motion is too large for the quantization step");
        }
        q = static_cast<int>(scaled + kRounding);
        if (coefficients[f] < 0) q = -q;
      }
      const int near = (last * 2 + before_last) * 16 / 3;
      const int above = (previous[f] + previous[f + 1]) * 8;
      q = model.CodeSigned(
          coder, q,
          {MagnitudeClass(near) * 12 + MagnitudeClass(above),
           std::min(last, 5) * 6 + std::min(before_last, 5),
           std::min(f < 8 ? f : 8 + 2 * BitLengthClass(f / 8), kNumFrequencyClasses - 1)},
          0);
      coefficients[f] = q * steps[k];
      previous[f] = std::min(std::abs(q), 4096);
      before_last = last;
      last = previous[f];
    }
    if (coder->overrun()) return absl::DataLossError("the trajectories are cut off");
    transform.Inverse(coefficients.data(), &rows->coeffRef(k, 0));
  }
  return absl::OkStatus();
}

}  // namespace pleat
