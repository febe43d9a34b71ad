#!/usr/bin/python3
"""etopo5.tif: ETOPO5 with its faults corrected. README.md tells how each was found.

    etopo5.py FERRET_DATA LAND_MASK OUTPUT      (the folder of etopo5.cdf in Debian's ferret-datasets; land_mask.tif)

The source has a sample at every node, 5' apart: column j at longitude j/12, row i at latitude 90 - i/12 degrees. The output
has one in the middle of every 5' cell, from 180 W and 90 N. Land was surveyed in cells, which the source has put at wrong
nodes, so that most of its heights land on the middle of a cell of the output unchanged.
"""
import sys

import numpy
from osgeo import gdal

gdal.UseExceptions()
ROWS, COLUMNS = 2160, 4320

# The nodes that a cell (row, column) takes its height from, as steps from the node at its north-west corner.
SEA = dict(rows=(0, 1), columns=(0, 1))  # samples are where they say: the mean of the four corners
LAND = dict(rows=(0,), columns=(-1,))  # samples are 7.5' west and 2.5' north of their cell
OCEANIA = dict(rows=(1,), columns=(-2,))  # 12.5' west and 2.5' south

COAST = 3  # cells from the sea within which land below 0 is taken for a sample of the sea

# Single samples of the land survey that are wrong: row and column of the source, what it has there, and how many nodes
# away the next samples of the survey are.
WRONG = (
    (246, 2870, 3205, 1),  # the Melville Hills, Canada, between 120 and 460 m
    (351, 2727, 2715, 1),  # the Yukon, between 1014 and 1293 m
    (856, 1221, -1006, 2),  # Laos, between 366 and 671 m
    (920, 1309, 1981, 2),  # the coast of Vietnam, between 30 and 122 m
)

# Lakes whose beds are in the source, wholly or in part: level of the water (metres; rounded long-term means), then south,
# north, west and east of a box without the ground below the outlet. All other ground around a lake is above it.
LAKES = (
    (183, 46.40, 49.10, -92.20, -84.50),  # Superior
    (176, 41.60, 46.20, -87.95, -84.80),  # Michigan
    (176, 43.10, 46.35, -84.80, -81.30),  # Huron
    (176, 44.40, 46.10, -81.60, -79.60),  # Georgian Bay
    (174, 41.35, 42.85, -83.50, -78.90),  # Erie
    (75, 43.15, 44.15, -79.85, -76.30),  # Ontario
    (156, 65.30, 67.00, -125.00, -117.50),  # Great Bear Lake
    (156, 64.70, 65.30, -123.30, -117.50),
    (156, 60.80, 62.90, -116.20, -109.00),  # Great Slave Lake
    (5, 60.40, 61.80, 29.90, 33.00),  # Ladoga
    (5, 59.90, 60.40, 31.10, 33.00),
    (33, 61.20, 62.90, 34.10, 36.50),  # Onega
    (32, 11.40, 12.15, -85.85, -84.95),  # Nicaragua
    (32, 11.15, 11.40, -85.65, -84.95),
    (-430, 30.90, 32.30, 35.30, 35.65),  # the Dead Sea and the valley above it
    (-212, 32.65, 32.95, 35.50, 35.70),  # the Sea of Galilee
    (-71, 32.75, 33.90, -116.50, -115.20),  # the Salton Sea and the valleys above it
    (-30, 36.50, 39.00, 48.50, 54.20),  # the south of the Caspian, at the level that it has in the source elsewhere
)


def read_source(folder):
    values = gdal.Open(f"NETCDF:{folder}/etopo5.cdf:ROSE").ReadAsArray()
    heights = numpy.rint(values).astype(numpy.int32)
    if heights.shape != (ROWS + 1, COLUMNS) or numpy.abs(values - heights).max() != 0:
        raise SystemExit("etopo5.cdf: not 4320 x 2161 whole metres")
    # 1280 samples in file order belong elsewhere; they hang over from one row into the next.
    interpolate_rows(heights[:, 3520:], 2054, 2054)
    interpolate_rows(heights[:, :480], 2055, 2055)
    # Arnhem Land lies under water for four rows.
    interpolate_rows(heights[:, 1566:1632], 1235, 1238)
    for row, column, height, step in WRONG:
        if heights[row, column] != height:
            raise SystemExit(f"etopo5.cdf: {heights[row, column]} at row {row}, column {column}, not {height}")
        next_ones = heights[[row - step, row + step, row, row], [column, column, column - step, column + step]]
        heights[row, column] = next_ones[next_ones > 0].mean()
    return heights


def interpolate_rows(heights, first, last):
    """Rows first to last, from those before and after."""
    above, below, span = heights[first - 1], heights[last + 1], last + 2 - first
    for step in range(1, span):
        heights[first - 1 + step] = (above * (span - step) + below * step) // span


