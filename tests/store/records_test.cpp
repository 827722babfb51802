#include "pleat/store/records.h"

#include <google/protobuf/stubs/logging.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <set>

#include "pleat/base/file.h"
#include "pleat/base/random.h"
#include "pleat/store/catalog.h"
#include "pleat/store/v1/records.pb.h"
#include "pleat/wire/service_messages.h"
#include "store/record_samples.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

std::string Golden(const std::string& name) {
  absl::StatusOr<std::string> bytes =
      ReadFile(InSourceFolder("tests/golden/records/" + name + ".bin"));
  EXPECT_THAT(bytes, IsOk());
  return bytes.value_or("");
}

template <typename Info>
void ExpectSameClip(const Info& a, const Info& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.num_frames, b.num_frames);
  EXPECT_EQ(a.num_vertices, b.num_vertices);
  EXPECT_EQ(a.num_faces, b.num_faces);
  EXPECT_EQ(a.frame_rate, b.frame_rate);
  EXPECT_EQ(a.size_bytes, b.size_bytes);
}

SequenceInfo StoredSample() {  // SampleSequence as it comes back
  SequenceInfo info = SampleSequence();
  info.name = "Gr\xc3\xbc\xc3\x9f\xef\xbf\xbd";
  return info;
}

void ExpectSame(const JobInfo& a, const JobInfo& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.state, b.state);
  EXPECT_EQ(a.sequence_ids, b.sequence_ids);
  EXPECT_TRUE(a.options == b.options);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.rig_id, b.rig_id);
  EXPECT_EQ(a.request_id, b.request_id);
  EXPECT_EQ(a.client, b.client);
  EXPECT_EQ(a.stage, b.stage);
  EXPECT_EQ(a.fraction, b.fraction);
  EXPECT_EQ(a.objective, b.objective);
  EXPECT_EQ(a.eta_seconds, b.eta_seconds);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.result_id, b.result_id);
}

void ExpectSame(const TrainingRecord& a, const TrainingRecord& b) {
  EXPECT_EQ(a.learner, b.learner);
  EXPECT_EQ(a.num_frames, b.num_frames);
  EXPECT_EQ(a.rest_frame, b.rest_frame);
  EXPECT_EQ(a.yaw_degrees, b.yaw_degrees);
  EXPECT_EQ(a.rig_residual, b.rig_residual);
  EXPECT_EQ(a.diagonal_m, b.diagonal_m);
  EXPECT_EQ(a.fit.mean_percent, b.fit.mean_percent);
  EXPECT_EQ(a.fit.rms_percent, b.fit.rms_percent);
  EXPECT_EQ(a.fit.p95_percent, b.fit.p95_percent);
  EXPECT_EQ(a.fit.max_percent, b.fit.max_percent);
  EXPECT_EQ(a.fit.mean_mm, b.fit.mean_mm);
  EXPECT_EQ(a.fit.motion_mean_percent, b.fit.motion_mean_percent);
  EXPECT_EQ(a.reconstruction.mean_mm, b.reconstruction.mean_mm);
  EXPECT_EQ(a.warnings, b.warnings);
  ASSERT_EQ(a.worst_frames.size(), b.worst_frames.size());
  for (size_t i = 0; i < a.worst_frames.size(); ++i) {
    EXPECT_EQ(a.worst_frames[i].clip, b.worst_frames[i].clip);
    EXPECT_EQ(a.worst_frames[i].frame, b.worst_frames[i].frame);
    EXPECT_EQ(a.worst_frames[i].mean_percent, b.worst_frames[i].mean_percent);
  }
  EXPECT_EQ(a.joint_fit_percent, b.joint_fit_percent);
  EXPECT_EQ(a.pose_jitter_degrees, b.pose_jitter_degrees);
  EXPECT_EQ(a.unsmoothed_jitter_degrees, b.unsmoothed_jitter_degrees);
  EXPECT_EQ(a.unsmoothed_rms_percent, b.unsmoothed_rms_percent);
  EXPECT_EQ(a.validation.num_held_out_frames, b.validation.num_held_out_frames);
  EXPECT_EQ(a.validation.mean_percent, b.validation.mean_percent);
}

