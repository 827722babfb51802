#include "pleat/base/address.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(AddressTest, TheHostIsWhatStandsBeforeThePort) {
  EXPECT_EQ(HostOf("studio.example:7320"), "studio.example");
  EXPECT_EQ(HostOf("[fe80::1]:7320"), "fe80::1");
  EXPECT_EQ(HostOf("[::1]"), "::1");
  EXPECT_EQ(HostOf("::1"), "::1");
  EXPECT_EQ(HostOf("10.0.0.1"), "10.0.0.1");
  EXPECT_EQ(HostOf(":7320"), "");
  EXPECT_EQ(HostOf(""), "");
}

TEST(AddressTest, LocalIsWhatOnlyThisMachineReaches) {
  for (const char* address : {"127.0.0.1:7320", "127.1.2.3:0", "localhost:7320", "localhost",
                              "[::1]:7320", "::1", "unix:/run/pleat/socket"}) {
    EXPECT_TRUE(IsLocalAddress(address)) << address;
  }
  for (const char* address :
       {"0.0.0.0:7320", "[::]:7320", ":7320", "10.0.0.1:7320", "studio.example:7320",
        "localhost.example:1", "7320", "", "127", "[::1", "xunix:/a"}) {
    EXPECT_FALSE(IsLocalAddress(address)) << address;
  }
}

}  // namespace
}  // namespace pleat
