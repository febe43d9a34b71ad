#!/usr/bin/python3
"""sangre_de_cristo.tif: a 3" elevation model of the Sangre de Cristo mountains, Colorado, in whole metres.

    sangre_de_cristo.py NCARG_DATA OUTPUT      (the folder of trinidad.nc in Debian's libncarg-data)

The source is in feet at 3.28 a metre: divided by that, every value is a whole number of metres to 0.0003.
"""
import sys

import numpy
from osgeo import gdal

gdal.UseExceptions()


def main(folder, output):
    feet = gdal.Open(f"NETCDF:{folder}/trinidad.nc:data").ReadAsArray()
    metres = numpy.rint(feet / 3.28)
    if metres.shape != (1201, 2401) or numpy.abs(feet / 3.28 - metres).max() > 0.001:
        raise SystemExit("trinidad.nc: not 2401 x 1201 whole metres in feet at 3.28")

    options = ["COMPRESS=DEFLATE", "PREDICTOR=2", "ZLEVEL=9", "BLOCKYSIZE=40"]
    file = gdal.GetDriverByName("GTiff").Create(output, 2401, 1201, 1, gdal.GDT_Int16, options)
    # Samples are at 106 W to 104 W and 38 N to 37 N, whole multiples of 3": half a pixel outside is the corner.
    step = 1 / 1200
    file.SetGeoTransform((-106 - step / 2, step, 0, 38 + step / 2, 0, -step))
    file.SetProjection("EPSG:4326")
    band = file.GetRasterBand(1)
    band.SetDescription("height above mean sea level")
    band.SetUnitType("m")
    band.WriteArray(metres.astype(numpy.int16))


main(*sys.argv[1:])
