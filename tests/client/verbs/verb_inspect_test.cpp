#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/base/file.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/sequence_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class InspectVerbTest : public testing::Test {
 protected:
  void SetUp() override { ASSERT_THAT(WriteSequenceFile(path_, MovingTetrahedron(5)), IsOk()); }

  const TemporaryFolder folder_;
  const std::string path_ = folder_.File("moving.pseq");
};

TEST_F(InspectVerbTest, JsonSaysCountsBoundsAndContent) {
  const Outcome outcome = RunPleat({"inspect", path_, "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.inspect/1");
  EXPECT_EQ(json["name"], "tetrahedron");
  EXPECT_EQ(json["num_frames"], 5);
  EXPECT_EQ(json["num_vertices"], 4);
  EXPECT_EQ(json["num_triangles"], 4);
  EXPECT_EQ(json["fps"], 24);
  EXPECT_NEAR(json["diagonal_m"].get<double>(), std::sqrt(3), 1e-6);
  // The bounds enclose all frames: the tube grows by 1 % and moves by 10 cm in each.
  EXPECT_EQ(json["bounds"]["min_m"][0], 0);
  EXPECT_NEAR(json["bounds"]["max_m"][0].get<double>(), 1.04 + .4, 1e-6);
  EXPECT_NEAR(json["bounds"]["max_m"][2].get<double>(), 1.04, 1e-6);
  EXPECT_EQ(json["mesh_report"]["closed"], true);
  EXPECT_EQ(json["sequence_id"].get<std::string>().size(), 64u);
}

TEST_F(InspectVerbTest, ObjectsOfAlembicArchivesAreChosen) {
  const std::string archive = folder_.File("tetrahedron.abc");
  ASSERT_THAT(WriteAlembic(archive, MovingTetrahedron(5)), IsOk());
  const Outcome chosen = RunPleat(
      {"inspect", archive, "--json", "--strict", "--object", "/tetrahedron/tetrahedronShape"});
  ASSERT_EQ(chosen.code, ExitCode::kOk) << chosen.err;
  EXPECT_EQ(nlohmann::json::parse(chosen.out)["sequence_id"],
            nlohmann::json::parse(RunPleat({"inspect", path_, "--json"}).out)["sequence_id"]);
  EXPECT_THAT(RunPleat({"inspect", archive, "--object", "/a"}).err, HasSubstr("no object '/a'"));
  EXPECT_THAT(RunPleat({"inspect", path_, "--object", "/a"}).err, HasSubstr("no Alembic archive"));
}

TEST_F(InspectVerbTest, TheIdIsOfTheContentNotOfTheFile) {
  const std::string copy = folder_.File("copy.pseq");
  ASSERT_THAT(WriteFile(copy, ReadFile(path_).value()), IsOk());
  ASSERT_THAT(WriteSequenceFile(folder_.File("other.pseq"), MovingTetrahedron(6)), IsOk());
  const auto id = [](const std::string& path) {
    return nlohmann::json::parse(RunPleat({"inspect", path, "--json"}).out)["sequence_id"];
  };
  EXPECT_EQ(id(copy), id(path_));
  EXPECT_NE(id(folder_.File("other.pseq")), id(path_));
}

TEST_F(InspectVerbTest, TextIsForPeople) {
  const Outcome outcome = RunPleat({"inspect", path_});
  EXPECT_EQ(outcome.code, ExitCode::kOk);
  EXPECT_THAT(outcome.out, HasSubstr("frames      5 at 24 per second, 0.21 s\n"));
  EXPECT_THAT(outcome.out, HasSubstr("mesh        4 vertices, 4 faces (4 triangles), closed\n"));
  EXPECT_THAT(outcome.out, HasSubstr("frame 0     diagonal 1.732 m"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("unclean")));
}

TEST_F(InspectVerbTest, FaultsOfTheMeshAreListed) {
  ASSERT_THAT(WriteFile(folder_.File("open.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\n"),
              IsOk());
  const Outcome outcome = RunPleat({"inspect", folder_.File("open.obj"), "--fps", "12.5"});
  EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(", open\n"));
  EXPECT_THAT(outcome.out, HasSubstr("unclean     "));
}

TEST_F(InspectVerbTest, AFileThatIsCutOffIsBadInput) {
  const std::string bytes = ReadFile(path_).value();
  for (const size_t size : {size_t{0}, size_t{3}, bytes.size() / 2, bytes.size() - 1}) {
    ASSERT_THAT(WriteFile(path_, bytes.substr(0, size)), IsOk());
    const Outcome outcome = RunPleat({"inspect", path_});
    EXPECT_EQ(outcome.code, ExitCode::kBadInput) << size;
    EXPECT_THAT(outcome.err, HasSubstr("moving.pseq")) << size;
  }
}

TEST_F(InspectVerbTest, WhatTheReaderNoticedIsInTheJsonAndOnStderr) {
  ASSERT_THAT(WriteFile(folder_.File("a.obj"),
                        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\nusemtl B\xe6r\n"),
              IsOk());
  const Outcome outcome = RunPleat({"inspect", folder_.File("a.obj"), "--json", "-q"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto notes = nlohmann::json::parse(outcome.out)["input_notes"];
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_EQ(notes[0]["severity"], "note");
  EXPECT_EQ(notes[0]["kind"], "faces_left_out");
  EXPECT_EQ(notes[0]["text"], "a.obj: 1 face with 2 corners left out (line 5)");
  EXPECT_THAT(outcome.err, HasSubstr("note: a.obj: 1 face with 2 corners left out"));
}

TEST_F(InspectVerbTest, FilesCannotColorTheTerminal) {
  const std::string path = folder_.File("\x1b[31m.obj");
  ASSERT_THAT(WriteFile(path, "v \x1b[2J 0 0\n"), IsOk());
  const Outcome outcome = RunPleat({"inspect", path});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, Not(HasSubstr("\x1b")));
  EXPECT_THAT(outcome.err, HasSubstr("\\x1b[2J"));
  EXPECT_THAT(outcome.err, HasSubstr("\\x1b[31m.obj:1: "));
}

}  // namespace
}  // namespace pleat
