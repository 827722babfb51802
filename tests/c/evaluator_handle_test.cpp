#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "c_character.h"
#include "pleat/mesh/normals.h"
#include "support/allocation_counter.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

using EvaluatorHandleTest = CCharacterTest;

TEST_F(EvaluatorHandleTest, AQueryIsTheFrameOfTheEvaluator) {
  Eigen::Matrix3Xf frame;
  for (const int count : {1, 2, 3, 5}) {
    const std::vector<pleat_pose> poses = CHistory(20, count);
    pleat_query query = Query(poses, &frame);
    ASSERT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_OK) << error_.message;
    EXPECT_EQ(query.code, PLEAT_OK);
    ExpectFrame(History(20, count), frame, query.confidence);
  }
}

TEST_F(EvaluatorHandleTest, SkinnedOnlyAndBoneScalesAreThoseOfTheEvaluator) {
  const std::vector<pleat_pose> poses = CHistory(20, 3);
  const std::vector<double> scales = {1, 1.3, .8};
  Eigen::Matrix3Xf frame;
  EvaluatedFrame expected;
  pleat_query query = Query(poses, &frame);
  query.flags = PLEAT_SKINNED_ONLY;
  query.bone_scales = scales.data();
  ASSERT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_OK) << error_.message;
  ASSERT_TRUE(truth_.EvaluateSkinned(track_.pose(20), scales, &expected).ok());
  EXPECT_EQ(frame, expected.positions);
  query.flags = 0;
  ASSERT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_OK) << error_.message;
  ASSERT_TRUE(truth_.Evaluate(History(20, 3), scales, &expected).ok());
  EXPECT_EQ(frame, expected.positions);
}

TEST_F(EvaluatorHandleTest, ABatchGivesTheFramesOfSingleQueriesAndOneErrorStopsNoOther) {
  constexpr int kNumQueries = 21;
  std::vector<Eigen::Matrix3Xf> frames(kNumQueries);
  std::vector<std::vector<pleat_pose>> poses;
  std::vector<pleat_query> queries;
  for (int q = 0; q < kNumQueries; ++q) poses.push_back(CHistory(q + 3, 3));
  for (int q = 0; q < kNumQueries; ++q) queries.push_back(Query(poses[q], &frames[q]));
  queries[7].num_poses = 0;
  poses[11][1].num_joints = 2;
  const std::vector<double> wild = {1, 100, 1};
  queries[13].bone_scales = wild.data();
  EXPECT_EQ(pleat_evaluate(evaluator_.get(), queries.data(), kNumQueries, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("query 7: a query needs at least one pose"));
  for (int q = 0; q < kNumQueries; ++q) {
    if (q == 7 || q == 11 || q == 13) {
      EXPECT_EQ(queries[q].code, PLEAT_INVALID_ARGUMENT) << q;
      EXPECT_EQ(frames[q], Eigen::Matrix3Xf::Constant(3, num_vertices(), -77)) << "no frame";
      continue;
    }
    EXPECT_EQ(queries[q].code, PLEAT_OK) << q;
    ExpectFrame(History(q + 3, 3), frames[q], queries[q].confidence);
  }
  queries[7].num_poses = 1;
  poses[11][1].num_joints = 3;
  EXPECT_EQ(pleat_evaluate(evaluator_.get(), queries.data(), kNumQueries, &error_),
            PLEAT_INVALID_ARGUMENT);
  EXPECT_THAT(error_.message, HasSubstr("query 13: bone scale 100"));
}

// Position, normal and something else for each vertex, as in the vertex buffer of an engine.
TEST_F(EvaluatorHandleTest, FillsInterleavedVertices) {
  constexpr size_t kStride = 8;
  std::vector<float> buffer(kStride * num_vertices(), 5);
  Eigen::Matrix3Xf frame, normals(3, num_vertices());
  const std::vector<pleat_pose> poses = CHistory(9, 3);
  pleat_query query = Query(poses, &frame);
  const size_t num_bytes = buffer.size() * sizeof(float);
  query.positions = {buffer.data(), kStride * sizeof(float), num_bytes};
  query.normals = {buffer.data() + 4, kStride * sizeof(float), num_bytes - 4 * sizeof(float)};
  ASSERT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_OK) << error_.message;
  EvaluatedFrame expected;
  ASSERT_TRUE(truth_.Evaluate(History(9, 3), {}, &expected).ok());
  ComputeVertexNormals(RowsOf(&expected.positions), num_vertices(),
                       character_->topology().triangles(), RowsOf(&normals));
  for (int v = 0; v < num_vertices(); ++v) {
    const float* vertex = buffer.data() + kStride * v;
    EXPECT_EQ(Eigen::Map<const Eigen::Vector3f>(vertex), expected.positions.col(v));
    EXPECT_EQ(Eigen::Map<const Eigen::Vector3f>(vertex + 4), normals.col(v));
    EXPECT_EQ(vertex[3], 5);
    EXPECT_EQ(vertex[7], 5);
  }
}

