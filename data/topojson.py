"""Reads the TopoJSON files of npm world-atlas: quantized arcs, shared between the polygons of both their sides.

GDAL reads TopoJSON too, but these polygons have had their cuts at the antimeridian and the south pole removed: rings step
from 180 to -180, and the ring of Antarctica goes around the pole without touching it. Taken as plane polygons they cover
the wrong part of the plane. So rings are unrolled here: no step is longer than half a turn, and longitudes may lie outside
[-180, 180].
"""
import json


class Topology:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.content = json.load(file)
        (sx, sy), (tx, ty) = (self.content["transform"][key] for key in ("scale", "translate"))
        self.arcs = []
        for deltas in self.content["arcs"]:
            x, y, arc = 0, 0, []
            for dx, dy in deltas:
                x, y = x + dx, y + dy
                arc.append((x * sx + tx, y * sy + ty))
            self.arcs.append(arc)

    def geometries(self, name):
        """The polygons of each geometry of an object. A polygon is a list of rings, a ring a list of arc numbers, ~n for
        arc n backwards."""
        for geometry in self.content["objects"][name]["geometries"]:
            polygons = geometry["arcs"] if geometry["type"] == "MultiPolygon" else [geometry["arcs"]]
            yield polygons

    def polygons(self, name):
        for polygons in self.geometries(name):
            yield from polygons

    def points(self, ring):
        points = []
        for number in ring:
            arc = self.arcs[number] if number >= 0 else self.arcs[~number][::-1]
            points += arc[1:] if points else arc
        return points


def unrolled(points):
    """The same points with longitudes that go on beyond 180 degrees instead of jumping."""
    result = points[:1]
    for x, y in points[1:]:
        x += 360 * round((result[-1][0] - x) / 360)
        result.append((x, y))
    return result


def closed_around_pole(points):
    """An unrolled ring; if it goes around the south pole, closed along latitude -90."""
    turn = points[-1][0] - points[0][0]
    if abs(turn) < 180:
        return points
    return points + [(points[-1][0], -90.0), (points[0][0], -90.0), points[0]]
