// The captured files beside the checkout, where there are any.
#include <gtest/gtest.h>

#include "formats/obj_folder.h"
#include "pleat/formats/obj_reader.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/mesh/frame_jumps.h"
#include "support/shared_data.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

struct Expected {
  const char* file;
  int num_frames, num_vertices, num_faces;
};

class RealSequenceTest : public testing::TestWithParam<Expected> {};

TEST_P(RealSequenceTest, HasTheKnownCounts) {
  PLEAT_SHARED_DATA_OR_SKIP(path, GetParam().file);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(path));
  EXPECT_EQ(sequence.num_frames(), GetParam().num_frames);
  EXPECT_EQ(sequence.num_vertices(), GetParam().num_vertices);
  EXPECT_EQ(sequence.topology().num_faces(), GetParam().num_faces);
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{30, 1}));
}

// At its own speed and with every third and every tenth frame alone; its mesh is that of frame 0,
// in whatever pose.
TEST_P(RealSequenceTest, MovesWithoutJumpsAtAnySpeed) {
  PLEAT_SHARED_DATA_OR_SKIP(path, GetParam().file);
  InputReport report;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(path, {}, {}, &report));
  for (const InputNote& note : report.notes) {
    EXPECT_NE(note.severity, NoteSeverity::kWarning) << note.text;
  }
  for (const int step : {1, 3, 10}) {
    std::vector<int> frames;
    for (int t = 0; t < sequence.num_frames(); t += step) frames.push_back(t);
    EXPECT_TRUE(FindFrameJumps(sequence.Subset(frames)).empty()) << step;
  }
}

INSTANTIATE_TEST_SUITE_P(SharedData, RealSequenceTest,
                         testing::Values(Expected{"samba.pc2", 175, 9971, 19938},
                                         Expected{"crane.pc2", 175, 10002, 20000},
                                         Expected{"skirt/walk_a.pc2", 343, 10000, 19996},
                                         Expected{"skirt/walk_b.pc2", 279, 10000, 19996},
                                         Expected{"rumba.pc2", 121, 12811, 25472},
                                         Expected{"chicken_crossing.pc2", 400, 3030, 5664},
                                         Expected{"horse_gallop.pc2", 48, 8431, 16843}),
                         [](const auto& info) {
                           std::string name = info.param.file;
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
                           return name;
                         });

TEST(RealSequenceTest, FirstFrameOfTheCacheIsTheTemplate) {
  PLEAT_SHARED_DATA_OR_SKIP(cache, "samba.pc2");
  PLEAT_SHARED_DATA_OR_SKIP(mesh, "samba.obj");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(cache));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile file, ReadObj(mesh));
  EXPECT_LT((sequence.frame(0) - file.positions).cwiseAbs().maxCoeff(), 1e-5f);
}

TEST(RealSequenceTest, StaticMeshesAreSequencesOfOneFrame) {
  for (const char* name : {"cheb", "test", "human_male", "human_female", "anime_female"}) {
    PLEAT_SHARED_DATA_OR_SKIP(path, std::string("static/") + name + ".obj");
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(path));
    EXPECT_EQ(sequence.num_frames(), 1);
    EXPECT_GT(sequence.topology().num_faces(), 1000) << name;
    EXPECT_EQ(sequence.name(), name);
  }
}

TEST(RealSequenceTest, ObjFolderOfSambaReadsBackEqual) {
  PLEAT_SHARED_DATA_OR_SKIP(path, "samba.pc2");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence whole, ReadSequence(path));
  const MeshSequence sequence = whole.Subset({0, 20, 40, 60, 80, 100, 120, 140, 160, 170, 174});
  const TemporaryFolder folder;
  ASSERT_THAT(WriteObjFolder(folder.File("samba"), sequence), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence read, ReadSequence(folder.File("samba")));
  EXPECT_EQ(EncodeSequence(read), EncodeSequence(sequence));
}

TEST(RealSequenceTest, CanonicalBytesReadBackEqual) {
  PLEAT_SHARED_DATA_OR_SKIP(path, "samba.pc2");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(path));
  const std::string bytes = EncodeSequence(sequence);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence decoded, DecodeSequence(bytes));
  EXPECT_EQ(EncodeSequence(decoded), bytes);
  EXPECT_EQ(SequenceId(bytes).size(), 64u);
}

}  // namespace
}  // namespace pleat
