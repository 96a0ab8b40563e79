#!/usr/bin/env python3
# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""Mistakes on the command line get one line that says what to do and exit code 2, before any work; results that cannot be
delivered and outputs that cannot be written exit with 1; Ctrl-C is heard at once and leaves nothing half-written.

usage: usage.py BIN_DIR"""
import os, signal, subprocess, sys, tempfile, time

vitrine, play = (os.path.join(sys.argv[1], name) for name in ("vitrine", "vitrine-play"))
failures, ran = [], 0


def expect(code, command, mention):
    global ran
    ran += 1
    done = subprocess.run(command, capture_output=True, text=True, timeout=30)
    lines = done.stderr.splitlines()
    if done.returncode != code or len(lines) != 1 or mention not in lines[0] or done.stdout:
        failures.append(f"{command}: exit {done.returncode}, wanted {code} and \"{mention}\": {done.stderr[:300]}")


def expect_heard(command, output):
    """SIGTERM in the midst of work: exit code 130 within two seconds on an idle machine (ten are granted), no output."""
    global ran
    ran += 1
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    time.sleep(1)
    process.send_signal(signal.SIGTERM)
    try:
        error = process.communicate(timeout=10)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        failures.append(f"{command}: does not hear SIGTERM")
        return
    if process.returncode != 130 or "interrupted" not in error or os.path.exists(output):
        failures.append(f"{command}: exit {process.returncode} after SIGTERM: {error[:300]}")


with tempfile.TemporaryDirectory() as folder:
    scene, picture, image = (os.path.join(folder, name) for name in ("scene", "out.png", "out.vit"))
    subprocess.run([vitrine, "new", scene, "--quiet"], check=True)
    render, compile_ = [vitrine, "render", scene, "-o", picture], [vitrine, "compile", scene, "-o", image]

    expect(2, [vitrine], "subcommand")
    expect(2, [vitrine, "compose"], "see vitrine --help")
    expect(2, [vitrine, "compile"], "see vitrine compile --help")
    expect(2, [*compile_, "--preset", "huge"], "see vitrine compile --help")
    expect(2, [*compile_, "--codec", "zip"], "--codec")
    expect(2, [*compile_, "--jobs", "0"], "--jobs")
    expect(2, [*compile_, "--work", ""], "--work: is empty")
    expect(2, [vitrine, "render", scene, "-o", ""], "see vitrine render --help")
    expect(2, [*render, "--at", "view=0.5,view=0.2"], "twice")
    expect(2, [*render, "--at", "view=0.5,"], "AXIS=POSITION")
    expect(2, [*render, "--at", ""], "--at: is empty")
    expect(2, [*render, "--at", "view=1.5"], "from 0 to 1")
    expect(2, [*render, "--at", "view=#99"], "no sample")
    expect(2, [*render, "--at", "door=0"], "view, lamp")
    expect(2, [vitrine, "verify", image, "--scene", scene, "--off", "-1"], "see vitrine verify --help")
    expect(2, [play], "see vitrine-play --help")
    expect(2, [play, ""], "is empty")
    expect(2, [play, image, "--frames", "0"], "--frames")
    expect(2, [play, image, "--frames", "99999999999999999999999"], "--frames")
    expect(2, [play, image, "--backend", "vulkan"], "--backend")
    expect(2, [play, image, "--out", "still.exr"], ".png")
    expect(2, [play, image, "--out", "still.png", "--frames", "3"], "folder")

    expect(1, [*compile_[:-1], folder + "/no/out.vit"], "its folder does not exist")
    expect(1, [*compile_[:-1], folder + "/out.png"], "NAME.vit")
    expect(1, [vitrine, "compile", scene + "/model.glb", "-o", image], "vitrine new DIR --from")
    expect(1, [*compile_, "--storage", "0.5:1"], "--storage")
    expect(1, [*compile_, "--profile", "toaster"], "kiosk-60")
    expect(1, [*render[:-1], folder + "/no/out.png"], "its folder does not exist")
    expect(1, [*render[:-1], folder + "/out.jpg"], ".png")
    expect(1, [vitrine, "verify", image, "--scene", scene, "--sheet", folder + "/no/sheet.png"], "its folder does not exist")
    expect(1, ["sh", "-c", f"exec {vitrine} new {folder}/other > /dev/full"], "standard output")

    expect_heard([*render, "--spp", "100000", "--quiet"], picture)
    expect_heard([*compile_, "--preset", "full", "--quiet"], image)

for failure in failures:
    print("FAILED", failure)
print(f"{ran - len(failures)} passed, {len(failures)} failed")
sys.exit(bool(failures))
