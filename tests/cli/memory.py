#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Renders a scene of a million triangles with 16 textures of 4096 x 4096 and checks the peak of resident memory.

usage: memory.py BIN_DIR"""
import array, json, math, os, struct, subprocess, sys, tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "assets"))
from pictures import png_bytes

SIDE, TEXTURES, MESHES, GRID = 4096, 16, 8, 360  # 8 meshes of 2 * 360 * 360 triangles
LIMIT = 3 << 30
KINDS = ("base", "roughness", "normal")  # what a texture is, in turn


class Model:
    """A .glb in the making, its binary chunk in pieces."""
    def __init__(self):
        self.pieces, self.size = [], 0
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(MESHES))}], "bufferViews": [], "accessors": []}

    def add_view(self, data):
        padding = -len(data) % 4
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self.pieces += [bytes(data), bytes(padding)]
        self.size += len(data) + padding
        return len(self.json["bufferViews"]) - 1

    def add_accessor(self, values, component_type, kind, components):
        self.json["accessors"].append({"bufferView": self.add_view(values.tobytes()), "componentType": component_type,
                                       "count": len(values) // components, "type": kind})
        return len(self.json["accessors"]) - 1

    def write(self, path):
        self.json["buffers"] = [{"byteLength": self.size}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + self.size) + struct.pack("<I", len(text)) + b"JSON" + text +
                       struct.pack("<I", self.size) + b"BIN\0")
            file.writelines(self.pieces)


def texture(number):
    """Stripes that differ in every picture; runs of equal rows keep zlib fast."""
    def row(band):
        def pixel(x):
            if KINDS[number % 3] == "normal":
                return 128 + (x + band) % 64 - 32, 128, 240
            return (16 * number + x * band) & 255, (x + 37 * number) & 255, (255 - 5 * band) & 255
        tile = bytes(channel for x in range(256) for channel in pixel(x))
        return tile * (SIDE // 256)
    bands = [row(band) for band in range(32)]
    return png_bytes(SIDE, SIDE, (bands[y * 32 // SIDE] for y in range(SIDE)), level=1)


def add_hills(model, mesh):
    """A field of hills with normals and texture coordinates."""
    positions, normals, texcoords = array.array("f"), array.array("f"), array.array("f")
    step = 2 * math.pi * (mesh + 1) / GRID
    waves = [(math.sin(i * step), math.cos(i * step)) for i in range(GRID + 1)]
    for z, (sin_z, cos_z) in enumerate(waves):
        for x, (sin_x, cos_x) in enumerate(waves):
            positions.extend((x / GRID, 0.01 * sin_x * sin_z, z / GRID))
            normals.extend((-0.05 * cos_x * sin_z, 1, -0.05 * sin_x * cos_z))
            texcoords.extend((x / GRID, z / GRID))
    corners = array.array("I")
    for z in range(GRID):
        for a in range(z * (GRID + 1), z * (GRID + 1) + GRID):
            corners.extend((a, a + GRID + 1, a + 1, a + 1, a + GRID + 1, a + GRID + 2))
    attributes = {"POSITION": model.add_accessor(positions, 5126, "VEC3", 3), "NORMAL": model.add_accessor(normals, 5126, "VEC3", 3),
                  "TEXCOORD_0": model.add_accessor(texcoords, 5126, "VEC2", 2)}
    return {"primitives": [{"attributes": attributes, "indices": model.add_accessor(corners, 5125, "SCALAR", 1), "material": mesh}]}


def material(number):
    """Every third texture from a first one on, so that together all of them are used."""
    of_kind = [[t for t in range(TEXTURES) if t % 3 == kind] for kind in range(3)]
    base, roughness, normal = ({"index": textures[number % len(textures)]} for textures in of_kind)
    return {"doubleSided": True, "normalTexture": normal, "pbrMetallicRoughness": {"baseColorTexture": base, "metallicRoughnessTexture": roughness}}


def write_model(path):
    model = Model()
    model.json["images"] = [{"bufferView": model.add_view(texture(t)), "mimeType": "image/png"} for t in range(TEXTURES)]
    model.json["textures"] = [{"source": t} for t in range(TEXTURES)]
    model.json["materials"] = [material(m) for m in range(MESHES)]
    model.json["meshes"] = [add_hills(model, m) for m in range(MESHES)]
    model.json["nodes"] = [{"mesh": m, "translation": [1.1 * (m % 4), 0.2 * m, 1.1 * (m // 4)]} for m in range(MESHES)]
    model.write(path)


with tempfile.TemporaryDirectory() as folder:
    write_model(os.path.join(folder, "model.glb"))
    with open(os.path.join(folder, "scene.toml"), "w") as file:
        file.write('scene = "model.glb"\nenvironment = [1, 1, 1]\n')
    render = subprocess.Popen([os.path.join(sys.argv[1], "vitrine"), "render", folder, "--size", "64x48", "--spp", "2", "--quiet",
                               "-o", os.path.join(folder, "out.png")])
    _, status, usage = os.wait4(render.pid, 0)
peak = usage.ru_maxrss << 10  # Linux counts KiB
print(f"{MESHES * 2 * GRID * GRID} triangles, {TEXTURES} textures of {SIDE} x {SIDE}: {peak / (1 << 20):.0f} MiB at the peak, {LIMIT >> 20} MiB allowed")
sys.exit(os.waitstatus_to_exitcode(status) != 0 or peak >= LIMIT)
