#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Feeds broken and hostile files to the programs: each must end with exit code 1, one line on stderr that names the program
and the file, nothing on stdout, no file written, within ten seconds and never by a signal.

usage: hostile_inputs.py BIN_DIR [EXTRA_ASSETS]"""
import glob, json, os, random, struct, subprocess, sys, tempfile

bin_dir = sys.argv[1]
extra = sys.argv[2] if len(sys.argv) > 2 else ""
vitrine, play = os.path.join(bin_dir, "vitrine"), os.path.join(bin_dir, "vitrine-play")
failures, ran = [], 0


def check(name, command, must_fail=True):
    global ran
    ran += 1
    try:
        done = subprocess.run(command, capture_output=True, timeout=30, text=True, errors="replace")
    except subprocess.TimeoutExpired:
        failures.append(f"{name}: hangs")
        return
    lines = [line for line in done.stderr.splitlines() if ": warning: " not in line]
    if done.returncode < 0 or done.returncode > 1:
        failures.append(f"{name}: exit {done.returncode}: {done.stderr[:300]}")
    elif must_fail and done.returncode == 0:
        failures.append(f"{name}: accepted")
    elif done.returncode == 1 and (len(lines) != 1 or not lines[0].startswith("vitrine")):
        failures.append(f"{name}: {len(lines)} lines of error: {done.stderr[:300]}")


def write(folder, name, content):
    path = os.path.join(folder, name)
    with open(path, "wb") as f:
        f.write(content if isinstance(content, bytes) else content.encode())
    return path


def glb(document, binary=b""):
    text = json.dumps(document).encode() if not isinstance(document, bytes) else document
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text
    if binary:
        body += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


POSITIONS = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)


def triangle(**changes):
    """A valid one-triangle document; `changes` replace top-level entries."""
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "t"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36}]}
    document.update(changes)
    return document


def accessor(**changes):
    return triangle(accessors=[dict(triangle()["accessors"][0], **changes)])


MODELS = {
    "empty": b"", "one-byte": b"g", "not-a-model": b"\x89PNG\r\n\x1a\n" + bytes(100), "header-only": b"glTF\2\0\0\0\x0c\0\0\0",
    "wrong-version": b"glTF\x09\0\0\0" + glb(triangle(), POSITIONS)[8:], "length-beyond-file": glb(triangle(), POSITIONS)[:8] + b"\xff\xff\xff\x7f" + glb(triangle(), POSITIONS)[12:],
    "chunk-beyond-file": glb(triangle(), POSITIONS)[:12] + b"\xf0\xff\xff\xff" + glb(triangle(), POSITIONS)[16:], "not-json": glb(b"{{{{"), "json-array": glb(b"[1,2,3]"),
    "json-deep": glb(b"[" * 100000), "no-asset": glb({"nodes": []}), "asset-1": glb(triangle(asset={"version": "1.0"}), POSITIONS),
    "unknown-required": glb(triangle(extensionsRequired=["EXT_from_nowhere"], extensionsUsed=["EXT_from_nowhere"]), POSITIONS),
    "no-binary": glb(triangle()), "short-binary": glb(triangle(), POSITIONS[:20]), "mesh-99": glb(triangle(nodes=[{"mesh": 99}]), POSITIONS),
    "mesh-negative": glb(triangle(nodes=[{"mesh": -1}]), POSITIONS), "node-cycle": glb(triangle(nodes=[{"mesh": 0, "children": [0]}]), POSITIONS),
    "node-cycle-2": glb(triangle(nodes=[{"children": [1]}, {"mesh": 0, "children": [0]}]), POSITIONS), "count-huge": glb(accessor(count=1 << 40), POSITIONS),
    "count-negative": glb(accessor(count=-3), POSITIONS), "count-text": glb(accessor(count="three"), POSITIONS), "component-type": glb(accessor(componentType=1), POSITIONS),
    "offset-wraps": glb(accessor(byteOffset=2**63 - 4), POSITIONS), "view-wraps": glb(triangle(bufferViews=[{"buffer": 0, "byteOffset": 2**62, "byteLength": 2**62}]), POSITIONS),
    "positions-nan": glb(triangle(), struct.pack("<9f", float("nan"), *[0] * 8)), "positions-infinite": glb(triangle(), struct.pack("<9f", float("inf"), *[0] * 8)),
    "index-out-of-range": glb(triangle(meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        accessors=triangle()["accessors"] + [{"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"}],
        bufferViews=[{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}], buffers=[{"byteLength": 48}]), POSITIONS + struct.pack("<3I", 0, 1, 4000000)),
    "file-outside": glb(triangle(buffers=[{"byteLength": 36, "uri": "../../../../etc/passwd"}])), "file-missing": glb(triangle(buffers=[{"byteLength": 36, "uri": "gone.bin"}])),
    "data-uri-broken": glb(triangle(buffers=[{"byteLength": 36, "uri": "data:application/octet-stream;base64,@@@@"}])),
    "texture-missing": glb(triangle(materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 7}}}], meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}]), POSITIONS),
    "material-99": glb(triangle(meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "material": 99}]}]), POSITIONS),
}

ENVIRONMENTS = {
    "empty.exr": b"", "text.exr": b"hello, world", "magic-only.exr": b"\x76\x2f\x31\x01", "empty.hdr": b"", "text.hdr": b"hello",
    "no-size.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", "size-huge.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 999999999 +X 999999999\n",
    "short.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n\1\2\3", "png.exr": b"\x89PNG\r\n\x1a\n" + bytes(64), "unknown.tga": bytes(100),
}

AXIS = '[[axis]]\nname = "view"\nsamples = 2\norbit = { target = [0,0,0], radius = 3.0, height = 1.0, from = 0, to = 30 }\n'
TOMLS = {
    "empty": "", "not-toml": "scene = = =", "binary": b"\0\1\2\xff\xfe", "no-scene": 'resolution = [64, 48]\n', "scene-is-number": "scene = 3\n",
    "model-missing": 'scene = "gone.glb"\n', "unknown-key": 'scene = "good.glb"\nresolutoin = [64, 48]\n', "resolution-zero": 'scene = "good.glb"\nresolution = [0, 48]\n',
    "resolution-huge": 'scene = "good.glb"\nresolution = [1000000, 1000000]\n', "resolution-text": 'scene = "good.glb"\nresolution = "big"\n',
    "spp-negative": 'scene = "good.glb"\nsamples_per_pixel = -1\n', "axis-without-name": 'scene = "good.glb"\n[[axis]]\nsamples = 4\n',
    "axis-twice": 'scene = "good.glb"\n' + AXIS + AXIS, "axis-no-samples": 'scene = "good.glb"\n' + AXIS.replace("samples = 2", "samples = 0"),
    "axis-huge": 'scene = "good.glb"\n' + AXIS.replace("samples = 2", "samples = 1000000000"), "animation-missing": 'scene = "good.glb"\n[[axis]]\nname = "a"\nsamples = 2\nanimation = "none"\n',
    "kind-unknown": 'scene = "good.glb"\n' + AXIS + 'kind = "wobbly"\n', "object-missing": 'scene = "good.glb"\n' + AXIS + '[[object]]\nnode = "nobody"\n',
    "representation-unknown": 'scene = "good.glb"\n' + AXIS + '[[object]]\nnode = "t"\nrepresentation = "hologram"\n',
    "profile-missing": 'scene = "good.glb"\n' + AXIS + '[target]\nprofile = "toaster"\n', "storage-nonsense": 'scene = "good.glb"\n' + AXIS + '[target]\nstorage = "a lot"\n',
    "environment-missing": 'scene = "good.glb"\nenvironment = "gone.exr"\n' + AXIS, "environment-nan": 'scene = "good.glb"\nenvironment = [nan, 0, 0]\n' + AXIS,
    "object-twice": 'scene = "good.glb"\n' + AXIS + '[[object]]\nnode = "t"\n' * 2, "model-outside": 'scene = "../../../../../../etc/passwd"\n',
}

with tempfile.TemporaryDirectory() as folder:
    out = os.path.join(folder, "out.vit")
    compile_to = ["-o", out, "--preset", "tiny", "--quiet"]
    write(folder, "good.glb", glb(triangle(), POSITIONS))
    for name, content in MODELS.items():
        write(folder, "model.glb", content)
        toml = write(folder, "scene.toml", 'scene = "model.glb"\nresolution = [32, 24]\nsamples_per_pixel = 1\n' + AXIS)
        check(f"model {name}", [vitrine, "compile", toml, *compile_to])
    for name, content in TOMLS.items():
        check(f"toml {name}", [vitrine, "compile", write(folder, "scene.toml", content), *compile_to])
    for name, content in ENVIRONMENTS.items():
        write(folder, name, content)
        toml = write(folder, "scene.toml", f'scene = "good.glb"\nenvironment = "{name}"\nresolution = [32, 24]\nsamples_per_pixel = 1\n')
        check(f"environment {name}", [vitrine, "render", toml, "-o", os.path.join(folder, "out.png"), "--quiet"])
    for name, content in {"empty": b"", "text": b"hello", "magic": b"VITRINE\x1a", "zeros": bytes(4096), "magic-zeros": b"VITRINE\x1a" + bytes(4088)}.items():
        image = write(folder, "bad.vit", content)
        for command in ([vitrine, "inspect", image], [vitrine, "verify", image, "--scene", folder], [play, image, "--backend", "null", "--frames", "1"]):
            check(f"image {name}: {os.path.basename(command[0])} {command[1] if command[0] == vitrine else ''}", command)
    for command in ([vitrine, "inspect", folder], [play, folder, "--backend", "null"], [vitrine, "compile", folder + "/gone", *compile_to],
                    [vitrine, "new", folder], [vitrine, "inspect", "/dev/zero"], [vitrine, "render", folder + "/gone.toml", "-o", "x.png"]):
        check(" ".join(map(os.path.basename, command)), command)
    if os.path.exists(out):
        failures.append("a failed compile left an image")

    # A real image, damaged in every way that a cable or a worn flash can.
    toml = write(folder, "scene.toml", 'scene = "good.glb"\nenvironment = [1, 1, 1]\nresolution = [32, 24]\nsamples_per_pixel = 1\n' + AXIS + '[target]\nstorage = "1 MB"\n')
    done = subprocess.run([vitrine, "compile", toml, "-o", out, "--quiet"], capture_output=True, text=True)
    if done.returncode:
        sys.exit("the good scene does not compile: " + done.stderr)
    good = open(out, "rb").read()
    rng = random.Random(1)
    for i in range(60):
        bad = bytearray(good)
        bad[rng.randrange(len(bad))] ^= 1 << rng.randrange(8)
        # A flip in padding between sections changes nothing that anyone reads: then it plays.
        check(f"flip {i}", [play, write(folder, "flip.vit", bytes(bad)), "--backend", "null", "--frames", "2", "--quiet"], must_fail=False)
    for i in range(40):
        check(f"cut {i}", [play, write(folder, "cut.vit", good[:rng.randrange(len(good))]), "--backend", "null", "--frames", "2", "--quiet"])

    if extra:
        for bad in sorted(glob.glob(os.path.join(extra, "assets/env/bad-exr/*.exr")))[:30]:
            toml = write(folder, "scene.toml", 'scene = "good.glb"\nenvironment = "e.exr"\nresolution = [8, 8]\nsamples_per_pixel = 1\n')
            write(folder, "e.exr", open(bad, "rb").read())
            check("bad-exr " + os.path.basename(bad), [vitrine, "render", toml, "-o", os.path.join(folder, "out.png"), "--quiet"], must_fail=False)
    else:
        print("the extra assets are absent: damaged EXR files of others were not tried")

for failure in failures:
    print("FAILED", failure)
print(f"{ran - len(failures)} passed, {len(failures)} failed")
sys.exit(bool(failures))
