#include "sequence_encoder.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "compressed_format.h"
#include "connectivity_coder.h"
#include "face_list_coder.h"
#include "field_coder.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/mesh/mesh_sections.h"
#include "rest_shape.h"
#include "trial_progress.h"

namespace pleat {
namespace {

// A component is coded when its squared singular value is above this share of V step^2. Between the
// .04 that rate-distortion theory gives for white fields and 0, because fields are sparse.
constexpr double kComponentThreshold = 0.0125;
constexpr int kVerticesPerPart = 512;
constexpr int kGroupsPerReport = 8;
// Shares of the time of a segment that are over when its fields are fitted and coded.
constexpr double kFitted = .25, kCoded = .85;
constexpr double kFittedWithResiduals = .1, kCodedWithResiduals = .3;

// Steps with which one bit lowers the squared error equally wherever it is spent (reverse
// water-filling): every coefficient is scaled to its effect on all positions of all frames.
MotionSteps StepsFor(double step_m, const SequenceAnalysis& analysis, int num_frames) {
  const double num_vertices = static_cast<double>(analysis.rest.cols());
  const double size_squared = std::max<double>(analysis.rest.squaredNorm(), 1e-12);
  MotionSteps steps;
  steps.field_m = static_cast<float>(step_m);
  steps.rest_m = static_cast<float>(step_m / std::sqrt(static_cast<double>(num_frames)));
  // A quaternion's error e turns by 2 e about some axis: it moves the shape by 4 e^2 2/3 |rest|^2.
  steps.rotation = static_cast<float>(step_m / std::sqrt(8.0 / 3 * size_squared));
  steps.translation_m = static_cast<float>(step_m / std::sqrt(num_vertices));
  return steps;
}

CompressedHeader MakeHeader(const MeshSequence& sequence, const SequenceAnalysis& analysis) {
  const MeshAppearance& appearance = sequence.appearance();
  CompressedHeader header;
  header.num_vertices = static_cast<uint32_t>(sequence.num_vertices());
  header.num_faces = static_cast<uint32_t>(sequence.topology().num_faces());
  header.num_corners = static_cast<uint32_t>(sequence.topology().num_corners());
  header.num_frames = static_cast<uint32_t>(sequence.num_frames());
  header.frame_rate = sequence.frame_rate();
  header.num_texcoords = static_cast<uint32_t>(appearance.texcoords.size());
  header.appearance_flags = AppearanceFlags(appearance);
  header.name = sequence.name();
  header.materials.material_library = appearance.material_library;
  header.materials.material_names = appearance.material_names;
  for (const SegmentAnalysis& segment : analysis.segments) {
    header.segment_frames.push_back(static_cast<uint32_t>(segment.num_frames));
  }
  return header;
}

// Least-squares fields of the decoded trajectories (K x T): what remains of the frames after the
// decoded rigid motion and rest shape, projected on their span (V x 3 K).
FieldMatrix FitFields(const MeshSequence& sequence, const Eigen::Matrix3Xf& rest,
                      const MotionSegment& segment, const TrajectoryMatrix& rows, int num_threads) {
  const int num_components = segment.num_components, num_frames = segment.num_frames;
  const int num_vertices = sequence.num_vertices();
  // (rows rows^T)^-1 rows, T x K after the transposition. The ridge only guards equal rows.
  const Eigen::MatrixXd gram =
      rows * rows.transpose() + 1e-9 * Eigen::MatrixXd::Identity(num_components, num_components);
  const Eigen::MatrixXf projection = gram.llt().solve(rows).transpose().cast<float>();
  FieldMatrix fields(num_vertices, 3 * num_components);
  const int num_parts = (num_vertices + kVerticesPerPart - 1) / kVerticesPerPart;
  ParallelFor(num_parts, num_threads, [&](int part) {
    const int v0 = part * kVerticesPerPart, n = std::min(kVerticesPerPart, num_vertices - v0);
    Eigen::MatrixXf left(3 * n, num_frames);
    for (int t = 0; t < num_frames; ++t) {
      const Eigen::Matrix3Xf& frame = sequence.frame(segment.first_frame + t);
      Eigen::Map<Eigen::Matrix3Xf>(left.col(t).data(), 3, n) =
          segment.rotations[t].transpose() *
              (frame.middleCols(v0, n).colwise() - segment.translations[t]) -
          rest.middleCols(v0, n);
    }
    const Eigen::MatrixXf part_fields = left * projection;  // 3n x K
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < num_components; ++k) {
        fields.block<1, 3>(v0 + i, 3 * k) = part_fields.block<3, 1>(3 * i, k).transpose();
      }
    }
  });
  return fields;
}