void ExpectSame(const ModelInfo& a, const ModelInfo& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.skeleton.num_joints(), b.skeleton.num_joints());
  for (int j = 0; j < a.skeleton.num_joints(); ++j) {
    EXPECT_EQ(a.skeleton.joint(j).name, b.skeleton.joint(j).name);
    EXPECT_EQ(a.skeleton.parent(j), b.skeleton.parent(j));
    EXPECT_EQ(a.skeleton.rest_position(j), b.skeleton.rest_position(j));
  }
  EXPECT_EQ(a.frame_rate, b.frame_rate);
  EXPECT_EQ(a.num_vertices, b.num_vertices);
  EXPECT_EQ(a.num_faces, b.num_faces);
  EXPECT_EQ(a.num_control_vertices, b.num_control_vertices);
  EXPECT_EQ(a.num_components, b.num_components);
  EXPECT_EQ(a.size_bytes, b.size_bytes);
  EXPECT_EQ(a.memory_bytes, b.memory_bytes);
  EXPECT_EQ(a.options, b.options);
  ExpectSame(a.record, b.record);
}

void ExpectSame(const CompressedSequenceInfo& a, const CompressedSequenceInfo& b) {
  ExpectSameClip(a, b);
  ASSERT_EQ(a.record.has_value(), b.record.has_value());
  if (!a.record) return;
  EXPECT_EQ(a.record->sequence_id, b.record->sequence_id);
  EXPECT_EQ(a.record->options, b.record->options);
  EXPECT_EQ(a.record->summary.num_bytes, b.record->summary.num_bytes);
  EXPECT_EQ(a.record->summary.num_topology_bytes, b.record->summary.num_topology_bytes);
  EXPECT_EQ(a.record->summary.bpvf, b.record->summary.bpvf);
  EXPECT_EQ(a.record->summary.bpvf_without_topology, b.record->summary.bpvf_without_topology);
  EXPECT_EQ(a.record->summary.kg_percent, b.record->summary.kg_percent);
  EXPECT_EQ(a.record->summary.max_error_mm, b.record->summary.max_error_mm);
  EXPECT_EQ(a.record->encode_seconds, b.record->encode_seconds);
  EXPECT_EQ(a.record->decode_seconds, b.record->decode_seconds);
}

// The files were written by the code of 0.1.0, which stored serialized pleat.v1 messages.
TEST(RecordsTest, RowsOfTheFirstVersionAreRead) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto sequence, DecodeSequenceRecord(Golden("sequence")));
  ExpectSameClip(sequence, StoredSample());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto training, DecodeJobRecord(Golden("training_job")));
  ExpectSame(training, SampleTrainingJob());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto compression, DecodeJobRecord(Golden("compression_job")));
  ExpectSame(compression, SampleCompressionJob());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, DecodeModelRecord(Golden("model")));
  ExpectSame(model, SampleModel());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto compressed,
                             DecodeCompressedSequenceRecord(Golden("compressed_sequence")));
  ExpectSame(compressed, SampleCompressedSequence());
}

TEST(RecordsTest, WhatCameLaterIsKept) {
  JobInfo job = SampleTrainingJob();
  job.request_id = "0123456789abcdef";
  job.client = "token:5d0f";
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo read, DecodeJobRecord(EncodeRecord(job)));
  ExpectSame(read, job);
}

TEST(RecordsTest, EqualContentGivesTheBytesOfTheFirstVersion) {
  EXPECT_EQ(EncodeRecord(SampleSequence()), Golden("sequence"));
  EXPECT_EQ(EncodeRecord(SampleTrainingJob()), Golden("training_job"));
  EXPECT_EQ(EncodeRecord(SampleCompressionJob()), Golden("compression_job"));
  EXPECT_EQ(EncodeRecord(SampleModel()), Golden("model"));
  EXPECT_EQ(EncodeRecord(SampleCompressedSequence()), Golden("compressed_sequence"));
}

TEST(RecordsTest, JobsKeepTheirTimesToTheMillisecond) {
  JobInfo job = SampleTrainingJob();
  job.created = absl::FromUnixMillis(1'796'072'709'123);
  job.started = *job.created + absl::Milliseconds(1);
  job.ended = *job.created + absl::Hours(30);
  job.result_ttl = absl::Hours(1);
  const JobInfo read = DecodeJobRecord(EncodeRecord(job)).value();
  EXPECT_EQ(read.created, job.created);
  EXPECT_EQ(read.started, job.started);
  EXPECT_EQ(read.ended, job.ended);
  EXPECT_EQ(read.result_ttl, job.result_ttl);
  // Rows of 0.1.0 have none.
  const JobInfo old = DecodeJobRecord(Golden("training_job")).value();
  EXPECT_TRUE(!old.created && !old.started && !old.ended);
  EXPECT_EQ(old.result_ttl, kKeepForEver);
}

