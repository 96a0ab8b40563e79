#!/usr/bin/env python3
"""Makes table.glb: a vase, a glass cup and a table in a papered room, with a lamp that swings above.

    python3 make_table.py            writes table.glb beside this file, reads it back and checks it
    python3 make_table.py --check    only checks the table.glb that is there
    python3 make_table.py -o F.glb   writes somewhere else

Python 3 standard library only, and no randomness: the same script makes the same scene (another version of zlib may
pack the images differently, to the same pixels). It takes about half a minute.

Metres, Y up, the table stands in the origin. Seven mesh nodes: vase, cup, table_top, table_stand, walls, floor and the
lamp. Two animations: `view` turns the camera around the table, `lamp` swings the lamp. The rest pose is the middle of
both. All lathe objects (everything but walls and floor) are drawn as profiles: points (radius, height).

Texture coordinates: every object has one atlas in TEXCOORD_0, charts inside [0,1]^2 that do not overlap, at least
1.5 % of the atlas apart and nowhere mirrored. Steep parts of a lathe object are unrolled as rectangles with the arc
length of the profile upright, flat parts are discs seen from outside. Sizes within an atlas are metric, but for
parts that nobody sees, which are smaller.
"""

import argparse
import json
import math
import struct
import sys
import zlib
from pathlib import Path

# ---------------------------------------------------------------------------------------------- the scene's numbers

ROOM = 6.0                    # the room is ROOM x ROOM, walls WALL high, no ceiling: the sky lights it
WALL = 2.6
TABLE_Y = 0.74                # upper side of the table top
TABLE_R = 0.62
VASE_AT = (-0.16, -0.09)      # x, z
CUP_AT = (0.22, 0.17)
GROWN = 1.1                   # vase and cup are drawn at a natural size and enlarged by this

VIEW_SAMPLES = 64
VIEW_STEP = 1.8               # degrees from sample to sample: 113.4 in all
VIEW_DISTANCE = 2.2          # horizontal, from the table's axis
VIEW_HEIGHT = 1.42
VIEW_LOOK_AT = 0.86           # height of the point on the table's axis that is looked at
VIEW_YFOV = 38.0
VIEW_ASPECT = 4.0 / 3.0

LAMP_SAMPLES = 8
LAMP_STEP = 8.0               # degrees from sample to sample: 56 in all
LAMP_PIVOT = (0.04, 2.82, 0.16)
LAMP_LENGTH = 0.90
LAMP_R = 0.08
LAMP_COLOUR = (1.0, 0.83, 0.62)
LAMP_STRENGTH = 330.0

# ------------------------------------------------------------------------------------------------------ small helpers


def clamp(x, a=0.0, b=1.0):
    return a if x < a else b if x > b else x


def smooth(a, b, x):
    t = clamp((x - a) / (b - a))
    return t * t * (3 - 2 * t)


def mix(a, b, t):
    return tuple(p + (q - p) * t for p, q in zip(a, b))


def hash01(*key):
    """A number in [0,1) that depends on integers and on nothing else."""
    h = 2166136261
    for k in key:
        h = ((h ^ (k & 0xFFFFFFFF)) * 16777619) & 0xFFFFFFFF
        h ^= h >> 13
        h = (h * 0x5BD1E995) & 0xFFFFFFFF
        h ^= h >> 15
    return h / 4294967296.0


def noise(x, y, seed, period=0):
    """Value noise in [0,1]; with a period it repeats in x."""
    i, j = math.floor(x), math.floor(y)
    fx, fy = x - i, y - j
    fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
    i0, i1 = (i % period, (i + 1) % period) if period else (i, i + 1)
    a = hash01(i0, j, seed) * (1 - fx) + hash01(i1, j, seed) * fx
    b = hash01(i0, j + 1, seed) * (1 - fx) + hash01(i1, j + 1, seed) * fx
    return a * (1 - fy) + b * fy


def grain(across, along, seed, period=0):
    """Wood: streaks along one direction, in [0,1]."""
    return 0.62 * noise(across, along, seed, period) + 0.38 * noise(across * 2, along * 1.7, seed + 1, period * 2)


# --------------------------------------------------------------------------------------------------------- PNG images


class Picture:
    """An 8-bit palette image. Colours are linear; ramps of colours get consecutive palette entries."""

    def __init__(self, size):
        self.size = size
        self.palette = []
        self.rows = [bytearray(size) for _ in range(size)]

    def ramp(self, a, b, n):
        """n colours from a to b; returns a function from [0,1] to the palette index."""
        first = len(self.palette)
        self.palette += [mix(a, b, i / max(1, n - 1)) for i in range(n)]
        assert len(self.palette) <= 256
        return lambda t: first + int(clamp(t) * (n - 1) + 0.5)

    def png(self):
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        def srgb(c):
            c = clamp(c)
            return int(255 * (12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055) + 0.5)

        plte = bytes(srgb(c) for colour in self.palette for c in colour)
        raw = b"".join(b"\0" + bytes(r) for r in self.rows)
        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", self.size, self.size, 8, 3, 0, 0, 0))
                + chunk(b"sRGB", b"\0") + chunk(b"PLTE", plte) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))


