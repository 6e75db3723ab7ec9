# Every library comes from Debian 12 by name: see scripts/install-deps.sh.
# A folder on PATH whose neighbour has libraries, as an environment of conda, is not asked for any.
set(CMAKE_FIND_USE_SYSTEM_ENVIRONMENT_PATH OFF)
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(tl-expected REQUIRED)
find_package(Eigen3 3.3 REQUIRED NO_MODULE)

add_library(rc10::yaml INTERFACE IMPORTED)
target_link_libraries(rc10::yaml INTERFACE yaml-cpp)

pkg_check_modules(LIBSECCOMP REQUIRED IMPORTED_TARGET libseccomp)
add_library(rc10::seccomp ALIAS PkgConfig::LIBSECCOMP)

# 2.x has another interface.
pkg_check_modules(LIBGPIOD REQUIRED IMPORTED_TARGET "libgpiod>=1.6" "libgpiod<2")
add_library(rc10::gpiod ALIAS PkgConfig::LIBGPIOD)
pkg_check_modules(LIBSOCKETCAN REQUIRED IMPORTED_TARGET libsocketcan)
add_library(rc10::socketcan ALIAS PkgConfig::LIBSOCKETCAN)
pkg_check_modules(LIBMD REQUIRED IMPORTED_TARGET libmd)
add_library(rc10::md ALIAS PkgConfig::LIBMD)
pkg_check_modules(LIBMNL REQUIRED IMPORTED_TARGET libmnl)
add_library(rc10::mnl ALIAS PkgConfig::LIBMNL)
# Its header alone: rc10ctl loads libqrencode.so.4 where it draws a code.
pkg_check_modules(LIBQRENCODE REQUIRED "libqrencode>=4" "libqrencode<5")
add_library(rc10::qrencode INTERFACE IMPORTED)
target_include_directories(rc10::qrencode INTERFACE ${LIBQRENCODE_INCLUDE_DIRS})

# lcm.pc requires glib's .pc files, which liblcm-dev does not depend on.
find_path(LCM_INCLUDE_DIR lcm/lcm.h REQUIRED)
find_library(LCM_LIBRARY lcm REQUIRED)
add_library(rc10::lcm INTERFACE IMPORTED)
target_include_directories(rc10::lcm INTERFACE "${LCM_INCLUDE_DIR}")
target_link_libraries(rc10::lcm INTERFACE "${LCM_LIBRARY}")
