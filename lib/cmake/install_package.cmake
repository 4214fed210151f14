# What find_package(vasohex CONFIG) finds after an installation. The readers through Gmsh and VTK and the grids of
# deal.II have files of their own, so that programs which do not ask for them need none of these.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vasohex)

# vasohex_<name> as vasohex::<name>, in an export set of its own where one is named, with its headers.
function(install_adapter name folder export)
  set_target_properties(vasohex_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS vasohex_${name} EXPORT ${export})
  if(NOT export STREQUAL vasohexTargets)
    install(EXPORT ${export} NAMESPACE vasohex:: DESTINATION ${package_dir})
  endif()
  list(TRANSFORM ARGN PREPEND adapters/${folder}/)
  install(FILES ${ARGN} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vasohex/adapters/${folder})
endfunction()

install(TARGETS vasohex EXPORT vasohexTargets)
install_adapter(msh gmsh vasohexTargets write_msh.h node_order.h)
install_adapter(vtu vtk vasohexTargets write_vtu.h write_vtp.h)
install(EXPORT vasohexTargets NAMESPACE vasohex:: DESTINATION ${package_dir})
if(VASOHEX_GMSH)
  install_adapter(gmsh gmsh vasohexGmshTargets read_msh.h)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/FindGmshSdk.cmake DESTINATION ${package_dir})
endif()
if(TARGET vasohex_vtk_readers)
  install_adapter(vtk_readers vtk vasohexVtkReadersTargets read_labelmap.h read_poly_surface.h)
endif()
if(VASOHEX_HAS_DEALII)
  install_adapter(dealii dealii vasohexDealiiTargets dealii_grid.h mesh_info.h)
endif()

install(DIRECTORY lib/vasohex DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/vasohexConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/vasohexConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/vasohexConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/vasohexConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/vasohexConfigVersion.cmake
  DESTINATION ${package_dir})
