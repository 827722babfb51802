#include "pleat/observe/logging.h"

#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string>

#include "pleat/observe/request_scope.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LoggingTest : public testing::Test {
 protected:
  ~LoggingTest() override { spdlog::set_default_logger(before_); }
  // What appears on standard error while `log` runs.
  template <typename Log>
  static std::string Captured(const LoggingOptions& options, Log log) {
    testing::internal::CaptureStderr();
    EXPECT_THAT(ConfigureLogging(options), IsOk());
    log();
    spdlog::default_logger()->flush();
    return testing::internal::GetCapturedStderr();
  }

 private:
  const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

TEST_F(LoggingTest, EveryLevelHidesTheOnesBelow) {
  const auto log = [] {
    spdlog::debug("fine");
    spdlog::warn("careful");
    spdlog::error("broken");
  };
  EXPECT_THAT(Captured({.level = "trace"}, log), HasSubstr("fine"));
  const std::string errors = Captured({.level = "error"}, log);
  EXPECT_THAT(errors, HasSubstr("broken"));
  EXPECT_THAT(errors, Not(HasSubstr("careful")));
  EXPECT_EQ(Captured({.level = "off"}, log), "");
}

TEST_F(LoggingTest, AnUnknownLevelIsRefusedWithTheListOfAll) {
  for (const char* level : {"", "loud", "INFO", "warning "}) {
    EXPECT_THAT(ConfigureLogging({.level = level}),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("trace, debug, info")))
        << level;
  }
}

TEST_F(LoggingTest, AMessageWithAnythingInItStaysOneJsonString) {
  const std::string line = Captured({.json = true}, [] {
    spdlog::info(std::string("a \"quote\", C:\\ and \n\t\x01\x1f\0 end", 28));
  });
  EXPECT_THAT(line, HasSubstr(R"("level":"info")"));
  EXPECT_THAT(line,
              HasSubstr(R"("message":"a \"quote\", C:\\ and \u000a\u0009\u0001\u001f\u0000)"));
  EXPECT_EQ(line.find('\n'), line.size() - 1) << "one line per message";
}

TEST_F(LoggingTest, AMessageWithALineBreakForgesNoLine) {
  const std::string line = Captured(
      {}, [] { spdlog::info("no model 'x'\n2026-11-30 00:00:00.000 I all is well\x1b[2J \xff'"); });
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  EXPECT_THAT(line, HasSubstr("'x'\\x0a2026"));
  EXPECT_THAT(line, HasSubstr("\\x1b[2J \\xff'"));
  const std::string json = Captured({.json = true}, [] { spdlog::info("caf\xe9 \xc3\xa9"); });
  EXPECT_THAT(json, HasSubstr("caf\xef\xbf\xbd \xc3\xa9"));
}

TEST_F(LoggingTest, WhatProtocolBuffersSayIsADebugLine) {
  const auto log = [] { GOOGLE_LOG(ERROR) << "bad field"; };
  EXPECT_EQ(Captured({.level = "info"}, log), "");
  EXPECT_THAT(Captured({.level = "debug"}, log), HasSubstr("protobuf: bad field"));
}

TEST_F(LoggingTest, ALineNamesTheRequestThatItIsAbout) {
  const auto log = [] {
    spdlog::info("before");
    RequestTag request{.id = "r-1"};
    const RequestScope scope(request);
    spdlog::info("inside");
    request.project = "robots";  // the caller was let in
    spdlog::info("admitted");
  };
  const std::string text = Captured({}, log);
  EXPECT_THAT(text, HasSubstr("before\n"));
  EXPECT_THAT(text, HasSubstr("inside [request r-1]\n"));
  EXPECT_THAT(text, HasSubstr("admitted [request r-1, project robots]\n"));
  const std::string json = Captured({.json = true}, log);
  EXPECT_THAT(json, HasSubstr(R"("message":"before"})"));
  EXPECT_THAT(json, HasSubstr(R"("message":"inside","request":"r-1"})"));
  EXPECT_THAT(json, HasSubstr(R"("message":"admitted","request":"r-1","project":"robots"})"));
}

}  // namespace
}  // namespace pleat
