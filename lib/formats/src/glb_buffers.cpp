#include "glb_buffers.h"

#include <utility>

#include "gltf_file.h"

namespace pleat {

using nlohmann::json;

size_t GlbBuffers::Append(const void* values, size_t num_bytes, int component_type, size_t count,
                          const char* type, int target) {
  json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", num_bytes}};
  if (target != kNoBufferTarget) view["target"] = target;
  views_.push_back(std::move(view));
  accessors_.push_back({{"bufferView", views_.size() - 1},
                        {"componentType", component_type},
                        {"count", count},
                        {"type", type}});
  binary_.append(static_cast<const char*>(values), num_bytes);
  return accessors_.size() - 1;
}

size_t GlbBuffers::AddVectors(const Eigen::Matrix3Xf& vectors) {
  const std::span<const float> values(vectors.data(), static_cast<size_t>(vectors.size()));
  return Add(values, "VEC3", 3, kVertexBuffer);
}

size_t GlbBuffers::AddPoints(const Eigen::Matrix3Xf& points) {
  const size_t index = AddVectors(points);
  const Eigen::Vector3f low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  accessors_[index]["min"] = {low.x(), low.y(), low.z()};
  accessors_[index]["max"] = {high.x(), high.y(), high.z()};
  return index;
}

void GlbBuffers::SetRange(size_t accessor, double low, double high) {
  accessors_[accessor]["min"] = {low};
  accessors_[accessor]["max"] = {high};
}

std::string GlbBuffers::Finish(json root, std::string* binary) {
  root["bufferViews"] = std::move(views_);
  root["accessors"] = std::move(accessors_);
  root["buffers"] = json::array({{{"byteLength", binary_.size()}}});
  *binary = std::move(binary_);  // whole numbers of 4 bytes
  return GlbStart(root.dump(-1, ' ', false, json::error_handler_t::replace), binary->size());
}

}  // namespace pleat
