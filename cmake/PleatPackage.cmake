# What is installed beside the programs, and the Debian package (`./dev package`). The manual page and the
# completions are printed by the program itself, so they never differ from it.
set(package_dir ${CMAKE_BINARY_DIR}/package)
add_custom_command(
  OUTPUT ${package_dir}/pleat.1.gz ${package_dir}/pleat.bash ${package_dir}/_pleat ${package_dir}/pleat.fish
  COMMAND ${CMAKE_COMMAND} -E make_directory ${package_dir}
  COMMAND $<TARGET_FILE:pleat> manual > ${package_dir}/pleat.1
  COMMAND gzip -9nf ${package_dir}/pleat.1
  COMMAND $<TARGET_FILE:pleat> completion bash > ${package_dir}/pleat.bash
  COMMAND $<TARGET_FILE:pleat> completion zsh > ${package_dir}/_pleat
  COMMAND $<TARGET_FILE:pleat> completion fish > ${package_dir}/pleat.fish
  DEPENDS pleat VERBATIM)
add_custom_target(package_files DEPENDS ${package_dir}/pleat.1.gz)
add_dependencies(package_files pleat pleat-draco pleatd)

install(TARGETS pleat pleat-draco pleatd RUNTIME COMPONENT programs)
install(FILES ${package_dir}/pleat.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
install(FILES ${package_dir}/pleat.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME pleat COMPONENT programs)
install(FILES ${package_dir}/_pleat DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions
        COMPONENT programs)
install(FILES ${package_dir}/pleat.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
        COMPONENT programs)
install(FILES server/systemd/pleatd.service DESTINATION lib/systemd/system COMPONENT programs)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pleat RENAME copyright COMPONENT programs)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pleat)
set(CPACK_PACKAGE_CONTACT "The Pleat developers <pleat@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "turns mesh animations into characters that can be edited")
set(CPACK_PACKAGE_DESCRIPTION "Pleat finds the skeleton of a captured or simulated mesh animation and learns how its
 surface folds. The command line, the server for training and live frames, and the studio for browsers.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL programs)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME pleat)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)
include(CPack)
