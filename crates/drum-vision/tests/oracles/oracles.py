"""Freezes what SciPy and scikit-image make of a small picture: oracles.json, read by tests/it/oracles.rs.

    python3 oracles.py          # numpy, scipy, scikit-image
"""

import json

import numpy as np
import scipy
import skimage
from scipy import ndimage, signal
from skimage import color, exposure, filters, measure, transform

W, H = 40, 32


def picture():
    """An edge across the picture, with pseudo-random grains; integer arithmetic, so that any language gets the same."""
    y, x = np.mgrid[0:H, 0:W]
    noise = ((x * 7919 + y * 104729 + x * y * 31) % 97) - 48
    base = np.where(3 * x + 5 * y > 150, 170, 60)
    return np.clip(base + noise // 2, 0, 255).astype(np.uint8)


def disc(w, h, cx, cy, r, inside, outside):
    """A disc with edges one pixel wide."""
    y, x = np.mgrid[0:h, 0:w]
    share = np.clip(r + 0.5 - np.hypot(x - cx, y - cy), 0, 1)
    return outside + (inside - outside) * share


def main():
    img = picture()
    out = {"numpy": np.__version__, "scipy": scipy.__version__, "skimage": skimage.__version__}
    out["picture"] = img.ravel().tolist()
    for size in [(3, 3), (5, 5), (10, 10), (4, 7)]:  # rows, columns
        filtered = ndimage.median_filter(img, size=size, mode="reflect")
        out[f"median_{size[1]}x{size[0]}"] = filtered.ravel().tolist()
    mask = (img > 120).astype(np.uint8)
    out["binary_median_10"] = ndimage.median_filter(mask, size=10, mode="reflect").ravel().tolist()
    f = img.astype(float)
    out["wiener_5"] = np.round(signal.wiener(f, 5), 6).ravel().tolist()
    out["wiener_7_noise_300"] = np.round(signal.wiener(f, 7, noise=300.0), 6).ravel().tolist()
    out["otsu"] = int(filters.threshold_otsu(img))
    lo, hi = (int(np.percentile(img, p, method="inverted_cdf")) for p in (1, 99))
    out["stretch_limits"] = [lo, hi]
    stretched = exposure.rescale_intensity(f, in_range=(lo, hi), out_range=(0.0, 255.0))
    out["stretched"] = np.round(stretched, 6).ravel().tolist()
    local = filters.threshold_local(f, block_size=9, method="mean", mode="reflect")
    out["local_mean_9"] = np.round(local, 6).ravel().tolist()
    out["sobel_h"] = np.round(filters.sobel_h(f)[1:-1, 1:-1], 6).ravel().tolist()
    out["sobel_v"] = np.round(filters.sobel_v(f)[1:-1, 1:-1], 6).ravel().tolist()
    rgb = np.stack([img, 255 - img, np.roll(img, 3, 1)], -1)
    # rgb2gray has the weights of ITU-R BT.709; those of MATLAB's rgb2gray (BT.601) are the Y of rgb2yuv.
    out["luma"] = np.round(255 * color.rgb2yuv(rgb)[..., 0], 6).ravel().tolist()
    labels = measure.regionprops(np.asarray(mask, dtype=int))
    cy, cx = labels[0].centroid
    out["centroid"] = [float(cx), float(cy), float(labels[0].area)]
    # Polygon of a bed: area and centroid of its filled picture, at a fine scale.
    poly = np.array([[10.0, 80.0], [60.0, 20.0], [110.0, 35.0], [95.0, 105.0], [40.0, 118.0]])
    fine = 16
    filled = measure.grid_points_in_poly((130 * fine, 130 * fine), poly * fine)
    region = measure.regionprops(filled.astype(int))[0]
    out["polygon"] = poly.ravel().tolist()
    out["polygon_area_centroid"] = [
        float(region.area) / fine**2,
        float(region.centroid[0]) / fine,
        float(region.centroid[1]) / fine,
    ]
    d = disc(120, 100, 57.3, 48.8, 33.4, 40.0, 200.0)
    edges = np.hypot(filters.sobel_h(d), filters.sobel_v(d)) > 20
    radii = np.arange(20, 46)
    space = transform.hough_circle(edges, radii)
    _, hx, hy, hr = transform.hough_circle_peaks(space, radii, total_num_peaks=1)
    out["hough"] = [int(hx[0]), int(hy[0]), int(hr[0])]
    points = np.argwhere(edges)[:, ::-1].astype(float)
    if hasattr(measure.CircleModel, "from_estimate"):
        model = measure.CircleModel.from_estimate(points)
        out["circle_fit"] = [float(model.center[0]), float(model.center[1]), float(model.radius)]
    else:
        model = measure.CircleModel()
        model.estimate(points)
        out["circle_fit"] = [float(v) for v in model.params]
    out["edge_points"] = points.ravel().astype(int).tolist()
    with open("oracles.json", "w") as file:
        json.dump(out, file, separators=(",", ":"))
        file.write("\n")


if __name__ == "__main__":
    main()
