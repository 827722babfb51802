// What every message promises: all of its fields cross the wire, damaged bytes give an error or a
// value, and an error names the field.
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/hostile_bytes.h"
#include "support/not_a_number.h"
#include "support/status_matchers.h"
#include "wire/full_samples.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using Names = std::set<std::string>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Every field of the message and of those inside is set, apart from those in `except`.
void ExpectFull(const google::protobuf::Message& message, const Names& except) {
  const google::protobuf::Reflection& fields = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const google::protobuf::FieldDescriptor* field = message.GetDescriptor()->field(i);
    if (except.contains(std::string(field->name()))) continue;
    const bool is_set = field->is_repeated() ? fields.FieldSize(message, field) > 0
                                             : fields.HasField(message, field);
    EXPECT_TRUE(is_set) << field->full_name();
    const bool has_fields =
        is_set && field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE;
    if (!has_fields || field->is_map()) continue;
    ExpectFull(field->is_repeated() ? fields.GetRepeatedMessage(message, field, 0)
                                    : fields.GetMessage(message, field),
               except);
  }
}

// Together with ExpectFull: no field is lost on either way.
template <typename Value>
void ExpectEveryFieldCrosses(const Value& value, const Names& except = {}) {
  const auto message = ToProto(value);
  ExpectFull(message, except);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto back, FromProto(Reparse(message)));
  EXPECT_EQ(ToProto(back).SerializeAsString(), message.SerializeAsString())
      << message.GetDescriptor()->full_name();
}

TEST(FullMessagesTest, EveryFieldCrossesTheWire) {
  ExpectEveryFieldCrosses(FullSequence());
  ExpectEveryFieldCrosses(FullModel());
  ExpectEveryFieldCrosses(FullJob(TrainOptions()), {"compression"});
  ExpectEveryFieldCrosses(FullJob(FullCompressedSequence().record->options),
                          {"training", "max_error_mm", "lossless_at_bits"});
  // The record has an error of its own besides that of the options.
  ExpectEveryFieldCrosses(FullCompressedSequence(), {"lossless_at_bits", "max_error_mm"});
  EXPECT_EQ(FromProto(ToProto(FullCompressedSequence()))->record->summary.max_error_mm, 6);
  ExpectEveryFieldCrosses(FullHeader());
  ExpectEveryFieldCrosses(FullParameters(), {"packed_coefficients"});
  FrameParameters many = FullParameters();
  many.coefficients = Eigen::VectorXf::LinSpaced(300, -.5f, .5f);
  ExpectEveryFieldCrosses(many, {"coefficients"});
  ExpectEveryFieldCrosses(FullTrack());
  ExpectEveryFieldCrosses(
      CharacterQuery{kId, {1, 2}, true, {.joints = {1, .5}, .vertices = {0, 2, .25f}}});
  ExpectEveryFieldCrosses(FrameEncoderOptions{.content = StreamContent::kControlMesh, .speed = 0},
                          {"max_error_mm"});
  ExpectEveryFieldCrosses(FrameEncoderOptions{.max_error_mm = 2, .speed = 9}, {"position_bits"});
}

TEST(FullMessagesTest, EveryStateAndChoiceComesBackAndItsNumberIsNotTheUnspecifiedOne) {
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kSucceeded,
                               JobState::kFailed, JobState::kCancelled}) {
    EXPECT_NE(ToProto(state), v1::JOB_STATE_UNSPECIFIED);
    EXPECT_EQ(FromProto(ToProto(state)).value(), state);
  }
  for (const StreamContent content :
       {StreamContent::kMesh, StreamContent::kControlMesh, StreamContent::kParameters}) {
    EXPECT_NE(ToProto(content), v1::STREAM_CONTENT_UNSPECIFIED);
    EXPECT_EQ(FromProto(ToProto(content)).value(), content);
  }
}

