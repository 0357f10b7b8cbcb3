#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `odograph city locate` from the command line: EXIF data of a phone's JPEG, written by another program (ExifTool), and
# the reasons for photographs without a position. Usage: city_locate.sh ODOGRAPH SOURCE
set -u
odograph=$1 source=$2
command -v exiftool >/dev/null || { echo "exiftool is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
. "$source/tests/support/expect.sh"
# Houses around 52.105 N, 4.275 E, which is 78803.80, 458001.49 of RD New (cs2cs EPSG:4326 EPSG:28992).
python3 - <<'PYTHON'
import json
vertices, objects = [], {}
def house(x, y, a, b, height):
    first = len(vertices)
    for z in (0, height):
        vertices.extend([x + s * a, y + t * b, z] for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    sides = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7], [3, 2, 1, 0]]
    objects[f"house{len(objects)}"] = {"type": "Building", "geometry": [
        {"type": "MultiSurface", "lod": "1", "boundaries": [[[first + i for i in side]] for side in sides]}]}
for k in range(6):
    house(78803.8 - 14, 458001.5 - 30 + 13 * k, 6, 6, 9 + 5 * (k % 3))
    house(78803.8 + 14, 458001.5 - 30 + 13 * k, 6, 6, 12 + 4 * (k % 2))
model = {"type": "CityJSON", "version": "2.0", "vertices": vertices, "CityObjects": objects}
json.dump(model, open("local.city.json", "w"))
model["metadata"] = {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/7415"}
json.dump(model, open("town.city.json", "w"))
PYTHON
cp "$source/docs/pictures/photograph_roofs.jpg" plain.jpg
tagged() { # name, tags...
  cp plain.jpg "$1"
  file=$1
  shift
  exiftool -q -overwrite_original "$@" "$file" || failed=1
}
place="-GPSLatitude=52.105 -GPSLatitudeRef=N -GPSLongitude=4.275 -GPSLongitudeRef=E"
# shellcheck disable=SC2086
{
  tagged phone.jpg $place -GPSImgDirection=250 -GPSImgDirectionRef=T -GPSHPositioningError=4.5 -FocalLengthIn35mmFormat=26
  tagged no_lens.jpg $place
  tagged no_place.jpg -FocalLengthIn35mmFormat=26
  tagged south.jpg -GPSLatitude=52.105 -GPSLatitudeRef=S -GPSLongitude=4.275 -GPSLongitudeRef=E -FocalLengthIn35mmFormat=26
  tagged half.jpg -GPSLatitude=52.105 -GPSLatitudeRef=N -FocalLengthIn35mmFormat=26
  tagged turned.jpg $place -FocalLengthIn35mmFormat=26 -Orientation#=6
}
locate="$odograph city locate -o found --model town.city.json"
# EXIF data suffice; the picture is of another town and is not placed.
expect 1 "phone.jpg: not placed: " $locate phone.jpg
expect 1 "0 of 1 placed" $locate phone.jpg
expect 1 "the model has no terrain there" $locate phone.jpg
expect 0 'phone.jpg",false' grep phone found/photographs.csv
expect 0 "PNG" head -c 8 found/map.png
expect 1 "turned.jpg: not placed: " $locate turned.jpg
# Missing EXIF data are requested with their option; the other pictures of a folder are still processed.
expect 1 "no_lens.jpg: not placed: it does not say its focal length (no 35 mm equivalent in EXIF): give --lens" $locate no_lens.jpg
expect 2 "where were they taken?" $locate no_place.jpg
expect 2 "where were they taken?" $locate half.jpg
expect 1 "no_place.jpg: not placed: it does not say where it was taken (no GPS in EXIF): give --near" $locate phone.jpg no_place.jpg

expect 1 "plain.jpg: not placed: " $locate plain.jpg --near 52.105,4.275 --lens 26mm
# Error messages.
expect 3 "nothing.jpg: no such file" $locate nothing.jpg
expect 3 "town.city.json" $locate town.city.json --near 52.105,4.275 --lens 26mm
expect 2 "expected latitude,longitude in degrees" $locate plain.jpg --near 95,4 --lens 26mm
expect 2 "expected 26mm (35 mm equivalent)" $locate plain.jpg --near 52.105,4.275 --lens 26furlong
expect 1 "is it the right model?" $locate south.jpg
expect 3 "--model-at LAT,LON says where its zero is" "$odograph" city locate -o found --model local.city.json phone.jpg
expect 1 "phone.jpg: not placed: " "$odograph" city locate -o found --model local.city.json phone.jpg --at 78803.8 458001.5
expect 1 '"placed": false' $locate phone.jpg --json
python3 -m json.tool out >/dev/null || { echo "FAILED: --json is not one JSON value"; failed=1; }
# A truncated picture is reported, and the next one is still processed.
head -c 300 phone.jpg >cut.jpg
expect 3 "phone.jpg: not placed: " $locate cut.jpg phone.jpg
exit $failed
