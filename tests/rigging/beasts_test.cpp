// Animals, things and parts of bodies: none is taken for a human without a word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <string>

#include "pleat/rigging/auto_rig.h"
#include "support/capsule_beasts.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class BeastTest : public ::testing::TestWithParam<Beast> {};

// One that stands on its hind legs comes near to a human: there a warning will do.
TEST_P(BeastTest, IsRefusedOrWarnedOf) {
  AutoRigSummary summary;
  const absl::StatusOr<Rig> rig = AutoRig(
      MakeStillSequence(MakeCapsuleBody(GetParam().parts, GetParam().cell_m)), {}, &summary);
  if (!GetParam().rears) {
    EXPECT_THAT(rig, HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("own rig")));
  } else if (rig.ok()) {
    EXPECT_GT(summary.residual, 1.5 * AutoRigOptions().trusted_residual);
    EXPECT_THAT(summary.warnings, Contains(HasSubstr("look at the rig")));
  }
}

INSTANTIATE_TEST_SUITE_P(Beasts, BeastTest, ::testing::ValuesIn(CapsuleBeasts()),
                         [](const auto& instance) {
                           std::string name;
                           for (const char c : instance.param.name) {
                             if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
                           }
                           return name;
                         });

}  // namespace
}  // namespace pleat
