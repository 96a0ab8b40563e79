#!/usr/bin/env python3
"""Makes ring.glb: the table scene with a golden ring that turns upon the table, beside vase and cup.

    python3 make_ring.py            writes ring.glb beside this file
    python3 make_ring.py -o F.glb   writes somewhere else

The room is that of ../table/make_table.py; its lamp hangs still. Two animations: `view` turns the camera around the table,
`ring` turns the ring once about the vertical. The ring stands upright and is thicker on one side, so that it looks different
from everywhere; its atlas is one rectangle, round the ring along u and round its cross-section along v.
"""

import argparse
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "table"))
import make_table as table  # noqa: E402

VIEW_SAMPLES = 24
VIEW_STEP = 1.5               # degrees from sample to sample: 34.5 in all
RING_SAMPLES = 48
RING_STEP = 360 / RING_SAMPLES
RING_AT = (-0.03, 0.30)       # x, z
RING_R = 0.085                # of the circle within the metal
METAL_R = 0.022               # of the metal, in the mean
THICKER = 0.45                # by so much of that on the one side, and thinner on the other
ROUND, ACROSS = 64, 20        # quads


def metal_radius(phi):
    """At an angle around the ring, 0 outwards, pi / 2 up."""
    return METAL_R * (1 + THICKER * math.cos(phi - 0.6))


def ring_point(phi, psi):
    rho = RING_R + metal_radius(phi) * math.cos(psi)
    return (rho * math.cos(phi), rho * math.sin(phi), metal_radius(phi) * math.sin(psi))


def ring_normal(phi, psi):
    e = 1e-5
    a, b = ([q - p for p, q in zip(ring_point(phi - s, psi - t), ring_point(phi + s, psi + t))] for s, t in ((e, 0), (0, e)))
    n = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    length = math.sqrt(sum(c * c for c in n))
    return tuple(c / length for c in n)


def make_ring():
    """About the origin; its lowest point is `lowest` below it."""
    m = table.Mesh()
    rows = []
    for i in range(ROUND + 1):
        phi = 2 * math.pi * i / ROUND
        rows.append([m.vertex(ring_point(phi, psi), ring_normal(phi, psi), (0.03 + 0.94 * i / ROUND, 0.03 + 0.94 * j / ACROSS))
                     for j in range(ACROSS + 1) for psi in [2 * math.pi * j / ACROSS]])
    for a, b in zip(rows, rows[1:]):
        for j in range(ACROSS):
            m.quad(a[j], b[j], b[j + 1], a[j + 1])
    return m


def build(path):
    g = table.Glb()
    g.doc["asset"]["generator"] = "make_ring.py"
    g.doc["scenes"][0]["name"] = "ring"
    view_pivot, _ = table.furnish(g)
    gold = g.material("gold", None, (1.0, 0.77, 0.34), 0.06)
    g.doc["materials"][gold]["pbrMetallicRoughness"]["metallicFactor"] = 1.0
    lowest = max(-p[1] for p in (ring_point(2 * math.pi * i / 720, 0) for i in range(720)))
    ring = g.node(name="ring", mesh=g.mesh("ring", make_ring(), gold), translation=[RING_AT[0], table.TABLE_Y + lowest + 0.001, RING_AT[1]])
    g.swing("view", view_pivot, (0, 1, 0), VIEW_STEP * (VIEW_SAMPLES - 1), 5, 0.1 * (VIEW_SAMPLES - 1))
    g.swing("ring", ring, (0, 1, 0), 360.0, 9, 0.1 * RING_SAMPLES)
    g.write(path)
    print("%s: %d bytes" % (path.name, path.stat().st_size))


def main():
    p = argparse.ArgumentParser(description="Makes ring.glb.")
    p.add_argument("-o", "--output", type=Path, default=Path(__file__).with_name("ring.glb"), help="the file to write")
    build(p.parse_args().output)


if __name__ == "__main__":
    main()
