// A query goes through four steps, and a batch goes through each of them together:
//
//   Prepare      copies the poses, normalized, and computes the row of features of the pose, and
//                how the edges of the skin lie.
//   Predict      turns these into the features of the skin, and all features into the coefficients
//                of the detail basis and a confidence.
//   Place        computes the motions of the bones and the axes of the details, for one query.
//   FillFrames   expands the coefficients to details and skins the vertices.
//
// Predict and FillFrames read the large parts of the model: weights, training rows, and the basis
// with its 3V rows. They read them once for all queries of a batch. No sum crosses from one query
// to another, so a frame has the same bits whatever else is in its batch.
//
// FillFrames streams over the vertices in tiles of kTileBlocks blocks. For each tile it first
// expands the details of all queries and then skins them, so the 3V details of a frame never exist
// at once, and those of a tile are still in the nearest cache when skinning reads them.
//
// Everything that a query needs on its way is in its Scratch, which keeps its memory. In a batch of
// sessions every query brings the scratch of its own session's evaluator (scratch_of), so what has
// been allocated does not depend on which session evaluates for the others.
// Parameters leave after Predict. Another machine continues with Show, which begins at Place with
// the rounded rotations and gets by without poses of the past and without the training rows.
#include "pleat/character/pose_evaluator.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bone_scales.h"
#include "pleat/base/status.h"
#include "pleat/fitting/details.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skinning/frame_skinning.h"

namespace pleat {

struct PoseEvaluator::Scratch {
  explicit Scratch(const CharacterModel& model);

  std::vector<Pose> history;  // normalized copies; [0] is the pose to show
  std::vector<const Pose*> history_pointers;
  BoneTransforms transforms;
  SkinFeatures::Workspace skin_features;
  std::vector<Eigen::Matrix3d> axes;  // J: the axes in which the details of a bone are written
  BoneMotions motions;
  bool has_details = false;
  double confidence = 0;
  Eigen::VectorXd features;      // of the pose, then of the skin
  Eigen::VectorXf coefficients;  // r
  DetailModel::Workspace workspace;
  PartedBasis::Query expansion;
  std::vector<float> details;             // the details of one tile, block by block
  const float* lane_strengths = nullptr;  // of the query's evaluator, or null: 1
};

namespace {

// Checks a pose that comes from outside and belongs to no valid track.
absl::Status CheckFits(const Pose& pose, int num_joints) {
  PLEAT_RETURN_IF_ERROR(CheckJointCount(pose, num_joints));
  return CheckPose(pose);
}

// Copies without an allocation once `target` has the right size.
void CopyNormalized(const Pose& source, Pose* target) {
  target->root_position = source.root_position;
  target->rotations.resize(source.rotations.size());
  for (size_t j = 0; j < source.rotations.size(); ++j) {
    target->rotations[j] = source.rotations[j].normalized();
  }
}

// Sets the axes of the bones' details. The axes B_t(v) of a vertex are the mean of those of its
// bones, which are all the same unless details are local.
void SetAxes(DetailAxes axes, const BoneTransforms& transforms,
             std::vector<Eigen::Matrix3d>* bone_axes) {
  switch (axes) {
    case DetailAxes::kWorld:
      bone_axes->assign(transforms.rotation.size(), Eigen::Matrix3d::Identity());
      return;
    case DetailAxes::kRoot:
      bone_axes->assign(transforms.rotation.size(), transforms.rotation[0]);
      return;
    case DetailAxes::kLocal:
      *bone_axes = transforms.rotation;
      return;
  }
}

// Makes every bone move with the root, which is the base of models that learn all deformation
// (ComputeDetailBase).
void MoveAllWithRoot(BoneTransforms* transforms) {
  for (size_t b = 1; b < transforms->linear.size(); ++b) {
    transforms->linear[b] = transforms->linear[0];
    transforms->translation[b] = transforms->translation[0];
  }
}

// Multiplies the details of whole blocks, which hold x of their lanes, then y, then z.
void ScaleDetails(const float* strengths, int num_blocks, float* details) {
  for (int block = 0; block < num_blocks; ++block) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int lane = 0; lane < kSkinningLanes; ++lane) *details++ *= strengths[lane];
    }
    strengths += kSkinningLanes;
  }
}

