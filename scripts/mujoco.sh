#!/usr/bin/env bash
# Installs MuJoCo's library from its Python wheel into a folder (default: target/mujoco)
# and prints the settings that `cargo build --features mujoco` and the program need:
#
#     eval "$(scripts/mujoco.sh)"
#
# Needs python3 with pip. Only prints the settings if the library is already installed.
set -euo pipefail
version=3.17.0
folder=${1:-"$(dirname "$0")/../target/mujoco"}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
library="$folder/libmujoco.so.$version"

if [ ! -e "$library" ]; then
    if ! python3 -m pip --version >/dev/null 2>&1; then
        echo "scripts/mujoco.sh: python3 with pip is missing (Debian: apt-get install python3-pip)" >&2
        exit 1
    fi
    download=$(mktemp -d)
    trap 'rm -rf "$download"' EXIT
    if ! python3 -m pip download --quiet --disable-pip-version-check --no-deps \
        --only-binary :all: --dest "$download" "mujoco==$version" >&2; then
        echo "scripts/mujoco.sh: could not download the wheel mujoco==$version: check the network connection," \
            "and that a wheel exists for this platform" >&2
        exit 1
    fi
    # A wheel is a zip archive; the licence is extracted, too.
    python3 - "$download"/mujoco-*.whl "$download" "libmujoco.so.$version" <<'PYTHON' >&2
import pathlib, sys, zipfile
wheel, folder, library = sys.argv[1:]
with zipfile.ZipFile(wheel) as archive:
    for name in archive.namelist():
        if name.endswith((library, "LICENSE")):
            (pathlib.Path(folder) / pathlib.Path(name).name).write_bytes(archive.read(name))
PYTHON
    if [ ! -e "$download/libmujoco.so.$version" ]; then
        echo "scripts/mujoco.sh: the wheel contains no libmujoco.so.$version: only Linux is supported" >&2
        exit 1
    fi
    ln -sf "libmujoco.so.$version" "$folder/libmujoco.so"
    if [ -e "$download/LICENSE" ]; then mv "$download/LICENSE" "$folder/LICENSE"; fi
    # Last, so that an interrupted download does not count as an installation.
    mv "$download/libmujoco.so.$version" "$library"
fi

echo "export MUJOCO_DYNAMIC_LINK_DIR='$folder'"
echo "export LD_LIBRARY_PATH='$folder'\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}"
