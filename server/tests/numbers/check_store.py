"""Opens a store with xarray and prints what it has, as JSON. Warnings are errors."""

import json
import sys
import warnings
import zlib

import numpy
import xarray

warnings.simplefilter("error")


def checksum(values: numpy.ndarray) -> int:
    """CRC-32 of all values, little-endian, so that a single other bit shows."""
    return zlib.crc32(numpy.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes())


with xarray.open_zarr(sys.argv[1], chunks=None) as store:
    variables = {
        name: {
            "dims": list(variable.dims),
            "dtype": str(variable.dtype),
            "units": variable.attrs["units"],
            "crc32": checksum(variable.values),
        }
        for name, variable in store.variables.items()
    }
    # Coordinates serve for selection: the wind nearest to a place, and the mean over a part of the land.
    nearest = store.u.sel(wind_x=30.5, wind_z=9.0, y=2.9, time=1.0, method="nearest").item()
    track = store.theta.isel(time=-1).sel(z=slice(28.0, 36.0), x=slice(20.0, 40.0)).max().item()
    print(json.dumps({"attributes": store.attrs, "variables": variables, "nearest": nearest, "track": track}))
