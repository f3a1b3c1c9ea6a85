// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/host_lock.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime::host_lock_test {
namespace {

TEST(HostLockTest, ANameHasOneOwnerUntilItEnds) {
  const std::string name = "test-" + std::to_string(getpid());
  {
    const HostLock first(name, "a platform");
    EXPECT_THROW(HostLock(name, "a platform"), ConfigError);
    const HostLock other(name + "-other", "another platform");
  }
  EXPECT_NO_THROW(HostLock(name, "a platform"));
}

}  // namespace
}  // namespace stillhand::runtime::host_lock_test
