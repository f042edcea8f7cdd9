# libvpl. `make help` lists the targets.
# Every configuration has a folder of its own: make BUILD=build/clang CC=clang MODE=debug SANITIZE=address,undefined

CC      ?= cc
AR      ?= ar
BUILD   ?= build
MODE    ?= release
OPENMP  ?= 1
PREFIX  ?= /usr/local
DESTDIR ?=

ifeq ($(origin CC),default)
CC := gcc
endif

# -ffp-contract=off: a fused multiply-add rounds once instead of twice, so bits would depend on the machine.
# -fno-math-errno and -fno-trapping-math change no value; without them sqrtf and ?: do not vectorise.
STANDARD := -std=gnu11 -ffp-contract=off -fno-math-errno -fno-trapping-math -fno-strict-aliasing
WARNINGS := -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wno-unknown-pragmas $(WERROR)
INCLUDES := -Iinclude -Isrc -isystem /usr/include/stb
OPT_release := -O3 -DNDEBUG
OPT_debug   := -O0
OPT_size    := -O1
CFLAGS  ?= -g
SAN     := $(if $(SANITIZE),-fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer)
OMP     := $(if $(filter 1,$(OPENMP)),-fopenmp)
ALL_CFLAGS = $(STANDARD) $(WARNINGS) $(INCLUDES) $(OPT_$(MODE)) $(OMP) $(SAN) $(CFLAGS) -MMD -MP
LDLIBS  := -ljansson -lm

MACHINE := $(shell $(CC) -dumpmachine 2>/dev/null)
ISAS    := scalar sse2 $(if $(filter x86_64%,$(MACHINE)),avx2 avx512)
ISA_scalar := -fno-tree-vectorize -fno-tree-slp-vectorize
ISA_sse2   :=
ISA_avx2   := -mavx2
ISA_avx512 := -mavx512f -mavx512dq -mavx512bw -mavx512vl -mprefer-vector-width=512

LIB_SOURCES    := $(filter-out src/cli/%,$(wildcard src/*/*.c))
KERNEL_SOURCES := $(filter %_kernel.c,$(LIB_SOURCES))
PLAIN_SOURCES  := $(filter-out %_kernel.c,$(LIB_SOURCES))
CLI_SOURCES    := $(wildcard src/cli/*.c)
LIB_OBJECTS    := $(PLAIN_SOURCES:%.c=$(BUILD)/obj/%.o) \
                  $(foreach isa,$(ISAS),$(KERNEL_SOURCES:%.c=$(BUILD)/obj/%.$(isa).o))
CLI_OBJECTS    := $(CLI_SOURCES:%.c=$(BUILD)/obj/%.o)
TEST_SOURCES   := $(wildcard tests/*.c)
TEST_OBJECTS   := $(TEST_SOURCES:%.c=$(BUILD)/obj/%.o)
EXAMPLES       := $(patsubst examples/%.c,$(BUILD)/examples/%,$(wildcard examples/*.c))

.PHONY: all help deps demo test
all: deps
	@$(MAKE) --no-print-directory build-all

.PHONY: build-all
build-all: $(BUILD)/libvpl.a $(BUILD)/vpl

help:
	@sed -n 's/^## //p' Makefile

$(BUILD)/libvpl.a: $(LIB_OBJECTS)
	@rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/vpl: $(CLI_OBJECTS) $(BUILD)/libvpl.a
	$(CC) $(ALL_CFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/obj/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -c -o $@ $<

define KERNEL_RULE
$(BUILD)/obj/%_kernel.$(1).o: %_kernel.c
	@mkdir -p $$(@D)
	$$(CC) $$(ALL_CFLAGS) $$(ISA_$(1)) -DVPL_KERNEL_ISA=$(1) -c -o $$@ $$<
endef
$(foreach isa,$(ISAS),$(eval $(call KERNEL_RULE,$(isa))))

## make             build build/vpl and build/libvpl.a, installing what is missing
deps:
	@.ci/install-deps

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)

$(BUILD)/vpl-tests: $(TEST_OBJECTS) $(BUILD)/libvpl.a
	$(CC) $(ALL_CFLAGS) -o $@ $^ -lcmocka $(LDLIBS)
