# Third-party libraries, all from the distribution's packages; nothing is downloaded.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(glm REQUIRED)
find_package(TBB REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(tl-expected REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(prometheus-cpp CONFIG REQUIRED)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(SPNG REQUIRED IMPORTED_TARGET spng)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(EXPAT REQUIRED IMPORTED_TARGET expat)
pkg_check_modules(CURL REQUIRED IMPORTED_TARGET libcurl>=7.87)  # CURLOPT_QUICK_EXIT
pkg_check_modules(PROJ REQUIRED IMPORTED_TARGET proj>=9.1)
pkg_check_modules(ZLIB REQUIRED IMPORTED_TARGET zlib)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(TIFF REQUIRED IMPORTED_TARGET libtiff-4>=4.5)  # TIFFOpenOptions
find_path(SCANCAST_GEOTIFF_INCLUDE geotiff/xtiffio.h REQUIRED)  # Debian's libgeotiff-dev names itself to nobody
find_library(SCANCAST_GEOTIFF_LIBRARY geotiff REQUIRED)
add_library(scancast_geotiff INTERFACE)
target_include_directories(scancast_geotiff SYSTEM INTERFACE "${SCANCAST_GEOTIFF_INCLUDE}" "${SCANCAST_GEOTIFF_INCLUDE}/geotiff")
target_link_libraries(scancast_geotiff INTERFACE "${SCANCAST_GEOTIFF_LIBRARY}")
pkg_check_modules(BROTLI REQUIRED IMPORTED_TARGET libbrotlidec)
pkg_check_modules(BROTLI_ENCODER REQUIRED IMPORTED_TARGET libbrotlienc)  # while building, and for tests
pkg_check_modules(SDL2 IMPORTED_TARGET sdl2)  # not required: the window of scancast-client
