# Compiler settings shared by every target, and the three kinds of target there are.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

add_library(etendue_options INTERFACE)
target_compile_features(etendue_options INTERFACE cxx_std_20)
target_include_directories(etendue_options INTERFACE "${CMAKE_SOURCE_DIR}/src")
target_compile_options(etendue_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  # GCC 12 sees overlaps in std::string that are not there (its bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # Same arithmetic whatever the optimiser sees: no contraction into FMA, but no errno or trap bookkeeping either.
  -fno-math-errno -fno-trapping-math -ffp-contract=off)
if(ETENDUE_NATIVE)
  target_compile_options(etendue_options INTERFACE -march=native)
endif()
if(ETENDUE_SANITIZE)
  target_compile_options(etendue_options INTERFACE
    -fsanitize=${ETENDUE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g)
  # Instrumented code makes GCC's flow analysis see uninitialised members that are not (its manual says so).
  target_compile_options(etendue_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(etendue_options INTERFACE -fsanitize=${ETENDUE_SANITIZE})
endif()

# etendue_library(NAME SOURCES … LINKS …): one folder of src/.
function(etendue_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC etendue_options ${ARG_LINKS})
endfunction()

# etendue_test(NAME SOURCES … LINKS …): a GoogleTest program; every test case becomes a ctest entry.
function(etendue_test name)
  if(NOT ETENDUE_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gtest_main)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600)
endfunction()

# etendue_fuzzer(NAME SOURCES … LINKS ROOM): a libFuzzer program for what the room reads.
function(etendue_fuzzer name)
  if(NOT ETENDUE_FUZZ)
    return()
  endif()
  cmake_parse_arguments(ARG "" "LINKS" "SOURCES" ${ARGN})
  # The reader itself must be instrumented too, or the fuzzer sees no coverage.
  target_compile_options(${ARG_LINKS} PRIVATE -fsanitize=fuzzer-no-link)
  add_executable(${name} ${ARG_SOURCES})
  target_compile_options(${name} PRIVATE -fsanitize=fuzzer)
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  target_link_libraries(${name} PRIVATE ${ARG_LINKS})
endfunction()
