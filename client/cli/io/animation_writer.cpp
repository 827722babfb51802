#include "cli/io/animation_writer.h"

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/draco_folder.h"
#include "pleat/base/status.h"
#include "pleat/formats/alembic_writer.h"
#include "pleat/formats/obj_writer.h"
#include "pleat/formats/pc2.h"
#include "pleat/formats/ply_writer.h"
#include "pleat/formats/sequence_file.h"

namespace pleat {
namespace {

absl::Status NoFrames() { return absl::InvalidArgumentError("there are no frames to write"); }

class PointCacheWriter : public AnimationWriter {
 public:
  PointCacheWriter(std::string path, const Topology& topology, AnimationOptions options)
      : path_(std::move(path)), topology_(topology), options_(std::move(options)) {}

  absl::Status AddFrame(const Eigen::Matrix3Xf& positions) override {
    cache_.frames.push_back(positions);
    return absl::OkStatus();
  }
  absl::Status Finish() override {
    if (cache_.frames.empty()) return NoFrames();
    const std::string mesh_path = std::filesystem::path(path_).replace_extension(".obj").string();
    PLEAT_RETURN_IF_ERROR(WriteObj(mesh_path, topology_, cache_.frames[0], options_.appearance));
    return WritePointCache(path_, cache_);
  }

 private:
  std::string path_;
  Topology topology_;
  AnimationOptions options_;
  PointCache cache_;
};

// Collects a whole sequence for one file, a .pseq or an .abc.
class SequenceFileWriter : public AnimationWriter {
 public:
  using Write = absl::Status (*)(const std::string& path, const MeshSequence& sequence);

  SequenceFileWriter(std::string path, const Topology& topology, AnimationOptions options,
                     Write write)
      : path_(std::move(path)), topology_(topology), options_(std::move(options)), write_(write) {}

  absl::Status AddFrame(const Eigen::Matrix3Xf& positions) override {
    frames_.push_back(positions);
    return absl::OkStatus();
  }
  absl::Status Finish() override {
    if (frames_.empty()) return NoFrames();
    MeshSequenceOptions options;
    options.name = options_.name;
    options.frame_rate = options_.frame_rate;
    options.appearance = options_.appearance;
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                           MeshSequence::Create(topology_, std::move(frames_), options));
    return write_(path_, sequence);
  }

 private:
  std::string path_;
  Topology topology_;
  AnimationOptions options_;
  Write write_;
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

absl::StatusOr<AnimationFormat> ChooseAnimationFormat(const std::string& name,
                                                      const std::string& path,
                                                      AnimationFormat folder_format) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (name == "pc2" || (name == "auto" && extension == ".pc2")) return AnimationFormat::kPc2;
  if (name == "abc" || (name == "auto" && extension == ".abc")) return AnimationFormat::kAbc;
  if (name == "pseq" || (name == "auto" && extension == ".pseq")) return AnimationFormat::kPseq;
  if (name == "obj") return AnimationFormat::kObj;
  if (name == "ply") return AnimationFormat::kPly;
  if (name == "drc") return AnimationFormat::kDraco;
  if (name == "auto") return folder_format;
  return UsageError(
      absl::StrCat("format '", name, "' is unknown; choose auto, pc2, abc, pseq, obj, ply or drc"));
}

std::unique_ptr<AnimationWriter> MakeAnimationWriter(AnimationFormat format,
                                                     const std::string& path,
                                                     const Topology& topology,
                                                     AnimationOptions options) {
  switch (format) {
    case AnimationFormat::kPc2:
      return std::make_unique<PointCacheWriter>(path, topology, std::move(options));
    case AnimationFormat::kPseq:
      return std::make_unique<SequenceFileWriter>(path, topology, std::move(options),
                                                  WriteSequenceFile);
    case AnimationFormat::kAbc:
      return std::make_unique<SequenceFileWriter>(path, topology, std::move(options), WriteAlembic);
    case AnimationFormat::kObj:
    case AnimationFormat::kPly:
      return std::make_unique<MeshFolderWriter>(path, topology, std::move(options),
                                                format == AnimationFormat::kPly);
    case AnimationFormat::kDraco:
      break;
  }
  return std::make_unique<DracoWriter>(path, topology, std::move(options));
}

}  // namespace pleat
