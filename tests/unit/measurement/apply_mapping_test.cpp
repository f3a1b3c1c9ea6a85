// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/apply_mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/libraries/measurement/tables/text_table.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::apply_mapping_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<TableFile> table(const std::string& text, const TextForm& form = {}) {
  return text_table({text, {}}, "ride.csv", form, 1000);
}

Mapping mapping(const std::vector<const char*>& wishes) {
  Mapping out;
  for (const char* wish : wishes) out.columns.push_back(parse_wish(wish));
  return out;
}

MappedRows read(const std::string& text, const Mapping& asked = {}) {
  return apply_mapping(*table(text, asked.form), asked);
}

std::string error_of(const std::string& text, const Mapping& asked = {}) {
  return support::refusal([&] { (void)read(text, asked); });
}

TEST(ApplyMappingTest, ColumnsBecomeChannelsInSiUnits) {
  const MappedRows sut =
      read("zeit;acc;kraft;note\n0,0;1,0;0,5;start\n10,0;2,0;1,5;x\n20,0;-1,0;2,5;end\n",
           mapping({"zeit=t [ms]", "acc=a_y [g]", "kraft=f [kN]"}));
  EXPECT_THAT(sut.rows.time_s, ElementsAre(0.0, 0.01, 0.02));
  ASSERT_EQ(sut.rows.columns.size(), 2u);
  EXPECT_EQ(sut.rows.columns[0].unit, "m/s^2");
  EXPECT_THAT(sut.rows.columns[0].values, ElementsAre(9.80665, 2 * 9.80665, -9.80665));
  EXPECT_EQ(sut.rows.columns[1].unit, "N");
  EXPECT_THAT(sut.rows.columns[1].values, ElementsAre(500.0, 1500.0, 2500.0));
  EXPECT_DOUBLE_EQ(sut.rows.rate_hz, 100.0);
  EXPECT_THAT(sut.notes,
              Contains(HasSubstr("';' between columns and ',' as decimal sign: t from "
                                 "'zeit' (times 0.001), a_y from 'acc' (times 9.80665)")));
}

TEST(ApplyMappingTest, TitlesThatStateEverythingNeedNoMapping) {
  const MappedRows sut = read("Time (ms);a_y [g];Grip [%]\n0;1;5\n10;1;6\n");
  EXPECT_THAT(sut.rows.time_s, ElementsAre(0.0, 0.01));
  EXPECT_EQ(sut.rows.columns[0].name, "a_y");
  EXPECT_EQ(sut.rows.columns[0].values[0], 9.80665);
  EXPECT_EQ(sut.rows.columns[1].name, "Grip");
  EXPECT_EQ(sut.rows.columns[1].unit, "%") << "a name without a unit of its own keeps the file's";
}

TEST(ApplyMappingTest, ALineOfUnitsThatContradictsTheTitlesIsRefusedUntilTheMappingDecides) {
  const std::string rows = "0.0,1,2\n0.01,1,2\n";
  const std::string text = "t [s],a_y [m/s^2],f [N]\n[s],[g],[lbf]\n" + rows;
  EXPECT_THAT(error_of(text), HasSubstr("ride.csv:2:1: got [g] below the title 'a_y [m/s^2]', "
                                        "want one unit of each column; "));
  for (const auto& [unit, value] : {std::pair("m/s^2", 1.0), {"g", 9.80665}}) {
    const std::string wish = std::string("a_y [m/s^2]=a_y [") + unit + "]";
    const MappedRows sut = read(text, mapping({"t [s]=t", wish.c_str()}));
    EXPECT_EQ(sut.rows.columns[0].values[0], value) << unit;
  }
  EXPECT_THAT(error_of(text, mapping({"t [s]=t", "f [N]=f"})), HasSubstr("got [lbf] below"));
  // The same units, also in other words, and words in brackets that are no unit.
  const MappedRows sut = read("t [s],a_y (m/s^2),acc (left)\n[sec],[m s-2],[g]\n" + rows,
                              mapping({"t [s]=t", "a_y (m/s^2)=a_y", "acc (left)=a_x"}));
  EXPECT_EQ(sut.rows.columns[0].values[0], 1.0);
  EXPECT_EQ(sut.rows.columns[1].values[0], 2.0 * 9.80665);
}

