# Takes the project as a sub-directory: it configures without its programs' and tests' packages, and
# a user's newer compiler that warns of more does not stop his build.
file(REMOVE_RECURSE ${BINARY})
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${WITHIN} -B ${BINARY} -G Ninja -DDSEAM=${DSEAM}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON
  RESULT_VARIABLE result OUTPUT_VARIABLE text ERROR_VARIABLE text)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "it does not configure as a sub-directory:\n${text}")
endif()
file(READ ${BINARY}/compile_commands.json commands)
foreach(wanted "controller.dir" "dseam_lib.dir")
  if(NOT commands MATCHES "${wanted}")
    message(FATAL_ERROR "${wanted} is not built")
  endif()
endforeach()
if(commands MATCHES "-Werror" OR commands MATCHES "dseam_program.dir")
  message(FATAL_ERROR "somebody else's project gets -Werror or the programs")
endif()
