# Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
"""What the scripts that walk a folder of glTF models share."""
import glob, os, re, subprocess

# What a model may be refused for: an extension outside the list, a later glTF, nothing but points and lines.
REFUSALS = ("extensionsRequired", "asset.minVersion", "there is nothing to see in it")


def models_below(folder, names):
    """(path, path relative to `folder`) of all models, or of those whose relative path contains one of `names`."""
    for model in sorted(glob.glob(folder + "/**/*.gl*", recursive=True)):
        relative = os.path.relpath(model, folder)
        if re.search(r"\.(glb|gltf)$", model) and (not names or any(n in relative for n in names)):
            yield model, relative


def is_bad(relative):
    return "bad" in relative.split(os.sep)[:-1]


def file_name_of(relative):
    return re.sub(r"[^A-Za-z0-9.-]", "_", relative)


def run(command, limit=300):
    """Exit code (None: it hangs), warnings, and the other lines on stderr as one text."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=limit)
    except subprocess.TimeoutExpired:
        return None, [], "hangs"
    lines = done.stderr.splitlines()
    warnings = [line for line in lines if ": warning: " in line]
    return done.returncode, warnings, "\n".join(line for line in lines if ": warning: " not in line)


def is_refusal(code, error):
    return code == 1 and len(error.splitlines()) == 1 and any(reason in error for reason in REFUSALS)
