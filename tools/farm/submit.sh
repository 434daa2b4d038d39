#!/bin/sh
# One picture on many machines by Slurm: an array job of sample ranges, then a job that merges them when all are done.
#
#   sh tools/farm/submit.sh SAMPLES TASKS FOLDER SCENE [options of chiaro render]
#
# FOLDER is on a disk that all nodes see; it receives the parts, the logs, picture.exr and picture.png. Where and with what the tasks run
# is said in sbatch's own variables (SBATCH_PARTITION, SBATCH_TIMELIMIT, SBATCH_ACCOUNT, SBATCH_MEM_PER_NODE, SLURM_CPUS_PER_TASK ...).
# CHIARO names the program, else it is looked up. Prints the numbers of the two jobs.
set -eu
if [ $# -lt 4 ]; then
    echo "usage: sh tools/farm/submit.sh SAMPLES TASKS FOLDER SCENE [options of chiaro render]" >&2
    exit 64
fi
samples=$1 tasks=$2 folder=$3 scene=$4
shift 4
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
for number in "$samples" "$tasks"; do
    case $number in '' | *[!0-9]* | 0*) echo "error: $number is no number of samples or tasks, such as 1024 16" >&2; exit 64 ;; esac
done
[ "$tasks" -le "$samples" ] || { echo "error: $tasks tasks for $samples samples a pixel; a task needs one at least" >&2; exit 64; }
chiaro=${CHIARO:-$(command -v chiaro || true)}
[ -x "$chiaro" ] || { echo "error: no program chiaro in PATH; name it: CHIARO=/path/to/chiaro sh tools/farm/submit.sh ..." >&2; exit 4; }
for option in "$@"; do
    case $option in
    --spp* | --time | --time=* | --noise | --noise=* | -o* | --output* | --sample-range* | --checkpoint-every* | --resume* | -t | --threads*)
        echo "error: $option is what the farm sets itself; leave it out" >&2; exit 64 ;;
    esac
done
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
case $scene in @*) ;; *) scene=$(realpath -- "$scene") ;; esac
if ls "$folder"/part-*.chk >/dev/null 2>&1; then
    echo "error: $folder holds parts already; give an empty folder, or finish them as docs/farm.md says" >&2
    exit 4
fi

parts=$(sbatch --parsable --array="0-$((tasks - 1))" --chdir="$folder" --output="$folder/part-%a.log" \
    --cpus-per-task="${SLURM_CPUS_PER_TASK:-1}" "$here/part.sbatch" "$chiaro" "$folder" "$samples" "$tasks" "$scene" "$@")
parts=${parts%%;*}
merge=$(sbatch --parsable --dependency="afterok:$parts" --chdir="$folder" --output="$folder/merge.log" \
    "$here/merge.sbatch" "$chiaro" "$folder" "$tasks")
echo "parts $parts"
echo "merge ${merge%%;*}"
