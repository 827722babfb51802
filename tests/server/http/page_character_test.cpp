#include "page_character.h"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/model_builder.h"
#include "pleat/character/pose_evaluator.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

// The bytes of a page's character, read back as docs/formats/page_character.md has them.
struct ReadPage {
  explicit ReadPage(const std::string& bytes) : magic(bytes.substr(0, 4)) {
    uint32_t numbers[2] = {};
    std::memcpy(numbers, bytes.data() + 4, sizeof(numbers));
    version = numbers[0];
    head = nlohmann::json::parse(bytes.substr(12, numbers[1]));
    body = bytes.substr(12 + numbers[1]);
  }
  template <typename T>
  std::vector<T> Buffer(const char* name) const {
    const auto [first, size] = head["buffers"][name].get<std::pair<size_t, size_t>>();
    std::vector<T> values(size / sizeof(T));
    std::memcpy(values.data(), body.data() + first, size);
    return values;
  }

  std::string magic, body;
  uint32_t version = 0;
  nlohmann::json head;
};

// The details of all vertices, 3 x V, by the formula of the page.
Eigen::Matrix3Xd DetailsOf(const ReadPage& page, const Eigen::VectorXf& coefficients) {
  const auto vertices = page.Buffer<uint32_t>("part_vertices");
  const auto mean = page.Buffer<float>("mean");
  const auto planes = page.Buffer<int8_t>("planes");
  Eigen::Matrix3Xd details(3, static_cast<Eigen::Index>(vertices.size()));
  size_t place = 0, value = 0;
  for (const nlohmann::json& part : page.head["parts"]) {
    for (int i = 0; i < part["num_vertices"]; ++i, ++place) {
      Eigen::Vector3d detail(mean[3 * place], mean[3 * place + 1], mean[3 * place + 2]);
      for (size_t p = 0; p < part["scales"].size(); ++p) {
        const double weight = part["scales"][p].get<double>() *
                              coefficients[part["coefficients"][p].get<Eigen::Index>()];
        for (int axis = 0; axis < 3; ++axis) detail[axis] += weight * planes[value++];
      }
      details.col(vertices[place]) = detail;
    }
  }
  return details;
}

class PageCharacterTest : public testing::TestWithParam<Learner> {};

TEST_P(PageCharacterTest, TheDetailsOfThePageAreThoseOfTheModel) {
  const auto model = SmallModelBuilder(GetParam()).Build();
  const ReadPage page(EncodePageCharacter(*model));
  EXPECT_EQ(page.magic, "PLPC");
  EXPECT_EQ(page.version, 1u);
  const auto num_coefficients = model->full_basis().num_coefficients();
  ASSERT_EQ(page.head["num_coefficients"], num_coefficients);
  FrameParameters parameters{.pose = Pose::Rest(model->skeleton()), .coefficients = {}};
  for (const float size : {0.f, .01f, -.02f}) {
    parameters.coefficients = Eigen::VectorXf::LinSpaced(num_coefficients, size, 2 * size);
    PoseEvaluator evaluator(model);
    EvaluatedFrame frame;
    ASSERT_THAT(evaluator.Show(parameters, {}, &frame), IsOk());
    // At rest the axes of all bones are those of the world.
    const Eigen::Matrix3Xd difference = frame.positions.cast<double>() -
                                        model->rig().rest_positions -
                                        DetailsOf(page, parameters.coefficients);
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 5e-6) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(Learners, PageCharacterTest,
                         testing::Values(Learner::kRegional, Learner::kGp, Learner::kSgplvm));

TEST(PageCharacterSizeTest, TheSizeIsKnownBeforeAndTheSkinIsThere) {
  const auto model = SmallModelBuilder(Learner::kRegional).Build();
  const std::string bytes = EncodePageCharacter(*model);
  EXPECT_LE(bytes.size(), PageCharacterBytes(*model));
  const ReadPage page(bytes);
  EXPECT_EQ(page.head["num_vertices"], 8);
  EXPECT_EQ(page.head["joints"].size(), 3u);
  EXPECT_EQ(page.head["joints"][2]["parent"], 1);
  EXPECT_EQ(page.Buffer<float>("rest").size(), 24u);
  EXPECT_EQ(page.Buffer<uint8_t>("bones").size(), 64u);
  EXPECT_EQ(page.Buffer<float>("weights")[1], .25f);
  EXPECT_EQ(page.Buffer<uint32_t>("triangles").size(), 36u);
}

}  // namespace
}  // namespace pleat
