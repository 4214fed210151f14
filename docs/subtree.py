#!/usr/bin/python3
"""Cuts a subtree with all its outlets out of an SWC file: one point and all that is behind it.

    docs/subtree.py TREE.swc POINT SUBTREE.swc

POINT is the id of its line.
"""
import sys

source, root, out = sys.argv[1:]
lines = [line.rstrip() for line in open(source)]
points = {line.split()[0]: line.split() for line in lines if line.strip() and not line.lstrip().startswith("#")}
if root not in points:
    sys.exit(f"{source}: there is no point {root}")
behind = {root: True}


def is_behind(point):
    chain = []
    while point in points and point not in behind:
        chain.append(point)
        point = points[point][6]
    behind.update(dict.fromkeys(chain, behind.get(point, False)))
    return behind.get(chain[0] if chain else point, False)


kept = [words for point, words in points.items() if is_behind(point)]
with open(out, "w") as f:
    f.writelines(line + "\n" for line in lines if line.lstrip().startswith("#"))
    for words in kept:
        f.write(" ".join(words[:6] + ["-1" if words[0] == root else words[6]]) + "\n")
print(f"{len(kept)} of {len(points)} points")
