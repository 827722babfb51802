#include "cli/io/animation_writer.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/exit_code.h"
#include "cli/io/draco_folder.h"
#include "pleat/base/status.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/glb_writer.h"
#include "pleat/formats/mdd.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/ply_writer.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/usda_writer.h"

namespace pleat {
namespace {

absl::Status NoFrames() { return absl::InvalidArgumentError("there are no frames to write"); }

// How a format writes a whole sequence.
using WriteSequence = std::function<absl::Status(const std::string& path, const MeshSequence&,
                                                 const AnimationOptions&)>;

// The topology of a format that holds positions alone.
absl::Status WriteMeshBeside(const std::string& path, const MeshSequence& sequence) {
  return WriteObj(std::filesystem::path(path).replace_extension(".obj").string(),
                  sequence.topology(), sequence.frame(0), sequence.appearance());
}

std::vector<Eigen::Matrix3Xf> FramesOf(const MeshSequence& sequence) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); ++t) frames.push_back(sequence.frame(t));
  return frames;
}

absl::Status WritePc2WithMesh(const std::string& path, const MeshSequence& sequence,
                              const AnimationOptions& options) {
  PLEAT_RETURN_IF_ERROR(WriteMeshBeside(path, sequence));
  return WritePointCache(
      path, {.start_frame = static_cast<float>(options.first_frame), .frames = FramesOf(sequence)});
}

absl::Status WriteMddWithMesh(const std::string& path, const MeshSequence& sequence,
                              const AnimationOptions& options) {
  MddCache cache{.times_s = {}, .frames = FramesOf(sequence)};
  const FrameRate rate = sequence.frame_rate();
  for (int t = 0; t < sequence.num_frames(); ++t) {
    cache.times_s.push_back(
        static_cast<float>((options.first_frame + t) * rate.denominator / rate.numerator));
  }
  PLEAT_RETURN_IF_ERROR(WriteMeshBeside(path, sequence));
  return WriteMdd(path, cache);
}

WriteSequence WriterOf(AnimationFormat format) {
  switch (format) {
    case AnimationFormat::kPc2:
      return WritePc2WithMesh;
    case AnimationFormat::kMdd:
      return WriteMddWithMesh;
    case AnimationFormat::kNpy:
      return [](const auto& path, const auto& sequence, const auto&) -> absl::Status {
        PLEAT_RETURN_IF_ERROR(WriteMeshBeside(path, sequence));
        return WriteNpy(path, sequence);
      };
    case AnimationFormat::kNpz:
      return [](const auto& path, const auto& sequence, const auto& options) {
        return WriteNpz(path, sequence,
                        {.keys = options.npz_keys, .first_frame = options.first_frame});
      };
    case AnimationFormat::kAbc:
      return [](const auto& path, const auto& sequence, const auto& options) {
        return WriteAlembic(path, sequence, options.first_frame);
      };
    case AnimationFormat::kGlb:
      return [](const auto& path, const auto& sequence, const auto&) {
        return WriteGlb(path, sequence);
      };
    case AnimationFormat::kUsda:
      return [](const auto& path, const auto& sequence, const auto& options) {
        return WriteUsda(path, sequence,
                         {.meters_per_unit = options.space.unit_m,
                          .is_z_up = options.space.up == UpAxis::kZ,
                          .first_frame = options.first_frame});
      };
    default:
      return [](const auto& path, const auto& sequence, const auto&) {
        return WriteSequenceFile(path, sequence);
      };
  }
}

// Collects a whole sequence for one file.
class SequenceFileWriter : public AnimationWriter {
 public:
  SequenceFileWriter(std::string path, const Topology& topology, AnimationOptions options,
                     WriteSequence write)
      : path_(std::move(path)),
        topology_(topology),
        options_(std::move(options)),
        write_(std::move(write)) {}

  absl::Status AddFrame(const Eigen::Matrix3Xf& positions) override {
    frames_.push_back(positions);
    return absl::OkStatus();
  }
  absl::Status Finish() override {
    if (frames_.empty()) return NoFrames();
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                           MeshSequence::Create(topology_, std::move(frames_),
                                                {.name = options_.name,
                                                 .frame_rate = options_.frame_rate,
                                                 .appearance = options_.appearance}));
    return write_(path_, sequence, options_);
  }

 private:
  std::string path_;
  Topology topology_;
  AnimationOptions options_;
  WriteSequence write_;
  std::vector<Eigen::Matrix3Xf> frames_;
};

class MeshFolderWriter : public AnimationWriter {
 public:
  MeshFolderWriter(std::string folder, const Topology& topology, AnimationOptions options, bool ply)
      : folder_(std::move(folder)), topology_(topology), options_(std::move(options)), ply_(ply) {}

