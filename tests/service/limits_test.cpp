// Limits that have to agree with those of other modules, and what every interface must be.
#include "pleat/service/limits.h"

#include <gtest/gtest.h>

#include <type_traits>

#include "pleat/character/train_options.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/service/character_service.h"
#include "support/mock_services.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(LimitsTest, AQueryHoldsTheLongestHistoryThatAModelCanHave) {
  TrainOptions options;
  options.history = static_cast<int>(kMaxPosesPerQuery);
  EXPECT_THAT(ValidateTrainOptions(options), IsOk());
  ++options.history;
  EXPECT_FALSE(ValidateTrainOptions(options).ok());
}

// What the service takes in, its readers must be able to read.
TEST(LimitsTest, TheDefaultsLieWithinThoseOfTheReaders) {
  const ServiceLimits service;
  const MeshLimits readers;
  EXPECT_LE(static_cast<uint64_t>(service.max_upload_bytes), readers.max_file_bytes);
  EXPECT_LE(static_cast<uint64_t>(service.max_rig_bytes), readers.max_document_bytes);
  EXPECT_THAT(CheckCounts({.num_vertices = service.max_vertices,
                           .num_faces = 2 * service.max_vertices,
                           .num_frames = service.max_frames},
                          readers),
              IsOk());
  EXPECT_GE(service.max_clips, 1);
}

TEST(LimitsTest, DefaultsOfASessionAreAllowed) {
  EXPECT_GE(LiveRules().max_in_flight, 1);
  EXPECT_LE(LiveRules().max_in_flight, kMaxPosesInFlight);
  EXPECT_LT(kMaxUploadChunkBytes, ServiceLimits().max_upload_bytes);
}

// Who holds one by its interface must be able to end it.
template <typename... Interfaces>
constexpr bool kAllHaveVirtualDestructors = (std::has_virtual_destructor_v<Interfaces> && ...);
static_assert(kAllHaveVirtualDestructors<CharacterService, SequenceService, JobService,
                                         ModelService, PoseService, CompressedSequenceService>);
static_assert(kAllHaveVirtualDestructors<SequenceUpload, CompressedSequenceUpload, JobSubscription,
                                         PoseSession, ClipSession, PoseStream, DecodeSession>);

// The five services that belong together, as an implementation owns them.
class MockCharacterService final : public CharacterService {
 public:
  explicit MockCharacterService(int* num_alive) : num_alive_(num_alive) { ++*num_alive_; }
  ~MockCharacterService() override { --*num_alive_; }
  SequenceService& sequences() override { return sequences_; }
  JobService& jobs() override { return jobs_; }
  ModelService& models() override { return models_; }
  PoseService& poses() override { return poses_; }
  CompressedSequenceService& compressed_sequences() override { return compressed_; }

  testing::StrictMock<MockModelService> models_;

 private:
  int* num_alive_;
  testing::StrictMock<MockSequenceService> sequences_;
  testing::StrictMock<MockJobService> jobs_;
  testing::StrictMock<MockPoseService> poses_;
  testing::StrictMock<MockCompressedSequenceService> compressed_;
};

TEST(CharacterServiceTest, OwnsTheFiveAndGivesTheSameOnesEveryTime) {
  int num_alive = 0;
  {
    auto mock = std::make_unique<MockCharacterService>(&num_alive);
    EXPECT_CALL(mock->models_, Get("m")).WillOnce(testing::Return(absl::NotFoundError("none")));
    const std::unique_ptr<CharacterService> service = std::move(mock);
    EXPECT_EQ(&service->models(), &service->models());
    EXPECT_THAT(service->models().Get("m"), HasStatus(absl::StatusCode::kNotFound, "none"));
    EXPECT_EQ(num_alive, 1);
  }
  EXPECT_EQ(num_alive, 0);
}

// What has not been said yet must not look like an answer.
TEST(ValueTypesTest, DefaultsAreTheStateBeforeAnythingHappened) {
  const JobInfo job;
  EXPECT_EQ(job.state, JobState::kQueued);
  EXPECT_THAT(job.error, IsOk());
  EXPECT_FALSE(job.objective.has_value() || job.eta_seconds.has_value());
  EXPECT_TRUE(std::holds_alternative<TrainOptions>(job.options));
  EXPECT_FALSE(UploadStatus().complete);
  EXPECT_FALSE(CompressedSequenceInfo().record.has_value());
  EXPECT_FALSE(EncodedFrame().parameters.has_value());
  EXPECT_TRUE(FrameMark().keyframe);
  EXPECT_THAT(LivePose().status, IsOk());
  EXPECT_FALSE(LivePose().restart || LivePose().keyframe);
  EXPECT_THAT(LiveReply().frame, IsOk());
}

}  // namespace
}  // namespace pleat
