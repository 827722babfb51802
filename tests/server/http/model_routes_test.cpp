#include "pleat/formats/motion_file.h"
#include "pleat/formats/pc2.h"
#include "server/http/studio_fixture.h"

namespace pleat {
namespace {

using testing::HasSubstr;

using ModelRoutesTest = StudioTest;

TEST_F(ModelRoutesTest, AModelGivesItsMotionItsWeightsAndItsFrames) {
  const nlohmann::json take = UploadTube();
  const nlohmann::json job =
      Call("JobService/CreateTrainingJob", {{"sequenceIds", {take["sequence"]["id"]}}});
  Ask("POST", "/rpc/JobService/WatchJob", nlohmann::json{{"id", job["job"]["id"]}}.dump());
  const std::string id = Call("ModelService/ListModels")["models"][0]["id"];
  const std::string sequence = take["sequence"]["id"];
  const std::string motion =
      HttpClient::BodyOf(Ask("POST", "/studio/models/" + id + "/motion?sequence=" + sequence));
  EXPECT_EQ(nlohmann::json::parse(motion)["frames"].size(), 5u);
  EXPECT_EQ(Json("GET", "/studio/models/" + id + "/rig")["weights"]["vertices"].size(),
            static_cast<size_t>(take["sequence"]["numVertices"]));
  const std::string cache = HttpClient::BodyOf(
      Ask("POST", "/studio/models/" + id + "/export?format=pc2&save=a.pc2", motion));
  EXPECT_EQ(DecodePointCache(cache, "a.pc2")->frames.size(), 5u);
  EXPECT_THAT(Ask("POST", "/studio/models/" + id + "/export?format=bvh", motion),
              HasSubstr("HIERARCHY"));
  EXPECT_EQ(
      HttpClient::StatusOf(Ask("POST", "/studio/models/" + id + "/export?format=exe", motion)),
      400);
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/studio/models/" + id + "/export", "{}")), 400);
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/studio/models/" + std::string(64, '0') + "/rig")),
            404);
}

TEST_F(ModelRoutesTest, TheStrengthOfTheFoldsAndTheProportionsOfAMotionAreKept) {
  const nlohmann::json take = UploadTube();
  const std::string model = running_.TrainModel();
  const std::string sequence = take["sequence"]["id"];
  const std::string base = "/studio/models/" + model;
  nlohmann::json motion = Json("POST", base + "/motion?sequence=" + sequence);
  const auto frames = [&] {
    const std::string cache =
        HttpClient::BodyOf(Ask("POST", base + "/export?format=pc2", motion.dump()));
    return DecodePointCache(cache, "a.pc2").value().frames;
  };
  const std::vector<Eigen::Matrix3Xf> learned = frames();
  for (const auto& joint : motion["joints"]) motion["detail_strengths"][joint] = 0;
  const std::vector<Eigen::Matrix3Xf> skinned = frames();
  EXPECT_GT((learned[2] - skinned[2]).cwiseAbs().maxCoeff(), 1e-5);
  motion["detail_strengths"].clear();
  motion["vertex_strengths"] =
      std::vector<double>(take["sequence"]["numVertices"].get<size_t>(), 0.0);
  EXPECT_EQ(frames()[2], skinned[2]);
  motion["bone_scales"][motion["joints"].back().get<std::string>()] = 1.5;

  const std::string upload = Json("POST", "/studio/uploads")["id"];
  Ask("PUT", "/studio/uploads/" + upload + "?path=edited.json", motion.dump());
  const nlohmann::json back = Json("POST", base + "/motion?upload=" + upload);
  EXPECT_EQ(back["vertex_strengths"], motion["vertex_strengths"]);
  EXPECT_EQ(back["bone_scales"][motion["joints"].back().get<std::string>()], 1.5);
}

TEST_F(ModelRoutesTest, TheCharacterOfThePageAndTheSkinnedOneAreThere) {
  const nlohmann::json take = UploadTube();
  const std::string base = "/studio/models/" + running_.TrainModel();
  const std::string sequence = take["sequence"]["id"];
  EXPECT_THAT(HttpClient::BodyOf(Ask("GET", base + "/page")), testing::StartsWith("PLPC"));
  const std::string motion = HttpClient::BodyOf(Ask("POST", base + "/motion?sequence=" + sequence));
  EXPECT_THAT(HttpClient::BodyOf(Ask("POST", base + "/export?format=character.glb", motion)),
              testing::StartsWith("glTF"));
}

TEST_F(ModelRoutesTest, AMotionComesInAsAFile) {
  const nlohmann::json take = UploadTube();
  const std::string model = running_.TrainModel();
  const std::string sequence = take["sequence"]["id"];
  const std::string motion =
      HttpClient::BodyOf(Ask("POST", "/studio/models/" + model + "/motion?sequence=" + sequence));
  const std::string upload = Json("POST", "/studio/uploads")["id"];
  Ask("PUT", "/studio/uploads/" + upload + "?path=edited.json", motion);
  EXPECT_EQ(Json("POST", "/studio/models/" + model + "/motion?upload=" + upload)["frames"].size(),
            5u);
}

}  // namespace
}  // namespace pleat
