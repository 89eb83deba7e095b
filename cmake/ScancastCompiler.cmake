# Compiler settings of every target of ours.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(SCANCAST_CCACHE ccache)
if(SCANCAST_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${SCANCAST_CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER "${SCANCAST_CCACHE}")
endif()

# Everything runs on any x86-64-v2 machine; kernels that want more are compiled once more per level
# and chosen at run time (renderer/device/cpu). Contraction is off because a fused multiply-add
# rounds differently: pictures are promised to be the same bytes on every machine.
set(SCANCAST_FLOAT_FLAGS -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-march=x86-64-v2)
endif()
add_compile_options(${SCANCAST_FLOAT_FLAGS})
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g1")
set(CMAKE_CXX_FLAGS_RELEASE "-O3")
set(CMAKE_C_FLAGS_RELEASE "-O3")

set(SCANCAST_SANITIZE "" CACHE STRING "address (with undefined), thread, or empty")
if(SCANCAST_SANITIZE STREQUAL "address")
  # Pointers are the address sanitizer's to judge; asking of each a second time takes longer than all the rest to compile.
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
                      -fno-sanitize=null,vptr,object-size,nonnull-attribute,returns-nonnull-attribute)
  add_link_options(-fsanitize=address,undefined)
elseif(SCANCAST_SANITIZE STREQUAL "thread")
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer -O0)  # little is computed there, and much compiled
  add_link_options(-fsanitize=thread)
elseif(SCANCAST_SANITIZE)
  message(FATAL_ERROR "SCANCAST_SANITIZE is '${SCANCAST_SANITIZE}': expected address, thread or nothing")
endif()

# scancast_library(NAME SOURCES … [PUBLIC libs…] [PRIVATE libs…]): one room, warnings as errors.
function(scancast_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  scancast_warnings(${name})
  target_include_directories(${name} PUBLIC "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

function(scancast_warnings name)
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Werror)
endfunction()
