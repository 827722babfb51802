#include "cli/io/input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class InputTest : public testing::Test {
 protected:
  void SetUp() override {
    session_.out = &out_;
    session_.err = &err_;
    ASSERT_THAT(WriteSequenceFile(path_, MovingTetrahedron(5)), IsOk());
  }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("moving.pseq");
  std::ostringstream out_, err_;
  Session session_;
};

TEST_F(InputTest, SequencesComeAsTheyWereWithProgressInTheLog) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadInput(session_, path_));
  ASSERT_EQ(sequence.num_frames(), 5);
  EXPECT_EQ(sequence.frame(3), MovingTetrahedron(5).frame(3));
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{24, 1}));
  EXPECT_THAT(out_.str(), IsEmpty());
}

TEST_F(InputTest, QuietAndJsonReadWithoutAWord) {
  session_.quiet = true;
  ASSERT_THAT(ReadInput(session_, path_), IsOk());
  session_.quiet = false;
  session_.json = true;
  ASSERT_THAT(ReadInput(session_, path_), IsOk());
  EXPECT_THAT(err_.str(), IsEmpty());
  EXPECT_THAT(out_.str(), IsEmpty());
}

TEST_F(InputTest, AFrameRateGivenIsUsedWhereTheInputSaysNone) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (const char* name : {"a0.obj", "a1.obj"}) {
    ASSERT_THAT(WriteFile(folder_.File(name), obj), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence,
                             ReadInput(session_, folder_.File("a*.obj"), "30000/1001"));
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{30000, 1001}));
}

TEST_F(InputTest, AFrameRateThatIsNoneIsAUsageErrorBeforeAnythingIsRead) {
  for (const char* fps : {"0", "-3", "fast", "30/0", "1e99"}) {
    const absl::Status status = ReadInput(session_, folder_.File("missing.pseq"), fps).status();
    EXPECT_TRUE(IsUsageError(status)) << fps << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(fps));
  }
}

TEST_F(InputTest, WhatIsMissingIsNotFoundAndWhatIsDamagedIsBad) {
  const absl::Status missing = ReadInput(session_, folder_.File("none.pseq")).status();
  EXPECT_EQ(ExitCodeOf(missing), ExitCode::kNotFound);
  EXPECT_THAT(std::string(missing.message()), HasSubstr("none.pseq"));
  const std::string bytes = ReadFile(path_).value();
  ASSERT_THAT(WriteFile(path_, bytes.substr(0, bytes.size() / 2)), IsOk());
  const absl::Status damaged = ReadInput(session_, path_).status();
  EXPECT_EQ(ExitCodeOf(damaged), ExitCode::kBadInput);
  EXPECT_THAT(std::string(damaged.message()), HasSubstr("moving.pseq"));
}

// Three frames of which the second is ten times as large, and a reference beside them.
class NotedInputTest : public InputTest {
 protected:
  void SetUp() override {
    InputTest::SetUp();
    for (const auto& [name, size] : std::vector<std::pair<std::string, int>>{
             {"f_1", 1}, {"f_2", 10}, {"f_3", 1}, {"f_reference", 1}}) {
      ASSERT_THAT(WriteFile(Folder() + "/" + name + ".obj",
                            absl::StrCat("v 0 0 0\nv ", size, " 0 0\nv 0 ", size, " 0\nf 1 2 3\n")),
                  IsOk());
    }
  }
  std::string Folder() const { return folder_.File("frames"); }
};

TEST_F(NotedInputTest, NotesAndJumpsAreSaidEvenWithoutProgress) {
  session_.quiet = true;
  std::vector<InputNote> notes;
  ASSERT_THAT(ReadInput(session_, Folder(), "", &notes), IsOk());
  EXPECT_THAT(err_.str(), HasSubstr("note: 'f_reference.obj' is left out"));
  EXPECT_THAT(err_.str(), HasSubstr("warning: frame 1 (f_2.obj) is 10 times as large"));
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[1].frame, 1);
}

TEST_F(NotedInputTest, StrictRefusesThem) {
  session_.strict = true;
  const absl::Status status = ReadInput(session_, Folder()).status();
  EXPECT_EQ(ExitCodeOf(status), ExitCode::kRefused);
  EXPECT_THAT(std::string(status.message()), HasSubstr("the 2 lines above"));
  EXPECT_THAT(ReadInput(session_, path_), IsOk());
}

}  // namespace
}  // namespace pleat
