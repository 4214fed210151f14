#!/usr/bin/env bash
# Installs what is missing (Debian), builds into build/release, runs all tests.
# VASOHEX_DATA: folder of published skeletons; tests on them run if it is set.
# VASOHEX_SOLVER_DEMO=ON: the flow solver too, eight minutes of one core more; for changes to solver_demo/ or
# adapters/dealii/. CI leaves it out for that time: what of it is vasohex, the grids of deal.II, is tested without.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
source .ci/need_packages.sh

need_packages "${build_packages[@]}" ccache libgtest-dev libgmsh-dev libdeal.ii-dev \
  python3 python3-numpy python3-scipy python3-gmsh python3-vtk9 python3-meshio libvtk9-dev zlib1g-dev

echo "== building into build/release"
cmake --preset release -DVASOHEX_DEALII=ON -DVASOHEX_SOLVER_DEMO="${VASOHEX_SOLVER_DEMO:-OFF}"
cmake --build --preset release

echo "== testing${VASOHEX_DATA:+, also on the data in $VASOHEX_DATA}"
ctest --test-dir build/release -j2 --output-on-failure
