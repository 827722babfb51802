#include "cli/io/draco_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/test_sequence.h"
#include "pleat/base/file.h"
#include "pleat/stream/frame_encoder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

class DracoFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    const MeshSequence sequence = MovingTetrahedron(2);
    absl::StatusOr<FrameEncoder> encoder =
        FrameEncoder::Create(sequence.topology(), sequence.frame(0));
    ASSERT_THAT(encoder, IsOk());
    DracoFolderWriter writer(folder_.path(), {30, 1});
    for (int t = 0; t < 2; ++t) {
      ASSERT_THAT(writer.AddFrame(encoder->Encode(sequence.frame(t)).value()), IsOk());
    }
    EXPECT_FALSE(IsDracoFolder(folder_.path()));  // not complete yet
    ASSERT_THAT(writer.Finish(encoder->header()), IsOk());
    ASSERT_TRUE(IsDracoFolder(folder_.path()));
    header_ = nlohmann::json::parse(ReadFile(folder_.File("stream.json")).value());
  }

  // What reading says about the folder with this header.
  absl::Status ReadWith(const std::string& header_text) {
    EXPECT_THAT(WriteFile(folder_.File("stream.json"), header_text), IsOk());
    return ReadDracoFolder(folder_.path()).status();
  }

  TemporaryFolder folder_;
  nlohmann::json header_;
};

TEST_F(DracoFolder, EveryFieldOfTheHeaderIsNeeded) {
  EXPECT_THAT(ReadWith(header_.dump()), IsOk());
  for (const auto& [field, value] : header_.items()) {
    nlohmann::json without = header_;
    without.erase(field);
    EXPECT_FALSE(ReadWith(without.dump()).ok()) << field;
  }
}

TEST_F(DracoFolder, NonsenseInTheHeaderIsAnErrorNotACrash) {
  for (const auto& [field, value] : header_.items()) {
    for (const nlohmann::json& nonsense :
         {nlohmann::json(nullptr), nlohmann::json("x"), nlohmann::json(-1),
          nlohmann::json(2147483647), nlohmann::json::array({1, 2}), nlohmann::json::object()}) {
      nlohmann::json changed = header_;
      changed[field] = nonsense;
      const absl::Status status = ReadWith(changed.dump());
      // A frame rate may be any positive number.
      if (field.rfind("fps_", 0) == 0) continue;
      EXPECT_FALSE(status.ok()) << field << nonsense;
    }
  }
  EXPECT_FALSE(ReadWith("").ok());
  EXPECT_FALSE(ReadWith(header_.dump().substr(0, 50)).ok());
}

TEST_F(DracoFolder, AMissingFrameIsNamed) {
  header_["num_frames"] = 3;
  EXPECT_THAT(ReadWith(header_.dump()),
              HasStatus(absl::StatusCode::kNotFound, ::testing::HasSubstr("frame_0002.drc")));
}

TEST_F(DracoFolder, ADamagedFrameIsNamed) {
  ASSERT_THAT(WriteFile(folder_.File("frame_0001.drc"), "DRACO, but not really"), IsOk());
  const absl::Status status = ReadDracoFolder(folder_.path()).status();
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("frame_0001.drc"));
}

}  // namespace
}  // namespace pleat
