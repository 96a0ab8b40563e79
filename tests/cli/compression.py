#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""vitrine bench compression on a scene of a few tiny pictures: the rows of its JSON are whole and no video with random access
takes more decodes than promised; the page needs no other file; a second run traces nothing.

Without ffmpeg (which is no dependency of Vitrine) the video coders are left out, and what is missing is said in one line.

usage: compression.py BIN_DIR"""
import json, os, shutil, subprocess, sys, tempfile

vitrine = os.path.join(sys.argv[1], "vitrine")
KEYS = {"coder", "ratio_target", "ratio", "psnr_db", "decodes_per_access", "decode_ms", "scene", "bytes"}
RATIOS, CODERS = (8, 12), "svt-av1,mpeg4"


def check(condition, what):
    if not condition:
        sys.exit("compression.py: " + what)


def bench(scene, work, *options):
    command = [vitrine, "bench", "compression", scene, "--size", "96x72", "--noise", "20", "--samples", "3", "--coders", CODERS, "--work", work, *options]
    return subprocess.run(command, capture_output=True, text=True, timeout=550)


with tempfile.TemporaryDirectory() as folder:
    scene, work, page = (os.path.join(folder, name) for name in ("scene", "work", "page.html"))
    subprocess.run([vitrine, "new", scene, "--quiet"], check=True)
    has_ffmpeg = shutil.which("ffmpeg") is not None
    if not has_ffmpeg:
        done = bench(scene, work, "--quiet")
        check(done.returncode == 1 and done.stderr.count("\n") == 1 and "apt-get install ffmpeg" in done.stderr,
              "a missing ffmpeg is not said in one line: " + done.stderr[:500])
    options = ["--ratios", ",".join(map(str, RATIOS)), "--json", "--quiet", "--page", page] + ([] if has_ffmpeg else ["--no-videos"])
    done = bench(scene, work, *options)
    check(done.returncode == 0, "exit %d: %s" % (done.returncode, done.stderr[:500]))
    report = json.loads(done.stdout)
    rows = report["rows"]
    for row in rows:
        check(KEYS <= row.keys(), "a row lacks keys: %s" % row)
        check(10 < row["psnr_db"] < 99 and row["decode_ms"] >= 0 and row["bytes"] > 0, "a row makes no sense: %s" % row)
        check(abs(row["ratio"] * row["bytes"] / report["raw_bytes"] - 1) < 1e-6, "ratio and bytes do not agree: %s" % row)
        if "random access" in row["coder"]:
            check(row["decodes_per_access"] <= 4, "more decodes than promised: %s" % row)
    coders = {row["coder"] for row in rows}
    check("pyramid, DCT" in coders, "Vitrine's own row is missing")
    check(not has_ffmpeg or any("svt-av1" in coder for coder in coders), "the video coders are missing")
    check(len(rows) == len(RATIOS) * len(coders), "not a row for each coder and ratio")
    html = open(page).read()
    check("<svg" in html and "data:image/png;base64," in html and " href=" not in html, "the page is not whole")
    check(all(coder in html for coder in coders), "the page lacks coders")
print("bench compression holds" + ("" if has_ffmpeg else " (without ffmpeg: video coders skipped)"))
