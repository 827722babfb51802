#include "pleat/v1/pose_service.pb.h"
#include "server/http/studio_fixture.h"

namespace pleat {
namespace {

using testing::HasSubstr;

using LiveSocketTest = StudioTest;

TEST_F(LiveSocketTest, PosesAreAnsweredOverAWebSocket) {
  const std::string model = running_.TrainModel();
  HttpClient client(studio_->address());
  client.Send(absl::StrCat("GET /live HTTP/1.1\r\nHost: ", studio_->address(),
                           "\r\nUpgrade: websocket\r\n",
                           "Connection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n",
                           "Sec-WebSocket-Version: 13\r\n\r\n"));
  ASSERT_THAT(client.ReadUntil("\r\n\r\n"), HasSubstr("101"));
  const auto frame = [](char kind, const std::string& bytes) {
    return std::string{kind, static_cast<char>(0x80 | bytes.size())} + std::string(4, '\0') + bytes;
  };
  client.Send(frame('\x81', R"({"token":""})"));
  v1::LiveSessionRequest start;
  start.mutable_start()->mutable_character()->set_model_id(model);
  client.Send(frame('\x82', start.SerializeAsString()));
  // Field 1 of the response is the header; its topology is a Draco mesh.
  EXPECT_THAT(client.ReadUntil("DRACO"), HasSubstr("DRACO"));
  v1::LiveSessionRequest wrong;
  wrong.mutable_start();  // a second start makes no sense
  client.Send(frame('\x82', wrong.SerializeAsString()));
  EXPECT_THAT(client.ReadUntil("INVALID_ARGUMENT"), HasSubstr("INVALID_ARGUMENT"));
}

}  // namespace
}  // namespace pleat
