#include "pleat/sequence_codec/sequence_decoder.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "compressed_format.h"
#include "connectivity_coder.h"
#include "face_list_coder.h"
#include "field_coder.h"
#include "pleat/base/status.h"
#include "rest_shape.h"
#include "trial_progress.h"

namespace pleat {
namespace {

// Share of the time of a segment without residuals that its fields take.
constexpr double kFieldsShare = .85;

// Where one segment is in the file.
struct SegmentPlace {
  int first_frame = 0, num_frames = 0;
  std::string_view motion;
  std::vector<std::string_view> groups;
};

// `count` numbers cannot come from so few bytes of code: refuses before memory is taken.
absl::Status CheckPlausible(uint64_t count, std::string_view payload, absl::string_view what) {
  if (count / BinaryCoder::kMaxDecisionsPerByte > payload.size() + 4) {
    return absl::DataLossError(
        absl::StrCat(payload.size(), " bytes cannot hold ", count, " numbers of the ", what));
  }
  return absl::OkStatus();
}

// Hands out the sections in the order that the format wants.
class SectionReader {
 public:
  explicit SectionReader(std::vector<Section> sections) : sections_(std::move(sections)) {}

  bool IsNext(SectionKind kind) const {
    return next_ < sections_.size() && sections_[next_].kind == kind;
  }
  absl::StatusOr<std::string_view> Next(SectionKind kind, absl::string_view what) {
    if (!IsNext(kind)) {
      return absl::DataLossError(absl::StrCat("section ", next_, " should be the ", what));
    }
    return sections_[next_++].payload;
  }

 private:
  std::vector<Section> sections_;
  size_t next_ = 0;
};

}  // namespace

struct SequenceDecoder::State {
  std::string bytes;
  MeshLimits limits;
  CompressedHeader header;
  Topology topology;
  MeshAppearance appearance;
  uint64_t topology_bytes = 0;
  Eigen::Matrix3Xf rest;
  std::optional<SurfaceHierarchy> hierarchy;
  std::vector<SegmentPlace> places;

  int loaded = -1;        // which segment is in memory
  int loaded_group = -1;  // which group of it
  MotionSegment segment;
  std::vector<Eigen::Matrix3Xf> frames;  // of that group

  absl::Status ReadShared(SectionReader* reader) {
    PLEAT_ASSIGN_OR_RETURN(std::string_view payload, reader->Next(SectionKind::kHeader, "header"));
    PLEAT_ASSIGN_OR_RETURN(header, DecodeHeader(payload, limits));
    PLEAT_RETURN_IF_ERROR(CheckPlausible(uint64_t{3} * header.num_vertices, bytes, "rest shape"));
    const bool is_list = reader->IsNext(SectionKind::kFaceList);
    PLEAT_ASSIGN_OR_RETURN(
        payload,
        reader->Next(is_list ? SectionKind::kFaceList : SectionKind::kTopology, "topology"));
    PLEAT_RETURN_IF_ERROR(CheckPlausible(header.num_corners, payload, "topology"));
    BinaryCoder coder = BinaryCoder::ForDecoding(payload);
    const auto decode = is_list ? DecodeFaceList : DecodeTopology;
    PLEAT_ASSIGN_OR_RETURN(
        topology, decode(static_cast<int>(header.num_vertices), static_cast<int>(header.num_faces),
                         static_cast<int>(header.num_corners), &coder));
    topology_bytes = payload.size();
    PLEAT_ASSIGN_OR_RETURN(payload, reader->Next(SectionKind::kAppearance, "appearance"));
    appearance = header.materials;
    PLEAT_RETURN_IF_ERROR(DecodeAppearance(payload, header, topology, &appearance));
    topology_bytes += payload.size();
    PLEAT_ASSIGN_OR_RETURN(payload, reader->Next(SectionKind::kRest, "rest shape"));
    BinaryCoder rest_coder = BinaryCoder::ForDecoding(payload);
    PLEAT_RETURN_IF_ERROR(CodeRestShape(topology, header.steps.rest_m, &rest_coder, &rest));
    hierarchy.emplace(topology, &rest);
    return absl::OkStatus();
  }

  absl::Status ReadPlaces(SectionReader* reader) {
    int first = 0;
    for (const uint32_t num_frames : header.segment_frames) {
      SegmentPlace place;
      place.first_frame = first;
      place.num_frames = static_cast<int>(num_frames);
      PLEAT_ASSIGN_OR_RETURN(place.motion, reader->Next(SectionKind::kMotion, "motion"));
      for (int t = 0; t < place.num_frames; t += kGroupFrames) {
        PLEAT_ASSIGN_OR_RETURN(const std::string_view group,
                               reader->Next(SectionKind::kGroup, "group of frames"));
        place.groups.push_back(group);
      }
      first += place.num_frames;
      places.push_back(std::move(place));
    }
    return reader->Next(SectionKind::kEnd, "end").status();
  }

