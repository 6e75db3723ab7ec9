# Warnings of every target: errors (RC10_WERROR) in the presets of development and its checks; not in release, package, bench
# and coverage, so that a user's newer compiler does not break the build.
add_library(rc10_warnings INTERFACE)
target_compile_options(rc10_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast
  -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion
  $<$<BOOL:${RC10_WERROR}>:-Werror>)
# GCC 12 sees a copy of 9223372036854775810 bytes in every `"a" + string` that -O3 inlines: gcc.gnu.org/PR105329, PR105651.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12 AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(rc10_warnings INTERFACE $<$<CONFIG:Release>:-Wno-restrict>)
endif()
