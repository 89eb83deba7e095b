# find_package(scancast) gives scancast::client, the C++ client. What its headers include must be there:
# nlohmann-json3-dev, libglm-dev and libexpected-dev in Debian.
include(CMakeFindDependencyMacro)
find_dependency(nlohmann_json 3.11)
find_dependency(glm)
find_dependency(tl-expected)
include("${CMAKE_CURRENT_LIST_DIR}/scancastTargets.cmake")
