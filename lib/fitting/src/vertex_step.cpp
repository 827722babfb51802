#include "vertex_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <utility>

#include "pleat/base/parallel.h"
#include "pleat/base/status.h"
#include "pleat/optimize/simplex_qp.h"

namespace pleat {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr int kVerticesPerItem = 128;  // grain of the parallel loops

// Returns T_b of all bones of one frame, transposed: 4J x 3.
MatrixXd BoneMatrices(const Skeleton& skeleton, const ChainPose& pose, const Vector3d& center) {
  const int num_joints = skeleton.num_joints();
  MatrixXd bones = MatrixXd::Zero(4 * num_joints, 3);
  Eigen::Matrix3Xd joints(3, num_joints);  // posed, relative to the frame's center
  joints.col(0) = pose.root_position;
  for (int b = 1; b < num_joints; ++b) {
    const int parent = skeleton.parent(b);
    const Eigen::Matrix3d rotation = pose.rotation(b);
    joints.col(b) = joints.col(parent) +
                    rotation * (skeleton.rest_position(b) - skeleton.rest_position(parent));
    bones.block<3, 3>(4 * b, 0) = rotation.transpose();
    bones.row(4 * b + 3) =
        (joints.col(parent) - rotation * (skeleton.rest_position(parent) - center)).transpose();
  }
  return bones;
}

// The bones that a vertex may take, ascending. Further ones are dropped when it is full, so bones
// are added by falling likelihood.
class Candidates {
 public:
  void Add(int bone) {
    if (size_ == kMaxSimplexQpSize || bone < 1) return;
    if (std::find(bones_.begin(), bones_.begin() + size_, bone) == bones_.begin() + size_) {
      bones_[size_++] = bone;
    }
  }
  void Sort() { std::sort(bones_.begin(), bones_.begin() + size_); }
  int size() const { return size_; }
  int operator[](int k) const { return bones_[k]; }

 private:
  std::array<int, kMaxSimplexQpSize> bones_{};
  int size_ = 0;
};

void AddSupport(const VertexInfluences& influences, Candidates* candidates) {
  for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
    candidates->Add(influences.bones[k]);
  }
}

// The order of adding matters where there are more than 16: own bones, then those of neighbors,
// then those next to the own ones in the skeleton. Ascending order afterwards makes the solution
// independent of the order of the neighbors.
Candidates FindCandidates(const Skeleton& skeleton, const std::vector<VertexInfluences>& current,
                          std::span<const int32_t> neighbors, int v) {
  Candidates candidates;
  AddSupport(current[v], &candidates);
  const int num_own = candidates.size();
  for (const int32_t n : neighbors) AddSupport(current[n], &candidates);
  for (int k = 0; k < num_own; ++k) {
    const int bone = candidates[k];
    candidates.Add(skeleton.parent(bone));
    for (const int child : skeleton.children(bone)) candidates.Add(child);
    for (const int sibling : skeleton.children(skeleton.parent(bone))) candidates.Add(sibling);
  }
  candidates.Sort();
  return candidates;
}

// Adds scale * the weights of those bones of `influences` that are among the candidates.
void AddWeights(const VertexInfluences& influences, const Candidates& candidates, double scale,
                SimplexQpVector* sum) {
  for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
    for (int c = 0; c < candidates.size(); ++c) {
      if (candidates[c] == influences.bones[k]) (*sum)[c] += scale * influences.weights[k];
    }
  }
}

VertexInfluences ToInfluences(const Candidates& candidates, const SimplexQpVector& weights,
                              int max_influences) {
  std::array<int, kMaxSimplexQpSize> order;
  for (int c = 0; c < candidates.size(); ++c) order[c] = c;
  std::stable_sort(order.begin(), order.begin() + candidates.size(),
                   [&](int a, int b) { return weights[a] > weights[b]; });
  VertexInfluences influences;
  const int count = std::min(max_influences, candidates.size());
  double sum = 0;
  for (int k = 0; k < count; ++k) sum += weights[order[k]];
  for (int k = 0; k < count && weights[order[k]] > 1e-6; ++k) {
    influences.bones[k] = static_cast<uint16_t>(candidates[order[k]]);
    influences.weights[k] = static_cast<float>(weights[order[k]] / sum);
  }
  return influences;
}

