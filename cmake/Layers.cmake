# One static library per folder of src/. A layer's headers are reachable only through its own include
# root, <build>/layers/<layer>/, which holds one link named after the layer: `#include "motor/x.hpp"`
# resolves only in targets that use the layer `motor`.

# Sources with the same headers are compiled together: a quarter of the time. So many files that two cores have work.
set(RC10_UNITY_BATCH 16 CACHE STRING "How many files are compiled together, at most; 0: all of a target")
function(rc10_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${RC10_UNITY} UNITY_BUILD_BATCH_SIZE ${RC10_UNITY_BATCH})
endfunction()

# rc10_layer(<name> [FLAT] [USES <layer>...] [LIBRARIES <target>...])   FLAT: sources of sub-folders are in other targets
function(rc10_layer layer)
  cmake_parse_arguments(ARG "FLAT" "" "USES;LIBRARIES" ${ARGN})
  set(include_root "${PROJECT_BINARY_DIR}/layers/${layer}")
  file(MAKE_DIRECTORY "${include_root}")
  file(CREATE_LINK "${PROJECT_SOURCE_DIR}/src/${layer}" "${include_root}/${layer}" SYMBOLIC)

  # A layer is its folder: a new file needs no build rule.
  file(GLOB sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/${layer}/*.cpp")
  if(NOT ARG_FLAT)
    file(GLOB rooms CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/${layer}/*/*.cpp")
    list(APPEND sources ${rooms})
  endif()
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  set(target rc10_${layer})
  if(sources)
    add_library(${target} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE rc10_warnings)
    rc10_together(${target})
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(${target} ${scope} "${include_root}")
  list(TRANSFORM ARG_USES PREPEND rc10_)
  target_link_libraries(${target} ${scope} ${ARG_USES} ${ARG_LIBRARIES})
  if(layer STREQUAL "app")
    target_link_libraries(${target} ${scope} tl::expected)
    configure_file("${PROJECT_SOURCE_DIR}/cmake/version.hpp.in" "${PROJECT_BINARY_DIR}/generated/rc10_version.hpp")
    target_include_directories(${target} ${scope} "${PROJECT_BINARY_DIR}/generated")
  endif()
endfunction()

# rc10_program(<name> MAIN <source file, or folder of sources> [USES <layer>...] [LIBRARIES <target>...])
# All programs land in <build>/bin.
function(rc10_program name)
  cmake_parse_arguments(ARG "" "MAIN" "USES;LIBRARIES" ${ARGN})
  if(IS_DIRECTORY "${PROJECT_SOURCE_DIR}/${ARG_MAIN}")
    file(GLOB ARG_MAIN CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${ARG_MAIN}/*.cpp")
  endif()
  add_executable(${name} ${ARG_MAIN})
  list(TRANSFORM ARG_USES PREPEND rc10_)
  target_link_libraries(${name} PRIVATE rc10_warnings ${ARG_USES} ${ARG_LIBRARIES})
  rc10_together(${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
endfunction()
