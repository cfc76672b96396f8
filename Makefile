# Thin front to CMake's presets: `make` says what there is.
JOBS ?= $(shell nproc)
FUZZ_SECONDS ?= 600
ETENDUE := build/release/apps/cli/etendue
SOURCES = $(shell find src apps tests bench -name '*.cpp' -o -name '*.h')

# $(call build,PRESET): configures once, then builds; ninja configures again by itself when a CMakeLists.txt changes.
define build
	@test -e build/$(1)/build.ninja || cmake --preset $(1)
	@cmake --build --preset $(1) --parallel $(JOBS)
endef

.PHONY: help
help:
	@echo 'make demo         install what is missing, build, and render the first picture into out/'
	@echo 'make test         the same, then run every test and the fuzzers for a minute'
	@echo 'make build        install what is missing and build build/release/apps/cli/etendue'
	@echo 'make bench        build and run the benchmarks'
	@echo 'make bench-peers  measure beside Blender'\''s Cycles on scenes/bench/; PEERS='\''--scenes a,b'\'' and more: scripts/bench_peers.py --help'
	@echo 'make figures      render what each setting does, into out/figures/index.html; QUICK=1: small and noisy'
	@echo 'make conformance  render Mitsuba'\''s tests and compare, into out/conformance/index.html; needs ETENDUE_SHARED'
	@echo 'make asan         run the tests under AddressSanitizer and UndefinedBehaviorSanitizer'
	@echo 'make tsan         run the tests under ThreadSanitizer'
	@echo 'make fuzz         feed the file readers damaged files for FUZZ_SECONDS=$(FUZZ_SECONDS)'
	@echo 'make format       lay out the sources with clang-format'
	@echo 'make tidy         read the sources with clang-tidy'
	@echo 'make clean        remove build/ and out/'

.PHONY: dependencies
dependencies:
	@scripts/install-dependencies.sh

.PHONY: build
build: dependencies
	$(call build,release)

.PHONY: demo
demo: build
	@mkdir -p out
	$(ETENDUE) render scenes/cornell-spheres.dae --camera-placement file -r 640 480 -s 256 --exposure 0.5 --time-limit 1m \
	  -o out/demo.png -o out/demo.exr

.PHONY: test
test: build
	ctest --preset release
	@$(MAKE) --no-print-directory fuzz FUZZ_SECONDS=60

.PHONY: bench
bench: dependencies
	$(call build,bench)
	@for program in $$(find build/bench/bench -name '*_bench' -type f -executable); do $$program || exit 1; done

.PHONY: bench-peers
bench-peers: build
	@scripts/install-dependencies.sh --peers
	scripts/bench_peers.py --etendue $(ETENDUE) $(PEERS)

.PHONY: figures
figures: build
	scripts/make_figures.py --etendue $(ETENDUE) $(if $(QUICK),--quick)

.PHONY: conformance
conformance: build
	scripts/conformance.py --etendue $(ETENDUE) --seeds 1,2,3

.PHONY: asan tsan
asan tsan: dependencies
	$(call build,$@)
	ctest --preset $@

.PHONY: fuzz
fuzz:
	@scripts/install-dependencies.sh --fuzz
	$(call build,fuzz)
	@scripts/run-fuzzers.sh build/fuzz $(FUZZ_SECONDS)

.PHONY: format
format:
	@scripts/install-dependencies.sh --lint
	clang-format -i $(SOURCES)

.PHONY: tidy
tidy: build
	@scripts/install-dependencies.sh --lint
	printf '%s\n' $(filter %.cpp,$(SOURCES)) | xargs -P $(JOBS) -n 4 clang-tidy --quiet -p build/release

.PHONY: clean
clean:
	rm -rf build out