// A whole catalog of 0.1.0, not only its rows.
TEST(RecordsTest, ACatalogOfTheFirstVersionIsRead) {
  TemporaryFolder folder;
  std::filesystem::copy_file(InSourceFolder("tests/golden/records/catalogue.db"),
                             folder.File("c.db"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(folder.File("c.db")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto jobs, catalog->List(EntryKind::kJob));
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].attempts, 2);
  ExpectSame(DecodeJobRecord(jobs[0].record).value(), SampleTrainingJob());
  EXPECT_EQ(jobs[1].attempts, 1);
  ExpectSame(DecodeJobRecord(jobs[1].record).value(), SampleCompressionJob());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, catalog->Get(EntryKind::kModel, SampleModel().id));
  ExpectSame(DecodeModelRecord(model.record).value(), SampleModel());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto sequences, catalog->List(EntryKind::kSequence));
  ASSERT_EQ(sequences.size(), 1u);
  ExpectSameClip(DecodeSequenceRecord(sequences[0].record).value(), StoredSample());
  EXPECT_EQ(catalog->List(EntryKind::kCompressedSequence)->size(), 1u);
}

// The messages that 0.1.0 serialized. The day pleat.v1 goes its own way, this test goes; the golden
// files above stay.
TEST(RecordsTest, MessagesOfTheWireAreReadAsRecords) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto sequence,
                             DecodeSequenceRecord(ToProto(SampleSequence()).SerializeAsString()));
  ExpectSameClip(sequence, StoredSample());
  for (const JobInfo& sample : {SampleTrainingJob(), SampleCompressionJob()}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto job,
                               DecodeJobRecord(ToProto(sample).SerializeAsString()));
    ExpectSame(job, sample);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             DecodeModelRecord(ToProto(SampleModel()).SerializeAsString()));
  ExpectSame(model, SampleModel());
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const auto compressed,
      DecodeCompressedSequenceRecord(ToProto(SampleCompressedSequence()).SerializeAsString()));
  ExpectSame(compressed, SampleCompressedSequence());
}

TEST(RecordsTest, EveryGoalAndStateComesBack) {
  for (const CompressOptions& options :
       {CompressOptions{.goal = CompressionGoal::kMaxError, .max_error_mm = .25},
        CompressOptions{.goal = CompressionGoal::kKg, .kg_percent = 2.5, .keep_face_order = false},
        CompressOptions{.goal = CompressionGoal::kGrid, .grid_bits = 13}}) {
    JobInfo job = SampleCompressionJob();
    job.options = options;
    EXPECT_EQ(DecodeJobRecord(EncodeRecord(job))->options, JobOptions(options));
  }
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                               JobState::kFailed, JobState::kCancelled}) {
    JobInfo job = SampleCompressionJob();
    job.state = state;
    EXPECT_EQ(DecodeJobRecord(EncodeRecord(job))->state, state);
  }
  CompressedSequenceInfo uploaded = SampleCompressedSequence();
  uploaded.record.reset();
  ExpectSame(DecodeCompressedSequenceRecord(EncodeRecord(uploaded)).value(), uploaded);
}

TEST(RecordsTest, ACheckpointNamesItsJob) {
  EXPECT_EQ(DecodeCheckpointRecord(EncodeRecord(CheckpointInfo{"job-7"}))->job_id, "job-7");
  for (const std::string& id : {std::string(), std::string(65, 'a')}) {
    EXPECT_THAT(DecodeCheckpointRecord(EncodeRecord(CheckpointInfo{id})),
                HasStatus(absl::StatusCode::kDataLoss, testing::HasSubstr("job_id")));
  }
}

TEST(RecordsTest, EveryTrainOptionHasAFieldOfItsName) {
  std::set<std::string> names;
  const TrainOptions defaults;
  VisitTrainOptions(defaults, [&](const char* name, const auto&) { names.insert(name); });
  const auto* descriptor = store::v1::TrainOptions::descriptor();
  EXPECT_EQ(static_cast<int>(names.size()), descriptor->field_count());
  for (const std::string& name : names) {
    EXPECT_NE(descriptor->FindFieldByName(name), nullptr) << name;
  }
  // Absent fields keep their default.
  store::v1::Job job;
  ASSERT_TRUE(job.ParseFromString(EncodeRecord(SampleTrainingJob())));
  job.mutable_training()->Clear();
  EXPECT_EQ(DecodeJobRecord(job.SerializeAsString())->options, JobOptions(defaults));
  JobInfo placed = SampleTrainingJob();
  TrainOptions options;
  options.placed_joints = {{3, {.1, -1. / 3, 2}}, {0, {0, 1, 0}}};
  placed.options = options;
  EXPECT_EQ(DecodeJobRecord(EncodeRecord(placed))->options, JobOptions(options));
}

