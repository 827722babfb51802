// A kDracoDelta stream, from the encoder's side. Every frame is snapped to integers on the grid
// first, and all that follows is exact on them:
//
//   key frame    all positions, moved onto the grid, as a Draco point cloud. Draco quantizes on the
//                same grid and finds the same integers again, so a reader needs no frame before it.
//   difference   what the DeltaPredictor leaves of the movement since the last frame, as three
//                int32 attributes. It means something only to a reader that has the last frame.
//
// `last` is the frame that a reader has, if all went well. It is replaced when a frame has been
// encoded, and not when encoding fails, since the caller sends nothing then. Whether the bytes
// arrive is unknown here. A reader that has missed a frame notices by the checksum in the mark and
// asks for a key frame; RequestKeyframe then makes the next frame independent of `last`.
//
// Most differences are a quarter of a key frame. After a cut they can be larger, so a difference of
// more than 7/8 of the last key frame is compared with a new key frame, and the smaller is sent.
// The threshold saves encoding each frame twice.
#include "pleat/stream/frame_encoder.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "delta_predictor.h"
#include "draco/compression/decode.h"
#include "draco_encode.h"
#include "pleat/base/status.h"
#include "pleat/stream/frame_decoder.h"
#include "residual_writer.h"

namespace pleat {
namespace {

QuantizationBox MakeBox(const Eigen::Ref<const Eigen::Matrix3Xf>& reference,
                        const FrameEncoderOptions& options) {
  QuantizationBox box;
  box.bits = options.position_bits;
  const Eigen::Vector3f low = reference.rowwise().minCoeff();
  const Eigen::Vector3f high = reference.rowwise().maxCoeff();
  const float edge = static_cast<float>((high - low).maxCoeff() * options.box_margin);
  box.range_m = std::max(edge, 1e-6f);
  if (options.max_error_mm > 0) {
    // A vertex is off by at most half the diagonal of a grid cell, sqrt(3)/2 steps. The last factor
    // leaves room for the rounding of float32.
    const double step_m = options.max_error_mm * 1e-3 * 2 / std::sqrt(3.0) * (1 - 1e-4);
    box.bits = QuantizationBox::kMinBits;
    while (box.bits <= QuantizationBox::kMaxBits && step_m * ((1 << box.bits) - 1) < box.range_m) {
      ++box.bits;  // may end one above kMaxBits, which Validate refuses
    }
    box.range_m = static_cast<float>(step_m * ((1 << box.bits) - 1));
  }
  box.origin_m = (low + high) / 2 - Eigen::Vector3f::Constant(box.range_m / 2);
  return box;
}

absl::Status CheckPositions(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                            const QuantizationBox& box) {
  const Eigen::Array3f center = box.origin_m.array() + box.range_m / 2;
  const float limit = box.range_m * (0.5f + QuantizationBox::kMaxEdgesOutside);
  // The common case, that all is well, is decided without branches. A coordinate that is not finite
  // does not count as inside.
  int num_inside = 0;
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    const float* position = &positions.coeffRef(0, v);
    for (int c = 0; c < 3; ++c) num_inside += std::fabs(position[c] - center[c]) <= limit;
  }
  if (num_inside == positions.size()) return absl::OkStatus();
  for (int v = 0; v < positions.cols(); ++v) {
    if (!positions.col(v).allFinite()) {
      return absl::InvalidArgumentError(
          absl::StrCat("cannot encode the frame: vertex ", v, " is not finite"));
    }
    if (((positions.col(v).array() - center).abs() > limit).any()) {
      return absl::OutOfRangeError(absl::StrCat(
          "cannot encode the frame: vertex ", v, " is more than ", limit,
          " m from the center of the session's box; start a session nearer to the character"));
    }
  }
  return absl::OkStatus();
}

// What Draco has made of the topology mesh.
struct DecodedOrder {
  std::vector<int32_t> point_vertices;  // the vertex of every point
  int num_triangles = 0;
};

// Decodes bytes that this process has just encoded; no guard is needed.
absl::StatusOr<DecodedOrder> ReadBack(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) {
    return absl::InternalError(
        absl::StrCat("Draco cannot read its own mesh: ", mesh.status().error_msg_string()));
  }
  const draco::PointAttribute* ids =
      mesh.value()->GetNamedAttribute(draco::GeometryAttribute::GENERIC);
  DecodedOrder order;
  order.num_triangles = static_cast<int>(mesh.value()->num_faces());
  order.point_vertices.resize(mesh.value()->num_points());
  for (uint32_t p = 0; p < mesh.value()->num_points(); ++p) {
    ids->GetValue(ids->mapped_index(draco::PointIndex(p)), &order.point_vertices[p]);
  }
  return order;
}

