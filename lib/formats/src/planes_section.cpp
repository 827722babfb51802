#include "planes_section.h"

#include <array>
#include <span>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/math/array_io.h"

namespace pleat {

void WritePlanes(const DetailBasisParameters& planes, ByteWriter* writer) {
  for (size_t p = 0; p < planes.components.size(); ++p) {
    writer->Write(static_cast<uint32_t>(planes.components[p]));
    writer->Write(planes.scales[p]);
  }
  WriteMatrix(planes.values, writer);
}

absl::Status ReadPlanes(ByteReader* reader, uint64_t num_rows, uint32_t num_components,
                        uint32_t num_planes, absl::string_view what,
                        DetailBasisParameters* planes) {
  constexpr uint32_t kMaxComponents = 1 << 24;
  if (num_components > kMaxComponents) {
    return absl::InvalidArgumentError(absl::StrCat(num_components, " components of the ", what,
                                                   ", the limit is ", kMaxComponents));
  }
  planes->num_components = static_cast<int>(num_components);
  PLEAT_RETURN_IF_ERROR(reader->Require(num_planes, sizeof(uint32_t) + sizeof(float), what));
  for (uint32_t p = 0; p < num_planes; ++p) {
    PLEAT_ASSIGN_OR_RETURN(const uint32_t component, reader->Read<uint32_t>(what));
    if (component >= num_components) {
      return absl::InvalidArgumentError(absl::StrCat("plane ", p, " of the ", what,
                                                     " belongs to component ", component, " of ",
                                                     num_components));
    }
    planes->components.push_back(static_cast<int>(component));
    PLEAT_ASSIGN_OR_RETURN(const float scale, reader->Read<float>(what));
    planes->scales.push_back(scale);
  }
  return ReadMatrix(reader, num_rows, num_planes, what, &planes->values);
}

void WritePlaneMatrix(const DetailBasisParameters& matrix, ByteWriter* writer) {
  writer->Write(static_cast<uint32_t>(matrix.num_components));
  writer->Write(static_cast<uint32_t>(matrix.components.size()));
  WritePlanes(matrix, writer);
}

absl::StatusOr<DetailBasisParameters> ReadPlaneMatrix(ByteReader* reader, uint64_t num_rows,
                                                      absl::string_view what) {
  DetailBasisParameters matrix;
  std::array<uint32_t, 2> counts;
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), what));
  PLEAT_RETURN_IF_ERROR(ReadPlanes(reader, num_rows, counts[0], counts[1], what, &matrix));
  matrix.mean = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(num_rows));
  return matrix;
}

absl::StatusOr<DetailBasisParameters> ReadFloatsAsPlanes(ByteReader* reader, uint64_t num_columns,
                                                         uint64_t num_rows,
                                                         absl::string_view what) {
  Eigen::MatrixXf transposed;
  PLEAT_RETURN_IF_ERROR(ReadMatrix(reader, num_columns, num_rows, what, &transposed));
  if (transposed.size() == 0) return DetailBasisParameters();
  PLEAT_ASSIGN_OR_RETURN(const DetailBasis rounded,
                         DetailBasis::Quantize(Eigen::VectorXf::Zero(transposed.cols()),
                                               transposed.cast<double>().transpose(),
                                               Eigen::VectorXd::Zero(transposed.rows())));
  return rounded.parameters();
}

}  // namespace pleat