// Returns the mean squared distance of the rest mesh from its center, in square meters: the unit of
// the pulls.
double SquaredSize(const Rig& rig, const Vector3d& center) {
  return (rig.rest_positions.colwise() - center).colwise().squaredNorm().mean();
}

// Solves the weights of vertex v, with the `current` weights of its neighbors held.
VertexInfluences SolveVertexWeights(const VertexMoments& moments, const Rig& rig,
                                    const VertexInfluences& first,
                                    const std::vector<VertexInfluences>& current,
                                    std::span<const int32_t> neighbors,
                                    const WeightStepOptions& options, double unit, int v) {
  const Candidates candidates = FindCandidates(rig.skeleton, current, neighbors, v);
  const int n = candidates.size();
  Vector4d u;
  u << rig.rest_positions.col(v) - moments.rest_center, 1;
  SimplexQpMatrix hessian(n, n);
  SimplexQpVector linear = SimplexQpVector::Zero(n), x = SimplexQpVector::Zero(n);
  for (int a = 0; a < n; ++a) {
    const int row = 4 * candidates[a];
    linear[a] = u.dot(moments.cross.col(v).segment<4>(row));
    for (int b = 0; b <= a; ++b) {
      hessian(a, b) = u.dot(moments.pairs.block<4, 4>(row, 4 * candidates[b]) * u);
      hessian(b, a) = hessian(a, b);
    }
  }
  // Even without pulls every bone keeps a trace, so that bones that move alike are told apart.
  constexpr double kRidge = 1e-9;
  const double smoothness = neighbors.empty() ? 0 : unit * options.smoothness;
  const double prior = unit * (options.prior + kRidge);
  hessian.diagonal().array() += smoothness + prior;
  AddWeights(first, candidates, prior, &linear);
  for (const int32_t neighbor : neighbors) {
    AddWeights(current[neighbor], candidates, smoothness / static_cast<double>(neighbors.size()),
               &linear);
  }
  AddWeights(current[v], candidates, 1, &x);
  x /= x.sum();
  SolveSparseSimplexQp(hessian, linear, options.max_influences, &x);
  return ToInfluences(candidates, x, options.max_influences);
}

}  // namespace

absl::StatusOr<VertexMoments> ComputeVertexMoments(const MeshSequence& sequence,
                                                   const std::vector<int>& frames,
                                                   const std::vector<ChainPose>& poses,
                                                   const std::vector<Vector3d>& centers,
                                                   const Rig& rig, int num_threads,
                                                   const Progress& progress) {
  const int num_frames = static_cast<int>(frames.size());
  const int num_rows = 4 * rig.skeleton.num_joints();
  const int num_vertices = sequence.num_vertices();
  VertexMoments moments;
  moments.num_frames = num_frames;
  moments.rest_center = rig.rest_positions.rowwise().mean();
  MatrixXd bones(num_rows, 3 * num_frames);
  for (int f = 0; f < num_frames; ++f) {
    bones.middleCols<3>(3 * f) = BoneMatrices(rig.skeleton, poses[f], moments.rest_center);
  }
  moments.pairs = bones * bones.transpose();
  moments.cross.resize(num_rows, num_vertices);
  const int num_items = (num_vertices + kVerticesPerItem - 1) / kVerticesPerItem;
  ParallelFor(num_items, num_threads, [&](int item) {
    if (progress.cancelled()) return;
    const int begin = item * kVerticesPerItem;
    const int count = std::min(kVerticesPerItem, num_vertices - begin);
    MatrixXd observed(3 * num_frames, count);
    for (int f = 0; f < num_frames; ++f) {
      observed.middleRows<3>(3 * f) =
          sequence.frame(frames[f]).middleCols(begin, count).cast<double>().colwise() - centers[f];
    }
    moments.cross.middleCols(begin, count).noalias() = bones * observed;
  });
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return moments;
}

