"""Peak memory of ranks, for bench_ranks.py --memory."""
# SPDX-License-Identifier: GPL-3.0-or-later
import pathlib
import sys

from ranks import runs

# run a command; how much memory it took at most [kB] goes to a file, of each rank
PEAK = """import os, subprocess, sys
child = subprocess.Popen(sys.argv[2:])
_, status, usage = os.wait4(child.pid, 0)
open(sys.argv[1] + "." + os.environ.get("OMPI_COMM_WORLD_RANK", "0"), "w").write(str(usage.ru_maxrss))
sys.exit(os.waitstatus_to_exitcode(status))
"""


def peaks(options, particles, ranks):
    """most memory of each rank [MB], of a block of spheres that falls into a corner"""
    scene = runs.scene("falling", particles, options.steps or 100)
    if options.frames:
        scene["output"]["particles_interval"] = scene["time"]["end"] / 2
    file = runs.write(options, "memory.json", scene)
    peak = options.out / "peak"
    command = runs.MPIRUN + [ranks] if ranks > 1 else []
    command += [sys.executable, "-c", PEAK, peak, options.bin / "tandem-dem-mpi", "run", file]
    runs.call(command + ["--out", options.out / "run", "--force", "--no-plots"], options.out / "log")
    return [int(pathlib.Path(f"{peak}.{rank}").read_text()) / 1024 for rank in range(ranks)]


def measure(options):
    whole = peaks(options, options.memory, 1)[0] - peaks(options, 1000, 1)[0]
    print(f"one process: {whole:.1f} MB for {options.memory} particles, besides the program")
    for ranks in options.ranks:
        program = peaks(options, 1000, ranks)
        parts = [(peak - own) * ranks / whole for peak, own in zip(peaks(options, options.memory, ranks), program)]
        print(
            f"{ranks} ranks: the program {min(program):.1f} ... {max(program):.1f} MB; peak memory in shares "
            f"({whole / ranks:.1f} MB): " + " ".join(f"{share:.2f}" for share in parts),
            flush=True,
        )
