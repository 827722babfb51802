// The training of the paper's learner against the check values of method.md section 7.
#include <gtest/gtest.h>

#include "gplvm_data.h"
#include "pleat/gp/shared_gplvm.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

SharedGplvmOptions CheckOptions() {
  SharedGplvmOptions options = SharedGplvmOptions::Paper();
  options.scaling = ViewScaling::kPerColumn;
  return options;
}

struct CheckValues {
  const char* name;
  double start, end;
};

class CheckValuesTest : public ::testing::TestWithParam<CheckValues> {};

TEST_P(CheckValuesTest, StartsAndEndsWhereItShould) {
  const std::string base = std::string("gplvm/") + GetParam().name;
  PLEAT_SHARED_DATA_OR_SKIP(poses_path, base + "_poses.csv");
  PLEAT_SHARED_DATA_OR_SKIP(details_path, base + "_details.csv");
  const Eigen::MatrixXd poses = ReadCsv(poses_path), details = ReadCsv(details_path);
  ASSERT_EQ(poses.cols(), 102);
  ASSERT_EQ(details.cols(), 1050);

  SharedGplvmSummary summary;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const SharedGplvm model,
      TrainSharedGplvm(poses, MakeDetailView(details, ViewScaling::kPerColumn), {0}, CheckOptions(),
                       &summary));
  const OptimizationSummary& run = summary.optimization;
  EXPECT_NEAR(run.initial_objective, GetParam().start, 1e-6 * std::abs(GetParam().start));
  // 100 chaotic steps: the last digits depend on the order of sums.
  EXPECT_LE(run.final_objective, GetParam().end + 2e-6 * std::abs(GetParam().end));
  EXPECT_EQ(run.iterations, 100);
  EXPECT_EQ(model.latents.rows(), poses.rows());
  RecordProperty("final_objective", std::to_string(run.final_objective));
  RecordProperty("evaluations", run.evaluations);
}

INSTANTIATE_TEST_SUITE_P(Gplvm, CheckValuesTest,
                         ::testing::Values(CheckValues{"n100", -54697.3351, -209938.4},
                                           CheckValues{"n200", -126350.5630, -447465.8},
                                           CheckValues{"n400", -275213.4752, -981195.9}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace pleat