TEST(ApplyMappingTest, TheRefusalShowsTheMappingThatWouldDo) {
  EXPECT_THAT(error_of("time,acc,force\n0,1,2\n0.01,1,2\n"),
              HasSubstr("ride.csv: got the columns 'time', 'acc', 'force', want 't [s]' and 'name "
                        "[unit]'; if they are these, add --map 'time=t [s]' 'acc=a_y [m/s^2]' "
                        "'force=f [N]'"));
  EXPECT_EQ(read("time,acc,force\n0,1,2\n0.01,1,2\n",
                 mapping({"time=t [s]", "acc=a_y [m/s^2]", "force=f [N]"}))
                .rows.row_count(),
            2u);
  EXPECT_THAT(error_of("timestamp,acc_x (g),ay\n0,1,2\n10,1,2\n20,1,2\n"),
              HasSubstr("--map 'timestamp=t [ms]' 'acc_x (g)=a_x [g]' 'ay=a_y [m/s^2]'"))
      << "steps of 10 are milliseconds";
  EXPECT_THAT(error_of("p,q,r\n0,1,2\n0.1,1,2\n"),
              HasSubstr("--map 'p=t [s]' 'q=a_y [m/s^2]' 'r=f [N]'"));
  EXPECT_THAT(error_of("it's,it's,x\n0,1,2\n0.1,1,2\n"), HasSubstr("--map '#1=t [s]' '#2=a_y"));
  EXPECT_THAT(error_of("p,v_y [m/s],force\n0,1,2\n0.1,1,2\n"),
              HasSubstr("no other column has a unit of a_y, such as m/s^2"))
      << "a mapping that the next call would refuse";
}

TEST(ApplyMappingTest, ATitleThatStandsTwiceIsSaidToAndTheOfferedMappingWorks) {
  const std::string rows = "0.0,1,2,3\n0.01,1,2,3\n";
  EXPECT_THAT(error_of("t [s],a_y [m/s^2],f [N],a_y [m/s^2]\n" + rows),
              HasSubstr("ride.csv: got the title 'a_y [m/s^2]' twice (#2 and #4), want every name "
                        "once; if they are these, add --map 't [s]=t [s]' '#2=a_y [m/s^2]' "));
  EXPECT_THAT(error_of("t [s],a_y [m/s^2],f [N],t [ms]\n" + rows),
              HasSubstr("got the name 't' twice (#1 and #4)"));
  const MappedRows sut = read("t [s],a_y [m/s^2],f [N],a_y [m/s^2]\n" + rows,
                              mapping({"t [s]=t [s]", "#2=a_y [m/s^2]", "f [N]=f [N]"}));
  EXPECT_EQ(sut.rows.columns.size(), 2u);
}

TEST(ApplyMappingTest, AUnitOfAnotherQuantityIsTheFault) {
  const std::string rows = "0.0,1,2\n0.01,1,2\n";
  for (const auto& [titles, fault] :
       {std::pair("t [s],a_y [furlong],f [N]\n",
                  "got the unit furlong of 'a_y [furlong]', want a "
                  "unit of a_y, such as m/s^2: "),
        {"t [s],a_y [N],f [m/s^2]\n", "got the unit N of 'a_y [N]', want a unit of a_y"}}) {
    const std::string error = error_of(titles + rows);
    EXPECT_THAT(error, HasSubstr(fault));
    EXPECT_THAT(error, testing::Not(HasSubstr("--map")));
  }
}

TEST(ApplyMappingTest, ControlCharactersOfATitleReachNobody) {
  const std::string text = "t [s],a_y [m/s^2],\x1b[31mf\x07 [N]\n0.0,1,2\n0.01,1,2\n";
  const MappedRows sut = read(text);
  EXPECT_EQ(sut.rows.columns[1].name, "?[31mf?");
  EXPECT_THAT(sut.notes, Contains(HasSubstr("from '?[31mf? [N]'")));
  // By the title as it is shown, and by its place.
  for (const char* wish : {"?[31mf? [N]=f", "#3=f"}) {
    EXPECT_EQ(read(text, mapping({"t [s]=t", wish})).rows.columns[0].values[0], 2.0) << wish;
  }
}

TEST(ApplyMappingTest, RowsThatLackAValueAreLeftOutAndCounted) {
  const MappedRows sut = read("t,a,f,x\n0,1,2,\n0.1,,2,\n0.2,NaN,,\n0.3,1,2\n0.4,1,2,7\n",
                              mapping({"t=t [s]", "a=a_y [m/s^2]", "f=f [N]"}));
  EXPECT_THAT(sut.rows.time_s, ElementsAre(0.0, 0.3, 0.4));
  EXPECT_THAT(sut.notes, Contains(HasSubstr("2 of 5 rows lack a value (2 in a_y, 1 in f)")));
  EXPECT_THAT(sut.notes, Contains(HasSubstr("1 row with fewer cells than titles")));
}

