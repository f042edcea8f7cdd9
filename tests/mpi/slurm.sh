#!/bin/sh
# SPDX-License-Identifier: MIT
# The batch scripts of examples/slurm under Slurm: tests/mpi/slurm.sh BUILD. Starts a cluster of four nodes on this machine, with
# keys, ports and folders of its own, and stops it. Needs root, the packages slurm-wlm and munge, and build/vpl-mpi.mpich, which
# takes its ranks from Slurm by PMI-2. Where these are missing or the daemons do not start, a sentence says that nothing is tested.
for program in munged slurmctld slurmd sbatch; do
    command -v $program >/dev/null || { echo "slurm: not tested, there is no $program (packages slurm-wlm and munge)"; exit 0; }
done
[ "$(id -u)" -eq 0 ] || { echo "slurm: not tested, a cluster is only started by root"; exit 0; }
. tests/mpi/support.sh

# ---- the cluster

ctld=$((20000 + $$ % 8000 * 5)) host=$(hostname -s)
export SLURM_CONF="$scratch/slurm.conf"
stop_cluster() {
    for file in "$scratch"/*.pid; do
        [ ! -e "$file" ] || kill "$(cat "$file")" 2>/dev/null
    done
    sleep 1
    rm -rf "$scratch"
}
trap stop_cluster EXIT
chmod 755 "$scratch"
head -c 128 /dev/urandom >"$scratch/key" && chmod 600 "$scratch/key"
munged --force --key-file="$scratch/key" --socket="$scratch/munge" --pid-file="$scratch/munged.pid" \
    --log-file="$scratch/munged.log" --seed-file="$scratch/munged.seed"
cat >"$SLURM_CONF" <<END
ClusterName=vpl
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$ctld
AuthType=auth/munge
AuthInfo=socket=$scratch/munge
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool-%n
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd-%n.pid
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/slurmd-%n.log
MpiDefault=pmi2
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=n[1-4] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((ctld + 1))-$((ctld + 4))] CPUs=2
PartitionName=all Nodes=ALL Default=YES State=UP
END
mkdir -p "$scratch/state" "$scratch/spool-n1" "$scratch/spool-n2" "$scratch/spool-n3" "$scratch/spool-n4"
slurmctld -f "$SLURM_CONF"
for node in n1 n2 n3 n4; do
    slurmd -f "$SLURM_CONF" -N $node
done
await() { # SECONDS COMMAND...: tries the command ten times a second until it succeeds; fails when the time is over
    tries=$(($1 * 10))
    shift
    until "$@"; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || return 1
        sleep 0.1
    done
}
all_are_idle() { [ "$(sinfo -h -t idle -o %D)" = 4 ]; }
await 30 all_are_idle || { echo "slurm: not tested, its daemons do not start here"; tail -n 5 "$scratch"/*.log; exit 0; }

# ---- jobs. The scripts run in a folder where build/ has the programs.

scripts=$PWD/examples/slurm scenes=$PWD/examples/scenes
mkdir "$scratch/work" "$scratch/work/build" && ln -s "$PWD/$build/vpl" "$scratch/work/build/vpl" &&
    ln -s "$PWD/$build/vpl-mpi.mpich" "$scratch/work/build/vpl-mpi" && cd "$scratch/work" || exit 1
has_state() { [ "$(squeue -h -j "$1" -o %T 2>/dev/null)" = "$2" ]; } # JOB STATE: empty if the job has ended
submit() { sbatch --parsable --output="$scratch/work/log-%j" --cpus-per-task=1 "$@"; }

options="$scenes/room-area.json --method path --spp 24 --size 96x240"
build/vpl render $options -o whole.pfm --quiet

tiles() {
    sbatch --wait --output=log-tiles --cpus-per-task=1 --array=1-4 "$scripts/tiles.sbatch" ${options%% *} tiles.pfm \
        ${options#* } --quiet >/dev/null && build/vpl merge tiles.pfm.part-* -o tiles.pfm --quiet && cmp whole.pfm tiles.pfm
}
check Array_jobs_make_tiles tiles

job_of_four() {
    sbatch --wait --output=log-four --cpus-per-task=1 "$scripts/render.sbatch" ${options%% *} four.pfm ${options#* } >/dev/null &&
        cmp whole.pfm four.pfm
}
check A_job_of_four_nodes job_of_four

# A job that ends too early: Slurm sends SIGTERM to the ranks, they keep what is finished, and the job goes on by itself.
long="$scenes/room-area.json --method path --spp 160 --size 96x240"
build/vpl render $long -o long.pfm --quiet
has_a_piece() { [ "$(wc -c <"$1" 2>/dev/null || echo 0)" -gt 5000 ]; }
# goes_on JOB FILE: waits until the job is queued again, and starts it at once instead of after Slurm's two minutes.
goes_on() {
    await 60 has_state "$1" PENDING && [ ! -e "$2" ] && cp "$2.pieces" kept && scontrol update JobId="$1" StartTime=now &&
        await 120 has_state "$1" "" && cmp long.pfm "$2" && cmp -n "$(wc -c <kept)" kept "$2.pieces"
}

out_of_time() {
    job=$(submit "$scripts/render.sbatch" ${long%% *} late.pfm ${long#* } --quiet) && await 30 has_a_piece late.pfm.pieces &&
        scancel --signal=TERM "$job" && goes_on "$job" late.pfm
}
check A_job_out_of_time_goes_on out_of_time

# A machine that is lost: the job is queued again, and goes on without it.
lost_node() {
    job=$(submit --nodes=3 "$scripts/render.sbatch" ${long%% *} lost.pfm ${long#* } --quiet) && await 30 has_a_piece lost.pfm.pieces || return 1
    node=$(scontrol show hostnames "$(squeue -h -j "$job" -o %N)" | tail -n 1)
    scontrol update NodeName="$node" State=DOWN Reason=test && goes_on "$job" lost.pfm
}
check A_job_that_loses_a_node_goes_on lost_node

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
