// Models in the store and in memory, and the sessions that hold them.
#include "pleat/local/local_models.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <thread>

#include "data_folder.h"
#include "infos.h"
#include "pleat/formats/model_file.h"
#include "pleat/local/local_poses.h"
#include "pleat/store/records.h"
#include "pleat/stream/frame_decoder.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class LocalModelsTest : public testing::Test {
 protected:
  LocalModelsTest() {
    folder_.Open();
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      ids_.push_back(Add(*MakeFakeModel(MakeSwayingTube(5), TrainOptions{.seed = seed})));
    }
  }
  std::string Add(const CharacterModel& model) {
    const std::string bytes = EncodeModel(model);
    const ModelInfo info = MakeModelInfo(model, ModelId(bytes), bytes.size());
    EXPECT_THAT(folder_.files().Add(EntryKind::kModel, {info.id, EncodeRecord(info)}, bytes),
                IsOk());
    bytes_ = std::max(bytes_, info.memory_bytes);
    return info.id;
  }

  DataFolder folder_;
  std::vector<std::string> ids_;
  uint64_t bytes_ = 0;  // of one model in memory, the largest
};

TEST_F(LocalModelsTest, OneModelIsLoadedOnceForAllWhoAsk) {
  ModelCache cache(10 * bytes_);
  LocalModels models(&folder_.files(), &cache);
  std::vector<std::shared_ptr<const CharacterModel>> handles(4);
  std::vector<std::thread> threads;
  for (auto& handle : handles) {
    threads.emplace_back([&] { handle = models.Acquire(ids_[0]).value(); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& handle : handles) EXPECT_EQ(handle, handles[0]);
  EXPECT_EQ(models.cache_stats().misses, 1u);
  EXPECT_EQ(models.cache_stats().num_pinned, 1);
  EXPECT_EQ(models.cache_stats().used_bytes, handles[0]->memory_bytes());
  EXPECT_EQ(EncodeModel(*handles[0]), models.Download(ids_[0], {}).value());
}

TEST_F(LocalModelsTest, WhatIsInUseIsNotEvicted) {
  ModelCache cache(bytes_ + bytes_ / 2);
  LocalModels models(&folder_.files(), &cache);  // one and not two
  auto held = models.Acquire(ids_[0]).value();
  EXPECT_THAT(models.Acquire(ids_[1]), HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_EQ(models.Acquire(ids_[0]).value(), held);
  held.reset();
  EXPECT_THAT(models.Acquire(ids_[1]), IsOk());
  EXPECT_EQ(models.cache_stats().evictions, 1u);
  EXPECT_EQ(models.cache_stats().num_entries, 1);
  EXPECT_THAT(models.Acquire(ids_[0]), IsOk());  // is loaded again
}

TEST_F(LocalModelsTest, ADeletedModelLeavesTheMemoryAsWell) {
  ModelCache cache(10 * bytes_);
  LocalModels models(&folder_.files(), &cache);
  ASSERT_THAT(models.Acquire(ids_[0]), IsOk());
  ASSERT_THAT(models.Delete(ids_[0]), IsOk());
  EXPECT_EQ(models.cache_stats().num_entries, 0);
  EXPECT_EQ(models.List()->size(), 2u);
  for (const std::string& id : {ids_[0], std::string("x"), std::string()}) {
    EXPECT_THAT(models.Acquire(id), HasStatus(absl::StatusCode::kNotFound, _));
    EXPECT_THAT(models.Get(id), HasStatus(absl::StatusCode::kNotFound, _));
    EXPECT_THAT(models.Download(id, {}), HasStatus(absl::StatusCode::kNotFound, _));
    EXPECT_THAT(models.OpenDownload(id, 0), HasStatus(absl::StatusCode::kNotFound, _));
    EXPECT_THAT(models.Delete(id), HasStatus(absl::StatusCode::kNotFound, _));
  }
}

TEST_F(LocalModelsTest, PiecesAreThoseOfTheWholeFile) {
  ModelCache cache(10 * bytes_);
  LocalModels models(&folder_.files(), &cache);
  const std::string whole = models.Download(ids_[1], {}).value();
  EXPECT_EQ(whole.size(), models.Get(ids_[1])->size_bytes);
  const auto download = models.OpenDownload(ids_[1], 0).value();
  std::string joined;
  while (joined.size() < whole.size()) {
    const std::string part = download->Next().value();
    ASSERT_FALSE(part.empty());
    joined += part;
  }
  EXPECT_TRUE(joined == whole);
}

// An error of the store is the error of the call, and is not remembered.
TEST_F(LocalModelsTest, ErrorsOfTheStoreArePassedOnAndForgotten) {
  ModelCache cache(10 * bytes_);
  LocalModels models(&folder_.files(), &cache);
  const std::string path = folder_.PathOf(ids_[0]), kept = models.Download(ids_[0], {}).value();
  std::ofstream(path, std::ios::binary) << "damaged";
  EXPECT_THAT(models.Acquire(ids_[0]), HasStatus(absl::StatusCode::kDataLoss, _));
  EXPECT_EQ(models.cache_stats().num_entries, 0);
  std::ofstream(path, std::ios::binary) << kept;
  EXPECT_THAT(models.Acquire(ids_[0]), IsOk());
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kModel, {ids_[2], "\xff\xff"}), IsOk());
  EXPECT_THAT(models.Get(ids_[2]), HasStatus(absl::StatusCode::kDataLoss, _));
  EXPECT_EQ(models.List()->size(), 2u);  // without the one that cannot be read
  EXPECT_THAT(models.Get(ids_[0]), IsOk());
}

class SessionsOfModelsTest : public LocalModelsTest {
 protected:
  void Open(uint64_t cache_bytes) {
    poses_.reset();
    models_.reset();
    cache_ = std::make_unique<ModelCache>(cache_bytes);
    models_ = std::make_unique<LocalModels>(&folder_.files(), cache_.get());
    poses_ = std::make_unique<LocalPoses>(models_.get(), &engine_, /*max_frames=*/100);
  }
  ~SessionsOfModelsTest() override { poses_.reset(); }
  std::unique_ptr<PoseSession> OpenSession(const std::string& id, FrameEncoding encoding) {
    return poses_->OpenSession(id, {.encoder = {.encoding = encoding, .position_bits = 16}})
        .value();
  }
  // The positions that a client of `session` sees, against those of an evaluator of its own.
  static void ExpectTruth(FrameDecoder& decoder, const EncodedFrame& frame,
                          const std::shared_ptr<const CharacterModel>& model, const Pose& pose) {
    EvaluatedFrame truth;
    ASSERT_THAT(PoseEvaluator(model).Evaluate({&pose}, {}, &truth), IsOk());
    Eigen::Matrix3Xf positions;
    ASSERT_THAT(decoder.Decode(frame.draco, frame.mark, &positions), IsOk());
    EXPECT_LT((positions - truth.positions).cwiseAbs().maxCoeff(), 1e-4);
  }

  PoseEngine engine_{{.num_threads = 1}};
  std::unique_ptr<ModelCache> cache_;
  std::unique_ptr<LocalModels> models_;
  std::unique_ptr<LocalPoses> poses_;
};

// Differences are to the last frame of the same session, whatever another one has shown meanwhile.
TEST_F(SessionsOfModelsTest, TwoSessionsOfOneModelDoNotDisturbEachOther) {
  Open(10 * bytes_);
  const auto model = models_->Acquire(ids_[0]).value();
  const PoseTrack track = MakeMotion(model->skeleton(), 8);
  const auto first = OpenSession(ids_[0], FrameEncoding::kDracoDelta);
  const auto second = OpenSession(ids_[0], FrameEncoding::kDracoDelta);
  EXPECT_EQ(models_->cache_stats().misses, 1u);
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder a, FrameDecoder::Create(first->header()));
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder b, FrameDecoder::Create(second->header()));
  for (int t = 0; t < 8; ++t) {
    const Pose &forwards = track.pose(t), &backwards = track.pose(7 - t);
    PLEAT_ASSERT_OK_AND_ASSIGN(const EncodedFrame of_first, first->Show({&forwards}));
    if (t % 3 != 0) {  // the second is slower
      PLEAT_ASSERT_OK_AND_ASSIGN(const EncodedFrame of_second, second->Show({&backwards}));
      ExpectTruth(b, of_second, model, backwards);
    }
    ExpectTruth(a, of_first, model, forwards);
  }
}

