#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "client/test_sequence.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"
#include "support/mesh_shapes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::Not;

class ConvertTest : public testing::Test {
 protected:
  ConvertTest() {
    // Quads with seams and materials, and coordinates that pass zero.
    const MeshShape box = MakeBox({1, 2, 3});
    MeshSequenceOptions options{.name = "a", .frame_rate = {24, 1}};
    options.appearance.texcoords = {{0, 0}, {1, 0}, {1, 0.5f}, {0, 0.5f}};
    for (int c = 0; c < box.topology.num_corners(); ++c) {
      options.appearance.corner_texcoords.push_back((c + c / 4) % 4);
    }
    options.appearance.material_names = {"skin", "cloth"};
    options.appearance.face_materials = {0, 0, 0, 1, 1, 1};
    std::vector<Eigen::Matrix3Xf> frames;
    for (int t = 0; t < 6; ++t) {
      Eigen::Matrix3Xf frame = box.positions.cast<float>();
      frame.row(0).array() -= 0.1f + 0.17f * static_cast<float>(t);
      frame.row(1) *= 1 + 0.013f * static_cast<float>(t);
      frames.push_back(frame);
    }
    sequence_.emplace(*MeshSequence::Create(box.topology, std::move(frames), options));
    EXPECT_THAT(WriteSequenceFile(File("a.pseq"), *sequence_), IsOk());
  }
  std::string File(const std::string& name) const { return folder_.File(name); }
  Outcome Convert(const std::string& input, const std::string& output,
                  std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"convert", File(input), "-o", File(output)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunPleat(arguments);
  }
  MeshSequence Read(const std::string& name) const {
    absl::StatusOr<MeshSequence> sequence = ReadSequence(File(name));
    EXPECT_THAT(sequence, IsOk()) << name;
    return sequence.ok() ? *sequence : *sequence_;
  }

  const TemporaryFolder folder_;
  std::optional<MeshSequence> sequence_;
};

TEST_F(ConvertTest, PositionsPassThroughEveryFormatBitByBit) {
  // A chain through all formats that hold positions exactly, so that each reads the one before.
  std::string last = "a.pseq";
  for (const std::string name : {"b.mdd", "c.npz", "d.abc", "e.pc2", "f.npy", "g.mdd", "h.glb"}) {
    const Outcome outcome = Convert(last, name);
    ASSERT_EQ(outcome.code, ExitCode::kOk) << name << outcome.err;
    const MeshSequence back = Read(name);
    ASSERT_EQ(back.num_frames(), 6) << name;
    ASSERT_EQ(back.num_vertices(), 8) << name;
    for (int t = 0; t < 6; ++t) EXPECT_EQ(back.frame(t), sequence_->frame(t)) << name << t;
    if (name != "h.glb") {
      EXPECT_TRUE(back.topology() == sequence_->topology()) << name;
      EXPECT_EQ(back.appearance().material_names, sequence_->appearance().material_names) << name;
      EXPECT_EQ(back.appearance().corner_texcoords.size(), 24u) << name;
    }
    last = name;
  }
  EXPECT_EQ(Read("b.mdd").frame_rate(), (FrameRate{24, 1}));
  EXPECT_EQ(Read("d.abc").frame_rate(), (FrameRate{24, 1}));
}

TEST_F(ConvertTest, FoldersAreWritten) {
  ASSERT_EQ(Convert("a.pseq", "objs").code, ExitCode::kOk);
  ASSERT_EQ(Convert("objs", "plys", {"--format", "ply"}).code, ExitCode::kOk);
  const MeshSequence back = Read("plys");
  for (int t = 0; t < 6; ++t) EXPECT_EQ(back.frame(t), sequence_->frame(t));
}

TEST_F(ConvertTest, WhatIsTakenForGrantedAndLostIsSaid) {
  const Outcome glb = Convert("a.pseq", "a.glb");
  EXPECT_THAT(glb.err, HasSubstr("polygons"));
  EXPECT_THAT(glb.err, HasSubstr("taken as meters, Y up"));
  EXPECT_THAT(glb.err, Not(HasSubstr("frame rate")));
  ASSERT_EQ(Convert("a.pseq", "objs").code, ExitCode::kOk);
  EXPECT_THAT(Convert("objs", "b.mdd").err, HasSubstr("no frame rate: 30 frames"));
  EXPECT_THAT(Convert("objs", "c.mdd", {"--fps", "25"}).err, Not(HasSubstr("no frame rate")));
  EXPECT_EQ(Read("c.mdd").frame_rate(), (FrameRate{25, 1}));
}

TEST_F(ConvertTest, UnitsAxesAndStartAreWhatIsAsked) {
  const Outcome outcome = Convert("a.pseq", "maya.npz",
                                  {"--for", "unreal", "--up", "z", "--start-frame", "1001",
                                   "--from-unit", "m", "--from-up", "y", "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["first_frame"], 1001);
  EXPECT_EQ(json["unit_m"], 0.01);
  EXPECT_EQ(json["up"], "z");
  EXPECT_EQ(json["input_notes"][0]["kind"], "format_not_for_package");
  const Eigen::Vector3f before = sequence_->frame(3).col(5),
                        after = Read("maya.npz").frame(3).col(5);
  EXPECT_LT((after - 100 * Eigen::Vector3f(before.x(), -before.z(), before.y())).norm(), 1e-3);
  // The number of the first frame goes on from file to file.
  ASSERT_EQ(Convert("maya.npz", "b.mdd").code, ExitCode::kOk);
  EXPECT_THAT(Convert("b.mdd", "c.pc2").out, HasSubstr("from frame 1001"));
}

TEST_F(ConvertTest, KeysOfArraysAreTheUsers) {
  ASSERT_EQ(Convert("a.pseq", "k.npz", {"--out-key", "positions=here"}).code, ExitCode::kOk);
  EXPECT_EQ(Convert("k.npz", "l.npz", {"--key", "positions=here"}).code, ExitCode::kOk);
  EXPECT_THAT(Convert("k.npz", "m.npz", {"--key", "positions=there"}).err,
              HasSubstr("'here' float32 (6, 8, 3)"));
}

TEST_F(ConvertTest, WrongFlagsAreUsageErrors) {
  for (const std::vector<std::string>& flags : {std::vector<std::string>{"--unit", "parsec"},
                                                {"--up", "x"},
                                                {"--for", "word"},
                                                {"--fps", "fast"},
                                                {"--key", "x"},
                                                {"--out-key", "x"},
                                                {"--format", "gif"}}) {
    EXPECT_EQ(Convert("a.pseq", "wrong.npz", flags).code, ExitCode::kUsage) << flags[0];
  }
  EXPECT_EQ(Convert("a.pseq", "a.glb", {"--unit", "cm"}).code, ExitCode::kUsage);
  EXPECT_EQ(Convert("a.pseq", "a.fbx").code, ExitCode::kUsage);
  EXPECT_FALSE(std::filesystem::exists(File("wrong.npz")));
}

TEST_F(ConvertTest, UsdaSaysItsSpaceAndTimes) {
  ASSERT_EQ(Convert("a.pseq", "a.usda", {"--unit", "cm", "--start-frame", "5"}).code,
            ExitCode::kOk);
  EXPECT_THAT(Convert("a.pseq", "a.usda").err, HasSubstr("--force"));
}

}  // namespace
}  // namespace pleat
