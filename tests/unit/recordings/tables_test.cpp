// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <sstream>

#include "apps/recordings/column_names.hpp"
#include "apps/recordings/csv_tables.hpp"
#include "apps/recordings/mat_tables.hpp"
#include "tests/unit/recordings/sample_recording.hpp"

namespace stillhand::recordings::tables_test {
namespace {

using recording::Cell;
using recording::CellKind;
using recording::MessageColumn;
using testing::ElementsAre;
using testing::HasSubstr;

std::string named(std::string_view name, std::size_t most, std::set<std::string> taken = {}) {
  return plain_name(name, most, taken);
}

TEST(PlainNameTest, OnlyLettersDigitsAndUnderscoresStayAndALetterIsFirst) {
  EXPECT_EQ(named("stillhand/sensed", 60), "stillhand_sensed");
  EXPECT_EQ(named("a.0", 60), "a_0");
  EXPECT_EQ(named("0a", 60), "x0a");
  EXPECT_EQ(named("_a", 60), "x_a");
  EXPECT_EQ(named("", 60), "x");
  EXPECT_EQ(named("é", 60), "x__");
  EXPECT_EQ(named("../../etc/passwd", 60), "x______etc_passwd");
}

TEST(PlainNameTest, ATakenNameGetsANumberWithinTheLimit) {
  EXPECT_EQ(named("a b", 60, {"a_b"}), "a_b_2");
  EXPECT_EQ(named("a b", 60, {"a_b", "a_b_2", "a_b_3"}), "a_b_4");
  EXPECT_EQ(named("abcdefgh", 6), "abcdef");
  EXPECT_EQ(named("abcdefgh", 6, {"abcdef"}), "abcd_2");
}

// MATLAB's limit is 63 characters; names of the same beginning must stay apart.
TEST(PlainNameTest, RandomNamesAreUniqueAndValid) {
  std::mt19937_64 random(71);
  std::set<std::string> taken;
  for (int i = 0; i < 2000; ++i) {
    std::string name(random() % 70, 'a');
    if (!name.empty()) name[random() % name.size()] = static_cast<char>(random() % 256);
    const std::size_t before = taken.size();
    const std::string plain = plain_name(name, 63, taken);
    ASSERT_EQ(taken.size(), before + 1);
    ASSERT_LE(plain.size(), 63u);
    ASSERT_TRUE(std::isalpha(static_cast<unsigned char>(plain.at(0)))) << plain;
    ASSERT_EQ(plain.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
                                      "0123456789"),
              std::string::npos)
        << plain;
  }
}

TEST(TopicTableTest, AnEmptyCellOfANumberIsNanAndWholeNumbersOfAListBecomeReal) {
  EXPECT_EQ(real_of(Cell(-2.5)), -2.5);
  EXPECT_EQ(real_of(Cell(std::int64_t{-3})), -3.0);
  EXPECT_EQ(real_of(Cell(std::uint64_t{1} << 63)), 0x1p63);
  EXPECT_TRUE(std::isnan(real_of(Cell())));
  EXPECT_TRUE(std::isnan(real_of(Cell(std::string_view("7")))));
  EXPECT_EQ(kind_without_gaps({"a", "", CellKind::kInteger, false}), CellKind::kInteger);
  EXPECT_EQ(kind_without_gaps({"a", "", CellKind::kInteger, true}), CellKind::kReal);
  EXPECT_EQ(kind_without_gaps({"a", "", CellKind::kUnsigned, true}), CellKind::kReal);
  EXPECT_EQ(kind_without_gaps({"a", "", CellKind::kText, true}), CellKind::kText);
}

class CsvTablesTest : public FolderTest {
 protected:
  // The table of these columns and rows as text.
  std::string written(const std::vector<MessageColumn>& columns,
                      const std::vector<std::vector<Cell>>& rows,
                      const std::vector<std::int64_t>& times_ns) {
    const auto sut = csv_tables(path("out"));
    const auto sink = sut->add({"table", "topic", "type", columns}, 1);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      sink->take({times_ns[i], 1, 2, 3, rows[i]});
    }
    sink->finish();
    sut->close();
    EXPECT_FALSE(std::filesystem::exists(path("out/table.csv"))) << "not published yet";
    sut->publish();
    return recording::read_file(path("out/table.csv"));
  }
  static std::string line(const std::string& text, std::size_t number) {
    std::istringstream stream(text);
    std::string line;
    for (std::size_t i = 0; i <= number; ++i) std::getline(stream, line);
    return line;
  }
};

TEST_F(CsvTablesTest, TimesHaveEveryNanosecondAndTheirSign) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  const std::vector<std::int64_t> times_ns{0,     1,         -1, 999'999'999, -1'000'000'001,
                                           kMost, -kMost - 1};
  const std::vector<std::string> want{
      "0.000000000",  "0.000000001",          "-0.000000001",         "0.999999999",
      "-1.000000001", "9223372036.854775807", "-9223372036.854775808"};
  const std::string text = written({}, std::vector<std::vector<Cell>>(times_ns.size()), times_ns);
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_EQ(line(text, i + 1), want[i] + ",1,2,3");
}

