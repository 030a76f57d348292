#!/usr/bin/env python3
"""TINs: yamanami beside other reducers and greedy insertion: levels at equal counts, counts at equal error, sizes, flights.

    pip install numpy rasterio pydelatin meshoptimizer quantized-mesh-encoder
    bench/tin.py target/release/yamanami levels DEM.tif... [-t 41800]
    bench/tin.py target/release/yamanami errors DEM.tif... [-e 2 5 10 20 50]
    bench/tin.py target/release/yamanami sizes FILE...
    bench/tin.py target/release/yamanami fly DEM.tif... [--brute drawing_5x5.csv] [--budget 100000]

DEMs are grids without CRS and without no-data. Errors are vertical: between two TINs exact by `yamanami compare` (and once more
by the sampler here, which shares no code with it), of meshes against DEMs at every sample. Seconds are user CPU seconds of a whole call for
yamanami, of the call alone for the peers. `--brute` is a table that `yamanami reproduce hiraoka` writes; its first row is
scaled by triangles.
"""
import argparse, csv, gzip, io, json, math, os, subprocess, sys, tempfile, time
from pathlib import Path

import numpy as np

from reduce import read_ply, write_ply


class Program:
    """A call's JSON; afterwards its user CPU seconds and greatest resident memory."""

    def __init__(self, path):
        self.path, self.user_s, self.resident_mb = path, 0.0, 0.0

    def __call__(self, *words):
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            p = subprocess.Popen([self.path, *map(str, words), "--json"], stdout=out, stderr=err)
            _, p.returncode, used = os.wait4(p.pid, 0)
            out.seek(0), err.seek(0)
            if p.returncode:
                sys.exit(err.read().decode())
            self.user_s, self.resident_mb = used.ru_utime, used.ru_maxrss / 1024
            return json.loads(out.read())


def read_dem(path):
    import rasterio
    with rasterio.open(path) as f:
        return f.read(1).astype("f4"), f.transform


def greedy(dem, **limit):
    """Greedy insertion (hmm) on the grid: vertices in the DEM's coordinates, triangles, CPU seconds."""
    from pydelatin import Delatin
    z, place = dem
    started = time.process_time()
    d = Delatin(z, **limit)
    taken = time.process_time() - started
    v = np.asarray(d.vertices, "f8").reshape(-1, 3)
    column, row = v[:, 0].astype(int), v[:, 1].astype(int)
    if not np.array_equal(z[row, column], v[:, 2].astype("f4")):
        row = z.shape[0] - 1 - row
    x, y = place * (column + 0.5, row + 0.5)
    return np.stack([x, y, z[row, column].astype("f8")], 1), upward(np.asarray(d.triangles).reshape(-1, 3), x, y), taken


