#include "pleat/base/random_id.h"

#include <random>

#include "absl/strings/str_format.h"

namespace pleat {

std::string RandomHexId(int num_words) {
  std::random_device device;
  std::string id;
  for (int i = 0; i < num_words; ++i) absl::StrAppendFormat(&id, "%08x", device());
  return id;
}

}  // namespace pleat
