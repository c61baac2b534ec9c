# dseam_library(NAME): a static library target dseam_NAME with the alias dseam::NAME, whose public
# headers are installed as file sets. Topics add their sources with dseam_sources().

function(dseam_library name)
  add_library(dseam_${name} STATIC)
  add_library(dseam::${name} ALIAS dseam_${name})
  set_target_properties(dseam_${name} PROPERTIES EXPORT_NAME ${name})
  set_property(GLOBAL APPEND PROPERTY DSEAM_INSTALLED_TARGETS dseam_${name})
endfunction()

# dseam_sources(NAME BASE include-dir SOURCES a.cpp ... HEADERS dseam/x/y.hpp ...)
function(dseam_sources name)
  cmake_parse_arguments(ARG "" "BASE" "SOURCES;HEADERS" ${ARGN})
  foreach(source IN LISTS ARG_SOURCES)
    target_sources(dseam_${name} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/${source})
  endforeach()
  list(TRANSFORM ARG_HEADERS PREPEND ${ARG_BASE}/)
  target_sources(dseam_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${ARG_BASE} FILES ${ARG_HEADERS})
endfunction()
