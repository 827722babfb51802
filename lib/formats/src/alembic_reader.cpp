#include "pleat/formats/alembic_reader.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "alembic_appearance.h"
#include "alembic_archive.h"
#include "alembic_choice.h"
#include "alembic_mesh.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "sequence_inputs.h"

namespace pleat {
namespace {

// Faces and appearance of all meshes, one after the other.
class Joined {
 public:
  void Add(const AlembicFaces& faces, int num_vertices, MeshAppearance appearance) {
    for (const int32_t v : faces.corner_vertices) corner_vertices_.push_back(num_vertices_ + v);
    face_sizes_.insert(face_sizes_.end(), faces.face_sizes.begin(), faces.face_sizes.end());
    num_vertices_ += num_vertices;
    AddTexcoords(appearance);
    AddMaterials(appearance);
  }
  int num_vertices() const { return num_vertices_; }
  int64_t num_faces() const { return static_cast<int64_t>(face_sizes_.size()); }
  absl::StatusOr<Topology> TakeTopology() {
    return Topology::Create(num_vertices_, std::move(corner_vertices_), std::move(face_sizes_));
  }
  MeshAppearance TakeAppearance() { return std::move(joined_); }

 private:
  // Lists are empty until a mesh has them; then the meshes before and after get "none".
  void AddTexcoords(const MeshAppearance& appearance) {
    const auto offset = static_cast<int32_t>(joined_.texcoords.size());
    joined_.texcoords.insert(joined_.texcoords.end(), appearance.texcoords.begin(),
                             appearance.texcoords.end());
    if (joined_.texcoords.empty()) return;
    joined_.corner_texcoords.resize(corner_vertices_.size() - appearance.corner_texcoords.size(),
                                    -1);
    for (const int32_t index : appearance.corner_texcoords) {
      joined_.corner_texcoords.push_back(index < 0 ? -1 : offset + index);
    }
  }

  // Materials of the same name are the same.
  void AddMaterials(const MeshAppearance& appearance) {
    std::vector<int32_t> numbers;
    for (const std::string& name : appearance.material_names) {
      const auto [entry, is_new] =
          materials_.emplace(name, static_cast<int32_t>(joined_.material_names.size()));
      if (is_new) joined_.material_names.push_back(name);
      numbers.push_back(entry->second);
    }
    if (joined_.material_names.empty()) return;
    joined_.face_materials.resize(face_sizes_.size() - appearance.face_materials.size(), -1);
    for (const int32_t material : appearance.face_materials) {
      joined_.face_materials.push_back(material < 0 ? -1 : numbers[material]);
    }
  }

  int num_vertices_ = 0;
  std::vector<int32_t> corner_vertices_, face_sizes_;
  MeshAppearance joined_;
  std::map<std::string, int32_t> materials_;
};

// Computes the frames of the chosen meshes. Frames with the same samples are computed once.
class FrameReader {
 public:
  FrameReader(const AlembicChoice& choice, int num_vertices, AlembicArchive* archive)
      : choice_(choice), num_vertices_(num_vertices), archive_(*archive) {
    // Only what is above the meshes is evaluated.
    std::vector<bool> is_needed(choice.xforms.size());
    for (const PlacedMesh& placed : choice.meshes) {
      for (int x = placed.xform; x >= 0 && !is_needed[x]; x = choice.xforms[x].parent) {
        is_needed[x] = true;
      }
    }
    for (size_t x = 0; x < is_needed.size(); ++x) {
      if (!is_needed[x]) continue;
      needed_.push_back(static_cast<int>(x));
      if (choice.xforms[x].xform.changes()) changing_.push_back(static_cast<int>(x));
    }
    states_.resize(choice.xforms.size());
  }