// Faces, and what an appearance says about them, in the order of the visits.
struct Faces {
  Topology topology;
  MeshAppearance appearance;
};

Faces Reordered(const MeshSequence& sequence) {
  const Topology& topology = sequence.topology();
  const MeshAppearance& appearance = sequence.appearance();
  std::vector<int32_t> corners, sizes;
  Faces faces;
  faces.appearance = appearance;
  faces.appearance.corner_texcoords.clear();
  faces.appearance.face_materials.clear();
  for (const FaceVisit& visit : VisitOrder(topology)) {
    const auto face = topology.face(visit.face);
    const int size = static_cast<int>(face.size());
    sizes.push_back(size);
    for (int i = 0; i < size; ++i) {
      const int corner = (visit.first_corner + i) % size;
      corners.push_back(face[corner]);
      if (appearance.corner_texcoords.empty()) continue;
      const int at = topology.face_start(visit.face) + corner;
      faces.appearance.corner_texcoords.push_back(appearance.corner_texcoords[at]);
    }
    if (appearance.face_materials.empty()) continue;
    faces.appearance.face_materials.push_back(appearance.face_materials[visit.face]);
  }
  absl::StatusOr<Topology> reordered =
      Topology::Create(topology.num_vertices(), std::move(corners), std::move(sizes));
  faces.topology = reordered.ok() ? *std::move(reordered) : topology;  // it is valid as before
  return faces;
}

}  // namespace

// What all segments of one encoding share.
struct SequenceEncoder::Shared {
  const CompressedHeader& header;
  const Eigen::Matrix3Xf& rest;  // decoded
  const SurfaceHierarchy& hierarchy;
};

SequenceEncoder::SequenceEncoder(const MeshSequence& sequence, SequenceAnalysis analysis,
                                 const Eigen::Vector3d& origin_m, bool keep_face_order,
                                 int num_threads)
    : sequence_(sequence),
      analysis_(std::move(analysis)),
      origin_m_(origin_m),
      num_threads_(num_threads) {
  BinaryCoder coder = BinaryCoder::ForEncoding();
  const Faces faces =
      keep_face_order ? Faces{sequence.topology(), sequence.appearance()} : Reordered(sequence);
  EncodeTopology(faces.topology, &coder);
  topology_ = coder.Finish();
  BinaryCoder list_coder = BinaryCoder::ForEncoding();
  EncodeFaceList(faces.topology, &list_coder);
  std::string list = list_coder.Finish();
  is_face_list_ = list.size() < topology_.size();
  if (is_face_list_) topology_ = std::move(list);
  appearance_ = EncodeAppearance(faces.appearance, faces.topology);
}

int SequenceEncoder::NumComponents(const SegmentAnalysis& segment, double step_m) const {
  const double least = std::sqrt(kComponentThreshold * sequence_.num_vertices()) * step_m;
  int count = 0;
  while (count < segment.num_frames && segment.singular_values[count] > least) ++count;
  return count;
}

absl::Status SequenceEncoder::EncodeSegment(const SegmentAnalysis& analysis, const Shared& shared,
                                            const Progress& progress, ByteWriter* writer) const {
  const MotionSteps& steps = shared.header.steps;
  MotionSegment segment;
  segment.first_frame = analysis.first_frame;
  segment.num_frames = analysis.num_frames;
  segment.num_components = NumComponents(analysis, steps.field_m);
  BinaryCoder coder = BinaryCoder::ForEncoding();
  TrajectoryMatrix rigid = analysis.rigid;
  PLEAT_RETURN_IF_ERROR(CodeRigidMotion(steps, &coder, &rigid, &segment));
  TrajectoryMatrix rows = analysis.singular_values.head(segment.num_components).asDiagonal() *
                          analysis.trajectories.topRows(segment.num_components);
  PLEAT_RETURN_IF_ERROR(CodeWeights(steps, &coder, &rows, &segment));
  const bool has_residuals = shared.header.grid.kind != ResidualKind::kNone;
  const double fitted = has_residuals ? kFittedWithResiduals : kFitted;
  const double coded = has_residuals ? kCodedWithResiduals : kCoded;
  segment.fields = FitFields(sequence_, shared.rest, segment, rows, num_threads_);
  PLEAT_RETURN_IF_ERROR(CodeFields(shared.hierarchy, steps.field_m, &coder, &segment.fields,
                                   PartOf(progress, fitted, coded)));
  ByteWriter motion;
  motion.Write(static_cast<uint16_t>(segment.num_components));
  motion.WriteRaw(coder.Finish());
  WriteSection(SectionKind::kMotion, motion.bytes(), writer);

  return EncodeGroups(segment, shared, PartOf(progress, coded, 1), writer);
}