// Returns the vertices in the order of their first points, then those without a point. `num_shown`
// is the number of vertices that have one.
std::vector<int32_t> FirstAppearance(const std::vector<int32_t>& point_vertices, int num_vertices,
                                     int* num_shown) {
  std::vector<int32_t> order;
  std::vector<bool> seen(num_vertices, false);
  for (const int32_t v : point_vertices) {
    if (!seen[v]) order.push_back(v);
    seen[v] = true;
  }
  *num_shown = static_cast<int>(order.size());
  for (int32_t v = 0; v < num_vertices; ++v) {
    if (!seen[v]) order.push_back(v);
  }
  return order;
}

absl::Status CheckOptions(const FrameEncoderOptions& options) {
  if (options.speed < 0 || options.speed > 10) {
    return absl::InvalidArgumentError(
        absl::StrCat("speed is ", options.speed, ", allowed are 0 to 10"));
  }
  if (!(options.box_margin >= 1 && options.box_margin <= 100)) {
    return absl::InvalidArgumentError(
        absl::StrCat("box_margin is ", options.box_margin, ", allowed are 1 to 100"));
  }
  if (options.max_error_mm != 0 && !(options.max_error_mm >= 1e-3 && options.max_error_mm <= 1e6)) {
    return absl::InvalidArgumentError(absl::StrCat("max_error_mm is ", options.max_error_mm,
                                                   ", allowed are 0 (not used) and 1e-3 to 1e6"));
  }
  return absl::OkStatus();
}

}  // namespace

struct FrameEncoder::State {
  StreamHeader header;
  MeshMethod method = MeshMethod::kEdgebreaker;
  int speed = 5;
  std::unique_ptr<draco::Mesh> mesh;         // kept for kDracoMesh only
  std::unique_ptr<draco::PointCloud> cloud;  // for point clouds and key frames
  FrameMark mark;

  // The rest serves kDracoDelta streams.
  std::optional<DeltaPredictor> predictor;
  ResidualWriter writer;
  std::unique_ptr<draco::PointCloud> residual_cloud;  // for residuals that `writer` refuses
  Eigen::Matrix3Xi last, now, movement, residuals;    // 3 x V, in grid steps
  bool has_last = false;                              // false: a key frame must come next
  Eigen::Matrix3Xf placed;                            // 3 x V, meters: `now` for a key frame
  std::string key;  // the key frame encoded last, even if a smaller difference was sent instead

  // Encodes the mesh with `method` and fills in the header. Returns false when a vertex was lost.
  absl::StatusOr<bool> TryTopology() {
    PLEAT_RETURN_IF_ERROR(EncodeDracoMesh(*mesh, header.box, method, speed, &header.topology));
    PLEAT_ASSIGN_OR_RETURN(const DecodedOrder decoded, ReadBack(header.topology));
    header.num_points = static_cast<int>(decoded.point_vertices.size());
    header.num_triangles = decoded.num_triangles;
    int num_shown = 0;
    header.vertex_order = FirstAppearance(decoded.point_vertices, header.num_vertices, &num_shown);
    return num_shown == header.num_vertices;
  }

  absl::Status EncodeKeyframe() {
    PlaceOnGrid(now, header.box, &placed);
    SetDracoPositions(placed, header.vertex_order, cloud.get());
    return EncodeDracoPointCloud(*cloud, header.box, speed, &key);
  }

  // Allocates what differences need, so that the first one finds it.
  void ReserveDeltas() {
    for (Eigen::Matrix3Xi* matrix : {&last, &now, &movement, &residuals}) {
      matrix->resize(3, header.num_vertices);
    }
    writer.Reserve(header.num_vertices);
  }

  // Makes room for every frame of the session: the coordinates as plain bits, five of them for
  // positions outside of the box. What is larger than a key frame is not sent. The room is the same
  // for every frame, because a caller gives several strings in turn, and each would have to grow
  // after a key frame that is larger than those before.
  void Reserve(std::string* bytes) const {
    constexpr size_t kOverhead = 1024;  // headers, tables of frequencies
    const auto bits = static_cast<size_t>(3 * (header.box.bits + 5));
    bytes->reserve(static_cast<size_t>(header.num_vertices) * bits / 8 + kOverhead);
  }

  absl::Status EncodeDelta(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                           std::string* bytes) {
    SnapToGrid(positions, header.box, &now);
    mark.checksum = GridChecksum(now);
    mark.keyframe = !has_last;
    if (!mark.keyframe) {
      Reserve(bytes);
      predictor->Residuals(last, now, &movement, &residuals);
      if (!writer.Write(residuals, bytes)) {
        SetDracoResiduals(residuals, residual_cloud.get());
        PLEAT_RETURN_IF_ERROR(EncodeDracoResiduals(*residual_cloud, speed, bytes));
      }
    }
    if (mark.keyframe || bytes->size() > key.size() - key.size() / 8) {
      PLEAT_RETURN_IF_ERROR(EncodeKeyframe());
      if (mark.keyframe || key.size() <= bytes->size()) {
        mark.keyframe = true;
        Reserve(bytes);
        bytes->assign(key);
      }
    }
    last.swap(now);
    has_last = true;
    return absl::OkStatus();
  }

