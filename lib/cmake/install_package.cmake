# What find_package(vasohex CONFIG) finds after an installation. The readers through Gmsh and VTK and the grids of
# deal.II have files of their own, so that programs which do not ask for them need none of these.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vasohex)

set_target_properties(vasohex_msh PROPERTIES EXPORT_NAME msh)
set_target_properties(vasohex_vtu PROPERTIES EXPORT_NAME vtu)
install(TARGETS vasohex vasohex_msh vasohex_vtu EXPORT vasohexTargets)
install(EXPORT vasohexTargets NAMESPACE vasohex:: DESTINATION ${package_dir})
if(VASOHEX_GMSH)
  set_target_properties(vasohex_gmsh PROPERTIES EXPORT_NAME gmsh)
  install(TARGETS vasohex_gmsh EXPORT vasohexGmshTargets)
  install(EXPORT vasohexGmshTargets NAMESPACE vasohex:: DESTINATION ${package_dir})
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/FindGmshSdk.cmake DESTINATION ${package_dir})
endif()
if(TARGET vasohex_vtk_readers)
  set_target_properties(vasohex_vtk_readers PROPERTIES EXPORT_NAME vtk_readers)
  install(TARGETS vasohex_vtk_readers EXPORT vasohexVtkReadersTargets)
  install(EXPORT vasohexVtkReadersTargets NAMESPACE vasohex:: DESTINATION ${package_dir})
  install(FILES adapters/vtk/read_labelmap.h adapters/vtk/read_poly_surface.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vasohex/adapters/vtk)
endif()
if(VASOHEX_HAS_DEALII)
  set_target_properties(vasohex_dealii PROPERTIES EXPORT_NAME dealii)
  install(TARGETS vasohex_dealii EXPORT vasohexDealiiTargets)
  install(EXPORT vasohexDealiiTargets NAMESPACE vasohex:: DESTINATION ${package_dir})
  install(FILES adapters/dealii/dealii_grid.h adapters/dealii/mesh_info.h
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vasohex/adapters/dealii)
endif()

install(DIRECTORY lib/vasohex DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(FILES adapters/gmsh/write_msh.h adapters/gmsh/node_order.h
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vasohex/adapters/gmsh)
if(VASOHEX_GMSH)
  install(FILES adapters/gmsh/read_msh.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vasohex/adapters/gmsh)
endif()
install(FILES adapters/vtk/write_vtu.h adapters/vtk/write_vtp.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/vasohex/adapters/vtk)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/vasohexConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/vasohexConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/vasohexConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/vasohexConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/vasohexConfigVersion.cmake
  DESTINATION ${package_dir})
