// The process that decodes Draco, when it is not what it should be: shell scripts in its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/io/draco_process.h"
#include "cli/io/draco_process_protocol.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr char kForEver[] = "exec sleep 1000\n";  // it is killed long before

// A line of shell that writes the bytes of `value` on standard output.
template <typename T>
std::string Print(const T& value) {
  std::string line = "printf '";
  for (size_t i = 0; i < sizeof value; ++i) {
    const auto byte = reinterpret_cast<const unsigned char*>(&value)[i];
    absl::StrAppendFormat(&line, "\\%03o", byte);
  }
  return line + "'\n";
}
std::string Reply(uint32_t num_positions, uint32_t num_triangles, uint32_t has_numbers = 0) {
  return Print(DracoReplyHeader{kDracoReplyMagic, num_positions, num_triangles, has_numbers});
}

struct FakeChild {
  std::string script;
  absl::StatusCode code;
  std::string message;
};

class DracoChildTest : public testing::Test {
 protected:
  absl::StatusOr<DracoGeometry> Decode(const std::string& script, double wall_seconds = 20,
                                       const Progress& progress = {}) {
    const std::string input = folder_.File("x.drc"), program = folder_.File("child");
    EXPECT_THAT(WriteFile(input, "DRACO"), IsOk());
    EXPECT_THAT(WriteFile(program, "#!/bin/sh\n" + script), IsOk());
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return DecodeDracoInChild(input, progress, {.wall_seconds = wall_seconds, .program = program});
  }
  // Nothing is left behind, not even a process that nobody has waited for.
  static void ExpectNoChildren() {
    EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
  }

  TemporaryFolder folder_;
};

TEST_F(DracoChildTest, AReplyIsTakenAsItIs) {
  const float corner[3] = {1, 2, 3};
  const int32_t triangle[3] = {0, 0, 0}, number = 7;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DracoGeometry geometry,
                             Decode("cat > /dev/null\n" + Reply(1, 1, 1) + Print(corner) +
                                    Print(triangle) + Print(number)));
  EXPECT_EQ(geometry.positions, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(geometry.triangles.cols(), 1);
  EXPECT_THAT(geometry.vertex_numbers, testing::ElementsAre(7));
}

TEST_F(DracoChildTest, WhatIsNoReplyIsAnErrorThatNamesTheFile) {
  const uint32_t most = 0xffffffff;
  const float corner[3] = {1, 2, 3};
  const int32_t beyond[3] = {0, 0, 1}, before[3] = {0, -1, 0};
  using enum absl::StatusCode;
  for (const FakeChild& child : std::vector<FakeChild>{
           {"exit 0\n", kDataLoss, "wrote too little"},
           {"printf 'RDL'\n", kDataLoss, "wrote too little"},
           {Reply(2, 0) + Print(corner), kDataLoss, "wrote too little"},
           {"printf 'an attribute is missing' >&2; exit 15\n", kDataLoss,
            "an attribute is missing"},
           {"printf 'too large' >&2; exit 8\n", kResourceExhausted, "too large"},
           {"exit 77\n", kInternal, "ended with 77"},
           {"kill -SEGV $$\n", kDataLoss, "crashed on it (signal 11)"},
           {"kill -KILL $$\n", kResourceExhausted, "takes more than"},
           {"printf 'anything but the header of a reply'\n", kDataLoss, "impossible"},
           {Reply(most, 0), kDataLoss, "impossible"},
           {Reply(0, most), kDataLoss, "impossible"},
           {Reply(0, 0, 2), kDataLoss, "impossible"},
           {Reply(1, 1) + Print(corner) + Print(beyond), kDataLoss, "impossible"},
           {Reply(1, 1) + Print(corner) + Print(before), kDataLoss, "impossible"},
           {Reply(0, 0) + "printf x\n", kDataLoss, "wrote too much"},
           {Reply(0, 0) + "exit 3\n", kDataLoss, "ended badly"}}) {
    EXPECT_THAT(Decode(child.script),
                HasStatus(child.code, AllOf(HasSubstr("x.drc: "), HasSubstr(child.message))))
        << child.script;
    ExpectNoChildren();
  }
}

// However little it does, it has no more than its time.
TEST_F(DracoChildTest, AChildThatDoesNotEndIsEnded) {
  const std::string close = "exec 1>&-\n", close_both = "exec 1>&- 2>&-\n";
  for (const std::string& script :
       {std::string(kForEver), close + kForEver, close_both + kForEver,
        Reply(1, 0) + kForEver,                              // half a reply
        Reply(0, 0) + close + kForEver,                      // a whole one
        std::string("exec head -c 300000 /dev/zero >&2\n"),  // a message larger than the pipe
        close + "exec head -c 300000 /dev/zero >&2\n",
        Reply(1'000'000, 0) + "while :; do printf x; done\n"}) {  // always a little more
    EXPECT_THAT(Decode(script, .2),
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("more than 0.2 s")))
        << script;
    ExpectNoChildren();
  }
}

TEST_F(DracoChildTest, CancellationEndsAChildThatHangs) {
  for (const std::string& script : {std::string(kForEver), std::string("exec 1>&-\n") + kForEver}) {
    int num_questions = 0;
    const Progress progress({}, [&] { return ++num_questions > 3; });
    EXPECT_EQ(Decode(script, 60, progress).status().code(), absl::StatusCode::kCancelled);
    ExpectNoChildren();
  }
}

TEST_F(DracoChildTest, AProgramThatIsNotThereIsNamed) {
  ASSERT_THAT(WriteFile(folder_.File("x.drc"), "DRACO"), IsOk());
  EXPECT_THAT(DecodeDracoInChild(folder_.File("x.drc"), {}, {.program = "/nowhere/pleat-draco"}),
              HasStatus(absl::StatusCode::kNotFound,
                        AllOf(HasSubstr("/nowhere/pleat-draco"), HasSubstr("reads Draco files"))));
  ExpectNoChildren();
}

// The program itself: what it is told decides what it may do.
TEST_F(DracoChildTest, TheLimitsReachTheChild) {
  DracoProcessOptions options{.memory_bytes = 1 << 28,
                              .cpu_seconds = 3,
                              .limits = {.max_vertices = 11, .max_faces = 12},
                              .program = folder_.File("child")};
  ASSERT_THAT(WriteFile(folder_.File("x.drc"), "DRACO"), IsOk());
  ASSERT_THAT(WriteFile(options.program, "#!/bin/sh\nprintf '%s ' \"$@\" >&2; exit 15\n"), IsOk());
  std::filesystem::permissions(options.program, std::filesystem::perms::owner_all);
  EXPECT_THAT(DecodeDracoInChild(folder_.File("x.drc"), {}, options),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("268435456 3 11 12 ")));
}

}  // namespace
}  // namespace pleat
