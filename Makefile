# Thin front end: every target first makes sure that what it needs is installed and built.
BUILD := build
JOBS  ?= $(shell nproc)

.PHONY: demo test bench build package docs setup sanitize format clean
demo: build
	$(BUILD)/bin/statejump compare cases/table1.toml

test: build
	ctest --test-dir $(BUILD) --output-on-failure --parallel $(JOBS)

bench: build
	PYTHONPATH=$(BUILD)/python /usr/bin/python3 bench/run.py --build $(BUILD)
	PYTHONPATH=$(BUILD)/python /usr/bin/python3 bench/umbrella.py --build $(BUILD)

build: setup
	cmake --preset release
	cmake --build $(BUILD) --parallel $(JOBS)

package: build
	cd $(BUILD) && cpack

docs: build
	/usr/bin/python3 docs/api/make.py --build $(BUILD)

setup:
	./scripts/setup.sh

sanitize: setup
	cmake --preset sanitize
	cmake --build build-sanitize --parallel $(JOBS)
	ctest --test-dir build-sanitize --output-on-failure --parallel $(JOBS)

format:
	git ls-files '*.cpp' '*.hpp' | xargs clang-format -i

clean:
	rm -rf build build-debug build-sanitize
