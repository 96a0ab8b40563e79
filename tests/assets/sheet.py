#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Traces one picture of every good glTF model below a folder (`vitrine new --from`, `vitrine render`; nothing is compiled)
and writes contact sheets with the models' names to look at, and table.txt with each model's warnings. A model may be
refused for what walk.py lists too; any other failure, and any warning of what Vitrine should read, makes the exit code 1.

usage: sheet.py BIN_DIR FOLDER OUT_DIR [NAME...]      NAME: only models whose path contains one of these"""
import os, re, shutil, sys, time

from models import file_name_of, is_bad, is_refusal, models_below, run
from pictures import captioned, read_png, write_sheet

PER_SHEET, COLUMNS = 25, 5
SIZE, SAMPLES = "240x180", "32"
# Extensions that are read: a warning that one of them is not would be wrong.
READ = {"KHR_lights_punctual", "KHR_texture_transform", "KHR_mesh_quantization", "EXT_texture_webp"} | {
    "KHR_materials_" + name for name in ("transmission", "ior", "volume", "specular", "clearcoat", "emissive_strength", "variants", "unlit")}


def is_allowed(warning):
    named = re.search(r'the extension "([^"]+)" is not read; the model is shown without it$', warning)
    return named is not None and named[1] not in READ


def render(vitrine, model, scene, picture):
    """Exit code, all warnings, and the error."""
    shutil.rmtree(scene, ignore_errors=True)
    code, warnings, error = run([vitrine, "new", scene, "--from", model, "--quiet"])
    if code == 0:
        code, more, error = run([vitrine, "render", scene, "--size", SIZE, "--spp", SAMPLES, "--at", "view=0.5,lamp=0.5", "-o", picture])
        warnings += more
    shutil.rmtree(scene, ignore_errors=True)
    return code, warnings, error


def main(bin_dir, folder, out_dir, *names):
    os.makedirs(out_dir, exist_ok=True)
    vitrine, pictures, table, bad = os.path.join(bin_dir, "vitrine"), [], [], 0
    for model, relative in models_below(os.path.abspath(folder), names):
        if is_bad(relative):
            continue
        picture = os.path.join(out_dir, file_name_of(relative) + ".png")
        start = time.monotonic()
        code, warnings, error = render(vitrine, model, os.path.join(out_dir, "scene"), picture)
        what = "shown" if code == 0 else "refused" if is_refusal(code, error) else "FAILED"
        lines = [f"{what:8} {relative}  {time.monotonic() - start:.1f} s"] + ([f"         {error[:300]}"] if code else [])
        lines += [f"         {'' if is_allowed(w) else 'UNWARRANTED '}{w}" for w in warnings]
        bad += what == "FAILED" or not all(is_allowed(w) for w in warnings)
        table += lines
        print("\n".join(lines), flush=True)
        if code == 0:
            pictures.append(captioned(read_png(picture), relative))
    for first in range(0, len(pictures), PER_SHEET):
        write_sheet(os.path.join(out_dir, f"sheet{first // PER_SHEET}.png"), pictures[first:first + PER_SHEET], COLUMNS)
    with open(os.path.join(out_dir, "table.txt"), "w") as file:
        file.write("\n".join(table) + "\n")
    print(f"{len(pictures)} shown, {bad} failed or with unwarranted warnings")
    return bad > 0 or not pictures


if len(sys.argv) < 4:
    sys.exit(__doc__)
sys.exit(main(*sys.argv[1:]))
