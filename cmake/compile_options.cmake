# Two interface targets: what every object of the project is compiled with, and what only the parts
# that run on a controller are (lib, the hal interfaces, rt).

add_library(dseam_options INTERFACE)
target_compile_features(dseam_options INTERFACE cxx_std_20)
target_compile_options(dseam_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow
  $<$<CXX_COMPILER_ID:GNU>:-Wdouble-promotion>  # Clang's also names what is written out: double{x}.
  -Wold-style-cast -Wnon-virtual-dtor -Wvla
  $<$<BOOL:${PROJECT_IS_TOP_LEVEL}>:-Werror>  # A user's newer compiler may warn of more.
  -ffp-contract=off)  # The same bits on every processor; docs/decisions/0006 says why.

if(DSEAM_FUZZ)
  set(instrumented -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined)
  target_compile_options(dseam_options INTERFACE ${instrumented})
  target_link_options(dseam_options INTERFACE ${instrumented})
endif()

add_library(dseam_freestanding INTERFACE)
target_link_libraries(dseam_freestanding INTERFACE dseam_options)
target_compile_options(dseam_freestanding INTERFACE
  -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Wstack-usage=4096>)
target_compile_definitions(dseam_freestanding INTERFACE EIGEN_NO_MALLOC)
