#include "bench/pca_draco.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "draco/compression/expert_encode.h"
#include "draco/mesh/mesh.h"

namespace pleat {
namespace {

constexpr int kMaxAttributes = 100;  // Draco fails to decode more than about 128

struct Pca {
  Eigen::VectorXd mean;     // 3V
  Eigen::MatrixXd fields;   // 3V x T: components times their singular values
  Eigen::VectorXd squares;  // T, squared singular values
  double spread = 0;        // |A - E(A)|^2
};

Pca ComputeFrames(const MeshSequence& sequence) {
  const int num_frames = sequence.num_frames();
  Eigen::MatrixXd data(3 * sequence.num_vertices(), num_frames);
  for (int t = 0; t < num_frames; ++t) {
    Eigen::Matrix3Xd frame = sequence.FrameAsDouble(t);
    frame.colwise() -= Eigen::Vector3d(frame.rowwise().mean());
    data.col(t) = frame.reshaped();
  }
  Pca pca;
  pca.spread = data.squaredNorm();
  pca.mean = data.rowwise().mean();
  data.colwise() -= pca.mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(data.transpose() * data);
  pca.squares = solver.eigenvalues().reverse().cwiseMax(0);
  pca.fields = data * solver.eigenvectors().rowwise().reverse();
  return pca;
}

Eigen::MatrixXi Quantize(const Eigen::MatrixXd& values, double step) {
  return (values.array() / step).round().cast<int>();
}

// Bytes of the columns (3V each) as attributes of a Draco mesh with parallelogram prediction.
size_t DracoBytes(const Topology& topology, const Eigen::MatrixXi& columns) {
  const int num_vertices = topology.num_vertices();
  size_t num_bytes = 0;
  for (Eigen::Index begin = 0; begin < columns.cols(); begin += kMaxAttributes) {
    const Eigen::Index end = std::min<Eigen::Index>(begin + kMaxAttributes, columns.cols());
    draco::Mesh mesh;
    mesh.set_num_points(num_vertices);
    mesh.SetNumFaces(topology.num_triangles());
    for (int f = 0; f < topology.num_triangles(); ++f) {
      draco::Mesh::Face face;
      for (int i = 0; i < 3; ++i) face[i] = topology.triangles()(i, f);
      mesh.SetFace(draco::FaceIndex(f), face);
    }
    for (Eigen::Index k = begin; k < end; ++k) {
      draco::GeometryAttribute attribute;
      // Draco wants one attribute to be the position.
      attribute.Init(
          k == begin ? draco::GeometryAttribute::POSITION : draco::GeometryAttribute::GENERIC,
          nullptr, 3, draco::DT_INT32, false, 12, 0);
      const int id = mesh.AddAttribute(attribute, /*identity_mapping=*/true, num_vertices);
      for (int v = 0; v < num_vertices; ++v) {
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v),
                                              columns.col(k).data() + 3 * v);
      }
    }
    draco::ExpertEncoder encoder(mesh);
    encoder.SetSpeedOptions(0, 0);
    encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeToBuffer(&buffer).ok()) return 0;
    num_bytes += buffer.size();
  }
  return num_bytes;
}

}  // namespace

PcaDracoResult CompressWithPcaDraco(const MeshSequence& sequence, double kg_percent) {
  const Pca pca = ComputeFrames(sequence);
  const int num_frames = sequence.num_frames();
  const double allowed = pca.spread * kg_percent * kg_percent * 1e-4;
  const double root_frames = std::sqrt(static_cast<double>(num_frames));
  int fewest = 0;
  double cut = pca.squares.sum();
  while (fewest < num_frames && cut > 0.95 * allowed) cut -= pca.squares[fewest++];
  PcaDracoResult best;
  for (const double factor : {1.0, 1.15, 1.35, 1.6}) {
    const int count = std::min(num_frames, static_cast<int>(std::ceil(fewest * factor)));
    Eigen::MatrixXd columns(pca.mean.size(), count + 1);
    columns << pca.mean * root_frames, pca.fields.leftCols(count);
    const double lost = pca.squares.tail(num_frames - count).sum();
    double low = 1e-6, high = 1e2;  // the step whose rounding uses up what is left
    for (int i = 0; i < 30; ++i) {
      const double step = std::sqrt(low * high);
      const double error = (columns - Quantize(columns, step).cast<double>() * step).squaredNorm();
      (error + lost <= 0.995 * allowed ? low : high) = step;
    }
    const Eigen::MatrixXi integers = Quantize(columns, low);
    const double error = (columns - integers.cast<double>() * low).squaredNorm() + lost;
    // Weights and centroids with 16 bits: finer than the fields need, .5 % of the error is left.
    const size_t num_bytes = DracoBytes(sequence.topology(), integers) +
                             static_cast<size_t>(2) * num_frames * static_cast<size_t>(count + 3);
    if (best.num_bytes == 0 || num_bytes < best.num_bytes) {
      best = {num_bytes, count, 100 * std::sqrt(error / pca.spread)};
    }
  }
  return best;
}

}  // namespace pleat
