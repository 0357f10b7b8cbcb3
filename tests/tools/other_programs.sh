#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Exchange with other programs, if installed: COLMAP triangulates from exported poses, gpsbabel reads tracks with their
# times, ROS 1's Python writes bags; with NODE_PATH @mcap/core reads MCAP, Chromium shows the page and axe-core checks
# it.
set -u
odograph=$1 source=$2
. "$source/tests/support/expect.sh"
same() { diff -r "$1" "$2" >/dev/null || { echo "FAILED: $1 and $2 differ"; failed=1; }; }
cat >walk.yaml <<'YAML'
odograph_scenario: 1
walker: {stand: 1 s}
route: {points: [[0, 0, 0], [9, 0, 0]]}
camera: {width: 480, height: 360, focal: 375 px, row_time: 0 s}
YAML
expect 0 "walk.odo" "$odograph" sim walk.yaml -o walk.odo --seed 3
expect 0 "written to run" "$odograph" run -c "$source/samples/configs/walk.yaml" -i walk.odo -o run --report
expect 0 "t_ns,state,reason" cat run/states.csv

# The page in a browser.
node "$source/tests/tools/page_browser.js" run/report.html run/summary.json >said 2>&1
case $? in
  0) cat said ;;
  77) echo "without playwright-core, axe-core or Chromium: no look at the page" ;;
  *) echo "FAILED: the page in a browser"; cat said; failed=1 ;;
esac

# MCAP export and import: identical samples, and pictures byte for byte.
expect 0 "poses" "$odograph" convert run run.mcap
expect 0 "MCAP" "$odograph" convert run.mcap back.odo
expect 0 "EuRoC" "$odograph" convert walk.odo direct
expect 0 "EuRoC" "$odograph" convert back.odo returned
same direct/mav0/imu0/data.csv returned/mav0/imu0/data.csv
same direct/mav0/cam0/data returned/mav0/cam0/data
node "$source/tests/recordings/mcap_file.js" run.mcap >said 2>&1
case $? in
  0) cat said ;;
  77) echo "without @mcap/core: run.mcap was read by odograph alone" ;;
  *) echo "FAILED: @mcap/core on run.mcap"; cat said; failed=1 ;;
esac
head -c 300000 run.mcap >cut.mcap
expect 3 "cut off" "$odograph" convert cut.mcap cut.odo
sed 's/"sec"/"zzz"/; s/jsonschema/JSONSCHEMA/; s/json/jsox/' run.mcap >other.mcap
expect 3 "encoded as 'jsox'" "$odograph" convert other.mcap other.odo

# A bag by ROS's own Python in each compression, with Kalibr's calibration beside it.
for compression in none bz2 lz4; do
  mkdir -p "bag_$compression"
  cp direct/camchain-imucam.yaml "bag_$compression"
  /usr/bin/python3 "$source/tests/recordings/write_bag.py" direct "bag_$compression/walk.bag" $compression
  [ $? = 77 ] && { echo "without python3-rosbag: no bags"; break; }
  expect 0 "EuRoC" "$odograph" convert "bag_$compression/walk.bag" "from_$compression"
  same direct/mav0/imu0/data.csv "from_$compression/mav0/imu0/data.csv"
  same direct/mav0/cam0/data "from_$compression/mav0/cam0/data"
done
expect 0 "camera of 480 x 360" "$odograph" convert direct/camchain-imucam.yaml camera.yaml
expect 0 "fx: 375" cat camera.yaml
sed 's/radtan/fov/' direct/camchain-imucam.yaml >fov.yaml
expect 3 "distortion_model 'fov'; expected radtan" "$odograph" convert fov.yaml camera.yaml

# Tracks on a map, with times if the clock is Unix time.
awk '{ $1 = sprintf("%.3f", $1 + 1781800000); print }' run/trajectory.tum >unix.tum
for kind in gpx kml geojson; do expect 0 "poses" "$odograph" convert unix.tum unix.$kind --origin 48,11,500; done
if command -v gpsbabel >/dev/null; then
  for kind in gpx kml; do
    expect 0 "2026/06/1" gpsbabel -t -i $kind -f unix.$kind -o unicsv -F -
    rows=$(grep -c "2026/06/1" out) poses=$(grep -c . unix.tum)
    [ "$rows" = "$poses" ] || { echo "FAILED: gpsbabel reads $rows of $poses places of unix.$kind with times"; failed=1; }
  done
fi

# Poses with pictures.
expect 0 "pictures" "$odograph" convert run nerf/transforms.json --every 1
expect 0 "transform_matrix" cat nerf/transforms.json
expect 2 "has files in it already" "$odograph" convert run nerf/transforms.json
expect 0 "pictures" "$odograph" convert walk.odo walk.colmap --every 0.6
if command -v colmap >/dev/null; then
  export QT_QPA_PLATFORM=offscreen
  mkdir points
  # One thread: COLMAP numbers pictures in the order of completion, and the model's numbers must match.
  { colmap feature_extractor --database_path all.db --image_path walk.colmap/images --ImageReader.single_camera 1 --ImageReader.camera_model OPENCV \
      --ImageReader.camera_params "375,375,240,180,0,0,0,0" --SiftExtraction.use_gpu 0 --SiftExtraction.num_threads 1 --SiftExtraction.max_num_features 800 &&
    colmap sequential_matcher --database_path all.db --SiftMatching.use_gpu 0 --SiftMatching.num_threads 1 --SequentialMatching.overlap 3 &&
    colmap point_triangulator --database_path all.db --image_path walk.colmap/images --input_path walk.colmap/sparse --output_path points &&
    colmap model_analyzer --path points; } >colmap.log 2>&1 || { echo "FAILED: colmap"; tail -5 colmap.log; failed=1; }
  error=$(sed -n 's/.*Mean reprojection error: \([0-9.]*\)px.*/\1/p' colmap.log)
  points=$(sed -n 's/.*Points: \([0-9]*\).*/\1/p' colmap.log)
  echo "COLMAP: ${points:-0} points, mean reprojection error ${error:-none} px"
  awk -v e="${error:-9}" -v n="${points:-0}" 'BEGIN { exit !(e < 1 && n > 100) }' || { echo "FAILED: expected under 1 px and 100 points"; failed=1; }
fi
exit $failed
