// What every CharacterService promises about how long it keeps things.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "pleat/base/file.h"
#include "pleat/base/sha256.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "server/running_service.h"
#include "server/watch_to_end.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class RetentionContractTest : public testing::TestWithParam<Reach> {
 protected:
  RunningService running_{GetParam()};
  CharacterService& service_ = running_.service();
  const std::string unknown_ = std::string(64, '0');
};

// The time of its end is that of its upload and its time to live, to the millisecond.
void ExpectLife(const EntryLife& life, absl::Duration ttl) {
  ASSERT_TRUE(life.created && life.expires);
  EXPECT_EQ(*life.expires - *life.created, ttl);
  EXPECT_FALSE(life.pinned);
}

TEST_P(RetentionContractTest, ASequenceLivesAsLongAsTheLongestUploadSays) {
  const MeshSequence tube = MakeSwayingTube(5);
  SequenceService& sequences = service_.sequences();
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo first, sequences.Upload(tube, {}, absl::Hours(1)));
  ExpectLife(first.life, absl::Hours(1));
  EXPECT_EQ(sequences.Upload(tube, {}, absl::Minutes(1))->life.expires, first.life.expires);
  EXPECT_GT(*sequences.Upload(tube, {}, absl::Hours(2))->life.expires,
            *first.life.created + absl::Hours(1));
  EXPECT_EQ(sequences.Upload(tube, {})->life.expires, std::nullopt);
  EXPECT_EQ(sequences.Upload(tube, {}, absl::Hours(1))->life.expires, std::nullopt);
  EXPECT_EQ(sequences.Get(first.id)->life.created, first.life.created);
  EXPECT_EQ(sequences.List()->at(0).life.created, first.life.created);
}

TEST_P(RetentionContractTest, WhatJobsMakeLivesAsLongAsTheyWereTold) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const JobInfo training,
      service_.jobs().CreateTraining({.sequence_ids = {id}, .model_ttl = absl::Hours(3)}));
  EXPECT_EQ(training.result_ttl, absl::Hours(3));
  const JobInfo trained = WatchToEnd(service_.jobs(), training.id);
  ASSERT_EQ(trained.state, JobState::kSucceeded) << trained.error;
  EXPECT_TRUE(trained.created && trained.started && trained.ended);
  ExpectLife(service_.models().Get(trained.result_id)->life, absl::Hours(3));
  const std::string compression =
      service_.jobs().CreateCompression({.sequence_id = id, .result_ttl = absl::Minutes(5)})->id;
  ExpectLife(
      service_.compressed_sequences().Get(WatchToEnd(service_.jobs(), compression).result_id)->life,
      absl::Minutes(5));
}

TEST_P(RetentionContractTest, ThingsArePinnedAndUnpinned) {
  const std::string sequence = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  const std::string model = running_.TrainModel();
  const std::string file = CompressSequence(MakeSwayingTube(5), {}, nullptr).value();
  const std::string compressed = service_.compressed_sequences().Upload(file, {})->id;
  for (const bool pinned : {true, true, false}) {
    ASSERT_THAT(service_.sequences().SetPinned(sequence, pinned), IsOk());
    ASSERT_THAT(service_.models().SetPinned(model, pinned), IsOk());
    ASSERT_THAT(service_.compressed_sequences().SetPinned(compressed, pinned), IsOk());
    EXPECT_EQ(service_.sequences().Get(sequence)->life.pinned, pinned);
    EXPECT_EQ(service_.models().Get(model)->life.pinned, pinned);
    EXPECT_EQ(service_.compressed_sequences().List()->at(0).life.pinned, pinned);
  }
  EXPECT_THAT(service_.sequences().SetPinned(model, true),
              HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(service_.models().SetPinned(unknown_, true),
              HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(service_.compressed_sequences().SetPinned(unknown_, true),
              HasStatus(absl::StatusCode::kNotFound, _));
}

TEST_P(RetentionContractTest, AnUploadThatWillNotGoOnIsForgotten) {
  const std::string bytes = EncodeSequence(MakeSwayingTube(60, "large", 100, 30));
  const std::string id = SequenceId(bytes);
  SequenceService& sequences = service_.sequences();
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, sequences.BeginUpload(id, bytes.size(), 0));
    ASSERT_THAT(upload->Append(std::string_view(bytes).substr(0, 1'000'000)), IsOk());
    EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kFailedPrecondition, _));
  }
  EXPECT_EQ(sequences.QueryUpload(id)->received_bytes, 1'000'000u);
  ASSERT_THAT(sequences.DeleteUpload(id), IsOk());
  EXPECT_EQ(sequences.QueryUpload(id)->received_bytes, 0u);
  EXPECT_THAT(sequences.DeleteUpload(id), HasStatus(absl::StatusCode::kNotFound, HasSubstr(id)));
  // While somebody writes it, it is his.
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto held,
                             running_.local().sequences().BeginUpload(id, bytes.size(), 0));
  EXPECT_THAT(sequences.DeleteUpload(id), HasStatus(absl::StatusCode::kAborted, _));
}

// OK came back for a file that was damaged or gone, as long as its row was there.
TEST_P(RetentionContractTest, UploadingDamagedContentAgainRepairsIt) {
  const MeshSequence tube = MakeSwayingTube(5);
  const std::string id = service_.sequences().Upload(tube, {})->id;
  const std::string path = running_.data_dir() + "/blobs/" + id.substr(0, 2) + "/" + id;
  for (const bool is_gone : {false, true}) {
    is_gone ? static_cast<void>(std::filesystem::remove(path))
            : std::filesystem::resize_file(path, 10);
    EXPECT_EQ(service_.sequences().Upload(tube, {})->id, id);
    EXPECT_EQ(ReadFile(path).value(), EncodeSequence(tube));
  }
}

INSTANTIATE_TEST_SUITE_P(Reach, RetentionContractTest,
                         testing::Values(Reach::kLocal, Reach::kInProcess, Reach::kSocket),
                         [](const auto& info) { return ReachName(info.param); });

}  // namespace
}  // namespace pleat
