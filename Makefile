# The commands of the project. `make demo` and `make test` are the two that a newcomer needs.
# Each installs what is missing from Debian (cmake/install_packages.sh), configures, builds, runs.

# x86-64-v3 where the processor has it (avx2, fma, bmi2 ...), else the baseline of its architecture.
V3 := $(shell /lib64/ld-linux-x86-64.so.2 --help 2>/dev/null | grep -c 'x86-64-v3 .supported')
PRESET ?= $(if $(filter 1,$(V3)),host-release,host-baseline)
JOBS ?= $(shell nproc)
OUT ?= out/demo
BUILD = build/$(PRESET)
INSTALL = cmake/install_packages.sh

.PHONY: demo test check check-long cross bench test-vm configure build clean

demo: build
	$(BUILD)/examples/dseam/dseam weld --camera sim --robot sim --out $(OUT)

test: build
	ctest --preset $(PRESET) -LE 'long|vm' -j $(JOBS)

configure:
	@$(INSTALL) quick
	cmake --preset $(PRESET)

build: configure
	cmake --build --preset $(PRESET) -j $(JOBS)

# Format of all sources, and the second compiler.
check:
	@$(INSTALL) quick check
	git ls-files '*.cpp' '*.hpp' | xargs clang-format-14 --dry-run --Werror
	cmake --preset host-clang
	cmake --build --preset host-clang -j $(JOBS)

# Both other processors: aarch64 under qemu-user, and lib/ on a bare Cortex-M7 without a heap.
cross:
	@$(INSTALL) quick cross
	cmake --preset aarch64-linux-release
	cmake --build --preset aarch64-linux-release -j $(JOBS)
	ctest --preset aarch64-linux-release -LE 'long|vm' -j $(JOBS)
	cmake --preset cortex-m7-none-release
	cmake --build --preset cortex-m7-none-release -j $(JOBS)

# Times beside PCL in the same run, in a folder of its own: `make test` must not need PCL afterwards.
BENCH = build/$(PRESET)-bench
bench:
	@$(INSTALL) quick bench
	cmake --preset $(PRESET) -B $(BENCH) -DDSEAM_BUILD_BENCH=ON
	cmake --build $(BENCH) -j $(JOBS) --target core_bench seam_bench
	$(BENCH)/tests/bench/core_bench --benchmark_repetitions=3
	$(BENCH)/tests/bench/seam_bench

# The campaigns and soaks that `make test` leaves out: hours.
check-long: build
	@$(INSTALL) vm
	ctest --preset $(PRESET) -L long

test-vm: build
	@$(INSTALL) vm
	tests/vm/run.sh $(BUILD)

clean:
	rm -rf build out
