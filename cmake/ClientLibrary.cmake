# librc10-client, what a robot program links: the layer robot_client as one shared and one static library. It
# uses only headers of the layer app, and its suggestions for misspelt names.
set_target_properties(rc10_robot_client PROPERTIES POSITION_INDEPENDENT_CODE ON)
# Its public headers are included as rc10/robot.hpp, beside the types that lcm-gen makes.
file(CREATE_LINK "${PROJECT_SOURCE_DIR}/src/robot_client/rc10" "${PROJECT_BINARY_DIR}/layers/robot_client/rc10" SYMBOLIC)

add_library(rc10_client_lib SHARED $<TARGET_OBJECTS:rc10_robot_client>)
add_library(rc10_client_lib_static STATIC $<TARGET_OBJECTS:rc10_robot_client>)
set_target_properties(rc10_client_lib PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} EXPORT_NAME client_lib)
set_target_properties(rc10_client_lib_static PROPERTIES EXPORT_NAME client_lib_static)
foreach(library rc10_client_lib rc10_client_lib_static)
  target_sources(${library} PRIVATE src/app/nearest.cpp)
  set_target_properties(${library} PROPERTIES OUTPUT_NAME rc10-client POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${library} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/layers/robot_client;${PROJECT_BINARY_DIR}/layers/app>")
  target_link_libraries(${library} PUBLIC tl::expected Threads::Threads $<BUILD_INTERFACE:rc10::lcm>
                        $<BUILD_INTERFACE:rc10_lcm_types>)
endforeach()
add_library(rc10::client_lib ALIAS rc10_client_lib)
add_library(rc10::client_lib_static ALIAS rc10_client_lib_static)
