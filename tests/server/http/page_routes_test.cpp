#include "page_routes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pleat/http/page_files.h"

namespace pleat {
namespace {

std::string HeaderOf(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

TEST(PageRoutesTest, TheStartIsAPageInBothForms) {
  HttpRequest request;
  const HttpResponse plain = AnswerPage("/", request);
  EXPECT_EQ(plain.status, 200);
  EXPECT_EQ(plain.body.substr(0, 15), "<!doctype html>");
  request.headers["accept-encoding"] = "gzip, br";
  const HttpResponse packed = AnswerPage("/", request);
  EXPECT_EQ(HeaderOf(packed, "Content-Encoding"), "gzip");
  EXPECT_EQ(packed.lasting_body.substr(0, 2), "\x1f\x8b");
}

TEST(PageRoutesTest, AKnownFileIsNotSentAgain) {
  HttpRequest request;
  request.headers["if-none-match"] = std::string(PageFiles().front().tag);
  EXPECT_EQ(AnswerPage(std::string(PageFiles().front().path), request).status, 304);
}

TEST(PageRoutesTest, OnlyEmbeddedFilesAreThere) {
  for (const char* path : {"/../main.cpp", "/etc/passwd", "/index", ""}) {
    EXPECT_EQ(AnswerPage(path, {}).status, 404) << path;
  }
}

TEST(PageRoutesTest, NothingForeignRuns) {
  HttpResponse response;
  AddSafetyHeaders(&response);
  const std::string policy = HeaderOf(response, "Content-Security-Policy");
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe-inline"), std::string::npos);
  EXPECT_EQ(policy.find("http"), std::string::npos);
  EXPECT_EQ(HeaderOf(response, "X-Content-Type-Options"), "nosniff");
}

}  // namespace
}  // namespace pleat
