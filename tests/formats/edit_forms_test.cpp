#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "pleat/formats/edited_motion_file.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(EditFormsTest, EveryKindHasItsFormAndANameOfItsOwn) {
  std::set<std::string_view> names;
  for (size_t i = 0; i < EditForms().size(); ++i) {
    EXPECT_EQ(static_cast<size_t>(EditForms()[i].kind), i);
    EXPECT_TRUE(names.insert(EditForms()[i].name).second);
  }
  EXPECT_EQ(FormOf(EditKind::kCleanFeet).name, "clean_feet");
  EXPECT_EQ(EditForms().size(), static_cast<size_t>(EditKind::kCleanFeet) + 1);
}

TEST(EditFormsTest, NumbersOutOfRangeAreRefusedAndLimitsTaken) {
  MotionEdit edit{.kind = EditKind::kDetail, .joints = {"all"}, .numbers = {{2}}};
  EXPECT_THAT(CheckEdit(edit), IsOk());
  for (const double number :
       {-.001, 2.001, std::nan(""), std::numeric_limits<double>::infinity()}) {
    edit.numbers = {{number}};
    EXPECT_THAT(CheckEdit(edit), HasStatus(kInvalid, testing::HasSubstr("outside 0 to 2")));
  }
  edit.numbers = {{}};
  EXPECT_THAT(CheckEdit(edit), HasStatus(kInvalid, testing::HasSubstr("'strength' is missing")));
  edit.numbers = {};
  EXPECT_THAT(CheckEdit(edit), HasStatus(kInvalid, testing::HasSubstr("'strength' is missing")));
}

}  // namespace
}  // namespace pleat
