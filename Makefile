# Two commands matter: `make run` and `make test`. Each installs what it needs first; a second start checks stamps only.
SHELL := /bin/bash
.DELETE_ON_ERROR:
MAKEFLAGS += --no-builtin-rules

SOURCE ?= simulated
DATA   ?= build
SITE   ?= deploy/sites/$(SOURCE)/site.toml
# Figures of the running box are compared over months: on the same film.
BENCH_SITE ?= deploy/sites/footage/site.toml
SHARED ?= ../shared/data

ifneq ($(words $(DATA)),1)
$(error DATA is '$(DATA)': make knows no folder with a space in its name; name another folder)
endif

FOOTAGES := footage footage2
FILM_OF_simulated := $(DATA)/simulated/six_actions/installed.json
FILM_OF_footage   := $(DATA)/footage/installed.json
FILM_OF_footage2  := $(DATA)/footage2/installed.json
FILMS := $(FILM_OF_simulated) $(FILM_OF_footage) $(FILM_OF_footage2)

VENV   := .venv
PYTHON := $(VENV)/bin/python
WEB    := services/tablet/web
# For `make bench-reconstruct DATASET=h36m PATH=folder`, PATH is the user's folder and not where programs are.
ifeq ($(origin PATH),command line)
DATASET_PATH := $(PATH)
override PATH := /usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
endif
override export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export NUMBA_CACHE_DIR := $(abspath $(DATA))/kernels

.PHONY: help run test check setup networks film footage simulated web bytecode kernels body check-body motions check-motions standards check-standards lock clean distclean test-faults test-mutations test-motions test-rendering bench-faults bench-start bench-box bench-footage bench-peers bench-footage2 bench-shelf bench-lessons bench-reconstruct bench-simulate bench-networks bench-feedback bench-keyframes bench-measures twin

help: ## Show this list
	@grep -hE '^[a-z0-9-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-17s %s\n", $$1, $$2}'

run: setup ## Start KineBox on the built-in lesson (SOURCE=footage or footage2: films of people) and print the address of the page
	@exec $(VENV)/bin/kinebox run --site $(SITE) --data $(DATA)

test: ## All tests but the four suites below: unit, property, golden, real sockets and processes, the page in Chromium
	@$(MAKE) --no-print-directory --silent --jobs=2 $(SETUP) $(FILMS) $(DATA)/tests.ready
	@# An open page or a running box takes a core for as long as it is there: one at a time, beside all others.
	@$(MAKE) --no-print-directory --jobs=3 tests-of-the-whole tests-of-parts tests-of-the-page

WHOLE := tests/browser tests/system
.PHONY: tests-of-the-page tests-of-the-whole tests-of-parts
tests-of-the-page: $(WEB)/node_modules/.ready
	cd $(WEB) && npm test

tests-of-the-whole: $(VENV)/.ready
	$(PYTHON) -m pytest -q $(WHOLE)

tests-of-parts: $(VENV)/.ready # many wait, for processes and deadlines; the order is that of tests/conftest.py
	$(PYTHON) -m pytest -q -n 3 --dist loadfile --no-loadscope-reorder $(addprefix --ignore=,$(WHOLE))

# Each process of pytest compiles every test that it does not find compiled, for 10 s of CPU: one does it before the others begin.
test check fast-tests: export PYTHONDONTWRITEBYTECODE :=
$(DATA)/tests.ready: $(shell find tests -name '*.py') | $(VENV)/.ready
	@mkdir -p $(@D)
	@$(PYTHON) -m pytest --collect-only -qq > /dev/null
	@touch $@

check: $(VENV)/.ready ## Formatting, types, import boundaries and the fast tests; under a minute (of the page: lint-page)
	@$(MAKE) --no-print-directory --jobs=2 --output-sync=line lint fast-tests # the type checker leaves cores idle

