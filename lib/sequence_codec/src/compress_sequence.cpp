#include "pleat/sequence_codec/compress_sequence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "compressed_format.h"
#include "pleat/base/status.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "sequence_encoder.h"
#include "trial_progress.h"

namespace pleat {
namespace {

constexpr int kMaxTrials = 12;
constexpr int kNumFactors = 2;  // 2 and its root, by which the step of the motion is changed
// What the progress expects of the time, measured on captured and made-up sequences: the share that
// is over after the analysis and before the last check, for each kind of goal.
struct TimeShares {
  double analyzed, encoded;
};
constexpr TimeShares kKgShares = {.22, .95}, kBoundShares = {.06, .91};
constexpr double kUsualKgTrials = 5, kUsualTrialsPerDirection = 1.5;
constexpr double kEncodingShare = .7;  // of a trial for a KG error; the rest decodes and compares

TimeShares SharesOf(CompressionGoal goal) {
  return goal == CompressionGoal::kKg ? kKgShares : kBoundShares;
}

absl::Status CheckRange(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(name, " is ", value, ", allowed are ", low, " to ", high));
}

// The extent of all frames.
struct Extent {
  Eigen::Vector3d low, high;
  double squared_spread = 0;  // sum of squared distances to the centroid of each frame

  explicit Extent(const MeshSequence& sequence) {
    low.setConstant(std::numeric_limits<double>::infinity());
    high = -low;
    for (int t = 0; t < sequence.num_frames(); ++t) {
      const Eigen::Matrix3Xd frame = sequence.FrameAsDouble(t);
      low = low.cwiseMin(frame.rowwise().minCoeff());
      high = high.cwiseMax(frame.rowwise().maxCoeff());
      const Eigen::Vector3d center = frame.rowwise().mean();
      squared_spread += (frame.colwise() - center).squaredNorm();
    }
  }
  // Coordinates are large against the size, so that little of float32 is left for the shape.
  bool IsFar() const {
    const double size = (high - low).maxCoeff();
    return size > 0 && Largest() > 8 * size;
  }
  // The middle, in float32.
  Eigen::Vector3d Middle() const { return ((low + high) / 2).cast<float>().cast<double>(); }
  double Largest() const { return std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()); }
};

struct Measured {
  double kg_percent = 0, max_error_m = 0;
};

absl::StatusOr<Measured> Measure(const MeshSequence& sequence, const std::string& bytes,
                                 const Extent& extent, const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(SequenceDecoder decoder, SequenceDecoder::Open(bytes));
  double sum = 0, largest = 0;
  PLEAT_RETURN_IF_ERROR(decoder.Decode(
      0, sequence.num_frames(),
      [&](int t, const Eigen::Matrix3Xf& positions) {
        const Eigen::RowVectorXd squares =
            (positions.cast<double>() - sequence.FrameAsDouble(t)).colwise().squaredNorm();
        sum += squares.sum();
        largest = std::max(largest, squares.maxCoeff());
        return absl::OkStatus();
      },
      progress));
  const double spread = std::max(extent.squared_spread, 1e-300);
  return Measured{100 * std::sqrt(sum / spread), std::sqrt(largest)};
}

// How many trials are to come until a KG error is as near to the aim as it has to be. miss, before:
// how far the last trial and the one before it were off, as logarithms; before is 0 at first.
double ExpectedKgTrials(double miss, double before) {
  constexpr double kHit = .005, kUsualRate = .2;
  // The last step rarely hits at once, hence what is added.
  constexpr double kAdded = .7, kFewest = 1.6;
  const double rate = before > 0 ? std::clamp(miss / before, .05, .7) : kUsualRate;
  return std::max(kFewest, std::log(std::max(miss, kHit) / kHit) / -std::log(rate) + kAdded);
}

