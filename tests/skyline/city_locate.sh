#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `odograph city locate` from the command line: EXIF data of a phone's JPEG, written by another program (ExifTool), and
# the reasons for photographs without a position. Usage: city_locate.sh ODOGRAPH SOURCE
set -u
odograph=$1 source=$2
command -v exiftool >/dev/null || { echo "exiftool is not installed"; exit 77; }
. "$source/tests/support/expect.sh"
# Houses around 52.105 N, 4.275 E, which is 78803.80, 458001.49 of RD New.
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
surfaces = ""
for building in objects.values():
    rings = "".join("<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>" +
                    " ".join(str(x) for i in ring[0] + ring[0][:1] for x in vertices[i]) +
                    "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"
                    for ring in building["geometry"][0]["boundaries"])
    surfaces += ("<cityObjectMember><b:Building><b:lod1MultiSurface><gml:MultiSurface srsName='EPSG:7415'>" + rings +
                 "</gml:MultiSurface></b:lod1MultiSurface></b:Building></cityObjectMember>")
open("town.gml", "w").write("<CityModel xmlns:gml='g' xmlns:b='b'>" + surfaces + "</CityModel>")
open("cut.gml", "w").write("<CityModel xmlns:gml='g' xmlns:b='b'>" + surfaces)
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
  tagged zero.jpg -GPSLatitude=0 -GPSLatitudeRef=N -GPSLongitude=0 -GPSLongitudeRef=E -FocalLengthIn35mmFormat=26
  tagged turned.jpg $place -FocalLengthIn35mmFormat=26 -Orientation#=6
}
town="$odograph city locate --model town.city.json"
locate="$town -o found --sigma 3"
# EXIF data suffice; the picture is of another town and is not placed. Another without them has its row too.
expect 1 "phone.jpg: not placed: " $town -o found phone.jpg no_place.jpg
cat out err >first
expect 0 "the model has no terrain there" cat first
expect 0 "no_place.jpg: not placed: it does not state where it was taken (no GPS position in EXIF): give --near" cat first
expect 0 "0 of 2 placed; found has photographs.csv, map.png" cat first
expect 0 'phone.jpg",false' grep phone.jpg found/photographs.csv
expect 0 "4.5,250" grep phone.jpg found/photographs.csv
expect 0 "PNG" head -c 8 found/map.png
expect 1 "turned.jpg: not placed: " $locate turned.jpg
# Missing inputs are requested with their options, all at once; the other pictures of a folder are still processed.
expect 2 "no picture states its focal length (no 35 mm equivalent in EXIF): give --lens" $locate no_lens.jpg
expect 2 "no picture states where it was taken" $locate no_place.jpg half.jpg
expect 2 "no picture states where it was taken" $locate zero.jpg
expect 2 "no picture states where it was taken" "$odograph" city locate -o found --model local.city.json plain.jpg
cp err all
expect 0 "no picture states its focal length" cat all
expect 0 "the model states no reference system" cat all

expect 1 "plain.jpg: not placed: " $locate plain.jpg --near 52.105,4.275 --lens 26mm --heading 250
# A place without buildings is not searched; the reason has the model's bounds.
expect 1 "km from the model, whose buildings span latitudes 52.104" $locate south.jpg
expect 1 "4.27530; are the two numbers exchanged?" $locate plain.jpg --near 4.275,52.105 --lens 26mm
expect 1 "the place is 981 m from the model, whose buildings span eastings" "$odograph" city locate -o found --model local.city.json phone.jpg --at 77803 458001
expect 1 "0 of 1 placed; nowhere has photographs.csv" $town south.jpg -o nowhere
test ! -e nowhere/map.png || { echo "FAILED: a map without a place"; failed=1; }
# Error messages.
expect 3 "nothing.jpg: no such file" $locate nothing.jpg
expect 3 "town.city.json" $locate town.city.json --near 52.105,4.275 --lens 26mm
expect 2 "expected latitude,longitude in degrees" $locate plain.jpg --near 95,4 --lens 26mm
expect 2 "--near 52.105: expected latitude,longitude" $locate plain.jpg --near 52.105 4.275 --lens 26mm
expect 2 "expected 26mm (35 mm equivalent" $locate plain.jpg --near 52.105,4.275 --lens 26furlong
expect 3 "--lens none.yaml: no such file" $locate plain.jpg --near 52.105,4.275 --lens none.yaml
expect 2 "not in range" $locate phone.jpg --heading 400
expect 3 "no folder can be made there" $town phone.jpg -o phone.jpg/out
expect 2 "give the place in its own coordinates by --at EASTING NORTHING, or" "$odograph" city locate -o found --model local.city.json phone.jpg
expect 3 "cut.gml:1: not XML" "$odograph" city locate -o found --model cut.gml phone.jpg
grep model-at err && { echo "FAILED: a hint at the reference system of a broken model"; failed=1; }
expect 1 "phone.jpg: not placed: " "$odograph" city locate -o found --model local.city.json phone.jpg --at 78803.8 458001.5 --sigma 3
expect 1 '"placed": false' $locate south.jpg --json
python3 -m json.tool out >/dev/null || { echo "FAILED: --json is not one JSON value"; failed=1; }
# A picture that cannot be read has a row with the reason, and the next one is still processed.
head -c 300 phone.jpg >cut.jpg
expect 3 "south.jpg: not placed: " $locate cut.jpg south.jpg
mkdir folder
head -c 30000 phone.jpg >folder/truncated.jpg
printf '\0\0\0\030ftypheic\0\0\0\0mif1heic' | tee folder/phone.heic >folder/renamed.jpg
cp south.jpg folder
expect 3 "folder/truncated.jpg: not placed: the picture is truncated" $locate folder south.jpg
expect 0 '"folder/phone.heic",false,,,,,,,,,,,,,"HEIC and AVIF are not read; convert it to JPEG' cat found/photographs.csv
expect 0 '"folder/renamed.jpg",false,,,,,,,,,,,,,"HEIC' cat found/photographs.csv
expect 0 '"folder/south.jpg",false' cat found/photographs.csv
# A name that is not UTF-8, and a strip of three rows that is reduced to less than one.
cp south.jpg "$(printf 'caf\351.jpg')"
expect 1 '"placed": false' $locate caf*.jpg --json
python3 - <<'PYTHON'
import struct, zlib
def chunk(name, data): return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
open("strip.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 16384, 3, 8, 0, 0, 0, 0)) +
                              chunk(b"IDAT", zlib.compress(bytes(3 * 16385))) + chunk(b"IEND", b""))
