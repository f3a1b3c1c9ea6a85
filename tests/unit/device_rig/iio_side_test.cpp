// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/iio_side.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "tests/support/folder.hpp"

namespace stillhand::emulators::iio_side_test {

namespace fs = std::filesystem;

/// The folder of tests/integration/iio_context.py, and a reader in the place of iiod.
class IioSideTest : public testing::Test {
 protected:
  IioSideTest() {
    for (const char* name : {"iio:device0", "iio:device1"}) {
      fs::create_directories(folder_ / "bus/iio/devices" / name / "buffer");
      std::ofstream(folder_ / "bus/iio/devices" / name / "buffer/length") << "4\n";
      fs::create_directories(folder_ / "dev");
      mkfifo((folder_ / "dev" / name).c_str(), 0600);
    }
    reader_ = open((folder_ / "dev/iio:device0").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  }
  ~IioSideTest() override { close(reader_); }
  int samples_read() {
    std::array<std::int32_t, 100> samples{};
    return static_cast<int>(std::max<ssize_t>(0, read(reader_, samples.data(), sizeof(samples)))) /
           static_cast<int>(sizeof(std::int32_t));
  }

  const support::Folder folder_;
  int reader_ = -1;
};

TEST_F(IioSideTest, ABufferKeepsWhatItsReaderAskedForAndDropsTheNewest) {
  IioSide sut(folder_ / "dev/iio:device0", folder_ / "dev/iio:device1");
  std::int64_t now_ns = 1'000'000'000;
  const auto write = [&](int samples) {
    for (int i = 0; i < samples; ++i) sut.write({}, now_ns += 1'000'000);
  };
  write(4);
  EXPECT_EQ(sut.counts().lost, 0u);
  write(10);
  EXPECT_EQ(sut.counts().lost, 10u);
  EXPECT_EQ(samples_read(), 4);
  write(3);
  EXPECT_EQ(sut.counts().lost, 10u);
  EXPECT_EQ(samples_read(), 3);
  EXPECT_EQ(sut.counts().longest_gap_ns, 1'000'000);
  now_ns += 50'000'000;
  write(1);
  EXPECT_EQ(sut.counts().longest_gap_ns, 51'000'000);
}

}  // namespace stillhand::emulators::iio_side_test