// A header of parameters has no box of its own: the default one must be no error.
TEST(FullMessagesTest, AHeaderOfParametersHasTheNumberOfVerticesOnly) {
  StreamHeader header;
  header.content = StreamContent::kParameters;
  header.num_vertices = 5;
  PLEAT_ASSERT_OK_AND_ASSIGN(const StreamHeader back, FromProto(Reparse(ToProto(header))));
  EXPECT_EQ(back.content, StreamContent::kParameters);
  EXPECT_EQ(back.num_vertices, 5);
  EXPECT_TRUE(back.topology.empty() && back.vertex_order.empty() && back.control_vertices.empty());
}

// Bytes from outside: refused with words, or a value that crosses the wire unchanged.
template <typename Message>
void ExpectHonest(const std::string& bytes) {
  Message message;
  if (!message.ParseFromString(bytes)) return;
  const auto value = FromProto(message);
  if (!value.ok()) {
    EXPECT_EQ(value.status().code(), absl::StatusCode::kInvalidArgument) << value.status();
    EXPECT_FALSE(value.status().message().empty());
    return;
  }
  const Message first = ToProto(*value);
  const auto again = FromProto(Reparse(first));
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(ToProto(*again).SerializeAsString(), first.SerializeAsString());
}

template <typename Value>
void DamageEveryByte(const Value& value) {
  const auto message = ToProto(value);
  using Message = std::decay_t<decltype(message)>;
  const auto check = [](const std::string& bytes) { ExpectHonest<Message>(bytes); };
  ForEachTruncation(message.SerializeAsString(), check);
  ForEachCorruption(message.SerializeAsString(), check);
}

TEST(DamagedMessagesTest, AreRefusedOrAreValues) {
  DamageEveryByte(FullSequence());
  DamageEveryByte(FullCompressedSequence());
  DamageEveryByte(FullJob(TrainOptions()));
  DamageEveryByte(FullJob(CompressOptions()));
  DamageEveryByte(FullModel());
  DamageEveryByte(FullHeader());
  DamageEveryByte(FullParameters());
  DamageEveryByte(FullTrack());
  DamageEveryByte(CharacterQuery{kId, {1, 2}, true, {.joints = {1, .5}, .vertices = {0, 2, .25f}}});
  DamageEveryByte(FrameEncoderOptions{.max_error_mm = 2});
}

// One change that makes a good message bad, and the name that the error must say.
template <typename Message>
using Faults = std::vector<std::pair<std::string, std::function<void(Message&)>>>;

template <typename Message>
void ExpectRefused(const Message& good, const Faults<Message>& faults) {
  ASSERT_THAT(FromProto(good), IsOk());
  for (size_t i = 0; i < faults.size(); ++i) {
    Message bad = good;
    faults[i].second(bad);
    EXPECT_THAT(FromProto(Reparse(bad)),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(faults[i].first)))
        << "fault " << i;
  }
}

template <typename Message>
void ExpectAccepted(const Message& good, const std::vector<std::function<void(Message&)>>& edges) {
  for (size_t i = 0; i < edges.size(); ++i) {
    Message edge = good;
    edges[i](edge);
    EXPECT_THAT(FromProto(Reparse(edge)), IsOk()) << "edge " << i;
  }
}

TEST(RefusalTest, JobsNameTheField) {
  const v1::Job good = ToProto(FullJob(TrainOptions()));
  Faults<v1::Job> faults = {
      {"job.id", [](v1::Job& job) { job.clear_id(); }},
      {"job.id", [](v1::Job& job) { job.set_id(std::string(65, 'x')); }},
      {"job.state is 0", [](v1::Job& job) { job.clear_state(); }},
      {"job.sequence_ids", [](v1::Job& job) { job.add_sequence_ids("../x"); }},
      {"history", [](v1::Job& job) { job.mutable_training()->set_history(9); }},
      {"learner", [](v1::Job& job) { job.mutable_training()->set_learner("magic"); }},
      {"goal", [](v1::Job& job) { job.mutable_compression(); }},
      {"job.result_id", [](v1::Job& job) { job.set_result_id("x"); }},
      {"job.rig_id", [](v1::Job& job) { job.set_rig_id(std::string(64, 'A')); }}};
  for (const int state : {-1, 6, 99}) {
    faults.push_back(
        {"job.state", [state](v1::Job& job) { job.set_state(static_cast<v1::JobState>(state)); }});
  }
  for (const double fraction : {-1e-9, 1.0001, kNan, kInfinity}) {
    faults.push_back({"job.fraction", [fraction](v1::Job& job) { job.set_fraction(fraction); }});
  }
  ExpectRefused(good, faults);
  ExpectAccepted<v1::Job>(
      good,
      {[](v1::Job& job) { job.set_id(std::string(64, 'x')); },
       [](v1::Job& job) { job.set_fraction(0); }, [](v1::Job& job) { job.set_fraction(1); },
       [](v1::Job& job) { job.clear_sequence_ids(); }, [](v1::Job& job) { job.clear_training(); }});
}

