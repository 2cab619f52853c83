# make          lint, types and all tests
# make demo     sets up an environment and runs the satellite of the paper
# make test     sets up and runs the tests, but those that are slow
# make test-all the others as well, and properties on more examples
# make systems  every description that comes with it, in one line each
# make gallery  draws docs/figures/systems and the README's first picture again
# make window   draws the pictures of a paper, a robot and the editor again (TeX, Chromium)
# make robots   27 robots (UR5 to Tiago Dual) derived and held against Pinocchio; installs its URDF files, 400 MB
# make outputs  every description in every format and language, every documented command, one digest a file;
#               make outputs REF=<commit> shows what differs from that commit, as a diff that a person reads
# make docs     builds the documentation site into build/site
# make bench    mbsym against SymPy in one run, as ratios (some minutes)

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
PIP    := $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable

.PHONY: all lint types test test-slow test-all demo systems gallery window outputs docs page extras robots robot-data consumers bench clean
.DEFAULT_GOAL := all

# What Python has compiled is kept, whatever the environment says: tests start many processes.
unexport PYTHONDONTWRITEBYTECODE

all: lint types test-all

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	    { echo "mbsym needs Python 3.11 or newer; try  make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || \
	    { echo "python's venv module is missing (on Debian: apt-get install python3-venv)"; exit 1; }
	@echo "installing mbsym and what it needs into $(VENV): a minute or two"
	@$(PIP) '.[test]'
	@$(BIN)/python -m compileall -q mbsym cli templates  # pip compiles what it copies, but not what stays in its place
	@touch $(READY)

# What some targets need besides, each once; `make extras` all of them by one call of pip.
# docs: the site.  robots: Pinocchio and its robots.  consumers: who reads the exports, for their tests, 700 MB.
$(VENV)/.has-%: $(READY)
	@$(PIP) '.[$*]'
	@touch $@

extras: $(READY)
	@$(PIP) '.[docs,robots,consumers]'
	@touch $(addprefix $(VENV)/.has-,docs robots consumers)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY)
	$(BIN)/mypy

TESTS := $(BIN)/python -m pytest --numprocesses auto --dist worksteal

# Which cases are slow stands in tests/durations.json.
test: $(READY)
	$(TESTS) -m "not slow"

# What `make test` leaves out, and every property once more, on more examples; PART=1/6 for a sixth of it.
test-slow: $(READY)
	$(TESTS) -m "slow or hypothesis" --hypothesis-profile thorough $(addprefix --part ,$(PART))

test-all: test test-slow

demo: $(READY)
	$(BIN)/mbsym run systems/satellite.yaml

systems: $(READY)
	$(BIN)/mbsym run systems --brief

# Most figures are kept smaller than they are drawn, in fewer colours: the repository holds them.
define SMALL
import sys; from PIL import Image; \
image = Image.open(sys.argv[1]).convert('RGB'); image.thumbnail((512, 512), Image.Resampling.LANCZOS); \
image.quantize(32, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(sys.argv[2], optimize=True)
endef

# The system, how long it moves, which of its figures, further options, anything for a small one.
define figure
$(BIN)/mbsym simulate systems/$(1).yaml --time $(2) --format png --out reports/gallery/$(1) --no-estimate --quiet $(4)
$(if $(5),$(BIN)/python -c "$(SMALL)",cp) reports/gallery/$(1)/$(3).png docs/figures/systems/$(1).png

endef

# The system, its axes and settings.
define map
$(BIN)/mbsym map systems/$(1).yaml $(2) --format png --out reports/gallery/map-$(1) --quiet
$(BIN)/python -c "$(SMALL)" reports/gallery/map-$(1)/map.png docs/figures/systems/map-$(1).png

endef

gallery: $(READY)
	@mkdir -p docs/figures/systems
	$(call figure,tethered-satellites,60,motion)
	$(call figure,satellite-with-damper,120,drift,--set p2=1/2)
	$(call figure,gyrostat,0.1,motion,,small)
	$(call figure,orbital-gyrostat,12,motion,,small)
	$(call figure,clebsch,8,motion,,small)
	$(call figure,gravity-gradient,20000,motion,--set psi=0.5 --set theta=0.4 --set phi=0.3,small)
	$(call figure,dumbbell,6000,motion,--set alpha=0.8 --set beta=0.4,small)
	$(call figure,satellite,20,motion)
	$(call figure,double-pendulum,6,motion)
	$(call figure,bicycle,1,motion,,small)
	$(call figure,rolling-disc,2,motion,,small)
	$(call figure,rolling-disc-in-a-circle,3,motion,,small)
	$(call figure,rolling-sphere,6,motion,,small)
	$(call figure,turntable-sphere,4,motion,,small)
	$(call figure,dish-sphere,3,motion,,small)
	$(call figure,snakeboard,6,motion,,small)
	$(call figure,chaplygin-sleigh,10,motion,,small)
	$(call figure,four-bar,6,motion,,small)
	$(call figure,cartesian-pendulum,4,motion,,small)
	$(call figure,cart-pole,2,motion,,small)
	$(call figure,gyrostat-poisson,0.1,motion,,small)
	$(call figure,clebsch-poisson,8,motion,,small)
	$(call map,satellite,--x alpha=-1:1 --y gamma=0:1 -s p1=2/5 -s p2=1/5)
	$(call map,gravity-gradient,--x A=0:2 --y B=0:2 -s C=1)
	$(call map,ziegler-damped,--x b1=0:1/5 --y b2=0:1/5 -s P=9/5)
	$(call map,orbital-gyrostat,--x h=-9:9 --y A=2:8)
	$(call map,satellite-with-damper,--x omega=0:5 --y Lambda=0:2)
	$(call map,heavy-top,--x Omega=0:100 --y l=0:1/2)
	$(call map,bicycle,--x v=0:10)
	$(BIN)/python tests/site/draw_hoop.py docs/figures

# The pictures of the README beside the first.
window: $(READY)
	PYTHONPATH=tests:tests/browser:tests/site $(BIN)/python tests/browser/draw_doors.py docs/figures

outputs: $(READY)
	$(BIN)/python tests/outputs.py build/outputs $(if $(REF),--ref $(REF)) $(if $(ONLY),--only $(ONLY))

docs: $(VENV)/.has-docs
	$(BIN)/mkdocs build --strict --quiet

# What is built is shipped, so that installing needs no Node; tests/browser holds it against the sources.
page:
	cd editor && npm ci --ignore-scripts --no-audit --no-fund --silent && npm run --silent build

# They are among the slow tests where the data are there.
robots: robot-data
	$(TESTS) tests/robots

robot-data: $(VENV)/.has-robots

consumers: $(VENV)/.has-consumers

bench: robot-data $(VENV)/.has-bench
	$(BIN)/python tests/bench/run.py
	$(BIN)/python tests/bench/rows_bench.py
	$(BIN)/python tests/bench/loops_bench.py
	$(BIN)/python tests/bench/sweep_bench.py
	$(BIN)/python tests/bench/maps_bench.py
	$(BIN)/python tests/bench/peers_bench.py
	$(BIN)/python tests/bench/choice_bench.py
	$(BIN)/python tests/bench/equilibria_bench.py
	PYTHONPATH=tests:tests/browser $(BIN)/python tests/bench/window_bench.py

# What can be made again; reports are the user's.
clean:
	rm -rf $(VENV) build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find cli mbsym templates tests -name __pycache__ -type d -prune -exec rm -rf {} + 2>/dev/null || true
