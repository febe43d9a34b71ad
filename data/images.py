#!/usr/bin/python3
"""blue_marble.jpg, night_lights.jpg and water_mask.png: pictures of the whole Earth, longitude 180 W to 180 E.

    images.py THREE_GLOBE OUTPUT_FOLDER      (the folder of npm three-globe)
"""
import shutil
import sys

import numpy
from osgeo import gdal

gdal.UseExceptions()
gdal.SetConfigOption("GDAL_PAM_ENABLED", "NO")  # no .aux.xml beside the pictures


def save(pixels, file, driver, options):
    bands, rows, columns = pixels.shape
    image = gdal.GetDriverByName("MEM").Create("", columns, rows, bands, gdal.GDT_Byte)
    for band in range(bands):
        image.GetRasterBand(band + 1).WriteArray(pixels[band])
    gdal.GetDriverByName(driver).CreateCopy(file, image, options=options)


def blue_marble(source, output):
    """The picture has a pale rounded corner at 180 E at the north pole, and pale rows along the pole: painted over."""
    pixels = gdal.Open(source).ReadAsArray().astype(numpy.float64)
    pixels[:, :4] = pixels[:, 4:5]
    rows, first = 90, 4040
    weight = (numpy.arange(first, 4096) - first) / (4096 - first)
    pixels[:, :rows, first:] = pixels[:, :rows, first - 1, None] * (1 - weight) + pixels[:, :rows, :1] * weight
    save(numpy.rint(pixels).astype(numpy.uint8), output, "JPEG", ["QUALITY=93"])


def water_mask(source, output):
    """One channel of three equal ones: 0 land, 255 water, grey where a pixel holds both."""
    pixels = gdal.Open(source).ReadAsArray()
    if (pixels != pixels[0]).any():
        raise SystemExit("earth-water.png: not grey")
    save(pixels[:1], output, "PNG", ["ZLEVEL=9"])


def main(folder, output):
    images = folder + "/example/img/"
    blue_marble(images + "earth-blue-marble.jpg", output + "/blue_marble.jpg")
    shutil.copyfile(images + "earth-night.jpg", output + "/night_lights.jpg")
    water_mask(images + "earth-water.png", output + "/water_mask.png")


main(*sys.argv[1:])
