# What CPack runs when all is installed in a folder for each component, before packages are made of them.

# Nothing that a build may do without is missing in a package.
foreach(file usr/share/man/man1/scancast-serve.1 usr/share/man/man1/scancast-import-laz.1)
  if(NOT EXISTS "${CPACK_TEMPORARY_DIRECTORY}/server/${file}")
    message(FATAL_ERROR "The package would lack ${file}. Man pages need Python 3 and the target scancast_manual: "
      "build all targets again.")
  endif()
endforeach()

# As Debian wants them: without names and times, so that the same pages are the same files.
file(GLOB_RECURSE pages "${CPACK_TEMPORARY_DIRECTORY}/*/usr/share/man/*.1")
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)

# SOURCE_DATE_EPOCH sets the time, for packages that are to be the same bytes.
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component ${CPACK_COMPONENTS_ALL})
  string(TOUPPER ${component} upper)
  set(package "${CPACK_DEBIAN_${upper}_PACKAGE_NAME}")
  set(changelog "${CPACK_TEMPORARY_DIRECTORY}/${component}/usr/share/doc/${package}/changelog.Debian")
  file(WRITE "${changelog}" "scancast (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
    "  * What changed: CHANGELOG.md, in the package scancast.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
  execute_process(COMMAND gzip -9n "${changelog}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
