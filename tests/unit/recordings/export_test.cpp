// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/export.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>
#include <matio.h>

#include <cmath>
#include <fstream>

#include "services/core/recording/csv.hpp"
#include "tests/unit/recordings/sample_recording.hpp"

namespace stillhand::recordings::export_test {
namespace {

using testing::HasSubstr;

std::vector<std::string> lines_of(const std::string& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class ExportTest : public FolderTest {};

TEST_F(ExportTest, ATopicBecomesACsvFileWithTimeFirstAndUnits) {
  write_sample(path("a.mcap"));
  const Exported sut = export_recording(path("a.mcap"), {path("out"), {}, {}, {}});
  EXPECT_TRUE(sut.left_out.empty());
  const auto lines = lines_of(path("out/stillhand_sensed.csv"));
  ASSERT_EQ(lines.size(), 201u);
  EXPECT_EQ(lines[0],
            "t [s],log_time [ns],publish_time [ns],sequence [-],rig [-],tick [-],stamp_ns [ns],"
            "acquired_ns [ns],accel_x_m_s2 [m/s^2],accel_y_m_s2 [m/s^2],accel_z_m_s2 [m/s^2],"
            "roll_rad [rad],force_n [N],theta_rad [rad],omega_rad_s [rad/s],flags [-]");
  EXPECT_EQ(
      lines[61],
      "0.060000000,1795272703905833285,1795272703905833280,60,1,62,0,0,0,-0.5,0,0,15.5,0,0,0");
  // It is a table as every verb of Stillhand reads it.
  const recording::Recording table = recording::read_csv(path("out/stillhand_sensed.csv"));
  ASSERT_NE(table.find("force_n"), nullptr);
  EXPECT_EQ(table.find("force_n")->unit, "N");
  EXPECT_EQ(table.find("force_n")->values[60], 15.5);
  EXPECT_NEAR(table.rate_hz, 1000.0, 1e-6);
}

TEST_F(ExportTest, TheWritersOfATopicShareItsTableInTheOrderOfTheFile) {
  write_two_writers(path("a.mcap"));
  const Exported sut = export_recording(path("a.mcap"), {path("tables"), {}, {}, {}});
  ASSERT_EQ(sut.topics.size(), 1u);
  EXPECT_EQ(sut.topics[0].rows, 6u);
  const auto table = recording::read_csv(path("tables/stillhand_sensed.csv"));
  ASSERT_NE(table.find("tick"), nullptr);
  EXPECT_EQ(table.find("tick")->values, (std::vector<double>{0, 0, 1, 1, 3, 3}));
}

TEST_F(ExportTest, WhatAReplayWroteHasATableOfItsOwn) {
  write_two_writers(path("a.mcap"), {{"replayed", "true"}});
  const Exported sut = export_recording(path("a.mcap"), {path("tables"), {}, {}, {}});
  ASSERT_EQ(sut.topics.size(), 2u);
  EXPECT_EQ(sut.topics[0].topic, "stillhand/sensed");
  EXPECT_EQ(sut.topics[1].topic, "stillhand/sensed (replayed)");
  EXPECT_EQ(sut.topics[1].rows, 3u);
  EXPECT_NE(sut.topics[0].name, sut.topics[1].name);
}

TEST_F(ExportTest, TextsAndEnumsAreReadable) {
  write_sample(path("a.mcap"));
  export_recording(path("a.mcap"), {path("out"), {}, {}, {}});
  const std::string text = recording::read_file(path("out/stillhand_event.csv"));
  EXPECT_THAT(text, HasSubstr("kind [-],kind.name [-],source [-]"));
  EXPECT_THAT(text, HasSubstr(",2,EVENT_TICKS_LOST,recorder,,,0,plain,0,CODE_NONE\n"));
  EXPECT_THAT(text, HasSubstr(",\"a \"\"quoted\"\", split\ntext\",0,CODE_NONE\n"));
}

TEST_F(ExportTest, AMatlabFileHoldsTheSameNumbers) {
  write_sample(path("a.mcap"));
  export_recording(path("a.mcap"), {{}, path("a.mat"), {}, {}});
  mat_t* file = Mat_Open(path("a.mat").c_str(), MAT_ACC_RDONLY);
  ASSERT_NE(file, nullptr);
  matvar_t* sensed = Mat_VarRead(file, "stillhand_sensed");
  ASSERT_NE(sensed, nullptr);
  const auto* force = Mat_VarGetStructFieldByName(sensed, "force_n", 0);
  ASSERT_NE(force, nullptr);
  ASSERT_EQ(force->class_type, MAT_C_DOUBLE);
  ASSERT_EQ(force->dims[0], 200u);
  EXPECT_EQ(static_cast<const double*>(force->data)[60], 15.5);
  const auto* log_time = Mat_VarGetStructFieldByName(sensed, "log_time", 0);
  ASSERT_EQ(log_time->class_type, MAT_C_UINT64);
  EXPECT_EQ(static_cast<const std::uint64_t*>(log_time->data)[60], 1795272703905833285u);
  auto* meta = Mat_VarGetStructFieldByName(sensed, "meta", 0);
  auto* units = Mat_VarGetStructFieldByName(meta, "units", 0);
  const auto* unit = Mat_VarGetStructFieldByName(units, "accel_y_m_s2", 0);
  ASSERT_EQ(unit->nbytes, 5u);
  EXPECT_EQ(std::string(static_cast<const char*>(unit->data), 5), "m/s^2");
  matvar_t* events = Mat_VarRead(file, "stillhand_event");
  ASSERT_NE(events, nullptr);
  auto* names = Mat_VarGetStructFieldByName(events, "kind_name", 0);
  ASSERT_EQ(names->class_type, MAT_C_CELL);
  const auto* first = Mat_VarGetCell(names, 0);
  EXPECT_EQ(std::string(static_cast<const char*>(first->data), first->nbytes), "EVENT_TICKS_LOST");
  Mat_VarFree(events);
  Mat_VarFree(sensed);
  Mat_Close(file);
}

TEST_F(ExportTest, AnHdf5FileHoldsTheSameNumbers) {
  write_sample(path("a.mcap"));
  export_recording(path("a.mcap"), {{}, {}, path("a.h5"), {}});
  const hid_t file = H5Fopen(path("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  const hid_t force = H5Dopen2(file, "/stillhand_sensed/force_n", H5P_DEFAULT);
  ASSERT_GE(force, 0);
  std::vector<double> values(200);
  const hid_t space = H5Dget_space(force);
  ASSERT_EQ(H5Sget_simple_extent_npoints(space), 200);
  ASSERT_GE(H5Dread(force, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  EXPECT_EQ(values[60], 15.5);
  const hid_t unit = H5Aopen(force, "unit", H5P_DEFAULT);
  const hid_t type = H5Aget_type(unit);
  char* text = nullptr;
  ASSERT_GE(H5Aread(unit, type, &text), 0);
  EXPECT_STREQ(text, "N");
  H5free_memory(text);
  std::vector<std::uint64_t> times(200);
  const hid_t log_time = H5Dopen2(file, "/stillhand_sensed/log_time", H5P_DEFAULT);
  ASSERT_GE(H5Dread(log_time, H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, times.data()), 0);
  EXPECT_EQ(times[60], 1795272703905833285u);
  for (const hid_t open : {log_time, force}) H5Dclose(open);
  H5Tclose(type);
  H5Aclose(unit);
  H5Sclose(space);
  EXPECT_GE(H5Fclose(file), 0);
}

// More rows than a block of the HDF5 file holds, and a list whose length changes.
TEST_F(ExportTest, AnyTypeIsExportedByTheSchemaInTheFile) {
  constexpr std::uint32_t kRows = 20'000;
  {
    recording::FileSink sink(path("b.mcap"));
    recording::McapWriter writer(sink);
    const auto schema = writer.add_schema(
        "lab::Grip", "omgidl",
        "module lab { struct Grip { sequence<short> fingers; /* [N] */\n double t; // [s]\n}; };");
    const auto channel = writer.add_channel("lab/../grip", schema, "cdr");
    for (std::uint32_t n = 0; n < kRows; ++n) {
      std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, {}, {}};
      const auto put = [&](const auto& value) {
        const auto* raw = reinterpret_cast<const std::byte*>(&value);
        bytes.insert(bytes.end(), raw, raw + sizeof(value));
      };
      put(std::uint32_t{n % 2 == 0 ? 2u : 0u});
      if (n % 2 == 0) put(std::array<std::int16_t, 2>{static_cast<std::int16_t>(n / 2), -1});
      while ((bytes.size() - 4) % 8 != 0) bytes.push_back({});
      put(static_cast<double>(n));
      ASSERT_TRUE(writer.write(channel, n, n, n, bytes).ok());
    }
    ASSERT_TRUE(writer.write(channel, kRows, kRows, kRows, std::vector<std::byte>(6)).ok());
    ASSERT_TRUE(writer.close().ok());
  }
  const Exported sut =
      export_recording(path("b.mcap"), {path("out"), path("b.mat"), path("b.h5"), {}});
  ASSERT_EQ(sut.topics.size(), 1u);
  EXPECT_EQ(sut.topics[0].name, "lab____grip");
  EXPECT_EQ(sut.topics[0].rows, kRows);
  EXPECT_EQ(sut.topics[0].unread, 1u) << "bytes that are no such message";
  const auto lines = lines_of(path("out/lab____grip.csv"));
  ASSERT_EQ(lines.size(), kRows + 1);
  EXPECT_THAT(lines[0], HasSubstr(",fingers.count [-],fingers.0 [N],fingers.1 [N],t [s]"));
  EXPECT_EQ(lines[3], "0.000000002,2,2,2,2,1,-1,2");
  EXPECT_EQ(lines[2], "0.000000001,1,1,1,0,,,1");
  const hid_t file = H5Fopen(path("b.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t finger = H5Dopen2(file, "/lab____grip/fingers_0", H5P_DEFAULT);
  ASSERT_GE(finger, 0);
  std::vector<double> values(kRows);
  ASSERT_GE(H5Dread(finger, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  EXPECT_EQ(values[kRows - 2], kRows / 2 - 1);
  EXPECT_TRUE(std::isnan(values[kRows - 1]));
  const hid_t own_time = H5Dopen2(file, "/lab____grip/t_2", H5P_DEFAULT);
  EXPECT_GE(own_time, 0) << "the message's own t, beside the recording's";
  for (const hid_t open : {own_time, finger}) H5Dclose(open);
  EXPECT_GE(H5Fclose(file), 0);
}

TEST_F(ExportTest, AnotherProgramsRecordingIsExportedAsFarAsItsSchemasAreKnown) {
  const auto write = [&](bool with_known) {
    recording::FileSink sink(path("ros.mcap"), recording::Existing::kReplace);
    recording::McapWriterOptions options;
    options.profile = "ros2";
    recording::McapWriter writer(sink, options);
    const auto ros = writer.add_schema("std_msgs/msg/Bool", "ros2idl", "bool data");
    writer.add_channel("/flag", ros, "cdr");
    writer.add_channel("/json", 0, "json");
    const auto broken = writer.add_schema("a::B", "omgidl", "struct B { double x }");
    writer.add_channel("/broken", broken, "cdr");
    const auto known =
        writer.add_schema("pkg/B", "omgidl", "module pkg { struct B { double x; }; };");
    if (with_known) writer.add_channel("/known", known, "cdr");
    ASSERT_TRUE(writer.close().ok());
  };
  write(false);
  EXPECT_THAT(
      support::refusal([&] { export_recording(path("ros.mcap"), {path("out"), {}, {}, {}}); }),
      HasSubstr("schema 1: got a schema in 'ros2idl', want a schema in 'omgidl' or 'ros2msg')"));
  EXPECT_EQ(file_count(), 1u) << "no folder of results that never were";
  write(true);
  const Exported sut = export_recording(path("ros.mcap"), {path("out"), {}, {}, {}});
  ASSERT_EQ(sut.topics.size(), 1u);
  EXPECT_EQ(sut.topics[0].topic, "/known");
  EXPECT_THAT(sut.left_out,
              testing::ElementsAre(HasSubstr("ros2idl"), HasSubstr("messages in 'json'"),
                                   HasSubstr("schema 2, IDL line 1:21: got '}', want ;")));
}

TEST_F(ExportTest, ATopicOfTheCatalogueIsReadWithoutItsSchema) {
  {
    recording::FileSink sink(path("a.mcap"));
    recording::McapWriter writer(sink);
    const auto channel = writer.add_channel("stillhand/sensed", 0, "cdr");
    ASSERT_TRUE(writer.write(channel, 0, 5, 5, to_cdr(sample(3))).ok());
    ASSERT_TRUE(writer.close().ok());
  }
  const Exported sut = export_recording(path("a.mcap"), {path("out"), {}, {}, {}});
  ASSERT_EQ(sut.topics.size(), 1u);
  EXPECT_EQ(sut.topics[0].rows, 1u);
  EXPECT_THAT(lines_of(path("out/stillhand_sensed.csv"))[1], HasSubstr(",0.75,"));
}

TEST_F(ExportTest, PlacesAndNamesThatCannotBeAreRefusedBeforeTheWork) {
  write_sample(path("a.mcap"));
  const auto refused = [&](const ExportOptions& options) {
    return support::refusal([&] { export_recording(path("a.mcap"), options); });
  };
  EXPECT_THAT(refused({path("out"), path("nowhere/a.mat"), {}, {}}), HasSubstr("--mat"));
  EXPECT_THAT(refused({{}, {}, path("a.mcap"), {}}), HasSubstr("--hdf5"));
  EXPECT_THAT(refused({path("a.mcap"), {}, {}, {}}), HasSubstr("--csv"));
  EXPECT_THAT(
      refused({path("out"), {}, {}, {"*/event", "lab/*"}}),
      HasSubstr("--topics: got lab/*, which no topic matches, want one of stillhand/event, "));
  EXPECT_EQ(file_count(), 1u);
  EXPECT_EQ(export_recording(path("a.mcap"), {path("out"), {}, {}, {"*/ev?nt"}}).topics.size(), 1u);
}

// Ctrl-C at every moment at which it is asked for: all tables or none, and no piece of one.
TEST_F(ExportTest, GivenUpAtAnyMomentItLeavesNothing) {
  write_sample(path("a.mcap"));
  bool whole = false;
  for (int moment = 0; !whole; ++moment) {
    ExportOptions options{path("out"), path("a.mat"), path("a.h5"), {}};
    int asked = 0;
    options.stopped = [&] { return asked++ == moment; };
    try {
      export_recording(path("a.mcap"), options);
      whole = true;
      EXPECT_EQ(asked, moment);
    } catch (const Interrupted&) {
      ASSERT_EQ(file_count(), 1u) << moment;
    }
  }
  EXPECT_EQ(file_count(), 4u);
  EXPECT_TRUE(std::filesystem::exists(path("out/stillhand_sensed.csv")));
}

}  // namespace
}  // namespace stillhand::recordings::export_test
