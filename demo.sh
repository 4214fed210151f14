#!/usr/bin/env bash
# Installs what is missing (Debian) and builds into build/demo.
#   ./demo.sh         meshes an abdominal aorta at order 3
#   ./demo.sh flow    computes the flow through an iliac bifurcation at order 3 and draws it (needs deal.II, 2 GB more)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source .ci/need_packages.sh

if [ $# -gt 1 ] || [ "${1:-flow}" != flow ]; then
  echo "usage: ./demo.sh         builds vasohex, writes build/demo/aorta.msh and build/demo/aorta.vtu" >&2
  echo "       ./demo.sh flow    builds the flow solver, writes build/demo/flow/ and build/demo/flow.png" >&2
  exit 2
fi

need_packages "${build_packages[@]}"

if [ $# -eq 1 ]; then
  need_packages libdeal.ii-dev python3-vtk9 python3-numpy xvfb xauth
  echo "== building the flow solver into build/demo-flow: some ten minutes"
  cmake -S . -B build/demo-flow -G Ninja -DCMAKE_BUILD_TYPE=Release -DVASOHEX_GMSH=OFF -DVASOHEX_TESTS=OFF \
    -DVASOHEX_DEALII=ON -DVASOHEX_SOLVER_DEMO=ON
  cmake --build build/demo-flow --target vasohex_stokes
  echo "== flow through meshes/iliac_bifurcation.swc, 50 ml/s"
  build/demo-flow/solver_demo/vasohex_stokes meshes/iliac_bifurcation.swc --order 3 --elements 4 --flow-rate 50000 \
    -o build/demo/flow
  echo "== drawing build/demo/flow.png"
  xvfb-run -a -s "-screen 0 1600x1600x24" /usr/bin/python3 docs/render_flow.py build/demo/flow build/demo/flow.png
  exit
fi

echo "== building into build/demo"
cmake -S . -B build/demo -G Ninja -DCMAKE_BUILD_TYPE=Release -DVASOHEX_GMSH=OFF -DVASOHEX_DEALII=OFF -DVASOHEX_TESTS=OFF
cmake --build build/demo

echo "== meshing meshes/abdominal_aorta.json at order 3"
build/demo/adapters/cli/vasohex mesh meshes/abdominal_aorta.json --order 3 \
  -o build/demo/aorta.msh -o build/demo/aorta.vtu --json build/demo/aorta.json
