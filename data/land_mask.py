#!/usr/bin/python3
"""land_mask.tif: 1 on land, 0 at sea, on the grid of etopo5.tif.

    land_mask.py WORLD_ATLAS OUTPUT      (the folder of npm world-atlas; land-10m.json of Natural Earth is used)

A cell of 5' is land if at least half of it is, measured at 16 x 16 points. Holes of the land (the Caspian) are filled:
water that the sea does not reach has a level of its own, and its heights are to be kept. Ice shelves are sea.
"""
import sys

import numpy
from osgeo import gdal, ogr

from topojson import Topology, closed_around_pole, unrolled

gdal.UseExceptions()
CELLS = 12  # a degree
POINTS = 16  # a side of a cell
BAND = 10  # degrees of latitude at a time


def land_rings(folder):
    topology = Topology(folder + "/land-10m.json")
    for outer, *_holes in topology.polygons("land"):
        yield closed_around_pole(unrolled(topology.points(outer)))


def layer_of(rings):
    """Every ring three times, a turn apart, so that [-180, 180] is covered whichever way it was unrolled."""
    source = ogr.GetDriverByName("Memory").CreateDataSource("land")
    layer = source.CreateLayer("land", geom_type=ogr.wkbPolygon)
    for points in rings:
        for turn in (-360, 0, 360):
            if max(x for x, _ in points) + turn < -180 or min(x for x, _ in points) + turn > 180:
                continue
            ring = ogr.Geometry(ogr.wkbLinearRing)
            for x, y in points:
                ring.AddPoint_2D(x + turn, y)
            polygon = ogr.Geometry(ogr.wkbPolygon)
            polygon.AddGeometry(ring)
            feature = ogr.Feature(layer.GetLayerDefn())
            feature.SetGeometry(polygon)
            layer.CreateFeature(feature)
    return source, layer


def points_in_land(layer, north):
    """How many of a cell's points are land, for the cells of a band of latitudes."""
    step = 1 / (CELLS * POINTS)
    band = gdal.GetDriverByName("MEM").Create("", 360 * CELLS * POINTS, BAND * CELLS * POINTS, 1, gdal.GDT_Byte)
    band.SetGeoTransform((-180, step, 0, north, 0, -step))
    gdal.RasterizeLayer(band, [1], layer, burn_values=[1])
    return band.ReadAsArray().reshape(BAND * CELLS, POINTS, 360 * CELLS, POINTS).sum(axis=(1, 3))


def main(folder, output):
    gdal.PushErrorHandler("CPLQuietErrorHandler")  # a layer without a reference system is meant
    source, layer = layer_of(land_rings(folder))
    counts = numpy.concatenate([points_in_land(layer, north) for north in range(90, -90, -BAND)])
    del layer, source
    gdal.PopErrorHandler()
    mask = (2 * counts >= POINTS * POINTS).astype(numpy.uint8)

    rows, columns = mask.shape
    options = ["NBITS=1", "COMPRESS=DEFLATE", "ZLEVEL=9", "BLOCKYSIZE=216"]
    file = gdal.GetDriverByName("GTiff").Create(output, columns, rows, 1, gdal.GDT_Byte, options)
    file.SetGeoTransform((-180, 1 / CELLS, 0, 90, 0, -1 / CELLS))
    file.SetProjection("EPSG:4326")
    file.GetRasterBand(1).SetDescription("1 land, 0 sea")
    file.GetRasterBand(1).WriteArray(mask)


main(*sys.argv[1:])
