#include "regional_section.h"

#include <array>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "model_versions.h"
#include "planes_section.h"
#include "pleat/base/status.h"
#include "pleat/math/array_io.h"

namespace pleat {
namespace {

// Writes a matrix as floats where they say it exactly, after a flag: 1 for floats, 0 for doubles.
void WriteAsFloats(const Eigen::MatrixXd& matrix, ByteWriter* writer) {
  const Eigen::MatrixXf floats = matrix.cast<float>();
  const bool exact = floats.cast<double>() == matrix;
  writer->Write(static_cast<uint32_t>(exact));
  exact ? WriteMatrix(floats, writer) : WriteMatrix(matrix, writer);
}

absl::Status ReadFloatsOrDoubles(ByteReader* reader, uint64_t rows, uint64_t columns,
                                 absl::string_view what, Eigen::MatrixXd* matrix) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t are_floats, reader->Read<uint32_t>(what));
  if (are_floats > 1) {
    return absl::InvalidArgumentError(absl::StrCat("unknown flag of the ", what));
  }
  if (are_floats == 0) return ReadMatrix(reader, rows, columns, what, matrix);
  Eigen::MatrixXf floats;
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, rows, columns, what, &floats));
  *matrix = floats.cast<double>();
  return absl::OkStatus();
}

absl::StatusOr<RegionalGpParameters::Scale> ReadScale(ByteReader* reader, uint32_t version) {
  RegionalGpParameters::Scale scale;
  std::array<double, 4> numbers;
  numbers[3] = scale.max_norm;
  const size_t count = version >= kFirstWithParts ? 4 : 3;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<double>(numbers).first(count), "scale"));
  scale.inverse_width = numbers[0];
  scale.amplitude = numbers[1];
  scale.linear = numbers[2];
  scale.max_norm = numbers[3];
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_columns, reader->Read<uint32_t>("column count"));
  std::vector<int32_t> columns;
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_columns, "columns of a scale", &columns));
  scale.columns.assign(columns.begin(), columns.end());
  return scale;
}

absl::StatusOr<int> ReadPlace(ByteReader* reader) {
  constexpr uint32_t kMax = 1 << 30;
  PLEAT_ASSIGN_OR_RETURN(const uint32_t place, reader->Read<uint32_t>("block of the fold"));
  if (place <= kMax) return static_cast<int>(place);
  return absl::InvalidArgumentError("a block of the fold begins or ends out of range");
}

absl::StatusOr<CoefficientFoldBlock> ReadFoldBlock(ByteReader* reader) {
  CoefficientFoldBlock block;
  PLEAT_ASSIGN_OR_RETURN(block.first_input, ReadPlace(reader));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_targets, reader->Read<uint32_t>("block of the fold"));
  PLEAT_RETURN_IF_ERROR(reader->Require(num_targets, 2 * sizeof(uint32_t), "targets of the fold"));
  uint64_t num_outputs = 0;
  for (uint32_t t = 0; t < num_targets; ++t) {
    CoefficientFoldBlock::Target target;
    PLEAT_ASSIGN_OR_RETURN(target.first_output, ReadPlace(reader));
    PLEAT_ASSIGN_OR_RETURN(target.count, ReadPlace(reader));
    num_outputs += static_cast<uint64_t>(target.count);
    block.targets.push_back(target);
  }
  if (num_outputs > kMaxCoefficients) {
    return absl::InvalidArgumentError(absl::StrCat("a block of the fold has ", num_outputs,
                                                   " outputs, the limit is ", kMaxCoefficients));
  }
  PLEAT_ASSIGN_OR_RETURN(block.weights,
                         ReadPlaneMatrix(reader, num_outputs, "weights of the fold"));
  return block;
}

// Reads the block of one region and one part, inputs x outputs, and rounds it as finely as planes
// allow.
absl::StatusOr<CoefficientFoldBlock> ReadFoldBlockOfFloats(ByteReader* reader) {
  PLEAT_ASSIGN_OR_RETURN(const int first_input, ReadPlace(reader));
  PLEAT_ASSIGN_OR_RETURN(const int first_output, ReadPlace(reader));
  std::array<uint32_t, 2> sizes;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(sizes), "block of the fold"));
  CoefficientFoldBlock block{first_input, {{first_output, static_cast<int>(sizes[1])}}, {}};
  PLEAT_ASSIGN_OR_RETURN(block.weights,
                         ReadFloatsAsPlanes(reader, sizes[0], sizes[1], "block of the fold"));
  return block;
}

}  // namespace

absl::Status ReadOldInputScale(ByteReader* reader, uint32_t version, double* scale) {
  if (version >= kFirstWithInputScales) return absl::OkStatus();
  PLEAT_ASSIGN_OR_RETURN(*scale, reader->Read<double>("input scale"));
  return absl::OkStatus();
}

absl::Status ReadMeanAndScales(ByteReader* reader, uint32_t version, uint32_t num_inputs,
                               double old_scale, Eigen::VectorXd* mean, Eigen::VectorXd* scales) {
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_inputs, 1, "input mean", mean));
  if (version >= kFirstWithInputScales) {
    return ReadMatrix(reader, num_inputs, 1, "input scales", scales);
  }
  scales->setConstant(num_inputs, old_scale);
  return absl::OkStatus();
}

