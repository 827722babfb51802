// The C interface as a host with bad luck uses it: any bytes as a model, and then any numbers as
// poses, sizes, strides and parameters of whatever became a model. Buffers are exactly as large as
// what the host says of them, so that the sanitizer sees a row too many.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "pleat.h"
#include "support/hostile_bytes.h"

namespace {

// Takes numbers from the input, over and over.
class Numbers {
 public:
  Numbers(const uint8_t* data, size_t size) : data_(data), size_(size) {}
  template <typename Value>
  Value Next() {
    Value value{};
    for (size_t i = 0; i < sizeof(Value) && size_ > 0; ++i) {
      reinterpret_cast<uint8_t*>(&value)[i] = data_[place_++ % size_];
    }
    return value;
  }

 private:
  const uint8_t* data_;
  size_t size_, place_ = 0;
};

// Rotations of `num_joints` joints: raw numbers, or unit quaternions made of them.
std::vector<double> Rotations(Numbers& numbers, size_t num_joints) {
  const bool raw = numbers.Next<uint8_t>() % 4 == 0;
  std::vector<double> values;
  for (size_t j = 0; j < num_joints; ++j) {
    double q[4], norm = 0;
    for (double& c : q) {
      c = raw ? numbers.Next<double>() : numbers.Next<int8_t>() + .5;
      norm += c * c;
    }
    for (const double c : q) values.push_back(raw ? c : c / std::sqrt(norm));
  }
  return values;
}

void Evaluate(const pleat_model* model, const pleat_model_info& info, Numbers& numbers) {
  pleat_error error;
  pleat_evaluator* evaluator = nullptr;
  pleat_motion* motion = nullptr;
  if (pleat_evaluator_create(model, &evaluator, &error) != PLEAT_OK ||
      pleat_motion_create(model, &motion, &error) != PLEAT_OK) {
    __builtin_trap();
  }
  const size_t num_joints = info.num_joints;
  std::vector<std::vector<double>> rotations;
  std::vector<pleat_pose> poses;
  for (int h = 0; h < 2; ++h) rotations.push_back(Rotations(numbers, num_joints));
  for (const std::vector<double>& values : rotations) {
    pleat_pose pose{.root_position = {}, .rotations = values.data(), .num_joints = num_joints};
    for (double& x : pose.root_position) x = numbers.Next<int16_t>() * .01;
    if (numbers.Next<uint8_t>() == 0) pose.num_joints = numbers.Next<size_t>();
    pleat_motion_push(motion, numbers.Next<uint16_t>() * .01, &pose, &error);
    poses.push_back(pose);
  }
  size_t num_history = 0;
  const pleat_pose* history = nullptr;
  if (pleat_motion_poses(motion, &history, &num_history, &error) != PLEAT_OK) num_history = 0;

  const size_t stride = 4 * (numbers.Next<uint8_t>() % 8);
  const size_t good = info.num_vertices * (stride < 12 ? 12 : stride);
  const size_t num_bytes = numbers.Next<uint8_t>() % 8 == 0 ? numbers.Next<uint16_t>() : good;
  std::vector<char> positions(num_bytes), normals(num_bytes);
  std::vector<double> scales(num_joints);
  for (double& scale : scales) scale = numbers.Next<uint8_t>() * .1;
  pleat_query query{};
  query.struct_size = sizeof(query);
  query.poses = num_history > 0 ? history : poses.data();
  query.num_poses = num_history > 0 ? num_history : poses.size();
  if (numbers.Next<uint8_t>() % 2 == 0) query.bone_scales = scales.data();
  query.flags = numbers.Next<uint8_t>() % 3;
  query.positions = {reinterpret_cast<float*>(positions.data()), stride, num_bytes};
  query.normals = {reinterpret_cast<float*>(normals.data()), stride, num_bytes};
  pleat_evaluate(evaluator, &query, 1, &error);

  std::vector<float> parameter_rotations(4 * num_joints), coefficients(info.num_coefficients);
  pleat_parameters parameters{.struct_size = sizeof(parameters),
                              .root_position = {},
                              .rotations = parameter_rotations.data(),
                              .num_joints = num_joints,
                              .coefficients = coefficients.data(),
                              .num_coefficients = coefficients.size(),
                              .confidence = 0};
  pleat_predict(evaluator, &query, &parameters, &error);
  if (numbers.Next<uint8_t>() % 2 == 0) {
    for (float& coefficient : coefficients) coefficient = numbers.Next<float>();
  }
  pleat_show(evaluator, &parameters, &query, &error);
  std::vector<double> confidence(num_joints);
  pleat_joint_confidence(model, query.poses, query.num_poses, confidence.data(), num_joints,
                         &error);
  pleat_motion_destroy(motion);
  pleat_evaluator_destroy(evaluator);
}

void CopyRig(const pleat_model* model, const pleat_model_info& info, Numbers& numbers) {
  pleat_error error;
  const uint32_t per_vertex = 1 + numbers.Next<uint8_t>() % 8;
  std::vector<float> rest(size_t{3} * info.num_vertices),
      weights(size_t{per_vertex} * info.num_vertices);
  std::vector<uint32_t> bones(weights.size());
  pleat_model_record record{};
  record.struct_size = sizeof(record);
  if (pleat_model_copy_rest_positions(model, rest.data(), rest.size(), &error) != PLEAT_OK ||
      pleat_model_copy_influences(model, per_vertex, bones.data(), weights.data(), bones.size(),
                                  &error) != PLEAT_OK ||
      pleat_model_get_record(model, &record, &error) != PLEAT_OK) {
    __builtin_trap();
  }
  for (const uint32_t bone : bones) {
    if (bone >= info.num_joints) __builtin_trap();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // With the right checksum, so that the fuzzer gets behind it.
  const std::string bytes = pleat::Reseal({reinterpret_cast<const char*>(data), size});
  const pleat_model_options options{.struct_size = sizeof(options), .max_unfolded_bytes = 1 << 28};
  pleat_model* model = nullptr;
  pleat_error error;
  if (pleat_model_create(bytes.data(), bytes.size(), &options, &model, &error) != PLEAT_OK) {
    if (model != nullptr || std::strlen(error.message) == 0) __builtin_trap();
    return 0;
  }
  pleat_model_info info{};
  info.struct_size = sizeof(info);
  if (pleat_model_get_info(model, &info, &error) != PLEAT_OK) __builtin_trap();
  std::vector<uint32_t> triangles(size_t{3} * info.num_triangles);
  if (pleat_model_copy_triangles(model, triangles.data(), triangles.size(), &error) != PLEAT_OK) {
    __builtin_trap();
  }
  Numbers numbers(data, size);
  CopyRig(model, info, numbers);
  Evaluate(model, info, numbers);
  pleat_model_destroy(model);
  return 0;
}
