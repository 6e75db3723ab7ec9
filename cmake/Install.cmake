# Places of `cmake --install`: programs, units, example robots, documents, and for programs that build on rc10d the
# libraries librc10 (the layers up to the daemon) and librc10-client with headers, a CMake package and .pc files.
include(CMakePackageConfigHelpers)

# Files without a component go into the package rc10d: Packages.cmake.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME daemon)
install(TARGETS rc10d rc10-lcm rc10ctl rc10-stop rc10-guard rc10-irq rc10-sim rc10-web RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Started by its socket alone: no command of a person's.
install(TARGETS rc10-config RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/rc10d)
install(FILES systemd/polkit/org.rc10d.config.policy DESTINATION ${CMAKE_INSTALL_DATADIR}/polkit-1/actions)
install(FILES systemd/polkit/60-rc10-config.rules DESTINATION ${CMAKE_INSTALL_DATADIR}/rc10d/polkit)
install(DIRECTORY docs/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN "*.1")
install(FILES completions/rc10ctl.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME rc10ctl)
install(DIRECTORY config/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rc10d/config FILES_MATCHING PATTERN "*.yaml" PATTERN "*.json")
install(DIRECTORY lcm_types/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rc10d/lcm_types FILES_MATCHING PATTERN "*.lcm")
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg")
install(FILES README.md README.zh-CN.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
# The page of rc10-web, which scripts/web.sh makes; scripts/package.sh sees to it.
install(DIRECTORY build/web/ DESTINATION ${CMAKE_INSTALL_DATADIR}/rc10d/web OPTIONAL PATTERN ".*" EXCLUDE)

# The units are for the prefix /usr.
set(RC10_INSTANCE_UNIT "${PROJECT_BINARY_DIR}/systemd/rc10d@.service")
include(InstanceUnit)
install(FILES systemd/rc10d.service "${RC10_INSTANCE_UNIT}" systemd/rc10-guard.service systemd/rc10-irq.service systemd/rc10-web.service
        systemd/rc10-config.socket "systemd/rc10-config@.service" DESTINATION lib/systemd/system)
foreach(unit rc10d rc10d@)
  install(FILES systemd/drop-ins/manage-link.conf DESTINATION lib/systemd/system/${unit}.service.d)
endforeach()
install(DIRECTORY systemd/drop-ins systemd/networkd systemd/limits.d DESTINATION ${CMAKE_INSTALL_DATADIR}/rc10d)
install(DIRECTORY systemd/sysusers.d systemd/tmpfiles.d systemd/sysctl.d DESTINATION lib)
install(FILES systemd/udev/60-rc10d.rules DESTINATION lib/udev/rules.d)

# One archive of the layers, so that nobody has to know their order.
set(rc10_embedded)
set(archived rc10_robot_client)
foreach(layer app bus motor module sim drives_motors drives_by_frames drives config link survey blackbox daemon)
  get_target_property(kind rc10_${layer} TYPE)
  if(kind STREQUAL "STATIC_LIBRARY")
    list(APPEND rc10_embedded $<TARGET_OBJECTS:rc10_${layer}>)
    list(APPEND archived rc10_${layer})
  endif()
endforeach()
include(PublicApi)
foreach(layer ${RC10_PUBLIC_LAYERS})
  install(DIRECTORY src/${layer} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/librc10 COMPONENT dev FILES_MATCHING PATTERN "*.hpp")
endforeach()
foreach(header ${RC10_PUBLIC_HEADERS})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES src/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/librc10/${folder} COMPONENT dev)
endforeach()
install(FILES "${PROJECT_BINARY_DIR}/generated/rc10_version.hpp" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/librc10 COMPONENT dev)
add_library(rc10_embed STATIC ${rc10_embedded})
set_target_properties(rc10_embed PROPERTIES OUTPUT_NAME rc10 EXPORT_NAME rc10 LINKER_LANGUAGE CXX)
target_compile_features(rc10_embed INTERFACE cxx_std_20)
target_include_directories(rc10_embed INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/librc10>)
target_link_libraries(rc10_embed INTERFACE
  $<INSTALL_INTERFACE:Eigen3::Eigen> $<INSTALL_INTERFACE:spdlog::spdlog> $<INSTALL_INTERFACE:yaml-cpp> $<INSTALL_INTERFACE:CLI11::CLI11>
  $<INSTALL_INTERFACE:Boost::headers> $<INSTALL_INTERFACE:tl::expected> $<INSTALL_INTERFACE:Threads::Threads>
  $<INSTALL_INTERFACE:socketcan> $<INSTALL_INTERFACE:mnl> $<INSTALL_INTERFACE:md> $<INSTALL_INTERFACE:gpiod>)

foreach(library rc10_client_lib rc10_client_lib_static)
  target_compile_features(${library} PUBLIC cxx_std_20)
  target_include_directories(${library} PUBLIC
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR};${CMAKE_INSTALL_INCLUDEDIR}/librc10>")
  target_link_libraries(${library} PUBLIC $<INSTALL_INTERFACE:rc10::lcm>)
endforeach()
install(DIRECTORY src/robot_client/rc10/ "${PROJECT_BINARY_DIR}/lcm/rc10/"
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rc10 COMPONENT dev FILES_MATCHING PATTERN "*.hpp")

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rc10)
install(TARGETS rc10_embed EXPORT rc10Targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(TARGETS rc10_client_lib rc10_client_lib_static EXPORT rc10ClientTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT client NAMELINK_COMPONENT dev
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
if(CMAKE_INTERPROCEDURAL_OPTIMIZATION)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # No archive is made of these: ordinary code, which the linker makes anew, would be compiled for nothing.
    get_property(linked GLOBAL PROPERTY RC10_COMPILED)
    list(REMOVE_ITEM linked ${archived})
    foreach(target ${linked})
      target_compile_options(${target} PRIVATE -fno-fat-lto-objects)
    endforeach()
  endif()
  # Sections that only this version of the compiler can read go.
  foreach(archive rc10_embed rc10_client_lib_static)
    install(CODE "execute_process(COMMAND \"${CMAKE_STRIP}\" --strip-debug -R .gnu.lto_* -N __gnu_lto_v1
                  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/$<TARGET_FILE_NAME:${archive}>\"
                  COMMAND_ERROR_IS_FATAL ANY)" COMPONENT dev)
  endforeach()
endif()
install(EXPORT rc10Targets NAMESPACE rc10:: DESTINATION ${package_dir} COMPONENT dev)
install(EXPORT rc10ClientTargets NAMESPACE rc10:: DESTINATION ${package_dir} COMPONENT dev)
configure_package_config_file(cmake/rc10Config.cmake.in "${PROJECT_BINARY_DIR}/rc10Config.cmake"
                              INSTALL_DESTINATION ${package_dir})
# Before 1.0 every minor version may change the interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/rc10ConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/rc10Config.cmake" "${PROJECT_BINARY_DIR}/rc10ConfigVersion.cmake"
        DESTINATION ${package_dir} COMPONENT dev)

# Relative to where they lie: the prefix may be chosen when installing.
file(RELATIVE_PATH RC10_PC_TO_PREFIX "/p/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/p")
foreach(file rc10 rc10-client)
  configure_file(cmake/${file}.pc.in "${PROJECT_BINARY_DIR}/${file}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${file}.pc" DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()
