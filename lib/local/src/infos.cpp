#include "infos.h"

#include "pleat/learner/detail_model.h"

namespace pleat {

SequenceInfo MakeSequenceInfo(const MeshSequence& sequence, const std::string& id,
                              uint64_t size_bytes) {
  return {.id = id,
          .name = sequence.name(),
          .num_frames = sequence.num_frames(),
          .num_vertices = sequence.num_vertices(),
          .num_faces = sequence.topology().num_faces(),
          .frame_rate = sequence.frame_rate(),
          .size_bytes = size_bytes};
}

ModelInfo MakeModelInfo(const CharacterModel& model, const std::string& id, uint64_t size_bytes) {
  return {.id = id,
          .name = model.name(),
          .skeleton = model.skeleton(),
          .frame_rate = model.frame_rate(),
          .num_vertices = model.num_vertices(),
          .num_faces = model.topology().num_faces(),
          .num_control_vertices = static_cast<int>(model.parts().control_vertices.size()),
          .num_components = model.detail_model().num_components(),
          .size_bytes = size_bytes,
          .memory_bytes = model.memory_bytes(),
          .options = model.options(),
          .record = model.record()};
}

CompressedSequenceInfo MakeCompressedSequenceInfo(const SequenceDecoder& decoder,
                                                  const std::string& id, uint64_t size_bytes) {
  return {.id = id,
          .name = decoder.name(),
          .num_frames = decoder.num_frames(),
          .num_vertices = decoder.num_vertices(),
          .num_faces = decoder.topology().num_faces(),
          .frame_rate = decoder.frame_rate(),
          .size_bytes = size_bytes,
          .record = std::nullopt};
}

}  // namespace pleat