TEST_F(EvaluatorHandleTest, RowsMustHoldAllVertices) {
  const std::vector<pleat_pose> poses = CHistory(9, 3);
  Eigen::Matrix3Xf frame, normals;
  const auto refused = [&](pleat_rows positions, pleat_rows normal_rows, const char* word) {
    pleat_query query = Query(poses, &frame);
    query.positions = positions;
    query.normals = normal_rows;
    EXPECT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_INVALID_ARGUMENT) << word;
    EXPECT_THAT(error_.message, HasSubstr(word));
    EXPECT_EQ(frame(0, 0), -77);
  };
  const pleat_rows good = RowsOfFrame(&frame), none{};
  const pleat_rows good_normals = RowsOfFrame(&normals);
  const auto with = [&](float* data, size_t stride, size_t num_bytes) {
    return pleat_rows{data, stride, num_bytes};
  };
  refused(with(nullptr, 0, good.num_bytes), none, "positions is NULL");
  refused(with(good.data, 0, good.num_bytes - 1), none, "positions: 1151 bytes for 96 vertices");
  refused(with(good.data, 16, good.num_bytes), none, "16 bytes apart");
  refused(with(good.data, SIZE_MAX - 3, SIZE_MAX), none, "bytes apart");
  refused(with(good.data, 0, 0), none, "0 bytes");
  refused(with(good.data, 8, good.num_bytes), none, "at least 12");
  refused(with(good.data, 13, SIZE_MAX), none, "multiples of 4");
  refused(with(reinterpret_cast<float*>(reinterpret_cast<char*>(good.data) + 1), 12, SIZE_MAX),
          none, "multiples of 4");
  refused(good, with(good_normals.data, 0, 100), "normals: 100 bytes");
  // The last row needs no more than its own twelve bytes.
  std::vector<float> tight(16 * (num_vertices() - 1) / 4 + 3);
  pleat_query query = Query(poses, &frame);
  query.positions = {tight.data(), 16, tight.size() * sizeof(float)};
  EXPECT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_OK) << error_.message;
}