  // How much of the time of decoding a segment is taken before its first frame: the fields of
  // its motion, against the residuals of its frames.
  static double LoadingShare(const SegmentPlace& place) {
    size_t num_group_bytes = 0;
    for (const std::string_view group : place.groups) num_group_bytes += group.size();
    const auto motion = static_cast<double>(place.motion.size());
    return kFieldsShare * motion / (motion + static_cast<double>(num_group_bytes) + 1);
  }

  absl::Status LoadSegment(int index, const Progress& progress = {}) {
    if (loaded == index) return absl::OkStatus();
    loaded = loaded_group = -1;
    const SegmentPlace& place = places[index];
    ByteReader reader(place.motion);
    PLEAT_ASSIGN_OR_RETURN(const uint16_t num_components, reader.Read<uint16_t>("components"));
    const uint64_t num_values = uint64_t{3} * num_components * header.num_vertices;
    if (num_components > place.num_frames) {
      return absl::DataLossError(
          absl::StrCat("segment ", index, " has more components than frames"));
    }
    if (num_values * sizeof(float) > limits.max_field_bytes) {
      return absl::ResourceExhaustedError(
          absl::StrCat(num_components, " components of ", header.num_vertices,
                       " vertices are over the limit of ", limits.max_field_bytes, " bytes"));
    }
    const std::string_view code = place.motion.substr(reader.offset());
    PLEAT_RETURN_IF_ERROR(CheckPlausible(num_values, code, "motion"));
    segment.first_frame = place.first_frame;
    segment.num_frames = place.num_frames;
    segment.num_components = num_components;
    BinaryCoder coder = BinaryCoder::ForDecoding(code);
    TrajectoryMatrix rigid, rows;
    PLEAT_RETURN_IF_ERROR(CodeRigidMotion(header.steps, &coder, &rigid, &segment));
    PLEAT_RETURN_IF_ERROR(CodeWeights(header.steps, &coder, &rows, &segment));
    segment.fields.resize(header.num_vertices, 3 * num_components);
    PLEAT_RETURN_IF_ERROR(
        CodeFields(*hierarchy, header.steps.field_m, &coder, &segment.fields, progress));
    loaded = index;
    return absl::OkStatus();
  }

