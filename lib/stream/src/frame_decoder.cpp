// How a kDracoDelta stream is decoded. A key frame holds positions that lie on the grid, from which
// the integers are computed; it needs nothing else. A difference holds residuals, which give the
// new integers together with those of the frame before. Positions are always computed from the
// integers, so a key frame and a chain of differences give the same floats.
//
// Decoding starts by taking the last frame out of last_, and only a frame whose checksum agrees
// puts one back. So there is no way to go on from a frame that is damaged or was restored from the
// wrong predecessor: when a frame was lost on its way, the next difference fails by its checksum,
// the differences after that fail because last_ is empty, and the next key frame mends the stream.
// The caller asks the sender for one.
#include "pleat/stream/frame_decoder.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "delta_predictor.h"
#include "draco_decode.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status CheckControlVertices(const StreamHeader& header) {
  const bool is_control = header.content == StreamContent::kControlMesh;
  const size_t expected = is_control ? static_cast<size_t>(header.num_vertices) : 0;
  if (header.control_vertices.size() != expected) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the stream names ", header.control_vertices.size(), " control vertices, not ", expected));
  }
  int32_t last = -1;
  for (const int32_t v : header.control_vertices) {
    if (v <= last) return absl::InvalidArgumentError("control vertices do not ascend");
    last = v;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckStreamHeader(const StreamHeader& header, const MeshLimits& limits) {
  if (header.content == StreamContent::kParameters) {
    return absl::InvalidArgumentError("a stream of parameters holds no Draco frames");
  }
  if (header.encoding != FrameEncoding::kDracoMesh &&
      header.encoding != FrameEncoding::kDracoPointCloud &&
      header.encoding != FrameEncoding::kDracoDelta) {
    return absl::InvalidArgumentError("unknown frame encoding");
  }
  if (header.num_vertices < 1 || header.num_vertices > limits.max_vertices ||
      header.num_points < header.num_vertices || header.num_points > limits.max_vertices) {
    return absl::InvalidArgumentError(absl::StrCat("the stream declares ", header.num_vertices,
                                                   " vertices and ", header.num_points,
                                                   " points, the limit is ", limits.max_vertices));
  }
  if (header.num_triangles < 1 || header.num_triangles > limits.max_faces) {
    return absl::InvalidArgumentError(absl::StrCat("the stream declares ", header.num_triangles,
                                                   " triangles, the limit is ", limits.max_faces));
  }
  PLEAT_RETURN_IF_ERROR(header.box.Validate());
  PLEAT_RETURN_IF_ERROR(CheckControlVertices(header));
  if (header.vertex_order.size() != static_cast<size_t>(header.num_vertices)) {
    return absl::InvalidArgumentError(absl::StrCat("the vertex order has ",
                                                   header.vertex_order.size(), " entries, not ",
                                                   header.num_vertices));
  }
  std::vector<bool> seen(header.num_vertices, false);
  for (const int32_t v : header.vertex_order) {
    if (v < 0 || v >= header.num_vertices || seen[v]) {
      return absl::InvalidArgumentError(
          absl::StrCat("the vertex order is no permutation: vertex ", v));
    }
    seen[v] = true;
  }
  return absl::OkStatus();
}

namespace {

// Sets column point_vertices[p] of `positions` (3 x V) to points.col(p) for every point p. Returns
// false when a vertex has no point.
bool Scatter(const Eigen::Matrix3Xf& points, const std::vector<int32_t>& point_vertices,
             int num_vertices, Eigen::Matrix3Xf* positions) {
  positions->resize(3, num_vertices);
  std::vector<bool> seen(num_vertices, false);
  int num_seen = 0;
  for (size_t p = 0; p < point_vertices.size(); ++p) {
    const int32_t v = point_vertices[p];
    positions->col(v) = points.col(p);
    num_seen += !seen[v];
    seen[v] = true;
  }
  return num_seen == num_vertices;
}

}  // namespace

FrameDecoder::FrameDecoder(StreamHeader header, Topology topology, Eigen::Matrix3Xf reference)
    : header_(std::move(header)),
      topology_(std::move(topology)),
      reference_(std::move(reference)) {}

absl::StatusOr<FrameDecoder> FrameDecoder::Create(StreamHeader header, const MeshLimits& limits) {
  PLEAT_RETURN_IF_ERROR(CheckStreamHeader(header, limits));
  Eigen::Matrix3Xf points, reference;
  std::vector<int32_t> point_vertices;
  Eigen::Matrix3Xi triangles;
  PLEAT_RETURN_IF_ERROR(DecodeDracoMesh(header.topology, header.num_points, header.num_triangles,
                                        header.num_vertices, &points, &point_vertices, &triangles));
  if (!Scatter(points, point_vertices, header.num_vertices, &reference)) {
    return absl::DataLossError("the topology of the stream does not show every vertex");
  }
  for (int& corner : triangles.reshaped()) corner = point_vertices[corner];
  PLEAT_ASSIGN_OR_RETURN(Topology topology,
                         Topology::FromTriangles(header.num_vertices, triangles));
  FrameDecoder decoder(std::move(header), std::move(topology), std::move(reference));
  if (decoder.header_.encoding == FrameEncoding::kDracoDelta) {
    decoder.predictor_ = std::make_shared<DeltaPredictor>(decoder.topology_, decoder.reference_,
                                                          decoder.header_.box);
  }
  return decoder;
}

absl::Status FrameDecoder::DecodeDelta(std::string_view bytes, const FrameMark& mark,
                                       Eigen::Matrix3Xf* positions) {
  const Eigen::Matrix3Xi last = std::move(last_);  // stays empty until this frame is right
  last_.resize(3, 0);
  if (mark.keyframe) {
    PLEAT_RETURN_IF_ERROR(DecodeDracoPointCloud(bytes, header_.num_vertices, &points_));
    positions->resize(3, header_.num_vertices);
    for (int k = 0; k < header_.num_vertices; ++k) {
      positions->col(header_.vertex_order[k]) = points_.col(k);
    }
    // SnapToGrid converts to int and needs numbers below 2^26; written so that a NaN fails.
    const float limit = static_cast<float>(header_.box.step_m() * (1 << 26));
    if (!((positions->colwise() - header_.box.origin_m).cwiseAbs().maxCoeff() < limit)) {
      return absl::DataLossError("malformed key frame: a position is out of range");
    }
    SnapToGrid(*positions, header_.box, &now_);
  } else {
    if (last.cols() != header_.num_vertices) {
      return absl::FailedPreconditionError(
          "this frame is a difference and the frame before is not known; ask for a key frame");
    }
    PLEAT_RETURN_IF_ERROR(DecodeDracoResiduals(bytes, header_.num_vertices, &residuals_));
    if (!predictor_->Restore(last, residuals_, &now_)) {
      return absl::DataLossError("malformed frame: a position is out of range");
    }
  }
  if (GridChecksum(now_) != mark.checksum) {
    return absl::DataLossError(
        "the frame is not the one that was sent: its checksum does not agree; ask for a key frame");
  }
  PlaceOnGrid(now_, header_.box, positions);
  last_.swap(now_);
  return absl::OkStatus();
}

absl::Status FrameDecoder::Decode(std::string_view bytes, const FrameMark& mark,
                                  Eigen::Matrix3Xf* positions) {
  if (header_.encoding == FrameEncoding::kDracoDelta) return DecodeDelta(bytes, mark, positions);
  if (header_.encoding == FrameEncoding::kDracoPointCloud) {
    PLEAT_RETURN_IF_ERROR(DecodeDracoPointCloud(bytes, header_.num_vertices, &points_));
    positions->resize(3, header_.num_vertices);
    for (int k = 0; k < header_.num_vertices; ++k) {
      positions->col(header_.vertex_order[k]) = points_.col(k);
    }
    return absl::OkStatus();
  }
  Eigen::Matrix3Xi triangles;
  PLEAT_RETURN_IF_ERROR(DecodeDracoMesh(bytes, header_.num_points, header_.num_triangles,
                                        header_.num_vertices, &points_, &point_vertices_,
                                        &triangles));
  if (!Scatter(points_, point_vertices_, header_.num_vertices, positions)) {
    return absl::DataLossError("malformed Draco frame: not every vertex is there");
  }
  return absl::OkStatus();
}

}  // namespace pleat
