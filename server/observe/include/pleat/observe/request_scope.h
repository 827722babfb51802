// Which request a thread works for, so that every line that it logs meanwhile can say so.
#pragma once

#include <string>

namespace pleat {

// The id of the request that this thread works for; empty: none.
const std::string& CurrentRequestId();

// Says so as long as it lives, which must be no longer than the id does. Scopes of one thread are
// nested. They copy nothing: there is one around each piece of work.
class RequestScope {
 public:
  explicit RequestScope(const std::string& request_id);
  explicit RequestScope(std::string&& request_id) = delete;
  ~RequestScope();
  RequestScope(const RequestScope&) = delete;
  RequestScope& operator=(const RequestScope&) = delete;

 private:
  const std::string* const outer_;
};

// The id that a client chose for its request, when it can stand in a log: 1 to 64 letters, digits,
// '-',
// '_' and '.'. Otherwise a new one, at random.
std::string RequestIdOr(const std::string& chosen);

}  // namespace pleat