  // Fills `frames` with the group of the loaded segment.
  absl::Status LoadGroup(int group) {
    if (loaded_group == group) return absl::OkStatus();
    loaded_group = -1;
    const int index = loaded;
    ByteReader reader(places[index].groups[group]);
    PLEAT_ASSIGN_OR_RETURN(const uint32_t checksum, reader.Read<uint32_t>("checksum of frames"));
    const std::string_view code = places[index].groups[group].substr(reader.offset());
    EvaluateGroup(rest, segment, group, &frames);
    BinaryCoder coder = BinaryCoder::ForDecoding(code);
    PLEAT_RETURN_IF_ERROR(CodeResiduals(*hierarchy, header.grid, {}, &coder, &frames));
    if (FramesChecksum(frames) != checksum) {
      return absl::DataLossError(
          absl::StrCat("the frames from ", places[index].first_frame + group * kGroupFrames,
                       " on are not the ones that were encoded: their checksum does not agree"));
    }
    for (Eigen::Matrix3Xf& frame : frames) {
      if (!header.origin_m.isZero(0)) {
        frame = (frame.cast<double>().colwise() + header.origin_m).cast<float>();
      }
      if (!frame.allFinite()) return absl::DataLossError("a decoded position is not finite");
    }
    loaded_group = group;
    return absl::OkStatus();
  }
};

SequenceDecoder::SequenceDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
SequenceDecoder::~SequenceDecoder() = default;
SequenceDecoder::SequenceDecoder(SequenceDecoder&&) noexcept = default;
SequenceDecoder& SequenceDecoder::operator=(SequenceDecoder&&) noexcept = default;

int SequenceDecoder::num_frames() const { return static_cast<int>(state_->header.num_frames); }
int SequenceDecoder::num_vertices() const { return static_cast<int>(state_->header.num_vertices); }
FrameRate SequenceDecoder::frame_rate() const { return state_->header.frame_rate; }
const std::string& SequenceDecoder::name() const { return state_->header.name; }
const Topology& SequenceDecoder::topology() const { return state_->topology; }
const MeshAppearance& SequenceDecoder::appearance() const { return state_->appearance; }
uint64_t SequenceDecoder::topology_bytes() const { return state_->topology_bytes; }

CompressionPromise SequenceDecoder::promise() const {
  const ResidualGrid& grid = state_->header.grid;
  CompressionPromise promise;
  if (grid.kind == ResidualKind::kCorrection) promise.max_error_mm = grid.bound_m * 1e3;
  if (grid.kind == ResidualKind::kGrid) promise.grid_step_mm = grid.step_m * 1e3;
  return promise;
}

uint64_t SequenceDecoder::memory_bytes() const {
  constexpr uint64_t kSharedBytesPerVertex = 300;  // topology, hierarchy, rest shape
  uint64_t num_components = 0;
  for (const SegmentPlace& place : state_->places) {
    const absl::StatusOr<uint16_t> count = ByteReader(place.motion).Read<uint16_t>("components");
    num_components = std::max<uint64_t>(num_components, count.value_or(0));
  }
  const uint64_t bytes_per_vertex =
      kSharedBytesPerVertex + (num_components + kGroupFrames) * 3 * sizeof(float);
  return state_->bytes.size() + bytes_per_vertex * state_->header.num_vertices;
}

absl::StatusOr<SequenceDecoder> SequenceDecoder::Open(std::string bytes, const MeshLimits& limits) {
  auto state = std::make_unique<State>();
  state->bytes = std::move(bytes);
  state->limits = limits;
  PLEAT_ASSIGN_OR_RETURN(std::vector<Section> sections, ReadSections(state->bytes));
  SectionReader reader(std::move(sections));
  PLEAT_RETURN_IF_ERROR(state->ReadShared(&reader));
  PLEAT_RETURN_IF_ERROR(state->ReadPlaces(&reader));
  return SequenceDecoder(std::move(state));
}

absl::Status SequenceDecoder::Decode(int begin, int end, const FrameSink& sink,
                                     const Progress& progress) {
  if (begin < 0 || end > num_frames() || begin >= end) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the frames ", begin, " to ", end, " are not in the sequence, which has ", num_frames()));
  }
  const double num_wanted = end - begin;
  for (size_t s = 0; s < state_->places.size(); ++s) {
    const SegmentPlace& place = state_->places[s];
    const int low = std::max(begin - place.first_frame, 0);
    const int high = std::min(end - place.first_frame, place.num_frames);
    if (low >= high) continue;
    const Progress part = PartOf(progress, (place.first_frame + low - begin) / num_wanted,
                                 (place.first_frame + high - begin) / num_wanted);
    const double loading = State::LoadingShare(place);
    PLEAT_RETURN_IF_ERROR(state_->LoadSegment(static_cast<int>(s), PartOf(part, 0, loading)));
    const Progress decoding = PartOf(part, loading, 1);
    for (int group = low / kGroupFrames; group * kGroupFrames < high; ++group) {
      PLEAT_RETURN_IF_ERROR(state_->LoadGroup(group));
      for (int i = 0; i < static_cast<int>(state_->frames.size()); ++i) {
        const int t = place.first_frame + group * kGroupFrames + i;
        if (t < begin || t >= end) continue;
        PLEAT_RETURN_IF_ERROR(sink(t, state_->frames[i]));
      }
      PLEAT_RETURN_IF_ERROR(
          decoding.Report(((group + 1.0) * kGroupFrames - low) / static_cast<double>(high - low)));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<const Eigen::Matrix3Xf*> SequenceDecoder::DecodeFrame(int t) {
  if (t < 0 || t >= num_frames()) {
    return absl::InvalidArgumentError(
        absl::StrCat("frame ", t, " is not in the sequence, which has ", num_frames()));
  }
  int index = 0;
  while (t >= state_->places[index].first_frame + state_->places[index].num_frames) ++index;
  PLEAT_RETURN_IF_ERROR(state_->LoadSegment(index));
  const int in_segment = t - state_->places[index].first_frame;
  PLEAT_RETURN_IF_ERROR(state_->LoadGroup(in_segment / kGroupFrames));
  return &state_->frames[in_segment % kGroupFrames];
}

absl::StatusOr<MeshSequence> SequenceDecoder::DecodeAll(const Progress& progress) {
  std::vector<Eigen::Matrix3Xf> frames;
  PLEAT_RETURN_IF_ERROR(Decode(
      0, num_frames(),
      [&frames](int, const Eigen::Matrix3Xf& positions) {
        frames.push_back(positions);
        return absl::OkStatus();
      },
      progress));
  MeshSequenceOptions options;
  options.name = name();
  options.frame_rate = frame_rate();
  options.appearance = appearance();
  return MeshSequence::Create(topology(), std::move(frames), std::move(options));
}

}  // namespace pleat