def plan_area(v, t):
    a, b, c = (v[t[:, k], :2] for k in range(3))
    u, w = b - a, c - a
    longest = np.max([((p - q) ** 2).sum(1) for p, q in ((a, b), (b, c), (c, a))], 0)
    return (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / 2, longest


def upward(t, x, y):
    """Triangles anticlockwise in plan where most of them are clockwise."""
    area, _ = plan_area(np.stack([x, y], 1), t)
    return t if np.median(area) > 0 else np.ascontiguousarray(t[:, ::-1])


def defects(v, t):
    """Triangles that face down in plan, and those without area there (their height less than 1e-9 of their longest edge)."""
    area, longest = plan_area(v, t)
    flat = np.abs(area) <= 5e-10 * longest
    return int(((area < 0) & ~flat).sum()), int(flat.sum())


def sampled(source, mesh, side=600):
    """RMS and greatest vertical distance at the points of a grid that avoids vertices; where a mesh folds over, of every layer."""
    low, high = source[0][:, :2].min(0), source[0][:, :2].max(0)
    axes = [low[k] + (high[k] - low[k]) * (np.arange(side) + 0.4142135) / side for k in range(2)]

    def layers(v, t):
        t = t[plan_area(v, t)[0] != 0]
        corner = v[t]
        first, last = (np.stack([np.searchsorted(axes[k], f(corner[:, :, k], 1)) for k in range(2)], 1) for f in (np.min, np.max))
        wide = last - first
        cells = wide.prod(1)
        of = np.repeat(np.arange(len(t)), cells)
        n = np.arange(len(of)) - np.repeat(np.cumsum(cells) - cells, cells)
        i, j = first[of, 0] + n % wide[of, 0], first[of, 1] + n // wide[of, 0]
        a, b, c = (corner[of, k] for k in range(3))
        x, y = axes[0][i] - a[:, 0], axes[1][j] - a[:, 1]
        ux, uy, wx, wy = b[:, 0] - a[:, 0], b[:, 1] - a[:, 1], c[:, 0] - a[:, 0], c[:, 1] - a[:, 1]
        whole = ux * wy - uy * wx
        s, r = (x * wy - y * wx) / whole, (ux * y - uy * x) / whole
        inside = (s >= 0) & (r >= 0) & (s + r <= 1)
        z = a[:, 2] + s * (b[:, 2] - a[:, 2]) + r * (c[:, 2] - a[:, 2])
        return (j * side + i)[inside], z[inside]

    at, z = layers(*source)
    truth = np.full(side * side, np.nan)
    truth[at] = z
    at, z = layers(*mesh)
    far = z - truth[at]
    far = far[np.isfinite(far)]
    return math.sqrt((far**2).mean()), np.abs(far).max()


def meshopt(v, t, triangles):
    """meshoptimizer's `simplify` with locked border, on positions about their centre (it calculates in 32 bits)."""
    import meshoptimizer as m
    p = np.ascontiguousarray(v - v.mean(0), "f4")
    out = np.empty(t.size, "u4")
    started = time.process_time()
    n = m.simplify(out, np.ascontiguousarray(t, "u4").ravel(), p, target_index_count=3 * triangles, target_error=1e9, options=m.SIMPLIFY_LOCK_BORDER)
    return v, out[:n].reshape(-1, 3).astype("i4"), time.process_time() - started


def used_only(v, t):
    kept, t = np.unique(t, return_inverse=True)
    return v[kept], t.reshape(-1, 3).astype("i4")


def error_for(count, made):
    """The error whose result has about `count` triangles, and that result."""
    low, high = 1e-3, 1e4
    for _ in range(24):
        mid = math.sqrt(low * high)
        n = made(mid)
        if abs(n - count) <= count / 2000:
            break
        low, high = (mid, high) if n > count else (low, mid)
    return mid, n


def levels(run, folder, args):
    print("| TIN | tool | 1/2: triangles | RMS | greatest | 1/4: triangles | RMS | greatest | 1/8: triangles | RMS | greatest | flipped, no area | CPU s | sampled |")
    print("|" + "---|" * 14)
    ways = {"yamanami": [], **{f"hiraoka, {r}": ["--method", "hiraoka", "--reading-of-cost", r] for r in ("plain", "sum", "once", "plane")}}
    for dem in args.files:
        source = folder / "source.ply"
        error, n = error_for(args.triangles, lambda e: run("tin", dem, "--error", e, "-o", source)["triangles"])
        name = f"{Path(dem).stem}, {n:,} ({error:.2f} m)"
        v, t = read_ply(source)
        counts = [(n + k - 1) // k for k in (2, 4, 8)]
        for tool in (*ways, "meshoptimizer", "greedy again (hmm)"):
            cells, bad, taken, check = [], [0, 0], 0.0, []
            for level, count in enumerate(counts, 1):
                out = folder / "out.ply"
                if tool in ways:
                    run("tin", source, "--levels", level, *ways[tool], "-o", out)
                    taken = run.user_s
                    result = read_ply(out)
                    counts[level - 1] = len(result[1]) if tool == "yamanami" else count
                else:
                    *result, s = meshopt(v, t, count) if tool == "meshoptimizer" else greedy(read_dem(dem), max_triangles=count)
                    taken, result = taken + s, used_only(*result)
                    write_ply(out, *result)
                far = run("compare", source, out)
                by_samples = sampled((v, t), result)
                check.append(f"{by_samples[0]:.2f} ({by_samples[1]:.1f})")
                found = defects(*result)
                bad = [a + b for a, b in zip(bad, found)]
                if "rms_vertical_m" in far:
                    cells += [f"{len(result[1]):,}", f"{far['rms_vertical_m']:.2f}", f"{far['max_vertical_m']:.1f}"]
                else:  # it folds over itself: no surface over the plan
                    cells += [f"{len(result[1]):,}", f"{by_samples[0]:.2f}*", f"{by_samples[1]:.1f}*"]
            print(f"| {name} | {tool} | {' | '.join(cells)} | {bad[0]}, {bad[1]} | {taken:.2f} | {', '.join(check)} |", flush=True)


def errors(run, folder, args):
    """Asked for E; then the fewest triangles found whose true error is within E; then errors at greedy insertion's number of triangles."""
    print("| DEM | E (m) | TIN database | true error | equal error | quadtree | true error | equal error | greedy (hmm) | greedy (ours) | TIN / hmm | quadtree / hmm | RMS (greatest) at hmm's number: TIN | quadtree | hmm |")
    print("|" + "---|" * 15)
    ratios = []
    for dem in args.files:
        stores = {"tin": folder / "tin.yama", "quadtree": folder / "grid.yama"}
        run("build", dem, "--tin", "-o", stores["tin"])
        run("build", dem, "-o", stores["quadtree"])
        mesh = folder / "m.ply"

        def true(path):
            far = run("compare", dem, path)
            return far["max_vertical_m"], f"{far['rms_vertical_m']:.2f} ({far['max_vertical_m']:.1f})"

        def within(store, tolerance):
            n = run("extract", store, "--tolerance", tolerance, "-o", mesh)["triangles"]
            return n, true(mesh)[0]

        for e in args.errors:
            v, t, _ = greedy(read_dem(dem), max_error=e)
            cells, equal, same = [], [], []
            for store in stores.values():
                n, far = within(store, e)
                cells += [f"{n:,}", f"{far:.2f}"]
                low, high = e, 4 * e
                for _ in range(7):
                    mid = math.sqrt(low * high)
                    m, far = within(store, mid)
                    low, high = (mid, high) if far <= e else (low, mid)
                    n = min(n, m) if far <= e else n
                cells.append(f"{n:,}")
                equal.append(n)
                run("extract", store, "--budget", len(t), "-o", mesh)
                same.append(true(mesh)[1])
            write_ply(mesh, *used_only(v, t))
            same.append(true(mesh)[1])
            ours = run("tin", dem, "--error", e, "-o", mesh)["triangles"]
            ratios.append([k / len(t) for k in equal])
            print(f"| {Path(dem).stem} | {e:g} | {' | '.join(cells)} | {len(t):,} | {ours:,} | {ratios[-1][0]:.2f} | {ratios[-1][1]:.2f} | {' | '.join(same)} |", flush=True)
    mean = np.exp(np.log(ratios).mean(0))
    print(f"\ngeometric means at equal true error: TIN / hmm {mean[0]:.2f}, quadtree / hmm {mean[1]:.2f}")


def quantized(v, t):
    """Bytes of quantized-mesh (positions in 16 bits of the tile, high-water-mark indices): one tile, whatever its size; loses the rest."""
    from quantized_mesh_encoder import encode
    buffer = io.BytesIO()
    low, high = v.min(0), v.max(0)
    degrees = (v - low) / 111_320
    degrees[:, 2] = v[:, 2]
    bounds = [0, 0, *degrees.max(0)[:2]]
    encode(buffer, np.ascontiguousarray(degrees, "f4"), np.ascontiguousarray(t, "u4"), bounds=bounds, sphere_method="naive")
    return buffer.getvalue()


def sizes(run, folder, args):
    print("| TIN | faces | source | source, gzip -9 | .yama, all levels | .yama a face | GLB | GLB, gzip | quantized-mesh, 16 bits, gzip |")
    print("|" + "---|" * 9)
    for path in map(Path, args.files):
        raw = path.read_bytes()
        plain = gzip.decompress(raw) if path.suffix == ".gz" else raw
        grid = ["--tin"] if path.suffix == ".tif" else []
        built = run("build", path, *grid, "-o", folder / "s.yama")
        n, stored = built["faces"], built["bytes"]
        run("extract", folder / "s.yama", "--tolerance", 0, "-o", folder / "s.glb")
        run("extract", folder / "s.yama", "--tolerance", 0, "-o", folder / "s.ply")
        glb = (folder / "s.glb").read_bytes()
        a = lambda data: f"{data / n:.2f}"
        tile = quantized(*read_ply(folder / "s.ply"))
        print(
            f"| {path.name} | {n:,} | {a(len(plain))} | {a(len(gzip.compress(plain, 9)))} | {stored:,} bytes | {a(stored)} |"
            f" {a(len(glb))} | {a(len(gzip.compress(glb, 9)))} | {a(len(gzip.compress(tile, 9)))} |", flush=True
        )


def fly(run, folder, args):
    brute_ns = None
    if args.brute:
        rows = list(csv.DictReader(open(args.brute)))
        brute_ns = float(rows[0]["median_ms"]) * 1e6 / args.brute_triangles
    print("| TIN | triangles | build, CPU s | resident (MB) | file (MB) | flight: median ms | mean | worst after the first | first | CPU s, all frames | resident (MB) | kB a frame | most triangles | brute force, scaled (ms) |")
    print("|" + "---|" * 14)
    for dem in args.files:
        store = folder / "s.yama"
        built = run("build", dem, "--tin", "-o", store)
        build_s, build_mb = run.user_s, run.resident_mb
        f = run("fly", store, "--budget", args.budget, "--no-draw")
        frames = f["frames"]
        ms = [k["update_ms"] for k in frames]
        brute = f"{brute_ns * built['faces'] / 1e6:.0f}" if brute_ns else ""
        print(
            f"| {Path(dem).stem} | {built['faces']:,} | {build_s:.1f} | {build_mb:.0f} | {built['bytes'] / 1e6:.1f} | {np.median(ms[1:]):.3f} | {np.mean(ms[1:]):.3f} |"
            f" {max(ms[1:]):.2f} | {ms[0]:.1f} | {run.user_s:.2f} ({len(frames)} frames) | {run.resident_mb:.0f} | {np.mean([k['upload_bytes'] for k in frames[1:]]) / 1e3:.1f} |"
            f" {max(k['triangles'] for k in frames):,} | {brute} |", flush=True
        )


def main():
    a = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    a.add_argument("yamanami")
    a.add_argument("what", choices=["levels", "errors", "sizes", "fly"])
    a.add_argument("files", nargs="+")
    a.add_argument("-t", "--triangles", type=int, default=41_800)
    a.add_argument("-e", "--errors", nargs="+", type=float, default=[2, 5, 10, 20, 50])
    a.add_argument("--budget", type=int, default=100_000)
    a.add_argument("--brute")
    a.add_argument("--brute-triangles", type=int, default=1_044_950)
    args = a.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        {"levels": levels, "errors": errors, "sizes": sizes, "fly": fly}[args.what](Program(args.yamanami), Path(folder), args)


if __name__ == "__main__":
    main()
