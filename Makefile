# Every target sets up what it needs; the first one starts the console.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
COMPILED := $(VENV)/.compiled

.PHONY: run setup compile test check safety docs coverage lock licences sbom bench browser nginx mosquitto enki clean

run: compile
	$(BIN)/higvf run firefighting

setup: $(READY)

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev,docs,all]'
	touch $@

compile: $(COMPILED)

$(COMPILED): $(READY)
	$(BIN)/higvf compile
	touch $@

test: compile browser nginx mosquitto enki
	$(BIN)/pytest -n 2 --dist loadfile --ignore tests/attacks
	$(BIN)/pytest tests/attacks # by themselves: they measure the work of a tick in a process that attackers share

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/pyright
	$(BIN)/python docs/check_links.py

# A search for broken guarantees; a nightly one has a million control periods: `higvf bench --suite safety`.
TICKS ?= 100000
safety: setup
	$(BIN)/higvf bench --suite safety --ticks $(TICKS)

# The site is written to docs/_build/html; a warning, such as a reference to nowhere, is an error.
docs: setup
	$(BIN)/sphinx-build --nitpicky --fail-on-warning --quiet docs docs/_build/html
	@echo "docs/_build/html/index.html"

# Branch coverage in two passes: the equations as plain Python, without two tests that take minutes so, and the rest with
# the compiled engine. Not measured: tests that need a browser, and benchmarks, fit and reproduction (lab).
coverage: setup
	rm -f .coverage .coverage.*
	NUMBA_DISABLE_JIT=1 $(BIN)/coverage run -m pytest tests/control \
	  -k 'not speed_limit_is_part_of_the_problem and not nothing_is_violated_where_the_coupled'
	$(BIN)/coverage run -m pytest -m 'not browser' --ignore tests/control --ignore tests/lab
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report --skip-covered --sort cover

# constraints.txt holds the exact version of every package, for Python 3.11 to 3.13; `make setup` installs by it.
# requirements-hashed.txt is the same list with hashes, for `pip install --require-hashes`. Both are written here, from
# the ranges in pyproject.toml; versions stay as they are unless `make lock UPGRADE=--upgrade` asks for new ones.
LOCK := $(BIN)/uv pip compile pyproject.toml --quiet --all-extras --universal --python-version 3.11 \
  --fork-strategy fewest --no-annotate --no-header
lock: setup
	$(LOCK) $(UPGRADE) --output-file constraints.txt
	$(LOCK) --constraint constraints.txt --generate-hashes --output-file requirements-hashed.txt

# Of everything that `make setup` installs: licences as a table, and a bill of materials for a release. The tools have an
# environment of their own, so that they do not list themselves.
TOOLS := .venv-release
$(TOOLS): constraints.txt
	$(PYTHON) -m venv $@
	$@/bin/pip install --quiet --disable-pip-version-check --constraint constraints.txt cyclonedx-bom pip-licenses

licences: setup $(TOOLS)
	$(TOOLS)/bin/pip-licenses --python=$(BIN)/python --from=mixed --format=markdown --order=name --output-file=LICENCES.md

sbom: setup $(TOOLS)
	$(TOOLS)/bin/cyclonedx-py environment --pyproject pyproject.toml --output-file sbom.json $(BIN)/python

bench: setup
	$(BIN)/higvf bench --suite filter
	$(BIN)/higvf bench --suite tick

# The browser tests drive the system's Chromium; without it, and without the right to install it, they skip and say so.
browser:
	@for name in chromium chromium-browser google-chrome google-chrome-stable; do \
	  command -v $$name >/dev/null 2>&1 && exit 0; done; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq chromium; \
	else echo "chromium is not installed: browser tests will be skipped (install the package 'chromium')" >&2; fi

# Likewise for the shipped configuration of nginx, which one test module tries with the real one.
nginx:
	@command -v nginx >/dev/null 2>&1 || [ -x /usr/sbin/nginx ] && exit 0; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq nginx-light openssl; \
	else echo "nginx is not installed: its tests will be skipped (install the package 'nginx-light')" >&2; fi

# Likewise for the MQTT broker with which teams of robots are tried.
mosquitto:
	@command -v mosquitto >/dev/null 2>&1 || [ -x /usr/sbin/mosquitto ] && exit 0; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq mosquitto openssl; \
	else echo "mosquitto is not installed: its tests will be skipped (install the package 'mosquitto')" >&2; fi

# Likewise for Enki, the simulator whose e-pucks the team is tried with; Debian builds it for the system's Python.
enki:
	@/usr/bin/python3 -c 'import pyenki' 2>/dev/null && exit 0; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then \
	  apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq python3-enki2; \
	else echo "Enki is not installed: its tests will be skipped (install the package 'python3-enki2')" >&2; fi

clean:
	rm -rf $(VENV) $(TOOLS) sbom.json .pytest_cache .ruff_cache .import_linter_cache .hypothesis docs/_build .coverage .coverage.*
