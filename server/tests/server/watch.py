"""Prints the fields that the example client holds after each frame, a line of JSON each: python watch.py URL FRAMES X Z RADIUS"""
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples/python"))
import prairie

url, count = sys.argv[1], int(sys.argv[2])
x, z, radius_m = map(float, sys.argv[3:])
printed = {}
for fields, frame in prairie.frames(url, (x, 2, z), radius_m):
    new = {index: held for index, held in fields.grids.items() if held[0] not in (0, printed.get(index))}
    printed.update((index, seq) for index, (seq, _) in new.items())
    seen = {
        "grids": {index: [seq, codes.astype(">i2").tobytes().hex()] for index, (seq, codes) in new.items()},
        "wind_seq": fields.grids["wind"][0],
        "wind_m_per_s": fields.wind_at(x, 2, z).tolist(),
    }
    print(json.dumps(seen), flush=True)
    if frame["frame"] >= count:
        break
