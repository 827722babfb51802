#include "request_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

class RequestGuardTest : public testing::Test {
 protected:
  absl::Status Check(RequestKind kind, std::map<std::string, std::string> headers) {
    HttpRequest request;
    headers.emplace("host", "127.0.0.1:7321");
    request.headers = std::move(headers);
    return CheckRequest(request, kind, HostsOf("127.0.0.1:7321", {"Studio.Example.com"}));
  }
  static auto Refused(const char* words) {
    return HasStatus(absl::StatusCode::kPermissionDenied, HasSubstr(words));
  }
};

TEST_F(RequestGuardTest, ThePageAndItsOwnCallsAreLetIn) {
  EXPECT_THAT(Check(RequestKind::kPage, {}), IsOk());
  EXPECT_THAT(Check(RequestKind::kCall, {{kCallMarker, "1"},
                                         {"origin", "http://127.0.0.1:7321"},
                                         {"sec-fetch-site", "same-origin"}}),
              IsOk());
  EXPECT_THAT(Check(RequestKind::kSocket, {{"origin", "http://127.0.0.1:7321"}}), IsOk());
  EXPECT_THAT(Check(RequestKind::kCall, {{kCallMarker, "1"},
                                         {"host", "studio.example.com"},
                                         {"origin", "https://studio.example.com"}}),
              IsOk());
  EXPECT_THAT(Check(RequestKind::kPage, {{"host", "localhost:7321"}}), IsOk());
}

TEST_F(RequestGuardTest, AForeignPageCannotUseIt) {
  for (const char* origin : {"http://evil.example", "null", "http://127.0.0.1:7322",
                             "http://127.0.0.1:7321.evil.example", "file://"}) {
    for (const RequestKind kind : {RequestKind::kCall, RequestKind::kSocket}) {
      EXPECT_THAT(Check(kind, {{kCallMarker, "1"}, {"origin", origin}}), Refused("may not use"))
          << origin;
    }
  }
  EXPECT_THAT(Check(RequestKind::kCall, {{kCallMarker, "1"}, {"sec-fetch-site", "cross-site"}}),
              Refused("may not use"));
  EXPECT_THAT(Check(RequestKind::kCall, {{"origin", "http://127.0.0.1:7321"}}),
              Refused(kCallMarker));
}

TEST_F(RequestGuardTest, AForeignNameThatPointsHereIsRefused) {
  for (const RequestKind kind : {RequestKind::kPage, RequestKind::kCall, RequestKind::kSocket}) {
    EXPECT_THAT(Check(kind, {{kCallMarker, "1"}, {"host", "evil.example:7321"}}),
                Refused("does not answer for"));
    EXPECT_THAT(Check(kind, {{kCallMarker, "1"}, {"host", ""}}), Refused("does not answer for"));
  }
}

}  // namespace
}  // namespace pleat
