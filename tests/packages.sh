# What a plain Debian 12 needs to build phront and run its tests. Sourced by the scripts that build.

# compilers and tools | CAD | drawings | numerics and small libraries | pictures
packages=(
  g++ cmake ninja-build ccache pkg-config python3
  libocct-foundation-dev libocct-modeling-data-dev libocct-modeling-algorithms-dev
  libocct-ocaf-dev libocct-visualization-dev libocct-data-exchange-dev
  libdxflib-dev libpugixml-dev
  libeigen3-dev libtbb-dev libexpected-dev libfmt-dev libcli11-dev nlohmann-json3-dev libgtest-dev
  libvtk9-dev libegl1-mesa-dev libgl1-mesa-dri
)

# Installs those that are missing; does nothing, and needs no rights, when all are there.
installMissingPackages() {
  local missing=() package
  for package in "${packages[@]}"; do
    if [[ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" != "install ok installed" ]]; then
      missing+=("$package")
    fi
  done
  if ((${#missing[@]} == 0)); then
    echo "== packages: all there"
    return
  fi
  local asRoot=()
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "missing packages: ${missing[*]}; install them as root, or run this as root" >&2
      return 1
    fi
    asRoot=(sudo)
  fi
  echo "== packages: installing ${missing[*]}"
  "${asRoot[@]}" apt-get update
  "${asRoot[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y --no-install-recommends "${missing[@]}"
}

# Configures and builds the release preset into build/release. Arguments: targets; none builds all.
buildRelease() {
  local options=() targets=()
  if command -v ccache >/dev/null; then
    options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  (($# > 0)) && targets=(--target "$@")
  echo "== configuring build/release"
  cmake --preset release "${options[@]}"
  echo "== building with $(nproc) cores"
  cmake --build --preset release --parallel "$(nproc)" "${targets[@]}"
}
