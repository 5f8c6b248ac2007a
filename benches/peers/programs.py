"""The machine and the two programs, each started as a command whose CPU time is measured."""

import ctypes
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenEXR

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
OUT = ROOT / "target/peers"
K = 8
PATIENCE = 1800  # seconds for one command


class Stop(Exception):
    """An error with what to do about it."""


# the machine


def llvm():
    """The path of an LLVM library of version 16 or newer: with 15, the kernels of Mitsuba 3.9 abort."""
    given = os.environ.get("DRJIT_LIBLLVM_PATH")
    listed = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True, check=False).stdout
    found = [given] if given else re.findall(r"=> (\S*/libLLVM[-.\w]*)$", listed, re.M)
    versions = {}
    for path in found:
        major = ctypes.c_uint(0)
        try:  # the function that tells the version is itself new in 16
            ctypes.CDLL(path).LLVMGetVersion(ctypes.byref(major), None, None)
        except (OSError, AttributeError):
            continue
        versions[path] = major.value
    new = {path: version for path, version in versions.items() if version >= 16}
    if not new:
        what = f"{given} is not LLVM 16 or newer" if given else "no LLVM library of version 16 or newer"
        raise Stop(f"{what}\nhelp: apt-get install libllvm19, or name a library: DRJIT_LIBLLVM_PATH=/…/libLLVM.so")
    path = max(new, key=new.get)
    return path, new[path]


def processor():
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else 'unknown processor'}, {len(names)} cores"


# the two programs


def run(command):
    """Runs a command; returns its CPU seconds (user and system), what it printed and its messages."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = [str(word) for word in command]
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        raise Stop(f"`{' '.join(words)}` did not end within {PATIENCE} s") from None
    except OSError as e:
        raise Stop(f"`{words[0]}` does not start: {e.strerror}\nhelp: FREDHOLM names the program") from None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        last = "\n".join((done.stderr or done.stdout).strip().splitlines()[-6:])
        raise Stop(f"`{' '.join(words)}` ended with code {done.returncode}\n{last}")
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, done.stdout, done.stderr


def series(case, side, spp, seed=0, how=""):
    """CPU seconds of our command. Its results are in the folder `ours` of the case."""
    how = f"{how} --worlds terms --estimator prefix --roulette none -t 1 --quiet --force --max-bounces {K}".split()
    size = ["--size", f"{side}x{side}", "--spp", spp, "--seed", seed]
    return run([os.environ["FREDHOLM"], "series", case.scene, *how, *size, *case.sets, "-o", case.folder / "ours"])[0]


def export(case, side, spp):
    """Writes the scene for Mitsuba; returns the file and the notes of the exporter."""
    to = case.folder / f"{side}-{spp}"
    to.mkdir(parents=True)
    file = to / "scene.xml"
    what = ["--to", "mitsuba", "--max-bounces", K, "--spp", spp, "--set", f"camera.size=[{side},{side}]"]
    _, _, messages = run([os.environ["FREDHOLM"], "export", case.scene, *what, *case.sets, "-o", file])
    return file, [line.removeprefix("note: ") for line in messages.splitlines() if line.startswith("note: ")]


def mitsuba(mode, file, out, *more):
    """CPU seconds of Mitsuba."""
    return run([sys.executable, HERE / "by_mitsuba.py", mode, file, out, *more])[0]


def sum_of_terms(folder):
    """The image of the sum of the terms, [height, width, 3]."""
    with OpenEXR.File(str(folder / "terms.exr"), separate_channels=True) as file:
        return np.stack([file.channels()[f"Tsum.{c}"].pixels for c in "RGB"], 2).astype(np.float64)