absl::StatusOr<SkinWeights> RefineWeights(const VertexMoments& moments, const Rig& rig,
                                          const SkinWeights& first,
                                          const VertexAdjacency& adjacency,
                                          const WeightStepOptions& options,
                                          const Progress& progress) {
  const double unit = moments.num_frames * SquaredSize(rig, moments.rest_center);
  std::vector<VertexInfluences> current = rig.weights.influences();
  // Each sweep reads the weights of the sweep before and writes new ones (Jacobi, not
  // Gauss-Seidel), so neither the order of vertices nor the number of threads shows.
  std::vector<VertexInfluences> next(current.size());
  for (int sweep = 0; sweep < options.num_sweeps; ++sweep) {
    const double count = options.num_sweeps;
    PLEAT_RETURN_IF_ERROR(
        ParallelForPieces(rig.weights.num_vertices(), kVerticesPerItem, options.num_threads,
                          progress.Stage("refine", sweep / count, (sweep + 1) / count), [&](int v) {
                            next[v] = SolveVertexWeights(moments, rig, first.vertex(v), current,
                                                         adjacency.neighbors(v), options, unit, v);
                          }));
    current.swap(next);
  }
  return SkinWeights::Create(rig.skeleton.num_joints(), std::move(current));
}

absl::StatusOr<Eigen::Matrix3Xd> RefineRestPositions(const VertexMoments& moments, const Rig& rig,
                                                     const Eigen::Matrix3Xd& first,
                                                     const VertexAdjacency& adjacency,
                                                     const RestStepOptions& options,
                                                     const Progress& progress) {
  Eigen::Matrix3Xd current = rig.rest_positions, next(3, current.cols());
  for (int sweep = 0; sweep < options.num_sweeps; ++sweep) {
    const double count = options.num_sweeps;
    PLEAT_RETURN_IF_ERROR(ParallelForPieces(
        rig.weights.num_vertices(), kVerticesPerItem, options.num_threads,
        progress.Stage("refine", sweep / count, (sweep + 1) / count), [&](int v) {
          // The skinned vertex is v_it = L_t u + l_t with [L_t l_t] = sum_b W_ib T_bt.
          const VertexInfluences& influences = rig.weights.vertex(v);
          Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();  // sum_t [L l]^T [L l]
          Vector4d target = Vector4d::Zero();               // sum_t [L l]^T y
          for (int k = 0; k < kMaxInfluences && influences.weights[k] > 0; ++k) {
            const int b = 4 * influences.bones[k];
            target += influences.weights[k] * moments.cross.col(v).segment<4>(b);
            for (int l = 0; l < kMaxInfluences && influences.weights[l] > 0; ++l) {
              blend += influences.weights[k] * influences.weights[l] *
                       moments.pairs.block<4, 4>(b, 4 * influences.bones[l]);
            }
          }
          const auto neighbors = adjacency.neighbors(v);
          Vector3d mean = Vector3d::Zero();  // mean displacement of the neighbors
          for (const int32_t n : neighbors) mean += current.col(n) - first.col(n);
          if (!neighbors.empty()) mean /= static_cast<double>(neighbors.size());
          const double prior = moments.num_frames * options.prior;
          const double smoothness = neighbors.empty() ? 0 : moments.num_frames * options.smoothness;
          Eigen::Matrix3d matrix = blend.topLeftCorner<3, 3>();
          matrix.diagonal().array() += prior + smoothness;
          const Vector3d anchor = first.col(v) - moments.rest_center;
          const Vector3d right = target.head<3>() - blend.topRightCorner<3, 1>() + prior * anchor +
                                 smoothness * (anchor + mean);
          next.col(v) = matrix.ldlt().solve(right) + moments.rest_center;
        }));
    current.swap(next);
  }
  return current;
}

}  // namespace pleat
