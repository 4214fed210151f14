#!/usr/bin/env python3
"""Writes the example skeletons of this folder. README.md says where the figures come from. All lengths in mm.

Axes: x to the patient's left, y to the front, z up. Lengths and radii of the vessels are the constants below.
"""

import json
import math
import pathlib

FOLDER = pathlib.Path(__file__).parent


# --- curves ---------------------------------------------------------------------------------------------------------


def add(a, b, scale=1.0):
    return tuple(x + scale * y for x, y in zip(a, b))


def direction(lateral, front, down):
    """Unit vector; angles are not needed where three components say it."""
    length = math.sqrt(lateral**2 + front**2 + down**2)
    return (lateral / length, front / length, -down / length)


def bezier(p, t):
    """Cubic Bezier curve of the control points p at t."""
    s = 1 - t
    weights = (s**3, 3 * s * s * t, 3 * s * t * t, t**3)
    return tuple(sum(w * q[d] for w, q in zip(weights, p)) for d in range(3))


def arc(start, leaves, length, arrives):
    """A curve of the given length from start that leaves and arrives in the given directions."""

    def control(scale):
        end = add(start, add(leaves, arrives), scale / 2)
        return (start, add(start, leaves, scale / 3), add(end, arrives, -scale / 3), end)

    scale = length
    for _ in range(20):
        scale *= length / measure(control(scale))
    return control(scale)


def between(start, leaves, end, arrives):
    """A curve between two points that leaves and arrives in the given directions."""
    reach = math.dist(start, end) * 0.36
    return (start, add(start, leaves, reach), add(end, arrives, -reach), end)


def measure(curve, upto=1.0, steps=400):
    points = [bezier(curve, upto * i / steps) for i in range(steps + 1)]
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def along(curve, spacing):
    """Points at equal arc lengths, both ends included."""
    fine = [bezier(curve, i / 2000) for i in range(2001)]
    lengths = [0.0]
    for a, b in zip(fine, fine[1:]):
        lengths.append(lengths[-1] + math.dist(a, b))
    count = max(3, round(lengths[-1] / spacing))
    points, k = [], 0
    for i in range(count + 1):
        s = lengths[-1] * i / count
        while k < len(fine) - 2 and lengths[k + 1] < s:
            k += 1
        u = (s - lengths[k]) / (lengths[k + 1] - lengths[k])
        points.append(add(fine[k], add(fine[k + 1], fine[k], -1), u))
    points[-1] = curve[3]
    return points


# --- skeletons ------------------------------------------------------------------------------------------------------


