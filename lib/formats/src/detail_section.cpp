#include "detail_section.h"

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "model_versions.h"
#include "planes_section.h"
#include "pleat/base/status.h"
#include "pleat/math/array_io.h"
#include "regional_section.h"

namespace pleat {
namespace {

constexpr uint32_t kHasBias = 1, kHasLinear = 2;
constexpr uint32_t kMaxStages = 2;

// Returns the floating-point fields that stand before the sizes of a stage, in the order of the
// file.
std::array<double, 7> KernelNumbers(const GpRegressionParameters& stage) {
  const KernelLogs& logs = stage.kernel;
  return {stage.kernel_options.relative_noise_floor,
          stage.kernel_options.absolute_jitter,
          logs.inverse_width,
          logs.amplitude,
          logs.bias,
          logs.noise,
          logs.linear};
}

void WriteStage(const GpRegressionParameters& stage, ByteWriter* writer) {
  writer->Write((stage.kernel_options.bias ? kHasBias : 0) |
                (stage.kernel_options.linear ? kHasLinear : 0));
  const std::array<double, 7> numbers = KernelNumbers(stage);
  writer->WriteArray(std::span<const double>(numbers));
  writer->Write(static_cast<uint32_t>(stage.inputs.rows()));
  writer->Write(static_cast<uint32_t>(stage.inputs.cols()));
  writer->Write(static_cast<uint32_t>(stage.alpha.cols()));
  writer->Write(stage.output_scale);
  WriteMatrix(stage.input_mean, writer);
  WriteMatrix(stage.input_scales, writer);
  WriteMatrix(stage.inputs, writer);
  WriteMatrix(stage.output_mean, writer);
  WriteMatrix(stage.alpha, writer);
  for (Eigen::Index row = 0; row < stage.whitener.rows(); ++row) {
    const Eigen::VectorXf values = stage.whitener.row(row).head(row + 1).transpose();
    WriteMatrix(values, writer);
  }
}

// The whitener is lower triangular, and the file holds only that half, row by row. The square is
// twice the bytes that were checked to be there, hence the second limit.
absl::Status ReadWhitener(ByteReader* reader, uint64_t num_rows, uint64_t max_unfolded_bytes,
                          Eigen::MatrixXf* whitener) {
  PLEAT_RETURN_IF_ERROR(reader->Require(num_rows * (num_rows + 1) / 2, sizeof(float), "whitener"));
  if (num_rows * num_rows * sizeof(float) > max_unfolded_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("a Gaussian process of ", num_rows,
                                                     " rows needs more than the limit of ",
                                                     max_unfolded_bytes, " bytes"));
  }
  const auto size = static_cast<Eigen::Index>(num_rows);
  whitener->setZero(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    // A new one each time: when memory ends, Eigen frees what a resized matrix held a second time.
    Eigen::VectorXf values;
    PLEAT_RETURN_IF_ERROR(
        ReadMatrix(reader, static_cast<uint64_t>(row) + 1, 1, "whitener", &values));
    whitener->row(row).head(row + 1) = values.transpose();
  }
  return absl::OkStatus();
}

absl::StatusOr<GpRegressionParameters> ReadStage(ByteReader* reader, uint32_t version,
                                                 uint64_t max_unfolded_bytes) {
  GpRegressionParameters stage;
  PLEAT_ASSIGN_OR_RETURN(const uint32_t flags, reader->Read<uint32_t>("stage flags"));
  if (flags > (kHasBias | kHasLinear)) {
    return absl::InvalidArgumentError(absl::StrCat("unknown stage flags ", flags));
  }
  stage.kernel_options.bias = (flags & kHasBias) != 0;
  stage.kernel_options.linear = (flags & kHasLinear) != 0;
  std::array<double, 7> numbers;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<double>(numbers), "kernel"));
  stage.kernel_options.relative_noise_floor = numbers[0];
  stage.kernel_options.absolute_jitter = numbers[1];
  stage.kernel = {numbers[2], numbers[3], numbers[4], numbers[5], numbers[6]};
  std::array<uint32_t, 3> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "stage sizes"));
  const auto [num_rows, num_inputs, num_outputs] = counts;
  if (num_rows == 0 || num_inputs == 0) {
    return absl::InvalidArgumentError("a Gaussian process without rows or inputs");
  }
  double old_scale = 1;
  PLEAT_RETURN_IF_ERROR(ReadOldInputScale(reader, version, &old_scale));
  PLEAT_ASSIGN_OR_RETURN(stage.output_scale, reader->Read<double>("output scale"));
  PLEAT_RETURN_IF_ERROR(ReadMeanAndScales(reader, version, num_inputs, old_scale, &stage.input_mean,
                                          &stage.input_scales));
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_rows, num_inputs, "inputs", &stage.inputs));
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_outputs, 1, "output mean", &stage.output_mean));
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_rows, num_outputs, "alpha", &stage.alpha));
  PLEAT_RETURN_IF_ERROR(ReadWhitener(reader, num_rows, max_unfolded_bytes, &stage.whitener));
  return stage;
}

void WriteBasis(const DetailBasisParameters& basis, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(basis.mean.size()));
  writer->Write(static_cast<uint32_t>(basis.num_components));
  writer->Write(static_cast<uint32_t>(basis.components.size()));
  WriteMatrix(basis.mean, writer);
  WritePlanes(basis, writer);
}

absl::StatusOr<DetailBasisParameters> ReadBasis(ByteReader* reader) {
  DetailBasisParameters basis;
  std::array<uint32_t, 3> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "sizes of the basis"));
  const auto [num_details, num_components, num_planes] = counts;
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_details, 1, "mean detail", &basis.mean));
  PLEAT_RETURN_IF_ERROR(
      ReadPlanes(reader, num_details, num_components, num_planes, "planes of the basis", &basis));
  return basis;
}

