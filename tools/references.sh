#!/bin/sh
# Make the references of the converged-reference tests anew: tests/references/*.json, from 128 replicates of the path tracer a scene and
# set of paths, some minutes; of the scenes that are named (@cornell ...), else of all. Prints the verdict on new against old; look at it,
# and commit the files, only where a change is meant.
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
sh "$root/tools/build.sh" chiaro_tests_converged
cd -- "$root"
CHIARO_COMMIT=$(git describe --always --dirty 2>/dev/null || echo unknown)
CHIARO_SCENES=$*
export CHIARO_COMMIT CHIARO_SCENES
exec build/release/tests/chiaro_tests_converged --test-case="make the references" --no-skip --no-skipped-summary
