# Writes build_info.hpp at every build, and touches it only when it changes: the commit must be that of the build, not
# of the last time CMake was run.
find_package(Git QUIET)
set(commit "unknown")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --abbrev=40 --exclude=*
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE bad)
  if(NOT bad)
    set(commit "${described}")
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
