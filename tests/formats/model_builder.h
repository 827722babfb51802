// A small character model made by hand: every part of the file is there and none is trained.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "pleat/base/random.h"
#include "pleat/character/character_model.h"
#include "support/mesh_shapes.h"

namespace pleat {

// Three joints, a box, one training row per stage. kSgplvm: two stages, a control mesh of four
// vertices and an upsampler; else one stage at full resolution, with two regions for kRegional.
class SmallModelBuilder {
 public:
  explicit SmallModelBuilder(Learner learner) : learner_(learner), random_(7) {}

  CharacterModel::Parts Parts() {
    const MeshShape box = MakeBox({0.4, 1.6, 0.2});
    CharacterModel::Parts parts;
    parts.name = "small";
    parts.frame_rate = {25, 1};
    parts.topology = box.topology;
    parts.appearance.material_library = "a.mtl";
    parts.appearance.material_names = {"cloth"};
    parts.appearance.face_materials = {0, -1, 0, 0, 0, 0};
    parts.rig.rest_positions = box.positions;
    parts.rig.skeleton = *Skeleton::Create(
        {{"hips", -1, {0, 0, 0}}, {"chest", 0, {0, 0.4, 0}}, {"head", 1, {0, 0.8, 0}}});
    std::vector<VertexInfluences> influences(8);
    for (size_t v = 0; v < 8; ++v) influences[v] = {{1, 2, 0, 0}, {0.75f, 0.25f, 0, 0}};
    parts.rig.weights = *SkinWeights::Create(3, influences);
    parts.options.learner = *ParseChoice<LearnerChoice>("learner", LearnerName(learner_));
    parts.options.resolution_percent = learner_ == Learner::kSgplvm ? 50 : 100;
    parts.feature_reference = Vector(6);
    AddControl(&parts);
    parts.detail_model = std::make_shared<const DetailModel>(
        *DetailModel::FromParameters(Detail(static_cast<int>(parts.control_vertices.size()))));
    parts.record.learner = LearnerName(learner_);
    parts.record.num_frames = 3;
    parts.record.yaw_degrees = 90;
    parts.record.diagonal_m = 1.66;
    parts.record.fit.mean_percent = 1.25;
    parts.record.reconstruction.mean_mm = 0.5;
    parts.record.warnings = {"the rig is made by hand"};
    parts.record.worst_frames = {{0, 2, 3.5}, {0, 1, 1.5}};
    parts.record.joint_fit_percent = {0, 1.25, 0.75};
    parts.record.pose_jitter_degrees = 0.5;
    parts.record.unsmoothed_jitter_degrees = 0.625;
    parts.record.unsmoothed_rms_percent = 1.125;
    parts.record.validation = {4, {{"gp", 0.5}, {"sgplvm", 0.75}}};
    return parts;
  }
  std::shared_ptr<const CharacterModel> Build() { return *CharacterModel::Create(Parts()); }

 private:
  Eigen::MatrixXd Matrix(int rows, int columns) {
    Eigen::MatrixXd matrix(rows, columns);
    for (double& entry : matrix.reshaped()) entry = random_.Uniform(-1, 1);
    return matrix;
  }
  Eigen::VectorXd Vector(int size) { return Matrix(size, 1).col(0); }

  void AddControl(CharacterModel::Parts* parts) {
    if (learner_ != Learner::kSgplvm) {
      parts->control_vertices = {0, 1, 2, 3, 4, 5, 6, 7};
      return;
    }
    parts->control_vertices = {1, 3, 4, 6};
    std::vector<int32_t> row_starts = {0}, columns;
    std::vector<float> values;
    for (int v = 0; v < 8; ++v) {
      columns.push_back(v / 2);
      values.push_back(0.75f);
      if (v < 6) {
        columns.push_back(v / 2 + 1);
        values.push_back(0.25f);
      }
      row_starts.push_back(static_cast<int32_t>(columns.size()));
    }
    parts->upsampler = *RbfUpsampler::FromRows(4, row_starts, columns, values);
  }

  GpRegressionParameters Stage(int num_inputs, int num_outputs) {
    constexpr int kRows = 3;
    GpRegressionParameters stage;
    stage.kernel_options.linear = true;
    stage.input_mean = Vector(num_inputs);
    stage.input_scales = Eigen::VectorXd::LinSpaced(num_inputs, 1, 2);
    stage.inputs = Matrix(kRows, num_inputs);
    stage.output_mean = Vector(num_outputs);
    stage.output_scale = 0.01;
    stage.alpha = Matrix(kRows, num_outputs);
    stage.whitener =
        Matrix(kRows, kRows).triangularView<Eigen::Lower>().toDenseMatrix().cast<float>();
    return stage;
  }

  RegionalGpParameters Regional(int num_inputs, int num_outputs) {
    constexpr int kRows = 3;
    RegionalGpParameters regional;
    regional.input_mean = Vector(num_inputs);
    regional.input_scales = Eigen::VectorXd::LinSpaced(num_inputs, 1, 2);
    regional.inputs = Matrix(kRows, num_inputs);
    regional.output_mean = Vector(num_outputs);
    for (const std::vector<int>& columns : {std::vector<int>{0, 1, 2}, {1, 4}}) {
      RegionalGpParameters::Region region;
      region.scales = {{columns, 0.5, 1.5, 0.25}, {{2, 3, 5}, 2, 0.5, 0}};
      region.bias = 0.125;
      region.alpha = Matrix(kRows, num_outputs).cast<float>();
      regional.regions.push_back(std::move(region));
    }
    return regional;
  }

  DetailModelParameters Detail(int num_control) {
    constexpr int kComponents = 2, kLatent = 2, kFeatures = 12;
    DetailModelParameters detail;
    const bool sgplvm = learner_ == Learner::kSgplvm;
    detail.learner = learner_;
    if (sgplvm) detail.stages.push_back(Stage(kFeatures, kLatent));
    detail.stages.push_back(Stage(sgplvm ? kLatent : kFeatures, kComponents));
    if (learner_ == Learner::kRegional) {
      detail.regional_share = 0.5;
      detail.regional = Regional(kFeatures, kComponents);
    }
    const Eigen::VectorXf mean = Vector(3 * num_control).cast<float>() * 0.01f;
    const Eigen::MatrixXd basis = Matrix(3 * num_control, kComponents);
    detail.basis = PartedBasisParameters::Whole(
        DetailBasis::Quantize(mean, basis, Eigen::VectorXd::Constant(kComponents, 1e-4))
            .value()
            .parameters());
    return detail;
  }

  Learner learner_;
  Random random_;
};

}  // namespace pleat