  absl::Status AddFrame(const Eigen::Matrix3Xf& positions) override {
    const std::string path = FramePath(num_frames_++);
    if (ply_) return WritePly(path, topology_, positions, options_.appearance);
    return WriteObj(path, topology_, positions, options_.appearance);
  }
  // Removes the frames that a longer animation left in the folder, since readers take every file.
  absl::Status Finish() override {
    if (num_frames_ == 0) return NoFrames();
    std::error_code ignored;
    for (int t = num_frames_; std::filesystem::remove(FramePath(t), ignored); ++t) {
    }
    return absl::OkStatus();
  }

 private:
  std::string FramePath(int t) const {
    return absl::StrFormat("%s/frame_%04d.%s", folder_, t, ply_ ? "ply" : "obj");
  }

  std::string folder_;
  Topology topology_;
  AnimationOptions options_;
  bool ply_;
  int num_frames_ = 0;
};

class DracoWriter : public AnimationWriter {
 public:
  DracoWriter(std::string folder, const Topology& topology, AnimationOptions options)
      : topology_(topology),
        options_(std::move(options)),
        writer_(std::move(folder), options_.frame_rate) {}

  absl::Status AddFrame(const Eigen::Matrix3Xf& positions) override {
    if (!encoder_) {
      PLEAT_ASSIGN_OR_RETURN(
          FrameEncoder encoder,
          FrameEncoder::Create(topology_,
                               options_.reference.cols() > 0 ? options_.reference : positions,
                               options_.encoder));
      encoder_.emplace(std::move(encoder));
    }
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, encoder_->Encode(positions));
    return writer_.AddFrame(bytes);
  }
  absl::Status Finish() override {
    return encoder_ ? writer_.Finish(encoder_->header()) : NoFrames();
  }

 private:
  Topology topology_;
  AnimationOptions options_;
  DracoFolderWriter writer_;
  std::optional<FrameEncoder> encoder_;
};

}  // namespace

const std::vector<AnimationFormatInfo>& AnimationFormats() {
  using enum AnimationFormat;
  static const std::vector<AnimationFormatInfo>& formats =
      *new std::vector<AnimationFormatInfo>{{kPc2, "pc2", true, true},
                                            {kMdd, "mdd", true, true},
                                            {kAbc, "abc"},
                                            {kGlb, "glb"},
                                            {kUsda, "usda"},
                                            {kNpz, "npz"},
                                            {kNpy, "npy", true, true},
                                            {kPseq, "pseq"},
                                            {kObj, "obj", false},
                                            {kPly, "ply", false},
                                            {kDraco, "drc", false}};
  return formats;
}

const AnimationFormatInfo& InfoOf(AnimationFormat format) {
  return *std::ranges::find(AnimationFormats(), format, &AnimationFormatInfo::format);
}

std::string AnimationEndings() {
  std::vector<std::string> endings;
  for (const AnimationFormatInfo& info : AnimationFormats()) {
    if (info.is_file) endings.push_back("." + info.name);
  }
  return absl::StrJoin(endings, ", ");
}

std::string FormatFlagHelp(const std::string& folder_format) {
  std::vector<std::string> names;
  for (const AnimationFormatInfo& info : AnimationFormats()) names.push_back(info.name);
  const std::string last = names.back();
  names.pop_back();
  return absl::StrCat("auto (by the ending of OUT; a folder gets ", folder_format, "), ",
                      absl::StrJoin(names, ", "), " or ", last);
}

absl::StatusOr<AnimationFormat> ChooseAnimationFormat(const std::string& name,
                                                      const std::string& path,
                                                      AnimationFormat folder_format) {
  const std::string extension = std::filesystem::path(path).extension().string();
  std::vector<std::string> names;
  for (const AnimationFormatInfo& info : AnimationFormats()) {
    if (name == info.name) return info.format;
    if (name == "auto" && info.is_file && extension == "." + info.name) return info.format;
    names.push_back(info.name);
  }
  if (name == "auto") return folder_format;
  return UsageError(
      absl::StrCat("format '", name, "' is unknown; choose auto, ", absl::StrJoin(names, ", ")));
}

std::unique_ptr<AnimationWriter> MakeAnimationWriter(AnimationFormat format,
                                                     const std::string& path,
                                                     const Topology& topology,
                                                     AnimationOptions options) {
  if (InfoOf(format).is_file) {
    return std::make_unique<SequenceFileWriter>(path, topology, std::move(options),
                                                WriterOf(format));
  }
  if (format == AnimationFormat::kDraco) {
    return std::make_unique<DracoWriter>(path, topology, std::move(options));
  }
  return std::make_unique<MeshFolderWriter>(path, topology, std::move(options),
                                            format == AnimationFormat::kPly);
}

}  // namespace pleat
