#include "pleat/observe/request_scope.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "pleat/base/random_id.h"

namespace pleat {
namespace {

constexpr size_t kMaxIdBytes = 64;

const std::string kNone;
thread_local const std::string* current_id = &kNone;

}  // namespace

const std::string& CurrentRequestId() { return *current_id; }

RequestScope::RequestScope(const std::string& request_id)
    : outer_(std::exchange(current_id, &request_id)) {}

RequestScope::~RequestScope() { current_id = outer_; }

std::string RequestIdOr(const std::string& chosen) {
  const bool is_good = !chosen.empty() && chosen.size() <= kMaxIdBytes &&
                       std::ranges::all_of(chosen, [](unsigned char c) {
                         return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
                       });
  return is_good ? chosen : RandomHexId(2);
}

}  // namespace pleat