TEST(RefusalTest, SequencesNameTheField) {
  using Compressed = v1::CompressedSequence;
  ExpectRefused<v1::Sequence>(
      ToProto(FullSequence()),
      {{"sequence.id", [](v1::Sequence& s) { s.clear_id(); }},
       {"sequence.id", [](v1::Sequence& s) { s.set_id(std::string(63, 'a')); }},
       {"sequence.num_frames is -1", [](v1::Sequence& s) { s.set_num_frames(-1); }},
       {"sequence.num_vertices", [](v1::Sequence& s) { s.set_num_vertices(-2); }},
       {"sequence.num_faces", [](v1::Sequence& s) { s.set_num_faces(INT32_MIN); }},
       {"frame_rate 0/0", [](v1::Sequence& s) { s.clear_frame_rate(); }},
       {"frame_rate -30", [](v1::Sequence& s) { s.mutable_frame_rate()->set_numerator(-30); }}});
  ExpectRefused<Compressed>(
      ToProto(FullCompressedSequence()),
      {{"compressed_sequence.id", [](Compressed& s) { s.set_id("a"); }},
       {"compressed_sequence.num_frames", [](Compressed& s) { s.set_num_frames(-1); }},
       {"record.sequence_id", [](Compressed& s) { s.mutable_record()->clear_sequence_id(); }},
       {"goal", [](Compressed& s) { s.mutable_record()->clear_options(); }}});
}

TEST(RefusalTest, CompressOptionsKeepTheirRanges) {
  const auto with = [](auto set) {
    v1::CompressOptions options;
    set(options);
    return FromProto(options);
  };
  const auto refused = [](const char* name) {
    return HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(name));
  };
  for (const double mm : {0., -1., 9e-4, 1.1e6, kNan, kInfinity}) {
    EXPECT_THAT(with([&](auto& o) { o.set_max_error_mm(mm); }), refused("max_error_mm")) << mm;
  }
  for (const double percent : {0., -1., 9e-5, 50.1, kInfinity}) {
    EXPECT_THAT(with([&](auto& o) { o.set_kg_percent(percent); }), refused("kg_percent"));
  }
  for (const int bits : {0, 7, 21, -1, INT32_MAX}) {
    EXPECT_THAT(with([&](auto& o) { o.set_lossless_at_bits(bits); }), refused("bits")) << bits;
  }
  for (const double mm : {1e-3, 1e6}) {
    EXPECT_THAT(with([&](auto& o) { o.set_max_error_mm(mm); }), IsOk());
  }
  for (const int bits : {8, 20}) {
    EXPECT_THAT(with([&](auto& o) { o.set_lossless_at_bits(bits); }), IsOk());
  }
}

