#include "field_coder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "integer_model.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kMaxLevelClass = 15, kNumComponentClasses = 200;
constexpr int kBlockColumns = 8 * 3;
constexpr float kMaxQuantized = 1 << 26;
constexpr size_t kVerticesPerReport = 256;  // some milliseconds

// 0 .. 15, twice the logarithm of 1 + k.
int ComponentClass(int k) {
  int bits = 0;
  while ((k + 1) >> (bits + 1) != 0) ++bits;
  const bool upper_half = bits > 0 && ((k + 1) >> (bits - 1) & 1) != 0;
  return std::min(15, 2 * bits + upper_half);
}

class FieldWalk {
 public:
  FieldWalk(const SurfaceHierarchy& hierarchy, float step, BinaryCoder* coder, FieldMatrix* fields)
      : hierarchy_(hierarchy),
        step_(step),
        coder_(coder),
        fields_(*fields),
        num_columns_(static_cast<int>(fields->cols())),
        magnitudes_(static_cast<size_t>(fields->rows()) * num_columns_),
        around_(num_columns_),
        quantized_(num_columns_, 0),
        blocks_({12 * 12, 32 * 16, 8 * 12}, 1),
        values_({12 * 12, 12 * 12 * 3, 16 * 16, 12 * 3, kNumComponentClasses * 2}, 12) {}

  absl::Status Run(const Progress& progress) {
    size_t num_done = 0;
    const size_t num_vertices = hierarchy_.order().size();
    for (const int v : hierarchy_.order()) {
      if (num_done++ % kVerticesPerReport == 0) {
        PLEAT_RETURN_IF_ERROR(
            progress.Report(static_cast<double>(num_done) / static_cast<double>(num_vertices)));
      }
      SumNeighbors(v);
      if (!coder_->decoding() && !QuantizeRow(v)) {
        return absl::InvalidArgumentError(absl::StrCat("vertex ", v,
                                                       " moves too far for a quantization step of ",
                                                       step_ * 1e3, " mm; ask for a larger error"));
      }
      CodeRow(v);
      DequantizeRow(v);
      if (coder_->overrun()) return absl::DataLossError("the coefficients are cut off");
    }
    return absl::OkStatus();
  }

 private:
  uint8_t* Magnitudes(int v) { return magnitudes_.data() + static_cast<size_t>(v) * num_columns_; }

  // around_[column] = magnitudes of that column at the coarser neighbors.
  void SumNeighbors(int v) {
    std::fill(around_.begin(), around_.end(), 0);
    for (const int n : hierarchy_.neighbors(v)) {
      const uint8_t* row = Magnitudes(n);
      for (int i = 0; i < num_columns_; ++i)
        around_[i] = static_cast<uint16_t>(around_[i] + row[i]);
    }
  }

  // Encoder: the row as integers; false when one is too large.
  bool QuantizeRow(int v) {
    const float cell = step_ / hierarchy_.weight(v);
    const float* row = &fields_.coeffRef(v, 0);
    for (int i = 0; i < num_columns_; ++i) {
      const float scaled = std::fabs(row[i]) / cell;
      if (!(scaled < kMaxQuantized)) return false;
      const int q = static_cast<int>(scaled + kRounding);
      quantized_[i] = row[i] < 0 ? -q : q;
    }
    return true;
  }

  void DequantizeRow(int v) {
    const float cell = step_ / hierarchy_.weight(v);
    float* row = &fields_.coeffRef(v, 0);
    for (int i = 0; i < num_columns_; ++i) {
      const int q = quantized_[i];
      const float magnitude = static_cast<float>(std::abs(q)) - kCellShift;
      row[i] = q == 0 ? 0 : (q < 0 ? -magnitude : magnitude) * cell;
    }
  }