// The largest number of queries that go through the steps together. Larger batches are cut, so that
// lists of queries fit into arrays on the stack.
constexpr size_t kMostTogether = 16;
// Tiles are small, so that the processor begins with the sums of the next one while it still skins
// this one.
constexpr int kTileBlocks = 2;

}  // namespace

static_assert(DetailBasis::kLanes == kSkinningLanes);
static_assert(kMostTogether <= PartedBasis::kMostTogether);

PoseEvaluator::Scratch::Scratch(const CharacterModel& model)
    : history(model.options().history, Pose::Rest(model.skeleton())),
      features(model.detail_model().num_features()),
      coefficients(model.full_basis().num_coefficients()),
      details(kTileBlocks * DetailBasis::kBlockDetails) {
  for (const Pose& pose : history) history_pointers.push_back(&pose);
}

PoseEvaluator::PoseEvaluator(std::shared_ptr<const CharacterModel> model)
    : model_(std::move(model)) {}

PoseEvaluator::~PoseEvaluator() = default;
PoseEvaluator::PoseEvaluator(PoseEvaluator&&) noexcept = default;
PoseEvaluator& PoseEvaluator::operator=(PoseEvaluator&&) noexcept = default;

const CharacterModel& PoseEvaluator::model() const { return *model_; }

absl::Status PoseEvaluator::SetDetailStrengths(const DetailStrengths& strengths) {
  PLEAT_RETURN_IF_ERROR(
      CheckDetailStrengths(strengths, model_->skeleton().num_joints(), model_->num_vertices()));
  lane_strengths_.clear();
  if (!strengths.empty()) lane_strengths_ = LaneStrengths(*model_, strengths);
  return absl::OkStatus();
}

absl::Status PoseEvaluator::Evaluate(const std::vector<const Pose*>& poses,
                                     const std::vector<double>& bone_scales,
                                     EvaluatedFrame* frame) {
  PoseQuery query{.poses = &poses, .bone_scales = &bone_scales, .frame = frame};
  EvaluateBatch({&query, 1});
  return query.status;
}

absl::Status PoseEvaluator::EvaluateSkinned(const Pose& pose,
                                            const std::vector<double>& bone_scales,
                                            EvaluatedFrame* frame) {
  one_pose_.assign(1, &pose);
  PoseQuery query{
      .poses = &one_pose_, .bone_scales = &bone_scales, .skinned_only = true, .frame = frame};
  EvaluateBatch({&query, 1});
  return query.status;
}

void PoseEvaluator::TakeParameters(const Scratch& scratch, FrameParameters* parameters) {
  parameters->pose = scratch.history[0];
  for (Eigen::Quaterniond& rotation : parameters->pose.rotations) {
    const Eigen::Quaternionf rounded = rotation.cast<float>();
    rotation = rounded.cast<double>();
  }
  parameters->confidence = scratch.confidence;
  if (scratch.has_details) {
    parameters->coefficients = scratch.coefficients;
  } else {
    parameters->coefficients.resize(0);
  }
}

PoseEvaluator::Scratch* PoseEvaluator::ScratchAt(size_t number) {
  while (scratches_.size() <= number) scratches_.push_back(std::make_unique<Scratch>(*model_));
  return scratches_[number].get();
}

void PoseEvaluator::EvaluateBatch(std::span<PoseQuery> queries) {
  for (PoseQuery& query : queries) query.status = Check(query);
  EvaluateChecked(queries);
}

