#include "glb_frames.h"

#include "formats/figure_character.h"
#include "formats/figure_glb.h"
#include "formats/gltf_evaluation.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

class GlbFramesTest : public testing::Test {
 protected:
  // The frames of a character whose keys are at these times.
  GlbFrames FramesAt(const std::vector<float>& times, const GlbFrameOptions& options = {}) {
    CharacterFile character = FigureCharacter(static_cast<int>(times.size()));
    const std::string bytes = EncodeCharacterGlb(character).value();
    GltfEvaluation gltf(bytes);
    uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    FigureGltf edited{gltf.root, bytes.substr(20 + length + 8)};
    edited.root.erase("buffers");
    edited.root["animations"][0].erase("extras");
    const size_t input = edited.Add(times, 5126, "SCALAR", static_cast<int>(times.size()));
    for (nlohmann::json& sampler : edited.root["animations"][0]["samplers"]) {
      sampler["input"] = input;
    }
    bytes_ = PackFigureGltf(edited);
    glb_.emplace(GlbContainer::Open(bytes_).value());
    nodes_ = GlbNodes::Read(*glb_).value();
    animation_ = ChooseGlbAnimation(*glb_, nodes_, {}, &report_).value();
    return ChooseGlbFrames(*animation_, options, &report_);
  }
  std::vector<std::string> Kinds() const {
    std::vector<std::string> kinds;
    for (const InputNote& note : report_.notes) kinds.push_back(note.kind);
    return kinds;
  }

  std::string bytes_;
  std::optional<GlbContainer> glb_;
  GlbNodes nodes_;
  std::optional<GlbAnimation> animation_;
  InputReport report_;
};

TEST_F(GlbFramesTest, EvenKeysAreTheFrames) {
  const GlbFrames frames = FramesAt({0, .04f, .08f});
  EXPECT_THAT(frames.times, ElementsAre(0, .04f, .08f));
  EXPECT_EQ(frames.rate, (FrameRate{25, 1}));
  EXPECT_TRUE(report_.has_frame_rate);
  EXPECT_THAT(Kinds(), ElementsAre());
}

TEST_F(GlbFramesTest, OtherKeysAreSampledAtTheRateThatTheyLieAt) {
  const GlbFrames frames = FramesAt({0, .125f, .5f});
  EXPECT_EQ(frames.rate, (FrameRate{24, 1}));
  EXPECT_EQ(frames.times.size(), 13u);
  EXPECT_THAT(Kinds(), ElementsAre("animation_sampled"));
}

TEST_F(GlbFramesTest, AWantedRateWinsAndFramesAreBounded) {
  EXPECT_EQ(FramesAt({0, .5f, 1}, {.frame_rate = FrameRate{10, 1}}).times.size(), 11u);
  EXPECT_EQ(
      FramesAt({0, .5f, 1000}, {.frame_rate = FrameRate{10, 1}, .max_frames = 50}).times.size(),
      51u);  // one more than allowed, for the reader to refuse
}

TEST_F(GlbFramesTest, ARateThatFitsNothingIsAssumedAndSaid) {
  EXPECT_EQ(FramesAt({0, .0123f, .777f}).rate, (FrameRate{30, 1}));
  EXPECT_THAT(Kinds(), ElementsAre("frame_rate_assumed"));
}

TEST_F(GlbFramesTest, OtherAnimationsAreNamed) {
  FramesAt({0, 1});
  FigureGltf two{nlohmann::json::parse(GltfEvaluation(bytes_).root.dump()), bytes_};
  report_ = {};
  uint32_t length = 0;
  std::memcpy(&length, bytes_.data() + 12, 4);
  two.binary = bytes_.substr(20 + length + 8);
  two.root.erase("buffers");
  two.root["animations"].push_back(two.root["animations"][0]);
  const std::string bytes = PackFigureGltf(two);
  const GlbContainer glb = GlbContainer::Open(bytes).value();
  const GlbNodes nodes = GlbNodes::Read(glb).value();
  EXPECT_TRUE(ChooseGlbAnimation(glb, nodes, {}, &report_).value().has_value());
  EXPECT_THAT(report_.notes, ElementsAre(Field(&InputNote::text, HasSubstr("2 animations"))));
}

}  // namespace
}  // namespace pleat
