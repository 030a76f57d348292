#!/usr/bin/env python3
"""Reduced meshes: yamanami beside other reducers, in one interleaved run.

    pip install numpy fast-simplification pyfqmr
    bench/reduce.py target/release/yamanami MESH.ply... [-r 0.5 0.1 0.01] [-n 3] [--peer NAME="COMMAND {in} {out} {faces}"]

Every result is measured by `yamanami compare --json` (two-sided, a million samples; it shares no code with the reducer) and
looked through by `yamanami info --json`. Errors are given in millionths of the bounding box's diagonal. Seconds are CPU seconds of
the reduction alone: ours are those of the program less those of a run that only reads and writes; a --peer prints one JSON line
with `cpu_s`. Meshes are first made plain by `yamanami
reduce --ratio 1 --clean`, so that all tools get the same file.
"""
import argparse, json, resource, shlex, statistics, subprocess, sys, tempfile, time
from pathlib import Path

import numpy as np


def read_ply(path):
    data = path.read_bytes()
    end = data.index(b"end_header\n") + 11
    head = [line.split() for line in data[:end].decode().splitlines()]
    count = {w[1]: int(w[2]) for w in head if w[0] == "element"}
    kinds = {"double": "<f8", "float": "<f4", "uchar": "u1"}
    fields = [(w[2], kinds[w[1]]) for w in head if w[0] == "property" and w[1] != "list"]
    v = np.frombuffer(data, np.dtype(fields), count["vertex"], end)
    t = np.frombuffer(data, np.dtype([("n", "u1"), ("i", "<i4", 3)]), count["face"], end + v.nbytes)
    return np.stack([v[k] for k in "xyz"], 1).astype("f8"), np.ascontiguousarray(t["i"])


def write_ply(path, v, t):
    record = np.empty(len(t), np.dtype([("n", "u1"), ("i", "<i4", 3)]))
    record["n"], record["i"] = 3, t
    path.write_bytes(
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(v)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(t)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        + np.ascontiguousarray(v, "<f8").tobytes() + record.tobytes()
    )


def fast_simplification(source, out, faces):
    import fast_simplification as m
    v, t = read_ply(source)
    started = time.process_time()
    v, t = m.simplify(v.astype("f4"), t, target_count=faces)[:2]
    taken = time.process_time() - started
    write_ply(out, v, t)
    return taken


def pyfqmr(source, out, faces):
    import pyfqmr as m
    s = m.Simplify()
    s.setMesh(*read_ply(source))
    started = time.process_time()
    s.simplify_mesh(target_count=faces, aggressiveness=3, preserve_border=False, verbose=0)
    taken = time.process_time() - started
    write_ply(out, *s.getMesh()[:2])
    return taken


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("yamanami")
    a.add_argument("meshes", nargs="+")
    a.add_argument("-r", "--ratios", nargs="+", type=float, default=[0.5, 0.1, 0.01])
    a.add_argument("-n", "--runs", type=int, default=3)
    a.add_argument("--peer", action="append", default=[])
    args = a.parse_args()

    def run(*words):
        p = subprocess.run([args.yamanami, *map(str, words), "--json"], capture_output=True, text=True)
        if p.returncode:
            sys.exit(p.stderr)
        return json.loads(p.stdout)

    def cpu_s(*words):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run(*words)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def ours(source, out, faces):
        whole = cpu_s("reduce", source, "-o", out, "--faces", faces)
        return whole - cpu_s("reduce", source, "-o", out.with_name("unchanged.ply"), "--ratio", 1)

    def command(text):
        def call(source, out, faces):
            words = [w.format(**{"in": source, "out": out, "faces": faces}) for w in shlex.split(text)]
            p = subprocess.run(words, capture_output=True, text=True)
            return json.loads(p.stdout.strip().splitlines()[-1])["cpu_s"]
        return call

    tools = {"yamanami": ours, "fast-simplification": fast_simplification, "pyfqmr": pyfqmr}
    tools |= {name: command(text) for name, text in (peer.split("=", 1) for peer in args.peer)}
    print("| mesh | faces | tool | result | RMS | Hausdorff | CPU s | bad edges |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for mesh in args.meshes:
            plain = folder / "plain.ply"
            run("reduce", mesh, "-o", plain, "--ratio", 1, "--clean")
            v, t = read_ply(plain)
            write_ply(plain, v, t)
            diagonal = np.linalg.norm(v.max(0) - v.min(0))
            bad_before = run("info", plain)["non_manifold_edges"]
            for ratio in args.ratios:
                faces, taken = round(len(t) * ratio), {name: [] for name in tools}
                for _ in range(args.runs):
                    for name, tool in tools.items():
                        taken[name].append(tool(plain, folder / f"{name}.ply", faces))
                for name in tools:
                    result = folder / f"{name}.ply"
                    far, found = run("compare", plain, result), run("info", result)
                    rms = max(far[way]["rms_m"] for way in ("a_to_b", "b_to_a")) / diagonal * 1e6
                    print(
                        f"| {Path(mesh).name} | {faces} | {name} | {found['faces']} | {rms:.1f} |"
                        f" {far['hausdorff_m'] / diagonal * 1e6:.0f} | {statistics.median(taken[name]):.3f} |"
                        f" {found['non_manifold_edges'] - bad_before} |", flush=True
                    )


if __name__ == "__main__":
    main()