void PoseEvaluator::EvaluateChecked(std::span<PoseQuery> queries) {
  static const std::vector<double> kNoScales;
  for (size_t begin = 0; begin < queries.size(); begin += kMostTogether) {
    std::array<Scratch*, kMostTogether> scratches{};
    std::array<VertexRows, kMostTogether> positions{};
    std::array<PoseQuery*, kMostTogether> taken{};
    size_t count = 0, num_own = 0;
    // Queries with details come first, because Predict takes them from the front.
    for (const bool skinned_only : {false, true}) {
      for (size_t q = begin; q < std::min(begin + kMostTogether, queries.size()); ++q) {
        if (queries[q].skinned_only != skinned_only) continue;
        if (!queries[q].status.ok()) continue;
        PoseEvaluator* const lender = queries[q].scratch_of;
        Scratch* scratch = lender != nullptr ? lender->ScratchAt(0) : ScratchAt(num_own++);
        const PoseEvaluator& owner = lender != nullptr ? *lender : *this;
        scratch->lane_strengths =
            owner.lane_strengths_.empty() ? nullptr : owner.lane_strengths_.data();
        Prepare(queries[q], scratch);
        taken[count] = &queries[q];
        scratches[count++] = scratch;
      }
    }
    Predict({scratches.data(), count});
    size_t num_frames = 0;  // queries that want parameters drop out; the others move up
    for (size_t i = 0; i < count; ++i) {
      if (taken[i]->parameters != nullptr) {
        TakeParameters(*scratches[i], taken[i]->parameters);
        continue;
      }
      Place(taken[i]->bone_scales ? *taken[i]->bone_scales : kNoScales, scratches[i]);
      taken[i]->frame->confidence = scratches[i]->confidence;
      positions[num_frames] = RowsFor(taken[i]->rows, taken[i]->frame);
      scratches[num_frames++] = scratches[i];
    }
    FillFrames({scratches.data(), num_frames}, {positions.data(), num_frames});
  }
}

size_t PoseEvaluator::NumPosesOf(const PoseQuery& query) const {
  return query.skinned_only ? 1 : static_cast<size_t>(model_->options().history);
}

absl::Status PoseEvaluator::Check(const PoseQuery& query) const {
  const std::vector<const Pose*>& poses = *query.poses;
  const int num_joints = model_->skeleton().num_joints();
  if (poses.empty()) return absl::InvalidArgumentError("a pose query needs at least one pose");
  if (query.bone_scales != nullptr) {
    PLEAT_RETURN_IF_ERROR(CheckBoneScales(*query.bone_scales, num_joints));
  }
  for (size_t h = 0; h < std::min(NumPosesOf(query), poses.size()); ++h) {
    PLEAT_RETURN_IF_ERROR(CheckFits(*poses[h], num_joints));
  }
  return absl::OkStatus();
}

void PoseEvaluator::Prepare(const PoseQuery& query, Scratch* scratch) const {
  Scratch& s = *scratch;
  const std::vector<const Pose*>& poses = *query.poses;
  for (size_t h = 0; h < NumPosesOf(query); ++h) {
    CopyNormalized(*poses[std::min(h, poses.size() - 1)], &s.history[h]);
  }
  s.has_details = !query.skinned_only;
  s.confidence = 1;
  if (!s.has_details) return;
  model_->features().ComputeRow(s.history_pointers,
                                s.features.head(model_->features().num_features()));
  if (!model_->skin_features()) return;
  // Without the scales of the bones: the learner knows the body in its own proportions.
  ComputeBoneTransforms(model_->skeleton(), s.history[0], {}, &s.transforms);
  model_->skin_features()->Gather(s.transforms, &s.skin_features);
}

void PoseEvaluator::Predict(std::span<Scratch* const> scratches) const {
  std::array<DetailModel::Query, kMostTogether> queries;
  std::array<SkinFeatures::Query, kMostTogether> skin_queries;
  const std::optional<SkinFeatures>& skin = model_->skin_features();
  const Eigen::Index num_pose_features = model_->features().num_features();
  size_t count = 0;
  for (; count < scratches.size() && scratches[count]->has_details; ++count) {
    Scratch& s = *scratches[count];
    skin_queries[count] = {.workspace = &s.skin_features,
                           .features = s.features.data() + num_pose_features};
    queries[count] = {.features = s.features.data(),
                      .workspace = &s.workspace,
                      .coefficients = s.coefficients.data()};
  }
  if (skin) skin->Project({skin_queries.data(), count});
  model_->detail_model().PredictCoefficients(std::span(queries.data(), count));
  for (size_t q = 0; q < count; ++q) scratches[q]->confidence = queries[q].confidence;
}

