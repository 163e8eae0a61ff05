#!/usr/bin/env bash
# Installs optional tools on Debian by package name, unless they are already installed.
#
#     scripts/tools.sh                     the tools of .ci/run: valgrind, Python, prusa-slicer
#     scripts/tools.sh chromium slurm-wlm  these packages
#
# Needs root or sudo. If a package cannot be installed, prints its name and exits with 1; steps that need
# a missing tool are skipped with a message.
set -euo pipefail

packages=("$@")
if [ $# -eq 0 ]; then
    packages=(valgrind python3-venv python3-pip prusa-slicer)
fi
missing=()
for package in "${packages[@]}"; do
    case $package in
        gcc | libc6-dev | valgrind | python3-venv | python3-pip | chromium | prusa-slicer | slurm-wlm | munge | nodejs | npm) ;;
        *) echo "scripts/tools.sh: unknown package $package: not used by this project" >&2; exit 2 ;;
    esac
    if ! dpkg -s "$package" > /dev/null 2>&1; then missing+=("$package"); fi
done
if [ ${#missing[@]} -eq 0 ]; then exit; fi
if ! command -v apt-get > /dev/null; then
    echo "scripts/tools.sh: apt-get not found; install manually: ${missing[*]}" >&2
    exit 1
fi
root=()
if [ "$(id -u)" -ne 0 ]; then root=(sudo); fi
"${root[@]}" apt-get update -q
failed=()
for package in "${missing[@]}"; do
    DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -q --no-install-recommends "$package" ||
        failed+=("$package")
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "scripts/tools.sh: could not install ${failed[*]}" >&2
    exit 1
fi
