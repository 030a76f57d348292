#!/usr/bin/env python3
"""Progressive models beside 'reduce well, then compress': bytes at equal distance, and distance at equal bytes.

    pip install numpy DracoPy meshoptimizer zstandard
    bench/progressive.py target/release/yamanami SCAN.ply... [-f 2000 8000 20000] [-l LEVELS] [--reduced "COMMAND {in} {out} {faces}"]

The rivals are the scan reduced to some numbers of faces (by yamanami, or by the command given, which writes a PLY of doubles as this
file does) and compressed: by Draco (level 10, at 10 to 12 bits the best of all at that number of faces: the front of bytes and
distance), and by the meshoptimizer codecs at 12 bits with zstd on top. Every result is decoded and measured by `yamanami compare --json`
(two-sided, 400,000 samples). PSNR = 20 log10(diagonal of the scan's box / larger RMS of both ways). For each rival the table has what the first
as many bytes of the progressive file give, and how many of its bytes give the same distance.
"""
import argparse, json, math, shlex, subprocess, sys, tempfile
from pathlib import Path

import numpy as np

from reduce import read_ply, write_ply

BITS = (10, 11, 12)


def draco(v, t, bits):
    import DracoPy as m
    data = m.encode(v, faces=t, quantization_bits=bits, compression_level=10, preserve_order=False)
    mesh = m.decode(data)
    return len(data), np.asarray(mesh.points, "f8").reshape(-1, 3), np.asarray(mesh.faces).reshape(-1, 3)


def meshopt(v, t, bits=12):
    import meshoptimizer as m, zstandard
    low, size = v.min(0), (v.max(0) - v.min(0)).max()
    steps = (1 << bits) - 1
    q = np.round((v - low) / size * steps).astype("u2")
    # in the order that the triangles use them, as the codec expects
    order = np.empty(t.size, "u4")
    m.optimize_vertex_cache(order, t.astype("u4").ravel(), vertex_count=len(q))
    _, first = np.unique(order, return_index=True)
    used = order[np.sort(first)]
    number = np.empty(len(q), "u4")
    number[used] = np.arange(len(used), dtype="u4")
    q, order = q[used], number[order]
    packed = np.zeros((len(q), 4), "u2")
    packed[:, :3] = q
    parts = [m.encode_vertex_buffer(packed, len(q), 8), m.encode_index_buffer(order, len(order), len(q))]
    data = zstandard.ZstdCompressor(level=19).compress(b"".join(bytes(p) for p in parts))
    return len(data), q / steps * size + low, order.reshape(-1, 3)


class Scan:
    def __init__(self, program, path, folder, levels, reducer):
        self.program, self.path, self.folder, self.reducer = program, path, folder, reducer
        info = self.run("info", path)
        self.vertices, self.faces = info["vertices"], info["faces"]
        self.diagonal = math.dist(info["min"], info["max"])
        self.file = folder / "model.yama"
        extra = ["--levels", levels] if levels else []
        self.built = self.run("build", path, "--progressive", "-o", self.file, *extra)

    def run(self, *args):
        return json.loads(subprocess.run([self.program, *map(str, args), "--json"], check=True, capture_output=True).stdout)

    def psnr(self, mesh):
        found = self.run("compare", self.path, mesh, "--samples", 400000)
        rms = max(found[way]["rms_m"] for way in ("a_to_b", "b_to_a"))
        return 20 * math.log10(self.diagonal / rms)

    def ours(self, size):
        out = self.folder / "ours.ply"
        self.run("extract", self.file, "--bytes", int(size), "-o", out)
        return self.psnr(out)

    def ours_at(self, psnr):
        """Least bytes of ours that are as near, within a hundredth."""
        low, high = 200, self.built["bytes"]
        if self.ours(high) < psnr:
            return None
        while high > 1.01 * low:
            middle = int(math.sqrt(low * high))
            low, high = (low, middle) if self.ours(middle) >= psnr else (middle, high)
        return high

    def reduced(self, faces):
        out = self.folder / "reduced.ply"
        command = self.reducer or f"{shlex.quote(str(self.program))} reduce {{in}} -o {{out}} --faces {{faces}}"
        text = command.format(**{"in": shlex.quote(str(self.path)), "out": shlex.quote(str(out)), "faces": faces})
        subprocess.run(text, shell=True, check=True, capture_output=True)
        return read_ply(out)


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("program", type=Path)
    a.add_argument("scans", type=Path, nargs="+")
    a.add_argument("-f", "--faces", type=int, nargs="+", default=[2000, 5000, 10000, 16000, 30000])
    a.add_argument("-l", "--levels", type=int)
    a.add_argument("--reduced")
    o = a.parse_args()
    print("| scan | rival | faces | bytes | bytes a source vertex | dB | yamanami, same bytes (dB) | yamanami, same dB (bytes) | ratio |")
    print("|---|---|---|---|---|---|---|---|---|")
    for path in o.scans:
        with tempfile.TemporaryDirectory() as folder:
            scan = Scan(o.program.resolve(), path.resolve(), Path(folder), o.levels, o.reduced)
            for faces in (f for f in o.faces if f <= scan.faces // 2):
                v, t = scan.reduced(faces)
                rivals = [(f"Draco, {bits} bits", *draco(v, t, bits)) for bits in BITS] + [("meshopt + zstd, 12 bits", *meshopt(v, t))]
                for name, size, rv, rt in rivals:
                    out = scan.folder / "rival.ply"
                    write_ply(out, rv, rt)
                    theirs = scan.psnr(out)
                    same_bytes, same_psnr = scan.ours(size), scan.ours_at(theirs)
                    shown = f"{same_psnr:,} | {same_psnr / size:.2f}" if same_psnr else "not reached | –"
                    print(f"| {path.stem} | {name} | {len(rt):,} | {size:,} | {size / scan.vertices:.3f} | {theirs:.2f} "
                          f"| {same_bytes:.2f} | {shown} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
