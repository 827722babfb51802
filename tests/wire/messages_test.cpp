// Every ToProto has a FromProto that gives the same value back, and refuses what is hostile.
#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <type_traits>
#include <utility>

#include "pleat/base/random.h"
#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/training_messages.h"
#include "support/not_a_number.h"
#include "support/option_choices.h"
#include "support/status_matchers.h"
#include "wire/message_samples.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Skeleton SmallSkeleton() {
  return Skeleton::Create({{"hips", -1, {0, 1, 0}}, {"chest", 0, {0, 1.4, .01}}}).value();
}

TrainOptions ChangedOptions() {
  TrainOptions options = TrainOptions::Paper();
  options.learner = LearnerChoice::kGp;
  options.rotations = RotationRepresentation::kQuaternion;
  options.deformation = DetailBase::kRoot;
  options.detail_coordinates = DetailCoordinates::kDifferential;
  options.history = 3;
  options.rest_frame = 17;
  options.yaw_degrees = 90.5;
  options.latent_dimensions = 7;
  options.iterations = 321;
  options.dynamics_weight = .125;
  options.detail_energy = .5;
  options.max_components = 11;
  options.seed = std::numeric_limits<uint64_t>::max();
  options.placed_joints = {{3, {.1, 1. / 3, -2}}, {0, {0, 1, 0}}};
  return options;
}

TEST(MessagesTest, EveryTrainOptionCrossesTheWire) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions defaults, FromProto(v1::TrainOptions()));
  EXPECT_EQ(defaults, TrainOptions());
  const TrainOptions changed = ChangedOptions();
  PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions back, FromProto(Reparse(ToProto(changed))));
  EXPECT_EQ(back, changed);
  // The one list of options and the proto have the same names.
  std::set<std::string> names;
  VisitTrainOptions(changed, [&](const char* name, const auto&) { names.insert(name); });
  const auto* descriptor = v1::TrainOptions::descriptor();
  EXPECT_EQ(static_cast<int>(names.size()), descriptor->field_count());
  for (const std::string& name : names) {
    EXPECT_NE(descriptor->FindFieldByName(name), nullptr) << name;
  }
  v1::TrainOptions bad;
  bad.set_history(0);
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("history")));
  bad.Clear();
  bad.set_placed_joints("tail=1,2,3");
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument,
                                        AllOf(HasSubstr("placed_joints"), HasSubstr("'tail'"))));
}

TEST(MessagesTest, ChoicesTravelByNameAndUnknownNamesAreRefused) {
  const auto* descriptor = v1::TrainOptions::descriptor();
  std::string last_option;
  ForEachChoice(
      [&](const std::string& option, const std::string& name, const TrainOptions& options) {
        const v1::TrainOptions message = ToProto(options);
        const auto* field = descriptor->FindFieldByName(option);
        EXPECT_EQ(message.GetReflection()->GetString(message, field), name) << option;
        PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions back, FromProto(Reparse(message)));
        EXPECT_EQ(back, options) << option << " " << name;
        if (std::exchange(last_option, option) == option) return;
        for (const char* unknown : {"magic", ""}) {
          v1::TrainOptions bad;
          bad.GetReflection()->SetString(&bad, field, unknown);
          EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument,
                                                AllOf(HasSubstr(option), HasSubstr(name))));
        }
      });
}

TEST(MessagesTest, PosesAndTracksAreExact) {
  Random random(4);
  for (int round = 0; round < 20; ++round) {
    PoseTrack::Parts parts{.fps = random.Uniform(1, 120), .clip_starts = {0, 3}};
    for (int t = 0; t < 7; ++t) parts.poses.push_back(RandomPose(&random, 18));
    const PoseTrack track = PoseTrack::FromValid(std::move(parts));
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack back, FromProto(Reparse(ToProto(track))));
    EXPECT_EQ(back.fps(), track.fps());
    EXPECT_EQ(back.clip_starts(), track.clip_starts());
    for (int t = 0; t < 7; ++t) EXPECT_TRUE(SamePose(back.pose(t), track.pose(t)));
  }
}

