# The Gmsh SDK (gmsh.h and its library; GPL) as the target GmshSdk::gmsh.
find_path(GMSH_INCLUDE_DIR gmsh.h)
find_library(GMSH_LIBRARY gmsh)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(GmshSdk REQUIRED_VARS GMSH_LIBRARY GMSH_INCLUDE_DIR
  REASON_FAILURE_MESSAGE "install libgmsh-dev, or configure vasohex with -DVASOHEX_GMSH=OFF")
if(GmshSdk_FOUND AND NOT TARGET GmshSdk::gmsh)
  add_library(GmshSdk::gmsh UNKNOWN IMPORTED)
  set_target_properties(GmshSdk::gmsh PROPERTIES IMPORTED_LOCATION ${GMSH_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${GMSH_INCLUDE_DIR})
endif()