absl::Status SequenceEncoder::EncodeGroups(const MotionSegment& segment, const Shared& shared,
                                           const Progress& progress, ByteWriter* writer) const {
  std::vector<std::string> groups(segment.num_groups());
  std::vector<absl::Status> statuses(groups.size());
  const auto encode_group = [&](int group) {
    if (progress.cancelled()) return;
    std::vector<Eigen::Matrix3Xf> frames;
    EvaluateGroup(shared.rest, segment, group, &frames);
    std::vector<const Eigen::Matrix3Xf*> truth;
    for (size_t i = 0; i < frames.size(); ++i) {
      const size_t t = static_cast<size_t>(segment.first_frame + group * kGroupFrames) + i;
      truth.push_back(&sequence_.frame(static_cast<int>(t)));
    }
    BinaryCoder residuals = BinaryCoder::ForEncoding();
    statuses[group] =
        CodeResiduals(shared.hierarchy, shared.header.grid, truth, &residuals, &frames);
    ByteWriter group_writer;
    group_writer.Write(FramesChecksum(frames));
    if (shared.header.grid.kind != ResidualKind::kNone) group_writer.WriteRaw(residuals.Finish());
    groups[group] = group_writer.Release();
  };
  // In batches, since progress is told between parallel loops.
  for (int first = 0; first < segment.num_groups(); first += kGroupsPerReport) {
    const int count = std::min(kGroupsPerReport, segment.num_groups() - first);
    ParallelFor(count, num_threads_, [&](int item) { encode_group(first + item); });
    PLEAT_RETURN_IF_ERROR(
        progress.Report(static_cast<double>(first + count) / segment.num_groups()));
  }
  for (size_t group = 0; group < groups.size(); ++group) {
    PLEAT_RETURN_IF_ERROR(statuses[group]);
    WriteSection(SectionKind::kGroup, groups[group], writer);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> SequenceEncoder::Encode(double step_m, const ResidualGrid& grid,
                                                    const Progress& progress) const {
  CompressedHeader header = MakeHeader(sequence_, analysis_);
  header.steps = StepsFor(step_m, analysis_, sequence_.num_frames());
  header.grid = grid;
  header.origin_m = origin_m_;
  ByteWriter writer;
  WriteFileKind(kCompressedKind, &writer);
  WriteSection(SectionKind::kHeader, EncodeHeader(header), &writer);
  WriteSection(is_face_list_ ? SectionKind::kFaceList : SectionKind::kTopology, topology_, &writer);
  WriteSection(SectionKind::kAppearance, appearance_, &writer);

  BinaryCoder coder = BinaryCoder::ForEncoding();
  Eigen::Matrix3Xf rest = analysis_.rest;
  PLEAT_RETURN_IF_ERROR(CodeRestShape(sequence_.topology(), header.steps.rest_m, &coder, &rest));
  WriteSection(SectionKind::kRest, coder.Finish(), &writer);
  const SurfaceHierarchy hierarchy(sequence_.topology(), &rest);
  const double num_frames = sequence_.num_frames();
  for (const SegmentAnalysis& segment : analysis_.segments) {
    const Progress part = PartOf(progress, segment.first_frame / num_frames,
                                 (segment.first_frame + segment.num_frames) / num_frames);
    PLEAT_RETURN_IF_ERROR(EncodeSegment(segment, {header, rest, hierarchy}, part, &writer));
  }
  WriteSection(SectionKind::kEnd, {}, &writer);
  return writer.Release();
}

}  // namespace pleat