TEST_F(EvaluatorHandleTest, BadArgumentsAreErrors) {
  const std::vector<pleat_pose> poses = CHistory(9, 3);
  Eigen::Matrix3Xf frame;
  pleat_query query = Query(poses, &frame);
  const auto refused = [&](const char* word) {
    EXPECT_EQ(pleat_evaluate(evaluator_.get(), &query, 1, &error_), PLEAT_INVALID_ARGUMENT);
    EXPECT_THAT(error_.message, HasSubstr(word));
    query = Query(poses, &frame);
  };
  query.struct_size = 8;
  refused("struct_size is 8");
  query.struct_size = sizeof(query) + 1;
  refused("the size of no struct");
  query.flags = 6;
  refused("flags 6");
  query.poses = nullptr;
  refused("poses is NULL");
  pleat_pose strange = poses[0];
  std::vector<double> rotations(12, 0.0);
  strange.rotations = rotations.data();
  query.poses = &strange;
  query.num_poses = 1;
  refused("joint 0");
  EXPECT_EQ(pleat_evaluate(nullptr, &query, 1, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_evaluate(evaluator_.get(), nullptr, 1, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_evaluate(evaluator_.get(), nullptr, 0, &error_), PLEAT_OK);
  pleat_evaluator* evaluator = evaluator_.get();
  EXPECT_EQ(pleat_evaluator_create(nullptr, &evaluator, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(evaluator, nullptr);
  EXPECT_EQ(pleat_evaluator_reserve(evaluator_.get(), SIZE_MAX, &error_), PLEAT_INVALID_ARGUMENT);
  EXPECT_EQ(pleat_evaluator_reserve(nullptr, 1, &error_), PLEAT_INVALID_ARGUMENT);
}

// A caller with a later header has longer queries: what this version knows comes first.
TEST_F(EvaluatorHandleTest, LongerQueriesOfALaterHeaderAreUnderstood) {
  struct LaterQuery {
    pleat_query query;
    double more[2];
  };
  const std::vector<pleat_pose> poses[2] = {CHistory(9, 3), CHistory(12, 3)};
  Eigen::Matrix3Xf frames[2];
  LaterQuery queries[2] = {{Query(poses[0], &frames[0]), {}}, {Query(poses[1], &frames[1]), {}}};
  for (LaterQuery& query : queries) query.query.struct_size = sizeof(LaterQuery);
  ASSERT_EQ(pleat_evaluate(evaluator_.get(), &queries[0].query, 2, &error_), PLEAT_OK);
  ExpectFrame(History(9, 3), frames[0], queries[0].query.confidence);
  ExpectFrame(History(12, 3), frames[1], queries[1].query.confidence);
}

TEST_F(EvaluatorHandleTest, AllocatesNothingAfterReserve) {
  if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted here";
  constexpr int kNumQueries = 18;
  ASSERT_EQ(pleat_evaluator_reserve(evaluator_.get(), kNumQueries, &error_), PLEAT_OK);
  std::vector<Eigen::Matrix3Xf> frames(kNumQueries), normals(kNumQueries);
  std::vector<std::vector<pleat_pose>> poses;
  std::vector<pleat_query> queries;
  const std::vector<double> scales = {1, 1.2, 1};
  for (int q = 0; q < kNumQueries; ++q) poses.push_back(CHistory(q + 3, 1 + q % 3));
  for (int q = 0; q < kNumQueries; ++q) {
    queries.push_back(Query(poses[q], &frames[q]));
    queries[q].normals = RowsOfFrame(&normals[q]);
    if (q % 4 == 1) queries[q].bone_scales = scales.data();
    if (q % 5 == 2) queries[q].flags = PLEAT_SKINNED_ONLY;
  }
  const long before = NumAllocations();
  pleat_code code = pleat_evaluate(evaluator_.get(), queries.data(), kNumQueries, &error_);
  const long count = NumAllocations() - before;
  EXPECT_EQ(code, PLEAT_OK) << error_.message;
  EXPECT_EQ(count, 0);
}

// Many threads ask one model, each with an evaluator of its own, while the model's handle goes.
TEST_F(EvaluatorHandleTest, ThreadsShareAModel) {
  constexpr int kNumThreads = 4;
  std::vector<CEvaluator> evaluators;
  for (int i = 0; i < kNumThreads; ++i) {
    pleat_evaluator* evaluator = nullptr;
    ASSERT_EQ(pleat_evaluator_create(model_.get(), &evaluator, nullptr), PLEAT_OK);
    evaluators.emplace_back(evaluator);
  }
  model_.reset();
  std::vector<Eigen::Matrix3Xf> expected;
  for (int t = 3; t < 40; ++t) {
    EvaluatedFrame frame;
    ASSERT_TRUE(truth_.Evaluate(History(t, 3), {}, &frame).ok());
    expected.push_back(frame.positions);
  }
  std::vector<int> num_wrong(kNumThreads);
  std::vector<std::thread> threads;
  for (int i = 0; i < kNumThreads; ++i) {
    threads.emplace_back([&, i] {
      Eigen::Matrix3Xf frame;
      for (int t = 3; t < 40; ++t) {
        const std::vector<pleat_pose> poses = CHistory(t, 3);
        pleat_query query = Query(poses, &frame);
        pleat_error error;
        const pleat_code code = pleat_evaluate(evaluators[i].get(), &query, 1, &error);
        num_wrong[i] += code != PLEAT_OK || frame != expected[t - 3];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(num_wrong, std::vector<int>(kNumThreads));
}

}  // namespace
}  // namespace pleat
