# Man pages and completions, made of what the programs' --help says (deploy/manual): a part of every build of all
# targets where there is Python. Not with sanitizers, whose programs nobody installs, and not where programs of the
# build cannot run.
find_program(SCANCAST_PYTHON python3 DOC "Python 3, for man pages, completions, and tests of programs")
if(NOT SCANCAST_PYTHON OR SCANCAST_SANITIZE OR SCANCAST_COVERAGE OR CMAKE_CROSSCOMPILING)
  message(STATUS "No man pages and completions: they need Python 3, and programs without sanitizers")
  return()
endif()
set(SCANCAST_MANUAL "${PROJECT_BINARY_DIR}/manual")
set(manual_programs scancast scancast-client scancast-import-e57 scancast-import-laz scancast-import-octree)
if(TARGET scancast-import-pcl)
  list(APPEND manual_programs scancast-import-pcl)
endif()
if(TARGET scancast-ranks)
  list(APPEND manual_programs scancast-ranks)
endif()
list(TRANSFORM manual_programs PREPEND "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/" OUTPUT_VARIABLE manual_paths)
set(manual_source "${PROJECT_SOURCE_DIR}/deploy/manual")
add_custom_command(
  OUTPUT "${SCANCAST_MANUAL}/made"
  COMMAND "${CMAKE_COMMAND}" -E rm -rf "${SCANCAST_MANUAL}"
  COMMAND "${SCANCAST_PYTHON}" -B "${manual_source}/make_manual.py" "${PROJECT_VERSION}" "${SCANCAST_MANUAL}" ${manual_paths}
  DEPENDS ${manual_programs} "${manual_source}/completions.py" "${manual_source}/help_text.py" "${manual_source}/make_manual.py"
          "${manual_source}/man_page.py"
  COMMENT "Writing man pages and completions"
  VERBATIM)
add_custom_target(scancast_manual ALL DEPENDS "${SCANCAST_MANUAL}/made")

set(manual_parts server client import-pcl)
set(completed_parts server client)
if(TARGET scancast-ranks)
  list(APPEND manual_parts ranks)
  list(APPEND completed_parts ranks)
endif()
foreach(part IN LISTS manual_parts)
  string(REPLACE "server" "" name "${part}")
  string(REGEX REPLACE "(.+)" "-\\1" name "${name}")
  # The server's are all that are nobody else's.
  set(others "")
  if(part STREQUAL "server")
    set(others REGEX "/scancast-(client|import-pcl|ranks)[^/]*$" EXCLUDE)
  endif()
  install(DIRECTORY "${SCANCAST_MANUAL}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT ${part}
    FILES_MATCHING PATTERN "scancast${name}*.1" ${others})
endforeach()
foreach(part IN LISTS completed_parts)
  string(REPLACE "server" "" name "${part}")
  string(REGEX REPLACE "(.+)" "-\\1" name "${name}")
  install(FILES "${SCANCAST_MANUAL}/bash/scancast${name}" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
    COMPONENT ${part})
  # Where Debian's zsh looks.
  install(FILES "${SCANCAST_MANUAL}/zsh/_scancast${name}" DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions"
    COMPONENT ${part})
  install(FILES "${SCANCAST_MANUAL}/fish/scancast${name}.fish" DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d"
    COMPONENT ${part})
endforeach()
