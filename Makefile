# libvpl. `make help` lists the targets.
# Every configuration has a folder of its own:
#   make BUILD=build/clang CC=clang MODE=debug SANITIZE=address,undefined test-programs

CC      ?= cc
AR      ?= ar
BUILD   ?= build
MODE    ?= release
OPENMP  ?= 1
PREFIX  ?= /usr/local
# All processors, unless the caller said otherwise; V=1 shows whole commands.
JOBS     = $(if $(findstring -j,$(MAKEFLAGS)),,-j$(shell nproc 2>/dev/null || echo 1))
Q       := $(if $(V),,@)
DESTDIR ?=

ifeq ($(origin CC),default)
CC := gcc
endif

# -ffp-contract=off: a fused multiply-add rounds once instead of twice, so bits would depend on the machine.
# -fno-math-errno and -fno-trapping-math change no value; without them sqrtf and ?: do not vectorise.
STANDARD := -std=gnu11 -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-strict-aliasing
# One set of objects serves both libraries. What the public headers do not declare stays inside of them.
STANDARD += -fPIC -fvisibility=hidden
WARNINGS := -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wno-unknown-pragmas $(WERROR)
INCLUDES := -Iinclude -Isrc -isystem /usr/include/stb
OPT_release := -O3
OPT_debug   := -O0
CFLAGS  ?= -g
SAN     := $(if $(SANITIZE),-fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer)
OMP     := $(if $(filter 1,$(OPENMP)),-fopenmp)
ALL_CFLAGS = $(STANDARD) $(WARNINGS) $(INCLUDES) $(OPT_$(MODE)) $(OMP) $(SAN) $(CFLAGS) -MMD -MP
# EXR pictures where OpenEXR's C library is installed; EXR=0 does without.
EXR     ?= $(shell printf '\043include <OpenEXR/openexr.h>\nint main(void){exr_get_library_version(0,0,0,0);return 0;}' \
             | $(CC) -x c - -o /dev/null -lOpenEXRCore >/dev/null 2>&1 && echo 1 || echo 0)
EXR     := $(EXR)
LDLIBS  := -ljansson $(if $(filter 1,$(EXR)),-lOpenEXRCore) -lm

MACHINE := $(shell $(CC) -dumpmachine 2>/dev/null)
# 32-bit x86: its old floating point unit rounds at other places than SSE2, which all other machines agree with.
ifeq ($(shell $(CC) -dM -E -x c /dev/null 2>/dev/null | grep -c __i386__),1)
MACHINE  := i386
STANDARD += -msse2 -mfpmath=sse -mstackrealign
endif
# Windows: what it lacks of POSIX is in src/windows. gcc keeps 16 bytes of alignment on its stack, so that functions with wider
# vectors crash (gcc's bug 54412): AVX is left out. Programs need no DLL but those of Windows.
ifneq ($(findstring mingw,$(MACHINE)),)
STANDARD += -D__USE_MINGW_ANSI_STDIO=1 -Isrc/windows -include src/windows/posix.h -static
# isfinite() of its math.h is a macro that converts; gcc takes printf for the one of Microsoft, which is not linked.
WARNINGS += -Wno-float-conversion -Wno-format -Wno-format-extra-args
LDLIBS   += -lpthread
WIDE     :=
# These tests put functions of their own in the place of Linux's system calls.
ABSENT_TESTS := tests/test_faults.c
else
WIDE     := $(if $(filter x86_64%,$(MACHINE)),avx2 avx512)
endif
# make WIDE= builds without AVX2 and AVX-512.
STANDARD += $(if $(WIDE),-DVPL_WIDE)
ISAS    := scalar sse2 $(WIDE)
ISA_scalar := -fno-tree-vectorize -fno-tree-slp-vectorize
ISA_sse2   :=
# Without this gcc unrolls loops over 16 lanes completely instead of vectorising them.
LANES      := $(if $(findstring clang,$(shell $(CC) --version 2>/dev/null)),,--param max-completely-peel-times=15)
# Ray kernels have 8 lanes: 8 boxes or triangles.
$(BUILD)/obj/src/geometry/%: LANES := $(subst times=15,times=7,$(LANES))
# gcc copies 16 bytes at a time by default, and a later load of 32 bytes waits for both stores. With these options the fills
# of bench/roofline take 1/1.6 and 1/4.0 of the time under AVX2. clang copies 32 bytes by itself.
MOVES      := $(shell $(CC) -mavx2 -mmove-max=256 -mstore-max=256 -x c -c /dev/null -o /dev/null 2>/dev/null \
                && echo -mmove-max=256 -mstore-max=256)
