// What compression tells about its progress: it never goes back, and whoever extrapolates it after
// a quarter of the time is told about when it ends.
#include <gtest/gtest.h>

#include <ctime>
#include <vector>

#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "sequence_codec/compressed_clip.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// Processor time, which other processes do not lengthen.
double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct ProgressPoint {
  double seconds, fraction;
};

// Every report of a compression on one thread, and its end as the last point.
std::vector<ProgressPoint> WatchCompression(const MeshSequence& sequence, CompressOptions options) {
  options.num_threads = 1;
  std::vector<ProgressPoint> points;
  const double start = CpuSeconds();
  const Progress progress(
      [&](const ProgressUpdate& update) {
        points.push_back({CpuSeconds() - start, update.fraction});
      },
      nullptr);
  EXPECT_THAT(CompressSequence(sequence, options, nullptr, progress), IsOk());
  points.push_back({CpuSeconds() - start, 1});
  return points;
}

const CompressOptions kGoals[] = {{.goal = CompressionGoal::kKg, .kg_percent = 1},
                                  {.max_error_mm = 1},
                                  {.goal = CompressionGoal::kGrid, .grid_bits = 12}};

TEST(CompressProgressTest, NeverGoesBackAndReachesTheEnd) {
  const MeshSequence near = MakeWavingTorus(24, 12, 40);
  std::vector<Eigen::Matrix3Xf> moved;
  for (int t = 0; t < near.num_frames(); ++t) {
    moved.emplace_back(near.frame(t).colwise() + Eigen::Vector3f(3e4f, 0, 0));
  }
  // Far from the origin the first attempt is given up.
  const MeshSequence far = *MeshSequence::Create(near.topology(), std::move(moved));
  const MeshSequence several_segments = MakeWavingTorus(8, 6, 1100);
  for (const MeshSequence* sequence : {&near, &far, &several_segments}) {
    for (const CompressOptions& options : kGoals) {
      if (sequence == &far && options.goal == CompressionGoal::kMaxError) continue;  // no float32
      const std::vector<ProgressPoint> points = WatchCompression(*sequence, options);
      ASSERT_GT(points.size(), 20u);
      for (size_t i = 1; i < points.size(); ++i) {
        ASSERT_GE(points[i].fraction, points[i - 1].fraction - 1e-12) << i;
      }
      EXPECT_NEAR(points[points.size() - 2].fraction, 1, 1e-9);
    }
  }
}

// The end that a bar predicts by extrapolation, not what is left: before the end of a search that
// succeeds early, any ratio of what is left may come out.
TEST(CompressProgressTest, AfterAQuarterOfTheTimeThePredictedEndIsOfTheRightSize) {
  const MeshSequence sequence = MakeWavingTorus(96, 48, 120);
  for (const CompressOptions& options : kGoals) {
    // How many trials a KG error takes is not known: 3 to 5 in captures, 8 at worst, fewer here.
    const double factor = options.goal == CompressionGoal::kKg ? 4 : 2;
    const std::vector<ProgressPoint> points = WatchCompression(sequence, options);
    const double end = points.back().seconds;
    int num_predictions = 0;
    for (const ProgressPoint& point : points) {
      if (point.seconds < .25 * end || point.seconds > .9 * end) continue;
      const double predicted_end = point.seconds / point.fraction;
      EXPECT_GT(predicted_end, end / factor)
          << static_cast<int>(options.goal) << " after " << point.seconds / end;
      EXPECT_LT(predicted_end, end * factor)
          << static_cast<int>(options.goal) << " after " << point.seconds / end;
      ++num_predictions;
    }
    EXPECT_GT(num_predictions, 20);
  }
}

TEST(CompressProgressTest, DecodingTellsOfItsFieldsAndFrames) {
  const MeshSequence sequence = MakeWavingTorus(24, 12, 600);  // two segments
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                             CompressSequence(sequence, {.max_error_mm = 1}, nullptr));
  PLEAT_ASSERT_OK_AND_ASSIGN(SequenceDecoder decoder, SequenceDecoder::Open(bytes));
  for (const auto& [begin, end] : {std::pair(0, 600), std::pair(250, 350), std::pair(17, 19)}) {
    double last = 0;
    int num_reports = 0;
    const Progress progress(
        [&](const ProgressUpdate& update) {
          EXPECT_GE(update.fraction, last);
          last = update.fraction;
          ++num_reports;
        },
        nullptr);
    EXPECT_THAT(
        decoder.Decode(
            begin, end, [](int, const Eigen::Matrix3Xf&) { return absl::OkStatus(); }, progress),
        IsOk());
    EXPECT_NEAR(last, 1, 1e-9) << begin;
    EXPECT_GT(num_reports, end - begin > 20 ? 8 : 0) << begin;
  }
}

}  // namespace
}  // namespace pleat
