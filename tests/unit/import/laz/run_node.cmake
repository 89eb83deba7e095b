# Runs Node's test runner on FILE, after saying, command included, what is missing for it.
# cmake -DNODE=… -DFILE=damage.test.mjs -DMODULES=…/node_modules -P run_node.cmake
if(NOT NODE OR NODE MATCHES "NOTFOUND")
  message(FATAL_ERROR "Node.js is missing. Run this, and configure the build again:\n  apt-get install nodejs npm\n")
endif()
if(NOT EXISTS "${MODULES}/laz-perf/package.json")
  message(FATAL_ERROR "laz-perf is missing. Run this in the project's folder:\n  (cd importers/laz && npm ci --ignore-scripts)\n")
endif()
execute_process(COMMAND "${NODE}" --test "${FILE}" WORKING_DIRECTORY "${CMAKE_CURRENT_LIST_DIR}" RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "node --test failed: ${result}")
endif()
