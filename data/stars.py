#!/usr/bin/python3
"""stars.csv: the stars that the eye sees.

    stars.py D3_CELESTIAL OUTPUT      (the folder of npm d3-celestial; stars.8.json, from the Hipparcos catalogue)

A header line, then a star a line, the brightest first: right ascension and declination (ICRS, which is J2000 to 0.03";
epoch 2000 or nearly), degrees; V magnitude; colour index B-V.
"""
import json
import sys

FAINTEST = 6.5
WHITE = 0.3  # B-V of the few stars without one: an F star, white


def main(folder, output):
    with open(folder + "/data/stars.8.json", encoding="utf-8") as file:
        features = json.load(file)["features"]
    stars = []
    for star in features:
        (longitude, declination), values = star["geometry"]["coordinates"], star["properties"]
        magnitude = float(values["mag"])
        if magnitude <= FAINTEST:
            colour = float(values["bv"] or WHITE)
            stars.append((magnitude, longitude % 360, declination, colour))
    with open(output, "w", encoding="ascii") as file:
        file.write("right_ascension_deg,declination_deg,v_mag,b_v\n")
        for magnitude, right_ascension, declination, colour in sorted(stars):
            file.write(f"{right_ascension:.4f},{declination:.4f},{magnitude:.2f},{colour:.3f}\n")


main(*sys.argv[1:])
