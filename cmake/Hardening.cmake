# Mistakes in what parses end the process, and are no way into it. The presets of what is shipped have it.
option(RC10_HARDEN "Fortified libc calls; for what parses, stack protector, checked indices and control-flow protection" OFF)
# Layers of the tick, not hardened: checked indices were 12 % of its instructions, the stack protector and the marks of
# control flow 6 % (docs/measuring.md). What clients send is checked before it reaches them, in daemon/clients.
set(rc10_real_time_layers app bus motor module sim daemon)
set(rc10_hardening "")

if(RC10_HARDEN)
  # Level 3 came with GCC 12.
  set(fortify 3)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12)
    set(fortify 2)
  endif()
  # It needs optimisation.
  add_compile_options($<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE> $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=${fortify}>)
  set(rc10_hardening -fstack-protector-strong -fstack-clash-protection -D_GLIBCXX_ASSERTIONS)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND rc10_hardening -fcf-protection=full)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64")
    list(APPEND rc10_hardening -mbranch-protection=standard)
  endif()
endif()

# rc10_hardened(<target>): what parses.
function(rc10_hardened target)
  target_compile_options(${target} PRIVATE ${rc10_hardening})
endfunction()
