#!/bin/sh
# Build the release binary, build/release/chiaro, installing what it needs first. Arguments are CMake targets; "all" adds the tests.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
sh "$root/tools/setup.sh"
cd -- "$root"

# As many compilers as there are processors, but no more than the memory holds at 1.5 GB each.
memory_kb() {
    while read -r key value unit; do
        [ "$key" != MemTotal: ] || total=$value
    done </proc/meminfo
    limit=$(cat /sys/fs/cgroup/memory.max 2>/dev/null || echo max)
    case $limit in
        *[!0-9]* | '') ;;
        *) [ $((limit / 1024)) -ge "$total" ] || total=$((limit / 1024)) ;;
    esac
    echo "$total"
}
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-}
if [ -z "$jobs" ]; then
    jobs=$(nproc)
    fit=$(($(memory_kb) / 1572864))
    [ "$jobs" -le "$fit" ] || jobs=$fit
    [ "$jobs" -ge 1 ] || jobs=1
fi

[ $# -gt 0 ] || set -- chiaro
mkdir -p build
if ! cmake --preset release >build/configure.log 2>&1; then
    cat build/configure.log >&2
    exit 1
fi
cmake --build --preset release --parallel "$jobs" --target "$@"
