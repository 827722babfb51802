#include "request_target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::_;
using testing::ElementsAre;

TEST(RequestTargetTest, SplitsAndDecodes) {
  const auto target = ParseTarget("/rpc/JobService/Get%20Job?name=a%26b&x=1&flag&x=2");
  ASSERT_THAT(target, IsOk());
  EXPECT_THAT(target->segments, ElementsAre("rpc", "JobService", "Get Job"));
  EXPECT_EQ(target->query.at("name"), "a&b");
  EXPECT_EQ(target->query.at("x"), "2");
  EXPECT_EQ(target->query.at("flag"), "");
  EXPECT_THAT(ParseTarget("/")->segments, ElementsAre(""));
}

TEST(RequestTargetTest, RefusesWhatIsNoText) {
  for (const char* bad : {"", "rpc", "*", "http://host/", "/%", "/%4", "/%zz", "/%00", "/a?b=%0a",
                          "/%ff%fe", "/a%7f"}) {
    EXPECT_THAT(ParseTarget(bad), HasStatus(absl::StatusCode::kInvalidArgument, _)) << bad;
  }
  EXPECT_FALSE(ParseTarget("/" + std::string(9000, 'a')).ok());
  std::string deep, many = "/?";
  for (int i = 0; i < 40; ++i) {
    deep += "/a";
    many += absl::StrCat("k", i, "=1&");
  }
  EXPECT_FALSE(ParseTarget(deep).ok());
  EXPECT_FALSE(ParseTarget(many).ok());
}

TEST(RequestTargetTest, PathsStayInsideTheirFolder) {
  for (const char* good : {"take.pc2", "folder/frame 1.obj", "a/b/c/Größe.ply"}) {
    EXPECT_EQ(CheckRelativePath(good).value(), good);
  }
  for (const char* bad : {"", "/etc/passwd", "../up", "a/../../b", "a//b", ".hidden", "a/.b",
                          "a\\b", "a/", "nul\x01", "\xff", "a/b/c/d/e/f/g/h/i"}) {
    EXPECT_THAT(CheckRelativePath(bad), HasStatus(absl::StatusCode::kInvalidArgument, _)) << bad;
  }
  EXPECT_FALSE(CheckRelativePath(std::string(300, 'a')).ok());
}

// Whatever comes, what is let in has no way out of the folder and no byte that a file may not have.
TEST(RequestTargetTest, HostileBytesAreRefusedOrHarmless) {
  const std::string letters("/.%?&=+\\a0fF \n\0\xff\xc3", 17);
  Random random(7);
  for (int round = 0; round < 20'000; ++round) {
    std::string text = "/";
    for (int i = 0; i < 24; ++i) text.push_back(letters[random.UniformInt(17)]);
    const auto target = ParseTarget(text);
    if (!target.ok()) continue;
    for (const std::string& segment : target->segments) {
      EXPECT_EQ(segment.find('\0'), std::string::npos);
      EXPECT_EQ(segment.find('\n'), std::string::npos);
    }
    const auto path = CheckRelativePath(text.substr(1));
    if (path.ok()) {
      EXPECT_EQ(("/" + *path + "/").find("/../"), std::string::npos) << *path;
    }
  }
}

}  // namespace
}  // namespace pleat
