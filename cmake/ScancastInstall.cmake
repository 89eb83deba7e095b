# `cmake --install`: programs, importers, page, man pages and documents; the library is installed in client/cpp/install.
# Importers lie beside the program that starts them. Components are the packages of ScancastPackage.cmake.
include(GNUInstallDirs)
install(TARGETS scancast scancast-sandbox scancast-import-e57 scancast-import-laz scancast-import-octree COMPONENT server)
install(TARGETS scancast-client COMPONENT client)
if(TARGET scancast-import-pcl)
  install(TARGETS scancast-import-pcl COMPONENT import-pcl)
endif()
if(TARGET scancast-ranks)
  install(TARGETS scancast-ranks COMPONENT ranks)
endif()
# The page is inside the program; this copy is for whoever serves it from elsewhere (--allowed-origin).
include("${PROJECT_SOURCE_DIR}/client/web/files.cmake")
foreach(file IN LISTS SCANCAST_WEB_FILES)
  get_filename_component(folder "${file}" DIRECTORY)
  install(FILES "client/web/${file}" DESTINATION "${CMAKE_INSTALL_DATADIR}/scancast/web/${folder}" COMPONENT server)
endforeach()
install(FILES README.md CHANGELOG.md LICENSE protocol/PROTOCOL.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT server)
install(DIRECTORY docs/ DESTINATION "${CMAKE_INSTALL_DOCDIR}/docs" COMPONENT doc
  FILES_MATCHING PATTERN *.md PATTERN *.jpg PATTERN *.png)
install(DIRECTORY client/cpp/example DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT dev)
