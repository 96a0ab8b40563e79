#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Kills a compile at many moments, by Ctrl-C and by kill -9, and compiles again: the bytes must be those of an undisturbed
run, stored frames must not be traced twice, and the number of threads must not matter. What was compiled plays within its plan.

usage: resume.py BIN_DIR"""
import hashlib, json, os, random, signal, subprocess, sys, tempfile, time

vitrine, play = (os.path.join(sys.argv[1], name) for name in ("vitrine", "vitrine-play"))


def digest(path):
    return hashlib.sha256(open(path, "rb").read()).hexdigest()


def compile_scene(folder, name, *options):
    image = os.path.join(folder, name + ".vit")
    done = subprocess.run([vitrine, "compile", os.path.join(folder, "scene"), "-o", image, "--preset", "tiny", "--storage", "2 MB", "--json", *options], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"compile failed: {done.stderr}")
    return image, json.loads(done.stdout)


with tempfile.TemporaryDirectory() as folder:
    subprocess.run([vitrine, "new", os.path.join(folder, "scene"), "--quiet"], check=True)
    start = time.monotonic()
    image, report = compile_scene(folder, "one", "--jobs", "1")
    whole = time.monotonic() - start
    wanted = digest(image)
    assert report["frames_rendered"] == report["frames"], report

    played = subprocess.run([play, image, "--backend", "null", "--frames", "30", "--json"], capture_output=True, text=True, check=True)
    stats = json.loads(played.stdout)
    assert stats["units"]["max"] <= stats["units"]["budget"] and stats["upload_bytes"]["max"] <= stats["upload_bytes"]["budget"], f"the plan is not kept: {stats}"
    assert stats["late_nodes"] == stats["overruns"] == stats["allocations"] == 0, stats

    image, report = compile_scene(folder, "one", "--jobs", "1")
    assert report["frames_rendered"] == 0, f"stored frames were traced again: {report}"
    assert digest(image) == wanted, "a compile from the store gives other bytes"
    image, _ = compile_scene(folder, "two", "--jobs", "2")
    assert digest(image) == wanted, "two threads give other bytes than one"

    rng = random.Random(7)
    for i, how in enumerate([signal.SIGKILL, signal.SIGINT, signal.SIGKILL, signal.SIGINT, signal.SIGTERM]):
        name = f"killed{i}"
        image = os.path.join(folder, name + ".vit")
        for attempt in range(3):  # several kills in a row, each after another share of the work
            process = subprocess.Popen([vitrine, "compile", os.path.join(folder, "scene"), "-o", image, "--preset", "tiny", "--storage", "2 MB", "--quiet"], stderr=subprocess.PIPE)
            try:
                process.wait(timeout=whole * rng.uniform(0.05, 0.6))
            except subprocess.TimeoutExpired:
                process.send_signal(how)
                error = process.communicate(timeout=20)[1].decode()
                if how == signal.SIGINT and process.returncode not in (0, 130):
                    sys.exit(f"Ctrl-C ended with {process.returncode}: {error}")
                assert len(error.splitlines()) <= 1, error
        image, report = compile_scene(folder, name)
        assert digest(image) == wanted, f"after {how.name} the image differs from an undisturbed run"
    print(f"{report['frames']} frames; killed runs resumed to the same bytes")
print("1 passed, 0 failed")
