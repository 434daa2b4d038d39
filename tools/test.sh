#!/bin/sh
# Build everything in release and run every test in parallel; the last lines are ctest's count. Arguments go to ctest (-R NAME picks).
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
sh "$root/tools/build.sh" all
cd -- "$root"
exec ctest --preset release --output-on-failure -j "$(nproc)" "$@"
