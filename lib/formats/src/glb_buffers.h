// The binary chunk of a GLB that is written, and the lists of the JSON that describe it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace pleat {

// Targets of buffer views, as glTF numbers them.
inline constexpr int kVertexBuffer = 34962, kIndexBuffer = 34963, kNoBufferTarget = 0;
// What the header of a GLB can count, less what its JSON and headers take at most.
inline constexpr uint64_t kMaxGlbBinaryBytes = (uint64_t{4} << 30) - (uint64_t{256} << 20);

class GlbBuffers {
 public:
  explicit GlbBuffers(uint64_t num_bytes) { binary_.reserve(num_bytes); }

  // Appends the elements of one accessor and returns its index. T: float, uint32_t or uint16_t;
  // they must fill whole numbers of 4 bytes.
  template <typename T>
  size_t Add(std::span<const T> values, const char* type, int num_components, int target) {
    constexpr int kComponentType = std::is_same_v<T, float>      ? 5126
                                   : std::is_same_v<T, uint32_t> ? 5125
                                                                 : 5123;
    return Append(values.data(), values.size() * sizeof(T), kComponentType,
                  values.size() / static_cast<size_t>(num_components), type, target);
  }
  template <typename T>
  size_t Add(const std::vector<T>& values, const char* type, int num_components, int target) {
    return Add(std::span<const T>(values), type, num_components, target);
  }
  // Positions or differences of them, with the bounds that glTF asks for.
  size_t AddPoints(const Eigen::Matrix3Xf& points);
  // Vectors without bounds, such as normals.
  size_t AddVectors(const Eigen::Matrix3Xf& vectors);
  void SetRange(size_t accessor, double low, double high);

  // Adds the lists to `root`. The binary chunk is what `binary` receives; everything before it is
  // returned.
  std::string Finish(nlohmann::json root, std::string* binary);

 private:
  size_t Append(const void* values, size_t num_bytes, int component_type, size_t count,
                const char* type, int target);

  std::string binary_;
  nlohmann::json views_ = nlohmann::json::array(), accessors_ = nlohmann::json::array();
};

}  // namespace pleat