void PoseEvaluator::Place(const std::vector<double>& bone_scales, Scratch* scratch) const {
  Scratch& s = *scratch;
  ComputeBoneTransforms(model_->skeleton(), s.history[0], bone_scales, &s.transforms);
  SetAxes(model_->options().detail_axes, s.transforms, &s.axes);
  if (s.has_details && model_->options().deformation == DetailBase::kRoot) {
    MoveAllWithRoot(&s.transforms);
  }
  model_->skinning().SetMotions(s.transforms, s.axes, &s.motions);
  if (s.has_details) model_->full_basis().SetCoefficients(s.coefficients, &s.expansion);
}

absl::Status PoseEvaluator::Predict(const std::vector<const Pose*>& poses, bool skinned_only,
                                    FrameParameters* parameters) {
  PoseQuery query{.poses = &poses, .skinned_only = skinned_only, .parameters = parameters};
  EvaluateBatch({&query, 1});
  return query.status;
}

absl::Status PoseEvaluator::Show(const FrameParameters& parameters,
                                 const std::vector<double>& bone_scales, EvaluatedFrame* frame,
                                 const VertexRows& rows) {
  const Eigen::VectorXf& coefficients = parameters.coefficients;
  const int num_joints = model_->skeleton().num_joints();
  PLEAT_RETURN_IF_ERROR(CheckBoneScales(bone_scales, num_joints));
  PLEAT_RETURN_IF_ERROR(CheckFits(parameters.pose, num_joints));
  if (coefficients.size() != 0 && coefficients.size() != model_->full_basis().num_coefficients()) {
    return absl::InvalidArgumentError(
        absl::StrCat(coefficients.size(), " detail coefficients for a model of ",
                     model_->full_basis().num_coefficients(), "; is it another model?"));
  }
  if (!coefficients.allFinite()) {
    return absl::InvalidArgumentError("a detail coefficient is not finite");
  }
  Scratch* scratch = ScratchAt(0);
  scratch->lane_strengths = lane_strengths_.empty() ? nullptr : lane_strengths_.data();
  CopyNormalized(parameters.pose, &scratch->history[0]);
  scratch->has_details = coefficients.size() > 0;
  scratch->confidence = parameters.confidence;
  if (scratch->has_details) scratch->coefficients = coefficients;
  Place(bone_scales, scratch);
  frame->confidence = scratch->confidence;
  const VertexRows positions = RowsFor(rows, frame);
  FillFrames({&scratch, 1}, {&positions, 1});
  return absl::OkStatus();
}

VertexRows PoseEvaluator::RowsFor(const VertexRows& rows, EvaluatedFrame* frame) const {
  if (rows.data != nullptr) return rows;
  frame->positions.resize(3, model_->num_vertices());
  return RowsOf(&frame->positions);
}

void PoseEvaluator::FillFrames(std::span<Scratch* const> scratches,
                               std::span<const VertexRows> positions) {
  std::array<const PartedBasis::Query*, kMostTogether> expansions{};
  std::array<float*, kMostTogether> details{};
  size_t num_detailed = 0;
  for (size_t q = 0; q < scratches.size(); ++q) {
    if (!scratches[q]->has_details) continue;
    expansions[num_detailed] = &scratches[q]->expansion;
    details[num_detailed++] = scratches[q]->details.data();
  }
  const int num_blocks = model_->full_basis().num_blocks();
  for (int block = 0; block < num_blocks; block += kTileBlocks) {
    const int count = std::min(kTileBlocks, num_blocks - block);
    model_->full_basis().ExpandBlocks({expansions.data(), num_detailed}, block, count,
                                      {details.data(), num_detailed});
    for (size_t q = 0; q < scratches.size(); ++q) {
      Scratch& s = *scratches[q];
      if (s.has_details && s.lane_strengths != nullptr) {
        ScaleDetails(s.lane_strengths + static_cast<size_t>(block) * kSkinningLanes, count,
                     s.details.data());
      }
      model_->skinning().SkinBlocks(s.motions, block, count,
                                    s.has_details ? s.details.data() : nullptr, positions[q]);
    }
  }
}

}  // namespace pleat
