#include "model_export.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "pleat/base/status.h"
#include "pleat/character/morph_basis.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/bvh.h"
#include "pleat/formats/character_file.h"
#include "pleat/formats/glb_writer.h"
#include "pleat/formats/mdd.h"
#include "pleat/formats/npz.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/usda_writer.h"

namespace pleat {
namespace {

constexpr int kMaxFoldTargets = 24;  // what engines blend without trouble

std::vector<Eigen::Matrix3Xf> FramesOf(const MeshSequence& sequence) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  return frames;
}

struct FramesFormat {
  std::string name;
  EncodeFrames encode;
};

const std::vector<FramesFormat>& FramesFormats() {
  using Result = absl::StatusOr<std::string>;
  using Sequence = const MeshSequence&;
  static const std::vector<FramesFormat>& formats = *new std::vector<FramesFormat>{
      {"glb", [](Sequence sequence) { return EncodeGlb(sequence); }},
      {"abc", [](Sequence sequence) -> Result { return EncodeAlembic(sequence); }},
      {"usda", [](Sequence sequence) -> Result { return EncodeUsda(sequence); }},
      {"pc2",
       [](Sequence sequence) -> Result {
         return EncodePointCache({.start_frame = 0, .frames = FramesOf(sequence)});
       }},
      {"mdd",
       [](Sequence sequence) -> Result {
         MddCache cache{.times_s = {}, .frames = FramesOf(sequence)};
         for (int t = 0; t < sequence.num_frames(); ++t) {
           cache.times_s.push_back(static_cast<float>(t / sequence.frame_rate().fps()));
         }
         return EncodeMdd(cache);
       }},
      {"obj",
       [](Sequence sequence) -> Result {
         return EncodeObj(sequence.topology(), sequence.frame(0), sequence.appearance());
       }},
      {"npz", [](Sequence sequence) -> Result { return EncodeNpz(sequence); }},
      {"npy", [](Sequence sequence) -> Result { return EncodeNpy(sequence); }},
      {"pseq", [](Sequence sequence) -> Result { return EncodeSequence(sequence); }}};
  return formats;
}

absl::StatusOr<std::string> EncodeGlbWithFolds(const std::shared_ptr<const CharacterModel>& model,
                                               const Motion& motion) {
  if (!motion.detail_strengths.empty() || !motion.vertex_strengths.empty()) {
    return absl::InvalidArgumentError(
        "the strengths of the detail are not in morph targets: set them back to 1, or export the "
        "frames");
  }
  // Every engine reads four influences; those that take no more would show others wrongly.
  PLEAT_ASSIGN_OR_RETURN(CharacterFile file,
                         MakeCharacterFile(*model, motion, kStandardInfluences));
  const int num_targets = std::min(kMaxFoldTargets, motion.track.num_frames());
  PLEAT_ASSIGN_OR_RETURN(file.morphs, ComputeMorphBasis(model, file.rig.weights, file.track,
                                                        {.num_targets = num_targets}));
  return EncodeCharacterGlb(file);
}

}  // namespace

const std::vector<std::string>& ExportFormats() {
  static const std::vector<std::string>& names = *[] {
    auto* list = new std::vector<std::string>;
    for (const FramesFormat& format : FramesFormats()) list->push_back(format.name);
    list->insert(list->end(), {"character.glb", "character.usda", "bvh"});
    return list;
  }();
  return names;
}

EncodeFrames FindFramesFormat(const std::string& name) {
  for (const FramesFormat& format : FramesFormats()) {
    if (format.name == name) return format.encode;
  }
  return nullptr;
}

absl::StatusOr<std::string> EncodeCharacterAs(const std::string& name,
                                              const std::shared_ptr<const CharacterModel>& model,
                                              const Motion& motion) {
  if (name == "bvh") return EncodeBvh(ClipFromPoses(model->skeleton(), motion.track));
  if (name == "character.glb") return EncodeGlbWithFolds(model, motion);
  if (name == "character.usda") {
    PLEAT_ASSIGN_OR_RETURN(const CharacterFile file,
                           MakeCharacterFile(*model, motion, kMaxInfluences));
    return EncodeCharacterUsda(file);
  }
  return absl::InvalidArgumentError(absl::StrCat("there is no format of this name; choose ",
                                                 absl::StrJoin(ExportFormats(), ", ")));
}

}  // namespace pleat
