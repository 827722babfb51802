#include "npz_arrays.h"

#include <algorithm>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "npy_header.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr std::string_view kEnding = ".npy";
constexpr size_t kMaxListedMembers = 12;
constexpr uint64_t kHeaderStart = 4096;  // a header of NumPy has some hundred bytes

std::string ArrayName(const ZipMember& member) {
  const std::string_view name = member.name;
  return std::string(name.ends_with(kEnding) ? name.substr(0, name.size() - kEnding.size()) : name);
}

std::string QuotedName(const std::string& name) {
  return absl::StrCat("'", EscapeControls(name), "'");
}

bool IsAnimation(const NpyArray& array) {
  return array.is_float() && array.shape.size() == 3 && array.shape[2] == 3;
}

}  // namespace

const std::vector<NpzRole>& NpzRoles() {
  static const std::vector<NpzRole>& roles = *new std::vector<NpzRole>{
      {"positions", &NpzKeys::positions, {"vertices", "verts", "points", "xyz", "v"}},
      {"faces", &NpzKeys::faces, {"triangles", "tris", "polygons", "f"}},
      {"face_sizes", &NpzKeys::face_sizes, {"face_counts"}},
      {"frame_rate", &NpzKeys::frame_rate, {"fps", "mocap_frame_rate", "mocap_framerate"}}};
  return roles;
}

absl::StatusOr<NpzArrays> NpzArrays::Open(std::string_view bytes, const NpzKeys& keys) {
  NpzArrays arrays;
  arrays.keys_ = keys;
  PLEAT_ASSIGN_OR_RETURN(arrays.archive_, ZipArchive::Open(bytes));
  return arrays;
}

absl::StatusOr<std::optional<NpyArray>> NpzArrays::TakeNamed(const std::string& name,
                                                             uint64_t max_bytes) {
  const ZipMember* member = archive_.Find(absl::StrCat(name, std::string(kEnding)));
  if (member == nullptr) return std::optional<NpyArray>();
  const std::string where = absl::StrCat("array ", QuotedName(name));
  absl::StatusOr<std::string_view> bytes =
      archive_.Read(*member, max_bytes, &inflated_.emplace_back());
  if (!bytes.ok()) return WithContext(where, bytes.status());
  absl::StatusOr<NpyArray> array = ParseNpy(*bytes);
  if (!array.ok()) return WithContext(where, array.status());
  taken_.insert(name);
  return std::optional<NpyArray>(*std::move(array));
}

absl::StatusOr<std::optional<NpyArray>> NpzArrays::Take(const NpzRole& role, uint64_t max_bytes) {
  const std::string& wanted = keys_.*role.key;
  if (!wanted.empty()) {
    PLEAT_ASSIGN_OR_RETURN(std::optional<NpyArray> array, TakeNamed(wanted, max_bytes));
    if (array) return array;
    return absl::InvalidArgumentError(absl::StrCat("there is no array ", QuotedName(wanted),
                                                   " for the ", role.name, "; there are ", List()));
  }
  PLEAT_ASSIGN_OR_RETURN(std::optional<NpyArray> array, TakeNamed(role.name, max_bytes));
  for (size_t i = 0; i < role.others.size() && !array; ++i) {
    const std::string other(role.others[i]);
    PLEAT_ASSIGN_OR_RETURN(array, TakeNamed(other, max_bytes));
    if (array) renamed_.push_back(absl::StrCat(role.name, " from ", QuotedName(other)));
  }
  return array;
}

absl::StatusOr<std::optional<NpyArray>> NpzArrays::TakeOnlyAnimation(uint64_t max_bytes) {
  std::vector<std::string> names;
  for (const ZipMember& member : archive_.members()) {
    const std::optional<NpyArray> header = HeaderOf(member);
    if (header && IsAnimation(*header)) names.push_back(ArrayName(member));
  }
  if (names.size() != 1) return std::optional<NpyArray>();
  renamed_.push_back(absl::StrCat("positions from ", QuotedName(names[0])));
  return TakeNamed(names[0], max_bytes);
}

std::optional<NpyArray> NpzArrays::HeaderOf(const ZipMember& member) const {
  const std::string start = archive_.Start(member, kHeaderStart);
  size_t num_bytes = 0;
  absl::StatusOr<NpyArray> header = ParseNpyHeader(start, &num_bytes);
  if (!header.ok()) return std::nullopt;
  return *std::move(header);
}

std::string NpzArrays::List() const {
  std::string list;
  const std::vector<ZipMember>& members = archive_.members();
  for (size_t i = 0; i < std::min(members.size(), kMaxListedMembers); ++i) {
    const std::optional<NpyArray> header = HeaderOf(members[i]);
    absl::StrAppend(&list, i > 0 ? ", " : "", QuotedName(ArrayName(members[i])), " ",
                    header ? DescribeNpy(*header) : "(no array of numbers)");
  }
  if (members.size() > kMaxListedMembers)
    absl::StrAppend(&list, ", ... (", members.size(), " in all)");
  return list.empty() ? "no arrays" : list;
}

std::vector<std::string> NpzArrays::NotTaken() const {
  std::vector<std::string> names;
  for (const ZipMember& member : archive_.members()) {
    if (taken_.count(ArrayName(member)) > 0) continue;
    if (names.size() == kMaxListedMembers) {
      names.push_back("...");
      break;
    }
    names.push_back(QuotedName(ArrayName(member)));
  }
  return names;
}

}  // namespace pleat
