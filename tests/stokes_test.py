#!/usr/bin/python3
"""Flows by vasohex_stokes: orders of convergence against Poiseuille flow, conservation, and refusals.

    stokes_test.py POISEUILLE VASOHEX_STOKES MESHES_FOLDER
"""
import json
import os
import re
import subprocess
import sys
import tempfile

poiseuille, stokes, meshes = sys.argv[1:]
failures = []


def check(condition, what):
    print(("ok      " if condition else "FAILED  ") + what)
    if not condition:
        failures.append(what)


def run(source, *options):
    """Exit code, message and flow.json (or None) of one run."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        done = subprocess.run([stokes, source, "-o", out, *options], capture_output=True, text=True)
        path = os.path.join(out, "flow.json")
        figures = json.load(open(path)) if os.path.exists(path) else None
        return done.returncode, done.stderr.strip(), figures


def convergence():
    """Rates of the L2 errors: at least k + 1 - .4 for velocities and pressures (whose exact solution is linear, down to what the residual allows), k - .4
    for the wall's shear stress, where the geometry has the velocity's degree."""
    done = subprocess.run([poiseuille, "3"], capture_output=True, text=True, check=True)
    rows = [[c.strip() for c in line.split("|")[1:-1]] for line in done.stdout.splitlines()[2:]]
    check(len(rows) == 15, "poiseuille: 5 pairs of degrees on 3 meshes")
    for row in rows[2::3]:  # the finest of each pair: the coarse ones are far from their asymptotic rates
        order, degree = int(row[0]), int(row[1])
        velocity, pressure, shear = (float(re.search(r"\((.*)\)", c).group(1)) for c in row[5:8])
        text = f"geometry {order}, velocity {degree}: rates {velocity}, {pressure}, {shear}"
        if order == degree:
            check(velocity > degree + .6 and (pressure > degree + .4 or float(row[6].split()[0]) < 1e-9) and shear > degree - .4, text)
        else:  # the geometry's error is what remains
            check(velocity > order + .6, text)


def conservation():
    code, message, j = run(f"{meshes}/iliac_bifurcation.swc", "-p", "2", "-n", "1", "--flow-rate", "1000")
    check(code == 0, "iliac bifurcation: runs " + message)
    ends = {e["name"]: e for e in j["ends"]}
    check(abs(ends["inlet"]["flow_out"] / -1000 - 1) < 1e-6, "iliac: the inflow is what was asked for")
    check(abs(j["flow_imbalance"]) < 1e-4, f"iliac: flow in = flow out to {j['flow_imbalance']:.1e}")
    check(j["converged"] and j["iterations"] <= 60, f"iliac: {j['iterations']} iterations")
    free = ends["outlet_1"]["flow_out"]
    resist = 10 * ends["inlet"]["pressure"] / 1000
    code, message, j = run(f"{meshes}/iliac_bifurcation.swc", "-p", "2", "-n", "1", "--flow-rate", "1000",
                           "--resistance", f"outlet_1={resist}")
    ends = {e["name"]: e for e in j["ends"]}
    flow, pressure = ends["outlet_1"]["flow_out"], ends["outlet_1"]["pressure"]
    check(code == 0 and flow < .5 * free, "iliac: a resistance drives the flow into the other outlet")
    check(abs(pressure / (resist * flow) - 1) < .02, "iliac: pressure at the outlet is resistance times flow")


def refusals():
    iliac = f"{meshes}/iliac_bifurcation.swc"
    for what, source, options, word in [
        ("several inlets without flows", f"{meshes}/willis_cycle.json", [], "--flow"),
        ("an end that does not exist", iliac, ["--flow-rate", "1", "--flow", "nowhere=1"], "nowhere"),
        ("no outlet", iliac, ["--flow", "outlet_1=-1", "--flow", "outlet_2=-1", "--flow-rate", "2"], "outlet"),
        ("the wall as an end", iliac, ["--flow-rate", "1", "--flow", "wall=1"], "wall"),
        ("flow and resistance", iliac, ["--flow-rate", "1", "--resistance", "inlet=1"], "only one"),
        ("no number", iliac, ["--flow", "inlet=much"], "NAME=NUMBER"),
        ("no file", f"{meshes}/nothing.swc", [], "nothing.swc"),
        ("zero viscosity", iliac, ["--viscosity", "0"], "viscosity"),
    ]:
        code, message, j = run(source, "-p", "1", "-n", "1", *options)
        check(code == 2 and word in message and "\n" not in message and j is None, f"{what}: {message}")
    with tempfile.TemporaryDirectory() as folder:
        apart = os.path.join(folder, "apart.swc")
        with open(apart, "w") as f:
            f.write("# units: mm\n1 3 0 0 0 1 -1\n2 3 0 0 8 1 1\n3 3 9 0 0 1 -1\n4 3 9 0 8 1 3\n")
        code, message, j = run(apart, "-p", "1", "-n", "1", "--flow", "inlet=1", "--flow", "inlet_2=1")
        check(code == 0, "two parts, each with its inlet: " + message)


convergence()
conservation()
refusals()
sys.exit(1 if failures else 0)
