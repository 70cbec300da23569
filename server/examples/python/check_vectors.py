"""Checks prairie.py against server/docs/protocol-vectors.json; the exit status is 1 if anything differs."""
import json
import math
import sys
from pathlib import Path

import numpy as np

import prairie

VECTORS = json.loads((Path(__file__).resolve().parents[2] / "docs/protocol-vectors.json").read_text())
SPEED_M_PER_S, LEAN_RAD = 1e-4, 1e-5
# The steps of a scene with the default errors.
STEPS = {
    "theta_rad": np.float32(0.5) * np.float32(2 * math.pi / 180),
    "omega_rad_per_s": np.float32(0.07),
    "wind_m_per_s": np.float32(0.25),
    "dust": np.float32(0.03),
}

compared, differences = 0, []


def check(name, found, wanted, within=0.0):
    """Notes a difference of two values, or arrays, of more than `within`."""
    global compared
    compared += 1
    is_equal = found == wanted if within == 0.0 else np.shape(found) == np.shape(wanted) and np.all(np.abs(np.subtract(found, wanted)) <= within)
    if not is_equal:
        differences.append(f"{name}: {str(found)[:200]} instead of {str(wanted)[:200]}")


def plain(value):
    """A decoded value as it is in JSON: bytes are lists."""
    if isinstance(value, dict):
        return {name: plain(part) for name, part in value.items()}
    return [plain(part) for part in value] if isinstance(value, (list, bytes)) else value


def grid(text, planes, width):
    return np.frombuffer(bytes.fromhex(text), ">i2").reshape(planes, -1, width)


def check_messages():
    for number, vector in enumerate(VECTORS["messages"]):
        message = bytes.fromhex(vector["bytes"])
        check(f"message {number}", plain(prairie.decode(message, vector["layout"])), vector["value"])
        # The messages that the client sends.
        match vector["value"]:
            case {"Ack": {"frame": frame}}:
                check(f"message {number}, encoded", prairie.encode(4, prairie.number(frame)), message)
            case {"Hello": {"name": name}}:
                check(f"message {number}, encoded", prairie.encode(0, prairie.number(len(name.encode())), name.encode()), message)


def check_grids():
    for vector in VECTORS["grids"]:
        codes = grid(vector["codes"], vector["planes"], vector["width"])
        base = grid(vector["base"], vector["planes"], vector["width"]) if vector["base"] else np.zeros_like(codes)
        check(vector["name"], prairie.decode_grid(base, bytes.fromhex(vector["payload"])).tolist(), codes.tolist())


def code(quantity, value):
    """The formulas of the page, in single precision."""
    value = max(np.float32(value), np.float32(0)) if quantity == "dust" else np.float32(value)
    if quantity in ("omega_rad_per_s", "dust"):
        value = np.copysign(np.sqrt(np.abs(value)), value)
    return int(np.rint(np.clip(value * (np.float32(1) / STEPS[quantity]), -32767, 32767)))


def value(quantity, code):
    steps = code * float(STEPS[quantity])
    match quantity:
        case "omega_rad_per_s":
            return steps * abs(steps)
        case "dust":
            return max(steps, 0) ** 2
        case _:
            return steps


def check_quantisation():
    for table in VECTORS["quantisation"]:
        quantity = table["quantity"]
        for given, wanted_code, wanted in table["rows"]:
            name = f"{quantity} of {given}"
            if quantity == "heading_rad":
                check(f"{name}, code", round(math.atan2(given[1], given[0]) * 255 / math.tau) % 255 or 255, wanted_code)
                check(name, wanted_code * math.tau / 255, wanted, 1e-6)
            else:
                check(f"{name}, code", code(quantity, given), wanted_code)
                check(name, value(quantity, wanted_code), wanted, 1e-5)


def lean(fields, x, z, bend_rad):
    """Lean of the grass (rad) along X and Z in the wind alone."""
    wind = fields.resolved_at(x, 0, z)[[0, 2]] + fields.gust_at(x, z)
    speed = math.hypot(*wind)
    return wind * bend_rad * (min(speed, 10) / 10) ** 2 / max(speed, 1e-3)


def check_winds():
    for vector in VECTORS["winds"]:
        fields = prairie.Prairie(vector["scene"])
        planes, _, width = fields.grids["wind"][1].shape
        fields.grids["wind"] = 1, grid(vector["codes"], planes, width)
        fields.state = vector["turbulence"]
        for sample in vector["samples"]:
            x, above, z = sample["at_m"]
            name = f"{vector['name']} at {sample['at_m']}"
            check(f"{name}, resolved", fields.resolved_at(x, above, z), sample["resolved_m_per_s"], SPEED_M_PER_S)
            check(f"{name}, gust", fields.gust_at(x, z), sample["gust_m_per_s"], SPEED_M_PER_S)
            check(f"{name}, wind", fields.wind_at(x, above, z), sample["wind_m_per_s"], SPEED_M_PER_S)
            check(f"{name}, lean", lean(fields, x, z, vector["scene"]["grass"]["wind_bend_rad"]), sample["lean_rad"], LEAN_RAD)


def check_bends():
    for vector in VECTORS["bends"]:
        scene = {**VECTORS["winds"][0]["scene"], "patches": vector["layout"]}
        fields = prairie.Prairie(scene)
        for held in vector["patches"]:
            fields.grids[held["patch"]] = 1, grid(held["codes"], 3, vector["layout"]["cells"])
        for sample in vector["samples"]:
            check(f"bend at {sample['at_m']}", fields.bend_at(*sample["at_m"]), sample["bend_rad"], LEAN_RAD)


for check_section in (check_messages, check_grids, check_quantisation, check_winds, check_bends):
    check_section()
print(f"{compared} values compared, {len(differences)} differ", *differences, sep="\n")
sys.exit(1 if differences else 0)
