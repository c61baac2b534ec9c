# Most of a build goes into parsing the headers of Eigen and GoogleTest again for each source.
# dseam_precompile(TARGET HEADER...) parses them once for a target, dseam_precompile_as(TARGET DONOR)
# takes those of another one that is compiled with the same options. Off in the preset host-clang,
# which so proves that every source includes what it uses.
option(DSEAM_PRECOMPILE "Parse the headers of other libraries once for each target" ${PROJECT_IS_TOP_LEVEL})

function(dseam_precompile target)
  if(DSEAM_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

function(dseam_precompile_as target donor)
  if(DSEAM_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${donor})
  endif()
endfunction()
