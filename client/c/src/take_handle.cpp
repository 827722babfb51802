#include "take_handle.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

#include "absl/strings/match.h"
#include "error_report.h"
#include "pleat/base/status.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"

namespace pleat {
namespace {

constexpr uint32_t kMostIndex = std::numeric_limits<int32_t>::max();

// Copies indices of the caller, each of which must fit into an int32.
absl::StatusOr<std::vector<int32_t>> TakeIndices(absl::string_view name, const uint32_t* values,
                                                 size_t count) {
  if (count > kMostIndex) {
    return absl::ResourceExhaustedError(absl::StrCat(count, " values of ", name));
  }
  if (count > 0 && values == nullptr) return IsNull(name);
  std::vector<int32_t> taken;
  taken.reserve(count);
  for (const uint32_t value : std::span(values, count)) {
    if (value > kMostIndex) {
      return absl::InvalidArgumentError(absl::StrCat(value, " in ", name, " is out of range"));
    }
    taken.push_back(static_cast<int32_t>(value));
  }
  return taken;
}

absl::StatusOr<MeshSequence> TakeSequence(const pleat_take_mesh& mesh, const float* positions,
                                          size_t num_values) {
  const MeshLimits limits;
  if (mesh.num_vertices == 0 || mesh.num_frames == 0) {
    return absl::InvalidArgumentError(absl::StrCat("a take of ", mesh.num_frames, " frames and ",
                                                   mesh.num_vertices, " vertices shows nothing"));
  }
  if (mesh.num_vertices > limits.max_vertices || mesh.num_frames > limits.max_frames) {
    return absl::ResourceExhaustedError(absl::StrCat(
        mesh.num_frames, " frames of ", mesh.num_vertices, " vertices; at most ", limits.max_frames,
        " frames and ", limits.max_vertices, " vertices are taken"));
  }
  const size_t frame_values = 3 * size_t{mesh.num_vertices};
  if (num_values != frame_values * mesh.num_frames) {
    return absl::InvalidArgumentError(
        absl::StrCat(num_values, " values of positions; ", mesh.num_frames, " frames of ",
                     mesh.num_vertices, " vertices have ", frame_values * mesh.num_frames));
  }
  if (positions == nullptr) return IsNull("positions");
  PLEAT_ASSIGN_OR_RETURN(auto sizes, TakeIndices("face_sizes", mesh.face_sizes, mesh.num_faces));
  PLEAT_ASSIGN_OR_RETURN(auto corners, TakeIndices("corners", mesh.corners, mesh.num_corners));
  PLEAT_ASSIGN_OR_RETURN(Topology topology, Topology::Create(static_cast<int>(mesh.num_vertices),
                                                             std::move(corners), std::move(sizes)));
  std::vector<Eigen::Matrix3Xf> frames;
  for (uint32_t t = 0; t < mesh.num_frames; ++t) {
    frames.emplace_back(Eigen::Map<const Eigen::Matrix3Xf>(
        positions + t * frame_values, 3, static_cast<Eigen::Index>(mesh.num_vertices)));
  }
  return MeshSequence::Create(std::move(topology), std::move(frames),
                              {.name = mesh.name == nullptr ? "" : mesh.name,
                               .frame_rate = {mesh.rate_numerator, mesh.rate_denominator}});
}

absl::Status Write(const MeshSequence& sequence, const std::string& path) {
  if (absl::EndsWithIgnoreCase(path, ".abc")) return WriteAlembic(path, sequence);
  if (absl::EndsWithIgnoreCase(path, ".pseq")) return WriteSequenceFile(path, sequence);
  return absl::InvalidArgumentError(
      absl::StrCat("'", path, "' ends neither in .abc nor in .pseq, which are what is written"));
}

}  // namespace
}  // namespace pleat

using pleat::Guarded;
using pleat::IsNull;

extern "C" {

pleat_code pleat_take_create(const pleat_take_mesh* mesh, const float* positions, size_t num_values,
                             pleat_take** take, pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (take == nullptr) return IsNull("take");
    *take = nullptr;
    if (mesh == nullptr) return IsNull("mesh");
    PLEAT_RETURN_IF_ERROR(
        pleat::CheckStructSize("pleat_take_mesh", mesh->struct_size, sizeof(pleat_take_mesh)));
    PLEAT_ASSIGN_OR_RETURN(auto sequence, pleat::TakeSequence(*mesh, positions, num_values));
    *take = new pleat_take{std::move(sequence), {}};
    return absl::OkStatus();
  });
}

pleat_code pleat_take_read(const char* path, pleat_progress progress, void* user, pleat_take** take,
                           pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (take == nullptr) return IsNull("take");
    *take = nullptr;
    if (path == nullptr) return IsNull("path");
    pleat::CallerProgress report(progress, user);
    pleat::InputReport notes;
    PLEAT_ASSIGN_OR_RETURN(
        auto sequence, pleat::ReadSequence(path, {}, report.token().Stage("read", 0, 1), &notes));
    auto read = std::make_unique<pleat_take>(pleat_take{std::move(sequence), {}});
    for (const pleat::InputNote& note : notes.notes) read->notes.push_back(note.text);
    *take = read.release();
    return absl::OkStatus();
  });
}

pleat_code pleat_take_write(const pleat_take* take, const char* path, pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (take == nullptr) return IsNull("take");
    if (path == nullptr) return IsNull("path");
    return pleat::Write(take->sequence, path);
  });
}

void pleat_take_destroy(pleat_take* take) { delete take; }

pleat_code pleat_take_get_info(const pleat_take* take, pleat_take_info* info, pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (take == nullptr) return IsNull("take");
    if (info == nullptr) return IsNull("info");
    PLEAT_RETURN_IF_ERROR(
        pleat::CheckStructSize("pleat_take_info", info->struct_size, sizeof(pleat_take_info)));
    const pleat::MeshSequence& sequence = take->sequence;
    info->num_vertices = static_cast<uint32_t>(sequence.num_vertices());
    info->num_faces = static_cast<uint32_t>(sequence.topology().num_faces());
    info->num_frames = static_cast<uint32_t>(sequence.num_frames());
    info->rate_numerator = sequence.frame_rate().numerator;
    info->rate_denominator = sequence.frame_rate().denominator;
    info->num_notes = static_cast<uint32_t>(take->notes.size());
    return absl::OkStatus();
  });
}

const char* pleat_take_name(const pleat_take* take) {
  return take == nullptr ? nullptr : take->sequence.name().c_str();
}

const char* pleat_take_note(const pleat_take* take, uint32_t note) {
  return take == nullptr || note >= take->notes.size() ? nullptr : take->notes[note].c_str();
}

}  // extern "C"
