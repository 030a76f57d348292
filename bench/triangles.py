#!/usr/bin/env python3
"""Triangles at a promised error: yamanami beside MARTINI and greedy insertion (hmm), in one interleaved run.

    pip install numpy rasterio pymartini pydelatin
    bench/triangles.py target/release/yamanami DEM.tif... [-e 5 10 20 50]

Every mesh is checked by `yamanami compare`: the greatest vertical distance of any sample. MARTINI's E is no bound, so its
parameter is searched for the fewest triangles whose real error is within E ("equal"). It needs 2^k + 1 squares: of other grids
the upper left square is cut, for all three tools alike, and no-data is filled with the lowest height.
"""
import argparse, json, math, subprocess, sys, tempfile
from pathlib import Path

import numpy as np
import rasterio
from pydelatin import Delatin
from pymartini import Martini


def write_ply(path, xyz, triangles):
    v = np.asarray(xyz, dtype="<f8")
    t = np.empty(len(triangles), dtype=[("n", "u1"), ("i", "<i4", 3)])
    t["n"], t["i"] = 3, np.asarray(triangles)
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(v)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(t)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + v.tobytes() + t.tobytes())


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("yamanami")
    a.add_argument("dems", nargs="+")
    a.add_argument("-e", "--errors", nargs="+", type=float, default=[5, 10, 20, 50])
    args = a.parse_args()
    ratios_martini, ratios_greedy = [], []
    print("| DEM | E (m) | yamanami | real error | MARTINI, equal error | ours / MARTINI | greedy (hmm) | ours / greedy |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for dem in args.dems:
            with rasterio.open(dem) as f:
                z = f.read(1).astype("float32")
                if f.nodata is not None:
                    z[z == f.nodata] = np.nan
            z[~np.isfinite(z)] = np.nanmin(z)
            side = 2 ** int(math.log2(min(z.shape) - 1)) + 1
            z = np.ascontiguousarray(z[:side, :side])
            tif = folder / "dem.tif"
            with rasterio.open(tif, "w", driver="GTiff", width=side, height=side, count=1, dtype="float32") as f:
                f.write(z, 1)

            def run(*words):
                p = subprocess.run([args.yamanami, *map(str, words)], capture_output=True, text=True)
                if p.returncode:
                    sys.exit(p.stderr)
                return json.loads(p.stdout)

            def real_error(xy, heights, triangles):
                # a grid without CRS: one metre a sample, lower left sample at the origin, source frame
                write_ply(folder / "m.ply", np.column_stack([xy[:, 0], side - 1 - xy[:, 1], heights]), triangles)
                return run("compare", tif, folder / "m.ply", "--json")["max_vertical_m"]

            martini = Martini(side).create_tile(z)

            def of_martini(e):
                v, t = martini.get_mesh(e)
                v = np.asarray(v).reshape(-1, 2).astype(int)
                return v, z[v[:, 1], v[:, 0]], np.asarray(t).reshape(-1, 3)

            for e in args.errors:
                ours = run("extract", tif, "--tolerance", e, "--check", "--json", "-o", folder / "ours.ply")
                low, high = 0.0, e
                for _ in range(9):
                    mid = (low + high) / 2
                    low, high = (mid, high) if real_error(*of_martini(mid)) <= e else (low, mid)
                equal = len(of_martini(low)[2])
                greedy = Delatin(z, max_error=e)
                ratios_martini.append(ours["triangles"] / equal)
                ratios_greedy.append(ours["triangles"] / len(greedy.triangles))
                print(
                    f"| {Path(dem).stem} {side}² | {e:g} | {ours['triangles']:,} | {ours['check']['max_vertical_m']:.2f} | {equal:,} |"
                    f" {ratios_martini[-1]:.2f} | {len(greedy.triangles):,} | {ratios_greedy[-1]:.2f} |",
                    flush=True,
                )
    mean = lambda r: math.exp(sum(map(math.log, r)) / len(r))
    print(f"\ngeometric mean: ours / MARTINI {mean(ratios_martini):.2f}, ours / greedy {mean(ratios_greedy):.2f}")


if __name__ == "__main__":
    main()