PYTHON
expect 3 "strip.png: not placed: fix/skyline reported no result" $locate strip.png --near 52.105,4.275 --lens 26mm
# The table is written row by row.
$town south.jpg phone.jpg -o stopped >/dev/null 2>&1 &
for _ in $(seq 300); do
  grep -q south.jpg stopped/photographs.csv 2>/dev/null && break
  sleep 0.1
done
grep -q phone.jpg stopped/photographs.csv && { echo "FAILED: the table came at the end"; failed=1; }
kill $! 2>/dev/null
wait
# The check reports what of a model is used.
expect 0 "CityJSON 2.0, 12 objects" "$odograph" city check town.city.json
cp out check
expect 0 "edges of buildings; they span latitudes 52.104" cat check
expect 0 "edges of buildings; they span latitudes 52.104" "$odograph" city check town.gml
expect 0 "the model is in EPSG:7415 (Amersfoort / RD New + NAP height), easting first, by Amersfoort to WGS 84" "$odograph" city check town.gml
# A CityJSONSeq is read by both commands.
python3 - <<'PYTHON'
import json
model = json.load(open("town.city.json"))
with open("town.city.jsonl", "w") as file:
    file.write(json.dumps({**model, "transform": {"scale": [1, 1, 1], "translate": [0, 0, 0]}, "CityObjects": {}, "vertices": []}) + "\n")
    for name, building in model["CityObjects"].items():
        file.write(json.dumps({"type": "CityJSONFeature", "id": name, "CityObjects": {name: building}, "vertices": model["vertices"]}) + "\n")
# The town in US feet.
model["vertices"] = [[307868.958 * 3937 / 1200 + 10 * x, 90987.68 * 3937 / 1200 + 10 * y, z] for x, y, z in ((0, 0, 0), (1, 0, 0), (1, 1, 9))]
model["CityObjects"] = {"house": {"type": "Building", "geometry": [{"type": "MultiSurface", "lod": "1", "boundaries": [[[0, 1, 2]]]}]}}
model["metadata"]["referenceSystem"] = "https://www.opengis.net/def/crs/EPSG/0/2263"
json.dump(model, open("feet.city.json", "w"))
PYTHON
expect 0 "edges of buildings; they span latitudes 52.104" "$odograph" city check town.city.jsonl
expect 1 "phone.jpg: not placed: " "$odograph" city locate --model town.city.jsonl -o found --sigma 3 phone.jpg
cp err system
expect 0 "by Amersfoort to WGS 84 (4), accurate to 1 m" cat system
expect 0 "latitudes 40.98599 to 40.98602 and longitudes -73.90649 to -73.90646" "$odograph" city check feet.city.json
expect 3 "its coordinates are in the unit US survey foot" "$odograph" city build feet.city.json -o feet.skylines
expect 0 "\`city locate\` needs --model-at or --at: " "$odograph" city check local.city.json
expect 3 "cut.gml:1: not XML" "$odograph" city check cut.gml
expect 3 "town.gml: CityGML; this command reads CityJSON and OBJ alone" "$odograph" city build town.gml -o town.skylines
exit $failed