void WriteRegional(const RegionalGpParameters& regional, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(regional.inputs.rows()));
  writer->Write(static_cast<uint32_t>(regional.inputs.cols()));
  writer->Write(static_cast<uint32_t>(regional.output_mean.size()));
  writer->Write(static_cast<uint32_t>(regional.regions.size()));
  WriteMatrix(regional.input_mean, writer);
  WriteMatrix(regional.input_scales, writer);
  WriteAsFloats(regional.inputs, writer);
  WriteMatrix(regional.output_mean, writer);
  for (const RegionalGpParameters::Region& region : regional.regions) {
    writer->Write(static_cast<uint32_t>(region.first_output));
    writer->Write(static_cast<uint32_t>(region.alpha.cols()));
    writer->Write(region.bias);
    writer->Write(static_cast<uint32_t>(region.scales.size()));
    for (const RegionalGpParameters::Scale& scale : region.scales) {
      const std::array<double, 4> numbers = {scale.inverse_width, scale.amplitude, scale.linear,
                                             scale.max_norm};
      writer->WriteArray(std::span<const double>(numbers));
      const std::vector<int32_t> columns(scale.columns.begin(), scale.columns.end());
      writer->Write(static_cast<uint32_t>(columns.size()));
      writer->WriteArray(std::span<const int32_t>(columns));
    }
    WriteMatrix(region.alpha, writer);
  }
}

absl::StatusOr<RegionalGpParameters> ReadRegional(ByteReader* reader, uint32_t version) {
  RegionalGpParameters regional;
  std::array<uint32_t, 4> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "sizes of the regions"));
  const auto [num_rows, num_inputs, num_outputs, num_regions] = counts;
  double old_scale = 1;
  PLEAT_RETURN_IF_ERROR(ReadOldInputScale(reader, version, &old_scale));
  PLEAT_RETURN_IF_ERROR(ReadMeanAndScales(reader, version, num_inputs, old_scale,
                                          &regional.input_mean, &regional.input_scales));
  PLEAT_RETURN_IF_ERROR(
      version >= kFirstWithParts
          ? ReadFloatsOrDoubles(reader, num_rows, num_inputs, "inputs", &regional.inputs)
          : ReadMatrix(reader, num_rows, num_inputs, "inputs", &regional.inputs));
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_outputs, 1, "output mean", &regional.output_mean));
  for (uint32_t r = 0; r < num_regions; ++r) {
    RegionalGpParameters::Region region;
    std::array<uint32_t, 2> outputs = {0, num_outputs};
    if (version >= kFirstWithParts) {
      PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(outputs), "outputs of a region"));
    }
    if (outputs[0] > num_outputs || outputs[1] > num_outputs - outputs[0]) {
      return absl::InvalidArgumentError(absl::StrCat("a region has ", outputs[1], " outputs from ",
                                                     outputs[0], " on, of ", num_outputs));
    }
    region.first_output = static_cast<int>(outputs[0]);
    PLEAT_ASSIGN_OR_RETURN(region.bias, reader->Read<double>("bias of a region"));
    PLEAT_ASSIGN_OR_RETURN(const uint32_t num_scales, reader->Read<uint32_t>("scale count"));
    for (uint32_t s = 0; s < num_scales; ++s) {
      PLEAT_ASSIGN_OR_RETURN(RegionalGpParameters::Scale scale, ReadScale(reader, version));
      region.scales.push_back(std::move(scale));
    }
    PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_rows, outputs[1], "alpha", &region.alpha));
    regional.regions.push_back(std::move(region));
  }
  return regional;
}

void WriteFold(const std::vector<CoefficientFoldBlock>& fold, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(fold.size()));
  for (const CoefficientFoldBlock& block : fold) {
    writer->Write(static_cast<uint32_t>(block.first_input));
    writer->Write(static_cast<uint32_t>(block.targets.size()));
    for (const CoefficientFoldBlock::Target& target : block.targets) {
      writer->Write(static_cast<uint32_t>(target.first_output));
      writer->Write(static_cast<uint32_t>(target.count));
    }
    WritePlaneMatrix(block.weights, writer);
  }
}

absl::StatusOr<std::vector<CoefficientFoldBlock>> ReadFold(ByteReader* reader, uint32_t version) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t count, reader->Read<uint32_t>("blocks of the fold"));
  PLEAT_RETURN_IF_ERROR(reader->Require(count, 4 * sizeof(uint32_t), "blocks of the fold"));
  std::vector<CoefficientFoldBlock> fold;
  fold.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    PLEAT_ASSIGN_OR_RETURN(CoefficientFoldBlock block, version >= kFirstWithPlanes
                                                           ? ReadFoldBlock(reader)
                                                           : ReadFoldBlockOfFloats(reader));
    fold.push_back(std::move(block));
  }
  return fold;
}

}  // namespace pleat