  // Encodes the reference frame by edgebreaker, or sequentially where edgebreaker loses a vertex:
  // it drops those that belong to no triangle.
  absl::Status MakeTopology(const Eigen::Ref<const Eigen::Matrix3Xf>& reference) {
    SetDracoPositions(reference, {}, mesh.get());
    method = MeshMethod::kEdgebreaker;
    if (TryTopology().value_or(false)) return absl::OkStatus();
    method = MeshMethod::kSequential;
    return TryTopology().status();
  }
};

FrameEncoder::FrameEncoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
FrameEncoder::~FrameEncoder() = default;
FrameEncoder::FrameEncoder(FrameEncoder&&) noexcept = default;
FrameEncoder& FrameEncoder::operator=(FrameEncoder&&) noexcept = default;

const StreamHeader& FrameEncoder::header() const { return state_->header; }
const FrameMark& FrameEncoder::mark() const { return state_->mark; }
void FrameEncoder::RequestKeyframe() { state_->has_last = false; }

absl::StatusOr<FrameEncoder> FrameEncoder::Create(
    const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& reference,
    const FrameEncoderOptions& options, std::vector<int32_t> control_vertices) {
  PLEAT_RETURN_IF_ERROR(CheckOptions(options));
  if (options.content == StreamContent::kParameters) {
    return absl::InvalidArgumentError("a stream of parameters holds no frames to encode");
  }
  if (reference.cols() != topology.num_vertices() || reference.cols() == 0) {
    return absl::InvalidArgumentError(absl::StrCat("the reference frame has ", reference.cols(),
                                                   " vertices, the topology ",
                                                   topology.num_vertices()));
  }
  if (topology.num_triangles() == 0) {
    return absl::InvalidArgumentError("a character without triangles cannot be streamed");
  }
  auto state = std::make_unique<State>();
  state->speed = options.speed;
  StreamHeader& header = state->header;
  header.encoding = options.encoding;
  header.content = options.content;
  header.control_vertices = std::move(control_vertices);
  header.num_vertices = topology.num_vertices();
  header.box = MakeBox(reference, options);
  PLEAT_RETURN_IF_ERROR(CheckPositions(reference, header.box));
  PLEAT_RETURN_IF_ERROR(header.box.Validate());

  state->mesh = MakeDracoMesh(topology.num_vertices(), topology.triangles());
  PLEAT_RETURN_IF_ERROR(state->MakeTopology(reference));
  if (options.encoding != FrameEncoding::kDracoMesh) {
    state->mesh.reset();
    state->cloud = MakeDracoPointCloud(header.num_vertices);
  }
  if (options.encoding == FrameEncoding::kDracoDelta) {
    // The predictor is built from what a decoder sees. Its mesh may lack degenerate triangles, and
    // its reference frame has been quantized.
    PLEAT_ASSIGN_OR_RETURN(const FrameDecoder view, FrameDecoder::Create(header));
    state->predictor.emplace(view.topology(), view.reference(), header.box);
    state->residual_cloud = MakeDracoResidualCloud(header.num_vertices);
    state->ReserveDeltas();
  }
  return FrameEncoder(std::move(state));
}

absl::Status FrameEncoder::Encode(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                                  std::string* bytes) {
  const StreamHeader& header = state_->header;
  if (positions.cols() != header.num_vertices) {
    return absl::InvalidArgumentError(absl::StrCat("the frame has ", positions.cols(),
                                                   " vertices, the session ", header.num_vertices));
  }
  PLEAT_RETURN_IF_ERROR(CheckPositions(positions, header.box));
  if (header.encoding == FrameEncoding::kDracoDelta) return state_->EncodeDelta(positions, bytes);
  if (header.encoding == FrameEncoding::kDracoPointCloud) {
    SetDracoPositions(positions, header.vertex_order, state_->cloud.get());
    return EncodeDracoPointCloud(*state_->cloud, header.box, state_->speed, bytes);
  }
  SetDracoPositions(positions, {}, state_->mesh.get());
  return EncodeDracoMesh(*state_->mesh, header.box, state_->method, state_->speed, bytes);
}

absl::StatusOr<std::string> FrameEncoder::Encode(
    const Eigen::Ref<const Eigen::Matrix3Xf>& positions) {
  std::string bytes;
  PLEAT_RETURN_IF_ERROR(Encode(positions, &bytes));
  return bytes;
}

}  // namespace pleat
