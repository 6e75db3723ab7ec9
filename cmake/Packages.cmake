# Debian packages, by `cpack` in a build tree; scripts/package.sh makes them all. One for each component of Install.cmake.
set(RC10_PACKAGE_RELEASE 1 CACHE STRING "The package's own revision, after the dash of its version")
set(RC10_PACKAGE_MAINTAINER "rc10d maintainers <rc10d@localhost.localdomain>" CACHE STRING
    "Who answers for packages that are handed on, as Debian writes it: Name <address>")
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rc10d)
set(CPACK_PACKAGE_CONTACT "${RC10_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "real-time motor daemon for CAN, commanded through LCM")
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL daemon client dev)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE "${RC10_PACKAGE_RELEASE}")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The library of this very build: shlibdeps of the others need not find it.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# Contents of a Debian package beside those of `cmake --install`.
set(CPACK_PRE_BUILD_SCRIPTS "${PROJECT_SOURCE_DIR}/packaging/finish.cmake")

# cpack would take that of the computer it runs on.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()

set(scripts "${PROJECT_SOURCE_DIR}/packaging")
set(CPACK_DEBIAN_DAEMON_PACKAGE_NAME rc10d)
set(CPACK_DEBIAN_DAEMON_PACKAGE_SECTION misc)
set(CPACK_DEBIAN_DAEMON_DESCRIPTION "The daemon, which turns a Linux computer with a CAN interface into the motor
controller of a robot: closed loops at 1 kHz for DJI, VESC, Damiao, RobStride,
CubeMars, moteus, ODrive, MyActuator and LK-Tech drives, safe by default. With
the LCM gateway, the command line tool rc10ctl and simulated drives.")
# libqrencode4: rc10ctl loads it when it draws a code.
set(CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS "iproute2, libqrencode4, systemd")
set(CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS can-utils)
# For rc10-config.
set(CPACK_DEBIAN_DAEMON_PACKAGE_SUGGESTS polkitd)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA
    "${scripts}/preinst;${scripts}/postinst;${scripts}/prerm;${scripts}/postrm;${scripts}/conffiles")

set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME librc10-client${soversion})
set(CPACK_DEBIAN_CLIENT_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_CLIENT_DESCRIPTION "The library of robot programs: motors, moves and modules of a robot that rc10d
runs, through LCM.")
set(CPACK_DEBIAN_CLIENT_PACKAGE_CONTROL_EXTRA "${scripts}/triggers")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME librc10-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_DESCRIPTION "Headers and libraries: librc10-client for robot programs, and librc10, the
layers of rc10d, for a daemon with motor families or modules of one's own. With
a CMake package and pkg-config files.")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "librc10-client${soversion} (= ${PROJECT_VERSION}-${RC10_PACKAGE_RELEASE}), \
libexpected-dev, liblcm-dev, libeigen3-dev, libspdlog-dev, libyaml-cpp-dev, libcli11-dev, libboost-dev, \
libgpiod-dev, libmd-dev, libmnl-dev, libsocketcan-dev")
include(CPack)
