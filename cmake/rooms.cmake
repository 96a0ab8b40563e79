# vitrine_library(NAME [TARGET_SIDE] [COLD] USES rooms... LINKS libraries... PRECOMPILE headers...)
#
# The library of one room, made of all sources in the current folder. USES names the rooms whose headers it may include;
# tests/rooms reads the same calls and fails on any other include. TARGET_SIDE: built without exceptions and RTTI.
# COLD: nothing in it runs long; compiled with -O1, which is quicker.
# PRECOMPILE: large headers that most of the sources include anyway; compiling them once halves the time of a build.
set(VITRINE_WARNINGS -Wall -Wextra -Werror -Wshadow -Wno-missing-field-initializers)
# Results must not depend on the compiler's freedom with floating point. Nobody reads errno or traps: without them roots and
# choices are single instructions.
set(VITRINE_FLOATS -ffp-contract=off -fno-fast-math -fno-math-errno -fno-trapping-math)

function(vitrine_options target)
  target_compile_options(${target} PRIVATE ${VITRINE_WARNINGS} ${VITRINE_FLOATS})
  target_include_directories(${target} PRIVATE ${CMAKE_SOURCE_DIR})
endfunction()

function(vitrine_library name)
  cmake_parse_arguments(ARG "TARGET_SIDE;COLD" "" "USES;LINKS;PRECOMPILE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)  # headers only
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE ${ARG_USES} ${ARG_LINKS})
    return()
  endif()
  add_library(${name} STATIC ${sources})
  vitrine_options(${name})
  target_include_directories(${name} PUBLIC ${CMAKE_SOURCE_DIR})
  if(ARG_TARGET_SIDE)
    target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti)
  endif()
  if(ARG_PRECOMPILE)
    target_precompile_headers(${name} PRIVATE ${ARG_PRECOMPILE})
  endif()
  if(ARG_COLD)
    target_compile_options(${name} PRIVATE -O1)
  endif()
  target_link_libraries(${name} PUBLIC ${ARG_USES} ${ARG_LINKS})
endfunction()