TEST(ApplyMappingTest, ALastLineThatIsCutOffIsLeftOut) {
  const MappedRows sut =
      read("t,a,f\n0,1,2\n0.1,1,2\n0.2,1", mapping({"t=t [s]", "a=a_y [m/s^2]", "f=f [N]"}));
  EXPECT_EQ(sut.rows.row_count(), 2u);
  EXPECT_THAT(sut.notes, Contains(HasSubstr("The last line is cut off")));
}

TEST(ApplyMappingTest, AFileWithoutTimesHasASampleRate) {
  Mapping asked = mapping({"a=a_y [m/s^2]"});
  EXPECT_THAT(error_of("a,f\n1,2\n1,2\n", asked), HasSubstr("no time among 'a', 'f'"));
  asked.rate_hz = 1000.0;
  EXPECT_THAT(read("a,f\n1,2\n1,2\n1,2\n", asked).rows.time_s, ElementsAre(0.0, 0.001, 0.002));
  asked.columns.push_back(parse_wish("f=t [s]"));
  EXPECT_THAT(error_of("a,f\n1,2\n1,2\n", asked), HasSubstr("--sample-rate: got 1000 next to"));
}

TEST(ApplyMappingTest, SaysWhatIsWrongWithAMapping) {
  const std::string text = "t,ai0 [V],f\n0,1,2\n0.1,1,2\n";
  EXPECT_THAT(
      error_of(text, mapping({"t=t [s]", "acc=a_y"})),
      HasSubstr("--map: got 'acc', which is no column of ride.csv, want 't' or another of 't', "
                "'ai0 [V]', 'f'"));
  EXPECT_THAT(error_of(text, mapping({"t=t [s]", "f=f", "ai0=f"})), HasSubstr("a second 'f'"));
  EXPECT_THAT(error_of(text, mapping({"t=t [s]"})), HasSubstr("no channel except the time"));
  EXPECT_THAT(error_of(text, mapping({"t=t [s]", "ai0=f [N]"})),
              HasSubstr("ride.csv, 'ai0 [V]': got values in [V] for 'ai0=f [N]', want a unit of f "
                        "[N], or a gain with its unit"));
  EXPECT_THAT(error_of(text, mapping({"t=t [V]", "f=f [N]"})), HasSubstr("want a unit of t [s]"));
}

TEST(ApplyMappingTest, SaysWhereAValueIsWrong) {
  const Mapping asked = mapping({"t=t [s]", "f=f [N]"});
  EXPECT_THAT(error_of("t,f\n0,1\n0.1,x\n0.2,1\n", asked),
              HasSubstr("ride.csv:3:5: got 'x', want a finite number in column 'f'"));
  EXPECT_THAT(error_of("t,f\n0,1\n0.1,inf\n", asked), HasSubstr("ride.csv:3:5: got 'inf'"));
  EXPECT_THAT(error_of("t,f\n0,1\n0.1,1,1\n0.2,1\n", asked),
              HasSubstr("ride.csv:3:7: got more than 2 cells"));
  EXPECT_THAT(error_of("t,f\n0,1\n# c\n\n0.1,1\n0.1,2\n", asked),
              HasSubstr("ride.csv:6:1: got time 0.1 s, want more than 0.1 s"));
  EXPECT_THAT(error_of("t,f\n0,1\n,1\n", asked), HasSubstr("1 rows with every value"));
}

TEST(ApplyMappingTest, ARowThatIsThereTwiceIsLeftOut) {
  const MappedRows sut = read("t,f\n0,1\n0.1,2\n0.1,2\n0.2,3\n", mapping({"t=t [s]", "f=f [N]"}));
  EXPECT_EQ(sut.rows.row_count(), 3u);
  EXPECT_EQ(sut.rows.repeated_rows, 1u);
}

TEST(ApplyMappingTest, TooManyValuesAreRefusedBeforeTheyAreRead) {
  std::string text = "t,f\n";
  for (int i = 0; i < 600; ++i) text += std::to_string(i) + ",1\n";
  EXPECT_THAT(error_of(text, mapping({"t=t [s]", "f=f [N]"})), HasSubstr("at most 1000 values"));
}

}  // namespace stillhand::measurement::apply_mapping_test
