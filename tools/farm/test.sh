#!/bin/sh
# The farm, tried against a real Slurm on this machine: a one-node cluster in a scratch folder renders one picture as an array of five sample
# ranges and merges it; one task is killed in the middle of its work the first time and runs again. The picture must have the same bits as one
# that was rendered whole. sh tools/farm/test.sh [CHIARO]; needs root and slurmctld slurmd slurm-client munge (sh tools/setup.sh farm).
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
root=$(dirname "$(dirname "$here")")
chiaro=$(realpath -- "${1:-${CHIARO:-$root/build/release/chiaro}}")
[ -x "$chiaro" ] || { echo "error: no program $chiaro; build it (sh tools/build.sh), or name one" >&2; exit 4; }
scratch=$(mktemp -d)
clean() {
    sh "$here/cluster.sh" stop "$scratch/cluster" || true
    rm -rf "$scratch"
}
trap clean EXIT
trap 'exit 130' INT TERM
scene=@cornell samples=320 tasks=5 victim=2
options="--size 160x160 --seed 7 -i path:rr-depth=4"

# The program, which dies once: kill -9 in the middle of one part.
cat >"$scratch/chiaro" <<EOF
#!/bin/sh
if [ "\${SLURM_ARRAY_TASK_ID:-}" = $victim ] && mkdir "$scratch/died" 2>/dev/null; then
    "$chiaro" "\$@" &
    sleep 0.5
    kill -9 \$!
    exit 137
fi
exec "$chiaro" "\$@"
EOF
chmod 755 "$scratch" "$scratch/chiaro"

echo "cluster  one node, in $scratch"
sh "$here/cluster.sh" start "$scratch/cluster"
SLURM_CONF=$scratch/cluster/slurm.conf
export SLURM_CONF
echo "whole    $scene $options, $samples samples"
# shellcheck disable=SC2086 # the options are words
"$chiaro" render $scene $options --spp $samples -o "$scratch/whole.exr" -q
# shellcheck disable=SC2086
CHIARO=$scratch/chiaro sh "$here/submit.sh" $samples $tasks "$scratch/farm" $scene $options | tee "$scratch/jobs"
parts=$(sed -n 's/^parts //p' "$scratch/jobs")

tries=0
while [ -n "$(squeue -h)" ]; do
    tries=$((tries + 1))
    [ $tries -lt 600 ] || { echo "error: the jobs do not end"; squeue; tail -n 20 "$scratch"/farm/*.log; exit 2; }
    # Slurm lets a task that runs again wait two minutes; here it need not.
    if [ -d "$scratch/died" ]; then scontrol update "jobid=${parts}_$victim" StartTime=now 2>/dev/null || true; fi
    sleep 0.5
done
grep -h "^part" "$scratch"/farm/part-*.log
fail() { echo "FAILED: $1"; cat "$scratch"/farm/*.log; exit 2; }
[ -d "$scratch/died" ] || fail "no task died"
grep -q "attempt 2" "$scratch/farm/part-$victim.log" || fail "the task that died did not run again"
[ -s "$scratch/farm/picture.exr" ] && [ -s "$scratch/farm/picture.png" ] || fail "no picture"
"$chiaro" diff "$scratch/whole.exr" "$scratch/farm/picture.exr" --fail 0 >"$scratch/diff.txt" || { cat "$scratch/diff.txt"; fail "other pixels"; }
echo "ok       five parts, one of them killed and run again: the same bits as the whole"
