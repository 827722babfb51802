// What the tests of handlers share: handlers alone, with mocks of the services.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pleat/handlers/unary_handlers.h"
#include "support/mock_services.h"
#include "support/status_matchers.h"

namespace pleat {

inline const std::string kId(64, 'a');
inline const std::string kPathId = "../" + std::string(61, 'a');  // as long as an id

// The context of a handler; every call of a service that a test does not expect fails it.
struct MockContext {
  testing::StrictMock<MockSequenceService> sequences;
  testing::StrictMock<MockJobService> jobs;
  testing::StrictMock<MockModelService> models;
  testing::StrictMock<MockPoseService> poses;
  testing::StrictMock<MockCompressedSequenceService> compressed_sequences;
  HandlerContext context;

  MockContext() {
    context.sequences = &sequences;
    context.jobs = &jobs;
    context.models = &models;
    context.poses = &poses;
    context.compressed_sequences = &compressed_sequences;
  }
};

// Five infos whose ids are a run of one letter.
template <typename Info>
std::vector<Info> FiveInfos() {
  std::vector<Info> infos(5);
  for (size_t i = 0; i < infos.size(); ++i) {
    infos[i].id = std::string(64, static_cast<char>('a' + i));
  }
  return infos;
}

// That `list` gives the five infos above in pages. ids_of: the ids of a reply.
template <typename Request, typename Response, typename List, typename IdsOf>
void ExpectPages(List list, IdsOf ids_of) {
  const std::string a(64, 'a'), b(64, 'b'), c(64, 'c'), d(64, 'd'), e(64, 'e');
  Response all;
  ASSERT_THAT(list(Request(), &all), IsOk());
  EXPECT_THAT(ids_of(all), testing::ElementsAre(a, b, c, d, e));
  EXPECT_EQ(all.next_page_token(), "");

  Request request;
  request.set_page_size(2);
  std::vector<std::string> ids;
  int num_pages = 0;
  do {
    Response page;
    ASSERT_THAT(list(request, &page), IsOk());
    for (const std::string& id : ids_of(page)) ids.push_back(id);
    request.set_page_token(page.next_page_token());
    ++num_pages;
  } while (!request.page_token().empty());
  EXPECT_THAT(ids, testing::ElementsAre(a, b, c, d, e));
  EXPECT_EQ(num_pages, 3);

  Response refused;
  request.set_page_token("no such item");
  EXPECT_THAT(list(request, &refused),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("page_token")));
  for (const int size : {-1, 501}) {
    Request wrong;
    wrong.set_page_size(size);
    EXPECT_THAT(list(wrong, &refused),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("page_size")));
  }
}

}  // namespace pleat
