// The studio over a real service.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pleat/formats/sequence_file.h"
#include "pleat/http/studio_server.h"
#include "server/http/http_client.h"
#include "server/running_service.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {

class StudioTest : public testing::Test {
 protected:
  explicit StudioTest(GrpcServerOptions grpc = {}) : running_(Reach::kSocket, {}, grpc) {
    studio_ = StudioServer::Start({.listen = "127.0.0.1:0",
                                   .scratch_dir = running_.data_dir() + "/studio-uploads",
                                   .version = "test"},
                                  &running_.server())
                  .value();
  }
  ~StudioTest() override { studio_->Shutdown(); }

  std::string Ask(const std::string& method, const std::string& target,
                  const std::string& body = "", std::vector<std::string> headers = {}) {
    headers.push_back("X-Pleat-Studio: 1");
    return HttpClient::Ask(studio_->address(), method, target, headers, body);
  }
  nlohmann::json Json(const std::string& method, const std::string& target,
                      const std::string& body = "") {
    const std::string response = Ask(method, target, body);
    EXPECT_EQ(HttpClient::StatusOf(response), 200) << response;
    return nlohmann::json::parse(HttpClient::BodyOf(response), nullptr, false);
  }
  nlohmann::json Call(const std::string& rpc,
                      const nlohmann::json& request = nlohmann::json::object()) {
    return Json("POST", "/rpc/" + rpc, request.dump());
  }
  nlohmann::json UploadTube(int num_frames = 5) {
    const std::string id = Json("POST", "/studio/uploads")["id"];
    const std::string bytes = EncodeSequence(MakeSwayingTube(num_frames));
    EXPECT_EQ(HttpClient::StatusOf(Ask("PUT", "/studio/uploads/" + id + "?path=tube.pseq", bytes)),
              200);
    return Json("POST", "/studio/uploads/" + id + "?name=my%20tube");
  }
  // A chunked body, put together.
  static std::string Dechunk(const std::string& body) {
    std::string bytes;
    for (size_t at = 0; at < body.size();) {
      const size_t size = std::stoul(body.substr(at), nullptr, 16);
      at = body.find("\r\n", at) + 2;
      bytes += body.substr(at, size);
      at += size + 2;
      if (size == 0) break;
    }
    return bytes;
  }

  RunningService running_;
  std::unique_ptr<StudioServer> studio_;
};

}  // namespace pleat