TEST(RefusalTest, ModelsNameTheField) {
  const auto add_joints = [](v1::Model& model, int count) {
    for (int j = model.skeleton().joints_size(); j < count; ++j) {
      v1::Joint* joint = model.mutable_skeleton()->add_joints();
      joint->set_name(std::to_string(j));
      joint->mutable_rest_position();
    }
  };
  const auto joint = [](v1::Model& model) { return model.mutable_skeleton()->mutable_joints(1); };
  const v1::Model good = ToProto(FullModel());
  ExpectRefused<v1::Model>(
      good, {{"model.id", [](v1::Model& m) { m.clear_id(); }},
             {"model.num_vertices", [](v1::Model& m) { m.set_num_vertices(-1); }},
             {"model.num_faces", [](v1::Model& m) { m.set_num_faces(-1); }},
             {"model.num_control_vertices", [](v1::Model& m) { m.set_num_control_vertices(-1); }},
             {"model.num_components", [](v1::Model& m) { m.set_num_components(-1); }},
             {"frame_rate", [](v1::Model& m) { m.mutable_frame_rate()->set_denominator(0); }},
             {"resolution_percent",
              [](v1::Model& m) { m.mutable_options()->set_resolution_percent(kNan); }},
             {"at least one joint", [](v1::Model& m) { m.clear_skeleton(); }},
             {"joint 1", [&](v1::Model& m) { joint(m)->set_parent(7); }},
             {"used twice", [&](v1::Model& m) { joint(m)->set_name("hips"); }},
             {"joints[1].name", [&](v1::Model& m) { joint(m)->set_name(std::string(257, 'x')); }},
             {"joints[1].rest_position",
              [&](v1::Model& m) { joint(m)->mutable_rest_position()->set_z(kInfinity); }},
             {"joints has 1025", [&](v1::Model& m) { add_joints(m, kMaxWireJoints + 1); }}});
  ExpectAccepted<v1::Model>(
      good, {[&](v1::Model& m) { joint(m)->set_name(std::string(kMaxWireNameBytes, 'x')); },
             [&](v1::Model& m) { add_joints(m, kMaxWireJoints); },
             [](v1::Model& m) { m.clear_record(); }});
}

TEST(RefusalTest, StreamOptionsNameTheField) {
  using Options = v1::StreamOptions;
  Faults<Options> faults = {
      {"encoding", [](Options& o) { o.set_encoding(static_cast<v1::FrameEncoding>(4)); }},
      {"encoding", [](Options& o) { o.set_encoding(static_cast<v1::FrameEncoding>(-1)); }},
      {"content", [](Options& o) { o.set_content(static_cast<v1::StreamContent>(4)); }},
      {"both", [](Options& o) { o.set_position_bits(12), o.set_max_error_mm(1); }}};
  std::vector<std::function<void(Options&)>> edges;
  for (const int bits : {-1, 1, 7, 21, INT32_MIN}) {
    faults.push_back({"position_bits", [bits](Options& o) { o.set_position_bits(bits); }});
  }
  for (const int speed : {-1, 11, INT32_MAX}) {
    faults.push_back({"speed", [speed](Options& o) { o.set_speed(speed); }});
  }
  for (const double mm : {-1., 9e-4, 1.1e6, kNan, kInfinity}) {
    faults.push_back({"max_error_mm", [mm](Options& o) { o.set_max_error_mm(mm); }});
  }
  for (const int bits : {0, 8, 20}) {
    edges.push_back([bits](Options& o) { o.set_position_bits(bits); });
  }
  for (const int speed : {0, 10}) edges.push_back([speed](Options& o) { o.set_speed(speed); });
  for (const double mm : {0., 1e-3, 1e6}) {
    edges.push_back([mm](Options& o) { o.set_max_error_mm(mm); });
  }
  ExpectRefused(Options(), faults);
  ExpectAccepted(Options(), edges);
}

TEST(RefusalTest, StreamHeadersNameTheField) {
  using Header = v1::StreamHeader;
  Faults<Header> faults = {
      {"encoding", [](Header& h) { h.set_encoding(static_cast<v1::FrameEncoding>(9)); }},
      {"content", [](Header& h) { h.set_content(static_cast<v1::StreamContent>(9)); }},
      {"position_bits", [](Header& h) { h.clear_box(); }},
      {"position_bits", [](Header& h) { h.mutable_box()->set_bits(31); }}};
  for (const float origin : {NAN, INFINITY, 2e9f}) {
    faults.push_back({"origin", [origin](Header& h) { h.mutable_box()->set_origin_y(origin); }});
  }
  for (const float range : {0.f, -1.f, NAN, INFINITY, 2e9f}) {
    faults.push_back({"edge", [range](Header& h) { h.mutable_box()->set_range(range); }});
  }
  ExpectRefused(ToProto(FullHeader()), faults);
}