// The largest step whose error is at most the goal's, to some percent: regula falsi on logarithms.
absl::StatusOr<std::string> EncodeForKg(const SequenceEncoder& encoder,
                                        const MeshSequence& sequence, const Extent& extent,
                                        double kg_percent, const Progress& progress) {
  if (!(extent.squared_spread > 0)) {
    return absl::InvalidArgumentError(
        "the sequence has no extent: a KG error is not defined for it");
  }
  const double num_values = static_cast<double>(sequence.num_vertices()) * sequence.num_frames();
  double step_m = 15 * kg_percent / 100 * std::sqrt(extent.squared_spread / num_values);
  double below = 0, above = 0, kg_below = 0, kg_above = 0;  // steps with too small, too large error
  std::string best;
  TrialProgress trials(progress);
  double num_expected = kUsualKgTrials, last_miss = 0;
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    const Progress part = trials.Next("encode", num_expected);
    PLEAT_ASSIGN_OR_RETURN(std::string bytes,
                           encoder.Encode(step_m, {}, PartOf(part, 0, kEncodingShare)));
    PLEAT_ASSIGN_OR_RETURN(const Measured measured,
                           Measure(sequence, bytes, extent, PartOf(part, kEncodingShare, 1)));
    if (measured.kg_percent <= kg_percent) {
      below = step_m;
      kg_below = measured.kg_percent;
      best = std::move(bytes);
      if (kg_below > 0.99 * kg_percent) break;
    } else {
      above = step_m;
      kg_above = measured.kg_percent;
    }
    const double aim = std::log(0.995 * kg_percent);
    const double miss = std::abs(std::log(std::max(measured.kg_percent, 1e-9)) - aim);
    num_expected = ExpectedKgTrials(miss, last_miss);
    last_miss = miss;
    if (below > 0 && above > 0) {
      if (above < 1.002 * below) break;
      const double share = (aim - std::log(std::max(kg_below, 1e-9))) /
                           (std::log(kg_above) - std::log(std::max(kg_below, 1e-9)));
      step_m = below * std::pow(above / below, std::clamp(share, 0.1, 0.9));
    } else {  // the error grows with about the power .8 of the step
      const double ratio = std::exp(aim) / std::max(measured.kg_percent, 1e-9);
      step_m *= std::pow(std::clamp(ratio, 0.1, 10.0), 1.2);
    }
  }
  if (best.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "a KG error of ", kg_percent, " % cannot be reached in float32; ask for a larger one"));
  }
  return best;
}

// The step of the motion model that makes model and residuals together smallest.
absl::StatusOr<std::string> EncodeSmallest(const SequenceEncoder& encoder, const ResidualGrid& grid,
                                           double step_m, const Progress& progress) {
  int num_trials = 0;
  // Each direction ends with a trial that is no better, after a few that are.
  double num_directions = 2 * kNumFactors;
  TrialProgress trials(progress);
  const auto encode = [&](double step) {
    const double num_expected = num_directions * kUsualTrialsPerDirection + (num_trials == 0);
    ++num_trials;
    return encoder.Encode(step, grid, trials.Next("encode", num_expected));
  };
  PLEAT_ASSIGN_OR_RETURN(std::string best, encode(step_m));
  double factor = 2;
  for (int k = 0; k < kNumFactors && num_trials < kMaxTrials; ++k, factor = std::sqrt(factor)) {
    for (const double direction : {factor, 1 / factor}) {
      bool better = true;
      while (better && num_trials < kMaxTrials) {
        absl::StatusOr<std::string> trial = encode(step_m * direction);
        if (absl::IsCancelled(trial.status())) return trial.status();
        better = trial.ok() && trial->size() < best.size();
        if (!better) break;
        best = *std::move(trial);
        step_m *= direction;
      }
      --num_directions;
    }
  }
  return best;
}

// Distance of neighboring float32 numbers of that size.
double Ulp(double value) { return std::ldexp(1, std::ilogb(std::max(value, 1e-30)) - 23); }

absl::StatusOr<std::string> EncodeForMaxError(const SequenceEncoder& encoder, const Extent& extent,
                                              double bound_m, const Progress& progress) {
  // Decoded coordinates are rounded to float32, each by at most half an ulp.
  const double margin = 1.1 * Ulp(extent.Largest());
  if (bound_m < 8 * margin) {
    return absl::InvalidArgumentError(
        absl::StrCat("an error of ", bound_m * 1e3, " mm is below what float32 positions of ",
                     extent.Largest(), " m can keep; ask for ", 8e3 * margin, " mm or more"));
  }
  ResidualGrid grid;
  grid.kind = ResidualKind::kCorrection;
  grid.bound_m = bound_m - margin;
  grid.step_m = 2 * grid.bound_m / std::sqrt(3.0) * (1 - 1e-9);
  return EncodeSmallest(encoder, grid, 8 * bound_m, progress);
}

// origin_m: of the encoded positions.
ResidualGrid GridOf(const Extent& extent, int bits, const Eigen::Vector3d& origin_m) {
  ResidualGrid grid;
  grid.kind = ResidualKind::kGrid;
  grid.origin_m = extent.low - origin_m;
  grid.step_m = std::max((extent.high - extent.low).maxCoeff(), 1e-6) / ((1 << bits) - 1);
  return grid;
}

absl::StatusOr<std::string> EncodeForGoal(const SequenceEncoder& encoder,
                                          const MeshSequence& sequence, const Extent& extent,
                                          const CompressOptions& options,
                                          const Eigen::Vector3d& origin_m,
                                          const Progress& progress) {
  if (options.goal == CompressionGoal::kKg) {
    return EncodeForKg(encoder, sequence, extent, options.kg_percent, progress);
  }
  if (options.goal == CompressionGoal::kMaxError) {
    return EncodeForMaxError(encoder, extent, options.max_error_mm * 1e-3, progress);
  }
  const ResidualGrid grid = GridOf(extent, options.grid_bits, origin_m);
  return EncodeSmallest(encoder, grid, 4 * grid.step_m, progress);
}

struct Encoded {
  std::string bytes;
  uint64_t num_topology_bytes = 0;
};

