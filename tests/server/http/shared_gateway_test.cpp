#include "shared_gateway.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

// Remembers for whom a call was made.
class RememberingGateway final : public CallGateway {
 public:
  std::unique_ptr<GatewayCall> Start(const std::string& method,
                                     const ForeignCaller& caller) override {
    last_method = method;
    last_caller = caller;
    return nullptr;
  }
  std::shared_ptr<DuplexCall> Open(const std::string& method, const ForeignCaller& caller,
                                   DuplexListener) override {
    last_method = method;
    last_caller = caller;
    return nullptr;
  }
  std::string last_method;
  ForeignCaller last_caller;
};

TEST(SharedGatewayTest, EveryCallSaysWhatIsShared) {
  RememberingGateway behind;
  SharedGateway gateway(&behind, "model,take");
  gateway.Start("/a", {.token = "t", .peer = "ipv4:1.2.3.4:5", .request_id = "r"});
  EXPECT_EQ(behind.last_method, "/a");
  EXPECT_EQ(behind.last_caller.shared, "model,take");
  EXPECT_EQ(behind.last_caller.token, "t");
  EXPECT_EQ(behind.last_caller.peer, "ipv4:1.2.3.4:5");
  EXPECT_EQ(behind.last_caller.request_id, "r");
  gateway.Open("/b", {.shared = "everything"}, {});
  EXPECT_EQ(behind.last_method, "/b");
  EXPECT_EQ(behind.last_caller.shared, "model,take");
}

TEST(SharedGatewayTest, NothingIsSharedUnlessItIsAskedFor) {
  RememberingGateway behind;
  SharedGateway(&behind, "").Start("/a", {});
  EXPECT_TRUE(behind.last_caller.shared.empty());
}

}  // namespace
}  // namespace pleat
