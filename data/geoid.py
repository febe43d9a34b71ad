#!/usr/bin/python3
"""egm96-15.pgm: the EGM96 geoid on a 15' grid, in the form that GeographicLib reads.

    geoid.py PROJ_DATA OUTPUT      (the folder of egm96_15.gtx in Debian's proj-data)

The source has rows from 90 S to 90 N and columns from 180 W to 180 E, both ends included: 1441 columns, the last one the
first again (or 1440 without it). The output has rows from 90 N, columns from 0 E eastward.
"""
import sys

import numpy

OFFSET, SCALE = -108, 0.003  # metres, as in the grids that come with GeographicLib: rounding is 1.5 mm at most

HEADER = """P5
# Geoid file in PGM format for the GeographicLib::Geoid class
# Description WGS84 EGM96, 15-minute grid
# URL https://earth-info.nga.mil/
# Offset -108
# Scale 0.003
# Origin 90N 0E
# AREA_OR_POINT Point
# Vertical_Datum WGS84
1440 721
65535
"""


def main(folder, output):
    with open(folder + "/egm96_15.gtx", "rb") as file:
        south, west, *steps = numpy.fromfile(file, ">f8", 4)
        rows, columns = numpy.fromfile(file, ">i4", 2)
        undulations = numpy.fromfile(file, ">f4").reshape(rows, columns)
    if (south, rows, columns) != (-90, 721, columns) or columns < 1440 or steps != [0.25, 0.25]:
        raise SystemExit(f"egm96_15.gtx: starts at {south}, {west} with {rows} x {columns} samples, steps {steps}")
    from_north = undulations[::-1, :1440].astype(numpy.float64)
    from_greenwich = numpy.roll(from_north, round(west / 0.25), axis=1)
    steps = numpy.rint((from_greenwich - OFFSET) / SCALE)
    if steps.min() < 0 or steps.max() > 65535:
        raise SystemExit("egm96_15.gtx: undulations outside -108..88.6 m")
    with open(output, "wb") as file:
        file.write(HEADER.encode("ascii"))
        steps.astype(">u2").tofile(file)


main(*sys.argv[1:])
