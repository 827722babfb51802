#include "file_name.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(FileNameTest, NamesAreEscaped) {
  HttpResponse response;
  OfferAs(*ParseTarget("/x?save=t%C3%A4nzer%22%3B%20a.glb"), &response);
  ASSERT_EQ(response.headers.size(), 1u);
  EXPECT_EQ(response.headers[0].second, "attachment; filename*=UTF-8''t%C3%A4nzer%22%3B%20a.glb");
  HttpResponse plain;
  OfferAs(*ParseTarget("/x"), &plain);
  EXPECT_TRUE(plain.headers.empty());
}

}  // namespace
}  // namespace pleat
