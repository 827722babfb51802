#include "cli/session.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(SessionTest, TheFlagWinsOverTheEnvironmentAndThatOverTheDefault) {
  Session session;
  EXPECT_EQ(session.ServerAddress(), "127.0.0.1:7320");
  session.environment_server = "render:7000";
  EXPECT_EQ(session.ServerAddress(), "render:7000");
  session.server = "farm:9000";
  EXPECT_EQ(session.ServerAddress(), "farm:9000");
}

TEST(SessionTest, TheDataFolderIsTheFlagsTheVariablesOrInTheHome) {
  Session session;
  EXPECT_EQ(session.DataFolder(), "pleat-data");  // no home: below the working folder
  session.environment_home = "/home/ann";
  EXPECT_EQ(session.DataFolder(), "/home/ann/.local/share/pleat");
  session.environment_data = "/srv/pleat";
  EXPECT_EQ(session.DataFolder(), "/srv/pleat");
  session.data_dir = "here";
  EXPECT_EQ(session.DataFolder(), "here");
}

TEST(SessionTest, JsonAndQuietSilenceNotes) {
  Session session;
  EXPECT_TRUE(session.talkative());
  session.json = true;
  EXPECT_FALSE(session.talkative());
  session.json = false;
  session.quiet = true;
  EXPECT_FALSE(session.talkative());
}

TEST(SessionTest, TheClockNeverGoesBack) {
  double last = MonotonicSeconds();
  for (int i = 0; i < 1000; ++i) {
    const double now = MonotonicSeconds();
    ASSERT_GE(now, last);
    last = now;
  }
}

}  // namespace
}  // namespace pleat