// Encodes the positions minus origin_m, which the file holds.
absl::StatusOr<Encoded> EncodeAround(const Eigen::Vector3d& origin_m, const MeshSequence& sequence,
                                     const Extent& extent, const CompressOptions& options,
                                     const Progress& progress) {
  std::optional<MeshSequence> moved;
  if (!origin_m.isZero(0)) {
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < sequence.num_frames(); ++t) {
      frames.emplace_back((sequence.FrameAsDouble(t).colwise() - origin_m).cast<float>());
    }
    PLEAT_ASSIGN_OR_RETURN(
        moved,
        MeshSequence::Create(sequence.topology(), std::move(frames),
                             {sequence.name(), sequence.frame_rate(), sequence.appearance(), {}}));
  }
  const MeshSequence& encoded = moved ? *moved : sequence;
  const TimeShares shares = SharesOf(options.goal);
  const double analyzed = shares.analyzed / shares.encoded;  // of the encoding without the check
  PLEAT_ASSIGN_OR_RETURN(
      SequenceAnalysis analysis,
      AnalyzeSequence(encoded, options.num_threads, progress.Stage("analyse", 0, analyzed)));
  const SequenceEncoder encoder(encoded, std::move(analysis), origin_m, options.keep_face_order,
                                options.num_threads);
  Encoded result;
  PLEAT_ASSIGN_OR_RETURN(result.bytes, EncodeForGoal(encoder, sequence, extent, options, origin_m,
                                                     progress.Stage("encode", analyzed, 1)));
  result.num_topology_bytes = encoder.topology_bytes();
  return result;
}

// The promise, on what a decoder gives.
absl::Status CheckPromise(const CompressOptions& options, const Measured& measured,
                          const Extent& extent) {
  double bound_m = std::numeric_limits<double>::infinity();
  if (options.goal == CompressionGoal::kMaxError) bound_m = options.max_error_mm * 1e-3;
  if (options.goal == CompressionGoal::kGrid) {
    const double step_m = GridOf(extent, options.grid_bits, Eigen::Vector3d::Zero()).step_m;
    bound_m = std::sqrt(0.75) * step_m + 2 * Ulp(extent.Largest());
  }
  if (measured.max_error_m <= bound_m) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("the decoded sequence is wrong by ",
                                          measured.max_error_m * 1e3, " mm, promised were ",
                                          bound_m * 1e3, " mm; nothing was written"));
}

}  // namespace

absl::Status ValidateCompressOptions(const CompressOptions& options) {
  switch (options.goal) {
    case CompressionGoal::kMaxError:
      return CheckRange("max_error_mm", options.max_error_mm, 1e-3, 1e6);
    case CompressionGoal::kKg:
      return CheckRange("kg_percent", options.kg_percent, 1e-4, 50);
    case CompressionGoal::kGrid:
      return CheckRange("grid_bits", options.grid_bits, 8, 20);
  }
  return absl::InvalidArgumentError("unknown goal of compression");
}

absl::StatusOr<std::string> CompressSequence(const MeshSequence& sequence,
                                             const CompressOptions& options,
                                             CompressSummary* summary, const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(ValidateCompressOptions(options));
  const Extent extent(sequence);
  const TimeShares shares = SharesOf(options.goal);
  const Progress forward = progress.ForwardOnly();
  absl::StatusOr<Encoded> encoded = EncodeAround(Eigen::Vector3d::Zero(), sequence, extent, options,
                                                 forward.Stage("", 0, shares.encoded));
  // Where the sequence lies cannot be quantized as finely as its shape: that is subtracted first.
  // Mostly this shows in the first trial, right after the analysis.
  if (absl::IsInvalidArgument(encoded.status()) && extent.IsFar()) {
    encoded = EncodeAround(extent.Middle(), sequence, extent, options,
                           forward.Stage("", shares.analyzed, shares.encoded));
  }
  PLEAT_RETURN_IF_ERROR(encoded.status());
  const std::string& bytes = encoded->bytes;
  PLEAT_ASSIGN_OR_RETURN(
      const Measured measured,
      Measure(sequence, bytes, extent, forward.Stage("check", shares.encoded, 1)));
  PLEAT_RETURN_IF_ERROR(CheckPromise(options, measured, extent));
  if (summary != nullptr) {
    const double num_values = static_cast<double>(sequence.num_vertices()) * sequence.num_frames();
    summary->num_bytes = bytes.size();
    summary->num_topology_bytes = encoded->num_topology_bytes;
    summary->bpvf = 8.0 * static_cast<double>(bytes.size()) / num_values;
    summary->bpvf_without_topology =
        8.0 * static_cast<double>(bytes.size() - encoded->num_topology_bytes) / num_values;
    summary->kg_percent = measured.kg_percent;
    summary->max_error_mm = measured.max_error_m * 1e3;
  }
  return std::move(encoded->bytes);
}

}  // namespace pleat
