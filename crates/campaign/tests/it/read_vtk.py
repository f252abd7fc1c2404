"""Reads particles and contacts in both encodings with meshio and compares them."""
import sys
from pathlib import Path

import meshio
import numpy as np

folder = Path(sys.argv[1])
text, coded = (meshio.read(folder / f"p_{kind}.vtu") for kind in ("text", "base64"))
assert np.array_equal(text.points, coded.points)
expected = {"radius": 1, "velocity": 3, "spin": 3, "force": 3, "mass": 1, "coordination": 1,
            "wall_contacts": 1, "particle": 1}
for name, width in expected.items():
    a, b = text.point_data[name], coded.point_data[name]
    assert np.array_equal(a, b), name
    assert a.shape == ((len(text.points),) if width == 1 else (len(text.points), width)), name
assert [c.type for c in text.cells] == ["vertex"]
lines, coded_lines = (meshio.read(folder / f"c_{kind}.vtu") for kind in ("text", "base64"))
assert np.array_equal(lines.points, coded_lines.points)
for name in ("force", "force_magnitude", "particle", "other"):
    assert np.array_equal(lines.cell_data[name][0], coded_lines.cell_data[name][0]), name
assert all(c.type == "line" for c in lines.cells)
size = np.linalg.norm(lines.cell_data["force"][0], axis=1)
assert len(size) > 0 and np.allclose(size, lines.cell_data["force_magnitude"][0], rtol=1e-12, atol=0)
print("particles", len(text.points))
print("contacts", len(lines.points) // 2)
print("sum_x", repr(float(text.points[:, 0].sum())))
