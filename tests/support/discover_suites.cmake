# Lists the suites of a GoogleTest program as tests of CTest, one process each: what a suite prepares - a device, a
# scene, a server - is made once, and a run is some hundreds of processes instead of thousands.
# Run after the program is linked: cmake -DPROGRAM=… -DOUTPUT=… -DNAME=… -DLAUNCHER=… -DBUDGET=… -DGL_BUDGET=… -DBUDGETS=SUITE=SECONDS,…
# -DLABEL=… [-DGL_LABEL=…] -P this
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${failed}")
endif()

set(tests "")
string(REGEX MATCHALL "(^|\n)[^ \n][^ \n]*\\.[ \n]" suites "\n${listed}")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[ \n.]+$" "" suite "${suite}")
  string(STRIP "${suite}" suite)
  if(suite MATCHES "DISABLED_")
    continue()
  endif()
  set(budget "${BUDGET}")
  if(suite MATCHES "^Gl[A-Za-z0-9]*/")
    set(budget "${GL_BUDGET}")
  endif()
  if(",${BUDGETS}," MATCHES ",${suite}=([0-9.]+),")
    set(budget "${CMAKE_MATCH_1}")
  endif()
  set(label "${LABEL}")
  if(GL_LABEL AND suite MATCHES "^Gl/")
    set(label "${GL_LABEL}")
  endif()
  if(suite MATCHES "^Slow/")
    set(label slow)
  endif()
  string(APPEND tests "add_test([==[${suite} (${NAME})]==] [==[${LAUNCHER}]==] ${budget} [==[${PROGRAM}]==] "
                      "[==[--gtest_filter=${suite}.*]==])\n"
                      "set_tests_properties([==[${suite} (${NAME})]==] PROPERTIES LABELS ${label} TIMEOUT 600 COST ${budget} "
                      "SKIP_RETURN_CODE 77)\n")
endforeach()
if(NOT tests)
  message(FATAL_ERROR "${PROGRAM} lists no tests")
endif()
file(WRITE "${OUTPUT}" "${tests}")
