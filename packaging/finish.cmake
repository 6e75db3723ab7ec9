# Run by cpack on the installed files, one folder for each component, before they become packages.
cmake_minimum_required(VERSION 3.22)

# File times in packages are those of the last commit: the same sources make the same packages.
set(date "$ENV{SOURCE_DATE_EPOCH}")
if(NOT date)
  set(date 0)
endif()
execute_process(COMMAND date --utc --rfc-email --date=@${date} OUTPUT_VARIABLE date_text OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(root "${CPACK_TEMPORARY_DIRECTORY}/${component}")
  set(doc "${root}/usr/share/doc/${package}")
  file(COPY "${CMAKE_CURRENT_LIST_DIR}/copyright" DESTINATION "${doc}")
  file(WRITE "${doc}/changelog.Debian"
    "${package} (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
    "  * See changelog.gz.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date_text}\n")
  configure_file("${CMAKE_CURRENT_LIST_DIR}/../CHANGELOG.md" "${doc}/changelog" COPYONLY)
  file(GLOB_RECURSE compressed "${doc}/changelog*" "${root}/usr/share/man/man*/*.[1-8]")
  execute_process(COMMAND gzip --best --no-name ${compressed} COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE shared "${root}/usr/lib/*.so.*")
  foreach(library IN LISTS shared)
    if(NOT IS_SYMLINK "${library}")
      file(CHMOD "${library}" PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
    endif()
  endforeach()
endforeach()

# Below /etc, where no prefix leads.
set(root "${CPACK_TEMPORARY_DIRECTORY}/daemon")
file(MAKE_DIRECTORY "${root}/etc/rc10d" "${root}/etc/security")
file(RENAME "${root}/usr/share/rc10d/limits.d" "${root}/etc/security/limits.d")
file(MAKE_DIRECTORY "${root}/etc/needrestart/conf.d")
file(COPY_FILE "${CMAKE_CURRENT_LIST_DIR}/needrestart.conf" "${root}/etc/needrestart/conf.d/rc10d.conf")
