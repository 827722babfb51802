// Which request a thread works for, so that every line that it logs meanwhile can say so.
#pragma once

#include <string>

namespace pleat {

// What every line about a request says.
struct RequestTag {
  std::string id{};       // empty: none
  std::string project{};  // of the caller, once it was let in
};

// The request that this thread works for.
const RequestTag& CurrentRequest();
inline const std::string& CurrentRequestId() { return CurrentRequest().id; }

// Says so as long as it lives, which must be no longer than the tag does. Scopes of one thread are
// nested. They copy nothing: there is one around each piece of work.
class RequestScope {
 public:
  explicit RequestScope(const RequestTag& request);
  explicit RequestScope(RequestTag&& request) = delete;
  ~RequestScope();
  RequestScope(const RequestScope&) = delete;
  RequestScope& operator=(const RequestScope&) = delete;

 private:
  const RequestTag* const outer_;
};

// The id that a client chose for its request, when it can stand in a log: 1 to 64 letters, digits,
// '-',
// '_' and '.'. Otherwise a new one, at random.
std::string RequestIdOr(const std::string& chosen);

}  // namespace pleat
