#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "server/http/studio_fixture.h"

namespace pleat {
namespace {

using testing::HasSubstr;

using TakeReaderTest = StudioTest;

TEST_F(TakeReaderTest, ATakeComesInAndLeavesAgain) {
  const nlohmann::json take = UploadTube();
  EXPECT_EQ(take["sequence"]["name"], "my tube");
  EXPECT_EQ(take["sequence"]["numFrames"], 5);
  EXPECT_TRUE(take["notes"].is_array());
  EXPECT_EQ(Call("SequenceService/ListSequences")["sequences"].size(), 1u);
  const std::string file =
      Dechunk(HttpClient::BodyOf(Ask("POST", "/rpc/SequenceService/DownloadSequence",
                                     nlohmann::json{{"id", take["sequence"]["id"]}}.dump())));
  EXPECT_EQ(DecodeSequence(file)->num_frames(), 5);
}

TEST_F(TakeReaderTest, AFileThatIsNoTakeSaysWhy) {
  const std::string id = Json("POST", "/studio/uploads")["id"];
  Ask("PUT", "/studio/uploads/" + id + "?path=bad.obj", "v 1 2\n");
  const std::string response = Ask("POST", "/studio/uploads/" + id);
  EXPECT_EQ(HttpClient::StatusOf(response), 400);
  EXPECT_THAT(response, HasSubstr("bad.obj"));
  EXPECT_THAT(response, testing::Not(HasSubstr("studio-uploads")));
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/studio/uploads/" + id)), 404);
}

TEST_F(TakeReaderTest, AFolderOfFramesIsOneTakeAndAFrameThatJumpsIsNamed) {
  const std::string id = Json("POST", "/studio/uploads")["id"];
  const MeshSequence tube = MakeSwayingTube(6);
  for (int t = 0; t < 6; ++t) {
    const Eigen::Matrix3Xf positions = (t == 4 ? 10.f : 1.f) * tube.frame(t);
    const std::string path = "walk/frame" + std::to_string(t) + ".obj";
    EXPECT_EQ(HttpClient::StatusOf(Ask("PUT", "/studio/uploads/" + id + "?path=" + path,
                                       EncodeObj(tube.topology(), positions, {}))),
              200);
  }
  const nlohmann::json take = Json("POST", "/studio/uploads/" + id + "?name=walk");
  EXPECT_EQ(take["sequence"]["numFrames"], 6);
  EXPECT_EQ(take["numComponents"], 1);
  EXPECT_GT(take["diagonalM"], 0);
  bool said = false;
  for (const nlohmann::json& note : take["notes"]) said |= note.value("frame", -1) == 4;
  EXPECT_TRUE(said) << take["notes"];
}

TEST_F(TakeReaderTest, APointCacheIsReadWithTheMeshBesideIt) {
  const std::string id = Json("POST", "/studio/uploads")["id"];
  const MeshSequence tube = MakeSwayingTube(3);
  PointCache cache{.start_frame = 0, .frames = {}};
  for (int t = 0; t < 3; ++t) cache.frames.push_back(tube.frame(t));
  const std::string target = "/studio/uploads/" + id + "?path=";
  Ask("PUT", target + "tube.obj", EncodeObj(tube.topology(), tube.frame(0), {}));
  Ask("PUT", target + "tube.pc2", EncodePointCache(cache));
  EXPECT_EQ(Json("POST", "/studio/uploads/" + id)["sequence"]["numFrames"], 3);
}

TEST_F(TakeReaderTest, ThereIsATakeToTry) {
  EXPECT_GT(Json("POST", "/studio/example")["sequence"]["numFrames"], 10);
}

}  // namespace
}  // namespace pleat
