#!/usr/bin/env bash
# Builds the release packages for Linux on x86_64 in dist/:
#
#     scripts/release.sh
#
#     finger_opt-VERSION-cp310-abi3-manylinux_2_28_x86_64.whl   for CPython 3.10 and later, glibc 2.28 and later
#     finger_opt-VERSION.tar.gz                                 the sources from which the wheel can be built
#     finger-opt-VERSION-x86_64-unknown-linux-musl.tar.gz       the static program, completions, commands
#     SHA256SUMS
#
# Needs git, Rust with the target x86_64-unknown-linux-musl, a C compiler, Python with venv, and a package index
# for maturin and zig, whose linker supports old glibc versions. scripts/check_release.sh tests the result.
set -euo pipefail
cd "$(dirname "$0")/.."

mkdir -p "${CARGO_TARGET_DIR:-target}"
target=$(realpath "${CARGO_TARGET_DIR:-target}")
venv=$target/release-venv
static=x86_64-unknown-linux-musl
# Exit code 3: a build requirement is missing.
missing() { echo "scripts/release.sh: $1" >&2; exit 3; }
name=finger-opt-$(cargo metadata --no-deps --offline --locked --format-version 1 | python3 -c \
    'import json, sys; print(next(p["version"] for p in json.load(sys.stdin)["packages"] if p["name"] == "finger-opt"))')

commit=$(git rev-parse HEAD) || missing "no git clone: a release names its commit"
if [ -n "$(git status --porcelain --untracked-files=no)" ]; then
    echo "scripts/release.sh: this release of $commit includes uncommitted changes" >&2
fi
if ! [ -d "$(rustc --print target-libdir --target $static)" ]; then
    missing "Rust's library for $static is missing: rustup target add $static"
fi
if ! { python3 -m venv "$venv" && "$venv/bin/pip" install -q maturin==1.16.0 ziglang==0.17.1 auditwheel==6.8.2; }; then
    missing "maturin, zig and auditwheel cannot be installed"
fi
rm -rf dist
mkdir dist
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Reproducible: the same commit, compiler and folder give the same bytes.
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH CARGO_TARGET_DIR=$target CARGO_PROFILE_RELEASE_STRIP=symbols
export RUSTFLAGS="--remap-path-prefix=$PWD=finger-opt --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}/registry/src=registry"
pack() { tar --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$SOURCE_DATE_EPOCH" -c "$@" | gzip -9n; }

cargo build --release --locked --bin optimize --target $static
program=$target/$static/release/optimize
folder=$scratch/$name-$static
mkdir -p "$folder/completions"
cp "$program" LICENSE-APACHE LICENSE-MIT README.md CHANGELOG.md "$folder"
# The bundled libraries; workspace crates are recognized by their folder.
cargo tree --locked -p finger-opt -e normal --target $static --prefix none --format '{p}: {l} {r}' |
    sed '/(\/.*)/d; s/ (\*)$//' | sort -u > "$folder/LICENSES-OF-LIBRARIES"
for shell in bash zsh fish; do "$program" completions $shell > "$folder/completions/optimize.$shell"; done
"$program" man > "$folder/COMMANDS.md"
pack -C "$scratch" "$name-$static" > "dist/$name-$static.tar.gz"

(cd python && PATH=$venv/bin:$PATH maturin build -q --release --locked --zig --compatibility manylinux_2_28 --out ../dist)
"$venv/bin/auditwheel" show dist/*.whl

# The sources from git, with the commit instead of the placeholder that `git archive` would expand.
git ls-files -z | tar --null -c -T - | tar x -C "$scratch" --one-top-level=source
echo "$commit" > "$scratch/source/COMMIT"
(cd "$scratch/source/python" && CARGO_TERM_QUIET=true "$venv/bin/maturin" sdist --out "$OLDPWD/dist")

(cd dist && sha256sum -- * > SHA256SUMS && ls -l && cat SHA256SUMS)
