#include "regional_section.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

#include "model_versions.h"
#include "support/hostile_bytes.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

constexpr uint32_t kNow = kModelFileVersion;

RegionalGpParameters Parameters() {
  RegionalGpParameters p;
  p.input_mean = RandomMatrix(4, 1, 1).col(0);
  p.input_scales = Eigen::VectorXd::LinSpaced(4, 1, 2);
  p.inputs = RandomMatrix(6, 4, 2).cast<float>().cast<double>();
  p.output_mean = RandomMatrix(5, 1, 3).col(0);
  p.regions.resize(2);
  p.regions[0] = {.scales = {{{0, 1}, .5, 1.5, .25, 3}, {{2, 3}, 2, .5, 0}},
                  .bias = .125,
                  .alpha = RandomMatrix(6, 3, 4).cast<float>(),
                  .first_output = 0};
  p.regions[1] = {.scales = {{{0, 1, 2, 3}, 1, 1, .5, 7}},
                  .bias = 0,
                  .alpha = RandomMatrix(6, 2, 5).cast<float>(),
                  .first_output = 3};
  return p;
}

std::string Written(const RegionalGpParameters& p) {
  ByteWriter writer;
  WriteRegional(p, &writer);
  return writer.Release();
}

absl::StatusOr<RegionalGpParameters> Read(const std::string& bytes) {
  ByteReader reader(bytes);
  return ReadRegional(&reader, kNow);
}

TEST(RegionalSectionTest, RegionsRoundTrip) {
  const RegionalGpParameters p = Parameters();
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGpParameters back, Read(Written(p)));
  EXPECT_EQ(back.inputs, p.inputs);
  EXPECT_EQ(back.output_mean, p.output_mean);
  ASSERT_EQ(back.regions.size(), 2u);
  for (size_t r = 0; r < 2; ++r) {
    EXPECT_EQ(back.regions[r].alpha, p.regions[r].alpha);
    EXPECT_EQ(back.regions[r].first_output, p.regions[r].first_output);
    for (size_t s = 0; s < p.regions[r].scales.size(); ++s) {
      EXPECT_EQ(back.regions[r].scales[s].columns, p.regions[r].scales[s].columns);
      EXPECT_EQ(back.regions[r].scales[s].max_norm, p.regions[r].scales[s].max_norm);
    }
  }
}

// Models of before version 4 have rows that no float says exactly; they must not be rounded.
TEST(RegionalSectionTest, RowsAreFloatsOnlyWhereThatIsExact) {
  RegionalGpParameters p = Parameters();
  const size_t as_floats = Written(p).size();
  p.inputs(2, 1) = .1;
  const std::string bytes = Written(p);
  EXPECT_EQ(bytes.size(), as_floats + 6 * 4 * sizeof(float));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RegionalGpParameters back, Read(bytes));
  EXPECT_EQ(back.inputs, p.inputs);
}

TEST(RegionalSectionTest, OutputsBeyondTheirNumberAreRefused) {
  RegionalGpParameters p = Parameters();
  p.regions[1].first_output = 4;
  EXPECT_THAT(Read(Written(p)), HasStatus(absl::StatusCode::kInvalidArgument,
                                          HasSubstr("2 outputs from 4 on, of 5")));
}

TEST(RegionalSectionTest, TruncationsAreRefusedAndDamageIsReadOrRefused) {
  const std::string bytes = Written(Parameters());
  ForEachTruncation(bytes, [](const std::string& cut) { EXPECT_FALSE(Read(cut).ok()); });
  ForEachCorruption(bytes, [](const std::string& damaged) {
    const auto read = Read(damaged);
    if (read.ok()) (void)RegionalGp::FromParameters(*read);
  });
}

std::vector<CoefficientFoldBlock> Fold() {
  const auto block = [](int first_input, std::vector<CoefficientFoldBlock::Target> targets,
                        const Eigen::MatrixXd& weights) {
    return CoefficientFoldBlock::Round(first_input, std::move(targets), weights,
                                       Eigen::VectorXd::Constant(weights.cols(), .01))
        .value();
  };
  return {block(0, {{2, 2}}, RandomMatrix(2, 3, 1)),
          block(3, {{0, 1}, {1, 3}}, RandomMatrix(4, 1, 2)),
          block(1, {{0, 4}}, Eigen::MatrixXd::Zero(4, 2))};
}

TEST(RegionalSectionTest, FoldsRoundTripAndHostileOnesAreRefused) {
  const std::vector<CoefficientFoldBlock> fold = Fold();
  ByteWriter writer;
  WriteFold(fold, &writer);
  const std::string bytes = writer.Release();
  const auto read = [](const std::string& from) {
    ByteReader reader(from);
    return ReadFold(&reader, kNow);
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<CoefficientFoldBlock> back, read(bytes));
  ASSERT_EQ(back.size(), 3u);
  EXPECT_EQ(back[1].first_input, 3);
  EXPECT_EQ(back[1].targets[1].count, 3);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(back[i].Dense(), fold[i].Dense()) << i;
  ForEachTruncation(bytes, [&](const std::string& cut) { EXPECT_FALSE(read(cut).ok()); });
  ForEachCorruption(bytes, [&](const std::string& damaged) {
    auto blocks = read(damaged);
    if (blocks.ok()) (void)CoefficientFold::FromBlocks(*std::move(blocks), 4, 4);
  });
}

// A block without planes takes no bytes for its outputs, so their number has a limit of its own.
TEST(RegionalSectionTest, AFoldOfMoreOutputsThanAModelHasIsRefused) {
  ByteWriter writer;
  for (const uint32_t number : {1u, 0u, 1u, 0u, 1u << 29, 2u, 0u}) writer.Write(number);
  const std::string bytes = writer.Release();
  ByteReader reader(bytes);
  EXPECT_THAT(ReadFold(&reader, kNow),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("536870912 outputs")));
}

}  // namespace
}  // namespace pleat
