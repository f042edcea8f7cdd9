# SPDX-License-Identifier: MIT
# What the tests of vpl-mpi share. Sourced; sets build, scratch and the ways to start ranks.
build=${1:-build}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export OMP_WAIT_POLICY=passive OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
# Ranks that wait in MPI_Init and MPI_Finalize give their processor to others.
export OMPI_MCA_mpi_yield_when_idle=1
passed=0
failed=0

check() {
    checked=$1
    shift
    if "$@" >"$scratch/log" 2>&1; then
        passed=$((passed + 1))
        echo "ok $checked"
    else
        failed=$((failed + 1))
        echo "not ok $checked"
        tail -n 20 "$scratch/log"
    fi
}

# ranks IMPLEMENTATION N ARGUMENT...: runs vpl-mpi.
ranks() {
    implementation=$1 number=$2
    shift 2
    case $implementation in
    openmpi) timeout 120 mpirun.openmpi --oversubscribe --bind-to none -n "$number" "$build/vpl-mpi.openmpi" "$@" ;;
    mpich) timeout 120 mpirun.mpich -n "$number" "$build/vpl-mpi.mpich" "$@" ;;
    esac
}