TEST_F(SessionsOfModelsTest, AModelThatIsWantedElsewhereStaysWithItsSession) {
  Open(bytes_ + bytes_ / 2);  // one model and not two
  auto session = OpenSession(ids_[0], FrameEncoding::kDracoMesh);
  const auto copy = DecodeModel(models_->Download(ids_[0], {}).value()).value();
  const Pose rest = Pose::Rest(copy->skeleton());
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(session->header()));
  for (const std::string& other : {ids_[1], ids_[2]}) {
    EXPECT_THAT(poses_->OpenSession(other, {}), HasStatus(absl::StatusCode::kResourceExhausted, _));
    PLEAT_ASSERT_OK_AND_ASSIGN(const EncodedFrame frame, session->Show({&rest}));
    ExpectTruth(decoder, frame, copy, rest);
  }
  EXPECT_EQ(models_->cache_stats().num_pinned, 1);
  session.reset();
  EXPECT_EQ(models_->cache_stats().num_pinned, 0);
  EXPECT_THAT(poses_->OpenSession(ids_[1], {}), IsOk());
  EXPECT_THAT(poses_->OpenSession(ids_[2], {}), IsOk());
}

TEST_F(SessionsOfModelsTest, AClipStopsWhereItsConsumerWants) {
  Open(10 * bytes_);
  const PoseTrack track = MakeMotion(models_->Acquire(ids_[0]).value()->skeleton(), 6);
  for (const bool skinned_only : {false, true}) {
    std::vector<int> seen;
    EXPECT_THAT(
        poses_->EvaluateClip(
            {.model_id = ids_[0], .track = track, .bone_scales = {}, .skinned_only = skinned_only},
            [&](int t, const EvaluatedFrame&) {
              seen.push_back(t);
              return t < 3 ? absl::OkStatus() : absl::AbortedError("seen enough");
            }),
        HasStatus(absl::StatusCode::kAborted, HasSubstr("seen enough")));
    EXPECT_EQ(seen, (std::vector<int>{0, 1, 2, 3}));
  }
}

TEST_F(SessionsOfModelsTest, OptionsThatDoNotFitOpenNothing) {
  Open(10 * bytes_);
  const PoseTrack track = MakeMotion(models_->Acquire(ids_[0]).value()->skeleton(), 2);
  const PoseSessionOptions scales{.bone_scales = {1, 1}}, bits{.encoder = {.position_bits = 99}};
  for (const PoseSessionOptions& wrong : {scales, bits}) {
    const auto invalid = HasStatus(absl::StatusCode::kInvalidArgument, _);
    EXPECT_THAT(poses_->OpenSession(ids_[0], wrong), invalid);
    EXPECT_THAT(poses_->OpenClip(ids_[0], track, wrong), invalid);
    EXPECT_THAT(poses_->OpenStream(ids_[0], wrong, {}, nullptr), invalid);
  }
  EXPECT_EQ(models_->cache_stats().num_pinned, 0);
}

}  // namespace
}  // namespace pleat
