// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <matio.h>

#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/measurement/columns_in_words.hpp"

namespace stillhand::measurement::mat_reader_test {

using testing::ElementsAre;
using Size = std::vector<std::size_t>;

// 1, 2, 3, ... down the columns.
template <typename Number = double>
matvar_t* array(const char* name, Size size = {2, 1}, matio_classes kind = MAT_C_DOUBLE,
                matio_types type = MAT_T_DOUBLE) {
  std::vector<Number> values(10'000);
  std::iota(values.begin(), values.end(), Number{1});
  return Mat_VarCreate(name, kind, type, static_cast<int>(size.size()), size.data(), values.data(),
                       0);
}

matvar_t* text(std::u16string words) {
  Size size{1, words.size()};
  return Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT16, 2, size.data(), words.data(), 0);
}

matvar_t* cells(const char* name, std::vector<matvar_t*> all) {
  Size size{1, all.size()};
  return Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, size.data(), all.data(), 0);
}

matvar_t* fields(const char* name, const std::vector<std::pair<const char*, matvar_t*>>& all) {
  Size size{1, 1};
  matvar_t* out = Mat_VarCreateStruct(name, 2, size.data(), nullptr, 0);
  for (const auto& [field, value] : all) {
    Mat_VarAddStructField(out, field);
    Mat_VarSetStructFieldByName(out, field, 0, value);
  }
  return out;
}

std::vector<std::string> written_and_read(const std::vector<matvar_t*>& variables) {
  const std::string path = testing::TempDir() + "written.mat";
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  for (matvar_t* each : variables) Mat_VarWrite(file, each, MAT_COMPRESSION_NONE);
  for (matvar_t* each : variables) Mat_VarFree(each);
  Mat_Close(file);
  return made::columns_in_words(mat_reader(), path);
}

TEST(MatReaderTest, EveryTypeOfNumberIsRead) {
  EXPECT_THAT(written_and_read({array<float>("a", {2, 1}, MAT_C_SINGLE, MAT_T_SINGLE),
                                array<std::int8_t>("b", {2, 1}, MAT_C_INT8, MAT_T_INT8),
                                array<std::uint8_t>("c", {2, 1}, MAT_C_UINT8, MAT_T_UINT8),
                                array<std::int16_t>("d", {2, 1}, MAT_C_INT16, MAT_T_INT16),
                                array<std::uint16_t>("e", {2, 1}, MAT_C_UINT16, MAT_T_UINT16),
                                array<std::int32_t>("f", {2, 1}, MAT_C_INT32, MAT_T_INT32),
                                array<std::uint32_t>("g", {2, 1}, MAT_C_UINT32, MAT_T_UINT32),
                                array<std::int64_t>("h", {2, 1}, MAT_C_INT64, MAT_T_INT64),
                                array<std::uint64_t>("i", {2, 1}, MAT_C_UINT64, MAT_T_UINT64)}),
              ElementsAre("a : 1 2", "b : 1 2", "c : 1 2", "d : 1 2", "e : 1 2", "f : 1 2",
                          "g : 1 2", "h : 1 2", "i : 1 2"));
}

TEST(MatReaderTest, TheLongerSideOfAMatrixIsTime) {
  EXPECT_THAT(written_and_read({array("a", {3, 2}), array("b", {2, 3}), array("c", {2, 2}),
                                array("d", {1, 2}), array("e", {1, 1}), array("f", {0, 3}),
                                array("g", {66, 65}), array("h", {2, 2, 2}),
                                cells("i", std::vector<matvar_t*>(1025))}),
              ElementsAre("a(:,1) : 1 2 3", "a(:,2) : 4 5 6", "b(1,:) : 1 3 5", "b(2,:) : 2 4 6",
                          "c(:,1) : 1 2", "c(:,2) : 3 4", "d : 1 2",
                          "Not read: g (65 signals in one matrix), h (3 dimensions), i (1025 "
                          "cells)."));
  EXPECT_EQ(written_and_read({array("most", {65, 64})}).size(), 64U);
  matvar_t* deep = array(nullptr);
  for (int depth = 16; depth > 0; --depth) deep = cells(depth == 1 ? "deep" : nullptr, {deep});
  EXPECT_EQ(written_and_read({deep, cells("most", std::vector<matvar_t*>(1024))}).size(), 1U);
}

// Of `stillhand export`, a table and a timeseries of MATLAB, and a text next to the numbers.
// 0x80 and 0x7FF are the ends of the characters of two bytes in UTF-8 (RFC 3629).
TEST(MatReaderTest, UnitsStandWhereProgramsKeepThem) {
  matvar_t* names = cells(nullptr, {text(u"f"), text(u"a")});
  matvar_t* units = cells(nullptr, {text(u"kN"), text(u"g")});
  matvar_t* meta = fields(nullptr, {{"units", fields(nullptr, {{"f", text(u"N")}})}});
  matvar_t* properties = fields(nullptr, {{"VariableNames", names}, {"VariableUnits", units}});
  matvar_t* information = fields(nullptr, {{"Units", text(u"mV")}});
  EXPECT_THAT(
      written_and_read({fields("a", {{"f", array(nullptr)}, {"meta", meta}}),
                        fields("b", {{"Properties", properties}, {"a", array(nullptr)}}),
                        fields("c", {{"Data", array(nullptr)}, {"DataInfo", information}}),
                        cells("d", {fields(nullptr, {{"x", array(nullptr)},
                                                     {"time", array(nullptr)},
                                                     {"Unit", text(u"A\u0080\u07FF\u0800b")}})})}),
      ElementsAre("a.f N: 1 2", "b.a g: 1 2", "c.Data mV: 1 2", "d{1}.x A\u0080\u07FFb: 1 2",
                  "d{1}.time : 1 2"));
}

}  // namespace stillhand::measurement::mat_reader_test
