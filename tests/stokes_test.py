#!/usr/bin/python3
"""Flows by vasohex_stokes: orders of convergence against Poiseuille flow, conservation, and refusals.

    stokes_test.py POISEUILLE VASOHEX_STOKES VASOHEX MESHES_FOLDER
"""
import json
import os
import re
import subprocess
import sys
import tempfile

poiseuille, stokes, vasohex, meshes = sys.argv[1:]
failures = []


def check(condition, what):
    print(("ok      " if condition else "FAILED  ") + what)
    if not condition:
        failures.append(what)


def run(source, *options, ranks=1):
    """Exit code, message and flow.json (or None) of one run."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        command = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
        done = subprocess.run([*command, stokes, source, "-o", out, *options], capture_output=True, text=True)
        path = os.path.join(out, "flow.json")
        figures = json.load(open(path)) if os.path.exists(path) else None
        return done.returncode, done.stderr.strip(), figures


def convergence():
    """Rates of the L2 errors where the geometry has the velocity's degree k: k + 1 for velocities, k + 1 for pressures
    (whose exact solution is linear), k + 1/2 for the wall's shear stress. A lower geometry spoils the pressure."""
    done = subprocess.run([poiseuille, "3"], capture_output=True, text=True, check=True)
    rows = [[c.strip() for c in line.split("|")[1:-1]] for line in done.stdout.splitlines()[2:]]
    check(len(rows) == 15, "poiseuille: 5 pairs of degrees on 3 meshes")
    pressure_error = {}
    for row in rows[2::3]:  # the finest of each pair: the coarse ones are far from their asymptotic rates
        order, degree = int(row[0]), int(row[1])
        velocity, pressure, shear = (float(re.search(r"\((.*)\)", c).group(1)) for c in row[5:8])
        pressure_error[order, degree] = float(row[6].split()[0])
        text = f"geometry {order}, velocity {degree}: rates {velocity}, {pressure}, {shear}"
        if order == degree:
            check(velocity > degree + .9 and pressure > degree + .9 and shear > degree + .5, text)
        else:  # the geometry's error is what remains
            check(velocity > order + .9, text)
    loss = pressure_error[2, 3] / pressure_error[3, 3]
    check(loss > 100, f"velocities of degree 3, geometry of order 2: the error of pressures is {loss:.0f} times larger")


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


def subtree():
    """docs/subtree.py: what is behind a point, with all its outlets."""
    with tempfile.TemporaryDirectory() as folder:
        cut = os.path.join(folder, "cut.swc")
        script = os.path.join(meshes, "..", "docs", "subtree.py")
        subprocess.run([sys.executable, script, f"{meshes}/iliac_bifurcation.swc", "6", cut], check=True)
        code, message, j = run(cut, "-p", "2", "-n", "1", "--flow-rate", "1000")
        names = [e["name"] for e in j["ends"]] if j else []
        check(code == 0 and names == ["inlet", "outlet_1", "outlet_2"], f"subtree: {names} {message}")


def same_mesh():
    """A skeleton and its block file, one rank and two."""
    iliac = f"{meshes}/iliac_bifurcation.swc"
    with tempfile.TemporaryDirectory() as folder:
        blocks = os.path.join(folder, "blocks.json")
        subprocess.run([vasohex, "blocks", iliac, "-o", blocks, "-q"], check=True)
        options = ["-p", "3", "-n", "1", "--flow-rate", "1000"]
        results = [run(source, *options) for source in (iliac, blocks)]
        results.append(run(iliac, *options, ranks=2))
        drops = []
        for (code, message, j), what in zip(results, ("skeleton", "block file", "two ranks")):
            check(code == 0 and j, f"{what}: runs {message}")
            drops.append(j["ends"][0]["pressure"])
        # blocks below degree 4 are optimised for the mesh asked for, those of a file for none
        check(abs(drops[1] / drops[0] - 1) < 1e-3, f"skeleton and block file: pressures {drops[0]}, {drops[1]}")
        check(abs(drops[2] / drops[0] - 1) < 1e-6, f"one rank and two: pressures {drops[0]}, {drops[2]}")

        with open(blocks) as f:
            j = json.load(f)
        for node in j["blocks"][0]["nodes"]:
            j["nodes"][node][0] *= -1
        with open(blocks, "w") as f:
            json.dump(j, f)
        refused("an inverted element", blocks, [], "element")


def refused(what, source, options, word):
    code, message, j = run(source, "-p", "1", "-n", "1", *options)
    check(code == 2 and word in message and "\n" not in message and j is None, f"{what}: {message}")


def refusals():
    iliac = f"{meshes}/iliac_bifurcation.swc"
    for what, source, options, word in [
        ("several inlets without flows", f"{meshes}/willis_cycle.json", [], "--flow"),
        ("one flow for several inlets", f"{meshes}/willis_cycle.json", ["--flow-rate", "1"], "--flow"),
        ("an end that does not exist", iliac, ["--flow-rate", "1", "--flow", "nowhere=1"], "nowhere"),
        ("no outlet", iliac, ["--flow", "outlet_1=-1", "--flow", "outlet_2=-1", "--flow-rate", "2"], "outlet"),
        ("no flow at all", iliac, ["--flow-rate", "0"], "no flow"),
        ("the wall as an end", iliac, ["--flow-rate", "1", "--flow", "wall=1"], "wall"),
        ("flow and resistance", iliac, ["--flow-rate", "1", "--resistance", "inlet=1"], "only one"),
        ("a negative resistance", iliac, ["--resistance", "outlet_1=-1"], "negative"),
        ("no number", iliac, ["--flow", "inlet=much"], "NAME=NUMBER"),
        ("no file", f"{meshes}/nothing.swc", [], "nothing.swc"),
        ("no input that is known", f"{meshes}/README.md", [], ".swc"),
        ("zero viscosity", iliac, ["--viscosity", "0"], "--viscosity: 0: must be a number > 0"),
        ("viscosity in words", iliac, ["--viscosity", "thick"], "--viscosity: thick: must be a number > 0"),
        ("no elements", iliac, ["-n", "0"], "whole number >= 1"),
        ("pressures of degree 0", iliac, ["-k", "1"], "--degree"),
    ]:
        refused(what, source, options, word)
    with tempfile.TemporaryDirectory() as folder:
        def tubes(names):
            path = os.path.join(folder, "tubes.json")
            with open(path, "w") as f:
                json.dump({"format": "vascular-graph-1", "units": "mm", "radius": [1, 1, 1, 1],
                           "points": [[0, 0, 0], [0, 0, 8], [9, 0, 0], [9, 0, 8]], "branches": [[0, 1], [2, 3]],
                           "names": dict(zip("0123", names))}, f)
            return path

        refused("a part without an inlet", tubes(["inlet", "a", "b", "c"]), [], "unconnected parts")
        refused("no inlet", tubes(["a", "b", "c", "d"]), [], "inlet")
        code, message, j = run(tubes(["inlet", "a", "inlet_2", "b"]), "-p", "1", "-n", "1", "--flow", "inlet=1",
                               "--flow", "inlet_2=1")
        check(code == 0, "two parts, each with its inlet: " + message)


convergence()
conservation()
subtree()
same_mesh()
refusals()
sys.exit(1 if failures else 0)