class Skeleton:
    """Points with radii, branches as lists of points, names of ends."""

    def __init__(self):
        self.points, self.radii, self.branches, self.names = [], [], [], {}

    def point(self, position, radius):
        self.points.append(tuple(round(x, 4) + 0.0 for x in position))
        self.radii.append(round(radius, 4))
        return len(self.points) - 1

    def vessel(self, curve, radii, start=None, end=None, name=None):
        """A branch along a curve, its radius from radii[0] to radii[1]; start and end are points that exist already.

        Returns its last point. name: of its free end."""
        positions = along(curve, sum(radii) / 2)
        last = len(positions) - 1
        branch = []
        for i, p in enumerate(positions):
            if i == 0 and start is not None:
                branch.append(start)
            elif i == last and end is not None:
                branch.append(end)
            else:
                branch.append(self.point(p, radii[0] + (radii[1] - radii[0]) * i / last))
        self.branches.append(branch)
        if name is not None:
            self.names[branch[-1] if start is not None else branch[0]] = name
        return branch[-1]

    def write_json(self, name):
        lines = [
            '{"format": "vascular-graph-1", "units": "mm",',
            ' "points": [\n  ' + ",\n  ".join(json.dumps(p) for p in self.points) + "],",
            ' "radius": ' + json.dumps(self.radii) + ",",
            ' "branches": [\n  ' + ",\n  ".join(json.dumps(b) for b in self.branches) + "],",
            ' "names": ' + json.dumps({str(p): n for p, n in sorted(self.names.items())}) + "}",
        ]
        (FOLDER / f"{name}.json").write_text("\n".join(lines) + "\n")

    def write_swc(self, name, title):
        """Each branch starts at a point of an earlier one, or is the first; names are not part of SWC."""
        parents = {self.branches[0][0]: -2}
        for branch in self.branches:
            for before, point in zip(branch, branch[1:]):
                parents[point] = before
        lines = [f"# {title}", "# units: mm", "# id type x y z radius parent"]
        for i, (p, r) in enumerate(zip(self.points, self.radii)):
            x, y, z = p
            lines.append(f"{i + 1} 0 {x:g} {y:g} {z:g} {r:g} {parents[i] + 1}")
        (FOLDER / f"{name}.swc").write_text("\n".join(lines) + "\n")

    def blocks(self):
        """Estimate of the number of blocks: 7 + 4 k at a junction of degree k, 5 per axial block of two radii."""
        degree = {}
        for branch in self.branches:
            for p in (branch[0], branch[-1]):
                degree[p] = degree.get(p, 0) + 1
        total = sum(7 + 4 * k for k in degree.values() if k > 2)
        for branch in self.branches:
            length = sum(math.dist(self.points[a], self.points[b]) for a, b in zip(branch, branch[1:]))
            radius = self.radii[branch[len(branch) // 2]]
            for p in (branch[0], branch[-1]):
                if degree[p] > 2:
                    thin = radius < 0.6 * self.radii[p]
                    length -= self.radii[p] + 0.5 * radius if thin else 0.8 * self.radii[p]
            total += 5 * max(1, round(length / (2 * radius)))
        return total


# --- the examples ---------------------------------------------------------------------------------------------------


def iliac_bifurcation():
    """Infrarenal aorta and common iliac arteries."""
    aorta, iliac = 9.5, 6.1  # radii
    left, right = math.radians(19), math.radians(26)  # take-off angles
    s = Skeleton()
    top = (2.0, -4.0, 62.0)
    fork = s.vessel(between(top, direction(0, 0.12, 1), (0, 0, 0), direction(0, -0.08, 1)), (aorta, aorta))
    for angle, length in ((left, 48.0), (-right, 55.0)):
        leaves = (math.sin(angle), 0.02, -math.cos(angle))
        arrives = direction(1.25 * math.sin(angle), -0.45, 0.8)
        s.vessel(arc((0, 0, 0), leaves, length, arrives), (iliac, 0.97 * iliac), start=fork)
    s.write_swc("iliac_bifurcation", "Infrarenal aorta and common iliac arteries; see README.md")
    return s


def abdominal_aorta():
    """From above the superior mesenteric artery to the external and internal iliac arteries."""
    # heights over the renal arteries
    inlet, mesenteric, inferior, fork = 48.0, 21.0, -70.0, -107.0
    suprarenal, renal_level, infrarenal = 11.0, 10.2, 9.5  # radii of the aorta
    lengths = {
        "mesenteric": 53.0,
        "renal": 45.5,
        "inferior": 43.0,
        "common": 50.0,
        "external": 67.0,
        "internal": 27.0,
    }
    radii = {"mesenteric": 3.6, "renal": 2.75, "inferior": 2.0, "common": 6.1, "external": 4.4, "internal": 3.2}

    def front(z):  # the aorta follows the lordosis of the spine
        return 9.0 * math.sin(math.pi * (z + 130) / 190)

    def aorta(above, below):
        def at(z):
            return (2.0 + 0.02 * z, front(z), z)

        def slope(z):
            a, b = at(z + 0.5), at(z - 0.5)
            return direction(b[0] - a[0], b[1] - a[1], 1)

        return between(at(above), slope(above), at(below), slope(below)), at(below)

    s = Skeleton()
    curve, sma_at = aorta(inlet, mesenteric)
    sma = s.vessel(curve, (suprarenal, suprarenal), name="inlet")
    curve, renal_at = aorta(mesenteric, 0)
    renal = s.vessel(curve, (suprarenal, renal_level), start=sma)
    curve, ima_at = aorta(0, inferior)
    ima = s.vessel(curve, (renal_level, infrarenal), start=renal)
    curve, fork_at = aorta(inferior, fork)
    bifurcation = s.vessel(curve, (infrarenal, infrarenal), start=ima)

    def side(name, start, at, leaves, arrives, outlet):
        r = radii[name]
        s.vessel(arc(at, leaves, lengths[name], arrives), (r, 0.95 * r), start=start, name=outlet)

    side("mesenteric", sma, sma_at, direction(0, 1, 0.55), direction(0.05, 0.25, 1), "superior_mesenteric")
    side("renal", renal, renal_at, direction(1, -0.05, 0.15), direction(1, -0.55, 0.3), "left_renal")
    side("renal", renal, renal_at, direction(-1, 0.1, 0.3), direction(-1, -0.6, 0.45), "right_renal")
    side("inferior", ima, ima_at, direction(0.55, 0.75, 0.6), direction(0.5, 0.1, 1), "inferior_mesenteric")
    for sign, side_name, take_off in ((1, "left", 19), (-1, "right", 26)):
        angle = sign * math.radians(take_off)
        iliac = arc(
            fork_at,
            (math.sin(angle), -0.05, -math.cos(angle)),
            lengths["common"],
            direction(1.3 * math.sin(angle), -0.5, 0.75),
        )
        r = radii["common"]
        end = s.vessel(iliac, (r, 0.97 * r), start=bifurcation)
        at = iliac[3]
        side(
            "external", end, at, direction(0.75 * sign, -0.02, 0.75), direction(0.4 * sign, 0.85, 0.75),
            side_name + "_external_iliac",
        )
        side(
            "internal", end, at, direction(0.05 * sign, -0.9, 0.65), direction(-0.1 * sign, -0.25, 1),
            side_name + "_internal_iliac",
        )
    s.write_json("abdominal_aorta")
    return s


def willis_cycle():
    """The arterial circle at the base of the brain: one cycle of nine vessels."""
    ica, mca, aca, acoa, pcoa, pca, basilar = 1.9, 1.67, 1.05, 0.75, 0.61, 1.0, 1.64
    s = Skeleton()
    tip_at = (0, -11, 0)
    tip = s.vessel(
        between((0.5, -15, -29), (0, 0.25, 0.97), tip_at, (0, 0.05, 1)), (basilar, 0.95 * basilar),
        name="inlet_basilar",
    )
    medial = {}
    for sign, side in ((1, "left"), (-1, "right")):

        def at(x, y, z):
            return (sign * x, y, z)

        def unit(x, y, z):
            return direction(sign * x, y, -z)

        pca_at, ica_at, end_at, acoa_at = at(6, -9, 1), at(8, 3.5, -1), at(9.2, 8.2, 6), at(2, 19, 8.5)
        p1 = s.vessel(between(tip_at, unit(0.95, 0.1, 0.3), pca_at, unit(0.9, 0.35, -0.1)), (pca, pca), start=tip)
        s.vessel(
            between(pca_at, unit(0.9, -0.1, 0.1), at(14.5, -21, 7), unit(0.2, -1, 0.4)), (pca, 0.9 * pca),
            start=p1, name=side + "_posterior",
        )
        siphon = between(at(12, -3, -24), unit(-0.1, 0.9, 0.5), ica_at, unit(-0.1, 0.2, 1))
        carotid = s.vessel(siphon, (1.1 * ica, ica), name="inlet_" + side + "_carotid")
        s.vessel(
            between(pca_at, unit(0.1, 1, 0.25), ica_at, unit(0.25, 1, -0.2)), (pcoa, pcoa), start=p1,
            end=carotid,
        )
        end = s.vessel(
            between(ica_at, unit(0.05, 0.45, 0.9), end_at, unit(0.2, 0.55, 0.8)), (ica, 0.95 * ica),
            start=carotid,
        )
        s.vessel(
            between(end_at, unit(1, 0.1, 0.35), at(25, 7.5, 9.5), unit(1, -0.25, 0.15)), (mca, 0.9 * mca),
            start=end, name=side + "_middle",
        )
        medial[sign] = s.vessel(
            between(end_at, unit(-0.7, 0.65, 0.35), acoa_at, unit(-0.35, 0.9, 0.2)), (aca, aca),
            start=end,
        )
        s.vessel(
            between(acoa_at, unit(0.05, 0.9, 0.3), at(3.2, 25, 28), unit(0.05, -0.15, 1)),
            (aca, 0.95 * aca), start=medial[sign], name=side + "_anterior",
        )
    s.vessel(
        between((2, 19, 8.5), (-1, 0.1, 0), (-2, 19, 8.5), (-1, -0.1, 0)), (acoa, acoa),
        start=medial[1], end=medial[-1],
    )
    s.write_json("willis_cycle")
    return s


def trifurcation():
    """One vessel into three that do not lie in a plane; radii after Murray's law, r^3 = r1^3 + r2^3 + r3^3."""
    stem = 5.0
    daughters = (3.6, 3.4, 3.4)
    s = Skeleton()
    fork = s.vessel(
        between((3, -2, 40), direction(-0.2, 0.1, 1), (0, 0, 0), direction(0, 0, 1)), (stem, stem),
        name="inlet",
    )
    for i, r in enumerate(daughters):
        turn = math.radians((10, 125, 245)[i])
        tilt = math.radians((48, 55, 52)[i])
        across = (math.cos(turn), math.sin(turn))
        leaves = (math.sin(tilt) * across[0], math.sin(tilt) * across[1], -math.cos(tilt))
        arrives = direction(0.45 * across[0] - 0.35 * across[1], 0.45 * across[1] + 0.35 * across[0], 1)
        s.vessel(arc((0, 0, 0), leaves, 11 * r, arrives), (r, 0.95 * r), start=fork, name=f"outlet_{i + 1}")
    s.write_json("trifurcation")
    return s


def helix():
    """Two turns of a helix of radius 4 and rise 6 per turn, around a tube of radius 1."""
    s = Skeleton()
    count = 52
    s.branches.append([])
    for i in range(count + 1):
        a = 4 * math.pi * i / count
        s.branches[0].append(s.point((4 * math.cos(a), 4 * math.sin(a), 6 * a / (2 * math.pi)), 1.0))
    s.write_swc("helix", "Helix; see README.md")
    return s


if __name__ == "__main__":
    for example in (iliac_bifurcation, abdominal_aorta, willis_cycle, trifurcation, helix):
        skeleton = example()
        counts = f"{len(skeleton.points)} points, {len(skeleton.branches)} branches, about {skeleton.blocks()} blocks"
        print(f"{example.__name__}: {counts}")
