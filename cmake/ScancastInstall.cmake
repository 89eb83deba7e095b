# `cmake --install`: programs, importers, page, man pages and documents; the library is installed in client/cpp/install.
# Importers lie beside the program that starts them. Components are the packages of ScancastPackage.cmake.
include(GNUInstallDirs)
install(TARGETS scancast scancast-sandbox scancast-import-e57 COMPONENT server)
install(TARGETS scancast-client COMPONENT client)
if(TARGET scancast-import-pcl)
  install(TARGETS scancast-import-pcl COMPONENT import-pcl)
endif()
# Links to scripts that lie with their modules. npm's are taken along where `npm ci` has brought them; else the
# script tells how.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/importers/laz" DESTINATION "${CMAKE_INSTALL_LIBEXECDIR}/scancast"
  COMPONENT server USE_SOURCE_PERMISSIONS PATTERN CMakeLists.txt EXCLUDE)
foreach(program scancast-import-laz scancast-import-potree)
  install(CODE "
    set(link \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/${program}\")
    file(CREATE_LINK \"../${CMAKE_INSTALL_LIBEXECDIR}/scancast/laz/${program}\" \"\${link}\" SYMBOLIC)" COMPONENT server)
endforeach()
# The page is inside the program; this copy is for whoever serves it from elsewhere (--allowed-origin).
include("${PROJECT_SOURCE_DIR}/client/web/files.cmake")
list(TRANSFORM SCANCAST_WEB_FILES PREPEND "${PROJECT_SOURCE_DIR}/client/web/" OUTPUT_VARIABLE page)
install(FILES ${page} DESTINATION "${CMAKE_INSTALL_DATADIR}/scancast/web" COMPONENT server)
install(FILES README.md CHANGELOG.md LICENSE protocol/PROTOCOL.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT server)
install(DIRECTORY docs/ DESTINATION "${CMAKE_INSTALL_DOCDIR}/docs" COMPONENT doc
  FILES_MATCHING PATTERN *.md PATTERN *.jpg PATTERN *.png)
install(DIRECTORY client/cpp/example DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT dev)
