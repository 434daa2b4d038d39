#!/bin/sh
# Install the Debian packages that Chiaro is built from. Asks for root only when some are missing; safe to run again.
# With the argument `browser` also those that the test of the comparison report in a browser needs, with `farm` those of tools/farm/test.sh,
# with `fuzz` those of tools/fuzz.sh.
# Why each of them is here: CONTRIBUTING.md, "Dependencies".
set -eu

packages='g++ cmake ninja-build ccache lld pkg-config git
libtbb-dev libembree-dev libopenimageio-dev libopencolorio-dev libimath-dev libtinygltf-dev nlohmann-json3-dev
libmeshoptimizer-dev libdraco-dev libwebp-dev libeigen3-dev libfmt-dev libcli11-dev libxxhash-dev zlib1g-dev doctest-dev'

case ${1-} in
    '') ;;
    browser) packages="$packages chromium chromium-driver python3-selenium" ;;
    farm) packages="$packages slurmctld slurmd slurm-client munge python3-minimal" ;;
    fuzz) packages="$packages clang-19 libclang-rt-19-dev" ;;
    *)
        echo "setup: no such argument: $1; use 'browser', 'farm' or 'fuzz' for the packages of that test, or nothing" >&2
        exit 64
        ;;
esac

missing_packages() {
    for package in $packages; do
        case $(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null || true) in
            ?i*) ;;
            *) printf ' %s' "$package" ;;
        esac
    done
}

if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
    echo 'setup: this is not a Debian system. Install the counterparts of these packages, then build with' >&2
    echo '       cmake --preset release && cmake --build --preset release' >&2
    printf '       %s\n' "$(echo $packages)" >&2
    exit 1
fi

missing=$(missing_packages)
[ -n "$missing" ] || exit 0
echo "setup: missing packages:$missing"

if [ "$(id -u)" -eq 0 ]; then
    as_root=
elif command -v sudo >/dev/null 2>&1; then
    as_root=sudo
    echo 'setup: sudo installs them'
else
    echo 'setup: installing needs root, and there is no sudo. Run as root, then try again:' >&2
    echo "       apt-get update && apt-get install --no-install-recommends$missing" >&2
    exit 1
fi

apt() {
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 "$@" </dev/null
}
# Package lists are fetched only when they are absent (a fresh system) or name files that are gone.
if ! apt-get -s --no-install-recommends install $missing >/dev/null 2>&1; then apt update; fi
apt -y --no-install-recommends install $missing || { apt update && apt -y --no-install-recommends install $missing; }

missing=$(missing_packages)
if [ -n "$missing" ]; then
    echo "setup: still missing:$missing" >&2
    exit 1
fi
