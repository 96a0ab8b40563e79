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
    os.mkfifo(folder + "/pipe.png")
    render, compile_ = [vitrine, "render", scene, "-o", picture], [vitrine, "compile", scene, "-o", image]

    expect(2, [vitrine], "subcommand")
    expect(2, [vitrine, "compose"], "there is no command \"compose\"")
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
    expect(1, [*render, "--size", "640"], "WIDTHxHEIGHT")
    expect(1, [vitrine, "bench", "noise", scene, "--size", "0x48"], "WIDTHxHEIGHT")
    expect(1, [vitrine, "bench", "inference", scene, "--object", "teapot"], "no such object")
    expect(1, [vitrine, "bench", "inference", scene, "--sheet", folder + "/no/sheet.png"], "its folder does not exist")
    expect(1, [vitrine, "bench", "compression", scene, "--page", folder + "/no/page.html"], "its folder does not exist")
    expect(2, [vitrine, "bench", "compression", scene, "--ratios", "0.5"], "see vitrine bench --help")
    expect(1, [vitrine, "bench", "inference-cost", scene, "--plot", folder + "/no/plot.svg"], "its folder does not exist")
    expect(1, [*compile_, "--storage", "0.5:1"], "--storage")
    expect(1, [*compile_, "--profile", "toaster"], "kiosk-60")
    expect(1, [*render[:-1], folder + "/no/out.png"], "its folder does not exist")
    expect(1, [*render[:-1], folder + "/out.jpg"], ".png")
    expect(1, [vitrine, "verify", image, "--scene", scene, "--sheet", folder + "/no/sheet.png"], "its folder does not exist")
    expect(1, [vitrine, "render", scene, "-o", folder + "/pipe.png"], "not a regular file")
    expect(1, [vitrine, "inspect", folder + "/no such\nimage.vit"], "no such?image.vit: no such file")
    expect(1, ["sh", "-c", f"exec {play} --help > /dev/full"], "standard output")
    expect(1, ["sh", "-c", f"exec {vitrine} new {folder}/other > /dev/full"], "standard output")

    # What is lost is the log, not the work.
    ran += 1
    os.symlink("real.png", folder + "/link.png")
    done = subprocess.run(["sh", "-c", f"exec {vitrine} render {scene} -o {folder}/link.png --size 8x8 --spp 1 2> /dev/full"])
    if done.returncode != 0 or not os.path.islink(folder + "/link.png") or not os.path.exists(folder + "/real.png"):
        failures.append("a full disk under the log, or a symbolic link for an output, is not borne")
    # An image that shrinks under the player: it says so when it reads what is gone, and plays on while it has all that it needs.
    ran += 1
    subprocess.run([*compile_, "--preset", "tiny", "--quiet"], check=True)
    process = subprocess.Popen([play, image, "--backend", "null", "--frames", "100000000"], stderr=subprocess.PIPE, text=True)
    time.sleep(1)
    os.truncate(image, 0)
    try:
        error = process.communicate(timeout=5)[1]
    except subprocess.TimeoutExpired:
        process.terminate()
        error = process.communicate(timeout=20)[1]
    if process.returncode not in (-signal.SIGTERM, 0, 128 + signal.SIGTERM, 1) or (process.returncode == 1 and "mv" not in error):
        failures.append(f"an image cut while it plays: exit {process.returncode}: {error}")
    # The same folder when it could not be filled.
    ran += 1
    gone = subprocess.run(["sh", "-c", f"trap '' XFSZ; ulimit -f 4; exec {vitrine} new {folder}/small"], capture_output=True, text=True)
    if gone.returncode == 0 or os.path.exists(folder + "/small"):
        failures.append(f"a scene that could not be written stays in part: {gone.returncode} {gone.stderr}")

    expect_heard([*render, "--spp", "100000", "--quiet"], picture)
    expect_heard([*compile_[:-1], folder + "/heard.vit", "--preset", "full", "--quiet"], folder + "/heard.vit")

for failure in failures:
    print("FAILED", failure)
print(f"{ran - len(failures)} passed, {len(failures)} failed")
sys.exit(bool(failures))
