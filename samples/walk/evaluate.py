# SPDX-License-Identifier: Apache-2.0
"""The error of a run against its recording's truth, in Python.

    python3 evaluate.py CONFIG.yaml RECORDING.odo TRACK.tum
"""
import sys

import odograph

if len(sys.argv) != 4:
    sys.exit(__doc__)
config, recording, track = sys.argv[1:]
run = odograph.run(config, recording)
run.save(track)  # as TUM, for `odograph eval` and other programs
errors = odograph.evaluate(recording, run)
print(f"{errors['ape_m']['rmse']:.2f} m of {errors['path_m']:.1f} m, {len(odograph.truth(recording))} true poses")
