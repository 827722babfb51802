#include "pleat/formats/ply_writer.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "pleat/base/bytes.h"
#include "pleat/base/file.h"

namespace pleat {
namespace {

// Writes the faces. The lengths of lists are uint8 unless a polygon is too large for that.
class FaceWriter {
 public:
  FaceWriter(const Topology& topology, const MeshAppearance& appearance)
      : topology_(topology), appearance_(appearance) {
    for (int f = 0; f < topology.num_faces(); ++f) {
      wide_lists_ |= 2 * topology.face(f).size() > 255;
    }
  }

  std::string Header() const {
    const char* size_type = wide_lists_ ? "uint" : "uchar";
    std::string text = absl::StrCat("element face ", topology_.num_faces(), "\nproperty list ",
                                    size_type, " int vertex_indices\n");
    if (HasTexcoords()) absl::StrAppend(&text, "property list ", size_type, " float texcoord\n");
    return text;
  }

  void WriteBody(ByteWriter* writer) const {
    for (int f = 0; f < topology_.num_faces(); ++f) {
      const std::span<const int32_t> corners = topology_.face(f);
      WriteSize(corners.size(), writer);
      writer->WriteArray(corners);
      if (HasTexcoords()) WriteTexcoords(f, corners.size(), writer);
    }
  }

 private:
  bool HasTexcoords() const { return !appearance_.corner_texcoords.empty(); }

  void WriteSize(size_t size, ByteWriter* writer) const {
    if (wide_lists_) {
      writer->Write(static_cast<uint32_t>(size));
    } else {
      writer->Write(static_cast<uint8_t>(size));
    }
  }

  void WriteTexcoords(int f, size_t num_corners, ByteWriter* writer) const {
    const auto texcoords = std::span(appearance_.corner_texcoords)
                               .subspan(static_cast<size_t>(topology_.face_start(f)), num_corners);
    const bool complete =
        std::none_of(texcoords.begin(), texcoords.end(), [](int32_t index) { return index < 0; });
    WriteSize(complete ? 2 * num_corners : 0, writer);
    for (size_t c = 0; complete && c < num_corners; ++c) {
      const Eigen::Vector2f& uv = appearance_.texcoords[static_cast<size_t>(texcoords[c])];
      writer->Write(uv.x());
      writer->Write(uv.y());
    }
  }

  const Topology& topology_;
  const MeshAppearance& appearance_;
  bool wide_lists_ = false;
};

}  // namespace

std::string EncodePly(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance) {
  const FaceWriter faces(topology, appearance);
  ByteWriter writer;
  writer.WriteRaw(absl::StrCat(
      "ply\nformat binary_little_endian 1.0\nelement vertex ", positions.cols(),
      "\nproperty float x\nproperty float y\nproperty float z\n", faces.Header(), "end_header\n"));
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    for (int axis = 0; axis < 3; ++axis) writer.Write(positions(axis, v));
  }
  faces.WriteBody(&writer);
  return writer.Release();
}

absl::Status WritePly(const std::string& path, const Topology& topology,
                      const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance) {
  return WriteFile(path, EncodePly(topology, positions, appearance));
}

}  // namespace pleat
