#include "pleat/formats/edited_motion_file.h"

#include <nlohmann/json.hpp>

#include "formats/figure_character.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class EditedMotionFileTest : public testing::Test {
 protected:
  EditedMotionFileTest() {
    motion_.track = character_.track;
    history_.source = EncodeMotion(skeleton_, motion_.track);
    history_.edits = {
        {.kind = EditKind::kLimit, .joints = {"head", "all"}, .numbers = {{90}, {10}}},
        {.kind = EditKind::kConcatenate, .numbers = {{.5}}, .other = history_.source},
        {.kind = EditKind::kTimeWarp, .numbers = {{0, .5}, {0, 1.5}}}};
    text_ = EncodeEditedMotion(skeleton_, motion_, history_);
  }

  const CharacterFile character_ = FigureCharacter(3);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  Motion motion_;
  EditHistory history_;
  std::string text_;
};

TEST_F(EditedMotionFileTest, TheHistoryComesBack) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const EditHistory back, DecodeEditHistory(text_));
  EXPECT_EQ(back.source, history_.source);
  ASSERT_EQ(back.edits.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back.edits[i].kind, history_.edits[i].kind);
    EXPECT_EQ(back.edits[i].joints, history_.edits[i].joints);
    EXPECT_EQ(back.edits[i].numbers, history_.edits[i].numbers);
    EXPECT_EQ(back.edits[i].other, history_.edits[i].other);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::optional<Skeleton> skeleton, DecodeMotionSkeleton(text_));
  ASSERT_TRUE(skeleton.has_value());
  EXPECT_EQ(skeleton->RestPositions(), skeleton_.RestPositions());
  EXPECT_EQ(EncodeEditedMotion(*skeleton, motion_, back), text_);
}

TEST_F(EditedMotionFileTest, AFileWithoutEditsIsItsOwnSource) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const EditHistory history, DecodeEditHistory(history_.source));
  EXPECT_EQ(history.source, history_.source);
  EXPECT_TRUE(history.edits.empty());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::optional<Skeleton> none,
                             DecodeMotionSkeleton(history_.source));
  EXPECT_FALSE(none.has_value());
}

TEST_F(EditedMotionFileTest, MistakesInEditsAreNamed) {
  const auto expect = [&](auto damage, const char* reason) {
    json root = json::parse(text_);
    damage(root);
    EXPECT_THAT(DecodeEditHistory(root.dump()), HasStatus(kInvalid, HasSubstr(reason)));
  };
  expect([](json& r) { r["edits"] = json::array(); }, "'edits' must list edits");
  expect([](json& r) { r.erase("source"); }, "'source' must be a text");
  expect([](json& r) { r["edits"][1] = 3; }, "edits[1]: an edit must be an object");
  expect([](json& r) { r["edits"][0]["edit"] = "melt\n"; },
         "edits[0]: there is no edit 'melt\\x0a'");
  expect([](json& r) { r["edits"][0].erase("joints"); }, "edits[0]: field 'joints'");
  expect([](json& r) { r["edits"][0]["joints"] = json::array(); }, "limit: 'joints' is empty");
  expect([](json& r) { r["edits"][0]["joints"][0] = 1; }, "names only");
  expect([](json& r) { r["edits"][0].erase("swing_degrees"); }, "'swing_degrees' is missing");
  expect([](json& r) { r["edits"][0]["swing_degrees"] = 181; }, "outside 0 to 180");
  expect([](json& r) { r["edits"][0]["swing_degrees"] = {1, 2}; }, "has 2 numbers in place of 1");
  expect([](json& r) { r["edits"][0]["swing_degrees"] = {"a"}; }, "must hold numbers");
  expect([](json& r) { r["edits"][1].erase("motion"); }, "'motion' must be a text");
  expect([](json& r) { r["edits"][1]["motion"] = ""; }, "'motion' is missing");
}

TEST_F(EditedMotionFileTest, MistakesInTheSkeletonAreNamed) {
  const auto expect = [&](auto damage, const char* reason) {
    json root = json::parse(text_);
    damage(root["skeleton"]);
    EXPECT_THAT(DecodeMotionSkeleton(root.dump()), HasStatus(kInvalid, HasSubstr(reason)));
  };
  expect([](json& s) { s = json::array(); }, "1 to 4096 joints");
  expect([](json& s) { s[2] = 1; }, "skeleton[2]: must be an object");
  expect([](json& s) { s[2].erase("parent"); }, "skeleton[2]: needs 'parent'");
  expect([](json& s) { s[2]["parent"] = 2; }, "an earlier joint");
  expect([](json& s) { s[2]["parent"] = -9'000'000'000; }, "an earlier joint");
  expect([](json& s) { s[2]["rest_position"] = {1, 2}; }, "three numbers");
  expect([](json& s) { s[2]["rest_position"][1] = "1"; }, "must hold numbers");
  expect([](json& s) { s[2]["name"] = s[1]["name"]; }, "skeleton");
}

TEST_F(EditedMotionFileTest, LimitsAreKept) {
  json root = json::parse(text_);
  root["edits"] = json(1001, json{{"edit", "mirror"}});
  EXPECT_THAT(DecodeEditHistory(root.dump()),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("1001 edits")));
  EXPECT_THAT(DecodeEditHistory(text_, {.max_document_bytes = 100}),
              HasStatus(absl::StatusCode::kResourceExhausted, AllOf(HasSubstr("limit is 100"))));
  EXPECT_THAT(DecodeEditHistory(std::string(1000, '[')),
              HasStatus(kInvalid, HasSubstr("too deep")));
}

TEST_F(EditedMotionFileTest, DamagedFilesAreRefusedOrRead) {
  history_.edits.resize(1);
  history_.source = "{}";
  const std::string text = EncodeEditedMotion(skeleton_, motion_, history_);
  size_t step = 0;
  const auto decode = [&](const std::string& damaged) {
    if (++step % 7 != 0) return;
    (void)DecodeEditHistory(damaged);
    (void)DecodeMotionSkeleton(damaged);
  };
  ForEachTruncation(text, decode);
  ForEachCorruption(text, decode);
}

}  // namespace
}  // namespace pleat
