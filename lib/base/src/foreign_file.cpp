#include "pleat/base/foreign_file.h"

#include <algorithm>
#include <fstream>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

constexpr size_t kNumSniffedBytes = 512;

struct Signature {
  std::string_view bytes;  // at the start of the file
  const char* description;
};

// In the order of the table; the first that fits counts.
constexpr Signature kSignatures[] = {
    {"version https://git-lfs",
     "a Git LFS pointer, not the file itself: run 'git lfs pull' in its repository"},
    {"/annex/objects/",
     "a git-annex pointer, not the file itself: run 'git annex get' in its repository"},
    {"\xff\xfe", "UTF-16 text: save it as UTF-8 or ASCII"},
    {"\xfe\xff", "UTF-16 text: save it as UTF-8 or ASCII"},
    {"\x89HDF\r\n\x1a\n",
     "an HDF5 file (Alembic files of before 2013 are): convert it with 'abcconvert -toOgawa', or "
     "export it as Ogawa, OBJ, PLY or .pc2"},
    {"Ogawa", "an Alembic (Ogawa) archive: give its name the ending .abc"},
    {"Kaydara FBX", "an FBX file: export it as OBJ, PLY or .pc2"},
    {"glTF", "a binary glTF file (GLB): give it the ending .glb"},
    {"BLENDER", "a Blender file: export it as OBJ, PLY or .pc2"},
    {"PXR-USDC", "a USD file: export it as OBJ, PLY or .pc2"},
    {"#usda", "a USD file: export it as OBJ, PLY or .pc2"},
    {"solid ", "an STL file: export it as OBJ or PLY, which keep shared vertices"},
    {"PK\x03\x04", "a ZIP archive: unpack it first"},
    {"\x1f\x8b", "a gzip archive: unpack it first"},
    {"7z\xbc\xaf\x27\x1c", "a 7z archive: unpack it first"},
    {"\xfd"
     "7zXZ",
     "an xz archive: unpack it first"},
    {"<!DOCTYPE", "an HTML page, as a failed download leaves: fetch the file again"},
    {"<html", "an HTML page, as a failed download leaves: fetch the file again"},
};

// Half of the bytes of ASCII text in UTF-16 are zero, always at the same side.
bool LooksLikeUtf16(std::string_view bytes) {
  const size_t num_pairs = std::min<size_t>(bytes.size(), 64) / 2;
  if (num_pairs < 4) return false;
  size_t num_even = 0, num_odd = 0;
  for (size_t i = 0; i < num_pairs; ++i) {
    num_even += bytes[2 * i] == '\0';
    num_odd += bytes[2 * i + 1] == '\0';
  }
  return (num_even == num_pairs && num_odd == 0) || (num_odd == num_pairs && num_even == 0);
}

}  // namespace

std::string DescribeForeignBytes(std::string_view bytes) {
  for (const Signature& signature : kSignatures) {
    if (bytes.starts_with(signature.bytes)) return signature.description;
  }
  return LooksLikeUtf16(bytes) ? "UTF-16 text: save it as UTF-8 or ASCII" : "";
}

absl::Status RefuseForeignBytes(std::string_view bytes, std::string_view file) {
  const std::string description = DescribeForeignBytes(bytes);
  if (description.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(std::string(file), ": this is ", description));
}

absl::Status RefuseForeignFile(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  char bytes[kNumSniffedBytes];
  stream.read(bytes, sizeof(bytes));
  return RefuseForeignBytes(std::string_view(bytes, static_cast<size_t>(stream.gcount())), path);
}

}  // namespace pleat
