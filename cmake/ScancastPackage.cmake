# `cpack -G DEB`: Debian packages. The server alone needs no graphics, no window system and no PCL, so what needs them is
# a package of its own: client (its window is SDL's), importer by PCL; so are the library, its headers and the documents
# with their pictures. deploy/README.md tells what each is for, tests/deploy/package_test.py installs them.
#
# What follows is of packages only (EXCLUDE_FROM_ALL): `cmake --install` writes nothing outside its prefix, and no file
# that administrators edit.
set(SCANCAST_CONTACT "The maintainers of Scancast <maintainers@scancast.example>" CACHE STRING
  "Name and address for packages, as in Debian's field Maintainer")
set(debian "${PROJECT_SOURCE_DIR}/deploy/debian")
set(systemd "${PROJECT_SOURCE_DIR}/deploy/systemd")
install(FILES "${systemd}/scancast.service" DESTINATION lib/systemd/system COMPONENT server EXCLUDE_FROM_ALL)
install(FILES "${systemd}/sysusers.conf" DESTINATION lib/sysusers.d RENAME scancast.conf COMPONENT server EXCLUDE_FROM_ALL)
install(FILES "${systemd}/scancast.env" DESTINATION /etc/scancast COMPONENT server EXCLUDE_FROM_ALL)
install(FILES deploy/nginx/scancast.conf deploy/nginx/oauth2-proxy.conf deploy/nginx/replicas.conf deploy/nginx/replicas-server.conf deploy/README.md DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/scancast/deploy"
  COMPONENT server EXCLUDE_FROM_ALL)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME scancast)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "${SCANCAST_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR ON)  # for what is not below the prefix
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PRE_BUILD_SCRIPTS "${debian}/finish_staging.cmake")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_COMPONENTS_ALL "")

# scancast_package(COMPONENT PACKAGE DESCRIPTION [VARIABLE VALUE]…): a component's package; variables are CPack's, without
# CPACK_DEBIAN_COMPONENT_.
macro(scancast_package component package description)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${description}")
  set(fields ${ARGN})
  while(fields)
    list(POP_FRONT fields field value)
    set(CPACK_DEBIAN_${upper}_${field} "${value}")
  endwhile()
  install(FILES "${debian}/copyright" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${package}" COMPONENT ${component} EXCLUDE_FROM_ALL)
endmacro()

scancast_package(server scancast "server for views of huge scanned point clouds
Keeps scanned point clouds in memory, draws the view that somebody asks for, and
streams the pictures to browsers and programs. Graphics cards are used where
there are any."
  PACKAGE_SHLIBDEPS ON
  PACKAGE_DEPENDS "systemd-standalone-sysusers | systemd-sysusers"
  PACKAGE_RECOMMENDS "ca-certificates, libegl1, libopenh264-7"  # object storage by https; video for moving frames
  PACKAGE_SUGGESTS "scancast-client, scancast-import-pcl, scancast-doc, libgl1-mesa-dri, libosmesa6, nginx")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA
  "${debian}/postinst" "${debian}/prerm" "${debian}/postrm" "${debian}/conffiles")
scancast_package(client scancast-client "client of the point cloud server Scancast
Fetches pictures and films of scanned point clouds from a server, and shows
them in a window."
  PACKAGE_SHLIBDEPS ON
  PACKAGE_SUGGESTS "ffmpeg, libopenh264-7")
if(TARGET scancast-import-pcl)
  scancast_package(import-pcl scancast-import-pcl "PLY and PCD for the point cloud server Scancast
A program that the server starts to read scans in these formats, with the Point
Cloud Library."
    PACKAGE_SHLIBDEPS ON
    PACKAGE_ENHANCES "scancast")
endif()
if(TARGET scancast-ranks)
  scancast_package(ranks scancast-ranks "point cloud server Scancast by many processes
A program that mpirun starts several times, on one machine or many, so that they
turn scans into a cloud file together, or draw pictures together."
    PACKAGE_SHLIBDEPS ON
    PACKAGE_DEPENDS "scancast (= ${PROJECT_VERSION}-1)"
    PACKAGE_RECOMMENDS "openmpi-bin")
endif()
scancast_package(library libscancast-client0.1 "client library of the point cloud server Scancast
The shared library that C++ programs use which look at scanned point clouds on a
server."
  PACKAGE_SHLIBDEPS ON
  PACKAGE_SECTION libs)
scancast_package(dev scancast-dev "client library of the point cloud server Scancast, for development
Headers, an example, and what find_package(scancast) needs."
  PACKAGE_DEPENDS "libscancast-client0.1 (= ${PROJECT_VERSION}-1), nlohmann-json3-dev, libglm-dev, libexpected-dev"
  PACKAGE_SECTION libdevel)
install(DIRECTORY client/python/scancast DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL
  PATTERN __pycache__ EXCLUDE)
install(FILES client/python/README.md client/python/examples/three_pictures.py client/python/examples/first_steps.ipynb
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/python3-scancast" COMPONENT python EXCLUDE_FROM_ALL)
scancast_package(python python3-scancast "Python client of the point cloud server Scancast
Pictures, depth, points and live views of scanned point clouds on a server, as
bytes and NumPy arrays, and in notebooks."
  PACKAGE_DEPENDS "python3 (>= 3.9)"
  PACKAGE_RECOMMENDS "python3-numpy, python3-pil"
  PACKAGE_SECTION python
  PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${debian}/python/postinst" "${debian}/python/prerm")
scancast_package(doc scancast-doc "documents of the point cloud server Scancast
What the methods compute, how they look, how fast they are."
  PACKAGE_SECTION doc
  PACKAGE_ARCHITECTURE all)
include(CPack)
