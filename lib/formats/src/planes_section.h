// Matrices in planes of 8-bit integers, as several sections of the model file have them.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "pleat/base/bytes.h"
#include "pleat/learner/detail_basis.h"

namespace pleat {

// The component and the scale of each plane, and the values. Their counts and the mean are the
// business of the section.
void WritePlanes(const DetailBasisParameters& planes, ByteWriter* writer);

// Reads them for num_rows rows, num_components components and num_planes planes.
absl::Status ReadPlanes(ByteReader* reader, uint64_t num_rows, uint32_t num_components,
                        uint32_t num_planes, absl::string_view what, DetailBasisParameters* planes);

// Writes a matrix without a mean, with the counts of its components and planes in front.
void WritePlaneMatrix(const DetailBasisParameters& matrix, ByteWriter* writer);

// Reads one of num_rows rows, which the caller has limited, since a matrix of zeros has no planes
// that would take bytes of the file. Its mean is zero.
absl::StatusOr<DetailBasisParameters> ReadPlaneMatrix(ByteReader* reader, uint64_t num_rows,
                                                      absl::string_view what);

// Reads what files before version 5 have instead: the transpose, num_columns x num_rows float32,
// which is rounded to as many planes as a component can have.
absl::StatusOr<DetailBasisParameters> ReadFloatsAsPlanes(ByteReader* reader, uint64_t num_columns,
                                                         uint64_t num_rows, absl::string_view what);

}  // namespace pleat
