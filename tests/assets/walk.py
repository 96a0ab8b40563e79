#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Walks all glTF models below a folder: `vitrine new --from`, `compile --preset tiny`, one still; writes a contact sheet
(ground truth above playback) to look at, and a table. A model that needs an extension outside the list or a
later glTF, or that holds only points and lines, must be refused in one line. Models below bad/ are only checked not to crash, hang, or print more than one line.

usage: walk.py BIN_DIR FOLDER OUT_DIR [NAME...]      NAME: only models whose path contains one of these"""
import os, shutil, sys, time

from models import file_name_of, is_bad, is_refusal, models_below, run
from pictures import read_png, write_sheet

bin_dir, folder, out_dir, names = sys.argv[1], os.path.abspath(sys.argv[2]), os.path.abspath(sys.argv[3]), sys.argv[4:]
vitrine, play = os.path.join(bin_dir, "vitrine"), os.path.join(bin_dir, "vitrine-play")
os.makedirs(out_dir, exist_ok=True)


def walk_good(model, name):
    scene, image = os.path.join(out_dir, name), os.path.join(out_dir, name + ".vit")
    shutil.rmtree(scene, ignore_errors=True)
    for command in ([vitrine, "new", scene, "--from", model, "--quiet"],
                    [vitrine, "compile", scene, "-o", image, "--preset", "tiny", "--storage", "12 MB", "--quiet"],
                    [play, image, "--backend", "osmesa", "--at", "view=0.5,lamp=0.5", "--out", os.path.join(out_dir, name + ".png"), "--quiet"],
                    [vitrine, "render", scene, "--at", "view=0.5,lamp=0.5", "--size", "160x120", "--spp", "8", "--quiet", "-o", os.path.join(out_dir, name + ".truth.png")]):
        code, _, error = run(command)
        if code != 0:
            return code, error
    return 0, ""


failed, refused, pictures = [], [], []
for model, relative in models_below(folder, names):
    name = file_name_of(relative)
    start = time.monotonic()
    if is_bad(relative):
        shutil.rmtree(os.path.join(out_dir, "bad"), ignore_errors=True)
        code, _, error = run([vitrine, "new", os.path.join(out_dir, "bad"), "--from", model, "--quiet"], 20)
        if code == 0:
            code, _, error = run([vitrine, "render", os.path.join(out_dir, "bad"), "--size", "16x12", "--spp", "1", "--quiet", "-o", os.path.join(out_dir, "bad.png")], 20)
        if code not in (0, 1) or len(error.splitlines()) > 1 or (code == 1 and not error):
            failed.append((relative, f"exit {code}: {error[:200]}"))
        continue
    code, error = walk_good(model, name)
    if is_refusal(code, error):
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
    write_sheet(os.path.join(out_dir, f"sheet{first // 48}.png"), pictures[first:first + 48], 8)
for relative, error in refused:
    print(f"refused  {relative}: {error}")
for relative, error in failed:
    print(f"FAILED   {relative}: {error}")
print(f"{len(pictures) // 2} compiled and played, {len(refused)} refused, {len(failed)} failed")
sys.exit(bool(failed))
