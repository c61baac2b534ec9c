# The commands of the project. `make demo` and `make test` are the two that a newcomer needs.
# Each installs what is missing from Debian (cmake/install_packages.sh), configures, builds, runs.

# x86-64-v3 where the processor has it (avx2, fma, bmi2 ...), else the baseline of its architecture.
V3 := $(shell /lib64/ld-linux-x86-64.so.2 --help 2>/dev/null | grep -c 'x86-64-v3 .supported')
PRESET ?= $(if $(filter 1,$(V3)),host-release,host-baseline)
JOBS ?= $(shell nproc)
OUT ?= out/demo
BUILD = build/$(PRESET)
THREADED = rt_core_test rt_linux_test rt_session_test candump_test socketcan_test fake_camera_test \
  aravis_camera_test aravis_multipart_test aravis_fault_sweep_test aravis_camera_contract_test \
  v4l2_camera_test v4l2_camera_contract_test can_bus_contract_test
CYCLE = rt_core_test rt_session_test link_test
INSTALL = cmake/install_packages.sh

.PHONY: demo test check check-long coverage cross sanitize fuzz bench paper-tables test-vm configure build clean

demo: build
	$(BUILD)/examples/dseam/dseam weld --camera sim --robot sim --out $(OUT)

test: build
	ctest --preset $(PRESET) -LE 'long|vm' -j $(JOBS)

configure:
	@$(INSTALL) quick
	cmake --preset $(PRESET)

build: configure
	cmake --build --preset $(PRESET) -j $(JOBS)

# Format of all sources, the second compiler, every public header by itself, and lint (.clang-tidy).
check:
	@$(INSTALL) quick check
	git ls-files '*.cpp' '*.hpp' | xargs clang-format-14 --dry-run --Werror
	cmake --preset host-clang
	cmake --build --preset host-clang -j $(JOBS)
	cmake --build --preset host-clang -j $(JOBS) --target all_verify_interface_header_sets
	git ls-files 'lib/*.cpp' 'hal/*.cpp' 'rt/*.cpp' 'examples/*.cpp' | \
	  xargs -n 4 -P $(JOBS) clang-tidy-14 --quiet -p build/host-clang

# The quick tests under the address and undefined-behaviour sanitizers, those with threads under the
# thread sanitizer, and the cycle's paths under the real-time sanitizer.
sanitize:
	@$(INSTALL) quick rtsan
	cmake --preset host-asan
	cmake --build --preset host-asan -j $(JOBS)
	ctest --preset host-asan -LE 'long|vm' -j $(JOBS)
	cmake --preset host-tsan
	cmake --build --preset host-tsan -j $(JOBS) --target $(THREADED)
	export TSAN_OPTIONS="suppressions=$(CURDIR)/tests/hal/aravis/thread_sanitizer.supp history_size=7"; \
	for t in $(THREADED); do $$(find build/host-tsan/tests -type f -name $$t) || exit 1; done
	cmake --preset host-rtsan
	cmake --build --preset host-rtsan -j $(JOBS) --target $(CYCLE)
	for t in $(CYCLE); do $$(find build/host-rtsan/tests -type f -name $$t) || exit 1; done

# Everything that parses under libFuzzer, FUZZ_SECONDS each; what it finds grows in build/fuzz.
FUZZ_SECONDS ?= 60
fuzz:
	@$(INSTALL) quick check
	cmake --preset host-fuzz
	cmake --build --preset host-fuzz -j $(JOBS) --target fuzzers
	for t in tests/fuzz/corpus/*; do t=$$(basename $$t); mkdir -p build/fuzz/$$t; \
	  build/host-fuzz/tests/fuzz/$$t -max_total_time=$(FUZZ_SECONDS) -rss_limit_mb=2048 \
	    -artifact_prefix=build/fuzz/ build/fuzz/$$t tests/fuzz/corpus/$$t || exit 1; done

# Every branch of the weld session and its gates, by their own tests.
coverage:
	@$(INSTALL) quick coverage
	cmake --preset host-coverage
	cmake --build --preset host-coverage -j $(JOBS) --target rt_core_test rt_session_test
	tests/rt/check_coverage.sh build/host-coverage

# Both other processors: aarch64 under qemu-user, and lib/ on a bare Cortex-M7 without a heap.
cross:
	@$(INSTALL) quick cross
	cmake --preset aarch64-linux-release
	cmake --build --preset aarch64-linux-release -j $(JOBS)
	ctest --preset aarch64-linux-release -LE 'long|vm' -j $(JOBS)
	cmake --preset cortex-m7-none-release
	cmake --build --preset cortex-m7-none-release -j $(JOBS)
	ctest --preset cortex-m7-none-release

# Times beside PCL in the same run, in a folder of its own: `make test` must not need PCL afterwards.
# All of them are run, whichever misses what is asked.
BENCH = build/$(PRESET)-bench
bench:
	@$(INSTALL) quick bench
	cmake --preset $(PRESET) -B $(BENCH) -DDSEAM_BUILD_BENCH=ON
	cmake --build $(BENCH) -j $(JOBS) --target core_bench core_growth seam_bench set_point_bench splice_bench
	failed=; \
	run() { echo; "$$@" || failed="$$failed $$1"; }; \
	run $(BENCH)/tests/bench/core_bench --benchmark_repetitions=3; \
	run tests/bench/check_growth.py $(BENCH)/tests/bench/core_growth; \
	run $(BENCH)/tests/bench/seam_bench; \
	run $(BENCH)/tests/bench/set_point_bench; \
	run $(BENCH)/tests/bench/splice_bench; \
	[ -z "$$failed" ] || { echo "missed what was asked:$$failed"; exit 1; }

# The paper's Tables 4, 5 and 6 beside the same quantities here: minutes.
paper-tables:
	@$(INSTALL) quick bench
	cmake --preset $(PRESET) -B $(BENCH) -DDSEAM_BUILD_BENCH=ON
	cmake --build $(BENCH) -j $(JOBS) --target paper_tables
	$(BENCH)/tests/bench/paper_tables

# The campaigns and soaks that `make test` leaves out: hours.
check-long: build
	@$(INSTALL) vm bench
	ctest --preset $(PRESET) -L long
	cmake --preset $(PRESET) -B $(BENCH) -DDSEAM_BUILD_BENCH=ON
	cmake --build $(BENCH) -j $(JOBS) --target core_oracle core_growth
	ctest --test-dir $(BENCH) --output-on-failure -R '^bench[.]'

test-vm: build
	@$(INSTALL) vm
	tests/vm/run.sh $(BUILD)

clean:
	rm -rf build out
