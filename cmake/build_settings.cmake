# What every target of the package is compiled with.

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Results must not depend on where the compiler finds it convenient to fuse a product and a sum.
add_compile_options(-ffp-contract=off)

if(VIBRO_IMPACT_SANITIZE STREQUAL "address")
  set(sanitizers address,undefined)
elseif(VIBRO_IMPACT_SANITIZE STREQUAL "thread")
  set(sanitizers thread)
elseif(VIBRO_IMPACT_SANITIZE)
  message(FATAL_ERROR "VIBRO_IMPACT_SANITIZE is '${VIBRO_IMPACT_SANITIZE}', must be address, thread or empty")
endif()
if(VIBRO_IMPACT_SANITIZE)
  add_compile_options(-fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${sanitizers})
  add_compile_definitions(VIBRO_IMPACT_SANITIZE)
endif()

if(VIBRO_IMPACT_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang" OR NOT VIBRO_IMPACT_SANITIZE STREQUAL "address")
    message(FATAL_ERROR "VIBRO_IMPACT_FUZZ needs CMAKE_CXX_COMPILER=clang++ and VIBRO_IMPACT_SANITIZE=address "
      "(they are ${CMAKE_CXX_COMPILER_ID} and '${VIBRO_IMPACT_SANITIZE}')")
  endif()
  # What the fuzzer steers by.
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

# Large headers of libraries, which most sources of a target wait for, are compiled once: vibro_impact_precompile(TARGET
# HEADER...). The targets of a folder share what the first of them has compiled.
option(VIBRO_IMPACT_PRECOMPILED_HEADERS "Compile large headers of libraries once, not once a source" ON)
function(vibro_impact_precompile target)
  if(NOT VIBRO_IMPACT_PRECOMPILED_HEADERS)
    return()
  endif()
  get_property(first DIRECTORY PROPERTY vibro_impact_precompiled)
  if(first)
    target_precompile_headers(${target} REUSE_FROM ${first})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
    set_property(DIRECTORY PROPERTY vibro_impact_precompiled ${target})
  endif()
endfunction()

# Our own code only: vibro_impact_target_settings(TARGET).
function(vibro_impact_target_settings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror)
endfunction()
