# The two commands: `make demo` and `make test`.
PRESET ?= host-release

.PHONY: test
test:
	cmake --preset $(PRESET)
	cmake --build --preset $(PRESET)
	ctest --preset $(PRESET)
