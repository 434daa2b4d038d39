#!/bin/sh
# Feeds damaged files to the readers, all of them instrumented by AddressSanitizer and UndefinedBehaviorSanitizer.
#   sh tools/fuzz.sh gltf [seconds]     libFuzzer on the glTF reader (600 seconds)
#   sh tools/fuzz.sh image [seconds]    libFuzzer on the reader of pictures
#   sh tools/fuzz.sh mutations          1,000 damaged scenes through reading, compiling and an 8 x 8 picture
# A find is kept in build/fuzz/finds and makes this fail; what was learnt is kept in build/fuzz/corpus-*, so that the next run goes on there.
set -eu
cd "$(dirname "$0")/.."
what=${1-gltf}
seconds=${2-600}
case $what in
    gltf | image | mutations) ;;
    *)
        echo "fuzz: no such target: $what; give gltf, image or mutations" >&2
        exit 64
        ;;
esac

if [ "$what" = mutations ]; then
    sh tools/setup.sh
    cmake --preset asan >/dev/null
    cmake --build --preset asan --target chiaro_tests_mutations
    # 2 GB is what a small file may take at the very most; a copy that hangs is named after ten minutes.
    exec env CHIARO_LONG=1 ASAN_OPTIONS=hard_rss_limit_mb=2048 build/asan/tests/chiaro_tests_mutations
fi

sh tools/setup.sh fuzz
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target "chiaro_fuzz_$what" chiaro_fuzz_corpus
build/fuzz/fuzz/chiaro_fuzz_corpus "$what" "build/fuzz/seeds-$what"
mkdir -p "build/fuzz/corpus-$what" build/fuzz/finds
# 2 GB and 25 seconds are what a small file may take at the very most.
exec "build/fuzz/fuzz/chiaro_fuzz_$what" -max_total_time="$seconds" -rss_limit_mb=2048 -timeout=25 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix=build/fuzz/finds/ "build/fuzz/corpus-$what" "build/fuzz/seeds-$what"