.PHONY: lint lint-page fast-tests
fast-tests: $(VENV)/.ready
	$(PYTHON) -m pytest -q -n 2 --dist loadfile -m "not slow" $(addprefix --ignore=,$(WHOLE) tests/faults)

lint: $(VENV)/.ready
	ruff format --check .
	ruff check .
	lint-imports
	mypy

lint-page: $(WEB)/node_modules/.ready ## Formatting and types of the page
	cd $(WEB) && npm run --silent check

SETUP := $(VENV)/.ready networks film web bytecode kernels
setup: ## Install everything that the two commands need
	@$(MAKE) --no-print-directory --silent --jobs=2 $(SETUP)

$(VENV)/.ready: requirements.lock pyproject.toml deploy/setup/check-machine
	@deploy/setup/check-machine
	@echo "Installing Python packages (about 60 s) ..."
	@python3 -m venv $(VENV)
	@$(VENV)/bin/pip install --disable-pip-version-check --quiet --progress-bar on --retries 10 --require-hashes -r requirements.lock
	@$(VENV)/bin/pip install --disable-pip-version-check --quiet --no-deps --no-build-isolation --editable .
	@touch $@

networks: $(DATA)/networks/installed.json ## Fetch the networks' weights and convert them
$(DATA)/networks/installed.json: models/networks/manifest.toml $(wildcard models/networks/build/*.py) | $(VENV)/.ready
	@$(PYTHON) -m models.networks.build.install --data $(DATA)
	@touch $@

.PHONY: film
film: $(FILM_OF_$(SOURCE)) # what SOURCE plays, if it is built in

simulated: $(FILM_OF_simulated) ## Prepare the built-in simulated lesson
$(FILM_OF_simulated): edge/simulation/shipped/install.py edge/simulation/shipped/worker.py $(wildcard edge/simulation/shipped/six_actions/*) | $(VENV)/.ready
	@$(PYTHON) -m edge.simulation.shipped.install --data $(DATA)
	@touch $@

footage: $(FILM_OF_$(filter footage%,$(SOURCE))) ## Fetch and prepare the built-in footage that SOURCE names
$(FOOTAGES:%=$(DATA)/%/installed.json): $(wildcard edge/footage/*.py) | $(VENV)/.ready
	@$(PYTHON) -m edge.footage.prepare --data $(DATA) --name $(notdir $(@D))
	@touch $@

web: $(WEB)/dist/index.html ## Build the tablet's page
$(WEB)/node_modules/.ready: $(WEB)/package-lock.json | $(VENV)/.ready
	@echo "Installing the page's packages (about 10 s) ..."
	@cd $(WEB) && npm ci --no-audit --no-fund --no-progress --loglevel=error
	@touch $@
WEB_SOURCES := $(shell find $(WEB)/src $(WEB)/public -type f) $(addprefix $(WEB)/,index.html package.json svelte.config.js tsconfig.json vite.config.ts)
$(WEB)/dist/index.html: $(WEB)/node_modules/.ready $(WEB_SOURCES)
	@echo "Building the page (about 5 s) ..."
	@cd $(WEB) && npm run --silent build -- --logLevel error
	@touch $@

# A process that may not write beside its modules, or is told not to, would compile them at every start.
bytecode: $(DATA)/bytecode.ready ## Compile our own Python modules
$(DATA)/bytecode.ready: $(shell find edge models services -name '*.py' -not -path '*/node_modules/*') | $(VENV)/.ready
	@mkdir -p $(@D)
	@$(PYTHON) -m compileall -q -x node_modules edge models services
	@touch $@

kernels: $(DATA)/kernels/.ready ## Compile the numerical kernels, so that no live frame waits for it
$(DATA)/kernels/.ready: models/compiled.py $(wildcard services/fusion/*.py services/evaluation/*.py) | $(VENV)/.ready
	@# Numba looks at the file of each kernel, and not at how all are compiled.
	@$(if $(filter models/compiled.py,$?),rm -rf $(@D))
	@mkdir -p $(@D)
	@echo "Compiling numerical kernels (about 45 s) ..."
	@$(PYTHON) -m services.cli.compile_kernels
	@touch $@

test-faults: setup $(FILM_OF_footage) ## The box killed, stopped and starved: every fault drill once, on the real processes
	$(PYTHON) -m pytest -m faults tests/faults

test-mutations: setup ## 100,000 mutated messages on each topic and on the tablet's socket
	$(PYTHON) -m pytest -m mutations tests/mutations

test-motions: $(VENV)/.ready ## Simulated pupils of all ages perform every action in every way; every fault and its size; the twin finds a known network again
	$(PYTHON) -m pytest -n 2 -m motions tests/property tests/unit/test_twin.py

test-rendering: setup ## Lessons rendered, found again, broken off and out of disk; ten attempts from pixels to the page; some 15 minutes
	$(PYTHON) -m pytest -m rendering tests/integration tests/browser

bench-faults: setup $(FILM_OF_footage) ## Recovery and lost recording over 20 runs of each fault drill; some 80 minutes (--drills, --runs, --no-page in ARGS)
	$(PYTHON) -m tests.bench.faults --data $(DATA) $(ARGS)

bench-start: setup $(FILM_OF_footage) ## Seconds from the command to the figure in the browser, everything installed
	$(PYTHON) -m tests.bench.start --site $(BENCH_SITE) --data $(DATA)

bench-box: setup $(FILM_OF_footage) ## Live rate, latency, CPU and memory of the whole box, 300 s and at half the CPU
	$(PYTHON) -m tests.bench.box --site $(BENCH_SITE) --data $(DATA)

bench-lessons: setup $(FILM_OF_footage) ## What recording costs: the recorder's CPU, and the size of a lesson of 45 minutes
	$(PYTHON) -m tests.bench.lessons --site $(BENCH_SITE) --data $(DATA)

build/peers/%/.ready: tests/bench/peers/%/requirements.lock | $(VENV)/.ready
	@echo "Installing $* in an environment of its own (some minutes) ..."
	@python3 -m venv $(@D)
	@$(@D)/bin/pip install --disable-pip-version-check --quiet --require-hashes -r $<
	@touch $@

bench-footage: setup $(FILM_OF_footage) build/peers/pose2sim/.ready ## Accuracy on the built-in footage, beside Pose2Sim on the same keypoints
	$(PYTHON) -m tests.bench.footage.one_person --data $(DATA)

bench-peers: setup $(FILM_OF_footage) build/peers/pose2sim/.ready build/peers/aniposelib/.ready ## Pose2Sim and aniposelib beside our fusion, on the same keypoints
	$(PYTHON) -m tests.bench.peers --data $(DATA)

bench-footage2: setup $(FILM_OF_footage2) ## The pupil among two people, on the second built-in footage
	$(PYTHON) -m tests.bench.footage.two_people --data $(DATA)

bench-reconstruct: $(VENV)/.ready networks kernels build/peers/pose2sim/.ready build/peers/aniposelib/.ready ## Rendered lessons through the whole box, against their truth (ARGS=--full; or DATASET=h36m|panoptic|shelf PATH=folder)
	$(PYTHON) -m tests.bench.reconstruct --data $(DATA) $(if $(DATASET),--dataset $(DATASET) --path "$(DATASET_PATH)") $(ARGS)

bench-simulate: $(VENV)/.ready kernels ## Time and memory that rendering a lesson of 24 s takes; some minutes
	$(PYTHON) -m tests.bench.simulate --data $(DATA) $(ARGS)

bench-networks: $(VENV)/.ready networks kernels ## How well the pose networks see simulated pupils, and the landmark bias
	$(PYTHON) -m tests.bench.networks --data $(DATA) $(ARGS)

bench-feedback: setup ## How soon the running box says what it says of the built-in lesson, and whether it corrects anything (--seconds, --site in ARGS)
	$(PYTHON) -m tests.bench.teaching.live --site deploy/sites/simulated/site.toml --data $(DATA) $(ARGS)

bench-keyframes: $(VENV)/.ready networks kernels ## Attempts, keyframes and cues: rendered (the first time for hours), on true motion, on the twin; half an hour without one (ARGS=--on rendered|true|twin|idle)
	$(PYTHON) -m tests.bench.teaching.keyframes --data $(DATA) $(ARGS)

bench-measures: $(VENV)/.ready networks kernels ## Angles, jumps and all else that is measured, against the truth on the twin (ARGS=--on rendered: on films), and jumps over a force plate (SHARED)
	$(PYTHON) -m tests.bench.teaching.measures --data $(DATA) --shared $(SHARED) $(ARGS)

twin: $(VENV)/.ready networks kernels ## Fit the twin to rendered lessons anew (the first time they are rendered, which takes hours), and print how far it agrees
	$(PYTHON) -m tests.bench.twin --data $(DATA) $(ARGS)

bench-shelf: $(VENV)/.ready ## Everyone on the Shelf data (SHARED, not part of the repository), beside a greedy baseline
	$(PYTHON) -m tests.bench.shelf --data $(DATA) --shared $(SHARED)

build/body/.ready: models/body/build/requirements.lock
	@echo "Installing the body's exporter in an environment of its own ..."
	@python3 -m venv $(@D)
	@$(@D)/bin/pip install --disable-pip-version-check --quiet --require-hashes -r $<
	@touch $@

BODY_EXPORT := ANNY_CACHE_DIR=$(CURDIR)/build/body/cache NUMBA_CACHE_DIR=$(CURDIR)/build/body/kernels build/body/bin/python -m models.body.build.export

body: build/body/.ready ## Export the body's files anew (they are in the repository; only its maintainers need this)
	$(BODY_EXPORT)

check-body: build/body/.ready ## Compare the body's files with a fresh export
	$(BODY_EXPORT) --check

build/motions/.ready: models/motions/build/requirements.lock
	@echo "Installing the motions' exporter in an environment of its own ..."
	@python3 -m venv $(@D)
	@$(@D)/bin/pip install --disable-pip-version-check --quiet --require-hashes -r $<
	@touch $@

motions: build/motions/.ready ## Export the recorded motion anew (it is in the repository; only its maintainers need this)
	build/motions/bin/python -m models.motions.build.export

check-motions: build/motions/.ready ## Compare the recorded motion with a fresh export
	build/motions/bin/python -m models.motions.build.export --check

standards: $(VENV)/.ready ## Export the standards of the simulated library anew (they are in the repository; only its maintainers need this)
	$(PYTHON) -m models.teaching.build.export

check-standards: $(VENV)/.ready ## Compare the standards with a fresh export
	$(PYTHON) -m models.teaching.build.export --check

.PHONY: strips
strips: $(VENV)/.ready ## Film every action with its faults anew, for docs/actions
	$(PYTHON) -m edge.simulation.rendering.strip

lock: ## Compile requirements.lock anew after a change of pyproject.toml
	$(PYTHON) -m venv build/lock && build/lock/bin/pip install --quiet uv
	build/lock/bin/uv pip compile pyproject.toml --extra web --extra dev --universal --python-version 3.11 \
	  --generate-hashes --no-emit-index-url --no-header --no-annotate --quiet -o requirements.lock

clean: ## Remove what was built, but not the downloads' results
	rm -rf $(WEB)/dist $(DATA)/kernels $(DATA)/bytecode.ready $(DATA)/bench .mypy_cache .ruff_cache .pytest_cache

distclean: clean ## Remove everything that was installed or downloaded, too; lessons, logs and what a school taught stay
	rm -rf $(VENV) $(DATA)/networks $(FOOTAGES:%=$(DATA)/%) $(DATA)/downloads $(DATA)/simulated/six_actions build/peers build/lock build/body build/motions $(WEB)/node_modules *.egg-info .hypothesis .import_linter_cache
