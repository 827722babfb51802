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

TEST_F(TakeReaderTest, ThereIsATakeToTry) {
  EXPECT_GT(Json("POST", "/studio/example")["sequence"]["numFrames"], 10);
}

}  // namespace
}  // namespace pleat
