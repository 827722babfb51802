#include "pleat/service/shared_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/mock_services.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::_;
using testing::HasSubstr;
using testing::Return;

constexpr absl::StatusCode kNotFound = absl::StatusCode::kNotFound;
constexpr absl::StatusCode kDenied = absl::StatusCode::kPermissionDenied;

class SharedServiceTest : public testing::Test {
 protected:
  SharedServiceTest() {
    ON_CALL(models_, Get(_)).WillByDefault([](const std::string& id) -> absl::StatusOr<ModelInfo> {
      if (id != "model" && id != "other") return absl::NotFoundError(id);
      ModelInfo info;
      info.id = id;
      return info;
    });
    ON_CALL(sequences_, Get(_))
        .WillByDefault([](const std::string& id) -> absl::StatusOr<SequenceInfo> {
          if (id == "gone" || id == "model") return absl::NotFoundError(id);
          SequenceInfo info;
          info.id = id;
          return info;
        });
    ON_CALL(jobs_, ListPage(_)).WillByDefault([](const PageRequest&) {
      Page<JobInfo> page;
      page.items.resize(3);
      page.items[0].id = "its job";
      page.items[0].result_id = "model";
      page.items[0].sequence_ids = {"take", "gone"};
      page.items[1].result_id = "other";
      page.items[1].sequence_ids = {"secret"};
      page.items[2].id = "running";
      return absl::StatusOr<Page<JobInfo>>(std::move(page));
    });
  }

  testing::NiceMock<MockSequenceService> sequences_;
  testing::NiceMock<MockJobService> jobs_;
  testing::NiceMock<MockModelService> models_;
  testing::NiceMock<MockPoseService> poses_;
  const std::unique_ptr<CharacterService> shared_ = MakeSharedService(
      {.sequences = &sequences_, .jobs = &jobs_, .models = &models_, .poses = &poses_},
      {"model", "take"});
};

TEST_F(SharedServiceTest, ListsHaveWhatIsSharedAlone) {
  const auto models = shared_->models().List().value();
  ASSERT_EQ(models.size(), 1u);
  EXPECT_EQ(models[0].id, "model");
  const auto sequences = shared_->sequences().List().value();
  ASSERT_EQ(sequences.size(), 1u);
  EXPECT_EQ(sequences[0].id, "take");
  const auto jobs = shared_->jobs().List().value();
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_EQ(jobs[0].id, "its job");
  EXPECT_TRUE(shared_->compressed_sequences().List().value().empty());
  EXPECT_THAT(shared_->models().ListPage({.size = -1}),
              HasStatus(absl::StatusCode::kInvalidArgument, _));
}

TEST_F(SharedServiceTest, EverythingElseIsNotThere) {
  EXPECT_CALL(models_, Get("other")).Times(0);
  EXPECT_CALL(models_, Download(_, _)).Times(0);
  EXPECT_CALL(sequences_, OpenDownload(_, _)).Times(0);
  EXPECT_CALL(poses_, EvaluateClip(_, _)).Times(0);
  EXPECT_THAT(shared_->models().Get("other"), HasStatus(kNotFound, HasSubstr("other")));
  EXPECT_THAT(shared_->models().Download("other", {}), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->models().OpenDownload("other", 0), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->sequences().OpenDownload("secret", 0), HasStatus(kNotFound, _));
  ClipQuery query;
  query.model_id = "other";
  EXPECT_THAT(shared_->poses().EvaluateClip(query, {}), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->poses().OpenSession("other", {}), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->poses().OpenClip("other", {}, {}), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->poses().OpenStream("other", {}, {}, nullptr), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->compressed_sequences().Get("any"), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->compressed_sequences().OpenDecode("any", {}), HasStatus(kNotFound, _));
  JobInfo running;
  EXPECT_CALL(jobs_, Get("running")).WillRepeatedly(Return(running));
  EXPECT_THAT(shared_->jobs().Get("running"), HasStatus(kNotFound, _));
  EXPECT_THAT(shared_->jobs().Subscribe("running", [] {}), HasStatus(kNotFound, _));
}

TEST_F(SharedServiceTest, NothingIsChanged) {
  EXPECT_CALL(models_, Delete(_)).Times(0);
  EXPECT_CALL(jobs_, CreateTraining(_)).Times(0);
  EXPECT_CALL(sequences_, QueryUpload(_)).Times(0);
  EXPECT_THAT(shared_->models().Delete("model"), HasStatus(kDenied, HasSubstr("shared")));
  EXPECT_THAT(shared_->models().SetPinned("model", true), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->sequences().Delete("take"), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->sequences().SetPinned("take", true), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->sequences().QueryUpload("take"), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->sequences().BeginUpload("take", 1, 0), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->sequences().DeleteUpload("take"), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->jobs().CreateTraining({}), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->jobs().CreateCompression({}), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->jobs().Cancel("its job"), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->jobs().Delete("its job"), HasStatus(kDenied, _));
  EXPECT_THAT(shared_->compressed_sequences().Delete("any"), HasStatus(kDenied, _));
}

class WholeService : public CharacterService {
 public:
  WholeService(MockSequenceService* sequences, MockJobService* jobs, MockModelService* models)
      : sequences_(sequences), jobs_(jobs), models_(models) {}
  SequenceService& sequences() override { return *sequences_; }
  JobService& jobs() override { return *jobs_; }
  ModelService& models() override { return *models_; }
  PoseService& poses() override { return *poses_; }
  CompressedSequenceService& compressed_sequences() override { return *compressed_; }

 private:
  MockSequenceService* const sequences_;
  MockJobService* const jobs_;
  MockModelService* const models_;
  PoseService* const poses_ = nullptr;
  CompressedSequenceService* const compressed_ = nullptr;
};

TEST_F(SharedServiceTest, AModelIsSharedWithItsSequencesThatAreThere) {
  WholeService all(&sequences_, &jobs_, &models_);
  EXPECT_EQ(ContentOfModel(&all, "model").value(), (std::set<std::string>{"model", "take"}));
  EXPECT_THAT(ContentOfModel(&all, "unknown"), HasStatus(kNotFound, _));
}

}  // namespace
}  // namespace pleat
