// Arrays and matrices in binary files. Sizes are checked before memory is taken.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "pleat/base/bytes.h"
#include "pleat/base/status.h"

namespace pleat {

template <typename T>
absl::Status ReadVector(ByteReader* reader, uint64_t count, absl::string_view what,
                        std::vector<T>* values) {
  PLEAT_RETURN_IF_ERROR(reader->Require(count, sizeof(T), what));
  values->resize(count);
  return reader->ReadArray(std::span(*values), what);
}

// Column after column. rows, columns < 2^32.
template <typename Matrix>
absl::Status ReadMatrix(ByteReader* reader, uint64_t rows, uint64_t columns, absl::string_view what,
                        Matrix* matrix) {
  using Value = typename Matrix::Scalar;
  PLEAT_RETURN_IF_ERROR(reader->Require(rows * columns, sizeof(Value), what));
  matrix->resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  return reader->ReadArray(std::span(matrix->data(), static_cast<size_t>(matrix->size())), what);
}

template <typename Matrix>
void WriteMatrix(const Matrix& matrix, ByteWriter* writer) {
  using Value = typename Matrix::Scalar;
  writer->WriteArray(std::span<const Value>(matrix.data(), static_cast<size_t>(matrix.size())));
}

}  // namespace pleat
