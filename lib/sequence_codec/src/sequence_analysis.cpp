#include "sequence_analysis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "compressed_format.h"
#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/math/rigid.h"

namespace pleat {
namespace {

constexpr int kNumAlignments = 3, kNumGramParts = 8;

struct Alignment {
  std::vector<RigidTransform> poses;  // frame from rest
  Eigen::Matrix3Xd rest;              // 3 x V, centered
};

Eigen::Matrix3Xd Centered(const Eigen::Matrix3Xf& frame, Eigen::Vector3d* center) {
  Eigen::Matrix3Xd positions = frame.cast<double>();
  *center = positions.rowwise().mean();
  return positions.colwise() - *center;
}

// The mean shape and the rigid motions that bring it to the frames, in turn (generalized
// Procrustes, Gower 1975).
absl::StatusOr<Alignment> Align(const MeshSequence& sequence, int num_threads,
                                const Progress& progress) {
  const int num_frames = sequence.num_frames();
  Alignment alignment;
  alignment.poses.resize(num_frames);
  Eigen::Vector3d ignored;
  alignment.rest = Centered(sequence.frame(0), &ignored);
  for (int round = 0; round < kNumAlignments; ++round) {
    ParallelFor(num_frames, num_threads, [&](int t) {
      if (progress.cancelled()) return;
      Eigen::Vector3d center;
      const Eigen::Matrix3Xd frame = Centered(sequence.frame(t), &center);
      const absl::StatusOr<RigidTransform> fit = FitRigidTransform(alignment.rest, frame);
      alignment.poses[t].rotation = fit.ok() ? fit->rotation : Eigen::Matrix3d::Identity();
      alignment.poses[t].translation = center;
    });
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, sequence.num_vertices());
    for (int t = 0; t < num_frames; ++t) {
      const RigidTransform& pose = alignment.poses[t];
      sum += pose.rotation.transpose() *
             (sequence.frame(t).cast<double>().colwise() - pose.translation);
    }
    alignment.rest = sum / num_frames;
    PLEAT_RETURN_IF_ERROR(progress.Report((round + 1.0) / kNumAlignments));
  }
  return alignment;
}

TrajectoryMatrix RigidRows(const Alignment& alignment, int first, int count) {
  TrajectoryMatrix rows(7, count);
  Eigen::Vector4d last(1, 0, 0, 0);
  for (int t = 0; t < count; ++t) {
    const RigidTransform& pose = alignment.poses[first + t];
    const Eigen::Quaterniond rotation(pose.rotation);
    Eigen::Vector4d q(rotation.w(), rotation.x(), rotation.y(), rotation.z());
    if (q.dot(last) < 0) q = -q;
    last = q;
    rows.col(t) << q, pose.translation;
  }
  return rows;
}

// T x T products of the aligned frames without the rest shape.
Eigen::MatrixXd GramMatrix(const MeshSequence& sequence, const Alignment& alignment, int first,
                           int count, int num_threads, const Progress& progress) {
  const int num_vertices = sequence.num_vertices();
  std::vector<Eigen::MatrixXd> parts(kNumGramParts);
  // A fixed number of parts, summed in a fixed order: the same bits for any number of threads.
  ParallelFor(kNumGramParts, num_threads, [&](int part) {
    parts[part] = Eigen::MatrixXd::Zero(count, count);
    const int begin = static_cast<int>(int64_t{num_vertices} * part / kNumGramParts);
    const int end = static_cast<int>(int64_t{num_vertices} * (part + 1) / kNumGramParts);
    constexpr int kBlock = 256;
    for (int v = begin; v < end && !progress.cancelled(); v += kBlock) {
      const int n = std::min(kBlock, end - v);
      Eigen::MatrixXd block(3 * n, count);
      for (int t = 0; t < count; ++t) {
        const RigidTransform& pose = alignment.poses[first + t];
        Eigen::Map<Eigen::Matrix3Xd>(block.col(t).data(), 3, n) =
            pose.rotation.transpose() *
                (sequence.frame(first + t).middleCols(v, n).cast<double>().colwise() -
                 pose.translation) -
            alignment.rest.middleCols(v, n);
      }
      parts[part].selfadjointView<Eigen::Lower>().rankUpdate(block.transpose());
    }
  });
  for (int part = 1; part < kNumGramParts; ++part) parts[0] += parts[part];
  return parts[0];
}

void PrincipalTrajectories(const Eigen::MatrixXd& gram, SegmentAnalysis* segment) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(gram);  // reads the lower triangle
  const int count = segment->num_frames;
  segment->singular_values = solver.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
  segment->trajectories.resize(count, count);
  for (int k = 0; k < count; ++k) {
    segment->trajectories.row(k) = solver.eigenvectors().col(count - 1 - k).transpose();
  }
}

}  // namespace

absl::StatusOr<SequenceAnalysis> AnalyzeSequence(const MeshSequence& sequence, int num_threads,
                                                 const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const Alignment alignment,
                         Align(sequence, num_threads, progress.Stage("align", 0, 0.3)));
  SequenceAnalysis analysis;
  analysis.rest = alignment.rest.cast<float>();
  const Progress gram_progress = progress.Stage("analyse", 0.3, 1);
  const int num_frames = sequence.num_frames();
  const int num_segments = (num_frames + kMaxSegmentFrames - 1) / kMaxSegmentFrames;
  for (int s = 0; s < num_segments; ++s) {
    SegmentAnalysis segment;
    segment.first_frame = static_cast<int>(int64_t{num_frames} * s / num_segments);
    segment.num_frames =
        static_cast<int>(int64_t{num_frames} * (s + 1) / num_segments) - segment.first_frame;
    segment.rigid = RigidRows(alignment, segment.first_frame, segment.num_frames);
    const Eigen::MatrixXd gram = GramMatrix(sequence, alignment, segment.first_frame,
                                            segment.num_frames, num_threads, gram_progress);
    PLEAT_RETURN_IF_ERROR(gram_progress.Report((s + 0.8) / num_segments));
    PrincipalTrajectories(gram, &segment);
    analysis.segments.push_back(std::move(segment));
  }
  PLEAT_RETURN_IF_ERROR(gram_progress.Report(1));
  return analysis;
}

}  // namespace pleat
