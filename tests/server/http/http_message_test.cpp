#include "pleat/http/http_message.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "pleat/base/limit_refusal.h"

namespace pleat {
namespace {

TEST(HttpMessageTest, ErrorsSayTheirCodeAndWords) {
  const HttpResponse response = ErrorResponse(absl::NotFoundError("there is no \xff model"));
  EXPECT_EQ(response.status, 404);
  const auto json = nlohmann::json::parse(response.body);
  EXPECT_EQ(json["code"], "NOT_FOUND");
  EXPECT_NE(std::string(json["message"]).find("model"), std::string::npos);
}

TEST(HttpMessageTest, ALimitSaysWhenToComeAgain) {
  const HttpResponse later =
      ErrorResponse(RefuseForLimit({.retry_after = absl::Seconds(1.5)}, "busy"));
  EXPECT_EQ(later.status, 429);
  EXPECT_EQ(later.headers.back(), (std::pair<std::string, std::string>("Retry-After", "2")));
  EXPECT_EQ(ErrorResponse(RefuseForLimit({}, "too large")).status, 413);
}

}  // namespace
}  // namespace pleat
