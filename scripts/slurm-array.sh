#!/usr/bin/env bash
# Measures one shard of a sweep per task of a Slurm job array, see docs/scaling.md:
#   sbatch --array=1-8 scripts/slurm-array.sh SWEEP.toml OUT [option of `stickslip study`]...
# Submit the same array again to go on where it ended. `%a` in OUT becomes the shard, for folders of their own.
# Environment: SHARDS, how many there are, if only some are submitted (SHARDS=8 sbatch --array=3,5 ...);
# STICKSLIP, the program, target/release/stickslip by default.
#
# A cell is measured on one thread, and its times are worth something only on a node that does nothing else.
# `sbatch --oversubscribe --mem=4G ... --untimed` shares nodes and takes no times.
#SBATCH --job-name=stickslip
#SBATCH --nodes=1 --ntasks=1 --cpus-per-task=1
#SBATCH --exclusive --mem=0
# Before the time limit of the job, early enough for a cell (--time-limit, 300 s) to end with its record.
#SBATCH --signal=B:TERM@330
set -euo pipefail

refuse() {
    echo "slurm-array.sh: $*" >&2
    exit 2
}

(($# >= 2)) || refuse "usage: sbatch --array=1-N scripts/slurm-array.sh SWEEP.toml OUT [option]..."
sweep=$1 out=$2 program=${STICKSLIP:-target/release/stickslip}
[[ ${SLURM_ARRAY_TASK_ID-} ]] || refuse "not a task of a job array: sbatch --array=1-N"
shard=$SLURM_ARRAY_TASK_ID shards=${SHARDS:-$SLURM_ARRAY_TASK_COUNT}
# Slurm counts the tasks submitted now: for 3,5 that is 2, and task 1 of 1,5 must not take itself for shard 1 of 2.
((1 <= ${SLURM_ARRAY_TASK_MIN:-$shard} && ${SLURM_ARRAY_TASK_MAX:-$shard} <= shards && 1 <= shard && shard <= shards)) ||
    refuse "array indices are not all within 1-$shards; if this is a part of them, set SHARDS to the number of all shards"

# In place of the shell, so that Slurm's signal reaches the program.
exec "$program" study "$sweep" --out "${out//%a/$shard}" --shard "$shard/$shards" "${@:3}"
