// The main() of every GoogleTest program. A suite of which nothing could run is skipped, and CTest says so; a filter
// that finds nothing is a mistake, not a success.
#include <gmock/gmock.h>

#include <cstdio>

namespace {
constexpr int nothingRan = 77;  // tests/CMakeLists.txt: SKIP_RETURN_CODE
}

int main(int argc, char** argv) {
    testing::InitGoogleMock(&argc, argv);
    const int result = RUN_ALL_TESTS();
    if (result != 0 || GTEST_FLAG_GET(list_tests)) return result;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    if (all.test_to_run_count() == 0) {
        std::fprintf(stderr, "No test is called %s.\n", GTEST_FLAG_GET(filter).c_str());
        return 1;
    }
    return all.successful_test_count() == 0 ? nothingRan : 0;
}
