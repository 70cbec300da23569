"""Reads the last image of a collection with VTK, as ParaView does, and prints what it has, as JSON."""

import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree
import zlib

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

collection = pathlib.Path(sys.argv[1])
entry = ElementTree.parse(collection).getroot().findall("Collection/DataSet")[-1]
reader = vtkXMLImageDataReader()
reader.SetFileName(str(collection.parent / entry.get("file")))
reader.Update()
image = reader.GetOutput()
cells = image.GetCellData()
arrays = {cells.GetArrayName(n): vtk_to_numpy(cells.GetArray(n)) for n in range(cells.GetNumberOfArrays())}
print(
    json.dumps(
        {
            "time": float(entry.get("timestep")),
            "dimensions": image.GetDimensions(),
            "spacing": image.GetSpacing(),
            "arrays": {name: [list(values.shape), zlib.crc32(values.astype("<f4").tobytes())] for name, values in arrays.items()},
        }
    )
)
