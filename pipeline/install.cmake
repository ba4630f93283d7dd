# What `cmake --install` and `cpack -G DEB` put where. The program finds it by its own place (pipeline/system/own_place.hpp):
# PREFIX/share/collision_benchmark is laid out as the tree is.
include(GNUInstallDirs)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # `scripts/setup pipeline` has built what is installed; tests are not
set(share ${CMAKE_INSTALL_DATADIR}/collision_benchmark)

install(TARGETS pipeline RUNTIME)

# The command line about itself, read off its own definitions.
set(described ${CMAKE_BINARY_DIR}/described)
file(MAKE_DIRECTORY ${described})
install(CODE "
foreach(what man bash zsh)
  execute_process(COMMAND \"$<TARGET_FILE:pipeline>\" describe \${what} OUTPUT_FILE \"${described}/\${what}\" COMMAND_ERROR_IS_FATAL ANY)
endforeach()")
install(FILES ${described}/man DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 RENAME pipeline.1)
install(FILES ${described}/bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME pipeline)
install(FILES ${described}/zsh DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions RENAME _pipeline)
if(peer_plugins)
  install(TARGETS ${peer_plugins} LIBRARY DESTINATION lib/collision_benchmark)
endif()

install(DIRECTORY configs DESTINATION ${share})
install(DIRECTORY algorithms/program algorithms/plugin DESTINATION ${share}/algorithms PATTERN __pycache__ EXCLUDE)
install(DIRECTORY algorithms/peers/web DESTINATION ${share}/algorithms/peers PATTERN node_modules EXCLUDE)
install(FILES README.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/collision-benchmark)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/collision-benchmark RENAME copyright)
foreach(page algorithms pipeline configs analysis geometry)
  install(FILES ${page}/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/collision-benchmark/${page})
endforeach()
install(FILES pipeline/FILE.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/collision-benchmark/pipeline)

# For methods of others: one header, found by find_package(collision_benchmark) or pkg-config.
include(CMakePackageConfigHelpers)
install(FILES algorithms/plugin.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/collision_benchmark)
file(WRITE ${CMAKE_BINARY_DIR}/collision_benchmark-config.cmake.in [=[
@PACKAGE_INIT@
if(NOT TARGET collision_benchmark::plugin)
  add_library(collision_benchmark::plugin INTERFACE IMPORTED)
  set_target_properties(collision_benchmark::plugin PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "@PACKAGE_CMAKE_INSTALL_INCLUDEDIR@/collision_benchmark")
endif()
]=])
configure_package_config_file(${CMAKE_BINARY_DIR}/collision_benchmark-config.cmake.in
  ${CMAKE_BINARY_DIR}/collision_benchmark-config.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_DATADIR}/cmake/collision_benchmark
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/collision_benchmark-config-version.cmake
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(FILES ${CMAKE_BINARY_DIR}/collision_benchmark-config.cmake ${CMAKE_BINARY_DIR}/collision_benchmark-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_DATADIR}/cmake/collision_benchmark)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/collision_benchmark.pc @ONLY CONTENT [=[
prefix=${pcfiledir}/../..
Name: collision_benchmark
Description: Header for collision methods as plug-ins of the benchmark
Version: @PROJECT_VERSION@
Cflags: -I${prefix}/@CMAKE_INSTALL_INCLUDEDIR@/collision_benchmark
]=])
install(FILES ${CMAKE_BINARY_DIR}/collision_benchmark.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig)

# The Python part: the folder analysis under a name of its own, where Debian's python3 looks; and for the scripts under
# the name that it has in the tree.
set(python lib/python3/dist-packages)
install(DIRECTORY analysis/ DESTINATION ${python}/collision_analysis
  PATTERN __pycache__ EXCLUDE PATTERN *.md EXCLUDE PATTERN error_against_time.svg EXCLUDE PATTERN scene.png EXCLUDE)
file(CREATE_LINK ../../${python}/collision_analysis ${CMAKE_BINARY_DIR}/described/analysis SYMBOLIC)
install(FILES ${CMAKE_BINARY_DIR}/described/analysis DESTINATION ${share})
foreach(script analysis front python report results sweep)
  install(PROGRAMS scripts/${script} DESTINATION ${share}/scripts)
endforeach()
file(CONFIGURE OUTPUT ${described}/collision-analysis @ONLY CONTENT [=[
#!/bin/sh
# collision-analysis report|scene|statements|study|sweep|front|results ...: what results say; each has --help.
scripts=$(dirname "$(realpath "$0")")/../@CMAKE_INSTALL_DATADIR@/collision_benchmark/scripts
case ${1:-} in
  sweep|front|results) command=$1; shift; exec "$scripts/$command" "$@" ;;
  *) exec "$scripts/analysis" "$@" ;;
esac
]=])
install(PROGRAMS ${described}/collision-analysis TYPE BIN)

set(CPACK_PACKAGE_NAME collision-benchmark)
set(CPACK_PACKAGE_CONTACT "the authors of collision-benchmark <nobody@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Benchmark of discrete collision detection between triangle meshes")
set(CPACK_PACKAGE_DESCRIPTION "Simulates or replays a scene, decides exactly which bodies meet, asks approximate methods the same\nquestion, times them, and stores answers, errors and times in one HDF5 file.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy, python3-h5py, python3-h5netcdf, python3-xarray, python3-pandas, python3-matplotlib, python3-xxhash, python3-jinja2, python3-scipy, libjs-three, libjs-vega")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "nodejs, snakemake, bash-completion")
# What python3 keeps of the modules that it has read.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/described/prerm @ONLY CONTENT [=[
#!/bin/sh
set -e
find /usr/@python@/collision_analysis -name __pycache__ -prune -exec rm -rf {} +
]=])
file(CHMOD ${CMAKE_BINARY_DIR}/described/prerm PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/described/prerm)
include(CPack)
