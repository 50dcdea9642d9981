#!/usr/bin/env bash
# Workers on a Slurm cluster, one a task of an array:
#   HATCHERY_JOIN_FILE=$HOME/worker.token sbatch --array=1-50 --cpus-per-task=8 --time=04:00:00 deploy/slurm/workers.sh
# The file holds a worker's join token, and must be readable on the nodes (mode 0600). A coordinator without credentials,
# on the same machine or behind a tunnel, is named by its URL as an argument.
# Two minutes before the time is up, or when the job is cancelled or preempted, a worker gives back what it has not
# begun, finishes what it runs, delivers it and leaves with 0. What it does not finish is evaluated elsewhere.
#SBATCH --job-name=hatchery-worker
#SBATCH --ntasks=1
#SBATCH --signal=B:TERM@120
#SBATCH --requeue
#SBATCH --output=hatchery-worker-%A_%a.log
set -euo pipefail

coordinator=${1:-${HATCHERY_COORDINATOR:-}}
where=()
if [[ -z ${HATCHERY_JOIN:-}${HATCHERY_JOIN_FILE:-} ]]; then
    if [[ -z $coordinator ]]; then
        echo "usage: HATCHERY_JOIN_FILE=FILE sbatch --array=1-N workers.sh, or sbatch --array=1-N workers.sh URL" >&2
        exit 2
    fi
    where=(--coordinator "$coordinator")
fi
name="${SLURM_JOB_ID:?this runs under sbatch}-${SLURM_ARRAY_TASK_ID:-0}"

"${HATCHERY_WORKER_PROGRAM:-hatchery-worker}" \
    "${where[@]}" \
    --name "$name" \
    --slots "${SLURM_CPUS_PER_TASK:-1}" \
    --grace 100s &
worker=$!

# B: the signal comes to this shell alone, which passes it on. It ends a wait, so the worker is waited for again.
drained=
# shellcheck disable=SC2329 # the trap calls it
drain() {
    drained=yes
    kill -TERM "$worker" 2>/dev/null || true
}
trap drain TERM INT
status=0
wait "$worker" || status=$?
while [[ -n $drained ]]; do
    drained=
    status=0
    wait "$worker" || status=$?
done
exit "$status"