// 8 bytes a number: 2^25 rows of 4 columns of a message's own and 4 of its payload.
TEST_F(CsvTablesTest, AMatlabFileThatCannotHoldTheRowsIsRefusedBeforeTheFirst) {
  const auto sut = mat_tables(path("large.mat"));
  const std::vector<MessageColumn> columns(4, {"x", "N", CellKind::kReal});
  const TopicTable table{"table", "topic", "type", columns};
  EXPECT_NO_THROW((void)sut->add(table, (1U << 25) - 1));
  EXPECT_THROW((void)sut->add(table, 1U << 25), std::runtime_error);
  EXPECT_NO_THROW((void)csv_tables(path("large"))->add(table, 1U << 25));
}

TEST_F(CsvTablesTest, ATableOfItsOwnHasNoColumnOfAMessage) {
  const auto sut = csv_tables(path("own"));
  const auto sink = sut->add({"table",
                              "title",
                              "table",
                              {{"t", "s", CellKind::kReal}, {"code", "-", CellKind::kText}},
                              false},
                             1);
  sink->take({0, 0, 0, 0, std::vector<Cell>{Cell(0.25), Cell(std::string_view("P07"))}});
  sink->finish();
  sut->close();
  sut->publish();
  EXPECT_EQ(recording::read_file(path("own/table.csv")), "t [s],code [-]\n0.25,P07\n");
}

TEST_F(CsvTablesTest, ATextWithACommaAQuoteOrALineBreakIsQuotedAsRfc4180Says) {
  const std::vector<MessageColumn> columns{{"text", "", CellKind::kText}};
  const std::string text = written(
      columns, {{"plain"}, {"a,b"}, {"say \"x\""}, {"two\nlines"}, {"end\r"}, {""}, {Cell()}},
      {0, 0, 0, 0, 0, 0, 0});
  EXPECT_THAT(text, HasSubstr(",3,plain\n"));
  EXPECT_THAT(text, HasSubstr(",3,\"a,b\"\n"));
  EXPECT_THAT(text, HasSubstr(",3,\"say \"\"x\"\"\"\n"));
  EXPECT_THAT(text, HasSubstr(",3,\"two\nlines\"\n"));
  EXPECT_THAT(text, HasSubstr(",3,\"end\r\"\n"));
  EXPECT_THAT(text, testing::EndsWith(",3,\n0.000000000,1,2,3,\n"));
}

TEST_F(CsvTablesTest, TitlesNameTheUnitAndAreQuotedToo) {
  const std::string text = written({{"force", "N", CellKind::kReal},
                                    {"unknown", "", CellKind::kReal},
                                    {"count", "", CellKind::kUnsigned},
                                    {"odd,name", "m", CellKind::kReal}},
                                   {}, {});
  EXPECT_EQ(text,
            "t [s],log_time [ns],publish_time [ns],sequence [-],force [N],unknown [?],count [-],"
            "\"odd,name [m]\"\n");
}

TEST_F(CsvTablesTest, WholeNumbersAtTheirLimitsAndRealsReadBackExactly) {
  std::mt19937_64 random(72);
  std::vector<std::vector<Cell>> rows;
  std::vector<std::int64_t> times_ns;
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) {
    // Any finite double: random bits, exponents of all sizes.
    double value = std::nan("");
    while (!std::isfinite(value)) value = std::bit_cast<double>(random());
    values.push_back(value);
    rows.push_back({Cell(value), Cell(std::numeric_limits<std::int64_t>::min()),
                    Cell(std::numeric_limits<std::uint64_t>::max())});
    times_ns.push_back(i * 1'000'000);
  }
  const std::string text = written({{"x", "m", CellKind::kReal},
                                    {"low", "-", CellKind::kInteger},
                                    {"high", "-", CellKind::kUnsigned}},
                                   rows, times_ns);
  EXPECT_THAT(line(text, 1), testing::EndsWith(",-9223372036854775808,18446744073709551615"));
  const recording::Recording table = recording::read_csv(path("out/table.csv"));
  ASSERT_NE(table.find("x"), nullptr);
  EXPECT_EQ(table.find("x")->values, values);
}

// Rows leave for the disk in blocks of 256 kB.
TEST_F(CsvTablesTest, ATableOfManyBlocksHasEveryRowOnce) {
  constexpr std::size_t kRows = 20'000;  // 33 bytes each: three blocks
  std::vector<std::int64_t> times_ns;
  for (std::size_t i = 0; i < kRows; ++i) times_ns.push_back(static_cast<std::int64_t>(i) * 1000);
  const std::string text =
      written({{"x", "m", CellKind::kReal}},
              std::vector<std::vector<Cell>>(kRows, {Cell(0.123456789012)}), times_ns);
  EXPECT_GT(text.size(), std::size_t{2} << 18);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), kRows + 1);
  EXPECT_EQ(line(text, kRows), "0.019999000,1,2,3,0.123456789012");
}

}  // namespace
}  // namespace stillhand::recordings::tables_test
