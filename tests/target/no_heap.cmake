# Fails when the image holds a symbol of a heap.
execute_process(COMMAND ${NM} --demangle ${IMAGE} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]* (malloc|_malloc_r|calloc|free|_free_r|_sbrk|operator (new|delete)[^\n]*)\n" heap "${symbols}")
if(heap)
  message(FATAL_ERROR "symbols of a heap in ${IMAGE}:\n${heap}")
endif()
