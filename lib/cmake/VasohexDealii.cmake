# deal.II, where it is there: VASOHEX_DEALII is AUTO, ON or OFF. Sets VASOHEX_HAS_DEALII and gives
#   vasohex_dealii_target(TARGET)  deal.II's include directories, flags and library for a target whose
#                                  target_link_libraries use the plain signature, as deal.II's own macro demands
if(NOT VASOHEX_DEALII STREQUAL "OFF")
  if(VASOHEX_DEALII STREQUAL "ON")
    find_package(deal.II 9.4 REQUIRED)
  else()
    find_package(deal.II 9.4 QUIET)
  endif()
endif()
set(VASOHEX_HAS_DEALII OFF)
if(deal.II_FOUND)
  set(VASOHEX_HAS_DEALII ON)
endif()

function(vasohex_dealii_target target)
  # of the two flavours only the optimised one: the other is for debugging deal.II itself
  deal_ii_setup_target(${target} RELEASE)
  # deal.II says -g, -O2 and -Wmissing-braces after our own flags
  target_compile_options(${target} PRIVATE -O3 -g0 -Wno-missing-braces)
  if(VASOHEX_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
endfunction()
