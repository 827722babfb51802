#include "pleat/reactors/download_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <string>

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
    context_.max_open_streams = 1;
    for (size_t i = 0; i < file_.size(); ++i) file_[i] = static_cast<char>(i * 7);
    executor_.Release();
  }
  void Start(uint64_t offset = 0) {
    call_.emplace(StartDownload<Response>(
        &context_, std::string(64, 'a'), offset,
        {.rpc = "Test",
         .size_of = [this](const std::string&) -> absl::StatusOr<uint64_t> { return file_.size(); },
         .read = [this](const std::string&, uint64_t begin,
                        uint64_t count) -> absl::StatusOr<std::string> {
           on_read_();
           ++num_reads_;
           return file_.substr(begin, count);
         }}));
  }
  void ExpectEnd(grpc::StatusCode code) {
    EXPECT_EQ(call_->WaitForEnd().error_code(), code);
    context_.open_calls.WaitUntilNone();
  }

  HandlerContext context_;
  std::string file_ = std::string(2 * kDownloadChunkBytes + 5, '\0');
  std::function<void()> on_read_ = [] {};
  int num_reads_ = 0;
  HeldExecutor executor_;
  std::optional<FakeWriteCall<Response>> call_;
};

TEST_F(DownloadStreamTest, SendsTheRestOfTheFileFromAnyOffset) {
  for (const uint64_t offset : {uint64_t{0}, uint64_t{3}, kDownloadChunkBytes, uint64_t{1048580}}) {
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
  context_.draining = true;
  for (int i = 0; i < 3; ++i) call_->Receive();
  ExpectEnd(grpc::StatusCode::OK);
}

}  // namespace
}  // namespace pleat