  // kResourceExhausted when the matrices of all frames are larger than a sequence may be.
  absl::Status CheckWork(const MeshLimits& limits) const {
    const uint64_t bytes = sizeof(Eigen::Matrix4d) * changing_.size() *
                           static_cast<uint64_t>(choice_.times.num_samples);
    if (bytes <= limits.max_sequence_bytes) return absl::OkStatus();
    return absl::ResourceExhaustedError(
        absl::StrCat(changing_.size(), " transforms at ", choice_.times.num_samples, " times (",
                     bytes, " bytes) are over the limit of ", limits.max_sequence_bytes, " bytes"));
  }

  absl::Status Read(const Progress& progress) {
    const int num_frames = choice_.times.num_samples;
    std::vector<uint64_t> last;  // the samples of the frame before
    for (int t = 0; t < num_frames; ++t) {
      if (t % 16 == 0) PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(t) / num_frames));
      PLEAT_ASSIGN_OR_RETURN(std::vector<uint64_t> samples, FindSamples(t));
      if (t > 0 && samples == last) {
        order_.push_back(order_.back());
        continue;
      }
      const auto next = static_cast<int>(frames_.size());
      // A single sample decides about the whole frame when nothing else changes.
      const int known =
          samples.size() == 1 ? by_sample_.emplace(samples[0], next).first->second : next;
      order_.push_back(known);
      if (known == next) PLEAT_RETURN_IF_ERROR(ComputeFrame(t));
      last = std::move(samples);
    }
    return absl::OkStatus();
  }

  std::vector<Eigen::Matrix3Xf> TakeFrames() { return std::move(frames_); }
  const std::vector<int>& order() const { return order_; }  // frame -> which of TakeFrames
  bool interpolates() const { return interpolates_; }

 private:
  uint32_t SampleOf(const PlacedMesh& placed, int t) const {
    return placed.deforms() ? static_cast<uint32_t>(t) : 0;
  }

  // The places of all samples that frame t depends on, of what changes. Sets states_.
  absl::StatusOr<std::vector<uint64_t>> FindSamples(int t) {
    std::vector<uint64_t> samples;
    for (const PlacedMesh& placed : choice_.meshes) {
      if (!placed.mesh.positions.changes()) continue;
      PLEAT_ASSIGN_OR_RETURN(const OgawaRef ref,
                             FindSample(placed.mesh.positions, SampleOf(placed, t), archive_));
      samples.push_back(ref.bits);
    }
    for (const int x : t == 0 ? needed_ : changing_) {
      PLEAT_ASSIGN_OR_RETURN(states_[x],
                             choice_.xforms[x].xform.At(choice_.times.TimeOf(t), &archive_));
    }
    for (const int x : changing_) {
      const AlembicXform::State& state = states_[x];
      const bool is_between = state.before != state.after;
      interpolates_ = interpolates_ || is_between;
      samples.insert(samples.end(), {state.before.bits, state.after.bits,
                                     std::bit_cast<uint64_t>(is_between ? state.place.weight : 0),
                                     uint64_t{state.inherits}});
    }
    return samples;
  }

  absl::Status ComputeFrame(int t) {
    worlds_.resize(choice_.xforms.size());
    for (const int x : needed_) {
      PLEAT_ASSIGN_OR_RETURN(worlds_[x], choice_.xforms[x].xform.MatrixOf(states_[x], &archive_));
      const int parent = choice_.xforms[x].parent;
      if (parent < 0 || !states_[x].inherits) continue;
      worlds_[x] = MultiplyRows(worlds_[x], worlds_[parent]);
    }
    Eigen::Matrix3Xf& frame = frames_.emplace_back(3, num_vertices_);
    Eigen::Index begin = 0;
    for (const PlacedMesh& placed : choice_.meshes) {
      const Eigen::Matrix4d world =
          placed.xform < 0 ? Eigen::Matrix4d(Eigen::Matrix4d::Identity()) : worlds_[placed.xform];
      PLEAT_RETURN_IF_ERROR(ReadPositions(placed.mesh, SampleOf(placed, t), world, &archive_,
                                          frame.middleCols(begin, placed.num_vertices)));
      begin += placed.num_vertices;
    }
    return CheckFinite(t);
  }

