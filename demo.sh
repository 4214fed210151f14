#!/usr/bin/env bash
# Installs what is missing (Debian), builds the command line into build/demo and meshes an abdominal aorta at order 3.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source .ci/need_packages.sh

if [ $# -gt 0 ]; then
  echo "usage: ./demo.sh    builds vasohex, writes build/demo/aorta.msh and build/demo/aorta.vtu" >&2
  exit 2
fi

need_packages "${build_packages[@]}"

echo "== building into build/demo"
cmake -S . -B build/demo -G Ninja -DCMAKE_BUILD_TYPE=Release -DVASOHEX_GMSH=OFF -DVASOHEX_TESTS=OFF
cmake --build build/demo

echo "== meshing meshes/abdominal_aorta.json at order 3"
build/demo/adapters/cli/vasohex mesh meshes/abdominal_aorta.json --order 3 \
  -o build/demo/aorta.msh -o build/demo/aorta.vtu --json build/demo/aorta.json