// Reads the basis of version 1, which was not quantized. A largest step of 0 asks for as many
// planes as a component can have.
absl::StatusOr<DetailBasisParameters> ReadFloatBasis(ByteReader* reader) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_details, reader->Read<uint32_t>("detail size"));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_components, reader->Read<uint32_t>("component count"));
  Eigen::VectorXf mean;
  Eigen::MatrixXf basis;
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_details, 1, "mean detail", &mean));
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_details, num_components, "detail basis", &basis));
  PLEAT_ASSIGN_OR_RETURN(
      const DetailBasis rounded,
      DetailBasis::Quantize(mean, basis.cast<double>(), Eigen::VectorXd::Zero(num_components)));
  return rounded.parameters();
}

void WriteNumbers(const std::vector<int>& numbers, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(numbers.size()));
  writer->WriteArray(std::span<const int>(numbers));
}

absl::Status ReadNumbers(ByteReader* reader, absl::string_view what, std::vector<int>* numbers) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t count, reader->Read<uint32_t>(what));
  return ReadVector(reader, count, what, numbers);
}

void WriteParts(const PartedBasisParameters& basis, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(basis.num_coefficients));
  writer->Write(static_cast<uint32_t>(basis.parts.size()));
  for (const PartedBasisParameters::Part& part : basis.parts) {
    WriteNumbers(part.vertices, writer);
    WriteNumbers(part.coefficients, writer);
    WriteBasis(part.basis, writer);
  }
}

absl::StatusOr<PartedBasisParameters> ReadParts(ByteReader* reader) {
  PartedBasisParameters basis;
  std::array<uint32_t, 2> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "parts of the basis"));
  if (counts[0] > kMaxCoefficients) {
    return absl::InvalidArgumentError(
        absl::StrCat(counts[0], " coefficients, the limit is ", kMaxCoefficients));
  }
  basis.num_coefficients = static_cast<int>(counts[0]);
  constexpr uint64_t kMinPartBytes = 5 * sizeof(uint32_t);
  PLEAT_RETURN_IF_ERROR(reader->Require(counts[1], kMinPartBytes, "parts of the basis"));
  for (uint32_t i = 0; i < counts[1]; ++i) {
    PartedBasisParameters::Part part;
    PLEAT_RETURN_IF_ERROR(ReadNumbers(reader, "vertices of a part", &part.vertices));
    PLEAT_RETURN_IF_ERROR(ReadNumbers(reader, "coefficients of a part", &part.coefficients));
    PLEAT_ASSIGN_OR_RETURN(part.basis, ReadBasis(reader));
    basis.parts.push_back(std::move(part));
  }
  return basis;
}

absl::StatusOr<PartedBasisParameters> ReadAnyBasis(ByteReader* reader, uint32_t version) {
  if (version >= kFirstWithParts) return ReadParts(reader);
  PLEAT_ASSIGN_OR_RETURN(DetailBasisParameters basis,
                         version == 1 ? ReadFloatBasis(reader) : ReadBasis(reader));
  return PartedBasisParameters::Whole(std::move(basis));
}

absl::StatusOr<Learner> LearnerFromName(const std::string& name) {
  for (const Learner learner : kAllLearners) {
    if (LearnerName(learner) == name) return learner;
  }
  return absl::InvalidArgumentError(absl::StrCat("unknown learner '", name, "'"));
}

}  // namespace

void WriteDetail(const DetailModelParameters& parameters, ByteWriter* writer) {
  writer->WriteString(LearnerName(parameters.learner));
  writer->Write(parameters.fade_confidence);
  WriteParts(parameters.basis, writer);
  writer->Write(static_cast<uint32_t>(parameters.stages.size()));
  for (const GpRegressionParameters& stage : parameters.stages) WriteStage(stage, writer);
  if (parameters.regional) {
    writer->Write(parameters.regional_share);
    WriteRegional(*parameters.regional, writer);
    WriteFold(parameters.fold, writer);
  }
}

absl::StatusOr<DetailModelParameters> ReadDetail(ByteReader* reader, uint32_t version,
                                                 uint64_t max_unfolded_bytes) {
  DetailModelParameters parameters;
  PLEAT_ASSIGN_OR_RETURN(const std::string learner, reader->ReadString(64, "learner"));
  PLEAT_ASSIGN_OR_RETURN(parameters.learner, LearnerFromName(learner));
  PLEAT_ASSIGN_OR_RETURN(parameters.fade_confidence, reader->Read<double>("fade confidence"));
  PLEAT_ASSIGN_OR_RETURN(parameters.basis, ReadAnyBasis(reader, version));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_stages, reader->Read<uint32_t>("stage count"));
  if (num_stages == 0 || num_stages > kMaxStages) {
    return absl::InvalidArgumentError(
        absl::StrCat(num_stages, " stages of the detail model, expected 1 or 2"));
  }
  for (uint32_t s = 0; s < num_stages; ++s) {
    PLEAT_ASSIGN_OR_RETURN(GpRegressionParameters stage,
                           ReadStage(reader, version, max_unfolded_bytes));
    parameters.stages.push_back(std::move(stage));
  }
  if (parameters.learner == Learner::kRegional) {
    PLEAT_ASSIGN_OR_RETURN(parameters.regional_share, reader->Read<double>("share of the regions"));
    PLEAT_ASSIGN_OR_RETURN(parameters.regional, ReadRegional(reader, version));
    if (version >= kFirstWithParts) {
      PLEAT_ASSIGN_OR_RETURN(parameters.fold, ReadFold(reader, version));
    }
  }
  return parameters;
}

}  // namespace pleat