TEST(MessagesTest, HostilePosesAreRefused) {
  Random random(4);
  const v1::Pose good = ToProto(RandomPose(&random, 3));
  ASSERT_THAT(FromProto(good), IsOk());
  v1::Pose bad = good;
  bad.mutable_root_position()->set_y(kNan);
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("root")));
  bad = good;
  bad.mutable_rotations(1)->set_w(kNan);
  EXPECT_THAT(FromProto(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rotations[1]")));
  bad = good;
  *bad.mutable_rotations(2) = v1::Quaternion();
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("norm 0")));
  EXPECT_FALSE(FromProto(v1::Pose()).ok());
  bad.clear_rotations();
  for (int j = 0; j <= kMaxWireJoints; ++j) bad.add_rotations()->set_w(1);
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("1024")));

  v1::PoseTrack track;
  EXPECT_FALSE(FromProto(track).ok());
  track.set_fps(30);
  EXPECT_THAT(FromProto(track), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("empty")));
  *track.add_poses() = good;
  *track.add_poses() = good;
  EXPECT_EQ(FromProto(track)->clip_starts(), std::vector<int>{0});
  for (const std::vector<int>& starts :
       std::vector<std::vector<int>>{{1}, {0, 0}, {0, 2}, {0, -1}, {0, 1, 1}}) {
    track.clear_clip_starts();
    for (const int start : starts) track.add_clip_starts(start);
    EXPECT_THAT(FromProto(track),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("clip_starts")));
  }
  track.clear_clip_starts();
  for (const double fps : {0.0, -1.0, 1e9, kNan}) {
    track.set_fps(fps);
    EXPECT_THAT(FromProto(track), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("fps")));
  }
}

TEST(MessagesTest, SequencesJobsAndModelsComeBack) {
  SequenceInfo sequence{kId,
                        "Gr\xc3\xbc\xc3\x9f"
                        "e",
                        175,
                        9971,
                        19938,
                        {30000, 1001},
                        1u << 31};
  PLEAT_ASSERT_OK_AND_ASSIGN(const SequenceInfo s, FromProto(Reparse(ToProto(sequence))));
  EXPECT_EQ(s.id, sequence.id);
  EXPECT_EQ(s.name, sequence.name);
  EXPECT_EQ(s.num_frames, 175);
  EXPECT_EQ(s.frame_rate, sequence.frame_rate);
  EXPECT_EQ(s.size_bytes, sequence.size_bytes);

  JobInfo job;
  job.id = "job-1";
  job.state = JobState::kFailed;
  job.sequence_ids = {kId, std::string(64, 'b')};
  job.options = ChangedOptions();
  job.name = "m";
  job.stage = "learn";
  job.fraction = .25;
  job.objective = -3.5;
  job.warnings = {"w1", "w2"};
  job.error = absl::FailedPreconditionError("no rig fits");
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo j, FromProto(Reparse(ToProto(job))));
  EXPECT_EQ(j.state, job.state);
  EXPECT_EQ(j.sequence_ids, job.sequence_ids);
  EXPECT_TRUE(j.options == job.options);
  EXPECT_EQ(j.objective, job.objective);
  EXPECT_EQ(j.eta_seconds, std::nullopt);
  EXPECT_EQ(j.warnings, job.warnings);
  EXPECT_EQ(j.error, job.error);

  ModelInfo model;
  model.id = kId;
  model.skeleton = SmallSkeleton();
  model.num_vertices = 5;
  model.memory_bytes = 7;
  model.options = ChangedOptions();
  model.record.learner = "gp";
  model.record.fit.rms_percent = 1.25;
  model.record.reconstruction.mean_mm = .5;
  model.record.warnings = {"careful"};
  model.record.worst_frames = {{1, 7, 2.5}};
  model.record.joint_fit_percent = {0, .5};
  model.record.pose_jitter_degrees = .25;
  model.record.unsmoothed_jitter_degrees = .375;
  model.record.unsmoothed_rms_percent = .625;
  model.record.validation = {9, {{"gp", .25}, {"sgplvm", .5}}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const ModelInfo m, FromProto(Reparse(ToProto(model))));
  EXPECT_EQ(m.skeleton.joint(1).name, "chest");
  EXPECT_EQ(m.skeleton.rest_position(1), model.skeleton.rest_position(1));
  EXPECT_EQ(m.options, model.options);
  EXPECT_EQ(m.record.fit.rms_percent, 1.25);
  EXPECT_EQ(m.record.reconstruction.mean_mm, .5);
  EXPECT_EQ(m.record.warnings, model.record.warnings);
  ASSERT_EQ(m.record.worst_frames.size(), 1u);
  EXPECT_EQ(m.record.worst_frames[0].clip, 1);
  EXPECT_EQ(m.record.worst_frames[0].frame, 7);
  EXPECT_EQ(m.record.worst_frames[0].mean_percent, 2.5);
  EXPECT_EQ(m.record.joint_fit_percent, model.record.joint_fit_percent);
  EXPECT_EQ(m.record.pose_jitter_degrees, .25);
  EXPECT_EQ(m.record.unsmoothed_jitter_degrees, .375);
  EXPECT_EQ(m.record.unsmoothed_rms_percent, .625);
  EXPECT_EQ(m.record.validation.num_held_out_frames, 9);
  EXPECT_EQ(m.record.validation.mean_percent, model.record.validation.mean_percent);
}

