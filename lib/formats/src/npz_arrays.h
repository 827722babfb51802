// The arrays of a NumPy archive by what they hold.
#pragma once

#include <deque>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "npy_array.h"
#include "pleat/formats/npz.h"
#include "zip_archive.h"

namespace pleat {

// What an array may hold, and the names that it may have.
struct NpzRole {
  const char* name;                      // as in NpzKeys, and the name that Pleat writes
  std::string NpzKeys::*key;             // what the user calls it
  std::vector<std::string_view> others;  // what other programs call it
};
const std::vector<NpzRole>& NpzRoles();

class NpzArrays {
 public:
  // The bytes must outlive it.
  static absl::StatusOr<NpzArrays> Open(std::string_view bytes, const NpzKeys& keys);

  // The array with this role, none when there is none. kInvalidArgument names the arrays that are
  // there when the user's name is not among them. Its bytes live as long as this object.
  absl::StatusOr<std::optional<NpyArray>> Take(const NpzRole& role, uint64_t max_bytes);
  // The array of that very name.
  absl::StatusOr<std::optional<NpyArray>> TakeNamed(const std::string& name, uint64_t max_bytes);
  // The only array of floats of shape (T, V, 3), whatever its name.
  absl::StatusOr<std::optional<NpyArray>> TakeOnlyAnimation(uint64_t max_bytes);

  // "'verts' float32 (175, 10002, 3), 'faces' ..." of all arrays.
  std::string List() const;
  // What was taken under another name than Pleat's, or nothing; and what was not taken at all.
  const std::vector<std::string>& renamed() const { return renamed_; }
  std::vector<std::string> NotTaken() const;

 private:
  std::optional<NpyArray> HeaderOf(const ZipMember& member) const;

  NpzKeys keys_;
  ZipArchive archive_;
  std::deque<std::string> inflated_;
  std::vector<std::string> renamed_;
  std::set<std::string> taken_;
};

}  // namespace pleat