TEST(RefusalTest, CharactersAndParametersHaveAtMostAsManyEntriesAsTheWireAllows) {
  const auto scales = [](v1::Character& c, int count) {
    for (int i = c.bone_scales_size(); i < count; ++i) c.add_bone_scales(1);
  };
  const v1::Character character = ToProto(CharacterQuery{kId, {}, false});
  ExpectRefused<v1::Character>(
      character, {{"character.model_id", [](v1::Character& c) { c.set_model_id("latest"); }},
                  {"character.bone_scales has 1025", [&](v1::Character& c) { scales(c, 1025); }},
                  {"character.detail_strengths has 1025",
                   [](v1::Character& c) { c.mutable_detail_strengths()->Resize(1025, 1); }},
                  {"character.vertex_strengths has 4000001",
                   [](v1::Character& c) { c.mutable_vertex_strengths()->Resize(4'000'001, 1); }}});
  ExpectAccepted<v1::Character>(character, {[&](v1::Character& c) { scales(c, 1024); }});

  using Parameters = v1::FrameParameters;
  const auto resize = [](auto* values, int count) { values->Resize(count, .5f); };
  const Parameters parameters = ToProto(FullParameters());
  ExpectRefused<Parameters>(
      parameters,
      {{"parameters.rotations has 0", [](Parameters& p) { p.clear_rotations(); }},
       {"parameters.rotations has 3", [&](Parameters& p) { resize(p.mutable_rotations(), 3); }},
       {"1024 joints", [&](Parameters& p) { resize(p.mutable_rotations(), 4 * 1025); }},
       {"parameters.coefficients has 4097",
        [&](Parameters& p) { resize(p.mutable_coefficients(), 4097); }}});
  ExpectAccepted<Parameters>(parameters,
                             {[&](Parameters& p) { resize(p.mutable_rotations(), 4 * 1024); },
                              [&](Parameters& p) { resize(p.mutable_coefficients(), 4096); },
                              [](Parameters& p) { p.clear_coefficients(); }});
}

TEST(RefusalTest, PosesInAListAndInATrackAreNamedByTheirPlace) {
  const v1::PoseTrack good = ToProto(FullTrack());
  ExpectRefused<v1::PoseTrack>(
      good,
      {{"track.poses[1]", [](v1::PoseTrack& t) { t.mutable_poses(1)->clear_rotations(); }},
       {"frame 2", [](v1::PoseTrack& t) { t.mutable_poses(2)->add_rotations()->set_w(1); }},
       {"frame 3", [](v1::PoseTrack& t) { t.mutable_poses(3)->mutable_rotations(0)->set_w(9); }},
       {"track", [](v1::PoseTrack& t) { t.clear_poses(); }},
       {"fps", [](v1::PoseTrack& t) { t.set_fps(9e-3); }},
       {"fps", [](v1::PoseTrack& t) { t.set_fps(10001); }}});
  ExpectAccepted<v1::PoseTrack>(
      good, {[](v1::PoseTrack& t) { t.set_fps(.01); }, [](v1::PoseTrack& t) { t.set_fps(10000); },
             [](v1::PoseTrack& t) { t.clear_clip_starts(); }});
  google::protobuf::RepeatedPtrField<v1::Pose> poses = good.poses();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<Pose> all, FromProto(poses, "history"));
  EXPECT_EQ(all.size(), 4u);
  poses[2].mutable_root_position()->set_x(kNan);
  EXPECT_THAT(FromProto(poses, "history"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("history[2]")));
}

}  // namespace
}  // namespace pleat