def around(cells, reach):
    """Sums over (2 reach + 1)^2 cells; longitudes go around, latitudes end."""
    padded = numpy.pad(numpy.pad(cells, ((0, 0), (reach, reach)), mode="wrap"), ((reach, reach), (0, 0)))
    sums = numpy.pad(padded.astype(float).cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    size = 2 * reach + 1
    return sums[size:, size:] - sums[:-size, size:] - sums[size:, :-size] + sums[:-size, :-size]


def mean_of_nodes(heights, wanted, rows, columns):
    """Mean of a cell's wanted nodes; NaN where it has none."""
    total, count = numpy.zeros((ROWS, COLUMNS)), numpy.zeros((ROWS, COLUMNS))
    for row in rows:
        lines = numpy.clip(numpy.arange(ROWS) + row, 0, ROWS)
        for column in columns:
            use = numpy.roll(wanted[lines], -column, axis=1)
            total += numpy.where(use, numpy.roll(heights[lines], -column, axis=1), 0)
            count += use
    return numpy.where(count > 0, total / numpy.maximum(count, 1), numpy.nan)


def is_coarse(heights):
    """Cells around which land came from a 10' grid: every second column is then half-way between its neighbours."""
    west, east = numpy.roll(heights, 1, axis=1), numpy.roll(heights, -1, axis=1)
    telling = (heights > 0) & (west > 0) & (east > 0) & (numpy.abs(west - east) > 3)
    telling[:, 1::2] = False
    halfway = telling & (numpy.abs(2 * heights - west - east) <= 1)

    def weight(nodes):  # near ones count most; far ones decide where there is little land
        return around(nodes[:ROWS], 15) + 0.05 * around(nodes[:ROWS], 60)

    return weight(halfway) > 0.7 * weight(telling)


def slope(cells, axis):
    """Change from cell to cell, the least of what both neighbours allow; 0 at peaks and beside cells without a value."""
    before, after = cells - numpy.roll(cells, 1, axis), numpy.roll(cells, -1, axis) - cells
    size = numpy.minimum(numpy.abs(before + after) / 2, 2 * numpy.minimum(numpy.abs(before), numpy.abs(after)))
    return numpy.where(before * after > 0, numpy.sign(before) * size, 0)


def coarse_land(heights, wanted):
    """Heights of the 10' cells that the source was interpolated from, in 5' cells. Samples of the survey are in even rows
    and odd columns, 10' west and 5' north of their cell. A cell is sloped but keeps its mean, and makes no new peaks
    (van Leer 1977, J. Comp. Phys. 23, 276, eq. 67)."""
    survey = numpy.where(wanted, heights, numpy.nan)[:ROWS:2, 1::2]
    survey = numpy.roll(survey, 1, axis=1)
    southward, eastward = slope(survey, 0), slope(survey, 1)
    cells = numpy.empty((ROWS, COLUMNS))
    for row in (0, 1):
        for column in (0, 1):
            cells[row::2, column::2] = survey + (row - 0.5) / 2 * southward + (column - 0.5) / 2 * eastward
    return cells


def in_oceania():
    latitude = 90 - (numpy.arange(ROWS)[:, None] + 0.5) / 12
    longitude = (numpy.arange(COLUMNS)[None, :] + 0.5) / 12
    return (latitude < -10) & (latitude > -50) & (longitude > 110) & (longitude < 180)


def land_heights(heights, mask):
    coarse, oceania = is_coarse(heights), in_oceania()

    def placed(wanted):
        fine = numpy.where(oceania, mean_of_nodes(heights, wanted, **OCEANIA), mean_of_nodes(heights, wanted, **LAND))
        return numpy.where(coarse, coarse_land(heights, wanted), fine)

    near_sea = around(mask == 0, COAST) > 0.5
    near_sea[150 * ROWS // 180 :] = True  # in Antarctica no ground below 0 is free of ice or water
    cells = numpy.where(near_sea, placed(heights > 0), placed(numpy.ones_like(heights, bool)))
    return filled(cells, mask == 1, 1)


def fill_lakes(heights, mask):
    """Raises land below the level of its lake."""
    for level, south, north, west, east in LAKES:
        rows = numpy.arange(round((90 - north) * 12), round((90 - south) * 12))
        columns = numpy.arange(round(west * 12), round(east * 12)) % COLUMNS
        box = numpy.ix_(rows, columns)
        heights[box] = numpy.where(mask[box] == 1, numpy.maximum(heights[box], level), heights[box])


def sea_heights(heights, mask):
    depths = mean_of_nodes(heights, heights <= 0, **SEA)
    return numpy.minimum(filled(depths, mask == 0, -1), -1)


def filled(values, wanted, otherwise):
    """Wanted cells without a value take the mean of the cells around them that have one, up to three cells away."""
    values = numpy.where(wanted, values, numpy.nan)
    for _ in range(3):
        known = ~numpy.isnan(values)
        count = numpy.rint(around(known, 1))
        mean = around(numpy.where(known, values, 0), 1) / numpy.maximum(count, 1)
        values = numpy.where(wanted & ~known & (count > 0), mean, values)
    return numpy.where(numpy.isnan(values), otherwise, values)


def main(folder, mask_file, output):
    heights = read_source(folder)
    mask = numpy.roll(gdal.Open(mask_file).ReadAsArray(), COLUMNS // 2, axis=1)  # from longitude 0, as the source
    merged = numpy.where(mask == 1, land_heights(heights, mask), sea_heights(heights, mask))
    fill_lakes(merged, mask)
    merged = numpy.roll(numpy.rint(merged).astype(numpy.int16), COLUMNS // 2, axis=1)

    options = ["COMPRESS=DEFLATE", "PREDICTOR=2", "ZLEVEL=9", "BLOCKYSIZE=24"]
    file = gdal.GetDriverByName("GTiff").Create(output, COLUMNS, ROWS, 1, gdal.GDT_Int16, options)
    file.SetGeoTransform((-180, 1 / 12, 0, 90, 0, -1 / 12))
    file.SetProjection("EPSG:4326")
    band = file.GetRasterBand(1)
    band.SetDescription("height above mean sea level")
    band.SetUnitType("m")
    band.WriteArray(merged)


main(*sys.argv[1:])
