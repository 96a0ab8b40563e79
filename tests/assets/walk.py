#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Walks all glTF models below a folder: `vitrine new --from`, `compile --preset tiny`, one still; writes a contact sheet
(ground truth above playback) to look at, and a table. A model that needs an extension outside the list or a
later glTF, or that holds only points and lines, must be refused in one line. Models below bad/ are only checked not to crash, hang, or print more than one line.

usage: walk.py BIN_DIR FOLDER OUT_DIR [NAME...]      NAME: only models whose path contains one of these"""
import glob, json, os, re, shutil, struct, subprocess, sys, time, zlib

bin_dir, folder, out_dir, names = sys.argv[1], os.path.abspath(sys.argv[2]), os.path.abspath(sys.argv[3]), sys.argv[4:]
vitrine, play = os.path.join(bin_dir, "vitrine"), os.path.join(bin_dir, "vitrine-play")
os.makedirs(out_dir, exist_ok=True)


def read_png(path):
    """An 8-bit RGB or RGBA PNG as (width, height, rows of RGB bytes)."""
    data, pos, idat = open(path, "rb").read(), 8, b""
    while pos < len(data):
        size, kind = struct.unpack(">I4s", data[pos:pos + 8])
        if kind == b"IHDR":
            width, height, _, color = struct.unpack(">IIBB", data[pos + 8:pos + 18])
        idat += data[pos + 8:pos + 8 + size] if kind == b"IDAT" else b""
        pos += 12 + size
    raw, n = zlib.decompress(idat), 4 if color == 6 else 3
    rows, previous, stride = [], bytearray(width * n), width * n + 1
    for y in range(height):
        kind, line = raw[y * stride], bytearray(raw[y * stride + 1:(y + 1) * stride])
        for i in range(len(line)):
            a, b, c = line[i - n] if i >= n else 0, previous[i], previous[i - n] if i >= n else 0
            p = a + b - c
            paeth = a if abs(p - a) <= min(abs(p - b), abs(p - c)) else b if abs(p - b) <= abs(p - c) else c
            line[i] = line[i] + (0, a, b, (a + b) // 2, paeth)[kind] & 255
        rows.append(bytes(line) if n == 3 else b"".join(bytes(line[i:i + 3]) for i in range(0, len(line), 4)))
        previous = line
    return width, height, rows


def write_png(path, width, height, rows):
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                           chunk(b"IDAT", zlib.compress(b"".join(b"\0" + r for r in rows))) + chunk(b"IEND", b""))


def sheet(path, pictures, columns):
    """Pictures of one size, in rows, on white."""
    width, height, gap = pictures[0][0], pictures[0][1], 4
    rows = []
    for first in range(0, len(pictures), columns):
        band = pictures[first:first + columns]
        for y in range(height):
            line = b"".join(p[2][y] + b"\xff" * 3 * gap for p in band)
            rows.append(line + b"\xff" * (3 * columns * (width + gap) - len(line)))
        rows += [b"\xff" * (3 * columns * (width + gap))] * gap
    write_png(path, columns * (width + gap), len(rows), rows)


def run(command, limit=300):
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=limit)
    except subprocess.TimeoutExpired:
        return None, "hangs"
    return done.returncode, "\n".join(line for line in done.stderr.splitlines() if ": warning: " not in line)


def walk_good(model, name):
    scene, image = os.path.join(out_dir, name), os.path.join(out_dir, name + ".vit")
    shutil.rmtree(scene, ignore_errors=True)
    for command in ([vitrine, "new", scene, "--from", model, "--quiet"],
                    [vitrine, "compile", scene, "-o", image, "--preset", "tiny", "--storage", "12 MB", "--quiet"],
                    [play, image, "--backend", "osmesa", "--at", "view=0.5,lamp=0.5", "--out", os.path.join(out_dir, name + ".png"), "--quiet"],
                    [vitrine, "render", scene, "--at", "view=0.5,lamp=0.5", "--size", "160x120", "--spp", "8", "--quiet", "-o", os.path.join(out_dir, name + ".truth.png")]):
        code, error = run(command)
        if code != 0:
            return code, error
    return 0, ""


# What a model may be refused for: an extension outside the list, a later glTF, nothing but points and lines.
REFUSALS = ("extensionsRequired", "asset.minVersion", "there is nothing to see in it")
failed, refused, pictures = [], [], []
for model in sorted(glob.glob(folder + "/**/*.gl*", recursive=True)):
    relative = os.path.relpath(model, folder)
    if not re.search(r"\.(glb|gltf)$", model) or (names and not any(n in relative for n in names)):
        continue
    name = re.sub(r"[^A-Za-z0-9.-]", "_", relative)
    start = time.monotonic()
    if "/bad/" in model or relative.startswith("bad/"):
        shutil.rmtree(os.path.join(out_dir, "bad"), ignore_errors=True)
        code, error = run([vitrine, "new", os.path.join(out_dir, "bad"), "--from", model, "--quiet"], 20)
        if code == 0:
            code, error = run([vitrine, "render", os.path.join(out_dir, "bad"), "--size", "16x12", "--spp", "1", "--quiet", "-o", os.path.join(out_dir, "bad.png")], 20)
        if code not in (0, 1) or len(error.splitlines()) > 1 or (code == 1 and not error):
            failed.append((relative, f"exit {code}: {error[:200]}"))
        continue
    code, error = walk_good(model, name)
    if code == 1 and len(error.splitlines()) == 1 and any(reason in error for reason in REFUSALS):
        refused.append((relative, error))
    elif code != 0:
        failed.append((relative, f"exit {code}: {error[:300]}"))
    else:
        for kind in (".truth.png", ".png"):
            picture = read_png(os.path.join(out_dir, name + kind))
            pictures.append(picture)
        print(f"{len(pictures) // 2:4} {relative}  {os.path.getsize(os.path.join(out_dir, name + '.vit'))} bytes  {time.monotonic() - start:.1f} s", flush=True)
        shutil.rmtree(os.path.join(out_dir, name + ".work"), ignore_errors=True)

for first in range(0, len(pictures), 48):  # ground truth and playback side by side, 4 pairs a row
    sheet(os.path.join(out_dir, f"sheet{first // 48}.png"), pictures[first:first + 48], 8)
for relative, error in refused:
    print(f"refused  {relative}: {error}")
for relative, error in failed:
    print(f"FAILED   {relative}: {error}")
print(f"{len(pictures) // 2} compiled and played, {len(refused)} refused, {len(failed)} failed")
sys.exit(bool(failed))
