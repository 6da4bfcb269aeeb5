# Thin front end: every target first makes sure that what it needs is installed, configured and built,
# and no more. A part that another target has switched on stays on.
BUILD := build
JOBS  ?= $(shell nproc)
PYTHON := /usr/bin/python3

# $(call configure,PART ...): the build tree, with these parts besides what the demo needs.
configure = { test -e $(BUILD)/build.ninja || cmake --preset demo -B $(BUILD); } && \
            cmake $(foreach part,$(1),-DSTATEJUMP_BUILD_$(part)=ON) $(BUILD) >/dev/null
compile = cmake --build $(BUILD) --parallel $(JOBS)

.PHONY: demo build tests test check quick bench package validation docs sanitize sanitize-threads sanitize-yade format clean
demo:
	./scripts/setup.sh run build
	$(call configure)
	$(compile) --target demo
	$(BUILD)/bin/statejump compare cases/table1.toml

build:
	./scripts/setup.sh run build page
	$(call configure,REPORT)
	$(compile)

tests:
	./scripts/setup.sh run build page test docs
	$(call configure,REPORT TESTS)
	$(compile)

test: tests
	ctest --test-dir $(BUILD) -LE '^check$$' --output-on-failure --parallel $(JOBS)

# Slow checks of the sources, of the tests themselves, and of damaged files and killed processes.
check: tests
	ctest --test-dir $(BUILD) -L '^check$$' --output-on-failure --parallel $(JOBS) --no-tests=error

# Both models and their tests of some seconds each.
quick:
	./scripts/setup.sh run build test
	$(call configure,TESTS)
	$(compile) --target models
	ctest --test-dir $(BUILD) -L quick -LE lint --output-on-failure --parallel $(JOBS) --no-tests=error

bench:
	./scripts/setup.sh run build bench
	$(call configure,BENCH)
	$(compile)
	PYTHONPATH=$(BUILD)/python $(PYTHON) studies/bench/run.py --build $(BUILD)
	PYTHONPATH=$(BUILD)/python $(PYTHON) studies/bench/umbrella.py --build $(BUILD)

package: build
	./scripts/setup.sh package
	cd $(BUILD) && cpack

# Entries of the validation manual: fails if a verdict differs from the kept one.
validation:
	./scripts/setup.sh run build
	$(call configure)
	$(compile) --target models
	PYTHONPATH=$(BUILD)/python $(PYTHON) studies/validation/make_manual.py --check

docs:
	./scripts/setup.sh run build docs
	$(call configure)
	$(compile) --target models
	$(PYTHON) docs/site/make.py --build $(BUILD)

sanitize:
	./scripts/setup.sh build test
	cmake --preset sanitize
	cmake --build build-sanitize --parallel $(JOBS)
	ctest --test-dir build-sanitize -LE '^check$$' --output-on-failure --parallel $(JOBS)

sanitize-threads sanitize-yade:
	./scripts/setup.sh run build test
	cmake --preset $@
	cmake --build --preset $@ --parallel $(JOBS)
	ctest --preset $@ --no-tests=error

format:
	git ls-files '*.cpp' '*.hpp' | xargs clang-format -i

clean:
	rm -rf build build-debug build-sanitize build-sanitize-threads build-sanitize-yade
