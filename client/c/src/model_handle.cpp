#include "model_handle.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "error_report.h"
#include "pleat/base/status.h"
#include "pleat/formats/model_file.h"

namespace pleat {
namespace {

// Copies a list of the mesh into memory for `num_values` values.
template <typename Value, typename List>
absl::Status CopyList(absl::string_view name, const List& list, Value* values, size_t num_values) {
  if (num_values != list.size()) {
    return absl::InvalidArgumentError(absl::StrCat("there are ", list.size(), " values of ", name,
                                                   " and room for ", num_values,
                                                   ": ask pleat_model_get_info"));
  }
  if (list.empty()) return absl::OkStatus();
  if (values == nullptr) return IsNull(name);
  std::transform(list.begin(), list.end(), values,
                 [](const auto& value) { return static_cast<Value>(value); });
  return absl::OkStatus();
}

// Runs `copy` on the character of a model that is there.
template <typename Copy>
pleat_code WithCharacter(const pleat_model* model, pleat_error* error, Copy&& copy) noexcept {
  return Guarded(error, [&]() -> absl::Status {
    if (model == nullptr) return IsNull("model");
    return copy(*model->character);
  });
}

absl::StatusOr<MeshLimits> TakeLimits(const pleat_model_options* options) {
  MeshLimits limits;
  if (options == nullptr) return limits;
  PLEAT_RETURN_IF_ERROR(
      CheckStructSize("pleat_model_options", options->struct_size, sizeof(pleat_model_options)));
  if (options->max_unfolded_bytes > 0) limits.max_unfolded_bytes = options->max_unfolded_bytes;
  return limits;
}

absl::Status FillInfo(const CharacterModel& character, pleat_model_info* info) {
  const Topology& topology = character.topology();
  const auto count = [](auto value) { return static_cast<uint32_t>(value); };
  info->num_vertices = count(topology.num_vertices());
  info->num_faces = count(topology.num_faces());
  info->num_corners = count(topology.num_corners());
  info->num_triangles = count(topology.num_triangles());
  info->num_texcoords = count(character.parts().appearance.texcoords.size());
  info->num_joints = count(character.skeleton().num_joints());
  info->num_coefficients = count(character.full_basis().num_coefficients());
  info->history = count(character.options().history);
  info->frames_per_second = character.frame_rate().fps();
  info->memory_bytes = character.memory_bytes();
  return absl::OkStatus();
}

}  // namespace
}  // namespace pleat

using pleat::CopyList;
using pleat::Guarded;
using pleat::IsNull;
using pleat::WithCharacter;

extern "C" {

pleat_code pleat_model_create(const void* bytes, size_t num_bytes,
                              const pleat_model_options* options, pleat_model** model,
                              pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (model == nullptr) return IsNull("model");
    *model = nullptr;
    if (bytes == nullptr) return IsNull("bytes");
    PLEAT_ASSIGN_OR_RETURN(const pleat::MeshLimits limits, pleat::TakeLimits(options));
    const std::string_view file(static_cast<const char*>(bytes), num_bytes);
    PLEAT_ASSIGN_OR_RETURN(auto character, pleat::DecodeModel(file, limits));
    *model = new pleat_model{std::move(character)};
    return absl::OkStatus();
  });
}

void pleat_model_destroy(pleat_model* model) { delete model; }

pleat_code pleat_model_get_info(const pleat_model* model, pleat_model_info* info,
                                pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) -> absl::Status {
    if (info == nullptr) return IsNull("info");
    PLEAT_RETURN_IF_ERROR(
        pleat::CheckStructSize("pleat_model_info", info->struct_size, sizeof(pleat_model_info)));
    return pleat::FillInfo(character, info);
  });
}

const char* pleat_model_name(const pleat_model* model) {
  return model == nullptr ? nullptr : model->character->name().c_str();
}

const char* pleat_model_joint_name(const pleat_model* model, uint32_t joint) {
  if (model == nullptr) return nullptr;
  const auto& joints = model->character->skeleton().joints();
  return joint < joints.size() ? joints[joint].name.c_str() : nullptr;
}

int32_t pleat_model_joint_parent(const pleat_model* model, uint32_t joint) {
  constexpr int32_t kNoSuchJoint = -2;
  if (model == nullptr) return kNoSuchJoint;
  const auto& joints = model->character->skeleton().joints();
  return joint < joints.size() ? joints[joint].parent : kNoSuchJoint;
}

pleat_code pleat_model_copy_joints(const pleat_model* model, double* positions, size_t num_values,
                                   pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) {
    const Eigen::Matrix3Xd rest = character.skeleton().RestPositions();
    return CopyList("joint positions", std::span(rest.data(), static_cast<size_t>(rest.size())),
                    positions, num_values);
  });
}

pleat_code pleat_model_copy_triangles(const pleat_model* model, uint32_t* indices,
                                      size_t num_values, pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) {
    const Eigen::Matrix3Xi& triangles = character.topology().triangles();
    return CopyList("triangles", std::span(triangles.data(), static_cast<size_t>(triangles.size())),
                    indices, num_values);
  });
}

pleat_code pleat_model_copy_face_sizes(const pleat_model* model, uint32_t* sizes, size_t num_values,
                                       pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) {
    std::vector<size_t> face_sizes;
    for (int f = 0; f < character.topology().num_faces(); ++f) {
      face_sizes.push_back(character.topology().face(f).size());
    }
    return CopyList("face sizes", face_sizes, sizes, num_values);
  });
}

pleat_code pleat_model_copy_corners(const pleat_model* model, uint32_t* vertices, size_t num_values,
                                    pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) {
    return CopyList("corners", character.topology().corner_vertices(), vertices, num_values);
  });
}

pleat_code pleat_model_copy_texcoords(const pleat_model* model, float* texcoords, size_t num_values,
                                      pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) {
    std::vector<float> values;
    for (const Eigen::Vector2f& texcoord : character.parts().appearance.texcoords) {
      values.insert(values.end(), {texcoord.x(), texcoord.y()});
    }
    return CopyList("texture coordinates", values, texcoords, num_values);
  });
}

pleat_code pleat_model_copy_corner_texcoords(const pleat_model* model, int32_t* indices,
                                             size_t num_values, pleat_error* error) {
  return WithCharacter(model, error, [&](const auto& character) {
    return CopyList("corner texture coordinates", character.parts().appearance.corner_texcoords,
                    indices, num_values);
  });
}

}  // extern "C"
