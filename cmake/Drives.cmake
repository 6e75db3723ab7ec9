# src/drives: a folder for each family of drives, in two targets, and the list of families above them.
#
#   rc10_drives_motors      what commands a drive. It sees no simulation
#   rc10_drives_by_frames   what stands at the other end of the wire: simulated drives, and what recognises one on a
#                           bus and words its frames. Of the first it sees frames, models and families alone: no mistake of a motor repeats itself
#   rc10_drives             the list of families
#
# An include root with links to the headers that a target may see makes the wrong include a compiler's error.

set(drives_folder "${PROJECT_SOURCE_DIR}/src/drives")
file(GLOB drives_sources CONFIGURE_DEPENDS "${drives_folder}/*/*.cpp")
file(GLOB_RECURSE drives_headers RELATIVE "${drives_folder}" CONFIGURE_DEPENDS "${drives_folder}/*.hpp")
set(drives_far_side "_(simulated[a-z_]*|recogniser|wording)\\.[ch]pp$")

# rc10_drives_side(<target> SOURCES <file>... SEES <header>... USES <layer>...)
function(rc10_drives_side target)
  cmake_parse_arguments(ARG "" "" "SOURCES;SEES;USES" ${ARGN})
  set(include_root "${PROJECT_BINARY_DIR}/layers/${target}")
  file(REMOVE_RECURSE "${include_root}")
  foreach(header ${ARG_SEES})
    cmake_path(GET header PARENT_PATH family)
    file(MAKE_DIRECTORY "${include_root}/drives/${family}")
    file(CREATE_LINK "${drives_folder}/${header}" "${include_root}/drives/${header}" SYMBOLIC)
  endforeach()
  add_library(${target} STATIC ${ARG_SOURCES})
  target_include_directories(${target} PRIVATE "${include_root}")
  list(TRANSFORM ARG_USES PREPEND rc10_)
  target_link_libraries(${target} PUBLIC ${ARG_USES} PRIVATE rc10_warnings)
  rc10_together(${target})
endfunction()

set(motor_sources ${drives_sources})
list(FILTER motor_sources EXCLUDE REGEX "${drives_far_side}")
set(motor_headers ${drives_headers})
list(FILTER motor_headers EXCLUDE REGEX "${drives_far_side}|^[a-z]+\\.hpp$")
rc10_drives_side(rc10_drives_motors SOURCES ${motor_sources} SEES ${motor_headers} USES motor bus app)

set(far_sources ${drives_sources})
list(FILTER far_sources INCLUDE REGEX "${drives_far_side}")
set(far_headers ${drives_headers})
list(FILTER far_headers INCLUDE REGEX "${drives_far_side}|_(frames|model|family)\\.hpp$|^(recogniser|wording)\\.hpp$")
rc10_drives_side(rc10_drives_by_frames SOURCES ${far_sources} SEES ${far_headers} USES sim motor bus app)
target_link_libraries(rc10_drives_by_frames PUBLIC $<LINK_ONLY:rc10_drives_motors>)

rc10_layer(drives FLAT USES drives_by_frames drives_motors sim motor bus app)
