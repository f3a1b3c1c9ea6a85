// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string_view>
#include <utility>

#include "apps/libraries/measurement/tables/bag_table.hpp"
#include "apps/libraries/measurement/tables/guarded_table.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"
#include "apps/libraries/measurement/tables/tdms_table.hpp"
#include "apps/libraries/measurement/tables/text_encoding.hpp"
#include "apps/libraries/measurement/tables/text_table.hpp"
#include "apps/libraries/measurement/tables/xdf_table.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::measurement {
namespace {

// A table of short numbers has fewer bytes than its doubles; one of 20-digit numbers has more.
// 2 GiB of text hold 60 million 20-digit numbers.
constexpr std::uint64_t kMostText_bytes = std::uint64_t{2} << 30;

std::string first_bytes(const std::string& path) {
  recording::FileSource file(path);
  std::array<std::byte, 128> begin{};
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), begin.size()));
  const recording::Status status = file.read_at(0, std::span(begin).first(count));
  if (!status.ok()) throw ConfigError(path, status.text, "a file that can be read");
  return {reinterpret_cast<const char*>(begin.data()), count};
}

// A kind of file that is not read, and the line that makes one that is.
struct ForeignKind {
  std::string_view begin;  // of the file
  std::string_view kind;
  std::string_view convert;  // FILE stands for its name
};
using namespace std::string_view_literals;
constexpr std::array<ForeignKind, 19> kForeignKinds{{
    {"SQLite format 3\0"sv, "an SQLite file (rosbag2's .db3)",
     "MCAP: rosbags-convert --src $(dirname FILE) --dst out --dst-storage mcap"},
    {"#ROSBAG V2.0", "a bag of ROS 1",
     "MCAP: rosbags-convert --src FILE --dst out --dst-storage mcap"},
    {"\x28\xB5\x2F\xFD", "a file compressed with Zstandard", "the file in it: zstd -d FILE"},
    {"\x1F\x8B", "a file compressed with gzip", "the file in it: gunzip --keep FILE"},
    {"\xFD"
     "7zXZ",
     "a file compressed with xz", "the file in it: xz --decompress --keep FILE"},
    {"BZh", "a file compressed with bzip2", "the file in it: bunzip2 --keep FILE"},
    {"7z\xBC\xAF\x27\x1C", "an archive of 7-Zip", "the file in it: 7z x FILE"},
    {"PK\x03\x04", "a zip archive (.xlsx, .ods, .zip)",
     "a CSV of the sheet: libreoffice --convert-to csv FILE; of others what is in them: unzip "
     "FILE"},
    {"\xD0\xCF\x11\xE0", "an old Excel file (.xls)",
     "a CSV of the sheet: libreoffice --convert-to csv FILE"},
    {"TDSh", "the index of a TDMS file (.tdms_index)", "the .tdms next to it"},
    {"MDF ", "a measurement file of ASAM (.mf4)",
     "a CSV: python3 -c \"import asammdf; asammdf.MDF('FILE').export('csv', 'out.csv', "
     "single_time_base=True)\""},
    {"PAR1", "a Parquet file",
     "a CSV: python3 -c \"import pandas; pandas.read_parquet('FILE').to_csv('out.csv')\""},
    {"\x93NUMPY", "an array of NumPy",
     "a CSV: python3 -c \"import numpy; numpy.savetxt('out.csv', numpy.load('FILE'), "
     "delimiter=',')\""},
    {"ARROW1", "a Feather file",
     "a CSV: python3 -c \"import pandas; pandas.read_feather('FILE').to_csv('out.csv')\""},
    {"\x80\x04\x95", "a pickle of Python",
     "a CSV: python3 -c \"import pandas; pandas.read_pickle('FILE').to_csv('out.csv')\""},
    {"\x80\x05\x95", "a pickle of Python",
     "a CSV: python3 -c \"import pandas; pandas.read_pickle('FILE').to_csv('out.csv')\""},
    {"LOGG", "a log of a CAN bus (.blf)",
     "a CSV: python3 -m can.logconvert FILE out.csv, and then its signals by their database"},
    {"0       ", "a European data format (.edf)",
     "a CSV: python3 -c \"import mne; mne.io.read_raw_edf('FILE').to_data_frame("
     "scalings={'eeg': 1}).to_csv('out.csv')\""},
    {"%PDF", "a PDF", "the table that it was made from"},
}};

// C3D has no magic but the number of its parameter block and 0x50 (c3d.org, "The C3D file format").
constexpr ForeignKind kC3d{
    "", "a C3D file of a motion capture",
    "a CSV: python3 -c \"import ezc3d, numpy; c = ezc3d.c3d('FILE'); numpy.savetxt('out.csv', "
    "c['data']['analogs'][0].T, delimiter=',')\""};

