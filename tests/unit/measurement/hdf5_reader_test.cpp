// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <hdf5.h>

#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/in_child.hpp"
#include "tests/unit/measurement/columns_in_words.hpp"

namespace stillhand::measurement::hdf5_reader_test {

using testing::ElementsAre;
using Size = std::vector<hsize_t>;

// A file that the library of the format writes.
class Hdf5ReaderTest : public testing::Test {
 protected:
  // 1, 2, 3, ... along the last dimension, stored as the type of the file.
  hid_t add(const char* name, const Size& size = {2}, hid_t type = H5T_NATIVE_DOUBLE) {
    const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    const hid_t set = H5Dcreate2(file_, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    std::vector<double> values(10'000);
    std::iota(values.begin(), values.end(), 1.0);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    return set;
  }

  static void state(hid_t set, const char* name, const std::vector<double>& values) {
    const hsize_t count = values.size();
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t attribute =
        H5Acreate2(set, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
    H5Aclose(attribute);
  }

  static void state(hid_t set, const char* name, const char* text, bool fixed = true) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, fixed ? 8 : H5T_VARIABLE);
    const hid_t attribute =
        H5Acreate2(set, name, type, H5Screate(H5S_SCALAR), H5P_DEFAULT, H5P_DEFAULT);
    char eight[8] = {};
    if (fixed) std::string(text).copy(eight, sizeof(eight));
    H5Awrite(attribute, type, fixed ? static_cast<const void*>(eight) : &text);
    H5Aclose(attribute);
  }

  std::vector<std::string> read() {
    close();
    return made::columns_in_words(hdf5_reader(), path_);
  }

  std::string refused() {
    close();
    try {
      (void)hdf5_reader().head(path_);
    } catch (const Refused& refused) {
      return refused.got;
    }
    return "accepted";
  }

  // With all that is open in it.
  void close() {
    H5Fclose(file_);
    H5close();
  }

  std::string path_ = testing::TempDir() + "written.h5";
  hid_t file_ = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
};

TEST_F(Hdf5ReaderTest, TheLongerSideOfAMatrixIsTime) {
  add("a", {3, 2});
  add("b", {2, 3});
  add("c", {2, 2});
  add("d", {1, 2});
  add("e", {2, 1});
  add("f", {1});
  add("g", {1, 1});
  add("h", {66, 65});
  add("i", {2, 2, 2});
  add("j", {0});
  add("k", {2, 0});
  EXPECT_THAT(read(),
              ElementsAre("a[:,0] : 1 3 5", "a[:,1] : 2 4 6", "b[0,:] : 1 2 3", "b[1,:] : 4 5 6",
                          "c[:,0] : 1 3", "c[:,1] : 2 4", "d : 1 2", "e : 1 2",
                          "Not read: h (65 signals in one matrix), i (3 "
                          "dimensions)."));
}

TEST_F(Hdf5ReaderTest, AMatrixHasAtMost64Signals) {
  add("most", {65, 64});
  EXPECT_EQ(read().size(), 64U);
}

TEST_F(Hdf5ReaderTest, MembersOfATableAreColumns) {
  struct Row {
    double x;
    int n;
    double pair[2];
  };
  const hsize_t two = 2;
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Row));
  H5Tinsert(type, "x", HOFFSET(Row, x), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "n", HOFFSET(Row, n), H5T_NATIVE_INT);
  H5Tinsert(type, "pair", HOFFSET(Row, pair), H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &two));
  const hid_t set = H5Dcreate2(file_, "log", type, H5Screate_simple(1, &two, nullptr), H5P_DEFAULT,
                               H5P_DEFAULT, H5P_DEFAULT);
  const Row rows[] = {{1.0, 3, {}}, {2.0, 4, {}}};
  H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows);
  EXPECT_THAT(read(), ElementsAre("log.x : 1 2", "log.n : 3 4", "Not read: log.pair (arrays)."));
}

