#include "pleat/reactors/download_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <optional>
#include <string>

#include "pleat/service/limits.h"
#include "pleat/v1/model_service.pb.h"
#include "server/reactors/fake_call.h"
#include "support/checkpoint.h"
#include "support/held_executor.h"

namespace pleat {
namespace {

using Response = v1::DownloadModelResponse;

class DownloadStreamTest : public testing::Test {
 protected:
  DownloadStreamTest() {
    spdlog::set_level(spdlog::level::off);
    context_.transfer_executor = executor_.get();
    context_.calls->max_open_streams = 1;
    for (size_t i = 0; i < file_.size(); ++i) file_[i] = static_cast<char>(i * 7);
    executor_.Release();
  }
  class Download final : public ContentDownload {
   public:
    Download(DownloadStreamTest* test, uint64_t offset) : test_(test), offset_(offset) {}
    uint64_t size_bytes() const override { return test_->file_.size(); }
    absl::StatusOr<std::string> Next() override {
      test_->on_read_();
      ++test_->num_reads_;
      std::string bytes = test_->file_.substr(offset_, kDownloadPieceBytes);
      offset_ += bytes.size();
      return bytes;
    }

   private:
    DownloadStreamTest* const test_;
    uint64_t offset_;
  };

  void Start(uint64_t offset = 0) {
    call_.emplace(StartDownload<Response>(&context_, std::string(64, 'a'), offset,
                                          {.rpc = "Test",
                                           .open = [this](const std::string&, uint64_t offset_bytes)
                                               -> absl::StatusOr<std::unique_ptr<ContentDownload>> {
                                             return std::make_unique<Download>(this, offset_bytes);
                                           }}));
  }
  void ExpectEnd(grpc::StatusCode code) {
    EXPECT_EQ(call_->WaitForEnd().error_code(), code);
    context_.calls->open_calls.WaitUntilNone();
  }

  HandlerContext context_;
  std::string file_ = std::string(2 * kDownloadPieceBytes + 5, '\0');
  std::function<void()> on_read_ = [] {};
  int num_reads_ = 0;
  HeldExecutor executor_;
  std::optional<FakeWriteCall<Response>> call_;
};

TEST_F(DownloadStreamTest, SendsTheRestOfTheFileFromAnyOffset) {
  for (const uint64_t offset :
       {uint64_t{0}, uint64_t{3}, uint64_t{kDownloadPieceBytes}, uint64_t{1048580}}) {
    Start(offset);
    std::string bytes;
    while (offset + bytes.size() < file_.size()) {
      const Response part = call_->Receive();
      EXPECT_EQ(part.offset_bytes(), offset + bytes.size());
      EXPECT_EQ(part.size_bytes(), file_.size());
      bytes += part.data();
    }
    ExpectEnd(grpc::StatusCode::OK);
    EXPECT_TRUE(bytes == file_.substr(offset));
  }
}

TEST_F(DownloadStreamTest, CancelledWhileItWritesItReadsNoFurther) {
  Start();
  call_->WaitForWrite();
  call_->Cancel();
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(num_reads_, 1);
}

TEST_F(DownloadStreamTest, AClientThatIsGoneWhileTheDiskIsReadCostsOneRead) {
  Checkpoint reading;
  on_read_ = [&] { reading.Pass(); };
  Start();
  reading.WaitUntilReached();
  call_->Cancel();
  reading.Release();
  call_->EndWrite(false);
  ExpectEnd(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(num_reads_, 1);
}

TEST_F(DownloadStreamTest, AServerThatDrainsLetsItGoOnToItsEnd) {
  Start();
  call_->WaitForWrite();
  context_.calls->draining = true;
  for (int i = 0; i < 3; ++i) call_->Receive();
  ExpectEnd(grpc::StatusCode::OK);
}

}  // namespace
}  // namespace pleat
