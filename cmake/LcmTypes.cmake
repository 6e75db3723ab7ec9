# C++ types from lcm_types/*.lcm, made in the build. Debian's lcm-gen, not one that pip put first on PATH.
find_program(LCM_GEN lcm-gen PATHS /usr/bin /usr/local/bin NO_DEFAULT_PATH REQUIRED)
file(GLOB lcm_files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/lcm_types/*.lcm")
set(lcm_out "${PROJECT_BINARY_DIR}/lcm")
set(lcm_headers)
foreach(file IN LISTS lcm_files)
  get_filename_component(type "${file}" NAME_WE)
  list(APPEND lcm_headers "${lcm_out}/rc10/${type}.hpp")
endforeach()
add_custom_command(
  OUTPUT ${lcm_headers}
  COMMAND "${CMAKE_COMMAND}" -E make_directory "${lcm_out}"
  COMMAND "${LCM_GEN}" --cpp --cpp-hpath "${lcm_out}" ${lcm_files}
  DEPENDS ${lcm_files}
  COMMENT "Generating LCM types"
  VERBATIM)
add_custom_target(rc10_lcm_headers DEPENDS ${lcm_headers})
add_library(rc10_lcm_types INTERFACE)
add_dependencies(rc10_lcm_types rc10_lcm_headers)
target_include_directories(rc10_lcm_types SYSTEM INTERFACE "${lcm_out}")
add_library(rc10::lcm_types ALIAS rc10_lcm_types)
