# Copies PROGRAM and the shared libraries that it needs, but for those of the C library, into FOLDER: all that another
# machine needs to run it.
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES "${PROGRAM}" RESOLVED_DEPENDENCIES_VAR libraries
  POST_EXCLUDE_REGEXES "/(ld-linux[^/]*|lib(c|m|dl|rt|pthread))\\.so")
file(REMOVE_RECURSE "${FOLDER}")
file(COPY "${PROGRAM}" ${libraries} DESTINATION "${FOLDER}" FOLLOW_SYMLINK_CHAIN)
foreach(library IN LISTS libraries)
  message("${library}")
endforeach()