  // MeshSequence checks too, but once frames are shared it counts them in another way.
  absl::Status CheckFinite(int t) const {
    const Eigen::Matrix3Xf& frame = frames_.back();
    if (frames_.size() == order_.size() || frame.allFinite()) return absl::OkStatus();
    Eigen::Index v = 0;
    while (frame.col(v).allFinite()) ++v;
    return absl::InvalidArgumentError(
        absl::StrCat("frame ", t, ", vertex ", v, ": the position is not finite; repair or remove ",
                     "the frame"));
  }

  const AlembicChoice& choice_;
  const int num_vertices_;
  AlembicArchive& archive_;
  std::vector<int> needed_, changing_;  // transforms above the meshes, parents first
  // These two belong to the frame that is read: one for each transform, filled in where needed.
  std::vector<AlembicXform::State> states_;
  std::vector<Eigen::Matrix4d> worlds_;
  std::vector<Eigen::Matrix3Xf> frames_;
  std::vector<int> order_;
  std::unordered_map<uint64_t, int> by_sample_;
  bool interpolates_ = false;
};

absl::StatusOr<Joined> ReadStillParts(const AlembicChoice& choice, const MeshLimits& limits,
                                      AlembicArchive* archive, std::vector<InputNote>* notes) {
  MeshCounts counts;
  counts.num_frames = choice.times.num_samples;
  for (const PlacedMesh& placed : choice.meshes) counts.num_vertices += placed.num_vertices;
  PLEAT_RETURN_IF_ERROR(CheckSequenceCounts(counts, limits));
  Joined joined;
  for (const PlacedMesh& placed : choice.meshes) {
    const std::string path = archive->Path(placed.mesh.object);
    const std::string where = absl::StrCat("'", path, "'");
    absl::StatusOr<AlembicFaces> faces =
        ReadFaces(placed.mesh, placed.num_vertices, limits, archive);
    if (!faces.ok()) return WithContext(where, faces.status());
    PLEAT_RETURN_IF_ERROR(
        WithContext(where, CheckSameTopology(placed.mesh, placed.num_vertices,
                                             static_cast<uint32_t>(counts.num_frames), archive)));
    std::vector<InputNote> mesh_notes;
    absl::StatusOr<MeshAppearance> appearance =
        ReadAlembicAppearance(placed.mesh, *faces, placed.num_vertices, archive, &mesh_notes);
    if (!appearance.ok()) return WithContext(where, appearance.status());
    for (InputNote& note : mesh_notes) {
      // Each kind is said once, of the first mesh that has it.
      if (std::ranges::find(*notes, note.kind, &InputNote::kind) != notes->end()) continue;
      note.text = absl::StrCat(path, ": ", note.text);
      notes->push_back(std::move(note));
    }
    joined.Add(*faces, placed.num_vertices, *std::move(appearance));
  }
  counts.num_faces = joined.num_faces();
  PLEAT_RETURN_IF_ERROR(CheckCounts(counts, limits));
  return joined;
}

