"""A client that reads wind and bend, after server/docs/protocol.md. Prints both every second: python prairie.py [URL [X Z]]"""
import bisect, io, itertools, json, math, struct, sys, time
from pathlib import Path
import numpy as np
from websockets.sync.client import connect
LAYOUT = json.loads((Path(__file__).resolve().parents[2] / "docs/protocol.json").read_text())

def varint(data):
    byte = data.read(1)[0]
    return byte if byte < 128 else byte & 127 | varint(data) << 7
def read(layout, data):  # the next value of an io.BytesIO, of the shape that it has in JSON; byte strings are bytes
    match layout:
        case "BOOL" | "U8": return data.read(1)[0]
        case "U16" | "U32" | "U64": return varint(data)
        case "I16" | "I32": return (code := varint(data)) >> 1 ^ -(code & 1)
        case "F32" | "F64": return struct.unpack({"F32": "<f", "F64": "<d"}[layout], data.read(int(layout[1:]) // 8))[0]
        case "STR" | "BYTES": return data.read(varint(data)).decode() if layout == "STR" else data.read(varint(data))
        case {"OPTION": inner}: return read(inner, data) if data.read(1)[0] else None
        case {"SEQ": inner}: return [read(inner, data) for _ in range(varint(data))]
        case {"TUPLEARRAY": {"CONTENT": inner, "SIZE": size}}: return [read(inner, data) for _ in range(size)]
        case {"TUPLE": parts}: return [read(part, data) for part in parts]
        case {"STRUCT": fields}: return {name: read(part, data) for field in fields for name, part in field.items()}
        case {"NEWTYPE": inner}: return read(inner, data)
        case {"TYPENAME": name}: return read(LAYOUT["types"][name], data)
        case {"ENUM": variants}:
            (name, variant), = variants[str(varint(data))].items()
            return name if variant == "UNIT" else {name: read(variant, data)}
    raise ValueError(f"unknown layout {layout}")
def decode(message, layout="ServerMessage"):
    assert message[0] == LAYOUT["protocol"], f"version {message[0]} of the protocol instead of {LAYOUT['protocol']}"
    return read({"TYPENAME": layout}, io.BytesIO(message[1:]))
def number(n): return bytes([n]) if n < 128 else bytes([n & 127 | 128]) + number(n >> 7)
def encode(variant, *parts): return bytes([LAYOUT["protocol"], variant]) + b"".join(parts)

def decode_grid(base, payload):  # the grid (int16: plane, row, column) whose differences from `base` are in the payload
    (planes, rows, width), codes, data = base.shape, base.astype(int), iter(payload + bytes(4))
    low, high, value = 0, 0xffffffff, int.from_bytes(bytes(next(data) for _ in range(4)), "big")
    chances, seen, stride = [32768] * 649, [0] * 649, width + 1
    def bit(context):
        nonlocal low, high, value
        chance, rate = chances[context], 655360 // (10 * min(seen[context], 47) + 16)
        middle = low + ((high - low) * min(max(chance, 48), 65488) >> 16)
        low, high = (low, middle) if (is_set := value <= middle) else (middle + 1, high)
        chances[context] += (65535 - chance) * rate >> 16 if is_set else -(chance * rate >> 16)
        seen[context] += 1
        while low >> 24 == high >> 24:
            low, high, value = ((n << 8 | new) & 0xffffffff for n, new in ((low, 0), (high, 255), (value, next(data))))
        return is_set
    for plane, kind in zip(range(planes), (0, 1, 1, 2)):
        differences, residuals = ([0] * (stride * (rows + 1)) for _ in range(2))  # below a row, right of a column of zeros
        for y, x in itertools.product(range(0, rows, 8), range(0, width, 8)):
            lines, columns = range((y + 1) * stride, (min(y + 8, rows) + 1) * stride, stride), range(x + 1, min(x + 8, width) + 1)
            borders = any(residuals[line + x] for line in lines) + any(residuals[y * stride + column] for column in columns)
            if not bit(3 * kind + borders): continue
            predicted = bit(9 + kind)
            for at in (line + column for line in lines for column in columns):
                left, above, corner = residuals[at - 1], residuals[at - stride], residuals[at - stride - 1]
                size, residual, length = bisect.bisect((1, 3, 5, 10, 25), 2 * (abs(left) + abs(above)) + abs(corner)), 0, 0
                if not bit(12 + 12 * kind + 6 * predicted + size):
                    sign = -1 if bit(49 + 3 * predicted + (left + above > 0) - (left + above < 0)) else 1
                    while length < 16 and bit(54 + 102 * kind + 17 * size + length): length += 1
                    magnitude = sum(bit(360 + 17 * length + place) << place for place in reversed(range(length))) + (1 << length)
                    residuals[at] = residual = sign * magnitude
                left, above, corner = differences[at - 1], differences[at - stride], differences[at - stride - 1]
                differences[at] = residual + predicted * sorted((left, above, left + above - corner))[1]
        codes[plane] += np.reshape(differences, (rows + 1, stride))[1:, 1:]
    return codes.astype(np.int16)

def around(at, spacing):  # the two cells whose centres are around a coordinate, with their shares
    low = math.floor(at / spacing - 0.5)
    return (low, low + 1.5 - at / spacing), (low + 1, at / spacing - 0.5 - low)

class Prairie:  # the newest fields at places in metres: X, height above the ground, Z
    def __init__(self, scene):
        self.wind, self.patches, self.seed = scene["wind"], scene["patches"], (scene["seed"] ^ scene["seed"] >> 32) & 0xffffffff
        (nx, ny, nz), cells, planes = self.wind["cells"], self.patches["cells"], 4 if self.wind["dust"]["release_per_s"] > 0 else 3
        self.rest, self.grids = np.zeros((3 + (scene.get("snow", {}).get("depth_m", 0) > 0), cells, cells), np.int16), {"wind": (0, np.zeros((planes, nz * ny, nx), np.int16))}
        self.steps, self.state, self.waves = scene["stream"], dict(travel_m=[0, 0], path_m=0, friction_m_per_s=0), self.make_waves()
    def update(self, body):  # takes in a Patch or a Wind
        index, self.state = body.get("patch", "wind"), body.get("turbulence", self.state)
        seq, codes = self.grids.get(index, (0, self.rest))
        assert body["key"] or body["seq"] == seq + 1, "a delta applies to the previous frame"
        self.grids[index] = body["seq"], decode_grid(codes * (not body["key"]), body["payload"]) if body["payload"] else 0 * codes
    def make_waves(self):  # vectors (turns/m, X + iZ), phases (turns), turnovers (turns/m) and strength of the gusts
        n, longest, mean = np.arange(24), 7 * max(self.wind["spacing_m"][::2]), complex(*self.wind["mean_m_per_s"]) or 1
        logs = np.linspace(math.log(math.tau / max(longest, 4.01)), math.log(math.tau / 4), 401)
        x = np.exp(logs) * 63.1 / 0.746834
        density = 0.968508 * x**5 * (1 + x * x) ** (-17 / 6)
        energy = np.cumsum(np.append(0, (density[1:] + density[:-1]) / 2 * (logs[1] - logs[0])))
        z = self.seed + np.arange(1, 98, dtype=np.uint64) * 0x9e3779b97f4a7c15
        for shift, factor in (30, 0xbf58476d1ce4e5b9), (27, 0x94d049bb133111eb), (31, 1): z = (z ^ z >> shift) * factor
        nth, turn, phase, way = (z[1:] >> 11).reshape(24, 4).T / 2**53
        k = np.exp(np.interp((n + nth) / 24 * energy[-1], energy, logs))
        angle = ((int(z[0] % 24) + 7 * n) % 24 + turn) / 24 * math.pi
        toward = (np.cos(angle) + 1j * (2.39 / 1.92) ** 2 * np.sin(angle)) * mean
        strength = self.wind["turbulence"] * (longest > 4) * math.sqrt((2.39**2 + 1.92**2) * energy[-1] / 12)
        return toward / abs(toward) * k / math.tau, phase, np.cbrt(k * k / 4) / math.tau * np.where(way < 0.5, 1, -1), strength
    def gust_at(self, x, z):  # gust (m/s) along X and Z
        (waves, phase, turnover, strength), travel = self.waves, complex(*self.state["travel_m"])
        phase = (phase + turnover * self.state["path_m"] - (waves * travel.conjugate()).real) % 1
        east, south, phase, x, z = (np.float32(part) for part in (waves.real, waves.imag, phase, x, z))
        speed = strength * self.state["friction_m_per_s"] / abs(waves) * np.cos(math.tau * np.float64(east * x + south * z + phase))
        return np.array([-(south * speed).sum(), (east * speed).sum()])
    def taps(self, x, z):  # places in the wind's box, with their shares
        side, (dx, _, dz), (nx, _, nz) = self.patches["cells"] * self.patches["cell_m"], self.wind["spacing_m"], self.wind["cells"]
        if self.wind["tiling"] != "patch": return [(x, z, 1)]
        (i, u), (j, v) = ((n := around(at, side)[0][0], min(max((at - (n + 1) * side) / d + 0.5, 0), 1)) for at, d in ((x, dx), (z, dz)))
        a, b, c = np.array([(i + m, j + n, self.seed) for m in (0, 1) for n in (0, 1)]).T.astype(np.uint32) * 1664525 + 1013904223
        for step in range(6):
            a, b, c = b, c, a + b * c
            if step == 2: a, b, c = (part ^ part >> 16 for part in (a, b, c))
        return zip(x + (a >> 8) % nx * dx, z + (b >> 8) % nz * dz, ((1 - u) * (1 - v), (1 - u) * v, u * (1 - v), u * v))
    def resolved_at(self, x, above, z):  # the solver's wind (m/s) along X, Y and Z
        counts, faces, total = self.wind["cells"], self.wind["faces"], np.zeros(3)
        wraps = [faces["west"] == faces["east"] == "wrap", False, faces["north"] == faces["south"] == "wrap"]
        for tap_x, tap_z, share in self.taps(x, z):
            for corner in itertools.product(*map(around, (tap_x, above, tap_z), self.wind["spacing_m"])):
                i, j, k = (n % nx if wrap else min(max(n, 0), nx - 1) for (n, _), nx, wrap in zip(corner, counts, wraps))
                total += share * math.prod(part for _, part in corner) * self.grids["wind"][1][:3, j + counts[1] * k, i]
        return total * 2 * self.steps["wind_error_m_per_s"]
    def wind_at(self, x, above, z):  # wind (m/s) along X, Y and Z
        return (self.resolved_at(x, above, z) + np.insert(self.gust_at(x, z), 1, 0)) * min(max(above / 2, 0.02), 1) ** 0.25
    def bend_at(self, x, z):  # lean (rad) along X and Z of the bend field, relative to the lean in the wind
        total, cells, (nx, nz) = np.zeros(2), self.patches["cells"], self.patches["count"]
        for (i, u), (j, v) in itertools.product(*(around(at, self.patches["cell_m"]) for at in (x, z))):
            index = i // cells + j // cells * nx if 0 <= i < nx * cells and 0 <= j < nz * cells else None
            theta, *omega = map(float, self.grids.get(index, (0, self.rest))[1][:, j % cells, i % cells])
            omega = np.array(omega) * np.abs(omega)
            total += u * v * math.radians(2 * self.steps["theta_error_deg"]) * theta * omega / (math.hypot(*omega) or 1)
        return total

def frames(url, eye_m, radius_m=64, name="python"):  # connects; after each frame yields the newest fields and the FrameEnd
    with connect(url, max_size=96 << 20, compression=None, proxy=None) as socket:
        socket.send(encode(0, number(len(name.encode())), name.encode()))
        for (kind, body), in (decode(message).items() for message in socket):
            if kind == "Scene":
                prairie = Prairie(body["scene"])
                socket.send(encode(1, struct.pack("<4f", *eye_m, radius_m)))
            if kind in ("Wind", "Patch"): prairie.update(body)
            if kind == "FrameEnd":
                socket.send(encode(4, number(body["frame"])))
                yield prairie, body

if __name__ == "__main__":
    url, *place = sys.argv[1:] or ["ws://127.0.0.1:8080/ws"]
    x, z, due = *map(float, place or (128, 128)), 0
    for prairie, frame in frames(url, (x, 2, z)):
        if time.monotonic() < due: continue
        print(f"{frame['time_secs']:.1f} s: wind {prairie.wind_at(x, 2, z).round(2)} m/s, bend {prairie.bend_at(x, z).round(3)} rad", flush=True)
        due = time.monotonic() + 1
