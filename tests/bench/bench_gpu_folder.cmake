# Makes FOLDER all that a machine with a driver needs: PROGRAMS and SCRIPTS, and the shared libraries that the programs need,
# but for those of the C library. In FOLDER/egl lies libEGL (EGL_LIBRARIES, GLVND's, which find the driver's own), which some
# machines with a driver lack; gpu_day.sh uses it only there. Lists have commas.
string(REPLACE "," ";" programs "${PROGRAMS}")
string(REPLACE "," ";" scripts "${SCRIPTS}")
string(REPLACE "," ";" EGL_LIBRARIES "${EGL_LIBRARIES}")
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${programs} RESOLVED_DEPENDENCIES_VAR libraries
  POST_EXCLUDE_REGEXES "/(ld-linux[^/]*|lib(c|m|dl|rt|pthread))\\.so")
file(REMOVE_RECURSE "${FOLDER}")
file(COPY ${programs} ${scripts} ${libraries} DESTINATION "${FOLDER}" FOLLOW_SYMLINK_CHAIN)
foreach(library IN LISTS libraries)
  message("${library}")
endforeach()

foreach(library IN LISTS EGL_LIBRARIES)
  if(EXISTS "${library}")
    # Copied under the one name that is asked for: links do not survive every way of copying.
    get_filename_component(name "${library}" NAME)
    configure_file("${library}" "${FOLDER}/egl/${name}" COPYONLY)
    message("${library} (used where there is no libEGL)")
  else()
    message(WARNING "No libEGL is carried along, since there is none here (Debian: apt install libegl1): machines without "
                    "it will not open a device")
  endif()
endforeach()
