# Writes build_info.hpp at every build, and touches it only when it changes: the commit must be that of the build, not
# of the last time CMake was run.
# `git archive` writes its commit here (.gitattributes), as GitHub does for what it offers to download and for actions;
# whether files were changed since nobody knows. In a folder within somebody else's repository git tells of that one.
set(commit "unknown")
set(archived "$Format:%H$")
if(archived MATCHES "^[0-9a-f]+$")
  set(commit "${archived}-archived")
endif()
find_package(Git QUIET)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --show-prefix
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE below OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE bad)
  if(NOT bad AND below STREQUAL "")
    execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=40 --exclude=*
      WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE bad)
    if(NOT bad)
      set(commit "${described}")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [=[
#pragma once
#define BUILD_VERSION "@VERSION@"
#define BUILD_GIT_COMMIT "@commit@"
#define BUILD_TYPE "@TYPE@"
#define BUILD_COMPILER "@COMPILER@"
#define BUILD_FLAGS "@FLAGS@"
#define BUILD_LIBRARIES "@LIBRARIES@"
]=])