TEST_F(Hdf5ReaderTest, TheUnitIsAnAttributeOfFourNames) {
  state(add("a"), "unit", "N");
  state(add("b"), "units", "m/s^2", false);
  state(add("c"), "Unit", "seconds since 1970", false);
  state(add("d"), "Units", "12345678");  // without a zero behind it
  state(add("e", {2, 2}), "unit", "V");
  state(add("f"), "unit", std::vector<double>{1.0});
  EXPECT_THAT(read(), ElementsAre("a N: 1 2", "b m/s^2: 1 2", "c seconds: 1 2", "d 12345678: 1 2",
                                  "e[:,0] V: 1 3", "e[:,1] V: 2 4", "f : 1 2"));
}

// The users' guide of netCDF, appendix A; CF 1.11, sections 2.5.1 and 8.1.
TEST_F(Hdf5ReaderTest, PackedNumbersAreUnpacked) {
  state(add("a", {5}), "valid_range", {2.0, 4.0});
  const hid_t b = add("b", {5});
  state(b, "valid_min", std::vector<double>{2.0});
  state(b, "valid_max", std::vector<double>{4.0});
  state(add("c", {3}), "_FillValue", std::vector<double>{2.0});
  state(add("d", {3}), "missing_value", std::vector<double>{3.0});
  const hid_t e = add("e", {3});
  state(e, "scale_factor", std::vector<double>{10.0});
  state(e, "add_offset", std::vector<double>{5.0});
  state(add("f", {3}), "add_offset", std::vector<double>{5.0});
  const hid_t g = add("g", {3}, H5T_STD_I8LE);
  state(g, "_Unsigned", "true");
  const std::int8_t negative[] = {-1, 0, 1};
  H5Dwrite(g, H5T_NATIVE_INT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, negative);
  state(add("h", {3}), "scale_factor", {1.0, 2.0});  // no number
  state(add("i", {3}), "valid_range", {1.0, 2.0, 3.0});
  EXPECT_THAT(read(),
              ElementsAre("a : - 2 3 4 -", "b : - 2 3 4 -", "c : 1 - 3", "d : 1 2 -",
                          "e : 15 25 35", "f : 6 7 8", "g : 255 0 1", "h : 1 2 3", "i : 1 2 3",
                          "e: stored numbers times 10 plus 5 (scale_factor, add_offset).",
                          "f: stored numbers times 1 plus 5 (scale_factor, add_offset)."));
}

TEST_F(Hdf5ReaderTest, AFileWithoutNumbersIsRefusedWithWhatItHas) {
  const hid_t words = H5Tcreate(H5T_ENUM, sizeof(int));
  const int off = 0;
  H5Tenum_insert(words, "off", &off);
  const hid_t row = H5Tcreate(H5T_COMPOUND, sizeof(double));
  H5Tinsert(row, "x", 0, H5T_NATIVE_DOUBLE);
  add("a", {2}, H5Tcopy(H5T_C_S1));
  add("b", {2}, H5Tvlen_create(H5T_NATIVE_DOUBLE));
  add("c", {2}, words);
  add("d", {2, 2}, row);
  add("e", {2}, H5T_STD_B8LE);
  EXPECT_EQ(refused(),
            "an HDF5 file without a column of numbers, but a (text), b (lists), c (an "
            "enumeration), d (a compound), e (no numbers)");
}

TEST_F(Hdf5ReaderTest, ADamagedFileAndOneThatChangesAreRefused) {
  add("a", {3});
  close();
  TableHead head = hdf5_reader().head(path_);
  const auto read = [&](std::size_t column) {
    try {
      (void)hdf5_reader().read(path_, head, {column});
    } catch (const Refused& refused) {
      return refused.got;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(read(0), "accepted");
  head.columns.push_back(head.columns[0]);
  EXPECT_EQ(read(1), "a file that changes while it is read");
  head.columns[0].rows = 2;
  EXPECT_EQ(read(0), "a file that changes while it is read");
  std::ofstream(path_) << "\x89HDF\r\n\x1a\n";
  file_ = -1;
  EXPECT_EQ(refused(), "an HDF5 file that is damaged or cut off");
}

}  // namespace stillhand::measurement::hdf5_reader_test