TEST(MessagesTest, CompressionsComeBack) {
  for (const CompressOptions& options :
       {CompressOptions{.goal = CompressionGoal::kMaxError, .max_error_mm = .25},
        CompressOptions{.goal = CompressionGoal::kKg, .kg_percent = 2.5, .keep_face_order = false},
        CompressOptions{.goal = CompressionGoal::kGrid, .grid_bits = 13}}) {
    EXPECT_EQ(FromProto(Reparse(ToProto(options))).value(), options);
    JobInfo job;
    job.id = "job-1";
    job.options = options;
    EXPECT_EQ(FromProto(Reparse(ToProto(job)))->options, JobOptions(options));
  }
  v1::CompressOptions bad;
  EXPECT_THAT(FromProto(bad), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("goal")));
  bad.set_kg_percent(kNan);
  EXPECT_THAT(FromProto(bad),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("kg_percent")));
  bad.set_lossless_at_bits(31);
  EXPECT_FALSE(FromProto(bad).ok());

  CompressedSequenceInfo info{kId, "s", 7, 8, 9, {30000, 1001}, uint64_t{1} << 33, std::nullopt};
  EXPECT_FALSE(FromProto(Reparse(ToProto(info)))->record.has_value());
  info.record = CompressionRecord{kId, {.grid_bits = 12}, {1, 2, 3, 4, 5, 6}, 7, 8};
  PLEAT_ASSERT_OK_AND_ASSIGN(const CompressedSequenceInfo back, FromProto(Reparse(ToProto(info))));
  EXPECT_EQ(back.size_bytes, info.size_bytes);
  EXPECT_EQ(back.num_faces, 9);
  EXPECT_EQ(back.record->sequence_id, kId);
  EXPECT_EQ(back.record->summary.num_topology_bytes, 2u);
  EXPECT_EQ(back.record->summary.bpvf_without_topology, 4);
  EXPECT_EQ(back.record->summary.max_error_mm, 6);
  EXPECT_EQ(back.record->encode_seconds, 7);
  EXPECT_EQ(back.record->decode_seconds, 8);
  v1::CompressedSequence hostile = ToProto(info);
  hostile.set_num_vertices(-1);
  EXPECT_FALSE(FromProto(hostile).ok());
  hostile = ToProto(info);
  hostile.mutable_record()->set_sequence_id("../x");
  EXPECT_FALSE(FromProto(hostile).ok());
}

TEST(MessagesTest, AnErrorNeverTurnsIntoSuccess) {
  JobInfo job;
  job.id = "job-1";
  job.error = absl::InternalError("x");
  v1::Job message = ToProto(job);
  for (const int code : {0, -1, 17, 1'000'000}) {
    message.mutable_error()->set_code(code);
    EXPECT_THAT(FromProto(message)->error, HasStatus(absl::StatusCode::kUnknown, HasSubstr("x")));
  }
}

