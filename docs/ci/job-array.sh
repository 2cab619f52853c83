#!/bin/sh
# sbatch --array=1-8 job-array.sh: a folder of descriptions in eight parts, each on a machine of its own.
#SBATCH --job-name=mbsym
#SBATCH --cpus-per-task=4
set -eu
part="${SLURM_ARRAY_TASK_ID:-1}"
parts="${SLURM_ARRAY_TASK_COUNT:-1}"
mbsym batch systems --out build --shard "$part/$parts" --jobs "${SLURM_CPUS_PER_TASK:-1}"
