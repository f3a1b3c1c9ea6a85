// SPDX-License-Identifier: Apache-2.0
// main() of the test programs: GoogleTest's own, with exit status 77 when every case that ran
// passed and at least one was skipped.  ctest reports 77 as "Skipped" (SKIP_RETURN_CODE).
// SKIP_REGULAR_EXPRESSION cannot do this: it also turns a failed program with one skipped case into
// a skipped one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

int main(int argc, char** argv) {
  constexpr int kSkipped = 77;
  testing::InitGoogleMock(&argc, argv);
  const int status = RUN_ALL_TESTS();
  if (status != 0) return status;
  return testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkipped : 0;
}