// A zip archive whose first file is an array.
constexpr ForeignKind kNpz{
    "PK\x03\x04", "arrays of NumPy (.npz)",
    "a CSV: python3 -c \"import numpy; z = numpy.load('FILE'); numpy.savetxt('out.csv', "
    "numpy.column_stack([z[k] for k in z]), delimiter=',', header=','.join(z), comments='')\""};

[[noreturn]] void refuse_kind(const std::string& path, const ForeignKind& foreign) {
  std::string convert(foreign.convert);
  report::replace_all(convert, "FILE", path);
  throw ConfigError(path, std::string(foreign.kind), convert);
}

void refuse_foreign(const std::string& path, std::string_view begin) {
  if (begin.starts_with(kNpz.begin) && begin.find(".npy") != std::string_view::npos) {
    refuse_kind(path, kNpz);
  }
  for (const ForeignKind& foreign : kForeignKinds) {
    if (begin.starts_with(foreign.begin)) refuse_kind(path, foreign);
  }
  if (begin.size() > 1 && begin[1] == 0x50 && static_cast<unsigned char>(begin[0]) < 32 &&
      path.ends_with(".c3d")) {
    refuse_kind(path, kC3d);
  }
}

bool is_any_of(std::string_view begin, std::initializer_list<std::string_view> magics) {
  return std::ranges::any_of(magics,
                             [&](std::string_view magic) { return begin.starts_with(magic); });
}

// @throws stillhand::ConfigError if it cannot be read, or has over 2 GiB
std::string read_text(const std::string& path) {
  const std::uint64_t bytes = recording::FileSource(path).size();
  if (bytes > kMostText_bytes) {
    throw ConfigError(path, std::to_string(((bytes - 1) >> 20) + 1) + " MiB",
                      "at most " + std::to_string(kMostText_bytes >> 20) +
                          " MiB; use a part of the file, fewer columns or a lower rate");
  }
  return recording::read_file(path);
}

}  // namespace

FileKind kind_of(const std::string& path) {
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) {
    std::string file = "the .mcap of a bag";
    for (const auto& entry : std::filesystem::directory_iterator(path, none)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".mcap" || ending == ".db3") file = entry.path().string();
    }
    throw ConfigError(path, "a folder", "a file in it, for example " + in_one_line(file));
  }
  const std::string begin = first_bytes(path);
  refuse_foreign(path, begin);
  // MCAP specification, "Magic".  Only five of its eight bytes: the rest may be cut off.
  if (begin.starts_with("\x89MCAP")) return FileKind::kMcap;
  if (is_any_of(begin, {"MATLAB 5.0", "MATLAB 7.3"})) return FileKind::kMatlab;
  if (begin.starts_with("XDF:")) return FileKind::kXdf;
  if (begin.starts_with("TDSm")) return FileKind::kTdms;
  if (begin.starts_with("\x89HDF\r\n\x1a\n")) return FileKind::kHdf5;
  if (is_any_of(begin, {"RIFF", "RF64", "riff", "FORM", "fLaC", "caff"})) return FileKind::kSound;
  // MATLAB's versions before 5, and HDF5 behind a user block, have no magic: the name decides.
  const auto named = [&](std::string_view ending) { return path.ends_with(ending); };
  const bool binary = begin.find('\0') != std::string::npos;
  if (binary && named(".mat")) return FileKind::kMatlab;
  if (binary && (named(".h5") || named(".hdf5"))) return FileKind::kHdf5;
  return FileKind::kText;
}

TableFile::TableFile(TableHead head) : head_(std::move(head)) {
  constexpr auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; };
  for (ColumnHead& column : head_.columns) {
    for (std::string* text : {&column.title, &column.name, &column.unit, &column.unit_below}) {
      std::ranges::replace_if(*text, is_control, '?');
    }
  }
}

std::unique_ptr<TableFile> open_table(const std::string& path, const TextForm& form,
                                      std::size_t most_values) {
  switch (kind_of(path)) {
    case FileKind::kMcap:
      return bag_table(path, most_values);
    case FileKind::kMatlab:
      return guarded_table(path, mat_reader(), most_values);
    case FileKind::kHdf5:
      return guarded_table(path, hdf5_reader(), most_values);
    case FileKind::kSound:
      return guarded_table(path, sound_reader(), most_values);
    case FileKind::kXdf:
      return xdf_table(read_text(path), path, most_values);
    case FileKind::kTdms:
      return tdms_table(read_text(path), path, most_values);
    case FileKind::kText:
      break;
  }
  DecodedText decoded = to_utf8(read_text(path), path);
  return text_table(std::move(decoded), path, form, most_values);
}

}  // namespace stillhand::measurement