FrameRate ChooseRate(const AlembicChoice& choice, const std::optional<FrameRate>& wanted,
                     const AlembicArchive& archive, InputReport* report) {
  const AlembicTimes& times = choice.times;
  std::vector<InputNote>* notes = &report->notes;
  if (times.num_samples > 1 && times.TimeOf(0) != 0) {
    notes->push_back({.kind = "times_ignored",
                      .text = absl::StrCat("the first sample is at ", times.TimeOf(0),
                                           " s; here frames count from 0")});
  }
  const AlembicTimeSampling& sampling = *times.sampling;
  const bool is_said = times.number != 0 || sampling != AlembicTimeSampling{};
  std::optional<FrameRate> rate;
  if (is_said && sampling.is_uniform()) {
    rate = RateOfStep(sampling.seconds_per_cycle);
  } else if (is_said && times.num_samples > 1) {
    rate = RateOfTimes(times.All());
  }
  report->has_frame_rate = rate.has_value();
  if (times.num_samples > 1) {
    const double frame = times.TimeOf(0) * wanted.value_or(rate.value_or(FrameRate{})).fps();
    report->first_frame = std::abs(frame - std::round(frame)) < 1e-6 ? std::round(frame) : frame;
  }
  if (wanted) return *wanted;
  if (rate || times.num_samples < 2) return rate.value_or(FrameRate{});
  double fps = 0;
  const std::string_view said = MetadataValue(archive.metadata(), "_ai_DCC_FPS");
  if (absl::SimpleAtod(absl::string_view(said.data(), said.size()), &fps) && fps > 0) {
    rate = RateOfStep(1 / fps);
  }
  const FrameRate used = rate.value_or(FrameRate{});
  notes->push_back(
      {.severity = NoteSeverity::kWarning,
       .kind = "frame_rate_assumed",
       .text = absl::StrCat(
           is_said ? "the samples are at uneven times" : "the samples have no times",
           "; each is a frame, at ", used.fps(), " per second",
           rate ? ", the rate that the archive names" : "", "; say --fps for another rate")});
  return used;
}

absl::StatusOr<MeshSequence> DecodeArchive(std::string_view bytes, const AlembicOptions& options,
                                           const Progress& progress, InputReport* report) {
  std::vector<InputNote>* notes = &report->notes;
  if (bytes.empty()) return absl::InvalidArgumentError("the file is empty");
  if (!bytes.starts_with("Ogawa")) {
    if (const std::string other = DescribeForeignBytes(bytes); !other.empty()) {
      return absl::InvalidArgumentError(absl::StrCat("this is ", other));
    }
  }
  PLEAT_ASSIGN_OR_RETURN(AlembicArchive archive, AlembicArchive::Open(bytes));
  PLEAT_ASSIGN_OR_RETURN(const AlembicChoice choice,
                         ChooseAlembicMeshes(options.object, options.limits, &archive, notes));
  PLEAT_ASSIGN_OR_RETURN(Joined joined, ReadStillParts(choice, options.limits, &archive, notes));
  FrameReader frames(choice, joined.num_vertices(), &archive);
  PLEAT_RETURN_IF_ERROR(frames.CheckWork(options.limits));
  PLEAT_RETURN_IF_ERROR(frames.Read(progress));
  if (frames.interpolates()) {
    notes->push_back({.kind = "transforms_between_samples",
                      .text = "transforms have samples at other times than the mesh; they are "
                              "interpolated"});
  }
  MeshSequenceOptions sequence_options;
  sequence_options.name = NameToUtf8(options.name);
  sequence_options.frame_rate = ChooseRate(choice, options.frame_rate, archive, report);
  sequence_options.appearance = joined.TakeAppearance();
  PLEAT_ASSIGN_OR_RETURN(Topology topology, joined.TakeTopology());
  PLEAT_ASSIGN_OR_RETURN(
      const MeshSequence distinct,
      MeshSequence::Create(std::move(topology), frames.TakeFrames(), std::move(sequence_options)));
  if (static_cast<size_t>(distinct.num_frames()) == frames.order().size()) return distinct;
  return distinct.Subset(frames.order());
}

}  // namespace

absl::StatusOr<MeshSequence> DecodeAlembic(std::string_view bytes, const std::string& file,
                                           const AlembicOptions& options, const Progress& progress,
                                           InputReport* report) {
  InputReport found;
  absl::StatusOr<MeshSequence> sequence = DecodeArchive(bytes, options, progress, &found);
  if (report != nullptr) {
    report->has_frame_rate = found.has_frame_rate;
    report->first_frame = found.first_frame;
    for (InputNote& note : found.notes) {
      note.text = absl::StrCat(DisplayName(file), ": ", note.text);
      report->notes.push_back(std::move(note));
    }
  }
  return WithContext(file, std::move(sequence));
}

}  // namespace pleat