TEST(MessagesTest, HostileInfosAreRefused) {
  v1::Sequence sequence = ToProto(SequenceInfo{kId, "s", 1, 1, 1, {30, 1}, 1});
  ASSERT_THAT(FromProto(sequence), IsOk());
  sequence.set_num_frames(-1);
  EXPECT_THAT(FromProto(sequence),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("num_frames")));
  sequence.set_num_frames(1);
  sequence.mutable_frame_rate()->set_denominator(0);
  EXPECT_FALSE(FromProto(sequence).ok());
  for (const std::string& id : {std::string(), std::string("../../etc"), std::string(64, 'A')}) {
    sequence.set_id(id);
    EXPECT_THAT(FromProto(sequence),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("hexadecimal")));
  }
  v1::Job job;
  EXPECT_FALSE(FromProto(job).ok());
  job.set_id("job-1");
  EXPECT_THAT(FromProto(job), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("state")));
  job.set_state(v1::JOB_STATE_RUNNING);
  job.set_fraction(kNan);
  EXPECT_THAT(FromProto(job), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("fraction")));
  EXPECT_FALSE(FromProto(v1::Model()).ok());
  v1::Skeleton skeleton = ToProto(SmallSkeleton());
  skeleton.mutable_joints(1)->set_parent(1);
  EXPECT_FALSE(FromProto(skeleton).ok());
}

TEST(MessagesTest, TimesThatAreNoneAreRefused) {
  JobInfo info;
  info.id = "job-1";
  info.created = absl::FromUnixNanos(1'796'072'709'123'456'789);
  EXPECT_EQ(FromProto(Reparse(ToProto(info)))->created, info.created);
  for (const absl::Time time : {absl::UnixEpoch() - absl::Nanoseconds(1), absl::UnixEpoch()}) {
    info.created = time;
    EXPECT_EQ(FromProto(Reparse(ToProto(info)))->created, time);
  }
  info.created = absl::InfiniteFuture();  // no time of a calendar; the last one goes out
  v1::Job message = ToProto(info);
  ASSERT_THAT(FromProto(message), IsOk());
  const std::pair<int64_t, int32_t> wrong[] = {{int64_t{1} << 62, 0},
                                               {std::numeric_limits<int64_t>::min(), 0},
                                               {message.created().seconds() + 1, 0},
                                               {0, -1},
                                               {0, 1'000'000'000}};
  for (const auto& [seconds, nanos] : wrong) {
    message.mutable_created()->set_seconds(seconds);
    message.mutable_created()->set_nanos(nanos);
    EXPECT_THAT(FromProto(message),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("job.created")));
  }
}

TEST(MessagesTest, TimesToLiveAreSecondsAndZeroIsForEver) {
  EXPECT_EQ(TtlToSeconds(kKeepForEver), 0);
  EXPECT_EQ(TtlToSeconds(absl::Milliseconds(1)), 1);  // never shorter than it was told
  EXPECT_EQ(TtlToSeconds(absl::Milliseconds(1001)), 2);
  EXPECT_EQ(TtlFromSeconds(0, "ttl").value(), kKeepForEver);
  const int64_t century = int64_t{100} * 365 * 24 * 3600;
  for (const int64_t seconds : {int64_t{1}, century}) {
    EXPECT_EQ(TtlFromSeconds(seconds, "ttl").value(), absl::Seconds(seconds));
    EXPECT_EQ(TtlToSeconds(absl::Seconds(seconds)), seconds);
  }
  EXPECT_EQ(TtlToSeconds(absl::Seconds(century + 1)), century);
  for (const int64_t wrong : {int64_t{-1}, century + 1, std::numeric_limits<int64_t>::min()}) {
    EXPECT_THAT(TtlFromSeconds(wrong, "ttl_seconds"),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("ttl_seconds")));
  }
}

TEST(MessagesTest, NamesThatAreNoUtf8StillCrossTheWire) {
  SequenceInfo sequence{kId, "\xff\xfe", 1, 1, 1, {30, 1}, 1};
  EXPECT_EQ(FromProto(Reparse(ToProto(sequence)))->name, "\xef\xbf\xbd\xef\xbf\xbd");
}

}  // namespace
}  // namespace pleat