  // Blocks of components, first whether anything in them is not zero.
  void CodeRow(int v) {
    std::array<int, 3> last = {0, 0, 0};  // magnitudes of the components before, latest first
    const int num_neighbors = std::max<int>(1, static_cast<int>(hierarchy_.neighbors(v).size()));
    const int level = std::min(hierarchy_.level(v), kMaxLevelClass);
    uint8_t* own = Magnitudes(v);
    int history = 7;  // which of the last blocks had something
    for (int begin = 0; begin < num_columns_; begin += kBlockColumns) {
      const int end = std::min(begin + kBlockColumns, num_columns_);
      int around = 0;
      bool any = false;
      for (int i = begin; i < end; ++i) around += around_[i];
      for (int i = begin; i < end && !coder_->decoding(); ++i) any = any || quantized_[i] != 0;
      const int near = MagnitudeClass(around * 4 / num_neighbors);
      const int before = MagnitudeClass((last[0] * 2 + last[1] + last[2]) * 4);
      any = blocks_.CodeUnsigned(
          coder_, any,
          {near * 12 + before, std::min(begin / kBlockColumns, 31) * 16 + level,
           history * 12 + near},
          0);
      history = (history << 1 | any) & 7;
      if (!any) {
        std::fill(quantized_.begin() + begin, quantized_.begin() + end, 0);
        std::fill(own + begin, own + end, 0);
        last = {0, 0, 0};
        continue;
      }
      for (int at = begin; at < end; at += 3) {
        const int sum = CodeComponent(at, num_neighbors, level, last, own + at);
        last = {sum, last[0], last[1]};
      }
    }
  }

  // Three coordinates; returns the sum of their magnitudes.
  int CodeComponent(int at, int num_neighbors, int level, const std::array<int, 3>& last,
                    uint8_t* own) {
    const int k = at / 3;
    const int around = around_[at] + around_[at + 1] + around_[at + 2];
    // Means in 1/16; the weights fall with the distance of the component.
    const int before = (last[0] * 10 + last[1] * 7 + last[2] * 5) * 16 / 66;
    const int before_class = MagnitudeClass(before);
    int sum = 0;
    for (int c = 0; c < 3; ++c) {
      const int near = (around + around_[at + c]) * 4 / num_neighbors;
      const int siblings = sum * 16 / std::max(c, 1);
      const int near_class = MagnitudeClass(near);
      const int mixed = MagnitudeClass((4 * near + 4 * before + 3 * siblings) / 10);
      const int set = MagnitudeClass((4 * near + 6 * before + 3 * siblings) / 10);
      const int q = values_.CodeSigned(
          coder_, quantized_[at + c],
          {near_class * 12 + before_class, (MagnitudeClass(siblings) * 12 + near_class) * 3 + c,
           ComponentClass(k) * 16 + level, mixed * 3 + c,
           std::min(k, kNumComponentClasses - 1) * 2 + (level < 2)},
          set);
      quantized_[at + c] = q;
      own[c] = static_cast<uint8_t>(std::min(std::abs(q), 255));
      sum += own[c];
    }
    return sum;
  }

  const SurfaceHierarchy& hierarchy_;
  const float step_;
  BinaryCoder* coder_;
  FieldMatrix& fields_;
  const int num_columns_;
  std::vector<uint8_t> magnitudes_;
  std::vector<uint16_t> around_;
  std::vector<int> quantized_;  // the row at hand
  IntegerModel<3> blocks_;
  IntegerModel<5> values_;
};

}  // namespace

absl::Status CodeFields(const SurfaceHierarchy& hierarchy, float step, BinaryCoder* coder,
                        FieldMatrix* fields, const Progress& progress) {
  if (fields->cols() == 0) return absl::OkStatus();  // rigid motion
  if (!coder->decoding()) hierarchy.Analyze(fields);
  const absl::Status status = FieldWalk(hierarchy, step, coder, fields).Run(progress);
  if (status.ok()) hierarchy.Synthesize(fields);
  return status;
}

}  // namespace pleat