class Brush:
    """Anti-aliased strokes of varying width on a small canvas that repeats in x and (if wrap_y) in y."""

    SUB = 4

    def __init__(self, width, height, wrap_y):
        self.w, self.h, self.wrap_y = width * self.SUB, height * self.SUB, wrap_y
        self.dots = [bytearray(self.w) for _ in range(self.h)]

    def disc(self, x, y, r, ink=1):
        x, y, r = x * self.SUB, y * self.SUB, r * self.SUB
        for j in range(math.ceil(y - r - 0.5), math.floor(y + r - 0.5) + 1):
            if not self.wrap_y and not 0 <= j < self.h:
                continue
            half = math.sqrt(max(0.0, r * r - (j + 0.5 - y) ** 2))
            row = self.dots[j % self.h]
            for i in range(math.ceil(x - half - 0.5), math.floor(x + half - 0.5) + 1):
                row[i % self.w] = ink

    def stroke(self, points, width, ink=1):
        """points: 2, 3 or 4 Bezier points; width(t): the half width at t in [0,1]; ink 0 wipes out."""
        n = 48
        for k in range(n + 1):
            t = k / n
            p = list(points)
            while len(p) > 1:
                p = [mix(a, b, t) for a, b in zip(p, p[1:])]
            if width(t) > 0:
                self.disc(p[0][0], p[0][1], width(t), ink)

    def cover(self, i, j):
        """Covered part of pixel (i, j), in [0,1]."""
        s = self.SUB
        i = (i % (self.w // s)) * s
        return sum(sum(self.dots[(j * s + k) % self.h][i:i + s]) for k in range(s)) / (s * s)


def leaf(w):
    """Half width along a leaf: thin at the base, full below the middle, pointed."""
    return lambda t: w * 1.9 * (t + 0.04) ** 0.7 * (1 - t) ** 0.8


# ------------------------------------------------------------------------------------------------------------- meshes


class Mesh:
    def __init__(self):
        self.pos, self.nrm, self.uv, self.tri = [], [], [], []

    def vertex(self, p, n, uv):
        self.pos.append(p)
        self.nrm.append(n)
        self.uv.append(uv)
        return len(self.pos) - 1

    def quad(self, a, b, c, d):
        self.tri += [(a, b, c), (a, c, d)]


def curve(points, start=None, end=None):
    """A smooth profile through points (r, y, spans): Catmull-Rom over chord lengths.

    spans: into how many straight pieces the part up to the next point is cut. start, end: directions at the ends.
    Returns samples (r, y, normal_r, normal_y); walking along the profile the outside is on the right.
    """
    n = len(points)
    p = [(q[0], q[1]) for q in points]
    h = [math.hypot(p[i + 1][0] - p[i][0], p[i + 1][1] - p[i][1]) for i in range(n - 1)]
    d = [((p[i + 1][0] - p[i][0]) / h[i], (p[i + 1][1] - p[i][1]) / h[i]) for i in range(n - 1)]
    m = [None] * n
    for i in range(1, n - 1):
        m[i] = mix(d[i - 1], d[i], h[i - 1] / (h[i - 1] + h[i]))
    m[0] = start or (d[0] if n == 2 else mix(m[1], d[0], 2.0))
    m[n - 1] = end or (d[-1] if n == 2 else mix(m[n - 2], d[-1], 2.0))
    out = []
    for i in range(n - 1):
        spans = points[i][2]
        for k in range(spans + (1 if i == n - 2 else 0)):
            t = k / spans
            v, g = [0, 0], [0, 0]
            for c in range(2):
                a, b, ma, mb = p[i][c], p[i + 1][c], m[i][c] * h[i], m[i + 1][c] * h[i]
                v[c] = (2 * t**3 - 3 * t**2 + 1) * a + (t**3 - 2 * t**2 + t) * ma + (3 * t**2 - 2 * t**3) * b + (t**3 - t**2) * mb
                g[c] = (6 * t**2 - 6 * t) * (a - b) + (3 * t**2 - 4 * t + 1) * ma + (3 * t**2 - 2 * t) * mb
            length = math.hypot(g[0], g[1])
            nr, ny = g[1] / length, -g[0] / length
            if v[0] < 1e-9:
                v[0], nr, ny = 0.0, 0.0, math.copysign(1.0, ny)
            out.append((v[0], v[1], nr, ny))
    return out


def arc_lengths(profile):
    s = [0.0]
    for a, b in zip(profile, profile[1:]):
        s.append(s[-1] + math.hypot(b[0] - a[0], b[1] - a[1]))
    return s


def spin(sample, theta, at):
    r, y, nr, ny = sample
    s, c = math.sin(theta), math.cos(theta)
    return (at[0] + r * s, y, at[1] + r * c), (nr * s, ny, nr * c)


def strip(mesh, profile, segments, at, left, top, width, scale, turn=(-math.pi, math.pi)):
    """Unrolls a steep part of a lathe object into a rectangle; returns the rectangle (left, top, right, bottom).

    A profile that climbs is an outside and is seen from there, one that falls is an inside.
    The seam (theta = -pi, pi) lies at the back, away from the middle view.
    """
    s = arc_lengths(profile)
    up = profile[-1][1] > profile[0][1]
    rows = []
    for k, sample in enumerate(profile):
        row = []
        for j in range(segments + 1):
            t = j / segments
            p, n = spin(sample, turn[0] + (turn[1] - turn[0]) * t, at)
            u = left + width * (t if up else 1 - t)
            v = top + scale * (s[-1] - s[k] if up else s[k])
            row.append(mesh.vertex(p, n, (u, v)))
        rows.append(row)
    for a, b in zip(rows, rows[1:]):
        for j in range(segments):
            mesh.quad(a[j], a[j + 1], b[j + 1], b[j])
    return left, top, left + width, top + scale * s[-1]


def disc(mesh, profile, segments, at, centre, scale):
    """Lays a flat part of a lathe object out as a disc or a ring; returns the radius of its chart."""
    s = arc_lengths(profile)
    outward = profile[-1][0] > profile[0][0]
    up = sum(q[3] for q in profile) > 0
    inner = profile[0][0] if outward else profile[-1][0]
    rows, largest = [], 0.0
    for k, sample in enumerate(profile):
        rho = scale * (inner + (s[k] if outward else s[-1] - s[k]))
        largest = max(largest, rho)
        row = []
        for j in range(1 if sample[0] == 0.0 else segments):
            theta = -math.pi + 2 * math.pi * j / segments
            p, n = spin(sample, theta, at)
            row.append(mesh.vertex(p, n, (centre[0] + rho * math.sin(theta), centre[1] + rho * math.cos(theta) * (1 if up else -1))))
        rows.append(row)
    for a, b in zip(rows, rows[1:]):
        for j in range(segments):
            k = (j + 1) % segments
            if len(a) == 1:
                mesh.tri.append((a[0], b[k], b[j]))
            elif len(b) == 1:
                mesh.tri.append((a[j], a[k], b[0]))
            else:
                mesh.quad(a[j], a[k], b[k], b[j])
    return largest


# ------------------------------------------------------------------------------------------------------------ objects


def make_vase():
    """A baluster vase: small foot, full shoulder, narrow neck, turned lip; cobalt glaze with a painted cream band."""
    m, y0, n = Mesh(), TABLE_Y + 0.001, 36

    def pts(*p):
        return [(GROWN * r, y0 + GROWN * y, k) for r, y, k in p]

    bottom = curve(pts((0, 0.004, 1), (0.070, 0.004, 1), (0.076, 0.0, 1)), start=(1, 0))
    body = curve(pts((0.076, 0.0, 1), (0.079, 0.012, 1), (0.071, 0.034, 1), (0.086, 0.10, 2), (0.140, 0.22, 2), (0.168, 0.325, 3),
                     (0.128, 0.412, 2), (0.064, 0.452, 1), (0.051, 0.476, 1)), start=(0.6, 0.8), end=(-0.12, 1.0))
    neck = curve(pts((0.051, 0.476, 1), (0.055, 0.515, 2), (0.080, 0.548, 1)), start=(-0.12, 1.0), end=(0.80, 0.60))
    lip = curve(pts((0.080, 0.548, 1), (0.0805, 0.5515, 1), (0.077, 0.553, 1)), start=(0.80, 0.60), end=(-0.90, -0.45))
    inside = curve(pts((0.077, 0.553, 1), (0.049, 0.515, 1), (0.050, 0.446, 1)), start=(-0.90, -0.45))
    floor = curve(pts((0.050, 0.446, 1), (0, 0.440, 1)))
    neck = neck + lip[1:]
    scale = 1.28 / GROWN                                                # of the atlas per metre
    v = {}
    v["body"] = strip(m, body, n, VASE_AT, 0.03, 0.21, 0.94, scale)
    v["neck"] = strip(m, neck, n, VASE_AT, 0.03, 0.03, 0.44, scale)
    v["inside"] = strip(m, inside, n, VASE_AT, 0.50, 0.03, 0.20, scale * 0.8)
    disc(m, floor, n, VASE_AT, (0.775, 0.09), 0.75)
    disc(m, bottom, n, VASE_AT, (0.905, 0.09), 0.65)
    return m, v, arc_lengths(body)[-1]


def paint_vase(v, body_length):
    pic = Picture(512)
    size = pic.size
    glaze = pic.ramp((0.012, 0.035, 0.17), (0.035, 0.105, 0.40), 40)
    cream = pic.ramp((0.66, 0.60, 0.48), (0.020, 0.050, 0.21), 12)       # the band, to the blue of its leaves
    gold = pic.ramp((0.012, 0.035, 0.17), (0.62, 0.42, 0.13), 8)
    inner = pic.ramp((0.10, 0.10, 0.11), (0.45, 0.42, 0.36), 16)
    left, top, right, bottom = (int(c * size + 0.5) for c in v["body"])
    scale = size * (v["body"][3] - v["body"][1]) / body_length          # pixels per metre of profile

    # The band lies over the belly and the shoulder: a scroll of leaves, repeats times around.
    repeats, half = 6, 0.070
    middle = top + (bottom - top) * 0.36
    y0, y1 = int(middle - half * scale), int(middle + half * scale)
    bw, bh = (right - left) // repeats, y1 - y0
    b = Brush(bw, bh, False)
    w, h = float(bw), float(bh)
    for side in (0, 1):                                                   # the vine: one wave, leaves on both sides
        x0 = side * w / 2
        sg = 1 if side == 0 else -1

        def at(x, y):
            return (x0 + x * w, h / 2 - sg * y * h)
        b.stroke([at(0, -0.16), at(0.18, -0.16), at(0.32, 0.16), at(0.5, 0.16)], lambda t: 1.3)
        b.stroke([at(0.02, -0.16), at(-0.04, 0.08), at(0.03, 0.22), at(0.17, 0.36)], leaf(4.6))
        b.stroke([at(0.02, -0.16), at(0.16, 0.02), at(0.25, 0.12), at(0.22, 0.28)], leaf(3.6))
        b.stroke([at(-0.02, -0.16), at(0.06, -0.26), at(0.16, -0.36), at(0.28, -0.34)], leaf(3.8))
        b.stroke([at(-0.02, -0.16), at(-0.06, -0.30), at(-0.12, -0.38), at(-0.20, -0.37)], leaf(3.2))
        b.disc(*at(0.34, -0.16), 2.9)
        b.disc(*at(0.40, -0.25), 2.1)
        b.disc(*at(0.29, -0.05), 2.1)

    # Gold lines: beside the band, above the foot, below the lip.
    def line(y, at, width):
        return clamp(width / 2 + 0.5 - abs(y + 0.5 - at))
    for y in range(size):
        row = pic.rows[y]
        for x in range(size):
            if y < 0.195 * size:                                          # neck, inside and what lies at the top
                if x < 0.485 * size:
                    t = (y - v["neck"][1] * size) / ((v["neck"][3] - v["neck"][1]) * size)
                    g = max(line(y, v["neck"][1] * size + 5, 6.0), line(y, v["neck"][3] * size - 2, 3.0))
                    row[x] = gold(g) if g > 0 else glaze(0.55 - 0.45 * clamp(t))
                else:
                    row[x] = inner(1 - smooth(v["inside"][1] * size, v["inside"][1] * size + 70, y))
                continue
            g = max(line(y, y0 - 4, 2.4), line(y, y1 + 3, 2.4), line(y, bottom - 26, 2.4), line(y, top + 2, 3.0))
            if y0 <= y < y1:
                row[x] = cream(b.cover(x - left, y - y0))
            elif g > 0:
                row[x] = gold(g)
            else:                                                         # thin glaze on the shoulder, thick and dark below
                t = (y - top) / (bottom - top)
                row[x] = glaze(0.95 - 0.9 * smooth(0.05, 0.95, t) + 0.10 * (noise((x - left) * 8 / (right - left), y / 48, 5, 8) - 0.5))
    return pic


def make_cup():
    """A stemmed glass: one closed solid, outside and inside."""
    m, y0, n = Mesh(), TABLE_Y + 0.001, 28

    def pts(*p):
        return [(GROWN * r, y0 + GROWN * y, k) for r, y, k in p]

    under = curve(pts((0, 0.003, 1), (0.052, 0.0, 1)), start=(1, 0))
    foot = curve(pts((0.052, 0.0, 1), (0.0545, 0.0022, 1), (0.050, 0.0046, 1), (0.025, 0.0085, 1), (0.0085, 0.0165, 1)), start=(1, 0.3), end=(-0.75, 0.65 / GROWN))
    stem = curve(pts((0.0085, 0.0165, 1), (0.0052, 0.036, 1), (0.0056, 0.078, 1), (0.0092, 0.092, 1), (0.0058, 0.106, 1), (0.0085, 0.124, 1)), start=(-0.75, 0.65 / GROWN), end=(0.7, 0.7))
    bowl = curve(pts((0.0085, 0.124, 1), (0.030, 0.1345, 1), (0.055, 0.157, 1)), start=(0.7, 0.7), end=(0.62, 0.785))
    wall = curve(pts((0.055, 0.157, 1), (0.0725, 0.195, 2), (0.0745, 0.230, 1), (0.0675, 0.288, 1), (0.0665, 0.2900, 1), (0.0655, 0.288, 1)), start=(0.62, 0.785))
    inner = curve(pts((0.0655, 0.288, 1), (0.0718, 0.230, 2), (0.0695, 0.195, 1), (0.0525, 0.160, 1)), end=(-0.64, -0.77))
    pit = curve(pts((0.0525, 0.160, 1), (0.030, 0.1395, 1), (0, 0.1325, 1)), start=(-0.64, -0.77), end=(-1, 0))
    scale = 2.3 / GROWN
    strip(m, wall, n, CUP_AT, 0.025, 0.025, 0.94, scale)
    strip(m, inner, n, CUP_AT, 0.025, 0.375, 0.94, scale)
    disc(m, bowl, n, CUP_AT, (0.18, 0.84), 1.9 / GROWN)
    disc(m, pit, n, CUP_AT, (0.47, 0.84), 1.9 / GROWN)
    disc(m, foot, n, CUP_AT, (0.745, 0.815), 1.9 / GROWN)
    strip(m, stem, n, CUP_AT, 0.875, 0.70, 0.09, scale)
    disc(m, under, n, CUP_AT, (0.612, 0.943), 0.65 / GROWN)
    return m


def make_table_top():
    m, n, y = Mesh(), 48, TABLE_Y
    t, r = 0.036, TABLE_R
    face = curve([(r - 0.020, y, 1), (r * 0.70, y, 1), (r * 0.36, y, 1), (0, y, 1)])
    rim = curve([(r - 0.030, y - t, 1), (r - 0.001, y - t + 0.012, 1), (r - 0.004, y - 0.007, 1), (r - 0.020, y, 1)], start=(1, 0.1), end=(-1, 0))
    under = curve([(0, y - t, 1), (r - 0.030, y - t, 1)])
    scale = 0.72 / (2 * (r - 0.020))
    v = {"face": (0.395, 0.395, 0.36)}
    disc(m, face, n, (0, 0), (0.395, 0.395), scale)
    v["rim"] = []
    quarter = 2 * math.pi * r / 4 * scale
    for k in range(4):                                          # the rim in four pieces below the face
        turn = (-math.pi + k * math.pi / 2, -math.pi / 2 + k * math.pi / 2)
        v["rim"].append(strip(m, rim, n // 4, (0, 0), 0.035, 0.785 + k * 0.0525, quarter, scale, turn))
    disc(m, under, n, (0, 0), (0.87, 0.13), 0.17)
    return m, v


def paint_table_top(v):
    """Veneer: a sunburst of sixteen wedges, inlaid rings, a star in the middle."""
    pic = Picture(640)
    size = pic.size
    dark = pic.ramp((0.150, 0.062, 0.026), (0.250, 0.112, 0.050), 10)
    light = pic.ramp((0.230, 0.105, 0.046), (0.345, 0.170, 0.080), 10)
    pale = pic.ramp((0.46, 0.31, 0.16), (0.58, 0.41, 0.23), 6)
    line = pic.ramp((0.05, 0.022, 0.012), (0.07, 0.03, 0.016), 2)
    cu, cv, cr = v["face"]
    wedges = 16
    for j in range(size):
        row = pic.rows[j]
        for i in range(size):
            x, y = ((i + 0.5) / size - cu) / cr, ((j + 0.5) / size - cv) / cr          # 1 = edge of the flat face
            r = math.hypot(x, y)
            if r > 1.06:                                                               # the rim and the underside: plain
                row[i] = dark(grain(j / 5.0, i / 90.0, 31))
                continue
            a = math.atan2(x, y)
            if r > 0.865:                                                              # outer ring, grain runs around
                row[i] = pale(grain(r * 40, a * 2, 21)) if 0.865 < r < 0.885 else dark(grain(r * 60, a * 4, 22))
                continue
            k = math.floor(a / (2 * math.pi / wedges))
            mid = (k + 0.5) * 2 * math.pi / wedges
            along, across = x * math.sin(mid) + y * math.cos(mid), x * math.cos(mid) - y * math.sin(mid)
            # A star of eight points in the middle: its edge in the direction a.
            b = abs((a / (2 * math.pi / 8)) % 1.0 - 0.5) * 2                            # 1 on a point's axis, 0 between
            edge = 0.13 / (0.38 + 0.62 * (1 - b) ** 0.9) if b < 1 else 0.34
            edge = min(edge, 0.34)
            if r < edge:
                s = math.floor(a / (2 * math.pi / 16)) % 2
                row[i] = pale(grain(across * 30, along * 4, 40 + s)) if s else light(grain(across * 30, along * 4, 42))
            elif r < edge + 0.010:
                row[i] = line(0)
            else:
                f = light if k % 2 else dark
                row[i] = f(grain(across * 34, along * 2.5, 50 + k % wedges))
    return pic


def make_table_stand():
    """A turned column on a round, flared base; a plate carries the top."""
    m, n, y1 = Mesh(), 24, TABLE_Y - 0.036 - 0.001
    under = curve([(0, 0.001, 1), (0.262, 0.001, 1)])
    base = curve([(0.262, 0.001, 1), (0.272, 0.012, 1), (0.262, 0.026, 1), (0.240, 0.032, 1), (0.130, 0.052, 2), (0.070, 0.094, 1)], start=(0.8, 0.6), end=(-0.45, 0.9))
    column = curve([(0.070, 0.094, 1), (0.072, 0.118, 1), (0.046, 0.140, 1), (0.050, 0.190, 1), (0.068, 0.270, 1), (0.060, 0.360, 1), (0.039, 0.475, 1),
                    (0.056, 0.512, 1), (0.040, 0.538, 1), (0.044, 0.600, 1), (0.075, y1 - 0.030, 1)], start=(-0.1, 1.0), end=(0.75, 0.66))
    plate = curve([(0.075, y1 - 0.030, 1), (0.160, y1 - 0.012, 1), (0.160, y1, 1)], start=(0.9, 0.3), end=(0, 1))
    top = curve([(0.160, y1, 1), (0, y1, 1)])
    scale = 0.90
    v = {"column": strip(m, column, n, (0, 0), 0.635, 0.03, 0.335, scale)}
    v["base"] = (0.31, 0.315, disc(m, base, n, (0, 0), (0.31, 0.315), scale))
    disc(m, plate, n, (0, 0), (0.19, 0.81), scale)
    disc(m, under, n, (0, 0), (0.47, 0.78), 0.35)
    disc(m, top, n, (0, 0), (0.80, 0.86), 0.6)
    return m, v


def paint_table_stand(v):
    pic = Picture(256)
    size = pic.size
    wood = pic.ramp((0.150, 0.062, 0.026), (0.285, 0.135, 0.062), 14)
    left, top, right, bottom = v["column"]
    bu, bv, _ = v["base"]
    for j in range(size):
        for i in range(size):
            u, w = (i + 0.5) / size, (j + 0.5) / size
            if u > 0.62:
                t = grain((u - left) / (right - left) * 16, w * 8, 60, 16)
            elif w < 0.63:
                a = math.atan2(u - bu, w - bv) / (2 * math.pi) + 0.5
                t = grain(a * 40, math.hypot(u - bu, w - bv) * 12, 61, 40)
            else:
                t = grain(u * 40, w * 8, 62)
            pic.rows[j][i] = wood(t)
    return pic


WALL_PX = 520 / ROOM          # the wallpaper's pixels per metre: eight tiles of 65 pixels fill a wall
WALL_LEFT, WALL_TOP, WALL_PITCH, WALL_IMAGE = 20, 20, 250, 1024


def make_walls():
    """Left, back, right and front wall, from above to below in the atlas; they face into the room."""
    m, h = Mesh(), ROOM / 2
    # start at the floor (left end as seen from inside), direction to the right, normal
    walls = [((-h, h), (0, -1), (1, 0)), ((-h, -h), (1, 0), (0, 1)), ((h, -h), (0, 1), (-1, 0)), ((h, h), (-1, 0), (0, -1))]
    nx, ny = 6, 3
    for k, (start, right, normal) in enumerate(walls):
        rows = []
        for j in range(ny + 1):
            row = []
            for i in range(nx + 1):
                a, b = ROOM * i / nx, WALL * j / ny
                u = (WALL_LEFT + a * WALL_PX) / WALL_IMAGE
                v = (WALL_TOP + k * WALL_PITCH + (WALL - b) * WALL_PX) / WALL_IMAGE
                row.append(m.vertex((start[0] + right[0] * a, b, start[1] + right[1] * a), (normal[0], 0.0, normal[1]), (u, v)))
            rows.append(row)
        for a, b in zip(rows, rows[1:]):
            for i in range(nx):
                m.quad(a[i], a[i + 1], b[i + 1], b[i])
    return m


def damask(width, height):
    """One tile of wallpaper: ogee lattice, a palmette in every cell, the next column half a tile lower."""
    b = Brush(width, height, True)
    for ox, oy in ((0.5, 0.5), (0.0, 0.0)):
        for side in (1, -1):
            def at(x, y):
                return ((ox + side * x) * width, (oy - y) * height)
            # lattice: from the cell's bottom to its side, and a leaf where the ribbons meet
            b.stroke([at(0, -0.5), at(0.02, -0.30), at(0.46, -0.24), at(0.5, 0)], lambda t: 1.15 + 0.9 * math.sin(math.pi * t) ** 2)
            b.stroke([at(0.5, 0), at(0.46, 0.24), at(0.02, 0.30), at(0, 0.5)], lambda t: 1.15 + 0.9 * math.sin(math.pi * t) ** 2)
            # leaves that bend outwards, scrolls below them, the crown's outer leaves
            b.stroke([at(0.0, -0.22), at(0.30, -0.25), at(0.17, 0.10), at(0.33, 0.15)], leaf(4.0))
            b.stroke([at(0.0, -0.22), at(0.22, -0.20), at(0.42, -0.13), at(0.31, -0.02)], leaf(2.9))
            b.stroke([at(0.0, -0.27), at(0.12, -0.36), at(0.24, -0.30), at(0.19, -0.235)], leaf(2.3))
            b.disc(*at(0.185, 0.175), 1.7)
            b.stroke([at(0.0, 0.20), at(0.03, 0.26), at(0.09, 0.27), at(0.115, 0.34)], leaf(2.2))

        def at(x, y):
            return ((ox + x) * width, (oy - y) * height)
        # pomegranate: a bud, wiped out inside, with a kernel
        b.stroke([at(0.0, -0.19), at(0.0, 0.235)], lambda t: 17.0 * (t + 0.03) ** 0.6 * (1 - t) ** 0.75)
        b.stroke([at(0.0, -0.14), at(0.0, 0.17)], lambda t: 11.5 * (t + 0.03) ** 0.6 * (1 - t) ** 0.75, 0)
        b.stroke([at(0.0, -0.11), at(0.0, 0.12)], leaf(3.4))
        b.stroke([at(0.0, 0.20), at(0.0, 0.40)], leaf(2.6))
        b.stroke([at(0.0, -0.18), at(0.0, -0.40)], leaf(2.4))
        b.disc(*at(0.0, 0.5), 3.0)
    return b


def paint_walls():
    pic = Picture(WALL_IMAGE)
    tile_w, tile_h = 65, 88
    paper = pic.ramp((0.400, 0.490, 0.330), (0.640, 0.665, 0.520), 14)
    board = pic.ramp((0.22, 0.21, 0.18), (0.68, 0.65, 0.58), 16)
    b = damask(tile_w, tile_h)
    tile = [[paper(b.cover(i, j)) for i in range(tile_w)] for j in range(tile_h)]
    for y in range(WALL_IMAGE):
        k = min(3, max(0, (y - WALL_TOP + 12) // WALL_PITCH))
        py = y - WALL_TOP - k * WALL_PITCH                    # pixels below the wall's upper edge
        up = WALL - (py + 0.5) / WALL_PX                      # metres above the floor
        if up < 0.175:                                        # skirting board, with a moulding
            line = board(0.05 if up > 0.160 else 0.86 if up > 0.135 else 0.55 if up > 0.12 else 1.0 if up > 0.02 else 0.55)
            row = bytearray([line]) * WALL_IMAGE
        else:
            row = bytearray(tile[(py + 30) % tile_h][(x - WALL_LEFT) % tile_w] for x in range(WALL_IMAGE))
        used = WALL_LEFT + 520 + 12
        row[used:] = bytearray([row[used - 1]]) * (WALL_IMAGE - used)
        pic.rows[y] = row
    return pic


def make_floor():
    m, h, n = Mesh(), ROOM / 2, 6
    rows = []
    for j in range(n + 1):
        rows.append([m.vertex((-h + ROOM * i / n, 0.0, h - ROOM * j / n), (0.0, 1.0, 0.0), (0.02 + 0.96 * i / n, 0.98 - 0.96 * j / n)) for i in range(n + 1)])
    for a, b in zip(rows, rows[1:]):
        for i in range(n):
            m.quad(a[i], a[i + 1], b[i + 1], b[i])
    return m


def paint_floor():
    """Oak in herringbone: blocks of one to four, each its own tone and streaks, dark joints."""
    pic = Picture(1024)
    size = pic.size
    tones = [pic.ramp(mix((0.315, 0.205, 0.115), (0.450, 0.315, 0.190), k / 7), mix((0.365, 0.243, 0.140), (0.510, 0.365, 0.225), k / 7), 5) for k in range(8)]
    joint = pic.ramp((0.13, 0.08, 0.045), (0.25, 0.165, 0.095), 3)
    w, ratio = 0.155, 4                                       # a block's width in metres; its length is ratio widths
    c = math.sqrt(0.5)
    for j in range(size):
        row = pic.rows[j]
        for i in range(size):
            x, z = ((i + 0.5) / size - 0.5) * ROOM / 0.96, ((j + 0.5) / size - 0.5) * ROOM / 0.96
            p, q = (x + z) * c / w + 64, (z - x) * c / w + 64
            ip, iq = math.floor(p), math.floor(q)
            d = (ip - iq) % (2 * ratio)                       # which block of the zigzag this unit square belongs to
            if d < ratio:                                     # lies along p
                bp, bq, lying = ip - d, iq, True
                along, across, end = p - bp, q - iq, ratio
            else:                                             # stands along q
                e = 2 * ratio - 1 - d
                bp, bq, lying = ip, iq - e, False
                along, across, end = q - bq, p - ip, ratio
            near = min(across, 1 - across, along, end - along) * w
            if near < 0.0032:
                row[i] = joint(near / 0.0032)
                continue
            seed = int(hash01(bp, bq, lying) * 1e6)
            row[i] = tones[int(hash01(bp, bq, 7 + lying) * 8)](grain(across * 5, along * 0.6, seed))
    return pic


def make_lamp():
    m, r = Mesh(), LAMP_R
    points = [(r * math.sin(a), -r * math.cos(a), math.sin(a), -math.cos(a)) for a in (math.pi * k / 7 for k in range(8))]
    points[0], points[-1] = (0.0, -r, 0.0, -1.0), (0.0, r, 0.0, 1.0)
    scale = 0.94 / (2 * math.pi * r)
    strip(m, points[2:6], 12, (0, 0), 0.03, 0.03, 0.94, scale)
    disc(m, points[5:], 12, (0, 0), (0.28, 0.72), scale * 0.9)
    disc(m, points[:3], 12, (0, 0), (0.74, 0.72), scale * 0.9)
    return m


# ------------------------------------------------------------------------------------------------------- writing glTF


class Glb:
    def __init__(self):
        self.data = bytearray()
        self.doc = {"asset": {"version": "2.0", "generator": "make_table.py"}, "scene": 0, "scenes": [{"name": "table", "nodes": []}], "nodes": [], "meshes": [], "materials": [],
                    "accessors": [], "bufferViews": [], "cameras": [], "animations": []}

    def view(self, data, target=None):
        self.data += bytes(-len(self.data) % 4)
        v = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        if target:
            v["target"] = target
        self.data += data
        self.doc["bufferViews"].append(v)
        return len(self.doc["bufferViews"]) - 1

    def accessor(self, values, kind, target=None, indices=False):
        n = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[kind]
        flat = list(values) if n == 1 else [c for v in values for c in v]
        fmt, code = ("H", 5123) if indices else ("f", 5126)
        data = struct.pack("<%d%s" % (len(flat), fmt), *flat)
        flat = struct.unpack("<%d%s" % (len(flat), fmt), data)                  # limits as stored
        a = {"bufferView": self.view(data, target), "componentType": code, "count": len(flat) // n, "type": kind,
             "min": [min(flat[k::n]) for k in range(n)], "max": [max(flat[k::n]) for k in range(n)]}
        self.doc["accessors"].append(a)
        return len(self.doc["accessors"]) - 1

    def material(self, name, picture=None, colour=None, roughness=1.0, extensions=None):
        pbr = {"metallicFactor": 0.0, "roughnessFactor": roughness}
        if colour:
            pbr["baseColorFactor"] = list(colour) + [1.0]
        if picture:
            d = self.doc
            d.setdefault("images", []).append({"name": name, "mimeType": "image/png", "bufferView": self.view(picture.png())})
            d.setdefault("samplers", [{"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}])
            d.setdefault("textures", []).append({"sampler": 0, "source": len(d["images"]) - 1})
            pbr["baseColorTexture"] = {"index": len(d["textures"]) - 1}
        m = {"name": name, "pbrMetallicRoughness": pbr}
        if extensions:
            m["extensions"] = extensions
            self.doc["extensionsUsed"] = sorted(set(self.doc.get("extensionsUsed", [])) | set(extensions))
        self.doc["materials"].append(m)
        return len(self.doc["materials"]) - 1

    def mesh(self, name, mesh, material):
        prim = {"attributes": {"POSITION": self.accessor(mesh.pos, "VEC3", 34962), "NORMAL": self.accessor(mesh.nrm, "VEC3", 34962), "TEXCOORD_0": self.accessor(mesh.uv, "VEC2", 34962)},
                "indices": self.accessor([i for t in mesh.tri for i in t], "SCALAR", 34963, True), "material": material, "mode": 4}
        self.doc["meshes"].append({"name": name, "primitives": [prim]})
        return len(self.doc["meshes"]) - 1

    def node(self, root=True, **fields):
        self.doc["nodes"].append(fields)
        if root:
            self.doc["scenes"][0]["nodes"].append(len(self.doc["nodes"]) - 1)
        return len(self.doc["nodes"]) - 1

    def swing(self, name, node, axis, degrees, keys, seconds):
        """An animation that turns a node evenly from -degrees/2 to +degrees/2 (slerp between keys is exact)."""
        times = [seconds * k / (keys - 1) for k in range(keys)]
        turns = []
        for k in range(keys):
            a = math.radians(degrees * (k / (keys - 1) - 0.5)) / 2
            turns.append(tuple(c * math.sin(a) for c in axis) + (math.cos(a),))
        sampler = {"input": self.accessor(times, "SCALAR"), "output": self.accessor(turns, "VEC4"), "interpolation": "LINEAR"}
        self.doc["animations"].append({"name": name, "channels": [{"sampler": 0, "target": {"node": node, "path": "rotation"}}], "samplers": [sampler]})

    def write(self, path):
        data = bytes(self.data) + bytes(-len(self.data) % 4)
        self.doc["buffers"] = [{"byteLength": len(data)}]
        text = json.dumps(self.doc, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(data)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


def furnish(g):
    """Everything but the animations; returns the nodes about which camera and lamp turn."""
    matte = {"KHR_materials_specular": {"specularFactor": 0.0}}            # purely diffuse

    vase, v, body = make_vase()
    top, t = make_table_top()
    stand, s = make_table_stand()
    parts = [
        ("vase", vase, g.material("glaze", paint_vase(v, body), None, 0.08, {"KHR_materials_ior": {"ior": 1.9}})),
        ("cup", make_cup(), g.material("glass", None, (1.0, 1.0, 1.0), 0.0, {
            "KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": 1.5},
            "KHR_materials_volume": {"thicknessFactor": 0.003, "attenuationColor": [0.78, 0.93, 0.88], "attenuationDistance": 0.08}})),
        ("table_top", top, g.material("lacquer", paint_table_top(t), None, 0.12, {"KHR_materials_ior": {"ior": 1.5}})),
        ("table_stand", stand, g.material("turned wood", paint_table_stand(s), None, 1.0, matte)),
        ("walls", make_walls(), g.material("wallpaper", paint_walls(), None, 1.0, matte)),
        ("floor", make_floor(), g.material("parquet", paint_floor(), None, 1.0, matte)),
    ]
    for name, mesh, material in parts:
        g.node(name=name, mesh=g.mesh(name, mesh, material))

    glow = g.material("lamp", None, (0.0, 0.0, 0.0), 1.0, {"KHR_materials_emissive_strength": {"emissiveStrength": LAMP_STRENGTH}, **matte})
    g.doc["materials"][glow]["emissiveFactor"] = list(LAMP_COLOUR)
    lamp = g.node(False, name="lamp", mesh=g.mesh("lamp", make_lamp(), glow), translation=[0.0, -LAMP_LENGTH, 0.0])
    lamp_pivot = g.node(name="lamp_pivot", translation=list(LAMP_PIVOT), children=[lamp])

    g.doc["cameras"].append({"name": "camera", "type": "perspective", "perspective": {"yfov": math.radians(VIEW_YFOV), "aspectRatio": VIEW_ASPECT, "znear": 0.1, "zfar": 20.0}})
    tilt = -math.atan2(VIEW_HEIGHT - VIEW_LOOK_AT, VIEW_DISTANCE) / 2
    camera = g.node(False, name="camera", camera=0, translation=[0.0, VIEW_HEIGHT, VIEW_DISTANCE], rotation=[math.sin(tilt), 0.0, 0.0, math.cos(tilt)])
    view_pivot = g.node(name="view_pivot", children=[camera])
    return view_pivot, lamp_pivot


def build(path):
    g = Glb()
    view_pivot, lamp_pivot = furnish(g)
    g.swing("view", view_pivot, (0, 1, 0), VIEW_STEP * (VIEW_SAMPLES - 1), 5, 0.1 * (VIEW_SAMPLES - 1))
    g.swing("lamp", lamp_pivot, (0, 0, 1), LAMP_STEP * (LAMP_SAMPLES - 1), 3, 0.1 * (LAMP_SAMPLES - 1))
    g.write(path)


# ----------------------------------------------------------------------------------------------------------- the check


class Bad(Exception):
    pass


def need(condition, what):
    if not condition:
        raise Bad(what)


def read_glb(path):
    raw = path.read_bytes()
    magic, version, size = struct.unpack_from("<4sII", raw)
    need((magic, version, size) == (b"glTF", 2, len(raw)), "the container's header is wrong")
    n, kind = struct.unpack_from("<I4s", raw, 12)
    need(kind == b"JSON", "the first chunk is not JSON")
    doc = json.loads(raw[20:20 + n])
    m, kind = struct.unpack_from("<I4s", raw, 20 + n)
    need(kind == b"BIN\0" and 28 + n + m == len(raw), "the second chunk is not the binary one")
    return doc, raw[28 + n:]


def read_accessor(doc, data, index):
    a = doc["accessors"][index]
    v = doc["bufferViews"][a["bufferView"]]
    n = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
    fmt = {5123: "H", 5126: "f"}[a["componentType"]]
    size = struct.calcsize(fmt) * n * a["count"]
    need(a.get("byteOffset", 0) + size <= v["byteLength"] and v["byteOffset"] + v["byteLength"] <= doc["buffers"][0]["byteLength"] <= len(data), "accessor %d leaves its buffer" % index)
    flat = struct.unpack_from("<%d%s" % (n * a["count"], fmt), data, v["byteOffset"] + a.get("byteOffset", 0))
    need("min" in a and "max" in a, "accessor %d has no min and max" % index)
    need(list(a["min"]) == [min(flat[k::n]) for k in range(n)] and list(a["max"]) == [max(flat[k::n]) for k in range(n)], "accessor %d: min and max are wrong" % index)
    return [flat[k:k + n] for k in range(0, len(flat), n)] if n > 1 else list(flat)


def charts_of(count, tris):
    """A number for each triangle: triangles that share a vertex are of one chart."""
    up = list(range(count))

    def find(i):
        while up[i] != i:
            up[i] = up[up[i]]
            i = up[i]
        return i
    for a, b, c in tris:
        up[find(a)] = up[find(b)] = find(c)
    names = {}
    return [names.setdefault(find(t[0]), len(names)) for t in tris]


def raster(uv, tris, chart, size):
    """Which chart covers each cell's centre, and how many centres lie strictly inside two triangles."""
    grid = [[-1] * size for _ in range(size)]
    double = 0
    for t, label in zip(tris, chart):
        (ax, ay), (bx, by), (cx, cy) = ((uv[i][0] * size - 0.5, uv[i][1] * size - 0.5) for i in t)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area > 0:
            bx, by, cx, cy = cx, cy, bx, by
            area = -area
        for y in range(math.ceil(min(ay, by, cy)), math.floor(max(ay, by, cy)) + 1):
            lo, hi = -1e30, 1e30
            for px, py, qx, qy in ((ax, ay, bx, by), (bx, by, cx, cy), (cx, cy, ax, ay)):
                # inside: (qx-px)(y-py) - (qy-py)(x-px) < 0
                k, c = qy - py, (qx - px) * (y - py) + (qy - py) * px
                if abs(k) < 1e-12:
                    if c - k * px >= 0:
                        lo = 1e30
                elif k > 0:
                    lo = max(lo, c / k)
                else:
                    hi = min(hi, c / k)
            if lo < hi:
                row = grid[y]
                for x in range(math.floor(lo + 1e-7) + 1, math.ceil(hi - 1e-7)):
                    if row[x] >= 0:
                        double += 1
                    row[x] = label
    return grid, double


def closest_charts(grid):
    """The smallest distance between cells of different charts, in cells (8-neighbour steps)."""
    size = len(grid)
    label = [row[:] for row in grid]
    front = [(x, y) for y in range(size) for x in range(size) if grid[y][x] >= 0]
    step = {0: front}
    dist = [[0 if c >= 0 else -1 for c in row] for row in grid]
    best, d = size, 0
    while front and 2 * d < best:
        d += 1
        out = []
        for x, y in front:
            for yy in range(max(0, y - 1), min(size, y + 2)):
                for xx in range(max(0, x - 1), min(size, x + 2)):
                    if dist[yy][xx] < 0:
                        dist[yy][xx], label[yy][xx] = d, label[y][x]
                        out.append((xx, yy))
                    elif label[yy][xx] != label[y][x]:
                        best = min(best, dist[yy][xx] + dist[y][x] + 1)
        front = out
    return best


def turned(q, p):
    x, y, z, w = q
    tx, ty, tz = 2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])
    return (p[0] + w * tx + y * tz - z * ty, p[1] + w * ty + z * tx - x * tz, p[2] + w * tz + x * ty - y * tx)


def turn_at(doc, data, name, position):
    """The rotation that an animation gives its node at a position in [0,1]."""
    anim = next(a for a in doc["animations"] if a["name"] == name)
    s = anim["samplers"][0]
    times, turns = read_accessor(doc, data, s["input"]), read_accessor(doc, data, s["output"])
    t = position * times[-1]
    k = max(i for i in range(len(times) - 1) if times[i] <= t + 1e-9)
    f = (t - times[k]) / (times[k + 1] - times[k])
    a, b = turns[k], turns[k + 1]
    angle = math.acos(clamp(sum(p * q for p, q in zip(a, b)), -1.0, 1.0))
    q = [(math.sin((1 - f) * angle) * p + math.sin(f * angle) * r) / math.sin(angle) for p, r in zip(a, b)]
    return q, doc["nodes"][anim["channels"][0]["target"]["node"]]


def check(path):
    doc, data = read_glb(path)
    for i in range(len(doc["accessors"])):
        read_accessor(doc, data, i)
    total = 0
    print("%-12s %9s %8s %7s %8s %7s %9s" % ("object", "triangles", "vertices", "charts", "gutter", "filled", "stretch"))
    for node in doc["nodes"]:
        if "mesh" not in node:
            continue
        name = node["name"]
        prim = doc["meshes"][node["mesh"]]["primitives"][0]
        pos, nrm, uv = (read_accessor(doc, data, prim["attributes"][k]) for k in ("POSITION", "NORMAL", "TEXCOORD_0"))
        index = read_accessor(doc, data, prim["indices"])
        need(len(pos) == len(nrm) == len(uv) and max(index) < len(pos) and len(index) % 3 == 0, name + ": counts do not fit")
        tris = [tuple(index[k:k + 3]) for k in range(0, len(index), 3)]
        need(all(0.0 <= c <= 1.0 for p in uv for c in p), name + ": a texture coordinate lies outside [0,1]")
        need(all(abs(sum(c * c for c in n) - 1) < 1e-4 for n in nrm), name + ": a normal is not of length 1")
        worst = []
        edges = {}
        for t in tris:
            p, q, r = (pos[i] for i in t)
            e, f = [b - a for a, b in zip(p, q)], [b - a for a, b in zip(p, r)]
            n = (e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0])
            area = math.sqrt(sum(c * c for c in n))
            need(area > 1e-9, name + ": a triangle has no area")
            need(all(sum(a * b for a, b in zip(n, nrm[i])) > 0 for i in t), name + ": a normal points against its triangle")
            (a, b), (c, d) = [uv[t[1]][k] - uv[t[0]][k] for k in (0, 1)], [uv[t[2]][k] - uv[t[0]][k] for k in (0, 1)]
            need(a * d - b * c < 0, name + ": a triangle is mirrored or empty in the atlas")
            # singular values of the map from the surface (metres) to the atlas
            le = math.sqrt(sum(x * x for x in e))
            fx, fy = sum(x * y for x, y in zip(e, f)) / le, area / le
            m00, m10 = a / le, b / le
            m01, m11 = (c - m00 * fx) / fy, (d - m10 * fx) / fy
            k1, k2 = m00**2 + m01**2 + m10**2 + m11**2, abs(m00 * m11 - m01 * m10)
            big = (math.sqrt(k1 + 2 * k2) + math.sqrt(max(0.0, k1 - 2 * k2))) / 2
            worst.append(big * big / k2)
            for i, j in ((0, 1), (1, 2), (2, 0)):
                key = tuple(tuple(round(x, 5) + 0.0 for x in pos[t[k]]) for k in (i, j))
                edges[key] = edges.get(key, 0) + 1
        if name not in ("walls", "floor"):
            need(all(n == 1 and edges.get((b, a)) == 1 for (a, b), n in edges.items()), name + ": the surface is not closed")
        chart = charts_of(len(pos), tris)
        grid, double = raster(uv, tris, chart, 1024)
        need(double == 0, "%s: %d cells of 1024 x 1024 are covered twice" % (name, double))
        gap = closest_charts(raster(uv, tris, chart, 512)[0]) / 512 if max(chart) else 1.0
        need(gap >= 0.015, "%s: charts come as near as %.1f %%" % (name, 100 * gap))
        low, high = min(min(p) for p in uv), max(max(p) for p in uv)
        need(low >= 0.015 and high <= 0.985, "%s: a chart comes too near to the atlas' edge" % name)
        filled = sum(c >= 0 for row in grid for c in row) / 1024**2
        worst.sort()
        print("%-12s %9d %8d %7d %7.1f%% %6.0f%% %9.2f" % (name, len(tris), len(pos), max(chart) + 1, 100 * gap if max(chart) else 0, 100 * filled, worst[len(worst) // 2]))
        total += len(tris) if name != "lamp" else 0
    names = [n["name"] for n in doc["nodes"] if "mesh" in n]
    need(sorted(names) == sorted(["vase", "cup", "table_top", "table_stand", "walls", "floor", "lamp"]), "mesh nodes are " + ", ".join(names))
    need(4200 <= total <= 4600, "%d triangles without the lamp" % total)

    # The lamp is never in the picture: its sphere against the frustum, at every sample.
    cam = next(n for n in doc["nodes"] if "camera" in n)
    lens = doc["cameras"][cam["camera"]]["perspective"]
    bulb = next(n for n in doc["nodes"] if n["name"] == "lamp")
    ty = math.tan(lens["yfov"] / 2)
    tx = ty * lens["aspectRatio"]
    closest, highest = 1e9, 0.0
    for i in range(VIEW_SAMPLES):
        q, pivot = turn_at(doc, data, "view", i / (VIEW_SAMPLES - 1))
        eye = turned(q, cam["translation"])
        angle = math.degrees(2 * math.atan2(q[1], q[3]))
        need(abs(angle - VIEW_STEP * (i - (VIEW_SAMPLES - 1) / 2)) < 1e-4, "view sample %d stands at %.6f degrees" % (i, angle))
        need(max(abs(eye[0]), abs(eye[2])) < ROOM / 2 - 0.2, "the camera leaves the room")
        for u in (-tx, 0, tx):                                  # no sky above the walls: the frame's upper edge
            d = turned(q, turned(cam["rotation"], (u, ty, -1.0)))
            k = min((math.copysign(ROOM / 2, d[c]) - eye[c]) / d[c] for c in (0, 2) if abs(d[c]) > 1e-9)
            highest = max(highest, eye[1] + k * d[1])
        for j in range(LAMP_SAMPLES):
            r, hook = turn_at(doc, data, "lamp", j / (LAMP_SAMPLES - 1))
            p = [a + b for a, b in zip(hook["translation"], turned(r, bulb["translation"]))]
            p = [a - b for a, b in zip(p, eye)]
            back = [-cam["rotation"][0], -cam["rotation"][1], -cam["rotation"][2], cam["rotation"][3]]
            p = turned(back, turned([-q[0], -q[1], -q[2], q[3]], p))
            inside = max((-ty * -p[2] + p[1]) / math.hypot(1, ty), (-ty * -p[2] - p[1]) / math.hypot(1, ty),
                         (-tx * -p[2] + p[0]) / math.hypot(1, tx), (-tx * -p[2] - p[0]) / math.hypot(1, tx))
            closest = min(closest, inside - LAMP_R)
    need(closest > 0, "the lamp is visible")
    need(highest < WALL, "the camera looks over the walls")
    images = sum(doc["bufferViews"][i["bufferView"]]["byteLength"] for i in doc["images"])
    print("%d triangles and the lamp; lamp outside the frame by %.2f m at least; picture reaches %.2f m up the walls" % (total, closest, highest))
    print("%s: %d bytes, images %d (%s)" % (path.name, path.stat().st_size, images, ", ".join("%s %d" % (i["name"], doc["bufferViews"][i["bufferView"]]["byteLength"]) for i in doc["images"])))


def main():
    p = argparse.ArgumentParser(description="Makes table.glb and checks it.")
    p.add_argument("-o", "--output", type=Path, default=Path(__file__).with_name("table.glb"), help="the file to write (or to check)")
    p.add_argument("--check", action="store_true", help="only check the file that is there")
    a = p.parse_args()
    if not a.check:
        build(a.output)
    try:
        check(a.output)
    except Bad as e:
        print("make_table.py: %s: %s" % (a.output, e), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
