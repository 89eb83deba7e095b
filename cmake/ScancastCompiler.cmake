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

# Most of what compiling a file takes is reading headers and instantiating their templates, which files of a target
# have in common: compiled together they take about a third of the time. Alone, a change rebuilds little, and a file
# that forgets an include is seen; so `dev` compiles them alone, and the builds that are made in one go together.
option(SCANCAST_UNITY "Compile the files of each target together" OFF)
set(CMAKE_UNITY_BUILD ${SCANCAST_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)

# Sixty test programs are linked: with mold, or else lld, in a fraction of the time.
find_program(SCANCAST_MOLD mold)
find_program(SCANCAST_LLD ld.lld)
if(SCANCAST_MOLD)
  add_link_options(-fuse-ld=mold)
elseif(SCANCAST_LLD)
  add_link_options(-fuse-ld=lld)
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
  # For rooms that compute little and include much: two thirds of what -O1 takes to compile; their tests take a tenth longer.
  set(SCANCAST_LITTLE_COMPUTED -Og)
elseif(SCANCAST_SANITIZE STREQUAL "thread")
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer -O0)  # little is computed there, and much compiled
  add_link_options(-fsanitize=thread)
elseif(SCANCAST_SANITIZE)
  message(FATAL_ERROR "SCANCAST_SANITIZE is '${SCANCAST_SANITIZE}': expected address, thread or nothing")
endif()

option(SCANCAST_FUZZ "Build libFuzzer programs (needs clang): tests/fuzz/run.sh" OFF)
if(SCANCAST_FUZZ)
  # Everything, so that inputs are judged by what they reach in the parsers, not in the targets alone.
  add_compile_options(-fsanitize=fuzzer-no-link,address -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address)
endif()

option(SCANCAST_COVERAGE "Count the lines that run (tests/support/coverage.py)" OFF)
if(SCANCAST_COVERAGE)
  add_compile_options(--coverage -fprofile-update=atomic)
  add_link_options(--coverage)
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
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wnon-virtual-dtor
                         $<$<NOT:$<BOOL:${SCANCAST_FUZZ}>>:-Werror>  # of another compiler's warnings
                         # Compiled together, another file's names shadow nothing, and every file but the first is "included".
                         $<IF:$<BOOL:${SCANCAST_UNITY}>,-Wshadow=local;-Wno-subobject-linkage;-Wno-stringop-overflow,-Wshadow>)
endfunction()
