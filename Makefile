# Everything from a bare checkout: `make demo` shows the widgets, `make test` checks that they work.
# Needs Python 3.10 or later. Node comes from PyPI into .venv; nothing is installed outside the checkout,
# but for a missing Chromium, Firefox, ROS 1 or venv module on Debian as root.

SHELL := bash
PYTHON ?= python3
JS := robowidgets/js
SOURCES := $(shell find $(JS) -path $(JS)/node_modules -prune -o -type f \( -name '*.ts' -o -name '*.css' -o -name '*.mjs' \) -print)
INSTALLED := .venv/.installed
# The demo installs what it needs and no more; for all else, everything is installed at once.
RUNNABLE := $(if $(filter-out demo lab build,$(or $(MAKECMDGOALS),demo)),$(INSTALLED),.venv/.runnable)
MODULES := $(JS)/node_modules/.package-lock.json
EXPORT_MODULES := tests/browser/node_modules/.package-lock.json
BUNDLES := $(patsubst $(JS)/%.ts,robowidgets/static/%.js,$(wildcard $(JS)/*_widget.ts $(JS)/export_*.ts $(JS)/run_once.ts))
PYTEST := .venv/bin/python -m pytest
# Twice as many as cores: unit tests wait for half of their time. Files that take long come first (tests/unit/conftest.py).
UNITS := $(PYTEST) --numprocesses 4 --dist loadfile --no-loadscope-reorder tests/unit
BROWSER := $(PYTEST) --numprocesses 3 --dist loadgroup tests/browser

export PATH := $(CURDIR)/.venv/bin:$(PATH)
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# The tests start hundreds of processes and kernels: the package is compiled for the first of them.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo setup build exports watch lab lint sizes format check test test-all test-rest
.PHONY: environments test-versions test-oldest test-newest
.PHONY: test-js test-unit test-ros1 test-notebooks test-docs test-wheel test-browser chromium browsers site bench pictures clean
.NOTPARALLEL:
.DELETE_ON_ERROR:

demo: build
	.venv/bin/robowidgets demo

setup: $(INSTALLED) $(MODULES)

build: $(BUNDLES)

exports: $(EXPORT_MODULES)

# Two terminals: one rebuilds the bundles at every change, in the other JupyterLab puts each new one on show.
watch: setup
	cd $(JS) && npm run watch

lab: build
	ROBOWIDGETS_DEV=1 ANYWIDGET_HMR=1 .venv/bin/jupyter lab notebooks

lint: setup build
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy
	.venv/bin/python scripts/words.py
	.venv/bin/check-jsonschema --quiet --builtin-schema vendor.github-workflows .github/workflows/*.yml
	.venv/bin/check-jsonschema --quiet --builtin-schema vendor.citation-file-format CITATION.cff
	cd $(JS) && npm run --silent check

# What each widget weighs and imports, and what more of it costs: figures, no limit.
sizes: setup build
	.venv/bin/python scripts/sizes.py
	.venv/bin/python scripts/imports.py

format: setup
	.venv/bin/ruff check --fix .
	.venv/bin/ruff format .
	cd $(JS) && npm run --silent format

# The loop after each change, in two minutes; `make test` before each commit.
check: lint test-js sizes
	$(UNITS) -m 'not slow'

# All that is quick, and one path of each widget in a real browser.
test:
	scripts/side_by_side.sh '$(MAKE) setup build exports' '$(MAKE) chromium'
	scripts/side_by_side.sh '$(MAKE) lint test-js test-wheel' '$(MAKE) test-notebooks'
	$(UNITS) -m 'not slow'
	$(BROWSER) -m core

# Everything.
test-all: test test-rest

# Everything that `make test` leaves out.
test-rest: setup build $(EXPORT_MODULES)
	scripts/side_by_side.sh '$(MAKE) test-docs' '$(MAKE) browsers' scripts/ros1.sh
	$(MAKE) test-ros1
	$(UNITS) -m slow
	$(BROWSER) -m 'not core'

test-js: setup
	cd $(JS) && npm run --silent test

test-unit: setup build
	$(UNITS)

# The units on the oldest and on the newest Python that is there, each skipped without such a Python. The newest takes the
# newest versions of all packages, the oldest the oldest that pyproject.toml allows.
test-versions: test-oldest test-newest

OLDEST := oldest 3.10
NEWEST := newest "3.14 3.13"

environments: setup
	scripts/side_by_side.sh 'scripts/venv_on.sh $(OLDEST)' 'scripts/venv_on.sh $(NEWEST)'

# Left out on both: what needs no version of another package and of no Python in particular (`make test-unit` runs it).
# Of DDS, feeds/test_contract.py runs there.
ON_NO_OTHER := scanogram simulator shapes path plots message lessons test_layers.py test_names.py test_looks.py \
  repair/test_fuzz.py feeds/test_dds.py \
  samples/test_distance.py sonar/test_sonar_ring.py $(patsubst %,recordings/test_%.py,distances endings places scanogram) \
  $(patsubst tests/unit/%,%,$(wildcard tests/unit/recordings/test_find*.py))
# Left out on the oldest besides: the longest files, and what stands for a browser.
NOT_ON_THE_OLDEST := $(ON_NO_OTHER) behaviors runtime/test_locks.py recordings/test_show.py repair/test_clock.py \
  driving/test_drive_widget.py notebook/test_not_in_browser.py screens/test_to_html.py widget/test_watch.py

test-oldest: setup build
	scripts/units_on.sh $(OLDEST) -m 'not slow or versions' $(addprefix --ignore tests/unit/,$(NOT_ON_THE_OLDEST))

test-newest: setup build
	scripts/units_on.sh $(NEWEST) -m 'not slow or versions' $(addprefix --ignore tests/unit/,$(ON_NO_OTHER))

test-ros1: setup build
	scripts/ros1.sh
	$(PYTEST) --numprocesses 3 tests/ros1

test-notebooks: setup build
	$(PYTEST) --numprocesses 4 --dist worksteal tests/test_notebooks.py tests/test_lesson_languages.py tests/test_study.py

# The tests that run a page follow each other: by default, one process gets most of them.
test-docs: setup build
	$(PYTEST) --numprocesses 3 --dist worksteal --doctest-modules --ignore $(JS) tests/test_docs.py tests/test_odd_scans.py robowidgets

test-wheel: setup
	$(PYTEST) tests/test_wheel.py

test-browser: setup build $(EXPORT_MODULES) browsers
	$(BROWSER)

chromium:
	scripts/chromium.sh

# Chromium, Firefox and JupyterLite for the browser tests.
browsers: setup chromium
	scripts/firefox.sh
	scripts/lite.sh

# The documentation, and JupyterLite with the lessons in site/lite, as a folder of files that any web server serves.
site: setup build $(EXPORT_MODULES)
	scripts/lite.sh
	.venv/bin/pip install --quiet --group site
	.venv/bin/python scripts/docs_site.py site $(if $(ROBOWIDGETS_PYODIDE_NUMPY),--lite)
	.venv/bin/python scripts/lite_site.py site/lite docs=site/try
	rm -r site/try

bench: setup build chromium
	.venv/bin/pip install --quiet --group bench
	.venv/bin/python -m benchmarks

# Draws the pictures, and writes the pages, of the documentation anew; look at them before you commit them.
pictures: setup build chromium
	PICTURES=1 $(PYTEST) tests/browser/test_gallery.py
	mkdir -p docs/images
	for picture in tests/screenshots/gallery-*@2x.png; do \
	  name=$${picture##*/gallery-}; cp "$$picture" "docs/images/$${name%@2x.png}.png"; done
	for film in tests/screenshots/gallery-*.webp; do cp "$$film" "docs/images/$${film##*/gallery-}"; done
	mkdir -p docs/pages
	for page in tests/screenshots/gallery-*.html; do cp "$$page" "docs/pages/$${page##*/gallery-}"; done

clean:
	rm -rf .venv .venv-site .venv-oldest .venv-newest $(JS)/node_modules tests/browser/node_modules robowidgets/static
	rm -rf site tests/screenshots benchmarks/results .pytest_cache .mypy_cache .ruff_cache dist

# Not compiled: only a small part is ever imported.
.venv/.runnable: pyproject.toml scripts/venv.sh scripts/apt.sh
	scripts/venv.sh $(PYTHON)
	SKIP_JUPYTER_BUILDER=1 .venv/bin/pip install --quiet --no-compile --group js --editable '.[lab]'
	touch $@

$(INSTALLED): pyproject.toml scripts/venv.sh scripts/apt.sh
	scripts/venv.sh $(PYTHON)
	SKIP_JUPYTER_BUILDER=1 .venv/bin/pip install --quiet --no-compile --group dev --editable '.[lab]'
	touch .venv/.runnable $@

$(MODULES): $(JS)/package.json $(JS)/package-lock.json $(RUNNABLE)
	cd $(JS) && npm ci --no-audit --no-fund
	touch $@

$(EXPORT_MODULES): tests/browser/package.json tests/browser/package-lock.json $(RUNNABLE)
	cd tests/browser && npm ci --no-audit --no-fund --ignore-scripts
	touch $@

$(BUNDLES): $(SOURCES) $(MODULES)
	cd $(JS) && npm run --silent build