ISA_avx2   := -mavx2 $(MOVES)
ISA_avx512 := -mavx512f -mavx512dq -mavx512bw -mavx512vl -mprefer-vector-width=512

LIB_SOURCES    := $(filter-out src/cli/% src/mpi/%,$(wildcard src/*/*.c src/*/*/*.c))
EXR_SOURCES    := $(wildcard src/image/exr*.c)
KERNEL_SOURCES := $(filter %_kernel.c,$(LIB_SOURCES))
PLAIN_SOURCES  := $(filter-out %_kernel.c,$(LIB_SOURCES))
CLI_SOURCES    := $(wildcard src/cli/*.c src/cli/*/*.c)
# PACKED=1 compiles several sources as one file, which takes half of the processor time. It is for builds from scratch: any change
# compiles all of them again. Sources with rules of their own, and stb's, are compiled alone.
ifdef PACKED
ALONE          := src/cli/main.c src/image/stb_files.c $(EXR_SOURCES)
pack            = $(filter $(ALONE),$(1)) $(shell tests/pack.sh $(BUILD)/packed $(filter-out $(ALONE),$(1)))
KERNEL_SOURCES := $(call pack,$(KERNEL_SOURCES))
PLAIN_SOURCES  := $(call pack,$(PLAIN_SOURCES))
CLI_SOURCES    := $(call pack,$(CLI_SOURCES))
vpath %.c $(BUILD)/packed
endif
LIB_OBJECTS    := $(PLAIN_SOURCES:%.c=$(BUILD)/obj/%.o) \
                  $(foreach isa,$(ISAS),$(KERNEL_SOURCES:%.c=$(BUILD)/obj/%.$(isa).o))
CLI_OBJECTS    := $(CLI_SOURCES:%.c=$(BUILD)/obj/%.o)
# SUITES="image math" builds vpl-tests with those suites only. Words that begin with - exclude tests at run time and are ignored.
CHOSEN         := $(filter-out -%,$(SUITES))
LEFT_OUT       := $(if $(CHOSEN),$(filter-out $(CHOSEN:%=tests/test_%.c),$(wildcard tests/test_*.c)))
TEST_OBJECTS   := $(patsubst %.c,$(BUILD)/obj/%.o,$(filter-out $(ABSENT_TESTS) $(LEFT_OUT),$(wildcard tests/*.c)))
GOLDEN_OBJECTS := $(BUILD)/obj/tests/golden/golden.o
BENCH_PROGRAMS := $(patsubst tests/bench/%.c,$(BUILD)/bench/%,$(wildcard tests/bench/*.c))
FUZZERS        := $(patsubst tests/fuzz/%_fuzz.c,%,$(wildcard tests/fuzz/*_fuzz.c))
REPLAYS        := $(FUZZERS:%=$(BUILD)/fuzz/%_replay)
VERSION        := $(shell sed -n 's/.*VERSION_STRING *"\(.*\)"/\1/p' include/vpl/base.h)
# The number in the soname changes with the ABI: with the minor version while the major one is 0.
SONAME         := libvpl.so.$(shell echo $(VERSION) | sed -e 's/^\(0\.[0-9]*\).*/\1/' -e 's/^\([1-9][0-9]*\)\..*/\1/')
SHARED         := libvpl.so.$(VERSION)
# Replaces malloc, which sanitizers do themselves.
NO_MEMORY      := $(if $(SANITIZE),,$(BUILD)/no-memory.so)
# Calls with wrong arguments are written by a Python program.
NULLS          := $(if $(shell command -v python3),$(BUILD)/nulls)
EXAMPLES       := $(patsubst examples/%.c,$(BUILD)/examples/%,$(wildcard examples/*.c examples/tasks/*.c))

.PHONY: all libs programs test-programs help deps demo test check-all portability lint determinism bench bench-peers golden gallery install uninstall clean format fuzz soak faults coverage test-mpi

# These call make again, so they may not run beside other goals, which would build the same files.
ifneq ($(filter all demo test,$(MAKECMDGOALS)),)
.NOTPARALLEL:
endif

# Headers that programs need, each with the Debian package that has it.
NEEDS := jansson.h=libjansson-dev stb_image.h=libstb-dev

## make             builds build/vpl and build/libvpl.a; installs nothing, but says what is missing
all:
	@missing=; command -v $(firstword $(CC)) >/dev/null || missing=" build-essential"; \
	for need in $(NEEDS); do \
	  printf '#include <%s>\n' "$${need%=*}" | $(CC) $(INCLUDES) -E -x c - >/dev/null 2>&1 || missing="$$missing $${need#*=}"; \
	done; \
	[ -z "$$missing" ] || { echo "Missing:$$missing. Get them by: sudo apt-get install$$missing (or by: make demo)" >&2; exit 1; }
	@$(MAKE) --no-print-directory $(JOBS) programs

programs: $(BUILD)/libvpl.a $(BUILD)/$(SHARED) $(BUILD)/vpl

## make demo        installs what is missing, builds, renders a living room to build/demo.png
demo: deps
	@$(MAKE) --no-print-directory $(JOBS) programs
	$(BUILD)/vpl render examples/scenes/loft.json -o $(BUILD)/demo.png
	@echo "Done: open $(BUILD)/demo.png"

## make test        installs what is missing, runs every test; ends with "N passed, N failed"
test: deps
	@$(MAKE) --no-print-directory $(JOBS) test-programs
	@tests/run.sh $(BUILD)

test-programs: programs $(NULLS) $(NO_MEMORY) $(BUILD)/vpl-tests $(BUILD)/vpl-golden $(EXAMPLES) $(REPLAYS) $(BUILD)/soak

## make check-all   installs what is missing, the tests under gcc and clang, release, debug, sanitizers, threads, aarch64
check-all: deps
	@tests/check_all.sh

## make portability the tests on musl, i386, s390x and Windows, by cross compilers, qemu and wine: installs them
portability: deps
	@tests/portability.sh

## make lint        static checks of src by cppcheck and clang-tidy (installs them)
lint: deps
	@.ci/install-deps cppcheck clang-tidy
	@tests/lint.sh

## make coverage    the share of the lines of src that the tests run, and which they leave out
coverage: deps
	@tests/coverage.sh

## make determinism the golden pictures by every compiler, optimisation, number of threads and instruction set: a table
determinism: deps
	@tests/determinism.sh

## make bench       times every stage (tests/bench/README.md explains the tables)
bench: all
	@$(MAKE) --no-print-directory $(JOBS) $(BENCH_PROGRAMS)
	$(BUILD)/vpl bench
	$(BUILD)/bench/acne
	$(BUILD)/bench/shadow examples/scenes/room.json
	$(BUILD)/bench/rays examples/scenes/room.json
	$(BUILD)/bench/interleaved examples/scenes/room.json
	$(BUILD)/bench/ssvp examples/scenes/room.json
	$(BUILD)/bench/crossover --quick examples/scenes/room.json
	$(BUILD)/bench/lightcuts examples/scenes/room.json
	$(BUILD)/bench/rsm examples/scenes/room.json
	$(BUILD)/bench/clusters examples/scenes/room.json
	$(BUILD)/bench/gbuffer examples/scenes/room.json
	$(BUILD)/bench/history examples/scenes/room.json
	$(BUILD)/bench/flicker examples/scenes/room.json instant-radiosity 12
	$(BUILD)/bench/paraboloid --quick examples/scenes/room.json
	$(BUILD)/bench/scale
	$(BUILD)/bench/edits examples/scenes/cut-outs.json
	$(BUILD)/bench/refit
	$(BUILD)/bench/path examples/scenes/room-area.json
	$(BUILD)/bench/guide examples/scenes/flat.json 1000 64
	$(BUILD)/bench/patches examples/scenes/room-area.json
	$(BUILD)/bench/form_factors examples/scenes/room-area.json
	$(BUILD)/bench/links examples/scenes/closed-room.json
	$(BUILD)/bench/patch_mesh examples/scenes/room-area.json
	$(BUILD)/bench/radiosity_motion examples/scenes/testmodel.json
	$(BUILD)/bench/roofline
	$(BUILD)/vpl bench --scaling

## make bench-peers the same room by OpenGL (llvmpipe) and by Embree, which it installs where it can
bench-peers: all
	@.ci/install-deps $(PEER_PACKAGES) || true
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/peers $(BUILD)/bench/rays
	$(BUILD)/bench/peers --threads 1 $(PEER_OPTIONS)
	$(BUILD)/bench/peers --threads 2 $(PEER_OPTIONS)
	$(BUILD)/bench/rays examples/scenes/room.json
PEER_PACKAGES := libegl-dev libgl-dev libopengl-dev libegl1 libgl1-mesa-dri libembree-dev

## make golden      rewrites golden/; the commit says why bits moved
golden: deps
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/vpl-golden
	$(BUILD)/vpl-golden write golden

## make gallery     rewrites golden/gallery and prints the numbers of README.md
gallery: all
	tests/gallery.sh $(BUILD)/vpl
	tests/bench/readme.sh $(BUILD)

## make fuzz        fuzzes the readers for FUZZ_SECONDS each (default 600)
fuzz: deps
	@tests/fuzz/run.sh $(FUZZERS)

## make soak        N random renders in one process (default 20000): memory stays flat, bits are those of fresh processes
soak: deps
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/soak
	OMP_WAIT_POLICY=passive $(BUILD)/soak $(or $(N),20000)

## make faults      every allocation fails once, every method is cancelled at every call; 300 interrupts at random moments
faults: test-programs
	VPL_EVERY_FAULT=1 $(BUILD)/vpl-tests FailedAllocation CancelledAtEveryCall
	VPL_EVERY_FAULT=1 tests/cli/run.sh $(BUILD)/vpl memory
	tests/signals.sh $(BUILD)/vpl 300

## make test-mpi    vpl-mpi: installs OpenMPI, MPICH and Slurm, builds it with both, tests 1 to 8 ranks and the batch scripts
test-mpi: deps
	@.ci/install-deps libopenmpi-dev openmpi-bin libmpich-dev mpich
	@$(MAKE) --no-print-directory $(JOBS) programs $(BUILD)/vpl-mpi.openmpi $(BUILD)/vpl-mpi.mpich
	@tests/mpi/run.sh $(BUILD)
	@.ci/install-deps slurm-wlm munge || true # without them the batch scripts are not tested
	@tests/mpi/slurm.sh $(BUILD)

## make install     libraries, headers, program, man page, libvpl.pc and a CMake package under PREFIX (/usr/local)
LIBDIR  ?= $(PREFIX)/lib
COMPLETIONS := $(PREFIX)/share/bash-completion/completions/vpl $(PREFIX)/share/zsh/site-functions/_vpl \
  $(PREFIX)/share/fish/vendor_completions.d/vpl.fish
INSTALLED := $(PREFIX)/bin/vpl $(PREFIX)/share/man/man1/vpl.1 $(LIBDIR)/libvpl.a $(LIBDIR)/$(SHARED) $(LIBDIR)/$(SONAME) \
  $(COMPLETIONS) $(LIBDIR)/libvpl.so $(LIBDIR)/pkgconfig/libvpl.pc $(LIBDIR)/cmake/libvpl $(PREFIX)/include/vpl
FILL_IN = sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(LIBDIR)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@SONAME@|$(SONAME)|' \
  -e 's|@SHARED@|$(SHARED)|' -e 's|@OMP@|$(OMP)|' -e 's|@LIBS@|$(LDLIBS)|'
install: programs $(BUILD)/vpl.1
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/include/vpl $(DESTDIR)$(LIBDIR)/pkgconfig \
	  $(DESTDIR)$(LIBDIR)/cmake/libvpl $(DESTDIR)$(PREFIX)/share/man/man1 $(dir $(COMPLETIONS:%=$(DESTDIR)%))
	install $(BUILD)/vpl $(DESTDIR)$(PREFIX)/bin
	install -m 644 include/vpl/*.h include/vpl/*.def $(DESTDIR)$(PREFIX)/include/vpl
	install -m 644 $(BUILD)/libvpl.a $(BUILD)/$(SHARED) $(DESTDIR)$(LIBDIR)
	ln -sf $(SHARED) $(DESTDIR)$(LIBDIR)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/libvpl.so
	install -m 644 $(BUILD)/vpl.1 $(DESTDIR)$(PREFIX)/share/man/man1
	$(BUILD)/vpl completion bash > $(DESTDIR)$(word 1,$(COMPLETIONS))
	$(BUILD)/vpl completion zsh > $(DESTDIR)$(word 2,$(COMPLETIONS))
	$(BUILD)/vpl completion fish > $(DESTDIR)$(word 3,$(COMPLETIONS))
	$(FILL_IN) src/libvpl.pc.in > $(DESTDIR)$(LIBDIR)/pkgconfig/libvpl.pc
	for file in Config ConfigVersion; do \
	  $(FILL_IN) src/libvpl$$file.cmake.in > $(DESTDIR)$(LIBDIR)/cmake/libvpl/libvpl$$file.cmake || exit 1; done

## make uninstall   removes what install put there
uninstall:
	rm -rf $(INSTALLED:%=$(DESTDIR)%)

## make format      clang-format over all sources
format:
	clang-format -i $(shell git ls-files '*.c' '*.h')

## make clean       removes build/
clean:
	rm -rf build

help:
	@sed -n 's/^## //p' Makefile

deps:
	@.ci/install-deps

$(BUILD)/libvpl.a: $(LIB_OBJECTS)
	@rm -f $@
	@echo "  AR  $@"
	$(Q)$(AR) rcs $@ $^

$(BUILD)/$(SHARED): $(LIB_OBJECTS)
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -shared -Wl,-soname,$(SONAME) -Wl,-z,defs -o $@ $^ $(LDLIBS)
	@ln -sf $(SHARED) $(BUILD)/$(SONAME)
	@ln -sf $(SONAME) $(BUILD)/libvpl.so

$(BUILD)/vpl: $(CLI_OBJECTS) $(BUILD)/libvpl.a
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

# vpl-mpi, by the compiler of an MPI: make build/vpl-mpi MPICC=mpicc.mpich, or by name: build/vpl-mpi.openmpi.
MPICC       ?= mpicc
MPI_SOURCES := $(wildcard src/mpi/*.c)
MPI_OTHERS  := $(filter-out %/cli/main.o,$(CLI_OBJECTS)) $(BUILD)/libvpl.a
define BUILD_MPI
	@command -v $(1) >/dev/null || { echo "$@ needs an MPI: there is no $(1); make test-mpi installs two" >&2; exit 1; }
	@mkdir -p $(@D)
	@echo "  MPI $@"
	$(Q)OMPI_CC="$(CC)" MPICH_CC="$(CC)" $(1) $(filter-out -MMD -MP,$(ALL_CFLAGS)) -Wconversion -o $@ $(MPI_SOURCES) $(MPI_OTHERS) $(LDLIBS)
endef
$(BUILD)/vpl-mpi: $(MPI_SOURCES) src/mpi/ranks.h $(MPI_OTHERS)
	$(call BUILD_MPI,$(MPICC))
$(BUILD)/vpl-mpi.%: $(MPI_SOURCES) src/mpi/ranks.h $(MPI_OTHERS)
	$(call BUILD_MPI,mpicc.$*)

# The program writes the options of its man page.
$(BUILD)/vpl.1: src/cli/vpl.1.in $(BUILD)/vpl
	$(Q)$(BUILD)/vpl help --man | sed -e '/^@OPTIONS@$$/{r /dev/stdin' -e 'd' -e '}' $< > $@

$(BUILD)/vpl-tests: $(TEST_OBJECTS) $(BUILD)/libcli.a $(BUILD)/libvpl.a
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -pthread -o $@ $^ -lcmocka $(LDLIBS)

$(BUILD)/vpl-golden: $(GOLDEN_OBJECTS) $(BUILD)/libvpl.a
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

# Libraries that benchmarks compare with, where they are installed.
EMBREE := $(if $(wildcard /usr/include/embree3/rtcore.h),-lembree3)
$(BUILD)/obj/tests/bench/rays.o: INCLUDES += $(if $(EMBREE),-DHAVE_EMBREE)
$(BUILD)/bench/rays: LDLIBS += $(EMBREE)
MEASURE := $(BUILD)/obj/src/cli/bench/measure.o
ROOFLINE := $(foreach part,roofline roofline/loops roofline/work roofline/peaks $(ISAS:%=roofline/peaks_kernel.%),\
              $(BUILD)/obj/tests/bench/$(part).o) $(filter %/bench/cover.o,$(CLI_OBJECTS)) $(MEASURE)
$(BUILD)/bench/roofline: $(ROOFLINE) $(BUILD)/libvpl.a
	@mkdir -p $(@D)
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

PEER_HEADERS := /usr/include/EGL/egl.h /usr/include/GL/glcorearb.h
PEER_OBJECTS := $(patsubst %.c,$(BUILD)/obj/%.o,$(wildcard tests/bench/peers/*.c))
ifeq ($(words $(wildcard $(PEER_HEADERS))),2)
$(BUILD)/bench/peers: $(PEER_OBJECTS) $(MEASURE) $(BUILD)/libvpl.a
	@mkdir -p $(@D)
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ -lEGL -lOpenGL $(LDLIBS)
else
$(BUILD)/bench/peers:
	@echo "bench-peers needs EGL and OpenGL to build: $(PEER_HEADERS)" >&2; exit 1
endif
$(BUILD)/bench/%: $(BUILD)/obj/tests/bench/%.o $(MEASURE) $(BUILD)/libvpl.a
	@mkdir -p $(@D)
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

# Examples see public headers only.
$(BUILD)/obj/examples/%: INCLUDES := -Iinclude
$(BUILD)/examples/%: $(BUILD)/obj/examples/%.o $(BUILD)/libvpl.a
	@mkdir -p $(@D)
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

# The program without its main, for tests and the fuzzer of command lines.
$(BUILD)/libcli.a: $(filter-out %/cli/main.o,$(CLI_OBJECTS))
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(BUILD)/fuzz/%_replay: $(BUILD)/obj/tests/fuzz/%_fuzz.o $(BUILD)/obj/tests/fuzz/replay.o $(BUILD)/libcli.a $(BUILD)/libvpl.a
	@mkdir -p $(@D)
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

# Calls of every public function with every wrong argument, written from the headers.
$(BUILD)/nulls-calls.c: tests/nulls/generate.py $(wildcard include/vpl/*.h)
	@mkdir -p $(@D)
	$(Q)python3 $< $(wildcard include/vpl/*.h) >$@.new && mv $@.new $@

$(BUILD)/nulls: $(BUILD)/nulls-calls.c $(wildcard tests/nulls/*.[ch]) $(BUILD)/libvpl.a
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -O0 -Itests/nulls -o $@ $(filter %.c %.a,$^) $(LDLIBS)

$(BUILD)/no-memory.so: tests/cli/no_memory.c
	@mkdir -p $(@D)
	$(Q)$(CC) $(ALL_CFLAGS) -fPIC -fvisibility=default -shared -o $@ $< -ldl

$(BUILD)/soak: $(BUILD)/obj/tests/fuzz/soak.o $(BUILD)/obj/tests/fuzz/valid_fuzz.o $(BUILD)/libvpl.a
	@echo "  LD  $@"
	$(Q)$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/obj/src/%: WARNINGS += -Wconversion
# Tests wait for the library: their own code compiles in 0.7 of the time with -O1.
$(TEST_OBJECTS): OPT_release := -O1
$(BUILD)/obj/%.o: %.c
	@mkdir -p $(@D)
	@echo "  CC  $<"
	$(Q)$(CC) $(ALL_CFLAGS) -c -o $@ $<

define KERNEL_RULE
$(BUILD)/obj/%_kernel.$(1).o: %_kernel.c
	@mkdir -p $$(@D)
	@echo "  CC  $$< ($(1))"
	$$(Q)$$(CC) $$(ALL_CFLAGS) $$(ISA_$(1)) $$(LANES) -DVPL_KERNEL_ISA=$(1) -c -o $$@ $$<
endef
$(foreach isa,$(ISAS),$(eval $(call KERNEL_RULE,$(isa))))

# OpenEXR may come or go between two builds.
$(EXR_SOURCES:%.c=$(BUILD)/obj/%.o): $(BUILD)/obj/exr-$(EXR)
$(EXR_SOURCES:%.c=$(BUILD)/obj/%.o): ALL_CFLAGS += -DVPL_EXR=$(EXR)
$(BUILD)/obj/exr-$(EXR):
	@mkdir -p $(@D)
	@rm -f $(BUILD)/obj/exr-*
	@touch $@

# Prints the libraries that a program needs besides libvpl.a.
libs:
	@echo $(LDLIBS)

.SECONDARY:
-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)
