#include "pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "client/remote/scripted_server.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class PagesTest : public testing::Test {
 protected:
  // A script of one call: a page of the jobs `ids`, and the token of the next one.
  auto Page(std::vector<std::string> ids, const std::string& next) {
    return [this, ids, next](grpc::ServerContext*, const v1::ListJobsRequest* request,
                             v1::ListJobsResponse* response) {
      tokens_.push_back(request->page_token());
      for (const std::string& id : ids) {
        JobInfo info;
        info.id = id;
        *response->add_jobs() = ToProto(info);
      }
      response->set_next_page_token(next);
      return grpc::Status::OK;
    };
  }
  std::vector<std::string> Ids() {
    std::vector<std::string> ids;
    const absl::StatusOr<std::vector<JobInfo>> jobs = server_.Open()->jobs().List();
    for (const JobInfo& job : *jobs) ids.push_back(job.id);
    return ids;
  }

  std::vector<std::string> tokens_;
  ScriptedServer server_;
};

TEST_F(PagesTest, AreReadToTheLastOneInTheOrderOfTheServer) {
  EXPECT_CALL(server_.jobs, ListJobs)
      .WillOnce(Page({"c", "a"}, "second"))
      .WillOnce(Page({}, "third"))  // empty, but not the last
      .WillOnce(Page({"b"}, ""));
  EXPECT_THAT(Ids(), ElementsAre("c", "a", "b"));
  EXPECT_THAT(tokens_, ElementsAre("", "second", "third"));
}

TEST_F(PagesTest, AServerThatRepeatsItselfIsNotAskedForEver) {
  EXPECT_CALL(server_.jobs, ListJobs).WillOnce(Page({"a"}, "same")).WillOnce(Page({"b"}, "same"));
  EXPECT_THAT(Ids(), ElementsAre("a", "b"));
}

TEST_F(PagesTest, OnePageIsOneCall) {
  EXPECT_CALL(server_.jobs, ListJobs)
      .WillOnce([](auto*, const v1::ListJobsRequest* request, v1::ListJobsResponse* response) {
        EXPECT_EQ(request->page_size(), 7);
        EXPECT_EQ(request->page_token(), "here");
        response->set_next_page_token("there");
        return grpc::Status::OK;
      });
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto page, server_.Open()->jobs().ListPage({7, "here"}));
  EXPECT_TRUE(page.items.empty());
  EXPECT_EQ(page.next_token, "there");
}

TEST_F(PagesTest, HalfAListIsNoList) {
  EXPECT_CALL(server_.jobs, ListJobs)
      .WillOnce(Page({"a"}, "next"))
      .WillOnce(testing::Return(Refusal()));
  EXPECT_THAT(server_.Open()->jobs().List(),
              HasStatus(absl::StatusCode::kPermissionDenied, "not today"));
  EXPECT_CALL(server_.jobs, ListJobs).WillOnce(Page({"a", ""}, ""));
  EXPECT_THAT(server_.Open()->jobs().List(),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("job.id")));
}

TEST_F(PagesTest, EveryListOfTheServiceIsRead) {
  EXPECT_CALL(server_.models, ListModels).WillOnce([](auto*, auto*, auto* response) {
    ModelInfo info;
    info.skeleton = Skeleton::Create({{"hips", -1, {0, 1, 0}}}).value();
    info.id = std::string(64, 'a');
    info.frame_rate = {25, 1};
    *response->add_models() = ToProto(info);
    return grpc::Status::OK;
  });
  EXPECT_CALL(server_.sequences, ListSequences).WillOnce([](auto*, auto*, auto* response) {
    SequenceInfo info;
    info.id = std::string(64, 'b');
    info.num_frames = info.num_vertices = 3;
    *response->add_sequences() = ToProto(info);
    return grpc::Status::OK;
  });
  EXPECT_CALL(server_.compressed, ListCompressedSequences)
      .WillOnce([](auto*, auto*, auto* response) {
        CompressedSequenceInfo info;
        info.id = std::string(64, 'c');
        info.num_frames = info.num_vertices = 3;
        *response->add_compressed_sequences() = ToProto(info);
        return grpc::Status::OK;
      });
  const auto client = server_.Open();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto models, client->models().List());
  EXPECT_EQ(models.at(0).id, std::string(64, 'a'));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto sequences, client->sequences().List());
  EXPECT_EQ(sequences.at(0).id, std::string(64, 'b'));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto compressed, client->compressed_sequences().List());
  EXPECT_EQ(compressed.at(0).id, std::string(64, 'c'));
}

}  // namespace
}  // namespace pleat
