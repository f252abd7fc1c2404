"""Times the chain of `examples/speed.rs` in scikit-image and SciPy on the same folder, then the example itself.

    python3 speed.py FOLDER PATH_TO_EXAMPLE_BINARY [THREADS]

Both use the same number of processes or threads. The chain here: decode, red mask, median of the mask, circular
Hough transform over the same radii on the same reduced mask, luma, median and Wiener filter of the drum's square (windows
of 5 pixels), stretch, Otsu, column transitions, spline, two line fits, centroid. It stays simpler than the
Rust chain: whole pixels, no robust fits, no uncertainties.
"""

import glob
import os
import subprocess
import sys
import time
from multiprocessing import Pool

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np
from scipy import interpolate, ndimage, signal
from skimage import exposure, feature, filters, io, measure, transform


def chain(path):
    img = io.imread(path)
    h, w = img.shape[:2]
    red = (img[..., 0] > 100) & (img[..., 1] < 100) & (img[..., 2] < 100)
    mask = ndimage.median_filter(red.astype(np.uint8), size=13, mode="reflect")
    lo, hi = 0.2 * min(w, h), 0.55 * min(w, h)
    k = max(1, round(hi / 110))
    small = transform.downscale_local_mean(mask * 255.0, (k, k))
    edges = feature.canny(small / 255.0, sigma=1)
    radii = np.arange(int(lo / k), int(hi / k) + 1)
    space = transform.hough_circle(edges, radii)
    _, cx, cy, r = transform.hough_circle_peaks(space, radii, total_num_peaks=1)
    cx, cy, r = cx[0] * k + (k - 1) / 2, cy[0] * k + (k - 1) / 2, r[0] * k
    x0, y0 = max(0, int(cx - 1.02 * r)), max(0, int(cy - 1.02 * r))
    window = img[y0 : int(cy + 1.02 * r) + 1, x0 : int(cx + 1.02 * r) + 1].astype(float)
    grey = window @ [0.299, 0.587, 0.114]
    grey = ndimage.median_filter(np.round(grey).astype(np.uint8), size=5, mode="reflect").astype(float)
    with np.errstate(all="ignore"):
        grey = signal.wiener(grey, 5)
    y, x = np.mgrid[0 : grey.shape[0], 0 : grey.shape[1]]
    rho = np.hypot(x - (cx - x0), y - (cy - y0))
    interior = (rho < 0.97 * r) & (rho > r / 7)
    limits = np.percentile(grey[interior], (1, 99))
    grey = exposure.rescale_intensity(grey, in_range=tuple(limits), out_range=(0, 255))
    bed = (grey > filters.threshold_otsu(grey[interior])) & interior
    bed = ndimage.median_filter(bed.astype(np.uint8), size=9)
    xs, ys = [], []
    for column in range(bed.shape[1]):
        jumps = np.flatnonzero(np.diff(bed[:, column]))
        if len(jumps) in (2, 4, 6):
            xs.append(column)
            ys.append(jumps[len(jumps) - 2] + 0.5)
    xs, ys = np.array(xs, float), np.array(ys, float)
    inside = np.hypot(xs - (cx - x0), ys - (cy - y0)) < 0.97 * r - 3
    xs, ys = xs[inside], ys[inside]
    spline = interpolate.UnivariateSpline(xs, ys, s=len(xs))
    fine = np.linspace(xs[0], xs[-1], 2 * len(xs))
    height = -spline(fine)
    n = len(fine)
    lin = np.degrees(np.arctan(np.polyfit(fine, height, 1)[0]))
    mid = np.degrees(np.arctan(np.polyfit(fine[n // 4 : 3 * n // 4], height[n // 4 : 3 * n // 4], 1)[0]))
    centre = measure.regionprops(bed.astype(int))[0].centroid
    return lin, mid, 100 * (centre[1] + x0 - cx) / r, 100 * (centre[0] + y0 - cy) / r


def main():
    folder, binary = sys.argv[1:3]
    threads = int(sys.argv[3]) if len(sys.argv) > 3 else 2
    subprocess.run([binary, folder], check=True, capture_output=True)  # films the frames when there are none
    frames = sorted(glob.glob(os.path.join(folder, "*.jpg")))
    with Pool(threads) as pool:
        pool.map(chain, frames[:threads])  # imports and caches warm
        start = time.perf_counter()
        result = np.array(pool.map(chain, frames, chunksize=1))
        theirs = time.perf_counter() - start
    print(f"scikit-image: {len(frames)} frames in {theirs:.2f} s with {threads} processes; mean {result.mean(0).round(2)}")
    env = dict(os.environ, RAYON_NUM_THREADS=str(threads))
    start = time.perf_counter()
    out = subprocess.run([binary, folder], check=True, capture_output=True, text=True, env=env).stdout
    ours = time.perf_counter() - start
    print(out.strip())
    print(f"this crate: {ours:.2f} s with start-up; {theirs / ours:.1f} times faster")


if __name__ == "__main__":
    main()
