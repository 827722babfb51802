#include "pleat/observe/audit_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "absl/strings/str_split.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;

class AuditLogTest : public testing::Test {
 protected:
  std::unique_ptr<AuditLog> Open() {
    return AuditLog::Open(path_, [] { return int64_t{1'796'083'200'123}; }).value();
  }
  std::vector<std::string> Lines() {
    std::vector<std::string> lines = absl::StrSplit(ReadFile(path_).value(), '\n');
    EXPECT_EQ(lines.back(), "") << "the last line is not whole";
    lines.pop_back();
    return lines;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.path() + "/audit.jsonl";
};

TEST_F(AuditLogTest, OneLineSaysWhoDidWhat) {
  ASSERT_THAT(Open()->Write({.rpc = "DeleteModel",
                             .peer = "ipv4:10.0.0.7:52114",
                             .token_id = "5d0f3a9b2c4e6871",
                             .token_name = "Zoë",
                             .project = "robots",
                             .ids = {"a", "b"},
                             .trace_id = "4bf92f3577b34da6a3ce929d0e0e4736",
                             .status = "OK",
                             .seconds = .25}),
              IsOk());
  ASSERT_EQ(Lines().size(), 1);
  EXPECT_EQ(json::parse(Lines()[0]), json({{"time", "2026-12-01T00:00:00.123Z"},
                                           {"rpc", "DeleteModel"},
                                           {"peer", "ipv4:10.0.0.7:52114"},
                                           {"token", "5d0f3a9b2c4e6871"},
                                           {"name", "Zoë"},
                                           {"project", "robots"},
                                           {"ids", {"a", "b"}},
                                           {"trace", "4bf92f3577b34da6a3ce929d0e0e4736"},
                                           {"status", "OK"},
                                           {"seconds", .25}}));
}

TEST_F(AuditLogTest, NothingFromOutsideForgesALine) {
  ASSERT_THAT(Open()->Write({.rpc = "DeleteModel",
                             .peer = "unix:",
                             .ids = {"x\"}\n{\"rpc\":\"DeleteModel\"", "\xff\xfe", "\x1b[2J"},
                             .status = "NOT_FOUND"}),
              IsOk());
  ASSERT_EQ(Lines().size(), 1);
  const json line = json::parse(Lines()[0]);
  EXPECT_EQ(line["ids"][0], "x\"}\n{\"rpc\":\"DeleteModel\"");
  const std::string text = Lines()[0];
  for (const char c : text) EXPECT_TRUE(c >= ' ' && c < 127) << "byte " << int{c};
}

TEST_F(AuditLogTest, GrowsOverRestartsAndLinesOfThreadsDoNotMix) {
  for (int run = 0; run < 2; ++run) {
    const std::unique_ptr<AuditLog> log = Open();
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 50; ++i) {
          EXPECT_THAT(
              log->Write({.rpc = "CancelJob", .peer = std::string(200, 'p'), .status = "OK"}),
              IsOk());
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }
  ASSERT_EQ(Lines().size(), 400);
  for (const std::string& line : Lines()) EXPECT_TRUE(json::accept(line)) << line;
}

TEST_F(AuditLogTest, OnlyItsOwnerCanReadIt) {
  Open();
  struct stat info {};
  ASSERT_EQ(stat(path_.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600);
}

TEST_F(AuditLogTest, ALineThatIsLostIsSaid) {
  // A device that is always full.
  const auto log = AuditLog::Open("/dev/full", [] { return int64_t{0}; }).value();
  EXPECT_THAT(log->Write({.rpc = "CancelJob"}),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("audit log")));
  EXPECT_THAT(AuditLog::Open(folder_.path() + "/no/such/log", [] { return int64_t{0}; }),
              HasStatus(absl::StatusCode::kNotFound, testing::HasSubstr("audit log")));
}

}  // namespace
}  // namespace pleat