TEST(RecordsTest, AnErrorNeverTurnsIntoSuccess) {
  store::v1::Job job;
  ASSERT_TRUE(job.ParseFromString(EncodeRecord(SampleTrainingJob())));
  for (const int code : {0, -1, 17, 1'000'000}) {
    job.mutable_error()->set_code(code);
    EXPECT_THAT(DecodeJobRecord(job.SerializeAsString())->error,
                HasStatus(absl::StatusCode::kUnknown, HasSubstr("no rig fits")));
  }
}

TEST(RecordsTest, ValuesOutOfRangeAreDataLoss) {
  const auto expect_loss = [](const absl::Status& status, const std::string& field) {
    EXPECT_THAT(status, HasStatus(absl::StatusCode::kDataLoss, HasSubstr(field)));
  };
  store::v1::Job good_job;
  ASSERT_TRUE(good_job.ParseFromString(EncodeRecord(SampleTrainingJob())));
  const auto job_loss = [&](auto&& change, const std::string& field) {
    store::v1::Job job = good_job;
    change(&job);
    expect_loss(DecodeJobRecord(job.SerializeAsString()).status(), field);
  };
  job_loss([](store::v1::Job* job) { job->clear_id(); }, "id");
  job_loss([](store::v1::Job* job) { job->clear_state(); }, "state");
  job_loss([](store::v1::Job* job) { job->set_fraction(std::numeric_limits<double>::quiet_NaN()); },
           "fraction");
  job_loss([](store::v1::Job* job) { job->add_sequence_ids("../x"); }, "sequence_ids");
  job_loss([](store::v1::Job* job) { job->set_result_id("x"); }, "result_id");
  job_loss([](store::v1::Job* job) { job->set_rig_id("x"); }, "rig_id");
  job_loss([](store::v1::Job* job) { job->mutable_training()->set_history(0); }, "history");
  job_loss([](store::v1::Job* job) { job->mutable_training()->set_learner("magic"); }, "learner");
  job_loss([](store::v1::Job* job) { job->mutable_training()->set_fit("walk\nhistory=8"); }, "fit");
  job_loss([](store::v1::Job* job) { job->mutable_compression(); }, "goal");

  store::v1::Sequence sequence;
  ASSERT_TRUE(sequence.ParseFromString(EncodeRecord(SampleSequence())));
  sequence.set_num_vertices(-1);
  expect_loss(DecodeSequenceRecord(sequence.SerializeAsString()).status(), "num_vertices");
  sequence.set_num_vertices(1);
  sequence.mutable_frame_rate()->set_denominator(0);
  expect_loss(DecodeSequenceRecord(sequence.SerializeAsString()).status(), "frame_rate");

  store::v1::Model model;
  ASSERT_TRUE(model.ParseFromString(EncodeRecord(SampleModel())));
  model.mutable_skeleton()->mutable_joints(1)->set_parent(1);
  expect_loss(DecodeModelRecord(model.SerializeAsString()).status(), "");
}

TEST(RecordsTest, RandomBytesNeverCrashTheReader) {
  const google::protobuf::LogSilencer quiet;  // it prints a line for every string that is no UTF-8
  Random random(9);
  const std::string good = EncodeRecord(SampleTrainingJob());
  for (int round = 0; round < 5000; ++round) {
    std::string bytes = good;
    for (int k = 0; k < 3; ++k) {
      bytes[random.UniformInt(static_cast<int>(bytes.size()))] =
          static_cast<char>(random.NextBits());
    }
    bytes.resize(random.UniformInt(static_cast<int>(bytes.size()) + 1));
    for (const absl::Status& status :
         {DecodeJobRecord(bytes).status(), DecodeModelRecord(bytes).status(),
          DecodeSequenceRecord(bytes).status(), DecodeCompressedSequenceRecord(bytes).status(),
          DecodeCheckpointRecord(bytes).status()}) {
      EXPECT_TRUE(status.ok() || status.code() == absl::StatusCode::kDataLoss) << status;
    }
  }
}

}  // namespace
}  // namespace pleat
