// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "apps/libraries/measurement/tables/table_file.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::open_table_test {

using namespace std::string_literals;
using testing::AllOf;
using testing::HasSubstr;

class OpenTableTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  support::Folder folder_;
};

TEST_F(OpenTableTest, TheFirstBytesDecideAndOfABinaryFileWithoutAnyTheName) {
  struct Case {
    std::string bytes;
    const char* name;
    FileKind kind;
  };
  for (const Case& each : {Case{"\x89MCAP", "a", FileKind::kMcap},
                           {"MATLAB 5.0", "a", FileKind::kMatlab},
                           {"MATLAB 7.3", "a", FileKind::kMatlab},
                           {"MATLAB 6.0", "a.mat", FileKind::kText},
                           {"\0\0"s, "a.mat", FileKind::kMatlab},
                           {"XDF:", "a", FileKind::kXdf},
                           {"TDSm", "a", FileKind::kTdms},
                           {"\x89HDF\r\n\x1a\n", "a", FileKind::kHdf5},
                           {"\0"s, "a.h5", FileKind::kHdf5},
                           {"\0"s, "a.hdf5", FileKind::kHdf5},
                           {"1", "a.h5", FileKind::kText},
                           {"\0"s, "a.csv", FileKind::kText},
                           {"fLaC", "a", FileKind::kSound},
                           {"caff", "a", FileKind::kSound},
                           {"", "a.mat", FileKind::kText}}) {
    EXPECT_EQ(kind_of(file(each.name, each.bytes)), each.kind) << each.bytes << each.name;
  }
}

// c3d.org: the number of the parameter block, and 0x50 behind it.
TEST_F(OpenTableTest, ACaptureIsKnownByItsTwoBytesAndItsName) {
  const auto is_capture = [&](const std::string& bytes, const char* name = "a.c3d") {
    const std::string path = file(name, bytes);
    return support::refusal([&] { kind_of(path); }).find("a C3D file") != std::string::npos;
  };
  EXPECT_TRUE(is_capture("\x02P"));
  EXPECT_TRUE(is_capture("\x1FP"));
  for (const char* other : {" P", "\x80P", "\x02Q", "\x02", ""}) EXPECT_FALSE(is_capture(other));
  EXPECT_FALSE(is_capture("\x02P", "a.txt"));
}

TEST_F(OpenTableTest, AnArchiveOfArraysIsToldFromAnotherAndTheLineNamesTheFile) {
  const std::string arrays = file("a.npz", "PK\x03\x04 x.npy"), other = file("b.zip", "PK\x03\x04");
  EXPECT_THAT(support::refusal([&] { kind_of(arrays); }),
              HasSubstr("numpy.load('" + arrays + "')"));
  EXPECT_THAT(support::refusal([&] { kind_of(other); }),
              AllOf(HasSubstr("--convert-to csv " + other + ";"), HasSubstr("unzip " + other)));
  EXPECT_THAT(support::refusal([&] { kind_of(file("c", ".npy, but no archive")); }), "accepted");
}

TEST_F(OpenTableTest, AFolderNamesTheBagInIt) {
  const std::string path = folder_.path().string();
  const auto names = [&](const std::string& file) {
    EXPECT_THAT(support::refusal([&] { kind_of(path); }), HasSubstr("for example " + file));
  };
  file("metadata.yaml", "");
  names("the .mcap of a bag");
  const std::string db3 = file("bag.db3", "");
  names(db3);
  std::filesystem::remove(db3);
  names(file("bag.mcap", ""));
}

// A hole in the file takes no room on the disk, and nothing reads it.
TEST_F(OpenTableTest, MoreThanTwoGibibytesOfTextAreRefused) {
  const std::string path = file("long.csv", "t,f\n");
  std::filesystem::resize_file(path, (std::uintmax_t{2} << 30) + 1);
  EXPECT_THAT(support::refusal([&] { open_table(path, {}, 1000); }),
              HasSubstr("got 2049 MiB, want at most 2048 MiB;"));
}

}  // namespace stillhand::measurement::open_table_test
