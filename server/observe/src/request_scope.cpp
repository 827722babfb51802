#include "pleat/observe/request_scope.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "pleat/base/random_id.h"

namespace pleat {
namespace {

constexpr size_t kMaxIdBytes = 64;

const RequestTag kNone;
thread_local const RequestTag* current_request = &kNone;

}  // namespace

const RequestTag& CurrentRequest() { return *current_request; }

RequestScope::RequestScope(const RequestTag& request)
    : outer_(std::exchange(current_request, &request)) {}

RequestScope::~RequestScope() { current_request = outer_; }

std::string RequestIdOr(const std::string& chosen) {
  const bool is_good = !chosen.empty() && chosen.size() <= kMaxIdBytes &&
                       std::ranges::all_of(chosen, [](unsigned char c) {
                         return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
                       });
  return is_good ? chosen : RandomHexId(2);
}

}  // namespace pleat
