#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""A model whose animation drives a skin and morph weights: a scene folder is made from it, stills show the position asked for,
and compiling it is refused in one line before anything is traced.

usage: deformation.py BIN_DIR"""
import json, os, struct, subprocess, sys, tempfile

vitrine = os.path.join(sys.argv[1], "vitrine")
failures, ran = [], 0


def check(what, holds, detail=""):
    global ran
    ran += 1
    if not holds:
        failures.append(f"{what}: {detail}")


def run(*arguments):
    return subprocess.run([vitrine, *arguments], capture_output=True, text=True, timeout=120)


def waving_model():
    """A square of unit size on one joint that the animation "wave" lifts; its morph target, driven by "grow", doubles it."""
    binary, views, accessors = b"", [], []

    def add(values, components, kind, pack="f"):
        nonlocal binary
        data = struct.pack(f"<{len(values)}{pack}", *values)
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        binary += data + b"\0" * (-len(data) % 4)
        accessors.append({"bufferView": len(views) - 1, "componentType": {"f": 5126, "H": 5123, "B": 5121}[pack],
                          "count": len(values) // components, "type": kind})
        return len(accessors) - 1

    corners = [-0.5, 0, 0, 0.5, 0, 0, -0.5, 1, 0, 0.5, 1, 0]
    attributes = {"POSITION": add(corners, 3, "VEC3"), "JOINTS_0": add([0] * 16, 4, "VEC4", "B"),
                  "WEIGHTS_0": add([1, 0, 0, 0] * 4, 4, "VEC4")}
    primitive = {"attributes": attributes, "indices": add([0, 1, 2, 1, 3, 2], 1, "SCALAR", "H"),
                 "targets": [{"POSITION": add(corners, 3, "VEC3")}]}
    times = add([0, 1], 1, "SCALAR")

    def animation(name, node, path, output):
        return {"name": name, "samplers": [{"input": times, "output": output}],
                "channels": [{"sampler": 0, "target": {"node": node, "path": path}}]}

    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": "flag", "mesh": 0, "skin": 0}, {"name": "mast"}], "skins": [{"joints": [1]}],
        "meshes": [{"primitives": [primitive]}], "accessors": accessors, "bufferViews": views,
        "animations": [animation("wave", 1, "translation", add([0, 0, 0, 0, 1, 0], 3, "VEC3")),
                       animation("grow", 0, "weights", add([0, 1], 1, "SCALAR"))],
        "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


AXES = "".join(f'[[axis]]\nname = "{name}"\nanimation = "{name}"\nsamples = 3\n' for name in ("wave", "grow"))
VIEW = '[[axis]]\nname = "view"\norbit = { target = [0, 1, 0], radius = 6 }\nsamples = 2\n'

with tempfile.TemporaryDirectory() as folder:
    model, scene = os.path.join(folder, "flag.glb"), os.path.join(folder, "scene")
    with open(model, "wb") as file:
        file.write(waving_model())
    made = run("new", scene, "--from", model, "--quiet")
    check("vitrine new --from", made.returncode == 0, made.stderr)
    still = run("render", scene, "--spp", "1", "--size", "16x12", "-o", folder + "/rest.png", "--quiet")
    check("the new scene renders", still.returncode == 0, still.stderr)

    toml = os.path.join(scene, "scene.toml")
    with open(toml, "w") as file:
        file.write('scene = "flag.glb"\nenvironment = [1, 1, 1]\n' + AXES + VIEW)
    pictures = {}
    for position in ("wave=0,grow=0", "wave=0.3,grow=0", "wave=0,grow=0.5", "wave=1,grow=1"):
        picture = os.path.join(folder, "still.png")
        done = run("render", scene, "--at", position, "--spp", "4", "--size", "32x24", "-o", picture, "--quiet")
        check(f"render --at {position}", done.returncode == 0, done.stderr)
        with open(picture, "rb") as file:
            pictures.setdefault(file.read(), []).append(position)
    check("every position has its own picture", len(pictures) == 4, str(list(pictures.values())))

    image = os.path.join(folder, "flag.vit")
    refused = run("compile", scene, "-o", image, "--preset", "tiny", "--work", folder + "/work")
    lines = [line for line in refused.stderr.splitlines() if ": warning: " not in line]
    check("compile is refused with 1", refused.returncode == 1, str(refused.returncode))
    check("compile's error is one line", len(lines) == 1, refused.stderr)
    for part in ("scene.toml", 'axis "wave" deforms object "flag"', "render stills"):
        check(f"compile's error says {part}", part in refused.stderr, refused.stderr)
    check("nothing was traced", not os.path.exists(image) and not any(names for _, _, names in os.walk(folder + "/work")), "")

    with open(toml, "w") as file:
        file.write('scene = "flag.glb"\nenvironment = [1, 1, 1]\nresolution = [32, 24]\nsamples_per_pixel = 1\n' + VIEW + '[target]\nstorage = "1 MB"\n')
    compiled = run("compile", scene, "-o", image, "--preset", "tiny", "--work", folder + "/work", "--quiet")
    check("without those axes it compiles, at rest", compiled.returncode == 0, compiled.stderr)

for failure in failures:
    print("FAILED", failure)
print(f"{ran - len(failures)} passed, {len(failures)} failed")
sys.exit(bool(failures))
