#include "draco_encode.h"

#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "draco/compression/expert_encode.h"

namespace pleat {
namespace {

int AddAttribute(draco::GeometryAttribute::Type type, draco::DataType data_type, int num_components,
                 int num_values, draco::PointCloud* cloud) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<uint8_t>(num_components), data_type, false,
                 int64_t{draco::DataTypeLength(data_type)} * num_components, 0);
  return cloud->AddAttribute(attribute, /*identity_mapping=*/true, num_values);
}

absl::Status RunEncoder(draco::ExpertEncoder* encoder, std::string* bytes) {
  draco::EncoderBuffer buffer;
  try {
    // Draco throws std::length_error on values that it cannot code, and std::bad_alloc.
    const draco::Status status = encoder->EncodeToBuffer(&buffer);
    if (!status.ok()) {
      return absl::InternalError(absl::StrCat("Draco cannot encode: ", status.error_msg_string()));
    }
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("there is not enough memory to encode with Draco");
  } catch (const std::exception&) {
    return absl::InternalError("Draco cannot encode: a value is out of its range");
  }
  bytes->assign(buffer.data(), buffer.size());
  return absl::OkStatus();
}

}  // namespace

std::unique_ptr<draco::Mesh> MakeDracoMesh(int num_vertices, const Eigen::Matrix3Xi& triangles) {
  auto mesh = std::make_unique<draco::Mesh>();
  mesh->set_num_points(num_vertices);
  mesh->SetNumFaces(triangles.cols());
  for (int f = 0; f < triangles.cols(); ++f) {
    draco::Mesh::Face face;
    for (int corner = 0; corner < 3; ++corner) face[corner] = triangles(corner, f);
    mesh->SetFace(draco::FaceIndex(f), face);
  }
  AddAttribute(draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, num_vertices, mesh.get());
  const int ids =
      AddAttribute(draco::GeometryAttribute::GENERIC, draco::DT_INT32, 1, num_vertices, mesh.get());
  for (int32_t v = 0; v < num_vertices; ++v) {
    mesh->attribute(ids)->SetAttributeValue(draco::AttributeValueIndex(v), &v);
  }
  return mesh;
}

std::unique_ptr<draco::PointCloud> MakeDracoPointCloud(int num_points) {
  auto cloud = std::make_unique<draco::PointCloud>();
  cloud->set_num_points(num_points);
  AddAttribute(draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, num_points, cloud.get());
  return cloud;
}

void SetDracoPositions(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                       const std::vector<int32_t>& order, draco::PointCloud* cloud) {
  draco::PointAttribute* attribute = cloud->attribute(0);
  auto* values = reinterpret_cast<float*>(attribute->GetAddress(draco::AttributeValueIndex(0)));
  for (int k = 0; k < positions.cols(); ++k) {
    const int v = order.empty() ? k : order[k];
    std::memcpy(values + 3 * static_cast<size_t>(k), positions.col(v).data(), 3 * sizeof(float));
  }
}

std::unique_ptr<draco::PointCloud> MakeDracoResidualCloud(int num_points) {
  auto cloud = std::make_unique<draco::PointCloud>();
  cloud->set_num_points(num_points);
  for (int c = 0; c < 3; ++c) {
    AddAttribute(draco::GeometryAttribute::GENERIC, draco::DT_INT32, 1, num_points, cloud.get());
  }
  return cloud;
}

void SetDracoResiduals(const Eigen::Matrix3Xi& residuals, draco::PointCloud* cloud) {
  int32_t* values[3];
  for (int c = 0; c < 3; ++c) {
    values[c] =
        reinterpret_cast<int32_t*>(cloud->attribute(c)->GetAddress(draco::AttributeValueIndex(0)));
  }
  const int* column = residuals.data();
  for (Eigen::Index i = 0; i < residuals.cols(); ++i, column += 3) {
    for (int c = 0; c < 3; ++c) values[c][i] = column[c];
  }
}

absl::Status EncodeDracoResiduals(const draco::PointCloud& cloud, int speed, std::string* bytes) {
  draco::ExpertEncoder encoder(cloud);
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  for (int c = 0; c < 3; ++c) {  // what arrives here has been predicted already
    const draco::Status status = encoder.SetAttributePredictionScheme(c, draco::PREDICTION_NONE);
    if (!status.ok()) return absl::InternalError(status.error_msg_string());
  }
  return RunEncoder(&encoder, bytes);
}

absl::Status EncodeDracoMesh(const draco::Mesh& mesh, const QuantizationBox& box, MeshMethod method,
                             int speed, std::string* bytes) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetSpeedOptions(speed, speed);
  encoder.SetEncodingMethod(method == MeshMethod::kEdgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                               : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeExplicitQuantization(0, box.bits, 3, box.origin_m.data(), box.range_m);
  return RunEncoder(&encoder, bytes);
}

absl::Status EncodeDracoPointCloud(const draco::PointCloud& cloud, const QuantizationBox& box,
                                   int speed, std::string* bytes) {
  draco::ExpertEncoder encoder(cloud);
  encoder.SetSpeedOptions(speed, speed);
  // Draco's default for quantized clouds is the kd-tree, which loses the order of the points.
  encoder.SetEncodingMethod(draco::POINT_CLOUD_SEQUENTIAL_ENCODING);
  encoder.SetAttributeExplicitQuantization(0, box.bits, 3, box.origin_m.data(), box.range_m);
  return RunEncoder(&encoder, bytes);
}

}  // namespace pleat
