# Runs Node's test runner on FOLDER/FILE, after saying, command included, what is missing for it: Node, or MODULE of npm's,
# which PACKAGE (a folder of the project's) asks for.
# cmake -DNODE=… -DFOLDER=… -DFILE=stream.test.mjs -DMODULE=ws -DPACKAGE=tests/foreign -P run_node.cmake
if(NOT NODE OR NODE MATCHES "NOTFOUND")
  message(FATAL_ERROR "Node.js is missing. Run this, and configure the build again:\n  apt-get install nodejs npm\n")
endif()
if(NOT EXISTS "${CMAKE_CURRENT_LIST_DIR}/../../${PACKAGE}/node_modules/${MODULE}/package.json")
  message(FATAL_ERROR "npm's ${MODULE} is missing. Run this in the project's folder:\n  (cd ${PACKAGE} && npm ci --ignore-scripts)\n")
endif()
execute_process(COMMAND "${NODE}" --test "${FILE}" WORKING_DIRECTORY "${FOLDER}" RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "node --test failed: ${result}")
endif()
