#!/usr/bin/python3
"""coastlines.geojson and borders.geojson: lines of Natural Earth 1:50m.

    coastlines.py WORLD_ATLAS OUTPUT_FOLDER      (the folder of npm world-atlas; countries-50m.json is used)

A line that is a side of the land is coast (the shores of the Caspian are among them), one between two countries is a
border. Lines end at the antimeridian and begin again on its other side; none runs along it or along the pole.
"""
import json
import math
import sys
from collections import Counter

from topojson import Topology


def pieces(points):
    """A line without its steps across, or along, the antimeridian, and without those along the pole."""
    line = points[:1]
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if min(abs(x0), abs(x1)) > 179.9999 or max(y0, y1) < -89:
            yield line
            line = []
        elif abs(x1 - x0) > 180:
            edge = math.copysign(180, x0)
            at = y0 + (y1 - y0) * (edge - x0) / (x1 + 2 * edge - x0)
            yield line + [(edge, at)]
            line = [(-edge, at)]
        line.append((x1, y1))
    yield line


def rounded(line):
    """In steps of 0.0001 degree (11 m; the source has 400 m), without points that fall together."""
    points = [(round(x, 4), round(y, 4)) for x, y in line]
    return [point for i, point in enumerate(points) if i == 0 or point != points[i - 1]]


def save(topology, arcs, file):
    lines = [rounded(piece) for arc in sorted(arcs) for piece in pieces(topology.arcs[arc])]
    geometry = {"type": "MultiLineString", "coordinates": [line for line in lines if len(line) > 1]}
    feature = {"type": "Feature", "properties": {}, "geometry": geometry}
    with open(file, "w", encoding="ascii") as output:
        json.dump({"type": "FeatureCollection", "features": [feature]}, output, separators=(",", ":"))
        output.write("\n")


def arcs_of(polygons):
    return {arc if arc >= 0 else ~arc for polygon in polygons for ring in polygon for arc in ring}


def main(folder, output):
    topology = Topology(folder + "/countries-50m.json")
    coast = arcs_of(topology.polygons("land"))
    sides = Counter()
    for country in topology.geometries("countries"):
        sides.update(arcs_of(country))
    borders = {arc for arc, countries in sides.items() if countries > 1} - coast
    save(topology, coast, output + "/coastlines.geojson")
    save(topology, borders, output + "/borders.geojson")


main(*sys.argv[1:])
